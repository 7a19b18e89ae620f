//! The lock of a result folder.

use super::OutputError;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::Path;
use std::time::Duration;

/// Name of the file that a run locks. It is empty, and stays.
const FILE: &str = "stoss.lock";

/// How often and how long after each other a run tries to lock: [`is_in_use`] holds the lock for an instant.
const TRIALS: usize = 5;
const PAUSE: Duration = Duration::from_millis(10);

/// Whether a run has a folder now. Never where the system has no locks.
pub fn is_in_use(folder: &Path) -> bool {
    // Shared: programs that only look do not see each other. The lock is released with the file.
    let file = File::open(folder.join(FILE));
    file.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// Holds a folder for one run. The system releases it when the process ends, however it ends.
#[derive(Debug)]
pub(super) struct FolderLock(#[expect(dead_code, reason = "the lock lasts as long as the file is open")] File);

impl FolderLock {
    /// Locks a folder, which is created if it does not exist.
    ///
    /// # Errors
    /// [`OutputError::InUse`] if another run has it.
    pub fn take(folder: &Path) -> Result<Self, OutputError> {
        std::fs::create_dir_all(folder).map_err(OutputError::io(folder))?;
        let path = folder.join(FILE);
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
        let file = file.map_err(OutputError::io(&path))?;
        let mut trials = 1;
        let locked = loop {
            match file.try_lock() {
                Err(TryLockError::WouldBlock) if trials < TRIALS => std::thread::sleep(PAUSE),
                other => break other,
            }
            trials += 1;
        };
        match locked {
            Ok(()) => Ok(Self(file)),
            Err(TryLockError::WouldBlock) => Err(OutputError::InUse { path: folder.to_path_buf() }),
            // Some network file systems have no locks; a run is possible there all the same.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(Self(file)),
            Err(TryLockError::Error(error)) => Err(OutputError::io(&path)(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_is_in_use_as_long_as_its_lock_is_held() {
        let folder = tempfile::tempdir().unwrap();
        assert!(!is_in_use(folder.path()));
        let lock = FolderLock::take(folder.path()).unwrap();
        assert!(is_in_use(folder.path()));
        assert!(matches!(FolderLock::take(folder.path()), Err(OutputError::InUse { .. })));
        drop(lock);
        assert!(!is_in_use(folder.path()));
        // Who looks at the same time does not keep a run from starting for long.
        let looking = File::open(folder.path().join(FILE)).unwrap();
        looking.try_lock_shared().unwrap();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                std::thread::sleep(PAUSE);
                drop(looking);
            });
            assert!(FolderLock::take(folder.path()).is_ok());
        });
    }
}
