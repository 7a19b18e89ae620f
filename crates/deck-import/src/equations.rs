//! `*EQUATION`, `*MPC` and `*PRE-TENSION SECTION` to `[[equation]]`.

use std::collections::BTreeSet;

use stoss_mesh_io::deck::{MultiPoint, Pretension};

use crate::context::Context;
use crate::cut::Cut;
use crate::references::{End, Role};
use crate::severity::Severity;
use crate::text::{number, string, vector};

const AXES: [&str; 3] = ["x", "y", "z"];

/// A term of an equation: node, direction of unit length or component, factor.
struct Term {
    end: End,
    along: Along,
    factor: f64,
}

enum Along {
    Component(usize),
    Direction([f64; 3]),
}

/// Adds all equations. `cuts`: where bolts were cut.
pub(crate) fn equations(context: &mut Context<'_>, cuts: &[Cut]) {
    context.equations();
    context.multi_points();
    context.pretensions(cuts);
}

impl Context<'_> {
    fn equations(&mut self) {
        let deck = self.deck;
        for equation in &deck.equations {
            let named: Vec<Vec<u64>> = equation
                .terms
                .iter()
                .map(|term| {
                    let own = self.lookup.nodes(&term.nodes).members;
                    self.references.numbers(&term.nodes, &own)
                })
                .collect();
            let count = named.iter().map(Vec::len).max().unwrap_or(0);
            let missing = |context: &mut Self, consequence: &str| {
                let remedy = "write it as [[equation]], or use [[tie]] or [[joint]]";
                context.list.add(Severity::Missing, equation.place, "*EQUATION", consequence, remedy);
            };
            if named.iter().any(|own| own.is_empty() || own.len() != 1 && own.len() != count) {
                missing(self, "its nodes are not coupled: its sets have different numbers of nodes, or one has none");
                continue;
            }
            for k in 0..count {
                let terms = equation.terms.iter().zip(&named).map(|(term, own)| {
                    let node = own[if own.len() == 1 { 0 } else { k }];
                    self.term(node, term.freedom, term.factor)
                });
                match terms.collect::<Option<Vec<Term>>>() {
                    Some(terms) => self.equation(&terms),
                    None => missing(
                        self,
                        "its nodes are not coupled: one of them belongs to no body of the scene, or its degree of freedom is a rotation or has no known axes",
                    ),
                }
            }
        }
    }

    fn term(&mut self, node: u64, freedom: usize, factor: f64) -> Option<Term> {
        let end = self.references.end(node, self.bodies)?;
        if freedom > 2
            || matches!(end, End::Reference(r) if !matches!(self.references.all[r].role, Role::Point | Role::Body))
        {
            return None;
        }
        let along = match end {
            End::Solid(_, node) if self.axes.has(node) => match self.axes.direction(node, freedom)? {
                direction if direction.iter().filter(|d| **d != 0.0).count() > 1 => Along::Direction(direction),
                direction => {
                    let axis = (0..3).find(|&i| direction[i] != 0.0)?;
                    return Some(Term { end, along: Along::Component(axis), factor: factor * direction[axis] });
                }
            },
            _ => Along::Component(freedom),
        };
        Some(Term { end, along, factor })
    }

    /// The reference to a node in a scene.
    pub(crate) fn set_of(&mut self, end: End) -> String {
        match end {
            End::Solid(body, node) => {
                let wanted = BTreeSet::from([node]);
                // One new set, or one of the deck with just this node.
                self.sets.nodes(body, &wanted, &[], "node").pop().unwrap_or_default()
            }
            End::Reference(r) => format!("{}.all", self.references.all[r].name),
        }
    }

    fn text(&mut self, term: &Term) -> String {
        if let (End::Reference(r), Along::Component(component)) = (term.end, &term.along) {
            self.references.all[r].is_used[*component] = true;
        } else if let End::Reference(r) = term.end {
            self.references.all[r].is_used = [true; 3];
        }
        let along = match term.along {
            Along::Component(component) => format!("component = \"{}\"", AXES[component]),
            Along::Direction(direction) => format!("direction = {}", vector(direction)),
        };
        let factor = if term.factor == 1.0 { String::new() } else { format!(", factor = {}", number(term.factor)) };
        format!("{{ set = {}, {along}{factor} }}", string(&self.set_of(term.end)))
    }

    fn equation(&mut self, terms: &[Term]) {
        let terms: Vec<String> = terms.iter().filter(|term| term.factor != 0.0).map(|term| self.text(term)).collect();
        if !terms.is_empty() {
            self.scene.equation(&terms, None, &[]);
        }
    }

    fn multi_points(&mut self) {
        let deck = self.deck;
        for item in &deck.multi_points {
            let is_mapped = match (item.kind.as_str(), &item.nodes[..]) {
                ("TIE" | "PIN", &[a, b]) => (0..3).all(|i| {
                    let terms = [self.term(a, i, 1.0), self.term(b, i, -1.0)];
                    let [Some(a), Some(b)] = terms else { return false };
                    self.equation(&[a, b]);
                    true
                }),
                ("BEAM" | "LINK", &[a, b]) => self.distance(a, b),
                ("MEANROT", [_, _, .., _]) => self.mean_rotation(item),
                _ => false,
            };
            if !is_mapped {
                let consequence = format!("{} is left out: its nodes are not coupled", item.kind);
                let remedy = "see [[equation]], [[coupling]] and [[joint]]";
                self.list.add(Severity::Missing, item.place, format!("*MPC, {}", item.kind), consequence, remedy);
            }
        }
    }

    /// Two nodes that keep their distance.
    fn distance(&mut self, a: u64, b: u64) -> bool {
        let ends = [a, b].map(|node| self.references.end(node, self.bodies));
        let [Some(a), Some(b)] = ends else { return false };
        let places = [a, b].map(|end| self.references.place(end));
        if places[0] == places[1] {
            return false;
        }
        let sides = [a, b].map(|end| self.side_of(end));
        let [a, b] = sides.map(|side| string(&side));
        let at = places.map(vector).join(", ");
        self.scene.joint("distance", &format!("between = [{a}, {b}]\nat = [{at}]\n"), &[]);
        true
    }

    /// The node as a side of a joint or spring.
    pub(crate) fn side_of(&mut self, end: End) -> String {
        match end {
            End::Reference(r) => {
                self.references.all[r].is_used = [true; 3];
                self.references.all[r].name.clone()
            }
            End::Solid(..) => self.set_of(end),
        }
    }

    /// CalculiX' mean rotation of nodes, three times each, about the axis that the place of the last one gives, whose first displacement is the angle.
    fn mean_rotation(&mut self, item: &MultiPoint) -> bool {
        let [nodes @ .., pilot] = &item.nodes[..] else { return false };
        let nodes: BTreeSet<u64> = nodes.iter().copied().collect();
        let ends: Vec<Option<End>> = nodes.iter().map(|&node| self.references.end(node, self.bodies)).collect();
        let Some(ends) = ends.into_iter().collect::<Option<Vec<End>>>() else { return false };
        let mut by_body: Option<(usize, BTreeSet<u32>)> = None;
        for end in &ends {
            let End::Solid(body, node) = *end else { return false };
            let own = by_body.get_or_insert_with(|| (body, BTreeSet::new()));
            if own.0 != body {
                return false;
            }
            own.1.insert(node);
        }
        let Some((body, wanted)) = by_body else { return false };
        let count = ends.len() as f64;
        let places: Vec<[f64; 3]> = ends.iter().map(|&end| self.references.place(end)).collect();
        let centre = std::array::from_fn(|i| places.iter().map(|x| x[i]).sum::<f64>() / count);
        let Some(pilot) = self.references.make(*pilot, Role::Point) else { return false };
        let axis = self.references.all[pilot].at;
        if axis == [0.0; 3] {
            return false;
        }
        let rigid = self.references.make_body("mean-rotation", centre);
        self.references.all[pilot].role = Role::RotationAbout(rigid, axis);
        for set in self.sets.nodes(body, &wanted, &[], "mean-rotation") {
            let name = self.references.all[rigid].name.clone();
            self.scene.coupling("distributing", &set, &name);
        }
        true
    }

    fn pretensions(&mut self, cuts: &[Cut]) {
        let deck = self.deck;
        for (p, item) in deck.pretensions.iter().enumerate() {
            let is_mapped = match (item.element, cuts.iter().find(|cut| cut.pretension == p)) {
                (Some(element), _) => self.pretension_of_beam(item, element),
                (None, Some(cut)) => self.pretension_of_cut(item, cut),
                (None, None) => false,
            };
            if !is_mapped {
                let consequence = "the bolt has no pretension: it is not cut, and loads of its node are left out";
                let remedy = "cut the bolt, and use a [[joint]] of kind `slider` with `pretension`";
                self.list.add(Severity::Missing, item.place, "*PRE-TENSION SECTION", consequence, remedy);
            }
        }
    }

    /// The node of a pretension as a point that moves along x.
    fn bolt(&mut self, item: &Pretension) -> Option<End> {
        Some(End::Reference(self.reference(&item.node, Role::Point)?))
    }

    /// The two ends of the beam move apart along the normal by the displacement of the node, and not across it. The beam itself is left out.
    fn pretension_of_beam(&mut self, item: &Pretension, element: u64) -> bool {
        let beam =
            self.deck.connections.iter().find(|c| c.number == element && matches!(c.kind.as_str(), "B31" | "T3D2"));
        let (Some(&[a, b]), Some(normal)) =
            (beam.map(|beam| &beam.nodes[..]).and_then(|n| <&[u64; 2]>::try_from(n).ok()), item.normal)
        else {
            return false;
        };
        let ends = [a, b].map(|node| self.references.end(node, self.bodies));
        let ([Some(a), Some(b)], Some(bolt)) = (ends, self.bolt(item)) else { return false };
        // The ends of the beam in the order of the normal.
        let [x, y] = [a, b].map(|end| self.references.place(end));
        let along: f64 = (0..3).map(|i| normal[i] * (y[i] - x[i])).sum();
        let [first, second] = if along < 0.0 { [b, a] } else { [a, b] };
        self.apart(&[(first, second)], bolt, normal);
        let consequence = "the beam is left out: its ends are joined by the pretension, without its elasticity";
        self.list.add(Severity::Changed, item.place, "*PRE-TENSION SECTION", consequence, "see [[beam]]");
        true
    }

    fn pretension_of_cut(&mut self, item: &Pretension, cut: &Cut) -> bool {
        let Some(bolt) = self.bolt(item) else { return false };
        let of = |node: u32| self.bodies.owner(node).map(|body| End::Solid(body, node));
        let pairs: Option<Vec<(End, End)>> = cut.pairs.iter().map(|&(near, far)| Some((of(near)?, of(far)?))).collect();
        let Some(pairs) = pairs else { return false };
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let normal = item.normal.map_or(cut.normal, |normal| normal.map(|x| x / size(normal)));
        self.apart(&pairs, bolt, normal);
        true
    }

    /// Pairs of nodes that move apart along a normal in the mean by the displacement of a point along x, all by the same, and not across it.
    fn apart(&mut self, pairs: &[(End, End)], bolt: End, normal: [f64; 3]) {
        let across = across(normal);
        for &(near, far) in pairs {
            for direction in across {
                self.equation(&[
                    Term { end: far, along: Along::Direction(direction), factor: 1.0 },
                    Term { end: near, along: Along::Direction(direction), factor: -1.0 },
                ]);
            }
            self.equation(&[
                Term { end: far, along: Along::Direction(normal), factor: 1.0 },
                Term { end: near, along: Along::Direction(normal), factor: -1.0 },
                Term { end: bolt, along: Along::Component(0), factor: 1.0 },
            ]);
        }
    }
}

/// Two unit vectors across a normal and each other.
fn across(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let unit = |v: [f64; 3]| {
        let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        v.map(|x| x / length)
    };
    let cross = |a: [f64; 3], b: [f64; 3]| {
        std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
    };
    let smallest = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
    let axis: [f64; 3] = std::array::from_fn(|i| f64::from(u8::from(i == smallest)));
    let first = unit(cross(normal, axis));
    [first, unit(cross(normal, first))]
}
