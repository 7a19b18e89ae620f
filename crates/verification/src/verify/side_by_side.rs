//! Work on several cores that is not rayon's: the scenes of a suite have its threads already, and one of them must not take up another suite while it waits.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::hold;

/// What `work` makes of each item, in the order of the items. The last ones are begun first.
pub fn side_by_side<T: Sync, R: Send>(items: &[T], threads: usize, work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let left = AtomicUsize::new(items.len());
    let places: Vec<Mutex<Option<R>>> = items.iter().map(|_| Mutex::default()).collect();
    let take = || left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |count| count.checked_sub(1)).ok();
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some(count) = take() {
                    let result = work(&items[count - 1]);
                    *hold(&places[count - 1]) = Some(result);
                }
            });
        }
    });
    places.iter().filter_map(|place| hold(place).take()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_the_order_of_the_items() {
        let items: Vec<usize> = (0..50).collect();
        for threads in [0, 1, 3] {
            assert_eq!(
                side_by_side(&items, threads, |item| item * item),
                items.iter().map(|k| k * k).collect::<Vec<_>>()
            );
        }
        assert!(side_by_side(&[] as &[usize], 2, |item| *item).is_empty());
    }
}
