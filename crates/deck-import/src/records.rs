//! Which lines of the deck act on which node, facet or element in which stage.

use std::collections::BTreeMap;

use crate::timeline::Timeline;

/// Records that act in each stage, by their numbers.
pub(crate) type StageRecords = Vec<Vec<u32>>;

/// A line of the deck with what it acts on.
#[derive(Clone, Debug)]
pub(crate) struct DeckLine<T> {
    /// The step of the deck; none for what stands before the first one.
    pub step: Option<usize>,
    /// Number of the line among the lines of its kind.
    pub record: u32,
    pub members: Vec<T>,
}

/// Nodes, facets or elements by the lines that act on them. Lines of a step replace those of former steps for the same member; `adds`: several lines of one step for
/// a member are summed up, else the last one counts. `replaces_all`: whether a step ends all lines of former ones (`OP=NEW`).
pub(crate) fn members_by_records<T: Copy + Ord>(
    deck_lines: &[DeckLine<T>],
    steps: usize,
    replaces_all: impl Fn(usize) -> bool,
    timeline: &Timeline,
    adds: bool,
) -> BTreeMap<StageRecords, Vec<T>> {
    let mut of_members: BTreeMap<T, Vec<(Option<usize>, u32)>> = BTreeMap::new();
    for line in deck_lines {
        for &member in &line.members {
            of_members.entry(member).or_default().push((line.step, line.record));
        }
    }
    let mut all: BTreeMap<StageRecords, Vec<T>> = BTreeMap::new();
    for (member, lines) in of_members {
        let in_step = |step: Option<usize>| -> Vec<u32> {
            let mut records: Vec<u32> = lines.iter().filter(|(of, _)| *of == step).map(|(_, record)| *record).collect();
            if !adds && records.len() > 1 {
                records.drain(..records.len() - 1);
            }
            records
        };
        let mut state = in_step(None);
        let mut by_stage = StageRecords::new();
        let mut stages = timeline.stages.iter().filter_map(|stage| stage.step).peekable();
        for step in 0..steps {
            if replaces_all(step) {
                state.clear();
            }
            let own = in_step(Some(step));
            if !own.is_empty() {
                state = own;
            }
            if stages.next_if_eq(&step).is_some() {
                by_stage.push(state.clone());
            }
        }
        // A deck without a step that maps: what its steps have left.
        if by_stage.is_empty() {
            by_stage = vec![state; timeline.stages.len()];
        }
        if by_stage.iter().any(|records| !records.is_empty()) {
            all.entry(by_stage).or_default().push(member);
        }
    }
    all
}
