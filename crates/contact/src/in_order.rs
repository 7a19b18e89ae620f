//! Contributions that all threads compute and that are handed out in their order.

use rayon::prelude::*;

/// Contributions that are computed before they are handed out, for each thread.
const AT_ONCE: usize = 16;

/// Computes something of each item in a room, on all threads of rayon's current pool, and hands the rooms out one after the other in the order of the items: sums that `visit` makes have the same bits
/// for any number of threads. A room is `R::default()` at first and serves several items; with one thread there is one, and each item is visited before the next is computed.
///
/// # Errors
/// The one of the first item, in order, that has one. All before it have been visited, and none behind it.
pub fn in_order<T: Sync, R: Default + Send, E: Send>(
    items: &[T],
    compute: impl Fn(&T, &mut R) -> Result<(), E> + Sync,
    mut visit: impl FnMut(&T, &mut R),
) -> Result<(), E> {
    let threads = rayon::current_num_threads();
    if threads == 1 || items.len() <= 1 {
        let mut room = R::default();
        for item in items {
            compute(item, &mut room)?;
            visit(item, &mut room);
        }
        return Ok(());
    }
    let mut rooms: Vec<(R, Result<(), E>)> = Vec::new();
    rooms.resize_with((AT_ONCE * threads).min(items.len()), || (R::default(), Ok(())));
    for some in items.chunks(rooms.len()) {
        let rooms = &mut rooms[..some.len()];
        rooms.par_iter_mut().zip(some).for_each(|((room, done), item)| *done = compute(item, room));
        for ((room, done), item) in rooms.iter_mut().zip(some) {
            std::mem::replace(done, Ok(()))?;
            visit(item, room);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One, two and three threads hand out the same in the same order, and stop at the same item.
    #[test]
    fn threads_change_neither_order_nor_error() {
        let items: Vec<u32> = (0..200).collect();
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let seen_until = |failing: u32| {
                let mut seen = Vec::new();
                let compute = |&item: &u32, room: &mut u32| {
                    *room = item * item;
                    if item >= failing { Err(item) } else { Ok(()) }
                };
                let result = pool.install(|| in_order(&items, compute, |item, square| seen.push((*item, *square))));
                (seen, result)
            };
            let squares = |n: u32| (0..n).map(|k| (k, k * k)).collect::<Vec<_>>();
            assert_eq!(seen_until(u32::MAX), (squares(200), Ok(())));
            assert_eq!(seen_until(77), (squares(77), Err(77)));
        }
    }
}
