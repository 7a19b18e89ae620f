//! Checks that any term has to pass, for tests of its author: tangent, promises, order.
//!
//! They see nothing but the trait, at one iterate: whoever calls them has begun the step, and paired what is to be paired. A deviation is a number without unit that is round-off, or as small as the
//! truncation of a difference, if all is well.

use crate::{At, Auxiliary, Fault, Local, Rule, Share, Term};

/// Unknowns of a term: all positions, then the multipliers of its slots, then the auxiliaries that have an equation.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknowns {
    /// `3 * nodes` entries.
    pub positions: Vec<f64>,
    /// Multiplier of each slot.
    pub multipliers: Vec<f64>,
    /// Auxiliaries, slot by slot.
    pub auxiliaries: Vec<f64>,
}

impl Unknowns {
    fn add(&self, factor: f64, direction: &Self) -> Self {
        let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + factor * b).collect();
        Self {
            positions: sum(&self.positions, &direction.positions),
            multipliers: sum(&self.multipliers, &direction.multipliers),
            auxiliaries: sum(&self.auxiliaries, &direction.auxiliaries),
        }
    }

    fn at<'a>(&'a self, at: &At<'a>) -> At<'a> {
        At { q_np1: &self.positions, multipliers: &self.multipliers, auxiliaries: &self.auxiliaries, ..*at }
    }

    fn scaled(&self, factor: f64) -> Self {
        self.zeros().add(factor, self)
    }

    fn zeros(&self) -> Self {
        self.add(-1.0, self)
    }

    fn norm(&self) -> f64 {
        let all = self.positions.iter().chain(&self.multipliers).chain(&self.auxiliaries);
        all.map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Adds `factor * values` in the rows of a contribution.
    fn scatter(&mut self, local: &Local, values: &[f64]) {
        let (positions, rest) = values.split_at(3 * local.nodes.len());
        for (&node, values) in local.nodes.iter().zip(positions.chunks_exact(3)) {
            let first = 3 * node as usize;
            self.positions[first..first + 3].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        let (rows, further) = rest.split_at(local.slots.len());
        local.slots.iter().zip(rows).for_each(|(&slot, row)| self.multipliers[slot as usize] += row);
        let width = local.auxiliaries;
        for (&slot, values) in local.slots.iter().zip(further.chunks_exact(width.max(1))) {
            let own = &mut self.auxiliaries[slot as usize * width..(slot as usize + 1) * width];
            own.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
    }

    fn gather(&self, local: &Local) -> Vec<f64> {
        let nodes =
            local.nodes.iter().flat_map(|&node| self.positions[3 * node as usize..3 * node as usize + 3].iter());
        let slots = local.slots.iter().map(|&slot| &self.multipliers[slot as usize]);
        let width = local.auxiliaries;
        let further =
            local.slots.iter().flat_map(|&slot| &self.auxiliaries[slot as usize * width..(slot as usize + 1) * width]);
        nodes.chain(slots).chain(further).copied().collect()
    }
}

/// The residual of a term.
fn residual(term: &mut dyn Term, at: &At<'_>, like: &Unknowns) -> Result<Unknowns, Fault> {
    term.renew(at, false)?;
    let mut sum = like.zeros();
    term.assemble(at, false, &mut |local| sum.scatter(local, &local.residual))?;
    Ok(sum)
}

/// The tangent of a term against a difference of its residual along one direction (of which the parts of slots that do not act are left out).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivative {
    /// Difference between `K d` and the central difference, over the larger of both.
    pub deviation: f64,
    /// Difference between forward and backward differences over the same: large where a kink is nearer than the distance of the difference, which then says nothing.
    pub kink: f64,
}

/// Compares tangent and residual along `direction` over the distance `h`. Both are zero of a term that has no contribution there.
///
/// # Errors
/// Where the term cannot be evaluated.
pub fn derivative(term: &mut dyn Term, at: &At<'_>, direction: &Unknowns, h: f64) -> Result<Derivative, Fault> {
    let here = Unknowns {
        positions: at.q_np1.to_vec(),
        multipliers: at.multipliers.to_vec(),
        auxiliaries: at.auxiliaries.to_vec(),
    };
    let mut along = direction.clone();
    for (slot, _) in at.active.iter().enumerate().filter(|(_, active)| !**active) {
        along.multipliers[slot] = 0.0;
    }
    term.renew(at, true)?;
    let (mut product, mut count) = (here.zeros(), 0);
    term.assemble(at, true, &mut |local| {
        let d = along.gather(local);
        let rows = local.tangent.chunks_exact(local.dim().max(1));
        let values: Vec<f64> = rows.map(|row| row.iter().zip(&d).map(|(k, d)| k * d).sum()).collect();
        product.scatter(local, &values);
        count += 1;
    })?;
    if count == 0 {
        return Ok(Derivative { deviation: 0.0, kink: 0.0 });
    }
    let middle = residual(term, at, &here)?;
    let mut side = |h: f64| residual(term, &here.add(h, &along).at(at), &here);
    let (plus, minus) = (side(h)?, side(-h)?);
    let difference = plus.add(-1.0, &minus).scaled(0.5 / h);
    let size = product.norm().max(difference.norm()).max(f64::MIN_POSITIVE);
    let bent = plus.add(-2.0, &middle).add(1.0, &minus).norm() / h;
    Ok(Derivative { deviation: product.add(-1.0, &difference).norm() / size, kink: bent / size })
}

/// What a term promises, against what its forces do at an iterate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TermCheck {
    /// Size of the sum of the forces on positions over the sum of their sizes.
    pub resultant: f64,
    /// Size of the sum of the moments about the origin with positions of the middle of the step, directors included, over the sum of forces times distances.
    pub moment: f64,
    /// Largest difference between an entry of a tangent and its mirror image, over the largest entry.
    pub asymmetry: f64,
    /// Work of the forces in the step. Against it stand the energies of [`Term::work`].
    pub work: f64,
    /// Sum of the magnitudes of the products that `work` is the sum of.
    pub work_scale: f64,
    /// Whether a second evaluation has the same bits.
    pub is_pure: bool,
    /// Whether contributions have the nodes and slots that `stencils` names, in its order.
    pub has_order: bool,
}

/// What the forces do at an iterate; `is_direction` tells directors from positions.
///
/// # Errors
/// Where the term cannot be evaluated.
pub fn promises(
    term: &mut dyn Term,
    at: &At<'_>,
    is_direction: &(dyn Fn(u32) -> bool + Sync),
) -> Result<TermCheck, Fault> {
    term.renew(at, true)?;
    let mut stencils = Vec::new();
    term.stencils(at.active, &mut |nodes, slots| stencils.push((nodes.to_vec(), slots.to_vec())));
    let mut found = TermCheck { has_order: true, is_pure: true, ..TermCheck::default() };
    let (mut force, mut moment, mut sizes) = ([0.0; 3], [0.0; 3], [0.0; 2]);
    let (mut asymmetry, mut largest, mut k, mut first) = (0.0_f64, 0.0_f64, 0, Vec::new());
    term.assemble(at, true, &mut |local| {
        found.has_order &= stencils.get(k).is_some_and(|(nodes, slots)| *nodes == local.nodes && *slots == local.slots);
        k += 1;
        first.extend_from_slice(&local.residual);
        for (&node, f) in local.nodes.iter().zip(local.residual.chunks_exact(3)) {
            let x: [f64; 3] =
                std::array::from_fn(|i| 0.5 * (at.q_n[3 * node as usize + i] + at.q_np1[3 * node as usize + i]));
            let size = f[0].hypot(f[1]).hypot(f[2]);
            if !is_direction(node) {
                (0..3).for_each(|i| force[i] += f[i]);
                sizes[0] += size;
            }
            for i in 0..3 {
                let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                moment[i] += x[j] * f[l] - x[l] * f[j];
                let work = f[i] * (at.q_np1[3 * node as usize + i] - at.q_n[3 * node as usize + i]);
                found.work += work;
                found.work_scale += work.abs();
            }
            sizes[1] += size * x[0].hypot(x[1]).hypot(x[2]);
        }
        let dim = local.dim();
        for i in 0..dim {
            for j in 0..dim {
                let (a, b) = (local.tangent[dim * i + j], local.tangent[dim * j + i]);
                asymmetry = asymmetry.max((a - b).abs());
                largest = largest.max(a.abs());
            }
        }
    })?;
    found.has_order &= k == stencils.len();
    let mut second = Vec::new();
    term.assemble(at, true, &mut |local| second.extend_from_slice(&local.residual))?;
    found.is_pure = first.iter().map(|r| r.to_bits()).eq(second.iter().map(|r| r.to_bits()));
    let norm = |v: [f64; 3]| v[0].hypot(v[1]).hypot(v[2]);
    found.resultant = norm(force) / sizes[0].max(f64::MIN_POSITIVE);
    found.moment = norm(moment) / sizes[1].max(f64::MIN_POSITIVE);
    found.asymmetry = asymmetry / largest.max(f64::MIN_POSITIVE);
    Ok(found)
}

/// How a term deals out its contributions, see [`Term::set_share`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sharing {
    /// Contributions that each rank evaluates; empty of a term that does not deal them out.
    pub counts: Vec<usize>,
    /// Whether one rank alone has values of each contribution, with the bits of those of the whole term, and all ranks visit the same nodes and slots in the same order.
    pub is_whole: bool,
}

/// Compares what `ranks` ranks evaluate at an iterate with what the whole term does, and leaves it whole.
///
/// # Errors
/// Where the term cannot be evaluated.
pub fn sharing(term: &mut dyn Term, at: &At<'_>, ranks: u32) -> Result<Sharing, Fault> {
    term.renew(at, true)?;
    let mut whole = Vec::new();
    term.assemble(at, true, &mut |local| whole.push(local.clone()))?;
    let mut found = Sharing { counts: Vec::new(), is_whole: true };
    let mut seen = vec![0; whole.len()];
    for rank in 0..ranks {
        let Some(share) = term.set_share(Share::new(ranks, rank)) else { return Ok(found) };
        let renewed = term.renew(at, true);
        let (mut k, mut count) = (0, 0);
        let evaluated = term.assemble(at, true, &mut |local| {
            let all = whole.get(k);
            found.is_whole &= all.is_some_and(|all| match local.is_elsewhere {
                true => all.nodes == local.nodes && all.slots == local.slots && local.residual.is_empty(),
                false => has_bits_of(local, all),
            });
            found.is_whole &= local.is_elsewhere != share.has(&local.nodes);
            if !local.is_elsewhere {
                count += 1;
                seen.get_mut(k).into_iter().for_each(|seen| *seen += 1);
            }
            k += 1;
        });
        term.set_share(Share::default());
        renewed?;
        evaluated?;
        found.is_whole &= k == whole.len();
        found.counts.push(count);
    }
    found.is_whole &= seen.iter().all(|&seen| seen == 1);
    Ok(found)
}

fn has_bits_of(a: &Local, b: &Local) -> bool {
    let values = |local: &Local| -> Vec<u64> {
        let all = local.residual.iter().chain(&local.tangent).chain(&local.shift).chain([&local.violation]);
        all.map(|value| value.to_bits()).collect()
    };
    (&a.nodes, &a.slots, a.auxiliaries, values(a)) == (&b.nodes, &b.slots, b.auxiliaries, values(b))
}

/// A direction with entries between -1 and 1 that look random, for a term with these numbers of nodes and slots: positions times `length`, multipliers times `traction`.
pub fn direction(term: &dyn Term, nodes: usize, seed: u64, length: f64, traction: f64) -> Unknowns {
    let mut state = seed.wrapping_mul(2).wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut next = || {
        // xorshift64* (Vigna 2016).
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let mut list = |count: usize, size: f64| (0..count).map(|_| size * next()).collect::<Vec<f64>>();
    let slots = term.slot_count();
    let equations = Auxiliary::equations(term.auxiliaries());
    // Condensed auxiliaries follow the others and are no unknowns of the linear equations.
    let further = if equations == term.auxiliaries().len() { slots * equations } else { 0 };
    Unknowns {
        positions: list(3 * nodes, length),
        multipliers: list(slots, traction),
        auxiliaries: list(further, traction),
    }
}

/// Whether the scheme's rule is one under which forces of an energy do its work.
pub fn is_discrete_gradient(rule: Rule) -> bool {
    matches!(
        rule,
        Rule::Force(crate::ForceRule::DiscreteGradient) | Rule::Constraint(crate::GradientRule::DiscreteGradient)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ForceRule;

    /// A spring of node 0 to the origin, with a factor on its tangent.
    #[derive(Debug)]
    struct Spring {
        tangent: f64,
    }

    impl Term for Spring {
        fn name(&self) -> &str {
            "spring"
        }
        fn length_scale(&self) -> f64 {
            1.0
        }
        fn stencils(&self, _active: &[bool], visit: &mut dyn FnMut(&[u32], &[u32])) {
            visit(&[0], &[]);
        }
        fn assemble(
            &self,
            at: &At<'_>,
            want_tangent: bool,
            visit: &mut (dyn FnMut(&Local) + Send),
        ) -> Result<(), Fault> {
            let mut local = Local::default();
            local.begin(&[0], want_tangent);
            for i in 0..3 {
                local.residual[i] = 4.0 * at.q_np1[i];
                if want_tangent {
                    local.tangent[4 * i] = 4.0 * self.tangent;
                }
            }
            visit(&local);
            Ok(())
        }
    }

    #[test]
    fn a_wrong_tangent_is_found() {
        let (q_n, q) = ([0.0; 3], [0.3, -0.2, 0.5]);
        let at = At::force([&q_n, &q], ForceRule::END_POINT, 0.1);
        let deviation = |tangent: f64| {
            let mut spring = Spring { tangent };
            let direction = direction(&spring, 1, 5, 1.0, 1.0);
            derivative(&mut spring, &at, &direction, 1e-5).unwrap().deviation
        };
        assert!(deviation(1.0) < 1e-9 && (deviation(1.01) - 0.01 / 1.01).abs() < 1e-9, "{}", deviation(1.01));
    }

    #[test]
    fn forces_of_the_ground_have_a_resultant() {
        let (q_n, q) = ([0.0; 3], [0.3, -0.2, 0.5]);
        let at = At::force([&q_n, &q], ForceRule::END_POINT, 0.1);
        let found = promises(&mut Spring { tangent: 1.0 }, &at, &|_| false).unwrap();
        assert!(found.is_pure && found.has_order && found.asymmetry == 0.0);
        assert!((found.resultant - 1.0).abs() < 1e-15 && (found.work - 4.0 * 0.38).abs() < 1e-15, "{found:?}");
    }
}
