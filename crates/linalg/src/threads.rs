//! Threads of one process that behave as ranks: all of a distributed run without MPI.

use crate::{Communicator, Traffic};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// A rank that is a thread. When a rank is dropped before the others are done, as by a panic, the others panic where they wait for it.
#[derive(Debug)]
pub struct Threads {
    rank: usize,
    board: Arc<Board>,
    traffic: Mutex<Traffic>,
}

/// Where the ranks put what they give.
#[derive(Debug)]
struct Board {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct State {
    posts: Vec<Option<Post>>,
    /// Ranks that have read the present posts.
    readers: usize,
    /// A rank that is gone.
    gone: Option<usize>,
}

#[derive(Debug, Default)]
struct Post {
    values: Vec<f64>,
    counts: Vec<usize>,
    bytes: Vec<u8>,
}

impl Threads {
    /// Communicators of so many ranks, in their order, one for each thread.
    pub fn ranks(size: usize) -> Vec<Arc<dyn Communicator>> {
        let state = State { posts: (0..size).map(|_| None).collect(), ..State::default() };
        let board = Arc::new(Board { state: Mutex::new(state), changed: Condvar::new() });
        let of = |rank| Self { rank, board: board.clone(), traffic: Mutex::default() };
        (0..size).map(|rank| Arc::new(of(rank)) as Arc<dyn Communicator>).collect()
    }

    /// Calls with the communicator of each rank on a thread of its own; returns what they return, in the order of the ranks.
    ///
    /// # Panics
    /// If one of them does, with its panic.
    pub fn run<T: Send>(size: usize, of_rank: impl Fn(Arc<dyn Communicator>) -> T + Sync) -> Vec<T> {
        let of_rank = &of_rank;
        std::thread::scope(|scope| {
            let start = |rank| scope.spawn(move || of_rank(rank));
            let handles: Vec<_> = Self::ranks(size).into_iter().map(start).collect();
            let results: Vec<_> = handles.into_iter().map(std::thread::ScopedJoinHandle::join).collect();
            // The others say that a rank is gone: the first cause is of more use.
            let is_cause = |panic: &Box<dyn std::any::Any + Send>| {
                !panic.downcast_ref::<String>().is_some_and(|text| text.starts_with(GONE))
            };
            let (mut found, mut cause) = (Vec::new(), None);
            for result in results {
                match result {
                    Ok(value) => found.push(value),
                    Err(panic) if cause.is_none() || is_cause(&panic) => cause = Some(panic),
                    Err(_) => {}
                }
            }
            match cause {
                Some(panic) => std::panic::resume_unwind(panic),
                None => found,
            }
        })
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.board.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait(&self, until: impl Fn(&State) -> bool) -> MutexGuard<'_, State> {
        let mut state = self.lock();
        while !until(&state) {
            if let Some(gone) = state.gone {
                drop(state);
                // The rank that is gone has said why.
                std::panic::resume_unwind(Box::new(format!("{GONE} {gone} while rank {} waits for it", self.rank)));
            }
            state = self.board.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state
    }

    /// Posts something, waits for all, reads.
    fn meet<T>(&self, mine: Post, read: impl FnOnce(&[Option<Post>]) -> T) -> T {
        // Those who are slow may still read what was posted last.
        self.wait(|state| state.posts[self.rank].is_none()).posts[self.rank] = Some(mine);
        self.board.changed.notify_all();
        let mut state = self.wait(|state| state.posts.iter().all(Option::is_some));
        let result = read(&state.posts);
        state.readers += 1;
        if state.readers == state.posts.len() {
            state.readers = 0;
            state.posts.iter_mut().for_each(|post| *post = None);
            self.board.changed.notify_all();
        }
        result
    }

    fn count(&self, received: impl Iterator<Item = usize>) {
        self.traffic.lock().unwrap_or_else(PoisonError::into_inner).count(self.rank, received);
    }
}

/// What a rank says that has waited for one that is gone.
const GONE: &str = "there is no rank";

impl Drop for Threads {
    fn drop(&mut self) {
        self.lock().gone = Some(self.rank);
        self.board.changed.notify_all();
    }
}

impl Communicator for Threads {
    fn rank(&self) -> usize {
        self.rank
    }
    fn size(&self) -> usize {
        self.lock().posts.len()
    }
    fn gather(&self, mine: &[f64], counts: &[usize], all: &mut [f64]) {
        assert_eq!(mine.len(), counts[self.rank], "length of what rank {} gives", self.rank);
        self.count(counts.iter().map(|n| 8 * n));
        self.meet(Post { values: mine.to_vec(), ..Post::default() }, |posts| {
            let mut at = 0;
            for (post, &count) in posts.iter().flatten().zip(counts) {
                all[at..at + count].copy_from_slice(&post.values);
                at += count;
            }
        });
    }
    fn exchange(&self, send: &[f64], send_counts: &[usize], receive: &mut [f64], receive_counts: &[usize]) {
        self.count(receive_counts.iter().map(|n| 8 * n));
        let mine = Post { values: send.to_vec(), counts: send_counts.to_vec(), ..Post::default() };
        self.meet(mine, |posts| {
            let mut at = 0;
            for (post, &count) in posts.iter().flatten().zip(receive_counts) {
                let first: usize = post.counts[..self.rank].iter().sum();
                assert_eq!(post.counts[self.rank], count, "length of what rank {} expects", self.rank);
                receive[at..at + count].copy_from_slice(&post.values[first..first + count]);
                at += count;
            }
        });
    }
    fn gather_bytes(&self, mine: &[u8]) -> Vec<Vec<u8>> {
        let mine = Post { bytes: mine.to_vec(), ..Post::default() };
        let all: Vec<Vec<u8>> =
            self.meet(mine, |posts| posts.iter().flatten().map(|post| post.bytes.clone()).collect());
        self.count(all.iter().map(Vec::len));
        all
    }
    fn traffic(&self) -> Traffic {
        *self.traffic.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
