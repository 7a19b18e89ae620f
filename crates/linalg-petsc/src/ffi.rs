//! The C side, made safe: lengths are checked, calls come from one thread at a time, and nothing is called before the start or after the end.
#![allow(unsafe_code, reason = "the only module with foreign functions")]

use std::ffi::{CStr, CString, c_char, c_double, c_int, c_uchar, c_void};
use std::ptr::NonNull;
use std::sync::{Mutex, MutexGuard, PoisonError};

unsafe extern "C" {
    fn sp_error() -> *const c_char;
    fn sp_start() -> c_int;
    fn sp_end() -> c_int;
    fn sp_rank() -> c_int;
    fn sp_size() -> c_int;
    fn sp_abort(code: c_int);
    fn sp_options(text: *const c_char) -> c_int;
    fn sp_unused(prefix: *const c_char, text: *mut c_char, length: usize) -> c_int;
    fn sp_gather(
        mine: *const c_double,
        count: c_int,
        all: *mut c_double,
        counts: *const c_int,
        starts: *const c_int,
    ) -> c_int;
    fn sp_gather_bytes(
        mine: *const c_uchar,
        count: c_int,
        all: *mut c_uchar,
        counts: *const c_int,
        starts: *const c_int,
    ) -> c_int;
    fn sp_gather_int(mine: c_int, all: *mut c_int) -> c_int;
    fn sp_exchange(
        send: *const c_double,
        send_counts: *const c_int,
        receive: *mut c_double,
        receive_counts: *const c_int,
    ) -> c_int;
    fn sp_create(
        rows: c_int,
        block: c_int,
        entries: isize,
        i: *mut c_int,
        j: *mut c_int,
        symmetric: c_int,
        motions: c_int,
        values: *const c_double,
        out: *mut *mut c_void,
    ) -> c_int;
    fn sp_destroy(system: *mut c_void) -> c_int;
    fn sp_values(system: *mut c_void, values: *const c_double) -> c_int;
    fn sp_engine(system: *mut c_void, engine: c_int, prefix: *const c_char) -> c_int;
    fn sp_set_up(system: *mut c_void, engine: c_int, failure: *mut c_int) -> c_int;
    fn sp_pivots(system: *mut c_void, engine: c_int, null_pivots: *mut c_int, negative: *mut c_int) -> c_int;
    fn sp_solve(
        system: *mut c_void,
        engine: c_int,
        tolerance: c_double,
        b: *const c_double,
        x: *mut c_double,
        numbers: *mut c_int,
    ) -> c_int;
    fn sp_residual(
        system: *mut c_void,
        b: *const c_double,
        x: *const c_double,
        r: *mut c_double,
        norms: *mut c_double,
    ) -> c_int;
    fn sp_reason(reason: c_int) -> *const c_char;
    fn sp_is_indefinite(reason: c_int) -> c_int;
    fn sp_memory(system: *mut c_void, bytes: *mut c_double) -> c_int;
}

/// Whether MPI and PETSc may be called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Life {
    Before,
    Running,
    Over,
}

static LIFE: Mutex<Life> = Mutex::new(Life::Before);

fn lock() -> MutexGuard<'static, Life> {
    LIFE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The lock of a call, which needs MPI.
///
/// # Panics
/// Before the start and after the end.
fn running() -> MutexGuard<'static, Life> {
    let life = lock();
    assert!(*life == Life::Running, "MPI is not running");
    life
}

/// The text of an error of PETSc.
fn told(code: c_int) -> Result<(), String> {
    if code == 0 {
        return Ok(());
    }
    // SAFETY: a static text with an end, which is not written to while the lock of the call is held.
    let text = unsafe { CStr::from_ptr(sp_error()) }.to_string_lossy().into_owned();
    Err(if text.is_empty() { format!("error {code} of PETSc") } else { text })
}

/// Starts MPI and PETSc, and returns rank and number of ranks.
pub fn start() -> Result<(usize, usize), String> {
    let mut life = lock();
    if *life != Life::Before {
        return Err("MPI cannot be started twice".to_owned());
    }
    // SAFETY: the first call, under the lock.
    told(unsafe { sp_start() })?;
    *life = Life::Running;
    // SAFETY: MPI has started.
    Ok(unsafe { (sp_rank() as usize, sp_size() as usize) })
}

/// Ends MPI and PETSc, if they run.
pub fn end() {
    let mut life = lock();
    if *life == Life::Running {
        *life = Life::Over;
        // SAFETY: MPI runs, and nothing is called after it.
        unsafe { sp_end() };
    }
}

/// Ends all ranks with one message. Needs no lock: it may be called while another call waits for a rank that will never come.
pub fn abort(message: &str) -> ! {
    // SAFETY: both functions only read what MPI has known since its start; `MPI_Abort` may be called at any time.
    unsafe {
        eprintln!("error: rank {} of {}: {message}; all ranks end", sp_rank(), sp_size());
        sp_abort(1);
    }
    std::process::abort()
}

/// A count as MPI takes it; a message that is too large ends the program.
fn int(count: usize) -> c_int {
    c_int::try_from(count).unwrap_or_else(|_| abort("a message has 2^31 numbers or more, which MPI cannot count"))
}

/// Counts as MPI counts, and where the piece of each rank begins.
fn pieces(counts: impl Iterator<Item = usize>) -> (Vec<c_int>, Vec<c_int>) {
    let mut sum = 0;
    let of = |count: usize| {
        let start = int(sum);
        sum += count;
        (int(count), start)
    };
    let pieces = counts.map(of).unzip();
    int(sum);
    pieces
}

fn check(code: c_int, what: &str) {
    if code != 0 {
        abort(&format!("{what} failed with the code {code} of MPI"));
    }
}

/// All pieces, one behind the other, of the lengths `counts`.
pub fn gather(mine: &[f64], rank: usize, counts: &[usize], all: &mut [f64]) {
    assert!(mine.len() == counts[rank] && all.len() == counts.iter().sum::<usize>(), "lengths of a gather");
    let (counts, starts) = pieces(counts.iter().copied());
    let _life = running();
    // SAFETY: `counts` has an entry for each rank (asserted by the caller), their sum is the length of `all`, and `mine` is as long as this rank's.
    let code = unsafe { sp_gather(mine.as_ptr(), int(mine.len()), all.as_mut_ptr(), counts.as_ptr(), starts.as_ptr()) };
    check(code, "a gather");
}

/// What each of `size` ranks gives.
pub fn gather_bytes(mine: &[u8], size: usize) -> Vec<Vec<u8>> {
    let count = int(mine.len());
    let mut counts = vec![0; size];
    let _life = running();
    // SAFETY: one number from each rank.
    check(unsafe { sp_gather_int(count, counts.as_mut_ptr()) }, "a gather");
    let (counts, starts) = pieces(counts.iter().map(|&count| count as usize));
    let mut all = vec![0_u8; counts.iter().map(|&count| count as usize).sum()];
    // SAFETY: `all` has room for as many bytes as the ranks have announced.
    let code = unsafe { sp_gather_bytes(mine.as_ptr(), count, all.as_mut_ptr(), counts.as_ptr(), starts.as_ptr()) };
    check(code, "a gather");
    let piece = |(&start, &count): (&c_int, &c_int)| all[start as usize..(start + count) as usize].to_vec();
    starts.iter().zip(&counts).map(piece).collect()
}

/// Sends pieces to the ranks and receives theirs.
pub fn exchange(send: &[f64], send_counts: &[usize], receive: &mut [f64], receive_counts: &[usize], rank: usize) {
    let fits = |data: usize, counts: &[usize]| data == counts.iter().sum::<usize>();
    assert!(fits(send.len(), send_counts) && fits(receive.len(), receive_counts), "lengths of an exchange");
    assert_eq!(send_counts[rank], receive_counts[rank], "what a rank sends to itself it receives");
    let ((to, _), (from, _)) = (pieces(send_counts.iter().copied()), pieces(receive_counts.iter().copied()));
    let _life = running();
    // SAFETY: both lists have an entry for each rank (asserted by the caller), and their sums are the lengths of the data.
    let code = unsafe { sp_exchange(send.as_ptr(), to.as_ptr(), receive.as_mut_ptr(), from.as_ptr()) };
    check(code, "an exchange");
}

fn c_string(text: &str) -> Result<CString, String> {
    CString::new(text).map_err(|error| error.to_string())
}

/// Adds options to those of PETSc.
pub fn insert_options(text: &str) -> Result<(), String> {
    let text = c_string(text)?;
    let _life = running();
    // SAFETY: a text with an end.
    told(unsafe { sp_options(text.as_ptr()) })
}

/// Names of the options with this prefix that nothing has asked for so far.
pub fn unused_options(prefix: &str) -> Result<Vec<String>, String> {
    let prefix = c_string(prefix)?;
    let mut text: Vec<c_char> = vec![0; 4096];
    let _life = running();
    // SAFETY: the text is written with its end into as many bytes as there are.
    told(unsafe { sp_unused(prefix.as_ptr(), text.as_mut_ptr(), text.len()) })?;
    // SAFETY: as above.
    let text = unsafe { CStr::from_ptr(text.as_ptr()) }.to_string_lossy().into_owned();
    Ok(text.split_whitespace().map(str::to_owned).collect())
}

/// How factors or a preconditioner were not made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A pivot that is zero.
    Singular,
    /// A lack of memory.
    Memory,
    /// Something else.
    Other,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Singular => "a pivot is zero",
            Self::Memory => "there is not enough memory; give the run more ranks or machines",
            Self::Other => "PETSc gives no reason",
        })
    }
}

/// End of a solution.
#[derive(Clone, Debug)]
pub struct Ended {
    /// Why, in PETSc's words.
    pub reason: String,
    /// Whether the tolerance is reached, as the solver sees it.
    pub has_converged: bool,
    /// Whether a direction of negative curvature was met.
    pub is_indefinite: bool,
    /// Iterations.
    pub iterations: u64,
}

/// Accuracy of a solution.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// 2-norm of the residual over that of the right-hand side.
    pub residual: f64,
    /// Largest entry of the residual over `|A| |x| + |b|`, in norms of largest entries.
    pub backward_error: f64,
}

/// A matrix with its solvers, each of which has a number below [`System::ENGINES`].
#[derive(Debug)]
pub struct System {
    pointer: NonNull<c_void>,
    rows: usize,
    entries: usize,
    engines: [bool; System::ENGINES],
}

// SAFETY: every use is under the lock of the module; PETSc's objects belong to no thread.
unsafe impl Send for System {}

impl Drop for System {
    fn drop(&mut self) {
        // After the end PETSc has given all back.
        let life = lock();
        if *life == Life::Running {
            // SAFETY: made by `sp_create`, and destroyed once.
            unsafe { sp_destroy(self.pointer.as_ptr()) };
        }
    }
}

impl System {
    /// Solvers of a matrix.
    pub const ENGINES: usize = 2;

    /// A matrix with `rows` rows of this rank, in blocks of `block`, and entries at `(i, j)`, which may be in the rows of other ranks; several at a place are summed. `motions`: rigid motions,
    /// `rows` numbers each, one after the other.
    pub fn new(
        rows: usize,
        block: usize,
        (mut i, mut j): (Vec<i32>, Vec<i32>),
        is_symmetric: bool,
        motions: &[f64],
    ) -> Result<Self, String> {
        let entries = i.len();
        let count = motions.len().checked_div(rows).unwrap_or(if block == 3 { 6 } else { 0 });
        assert!(entries == j.len() && motions.len() == count * rows, "lengths of a matrix");
        let mut pointer = std::ptr::null_mut();
        let _life = running();
        // SAFETY: `i` and `j` have `entries` numbers, which PETSc may change, `motions` has `count` times `rows`.
        told(unsafe {
            sp_create(
                int(rows),
                int(block),
                entries as isize,
                i.as_mut_ptr(),
                j.as_mut_ptr(),
                is_symmetric as c_int,
                int(count),
                motions.as_ptr(),
                &raw mut pointer,
            )
        })?;
        let pointer = NonNull::new(pointer).ok_or("no matrix was made")?;
        Ok(Self { pointer, rows, entries, engines: [false; Self::ENGINES] })
    }

    /// Values of the entries, in their order; those before are forgotten.
    pub fn set_values(&mut self, values: &[f64]) -> Result<(), String> {
        assert_eq!(values.len(), self.entries, "values of a matrix");
        let _life = running();
        // SAFETY: as many values as entries.
        told(unsafe { sp_values(self.pointer.as_ptr(), values.as_ptr()) })
    }

    /// Whether a solver was made.
    pub fn has_engine(&self, engine: usize) -> bool {
        self.engines[engine]
    }

    /// Has a solver made anew before it is used again.
    pub fn remake(&mut self, engine: usize) {
        self.engines[engine] = false;
    }

    /// Makes a solver with the options of a prefix.
    pub fn add_engine(&mut self, engine: usize, prefix: &str) -> Result<(), String> {
        let prefix = c_string(prefix)?;
        let _life = running();
        // SAFETY: a number below ENGINES (the index above), a text with an end.
        told(unsafe { sp_engine(self.pointer.as_ptr(), engine as c_int, prefix.as_ptr()) })?;
        self.engines[engine] = true;
        Ok(())
    }

    fn assert_has(&self, engine: usize) {
        assert!(self.engines[engine], "the solver {engine} was not made");
    }

    /// Factors, or a preconditioner, of the present values.
    pub fn set_up(&mut self, engine: usize) -> Result<Option<Failure>, String> {
        self.assert_has(engine);
        let mut failure = 0;
        let _life = running();
        // SAFETY: a solver that was made.
        told(unsafe { sp_set_up(self.pointer.as_ptr(), engine as c_int, &raw mut failure) })?;
        Ok(match failure {
            0 => None,
            1 => Some(Failure::Singular),
            2 => Some(Failure::Memory),
            _ => Some(Failure::Other),
        })
    }

    /// Number of pivots of the factors that are zero, and of those that are negative, if they are symmetric.
    pub fn pivots(&self, engine: usize) -> Result<(usize, Option<usize>), String> {
        let (mut zero, mut negative) = (0, -1);
        self.assert_has(engine);
        let _life = running();
        // SAFETY: a solver that was made.
        told(unsafe { sp_pivots(self.pointer.as_ptr(), engine as c_int, &raw mut zero, &raw mut negative) })?;
        Ok((usize::try_from(zero).unwrap_or(0), usize::try_from(negative).ok()))
    }

    /// Solves for the rows of this rank, to a relative residual of `tolerance` if one is given.
    pub fn solve(&mut self, engine: usize, tolerance: Option<f64>, b: &[f64], x: &mut [f64]) -> Result<Ended, String> {
        assert!(b.len() == self.rows && x.len() == self.rows, "lengths of a solution");
        self.assert_has(engine);
        let mut numbers = [0; 2];
        let (pointer, tolerance) = (self.pointer.as_ptr(), tolerance.unwrap_or(0.0));
        let _life = running();
        // SAFETY: a solver that was made, vectors of as many numbers as rows, room for two numbers.
        told(unsafe {
            sp_solve(pointer, engine as c_int, tolerance, b.as_ptr(), x.as_mut_ptr(), numbers.as_mut_ptr())
        })?;
        // SAFETY: a reason that PETSc has given, whose name is a static text.
        let (reason, is_indefinite) = unsafe { (CStr::from_ptr(sp_reason(numbers[0])), sp_is_indefinite(numbers[0])) };
        Ok(Ended {
            reason: reason.to_string_lossy().into_owned(),
            has_converged: numbers[0] > 0,
            is_indefinite: is_indefinite != 0,
            iterations: numbers[1].unsigned_abs().into(),
        })
    }

    /// The residual `r = b - A x` in the rows of this rank, and its size over all of them.
    pub fn residual(&mut self, b: &[f64], x: &[f64], r: &mut [f64]) -> Result<Quality, String> {
        assert!([b.len(), x.len(), r.len()] == [self.rows; 3], "lengths of a residual");
        let mut norms = [0.0; 6];
        let _life = running();
        // SAFETY: vectors of as many numbers as rows, room for six numbers.
        told(unsafe {
            sp_residual(self.pointer.as_ptr(), b.as_ptr(), x.as_ptr(), r.as_mut_ptr(), norms.as_mut_ptr())
        })?;
        let [residual, rhs, largest, solution, largest_rhs, matrix] = norms;
        let over = |value: f64, scale: f64| if scale > 0.0 { value / scale } else { value };
        Ok(Quality { residual: over(residual, rhs), backward_error: over(largest, matrix * solution + largest_rhs) })
    }

    /// Bytes on this rank, as far as PETSc tells.
    pub fn memory_bytes(&self) -> usize {
        let mut bytes = 0.0;
        let life = lock();
        if *life == Life::Running {
            // SAFETY: a system that was made; an error leaves the number as it is.
            unsafe { sp_memory(self.pointer.as_ptr(), &raw mut bytes) };
        }
        bytes as usize
    }
}
