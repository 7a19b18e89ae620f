//! Sets by name, before their numbers are resolved.

use std::collections::BTreeMap;

/// Where a name is defined: names of an assembly and of its part are different things.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Level {
    Part,
    Assembly,
}

/// Numbers and ranges with the line of their first occurrence. Both are kept unique, so that sets of sets cannot grow beyond
/// what the file says.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Labels {
    pub numbers: BTreeMap<u64, usize>,
    /// First, last, increment.
    pub ranges: BTreeMap<(u64, u64, u64), usize>,
}

impl Labels {
    pub fn extend(&mut self, other: &Labels) {
        for (&number, &line) in &other.numbers {
            self.numbers.entry(number).or_insert(line);
        }
        for (&range, &line) in &other.ranges {
            self.ranges.entry(range).or_insert(line);
        }
    }

    /// Same content, whatever the lines.
    fn same(&self, other: &Labels) -> bool {
        self.numbers.keys().eq(other.numbers.keys()) && self.ranges.keys().eq(other.ranges.keys())
    }

    /// Does the number lie in one of the ranges?
    pub fn in_ranges(&self, number: u64) -> bool {
        self.ranges.keys().any(|&(a, b, step)| a <= number && number <= b && (number - a).is_multiple_of(step))
    }
}

/// One named set.
#[derive(Debug, Clone)]
pub(super) struct Set {
    /// As first written.
    pub name: String,
    /// First line.
    pub line: usize,
    /// Made by a program, not by the user.
    pub internal: bool,
    pub labels: Labels,
}

/// Sets of one kind (node or element sets).
#[derive(Debug, Default)]
pub(super) struct Sets {
    sets: BTreeMap<(String, Level), Set>,
}

impl Sets {
    /// The set of this name, new if need be.
    pub fn open(&mut self, name: &str, level: Level, line: usize, internal: bool) -> &mut Set {
        self.sets.entry((name.to_uppercase(), level)).or_insert_with(|| Set {
            name: name.to_owned(),
            line,
            internal,
            labels: Labels::default(),
        })
    }

    /// The set that a name means at a level: its own first, from an assembly then that of the part.
    pub fn find(&self, name: &str, level: Level) -> Option<&Set> {
        let upper = name.to_uppercase();
        let own = self.sets.get(&(upper.clone(), level));
        own.or_else(|| if level == Level::Assembly { self.sets.get(&(upper, Level::Part)) } else { None })
    }

    /// All sets that get into the mesh, or a pair of one name with different content.
    pub fn result(&self) -> Result<Vec<&Set>, (&Set, &Set)> {
        let mut all = Vec::new();
        for ((name, level), set) in &self.sets {
            if *level == Level::Part
                && let Some(other) = self.sets.get(&(name.clone(), Level::Assembly))
            {
                if !set.internal && !other.internal && !set.labels.same(&other.labels) {
                    return Err((set, other));
                }
                continue;
            }
            all.push(set);
        }
        Ok(all)
    }
}
