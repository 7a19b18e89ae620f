//! Ranks that are the processes of `mpirun`.

use crate::ffi;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use stoss_linalg::{Communicator, Traffic};

/// All ranks of `mpirun`; one if the program was started without it. From the start on a panic of any of several ranks ends all of them, with its message and the code 1.
#[derive(Debug)]
pub struct Mpi {
    rank: usize,
    size: usize,
    traffic: Mutex<Traffic>,
}

impl Mpi {
    /// Starts MPI and PETSc, the first time that it is called: later calls return the same.
    ///
    /// # Errors
    /// Why they do not start, in PETSc's words.
    pub fn start() -> Result<Arc<Self>, String> {
        static STARTED: OnceLock<Result<Arc<Mpi>, String>> = OnceLock::new();
        STARTED.get_or_init(Self::first_start).clone()
    }

    fn first_start() -> Result<Arc<Self>, String> {
        let (rank, size) = ffi::start()?;
        if size > 1 {
            let before = std::panic::take_hook();
            std::panic::set_hook(Box::new(move |panic| {
                before(panic);
                // The others wait for a message that will not come.
                ffi::abort("it has panicked");
            }));
        }
        Ok(Arc::new(Self { rank, size, traffic: Mutex::default() }))
    }

    /// Ends MPI, if it was started: to be called by all ranks, at the end of the program. What is left of PETSc's objects is given back, and no rank can be talked to any more.
    pub fn end() {
        ffi::end();
    }

    fn count(&self, received: impl Iterator<Item = usize>) {
        self.traffic.lock().unwrap_or_else(PoisonError::into_inner).count(self.rank, received);
    }

    fn assert_all(&self, counts: &[usize]) {
        assert_eq!(counts.len(), self.size, "a count for each rank");
    }
}

impl Communicator for Mpi {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn gather(&self, mine: &[f64], counts: &[usize], all: &mut [f64]) {
        self.assert_all(counts);
        ffi::gather(mine, self.rank, counts, all);
        self.count(counts.iter().map(|count| 8 * count));
    }

    fn exchange(&self, send: &[f64], send_counts: &[usize], receive: &mut [f64], receive_counts: &[usize]) {
        self.assert_all(send_counts);
        self.assert_all(receive_counts);
        ffi::exchange(send, send_counts, receive, receive_counts, self.rank);
        self.count(receive_counts.iter().map(|count| 8 * count));
    }

    fn gather_bytes(&self, mine: &[u8]) -> Vec<Vec<u8>> {
        let all = ffi::gather_bytes(mine, self.size);
        self.count(all.iter().map(Vec::len));
        all
    }

    fn traffic(&self) -> Traffic {
        *self.traffic.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
