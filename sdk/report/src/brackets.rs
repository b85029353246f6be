//! Brackets over categories that differ, one above another.

/// A bracket over two categories.
#[derive(Debug, Clone, PartialEq)]
pub struct Bracket {
    /// Index of the left category.
    pub from: usize,
    /// Index of the right category.
    pub to: usize,
    /// Mark on the bracket, such as `"*"`.
    pub label: String,
    /// Hover text.
    pub note: String,
}

/// Assigns brackets to levels from below, so that none on a level overlap; shorter ones are lower where they come first.
pub(crate) fn levels(brackets: &[Bracket]) -> Vec<usize> {
    let mut taken: Vec<Vec<(usize, usize)>> = Vec::new();
    let ends = |b: &Bracket| (b.from.min(b.to), b.from.max(b.to));
    let free = |level: &[(usize, usize)], (from, to): (usize, usize)| {
        level.iter().all(|(a, b)| to <= *a || *b <= from)
    };
    let mut levels = Vec::new();
    for bracket in brackets {
        let own = ends(bracket);
        let level = taken
            .iter()
            .position(|level| free(level, own))
            .unwrap_or(taken.len());
        if level == taken.len() {
            taken.push(Vec::new());
        }
        taken[level].push(own);
        levels.push(level);
    }
    levels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_that_overlap_are_on_different_levels() {
        let bracket = |(from, to)| Bracket {
            from,
            to,
            label: String::new(),
            note: String::new(),
        };
        let all: Vec<Bracket> = [(0, 1), (1, 2), (3, 2), (0, 2), (1, 3)]
            .map(bracket)
            .to_vec();
        assert_eq!(levels(&all), [0, 0, 0, 1, 2]);
    }
}
