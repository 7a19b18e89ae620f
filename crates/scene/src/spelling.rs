//! Words that are not known, and the nearest ones that are.

/// Remedy for an unknown word: the nearest known one, and the list.
pub fn known<'n>(word: &str, names: impl IntoIterator<Item = &'n str> + Clone) -> String {
    let list = names.clone().into_iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    match nearest(word, names) {
        Some(name) => format!("did you mean `{name}`? The choices are {list}"),
        None => format!("the choices are {list}"),
    }
}

/// The candidate nearest to `word` by edit distance, if it is near enough to be meant.
pub(crate) fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let limit = (word.chars().count() / 3).max(1) + 1;
    candidates
        .into_iter()
        .map(|candidate| (edit_distance(word, candidate), candidate))
        .filter(|&(distance, _)| distance <= limit)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// Levenshtein distance: insertions, deletions and substitutions that turn `a` into `b`, case aside. Words longer than 64
/// characters are never near.
fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().take(65).flat_map(char::to_lowercase).collect();
    let b: Vec<char> = b.chars().take(65).flat_map(char::to_lowercase).collect();
    if a.len() > 64 || b.len() > 64 {
        return usize::MAX;
    }
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, &x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_textbook_words() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("Flaw", "lawn"), 2);
    }

    #[test]
    fn only_near_words_are_suggested() {
        assert_eq!(nearest("desnity", ["velocity", "density"]), Some("density"));
        assert_eq!(nearest("colour", ["velocity", "density"]), None);
    }
}
