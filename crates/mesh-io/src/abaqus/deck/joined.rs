//! The way from keywords to a [`super::Deck`]: equations, couplings, rigid bodies, pretension, springs, and what steps change.

use super::connected::{
    Change, ChangeKind, Connection, ConnectionSection, Coupling, Equation, EquationTerm, Followers, Following,
    MultiPoint, Pretension,
};
use super::fill::Filler;
use super::rows::Row;
use super::{Friction, SurfaceBehavior, Target};
use crate::MeshIoError;
use crate::abaqus::block::Block;

impl Filler<'_> {
    /// Nodes of the assembly: those of parts are the reader's.
    pub fn reference_nodes(&mut self, block: &Block) -> Result<(), MeshIoError> {
        for row in block.rows(self.contents) {
            let node = (row.number(0, "a node")?, row.vector(1, "a coordinate")?);
            self.deck.reference_nodes.push(node);
        }
        Ok(())
    }

    /// A set of nodes of the assembly.
    pub fn reference_set(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if block.keyword.value("INSTANCE").is_some() {
            return Ok(());
        }
        let name = block.require(self.contents, "NSET")?.to_uppercase();
        let mut own = Vec::new();
        for row in block.rows(self.contents) {
            if block.keyword.flag("GENERATE") {
                let (first, last) = (row.number(0, "a node")?, row.number(1, "a node")?);
                let step = if row.field(2).is_empty() { 1 } else { row.number(2, "an increment")? };
                let known = self.deck.reference_nodes.iter().map(|(number, _)| *number);
                own.extend(known.filter(|n| (first..=last).contains(n) && (n - first).is_multiple_of(step.max(1))));
            } else {
                // Names and numbers of instances are the reader's.
                own.extend((0..row.count()).filter_map(|k| row.field(k).parse::<u64>().ok()));
            }
        }
        self.deck.reference_sets.entry(name).or_default().extend(own);
        Ok(())
    }

    /// Each equation begins with a line with the number of its terms.
    pub fn equations(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if self.is_other(block, &[]) {
            return Ok(());
        }
        let mut rows = block.rows(self.contents);
        while let Some(head) = rows.next() {
            let count = head.number(0, "the number of terms of an equation")? as usize;
            let mut terms = Vec::new();
            while terms.len() < count {
                let Some(row) = rows.next() else {
                    return Err(head.error(
                        head.text,
                        format!("expected {count} terms: node, degree of freedom and factor of each"),
                    ));
                };
                for k in (0..row.count()).step_by(3).take_while(|k| !row.field(*k).is_empty()) {
                    terms.push(EquationTerm {
                        nodes: row.target_at(k),
                        freedom: self.freedom(&row, k + 1)?,
                        factor: row.real(k + 2, "a factor")?,
                    });
                }
            }
            self.deck.equations.push(Equation { terms, place: block.place() });
        }
        Ok(())
    }

    /// A degree of freedom from 1 to 6, counted from 0.
    fn freedom(&self, row: &Row, index: usize) -> Result<usize, MeshIoError> {
        match row.freedom(index)? {
            Some(freedom @ 1..=6) => Ok(freedom as usize - 1),
            _ => Err(row.error(row.text, "expected a degree of freedom from 1 to 6")),
        }
    }

    pub fn multi_point(&mut self, block: &Block) -> Result<(), MeshIoError> {
        for row in block.rows(self.contents) {
            let first = row.field(0);
            let continues = first.starts_with(|c: char| c.is_ascii_digit());
            if !continues {
                let kind = first.to_uppercase();
                self.deck.multi_points.push(MultiPoint { kind, nodes: Vec::new(), place: row.place() });
            }
            let mut nodes = Vec::new();
            for k in usize::from(!continues)..row.count() {
                let field = row.field(k);
                if field.starts_with(|c: char| c.is_ascii_alphabetic()) {
                    // Sets of nodes: not read.
                    if let Some(last) = self.deck.multi_points.last_mut() {
                        last.kind += " of sets";
                    }
                    break;
                }
                if !field.is_empty() {
                    nodes.push(row.number(k, "a node")?);
                }
            }
            match self.deck.multi_points.last_mut() {
                Some(last) => last.nodes.extend(nodes),
                None => return Err(row.error(row.text, "expected the type of a multi-point constraint")),
            }
        }
        Ok(())
    }

    /// `*COUPLING`; the keyword after it says how.
    pub fn coupling(&mut self, block: &Block) -> Result<(), MeshIoError> {
        self.other_parameters(block, &["REFNODE", "SURFACE", "CONSTRAINTNAME"]);
        let surface = block.require(self.contents, "SURFACE")?;
        let node = block.target(self.contents, "REFNODE")?;
        self.deck.couplings.push(Coupling {
            keyword: "*COUPLING",
            node,
            rotations: None,
            followers: Followers::Surface(surface),
            following: None,
            freedoms: [true; 6],
            place: block.place(),
        });
        Ok(())
    }

    /// `*KINEMATIC` and `*DISTRIBUTING`.
    pub fn following(&mut self, block: &Block, following: Following) -> Result<(), MeshIoError> {
        self.other_parameters(block, &[]);
        let mut freedoms = [false; 6];
        for row in block.rows(self.contents) {
            let first = self.freedom(&row, 0)?;
            let last = if row.field(1).is_empty() { first } else { self.freedom(&row, 1)? };
            (first..=last).for_each(|freedom| freedoms[freedom] = true);
        }
        if freedoms == [false; 6] {
            freedoms = [true; 6];
        }
        match self.deck.couplings.last_mut().filter(|coupling| coupling.following.is_none()) {
            Some(coupling) => (coupling.following, coupling.freedoms) = (Some(following), freedoms),
            None => self.leave(block.place(), format!("*{} without *COUPLING", block.keyword.name)),
        }
        Ok(())
    }

    /// `*DISTRIBUTING COUPLING` of CalculiX: nodes with weights; the reference node is that of the element of the set.
    pub fn distributing(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if self.is_other(block, &["ELSET"]) {
            return Ok(());
        }
        let set = block.require(self.contents, "ELSET")?;
        let own =
            self.deck.connections.iter().filter(|c| c.set.as_deref().is_some_and(|s| s.eq_ignore_ascii_case(&set)));
        let Some(node) = own.filter_map(|c| c.nodes.first()).next().copied() else {
            self.leave(block.place(), format!("*{}", block.keyword.name));
            return Ok(());
        };
        let mut nodes = Vec::new();
        for row in block.rows(self.contents) {
            nodes.push((row.target(), row.optional(1, "a weight")?.unwrap_or(1.0)));
        }
        self.deck.couplings.push(Coupling {
            keyword: "*DISTRIBUTING COUPLING",
            node: Target::Number { number: node, instance: None },
            rotations: None,
            followers: Followers::Nodes(nodes),
            following: Some(Following::Distributing),
            freedoms: [true; 6],
            place: block.place(),
        });
        Ok(())
    }

    pub fn rigid_body(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if self.is_other(block, &["NSET", "ELSET", "REFNODE", "ROTNODE"]) {
            return Ok(());
        }
        let keyword = &block.keyword;
        let followers = match (keyword.value("NSET"), keyword.value("ELSET")) {
            (Some(set), _) => Followers::Nodes(vec![(Target::Set(set.to_owned()), 1.0)]),
            (None, Some(set)) => Followers::Elements(set.to_owned()),
            (None, None) => return Err(block.error(self.contents, "needs the parameter NSET=... or ELSET=...")),
        };
        let node = block.target(self.contents, "REFNODE")?;
        let rotations = match keyword.value("ROTNODE") {
            Some(_) => Some(block.target(self.contents, "ROTNODE")?),
            None => None,
        };
        self.deck.couplings.push(Coupling {
            keyword: "*RIGID BODY",
            node,
            rotations,
            followers,
            following: Some(Following::Kinematic),
            freedoms: [true; 6],
            place: block.place(),
        });
        Ok(())
    }

    pub fn pretension(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if self.is_other(block, &["SURFACE", "ELEMENT", "NODE"]) {
            return Ok(());
        }
        let surface = block.keyword.value("SURFACE").map(str::to_owned);
        let element = match block.keyword.value("ELEMENT") {
            Some(_) => Some(block.node(self.contents, "ELEMENT")?),
            None => None,
        };
        let node = block.target(self.contents, "NODE")?;
        let normal =
            block.rows(self.contents).next().map(|row| row.vector(0, "a component of the normal")).transpose()?;
        let normal = normal.filter(|normal| *normal != [0.0; 3]);
        self.deck.pretensions.push(Pretension { surface, element, node, normal, place: block.place() });
        Ok(())
    }

    /// Elements that are no solids.
    pub fn connections(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let kind = block.require(self.contents, "TYPE")?.to_uppercase();
        // Numbers within parts mean other nodes in every instance.
        if self.is_in_part()
            || !matches!(
                kind.as_str(),
                "SPRINGA"
                    | "SPRING1"
                    | "SPRING2"
                    | "DASHPOTA"
                    | "DASHPOT1"
                    | "DASHPOT2"
                    | "MASS"
                    | "DCOUP3D"
                    | "B31"
                    | "T3D2"
            )
        {
            return Ok(());
        }
        for row in block.rows(self.contents) {
            let mut nodes = Vec::new();
            for k in 1..row.count() {
                if !row.field(k).is_empty() {
                    nodes.push(row.number(k, "a node")?);
                }
            }
            self.deck.connections.push(Connection {
                kind: kind.clone(),
                number: row.number(0, "the number of an element")?,
                nodes,
                set: block.keyword.value("ELSET").map(str::to_owned),
                place: row.place(),
            });
        }
        Ok(())
    }

    /// `*SPRING`, `*DASHPOT`: a line of degrees of freedom, which may be blank, and one with the value. `*MASS`: the value.
    pub fn connection_section(&mut self, block: &Block, keyword: &'static str) -> Result<(), MeshIoError> {
        if self.is_other(block, &["ELSET"]) {
            return Ok(());
        }
        let elements = block.require(self.contents, "ELSET")?;
        let mut rows = block.rows(self.contents);
        // A blank line is none for the reader.
        let lines: Vec<Row> = rows.by_ref().take(2).collect();
        let (freedoms, value) = match lines.as_slice() {
            [freedoms, value] if keyword != "*MASS" => (Some(*freedoms), *value),
            [value, ..] => (None, *value),
            [] => return Err(block.error(self.contents, "needs a data line with its value")),
        };
        let mut own = Vec::new();
        if let Some(row) = freedoms {
            for k in 0..row.count() {
                if !row.field(k).is_empty() {
                    own.push(self.freedom(&row, k)?);
                }
            }
        }
        if rows.next().is_some() {
            self.leave(block.place(), format!("all lines of *{} but the first", block.keyword.name));
        }
        let value = value.real(0, "a number")?;
        self.deck.sections_of_connections.push(ConnectionSection {
            keyword,
            elements,
            freedoms: own,
            value,
            place: block.place(),
        });
        Ok(())
    }

    /// `*CHANGE FRICTION` and `*CHANGE SURFACE BEHAVIOR` name the interaction; the keyword after them has the values.
    pub fn change(&mut self, block: &Block) -> Result<(), MeshIoError> {
        if self.in_step && !self.is_other(block, &["INTERACTION"]) {
            self.changed = Some((block.require(self.contents, "INTERACTION")?, block.place()));
        } else if !self.in_step {
            self.leave(block.place(), format!("*{}", block.keyword.name));
        }
        Ok(())
    }

    pub fn changed_friction(&mut self, friction: Friction) {
        self.push_change(|name| ChangeKind::Friction(name, friction));
    }

    pub fn changed_behavior(&mut self, behavior: SurfaceBehavior) {
        self.push_change(|name| ChangeKind::Behavior(name, behavior));
    }

    fn push_change(&mut self, kind: impl FnOnce(String) -> ChangeKind) {
        if let (Some((name, place)), Some(step)) = (self.changed.take(), self.deck.steps.last_mut()) {
            step.changes.push(Change { kind: kind(name), place });
        }
    }

    /// `*MODEL CHANGE` of contact pairs.
    pub fn model_change(&mut self, block: &Block) -> Result<(), MeshIoError> {
        let is_of_pairs =
            block.keyword.value("TYPE").is_some_and(|kind| kind.replace(' ', "").eq_ignore_ascii_case("CONTACTPAIR"));
        let (adds, removes) = (block.keyword.flag("ADD"), block.keyword.flag("REMOVE"));
        if !is_of_pairs || !self.in_step || adds == removes || self.is_other(block, &["TYPE", "ADD", "REMOVE"]) {
            self.leave(block.place(), format!("*{}", block.keyword.name));
            return Ok(());
        }
        for row in block.rows(self.contents) {
            let (slave, master) = (row.name(0, "a slave surface")?, row.name(1, "a master surface")?);
            let change = Change { kind: ChangeKind::Contact { slave, master, acts: adds }, place: row.place() };
            if let Some(step) = self.deck.steps.last_mut() {
                step.changes.push(change);
            }
        }
        Ok(())
    }
}
