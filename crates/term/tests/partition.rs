//! Elements divided among ranks: sizes, places, order.
use proptest::prelude::*;
use stoss_term::bisect;

fn sizes(part_of: &[u32], weights: &[u64], parts: usize) -> Vec<u64> {
    let mut sizes = vec![0; parts];
    part_of.iter().zip(weights).for_each(|(&part, weight)| sizes[part as usize] += weight);
    sizes
}

#[test]
fn a_bar_is_cut_across() {
    // 8 x 2 x 1 elements in four parts: slices of two by two, cut across the length.
    let centres: Vec<[f64; 3]> = (0..16).map(|k| [f64::from(k / 2), f64::from(k % 2), 0.5]).collect();
    assert_eq!(bisect(&centres, &[1; 16], 4), [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]);
    // An element as heavy as all others has a half for itself.
    let mut weights = [1; 16];
    weights[0] = 15;
    assert_eq!(bisect(&centres, &weights, 2)[..3], [0, 1, 1]);
    assert_eq!(sizes(&bisect(&centres, &weights, 2), &weights, 2), [15, 15]);
}

#[test]
fn elements_at_one_place_go_by_their_numbers() {
    let centres = [[0.0, 2.0, -1.0], [-0.0, 2.0, -1.0], [0.0, 2.0, -1.0], [-0.0, 2.0, -1.0], [0.0, 2.0, -1.0]];
    assert_eq!(bisect(&centres, &[3; 5], 2), [0, 0, 0, 1, 1]);
    assert_eq!(bisect(&centres, &[0; 5], 3).len(), 5);
    assert_eq!(bisect(&[], &[], 3), []);
    assert_eq!(bisect(&centres, &[7; 5], 0), [0; 5]);
    let alone = bisect(&centres, &[7; 5], 40);
    assert!(sizes(&alone, &[1; 5], 40).iter().all(|&size| size <= 1));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    /// Places on a coarse grid, so that many coordinates are equal.
    #[test]
    fn parts_weigh_the_same_up_to_an_element(
        cells in prop::collection::vec(([0i8..4, 0i8..4, 0i8..3], 0u64..1000), 0..60),
        parts in 1usize..20,
        turn in 0usize..60,
    ) {
        let centres: Vec<[f64; 3]> = cells.iter().map(|(x, _)| x.map(|x| 0.1 * f64::from(x) - 0.1)).collect();
        let weights: Vec<u64> = cells.iter().map(|(_, weight)| *weight).collect();
        let part_of = bisect(&centres, &weights, parts);
        let (total, largest) = (weights.iter().sum::<u64>(), weights.iter().copied().max().unwrap_or(0));
        for size in sizes(&part_of, &weights, parts) {
            let off = (size * parts as u64).abs_diff(total);
            prop_assert!(off < largest * parts as u64 || off == 0, "{size} of {total} in {parts}");
        }
        let equal = sizes(&bisect(&centres, &vec![1; cells.len()], parts), &vec![1; cells.len()], parts);
        prop_assert!(equal.iter().max().unwrap() - equal.iter().min().unwrap() <= 1, "{equal:?}");
        // Where no two coordinates are equal the order of the list is of no account.
        let apart = |k: usize| centres[k].map(|x| x + 1e-3 * (k + 1) as f64);
        let listed = |from: usize| -> Vec<u32> {
            let order = || (0..cells.len()).map(|k| (k + from) % cells.len());
            let (places, weights) = (order().map(apart).collect::<Vec<_>>(), order().map(|k| weights[k]).collect::<Vec<_>>());
            bisect(&places, &weights, parts)
        };
        let mut turned = listed(turn);
        turned.rotate_right(turn % cells.len().max(1));
        prop_assert_eq!(turned, listed(0));
    }
}
