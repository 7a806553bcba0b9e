//! Names that a misspelt one may have meant.

/// The known names nearest to a wrong one, at most five, nearest first.
pub(super) fn near_names<'a>(wrong: &str, known: &[&'a str]) -> Vec<&'a str> {
    let wrong = wrong.to_lowercase();
    let mut scored: Vec<(usize, &str)> = known.iter().filter_map(|&name| Some((score(&wrong, name)?, name))).collect();
    scored.sort_unstable();
    scored.dedup();
    scored.into_iter().take(5).map(|(_, name)| name).collect()
}

/// How far a name is, if it is near at all: a third of its letters may differ, or one contains the other.
fn score(wrong: &str, name: &str) -> Option<usize> {
    let distance = edits(wrong, name);
    let contains = wrong.len() >= 3 && name.len() >= 3 && (name.contains(wrong) || wrong.contains(name));
    (distance <= 1 + wrong.chars().count() / 3 || contains).then_some(distance)
}

/// Levenshtein's distance: letters inserted, removed or changed.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, &y) in b.iter().enumerate() {
            let changed = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
