//! Multipliers that are condensed: each takes a motion from a slave node of its own.
//!
//! Where every slot has a slave node and acts on no other slot's, as dual multipliers and those of nodes do, `[K B; C D]` is reduced to the nodes without filling it in. In a slot, rows with a
//! pivot in `D` (friction that slides, penalties, open slots) are eliminated first: `K' = K - B M C` with `M` the inverse of their block of `D`, and what is left of `B` and `C` is
//! `B' = B (I - M D)`, `C' = (I - D M) C`. The other rows fix motions of the slave node: with the right inverses `R` and `R_b` of their parts at the slave node, `Z = I - R C'` and
//! `Z_b = I - R_b B'^T`,
//!
//! `x = R r2' + Z M_c Z_b^T (r1' - K' R r2')`, `p = R_b^T (r1' - K' x)`,
//!
//! where `M_c` is a cycle for `Z_b^T K' Z`; the motions that are gone stay in it as inert unknowns, so that blocks stay `3 x 3`. Were `M_c` exact, this would be the inverse.

use super::bsr::{Block, Bsr, product};
use super::inverse::invert;
use super::modes::MODES;
use super::saddle::{Border, CouplingBlock, with_products};

/// A row whose own entry of `D` is larger than this part of `C E^-1 B` is eliminated; in others `D` is left out. (What is eliminated is a spring of `C E^-1 B / D` times the stiffness of the node. A
/// sandwich with dual multipliers and friction: 204 iterations in 14 solutions with 0.001, 139 with 0.3.)
const PIVOT: f64 = 0.3;

/// What a slot has at slave nodes of others counts at its own (the derivative of its normal, for instance), up to this part of what it has there.
const LUMPED: f64 = 0.25;

/// A row has at least this part of its length at the slave node.
const OWN: f64 = 0.1;

/// A slave node may be so many times as stiff as the master's nodes: beyond that the motion should be taken from the master.
const STIFFER: f64 = 10.0;

/// Rows of a slot whose parts at the slave node are as dependent as this (square of the sine of the angle between one and the others) fix no motions of their own there, as those of a node that is
/// held in part.
const DEPENDENT: f64 = 1e-4;

/// Equations of a slot at most.
const WIDTH: usize = 3;

type Small = [[f64; 3]; 3];

fn multiply(a: &Small, b: &Small) -> Small {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(a: &Small) -> Small {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

fn times(a: &Small, x: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|k| a[i][k] * x[k]).sum())
}

fn length(a: &Small) -> f64 {
    a.as_flattened().iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Rows of a slot at a node.
type At = (u32, Small);

/// A slot. Rows and columns that it does not have, or that do not take part, are zero.
#[derive(Debug)]
struct Slot {
    first: usize,
    width: usize,
    /// Which rows take a motion from the slave node.
    keeps: [bool; WIDTH],
    node: usize,
    m: Small,
    /// `D M` and `M D`.
    dm: Small,
    md: Small,
    c: Vec<At>,
    b: Vec<At>,
    /// `C'` and `B'^T`, the slave node first.
    c_left: Vec<At>,
    b_left: Vec<At>,
    r: Small,
    r_b: Small,
}

impl Slot {
    fn takes(&self) -> bool {
        self.keeps.contains(&true)
    }

    fn eliminates(&self) -> bool {
        self.m != [[0.0; 3]; 3]
    }

    /// What is left of rows at nodes after the elimination: they less `taken` times them; those at other slave nodes are added at the own one. `None` if that is much.
    fn left(&self, rows: &[At], taken: &Small, is_slave: &[bool]) -> Option<Vec<At>> {
        let mut out = vec![(self.node as u32, [[0.0; 3]; 3])];
        let mut lumped = 0.0;
        for &(node, ref entry) in rows {
            let taken = multiply(taken, entry);
            let mut entry = *entry;
            for k in 0..3 {
                entry[k] = if self.keeps[k] { std::array::from_fn(|d| entry[k][d] - taken[k][d]) } else { [0.0; 3] };
            }
            let is_own = node as usize == self.node;
            if is_own || is_slave[node as usize] {
                lumped += if is_own { 0.0 } else { length(&entry) };
                let own = out[0].1.as_flattened_mut().iter_mut();
                own.zip(entry.as_flattened()).for_each(|(own, v)| *own += v);
            } else {
                out.push((node, entry));
            }
        }
        let row = |k: usize, entry: &Small| entry[k].iter().map(|v| v * v).sum::<f64>();
        let is_fixed = |k: usize| {
            let all: f64 = out.iter().map(|(_, entry)| row(k, entry)).sum();
            !self.keeps[k] || row(k, &out[0].1) > OWN * OWN * all
        };
        (lumped <= LUMPED * length(&out[0].1) && (0..3).all(is_fixed)).then_some(out)
    }

    /// `A^T (A A^T)^-1` of the rows at the slave node; `None` where these are dependent.
    fn right_inverse(&self, left: &[At]) -> Option<Small> {
        let own = &left[0].1;
        let mut gram = multiply(own, &transposed(own));
        (0..3).filter(|&k| !self.keeps[k]).for_each(|k| gram[k][k] = 1.0);
        // Elimination leaves of each row the square of its distance from those before.
        let mut rest = gram;
        for k in 0..3 {
            if rest[k][k].is_nan() || rest[k][k] <= DEPENDENT * gram[k][k] {
                return None;
            }
            for i in k + 1..3 {
                let part = rest[i][k] / rest[k][k];
                for j in k..3 {
                    rest[i][j] -= part * rest[k][j];
                }
            }
        }
        invert(gram.as_flattened_mut(), 3);
        Some(multiply(&transposed(own), &gram))
    }

    /// `C x` of all rows.
    fn image(&self, x: &[[f64; 3]]) -> [f64; 3] {
        self.c.iter().fold([0.0; 3], |sum, (node, c)| {
            let part = times(c, x[*node as usize]);
            std::array::from_fn(|k| sum[k] + part[k])
        })
    }
}

/// The condensation of a system, and its vectors.
#[derive(Debug)]
pub(crate) struct Condensation {
    slots: Vec<Slot>,
    /// Nodes that are coupled with slave nodes by `K`, these among them.
    near: Vec<u32>,
    x: Vec<[f64; 3]>,
    t: Vec<[f64; 3]>,
    y: Vec<[f64; 3]>,
}

/// The rows of a slot at nodes.
fn gather(rows: std::ops::Range<usize>, coupling: &CouplingBlock, place: &mut [u32]) -> Vec<At> {
    let mut out: Vec<At> = Vec::new();
    for (k, row) in rows.enumerate() {
        for (node, value) in coupling.row(row) {
            if place[node] == u32::MAX {
                place[node] = out.len() as u32;
                out.push((node as u32, [[0.0; 3]; 3]));
            }
            out[place[node] as usize].1[k] = *value;
        }
    }
    out.iter().for_each(|(node, _)| place[*node as usize] = u32::MAX);
    out
}

impl Condensation {
    /// The condensation of a system with the slot and the slave node ([`crate::NONE`] if it has none) of each other equation, and `C E^-1 B` of it in size.
    /// `None` where it does not suit.
    pub fn new(
        k: &Bsr<f64, 3, 3>,
        border: &Border,
        slots: &[Option<u32>],
        slaves: &[u32],
        sizes: &[f64],
    ) -> Option<Self> {
        let nodes = k.rows();
        let mut place = vec![u32::MAX; nodes];
        let mut is_slave = vec![false; nodes];
        let mut out: Vec<Slot> = Vec::new();
        let mut first = 0;
        while first < slots.len() {
            let label = slots[first]?;
            let width = slots[first..].iter().take_while(|other| **other == Some(label)).count();
            if width > WIDTH {
                return None;
            }
            let (mut d, mut m) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
            for column in 0..width {
                for (row, value) in border.d_by_column.row(first + column) {
                    d[row.checked_sub(first).filter(|row| *row < width)?][column] = value;
                }
            }
            let has_pivot = |k: usize| d[k][k] != 0.0 && d[k][k].abs() > PIVOT * sizes[first + k];
            let keeps = std::array::from_fn(|k| k < width && !has_pivot(k));
            for i in 0..3 {
                for j in 0..3 {
                    let is_pivot = i < width && j < width && !keeps[i] && !keeps[j];
                    m[i][j] = if is_pivot { d[i][j] } else { f64::from(u8::from(i == j)) };
                }
            }
            invert(m.as_flattened_mut(), 3);
            (0..3).filter(|&k| k >= width || keeps[k]).for_each(|k| m[k][k] = 0.0);
            let node = slaves[first] as usize;
            let rows = first..first + width;
            let (c, b) = (gather(rows.clone(), &border.c, &mut place), gather(rows, &border.b, &mut place));
            let zero = [[0.0; 3]; 3];
            let (dm, md) = (multiply(&d, &m), multiply(&m, &d));
            let (c_left, b_left, r, r_b) = (Vec::new(), Vec::new(), zero, zero);
            let slot = Slot { first, width, keeps, node, m, dm, md, c, b, c_left, b_left, r, r_b };
            if slot.takes() {
                let same = slaves[first..first + width].iter().all(|other| *other == slaves[first]);
                if node >= nodes || !same || std::mem::replace(&mut is_slave[node], true) {
                    return None;
                }
            }
            out.push(slot);
            first += width;
        }
        let stiffness = |node: usize| {
            k.position(node, node).map_or(0.0, |at| (0..3).map(|d| k.blocks[at][d][d].abs()).fold(0.0, f64::max))
        };
        let mut is_near = vec![false; nodes];
        for slot in out.iter_mut().filter(|slot| slot.takes()) {
            slot.c_left = slot.left(&slot.c, &slot.dm, &is_slave)?;
            slot.b_left = slot.left(&slot.b, &transposed(&slot.md), &is_slave)?;
            let masters = slot.c_left[1..].iter().map(|(node, _)| stiffness(*node as usize)).fold(0.0, f64::max);
            if slot.c_left.len() > 1 && stiffness(slot.node) > STIFFER * masters {
                return None;
            }
            (slot.r, slot.r_b) = (slot.right_inverse(&slot.c_left)?, slot.right_inverse(&slot.b_left)?);
            k.row(slot.node).for_each(|(j, _)| is_near[j] = true);
        }
        let near = (0..nodes as u32).filter(|&i| is_near[i as usize]).collect();
        let zero = vec![[0.0; 3]; nodes];
        Some(Self { slots: out, near, x: zero.clone(), t: zero.clone(), y: zero })
    }

    /// Which rows of which slot take a motion: a hierarchy serves for these only.
    pub fn takes(&self) -> impl Iterator<Item = (usize, [bool; WIDTH])> {
        self.slots.iter().map(|slot| (slot.first, slot.keeps))
    }

    /// `I` with `- factor rows` in the rows of slave nodes.
    fn projector(&self, of: impl Fn(&Slot) -> (&Small, &[At])) -> Bsr<f64, 3, 3> {
        let nodes = self.x.len();
        let mut slot_of = vec![usize::MAX; nodes];
        self.slots.iter().enumerate().filter(|(_, slot)| slot.takes()).for_each(|(s, slot)| slot_of[slot.node] = s);
        let mut z = Bsr::empty(nodes);
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (i, &s) in slot_of.iter().enumerate() {
            match self.slots.get(s) {
                None => {
                    z.indices.push(i as u32);
                    z.blocks.push(unit);
                }
                Some(slot) => {
                    let (factor, rows) = of(slot);
                    let mut row: Vec<At> = rows.iter().map(|(j, rows)| (*j, multiply(factor, rows))).collect();
                    row.sort_unstable_by_key(|(j, _)| *j);
                    for (j, block) in row {
                        z.indices.push(j);
                        let one = |r: usize, c: usize| if j as usize == i { unit[r][c] } else { 0.0 };
                        z.blocks.push(std::array::from_fn(|r| std::array::from_fn(|c| one(r, c) - block[r][c])));
                    }
                }
            }
            z.starts.push(z.indices.len());
        }
        z
    }

    /// `Z_b^T K' Z`, with the motions that are gone as inert unknowns.
    pub fn matrix(&self, k: &Bsr<f64, 3, 3>, border: &Border) -> Bsr<f64, 3, 3> {
        let mut weights: Vec<Option<(usize, Vec<f64>)>> = vec![None; border.len()];
        for slot in self.slots.iter().filter(|slot| slot.eliminates()) {
            for row in 0..slot.width {
                let of_row = slot.m[row][..slot.width].iter().map(|v| -v).collect();
                weights[slot.first + row] = Some((slot.first, of_row));
            }
        }
        let left = self.projector(|slot| (&slot.r_b, &slot.b_left)).transposed();
        let right = self.projector(|slot| (&slot.r, &slot.c_left));
        let reduced = with_products(k, border, |r| weights[r].as_ref().map(|(first, w)| (*first, w.as_slice())));
        let mut out = product(&left, &product(&reduced, &right));
        for slot in self.slots.iter().filter(|slot| slot.takes()) {
            let (Some(at), Some(before)) = (out.position(slot.node, slot.node), k.position(slot.node, slot.node))
            else {
                continue;
            };
            let size = (0..3).map(|d| k.blocks[before][d][d].abs()).fold(0.0, f64::max);
            let gone = multiply(&slot.r, &slot.c_left[0].1);
            let inert = multiply(&transposed(&gone), &gone);
            let block = out.blocks[at].as_flattened_mut().iter_mut();
            block.zip(inert.as_flattened()).for_each(|(v, inert)| *v += size * inert);
        }
        out
    }

    /// Takes from the modes what slave nodes cannot do.
    pub fn restrict(&self, modes: &mut [Block<f64, 3, MODES>]) {
        for slot in self.slots.iter().filter(|slot| slot.takes()) {
            let gone = multiply(&slot.r, &slot.c_left[0].1);
            let own = modes[slot.node];
            for (r, row) in modes[slot.node].iter_mut().enumerate() {
                for (c, v) in row.iter_mut().enumerate() {
                    *v -= (0..3).map(|k| gone[r][k] * own[k][c]).sum::<f64>();
                }
            }
        }
    }

    /// `z = M r`, of a residual whose rows are scaled.
    pub fn apply(
        &mut self,
        k: &Bsr<f64, 3, 3>,
        scale: &[f64],
        mut cycle: impl FnMut(&[f64], &mut [f64]),
        r: &[f64],
        z: &mut [f64],
    ) {
        let Self { slots, near, x, t, y } = self;
        let (r1, r2) = r.split_at(3 * k.rows());
        let (z1, z2) = z.split_at_mut(3 * k.rows());
        let r1 = r1.as_chunks::<3>().0;
        let of = |slot: &Slot| -> [f64; 3] {
            std::array::from_fn(|i| if i < slot.width { r2[slot.first + i] / scale[slot.first + i] } else { 0.0 })
        };
        // What the rows that are eliminated have, for a motion of the nodes.
        let eliminated = |slot: &Slot, x: &[[f64; 3]]| {
            let (r, image) = (of(slot), slot.image(x));
            times(&slot.m, std::array::from_fn(|i| r[i] - image[i]))
        };
        // `x = R r2'`.
        x.fill([0.0; 3]);
        for slot in slots.iter().filter(|slot| slot.takes()) {
            let r = of(slot);
            let taken = times(&slot.dm, r);
            x[slot.node] = times(&slot.r, std::array::from_fn(|i| r[i] - taken[i]));
        }
        // `t = Z_b^T (r1' - K' x)`.
        t.copy_from_slice(r1);
        for &i in near.iter() {
            let product = k.row_product(i as usize, x);
            (0..3).for_each(|d| t[i as usize][d] -= product[d]);
        }
        for slot in slots.iter().filter(|slot| slot.eliminates()) {
            let v = eliminated(slot, x);
            for (node, b) in &slot.b {
                (0..3).for_each(|d| t[*node as usize][d] -= (0..3).map(|i| b[i][d] * v[i]).sum::<f64>());
            }
        }
        for slot in slots.iter().filter(|slot| slot.takes()) {
            let force = times(&transposed(&slot.r_b), t[slot.node]);
            for (node, b) in &slot.b_left {
                (0..3).for_each(|d| t[*node as usize][d] -= (0..3).map(|i| b[i][d] * force[i]).sum::<f64>());
            }
        }
        cycle(t.as_flattened(), y.as_flattened_mut());
        // `x + Z y`: slave nodes of others do not enter, so that one after the other may be changed.
        for slot in slots.iter().filter(|slot| slot.takes()) {
            let image = slot.c_left.iter().fold([0.0; 3], |sum: [f64; 3], (node, c)| {
                let part = times(c, y[*node as usize]);
                std::array::from_fn(|i| sum[i] + part[i])
            });
            let fixed = times(&slot.r, image);
            (0..3).for_each(|d| x[slot.node][d] -= fixed[d]);
        }
        x.as_flattened_mut().iter_mut().zip(y.as_flattened()).for_each(|(x, y)| *x += y);
        z1.copy_from_slice(x.as_flattened());
        // `p` from the balance of the slave nodes. The force of eliminated rows at them is that of all slots.
        for slot in slots.iter().filter(|slot| slot.takes()) {
            let product = k.row_product(slot.node, x);
            t[slot.node] = std::array::from_fn(|d| r1[slot.node][d] - product[d]);
        }
        for slot in slots.iter() {
            let v = eliminated(slot, x);
            (0..slot.width).for_each(|i| z2[slot.first + i] = v[i]);
            for (node, b) in slot.b.iter().filter(|_| slot.eliminates()) {
                (0..3).for_each(|d| t[*node as usize][d] -= (0..3).map(|i| b[i][d] * v[i]).sum::<f64>());
            }
        }
        for slot in slots.iter().filter(|slot| slot.takes()) {
            let force = times(&transposed(&slot.r_b), t[slot.node]);
            let moved = times(&slot.md, force);
            (0..slot.width).for_each(|i| z2[slot.first + i] += force[i] - moved[i]);
        }
    }

    /// Heap memory in bytes.
    pub fn memory_bytes(&self) -> usize {
        let of_slot = |slot: &Slot| {
            let entries: usize = [&slot.c, &slot.b, &slot.c_left, &slot.b_left].into_iter().map(Vec::capacity).sum();
            size_of::<At>() * entries
        };
        self.slots.iter().map(of_slot).sum::<usize>()
            + size_of::<Slot>() * self.slots.capacity()
            + size_of::<u32>() * self.near.capacity()
            + 3 * size_of::<[f64; 3]>() * self.x.capacity()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A node that a plane of symmetry holds across two tangents has one motion for both of their rows.
    #[test]
    fn dependent_rows_have_no_right_inverse() {
        let zero = [[0.0; 3]; 3];
        let slot = Slot {
            first: 0,
            width: 3,
            keeps: [true; WIDTH],
            node: 0,
            m: zero,
            dm: zero,
            md: zero,
            c: Vec::new(),
            b: Vec::new(),
            c_left: Vec::new(),
            b_left: Vec::new(),
            r: zero,
            r_b: zero,
        };
        let free = [[0.0, 0.0, 2.0], [0.7, 0.7, 0.0], [0.7, -0.7, 0.0]];
        let inverse = slot.right_inverse(&[(0, free)]).unwrap();
        let product = multiply(&free, &inverse);
        assert!((0..3).all(|i| (0..3).all(|j| (product[i][j] - f64::from(u8::from(i == j))).abs() < 1e-14)));
        let held = free.map(|row| [row[0], 0.0, row[2]]);
        assert!(slot.right_inverse(&[(0, held)]).is_none());
        // Lengths of rows do not matter, angles do.
        let short = [free[0], free[1].map(|v| 1e-9 * v), free[2]];
        assert!(slot.right_inverse(&[(0, short)]).is_some());
    }
}
