//! Sets by name, before their numbers are resolved.

use std::collections::BTreeMap;

use crate::place::FileLocation;

/// Numbers and ranges with the place of their first occurrence; the first of each key is the instance, 0 within a part. Both are kept
/// unique, so that sets of sets cannot grow beyond what the file says.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Labels {
    pub numbers: BTreeMap<(usize, u64), FileLocation>,
    /// First, last, increment.
    pub ranges: BTreeMap<(usize, [u64; 3]), FileLocation>,
}

impl Labels {
    pub fn extend(&mut self, other: &Labels) {
        for (&number, &place) in &other.numbers {
            self.numbers.entry(number).or_insert(place);
        }
        for (&range, &place) in &other.ranges {
            self.ranges.entry(range).or_insert(place);
        }
    }

    /// Labels of a part as those of an instance.
    pub fn of_instance(&self, instance: usize) -> Labels {
        Labels {
            numbers: self.numbers.iter().map(|(&(_, n), &place)| ((instance, n), place)).collect(),
            ranges: self.ranges.iter().map(|(&(_, r), &place)| ((instance, r), place)).collect(),
        }
    }

    /// Whether the content is the same, whatever the places.
    pub fn same(&self, other: &Labels) -> bool {
        self.numbers.keys().eq(other.numbers.keys()) && self.ranges.keys().eq(other.ranges.keys())
    }
}

/// One named set.
#[derive(Debug, Clone)]
pub(super) struct Set {
    /// Name as it was first written.
    pub name: String,
    /// First place.
    pub place: FileLocation,
    /// Made by a program, not by the user.
    pub internal: bool,
    pub labels: Labels,
}

/// Sets of one kind (node or element sets) of a part, an instance or the assembly, by name in upper case.
#[derive(Debug, Clone, Default)]
pub(super) struct Sets {
    pub all: BTreeMap<String, Set>,
}

impl Sets {
    /// The set of this name, new if need be.
    pub fn open(&mut self, name: &str, place: FileLocation, internal: bool) -> &mut Set {
        self.all.entry(name.to_uppercase()).or_insert_with(|| Set {
            name: name.to_owned(),
            place,
            internal,
            labels: Labels::default(),
        })
    }

    /// The set of this name.
    pub fn find(&self, name: &str) -> Option<&Set> {
        self.all.get(&name.to_uppercase())
    }
}
