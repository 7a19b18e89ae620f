//! Systems written to files and read again; a solver that shows what it solves.

use crate::common::tangents::{Setting, block_pair};
use std::sync::Arc;
use std::sync::mpsc::channel;
use stoss_linalg::matrix_market::{SystemFileError, read_system, write_system};
use stoss_linalg::{LinearSolver, MatrixKind, MultifrontalSolver, RecordingSolver, SparsityPattern};

fn folder(name: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("stoss-linalg-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn a_system_is_read_as_it_was_written() {
    let folder = folder("round-trip");
    let file = folder.join("system.mtx");
    for unsymmetric in [true, false] {
        let (mut a, mut b) = block_pair(2, Setting::new(unsymmetric));
        b[0] = 0.1 + 0.2;
        // With and without multipliers that are told from displacements.
        let first = if unsymmetric { a.n() } else { 30 };
        a.pattern = Arc::new(SparsityPattern::clone(&a.pattern).with_first_multiplier(first));
        write_system(&file, &a.pattern, &a.values, &b).unwrap();
        let read = read_system(&file).unwrap();
        assert_eq!(read.matrix.pattern, a.pattern);
        assert_eq!((read.matrix.values, read.rhs), (a.values, b));
    }
    // What others write: comments, no order, an entry in two parts, a pattern that is not symmetric, no groups.
    std::fs::remove_file(folder.join("system-groups.mtx")).unwrap();
    let text = "%%MatrixMarket matrix coordinate real general\n% by hand\n\n2 2 3\n2 1 1.5\n1 1 1\n2 1 -0.5\n";
    std::fs::write(&file, text).unwrap();
    std::fs::write(folder.join("system-rhs.mtx"), "%%MatrixMarket matrix array real general\n2 1\n3\n-4e-1\n").unwrap();
    let read = read_system(&file).unwrap();
    assert_eq!([read.matrix.get(0, 0), read.matrix.get(1, 0), read.matrix.get(0, 1)], [1.0, 1.0, 0.0]);
    assert_eq!(read.rhs, [3.0, -0.4]);
    for (bad, line) in [
        ("%%MatrixMarket matrix coordinate complex general\n1 1 0\n", 1),
        ("%%MatrixMarket matrix coordinate real general\n2 3 0\n", 2),
        ("%%MatrixMarket matrix coordinate real general\n1 1 1\n2 1 1.0\n", 3),
        ("%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 x\n", 3),
        ("%%MatrixMarket matrix coordinate real general\n1 1 1\n", 3),
        ("%%MatrixMarket matrix coordinate real general\n1 1\n", 2),
    ] {
        std::fs::write(&file, bad).unwrap();
        match read_system(&file) {
            Err(SystemFileError::Format { line: found, .. }) => assert_eq!(found, line, "{bad}"),
            other => panic!("{bad}: {other:?}"),
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_recording_solver_shows_each_factorised_system_once_and_changes_nothing() {
    let (a, b) = block_pair(3, Setting::new(true));
    let (sender, receiver) = channel();
    let mut left = 2;
    let recorder = Box::new(move |system: stoss_linalg::SolvedSystem<'_>| {
        left -= 1;
        sender.send((system.kind, system.values.to_vec(), system.rhs.to_vec())).unwrap();
        left > 0
    });
    let mut recording = RecordingSolver::new(Box::new(MultifrontalSolver::new()), recorder);
    let mut plain = MultifrontalSolver::new();
    let twice: Vec<f64> = a.values.iter().map(|v| 2.0 * v).collect();
    for values in [&a.values, &twice, &a.values] {
        let solutions = [&mut recording as &mut dyn LinearSolver, &mut plain].map(|solver| {
            let mut x = vec![0.0; b.len()];
            solver.analyse(&a.pattern, MatrixKind::General).unwrap();
            solver.factorise(values).unwrap();
            solver.solve(&b, &mut x).unwrap();
            solver.solve(&b, &mut x).unwrap();
            x
        });
        assert_eq!(solutions[0], solutions[1]);
    }
    assert_eq!(recording.statistics(), plain.statistics());
    let shown: Vec<_> = receiver.iter().take(2).collect();
    assert_eq!(shown[0], (MatrixKind::General, a.values, b.clone()));
    assert_eq!(shown[1], (MatrixKind::General, twice, b));
    assert!(receiver.try_recv().is_err());
}
