//! Elements, or what else has places and weights, divided among ranks. Not what a rank does with its part, not connectivity.

/// The part of each element by recursive bisection: elements are ordered along the longest side of the box around their centres and cut in two by their weights, then each half again,
/// until there is one list for each of the `parts` (0 counts as 1). `centres`: a length; `weights`: the work of each element in any unit.
///
/// The weight of each part differs from the mean by less than the largest weight of an element, so that equal weights give numbers of elements that differ by one at most. Parts may be
/// empty, and are if there are fewer elements. Of equal coordinates the element with the smaller number comes first, and weights are summed as whole numbers: the parts are the same on every machine.
///
/// # Panics
/// If there is not one weight for each centre; this is a programming error.
pub fn bisect(centres: &[[f64; 3]], weights: &[u64], parts: usize) -> Vec<u32> {
    assert_eq!(centres.len(), weights.len(), "a weight for each centre");
    let mut elements: Vec<u32> = (0..centres.len() as u32).collect();
    let parts = parts.max(1) as i128;
    let total = weights.iter().map(|&weight| i128::from(weight)).sum();
    let mut part_of = vec![0; centres.len()];
    Bisection { centres, weights, parts, total }.divide(&mut elements, 0, parts, &mut part_of);
    part_of
}

struct Bisection<'a> {
    centres: &'a [[f64; 3]],
    weights: &'a [u64],
    /// Number and weight of all parts.
    parts: i128,
    total: i128,
}

impl Bisection<'_> {
    /// Divides elements among `parts` parts from `first` on.
    fn divide(&self, elements: &mut [u32], first: u32, parts: i128, part_of: &mut [u32]) {
        if parts == 1 {
            elements.iter().for_each(|&element| part_of[element as usize] = first);
            return;
        }
        if elements.is_empty() {
            return;
        }
        let axis = self.longest_side(elements);
        // Zero has one sign.
        let at = |element: u32| self.centres[element as usize][axis] + 0.0;
        elements.sort_unstable_by(|&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        let left = parts / 2;
        let cut = self.cut(elements, left, parts);
        let (before, behind) = elements.split_at_mut(cut);
        self.divide(before, first, left, part_of);
        self.divide(behind, first + left as u32, parts - left, part_of);
    }

    /// How many of the elements `left` of their `parts` parts get.
    ///
    /// With the mean `m` of all parts, these elements weigh `parts m + e`; the cut is nearest to `left m + e / 2`. So `|e|` of a half is at most that of the whole and the largest
    /// weight, halved, and by induction less than the largest weight.
    fn cut(&self, elements: &[u32], left: i128, parts: i128) -> usize {
        let weight = |element: &u32| i128::from(self.weights[*element as usize]);
        let own: i128 = elements.iter().map(weight).sum();
        // Times twice the number of all parts, whole numbers.
        let target = 2 * left * self.total + (own * self.parts - parts * self.total);
        let mut sum = 0;
        for (count, element) in elements.iter().enumerate() {
            let next = sum + 2 * self.parts * weight(element);
            if next - target > target - sum {
                return count;
            }
            sum = next;
        }
        elements.len()
    }

    fn longest_side(&self, elements: &[u32]) -> usize {
        let extent = |axis: usize| {
            let along = elements.iter().map(|&element| self.centres[element as usize][axis]);
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            high - low
        };
        let [x, y, z] = std::array::from_fn(extent);
        if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        }
    }
}
