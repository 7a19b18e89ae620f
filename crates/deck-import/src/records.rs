//! Which lines of the deck act on which node, facet or element in which stage.

use std::collections::BTreeMap;

use crate::timeline::Timeline;

/// For each stage the records that act in it, by their numbers.
pub(crate) type Chain = Vec<Vec<u32>>;

/// A line of the deck with what it acts on.
#[derive(Clone, Debug)]
pub(crate) struct Acting<T> {
    /// The step of the deck; none for what stands before the first one.
    pub step: Option<usize>,
    pub record: u32,
    pub members: Vec<T>,
}

/// Nodes, facets or elements by what acts on them. What a step says of one of them replaces what former steps said; `adds`: what one step says of it
/// several times is summed up, else the last time counts. `ends`: does a step end what former ones said of everything (`OP=NEW`)?
pub(crate) fn chains<T: Copy + Ord>(
    acting: &[Acting<T>],
    steps: usize,
    ends: impl Fn(usize) -> bool,
    timeline: &Timeline,
    adds: bool,
) -> BTreeMap<Chain, Vec<T>> {
    let mut said: BTreeMap<T, Vec<(Option<usize>, u32)>> = BTreeMap::new();
    for line in acting {
        for &member in &line.members {
            said.entry(member).or_default().push((line.step, line.record));
        }
    }
    let mut all: BTreeMap<Chain, Vec<T>> = BTreeMap::new();
    for (member, lines) in said {
        let in_step = |step: Option<usize>| -> Vec<u32> {
            let mut records: Vec<u32> = lines.iter().filter(|(of, _)| *of == step).map(|(_, record)| *record).collect();
            if !adds && records.len() > 1 {
                records.drain(..records.len() - 1);
            }
            records
        };
        let mut state = in_step(None);
        let mut chain = Chain::new();
        let mut stages = timeline.stages.iter().filter_map(|stage| stage.step).peekable();
        for step in 0..steps {
            if ends(step) {
                state.clear();
            }
            let own = in_step(Some(step));
            if !own.is_empty() {
                state = own;
            }
            if stages.next_if_eq(&step).is_some() {
                chain.push(state.clone());
            }
        }
        // A deck without a step that maps: what its steps have left.
        if chain.is_empty() {
            chain = vec![state; timeline.stages.len()];
        }
        if chain.iter().any(|records| !records.is_empty()) {
            all.entry(chain).or_default().push(member);
        }
    }
    all
}
