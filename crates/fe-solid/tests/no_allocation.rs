//! The element loop allocates nothing once its workspace is warm.
#![allow(
    unsafe_code,
    reason = "a global allocator is an unsafe trait; this one only counts and hands over to the system's"
)]
mod common;
use common::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use stoss_fe_solid::{ForceRule, SolidStep, TangentTarget, Workspace};
use stoss_reference_element::{CellKind, Integration};

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Whether this thread assembles: the test harness, which has threads of its own, allocates while it starts the test.
    static COUNTED: Cell<bool> = const { Cell::new(false) };
}

fn count() {
    if COUNTED.try_with(Cell::get) == Ok(true) {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
    }
}

// SAFETY: every call is handed over unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    // SAFETY: as the trait demands of the caller.
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: the caller's layout.
        unsafe { System.alloc(layout) }
    }
    // SAFETY: as the trait demands of the caller.
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the block came from the same allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
    // SAFETY: as the trait demands of the caller.
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: the block came from the same allocator.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// One test only in this binary: the counter sees all threads that assemble.
#[test]
fn assembly_allocates_nothing_once_warm() {
    COUNTED.set(true);
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    let mesh = distorted_block([6, 5, 5], 0.1, 1);
    assert!(ALLOCATIONS.load(Ordering::Relaxed) > before, "the counter counts");
    COUNTED.set(false);
    // Averages within elements and at nodes; cells of other sizes.
    let of_kind = |kind, divisions| cells(&[kind], divisions, 0.1, 0.0, 1);
    let others = [of_kind(CellKind::Tet4, [3, 3, 3]), of_kind(CellKind::Hex27, [3, 3, 2])];
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.start_handler(|_| COUNTED.set(true)).build().unwrap();
        let mixed = |mesh| mixed_body(mesh, &stiff_laws(1e3)[1], Integration::Full);
        let all = laws().into_iter().map(|law| (&mesh, body(&mesh, &law)));
        for (mesh, mut body) in all.chain([&mesh, &others[0], &others[1]].map(|mesh| (mesh, mixed(mesh)))) {
            let law = format!("{} {:?}", body.law().name(), mesh.elements.kinds());
            let mut random = Random(2);
            let q_n = random.perturbed(&positions(mesh), 0.02);
            let q_np1 = random.perturbed(&q_n, 0.02);
            let (pattern, map) = pattern(&body, q_n.len());
            let (mut force, mut values) = (vec![0.0; q_n.len()], vec![0.0; pattern.nnz()]);
            let mut workspace = Workspace::default();
            pool.install(|| {
                for rule in [
                    ForceRule::Configuration { theta: 0.0 },
                    ForceRule::END_POINT,
                    ForceRule::MIDPOINT,
                    ForceRule::DiscreteGradient,
                ] {
                    body.begin_step(&q_n, rule, 1.0).unwrap();
                    let step = SolidStep { q_n: &q_n, q_np1: &q_np1, rule };
                    let mut assemble = || {
                        let target = TangentTarget { map: &map, first_stencil: 0, factor: 1.0, values: &mut values };
                        body.assemble(step, 1.0, &mut force, Some(target), &mut workspace).unwrap();
                        body.assemble(step, 1.0, &mut force, None, &mut workspace).unwrap();
                    };
                    assemble();
                    // An allocation of ours comes back in every call; the pool allocates when a thread first steals.
                    let mut of_one_call = || {
                        let warm = ALLOCATIONS.load(Ordering::Relaxed);
                        assemble();
                        ALLOCATIONS.load(Ordering::Relaxed) - warm
                    };
                    let least = (0..if threads == 1 { 1 } else { 10 }).map(|_| of_one_call()).min();
                    assert_eq!(least, Some(0), "{law} {rule:?} {threads} threads");
                    // A later step reuses the history.
                    let warm = ALLOCATIONS.load(Ordering::Relaxed);
                    body.begin_step(&q_n, rule, 1.0).unwrap();
                    assert_eq!(ALLOCATIONS.load(Ordering::Relaxed) - warm, 0);
                }
            });
        }
    }
}
