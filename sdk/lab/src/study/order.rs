//! Orders the trials of one participant.

use crate::study::Study;
use crate::study::file::Order;
use crate::study::random::Dice;

/// A texture in a model, both as indices. The model index after the last model is the hidden
/// reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Condition {
    pub(crate) texture: usize,
    pub(crate) model: usize,
}

/// Returns all conditions, texture by texture.
pub(crate) fn conditions(study: &Study) -> Vec<Condition> {
    let models = study.all_models().len();
    let of = |texture| (0..models).map(move |model| Condition { texture, model });
    (0..study.textures.len()).flat_map(of).collect()
}

/// Returns the conditions of all trials of a participant, in order. `index` is the participant's
/// place in the list.
pub(crate) fn order(study: &Study, index: usize, name: &str) -> Vec<Condition> {
    let all = conditions(study);
    let mut dice = Dice::new(study.seed, &["order", name]);
    let repetitions = study.repetitions as usize;
    match study.order {
        Order::Random => {
            let mut trials = all.repeat(repetitions);
            dice.shuffle(&mut trials);
            trials
        }
        Order::BlockedByRepetition => blocks(&all, repetitions, &mut dice),
        Order::BlockedByTexture => by_texture(&all, study, &mut dice),
        Order::LatinSquare => rows(study, &all, index, &latin),
        Order::WilliamsSquare => rows(study, &all, index, &williams),
    }
}

fn blocks(all: &[Condition], repetitions: usize, dice: &mut Dice) -> Vec<Condition> {
    let mut trials = Vec::new();
    for _ in 0..repetitions {
        let mut block = all.to_vec();
        dice.shuffle(&mut block);
        trials.extend(block);
    }
    trials
}

fn by_texture(all: &[Condition], study: &Study, dice: &mut Dice) -> Vec<Condition> {
    let mut trials = Vec::new();
    for texture in dice.permutation(study.textures.len()) {
        let own = all.iter().copied().filter(|c| c.texture == texture);
        let mut block = own.collect::<Vec<_>>().repeat(study.repetitions as usize);
        dice.shuffle(&mut block);
        trials.extend(block);
    }
    trials
}

/// Returns a participant's rows of a square, one for each repetition. The participants take the
/// rows one after another. The assignment of conditions to symbols and the order of the rows are
/// shuffled once for the whole study.
fn rows(
    study: &Study,
    all: &[Condition],
    participant: usize,
    square: &dyn Fn(usize) -> Vec<Vec<usize>>,
) -> Vec<Condition> {
    let mut dice = Dice::new(study.seed, &["square"]);
    let symbols = dice.permutation(all.len());
    let mut rows = square(all.len());
    dice.shuffle(&mut rows);
    let repetitions = study.repetitions as usize;
    let first = participant * repetitions;
    let own = (first..first + repetitions).map(|row| &rows[row % rows.len()]);
    own.flatten().map(|symbol| all[symbols[*symbol]]).collect()
}

/// Returns a Latin square: n rows of n symbols, with each symbol once in each row and in each
/// column. The columns of a cyclic square are permuted at random (always in the same way), because
/// in a cyclic square each symbol would always follow the same one. `rows` shuffles the rows.
fn latin(count: usize) -> Vec<Vec<usize>> {
    let columns = Dice::new(count as u64, &["columns"]).permutation(count);
    let row = |row| columns.iter().map(|at| (row + at) % count).collect();
    (0..count).map(row).collect()
}

/// Returns a Williams square: n rows for an even number of symbols, 2n for an odd one. Each ordered
/// pair of different symbols is adjacent equally often (Williams 1949, "Experimental designs
/// balanced for the estimation of residual effects of treatments").
fn williams(count: usize) -> Vec<Vec<usize>> {
    // 0, 1, n-1, 2, n-2, …: all differences between neighbours are different.
    let first: Vec<usize> = (0..count)
        .map(|at| match at {
            0 => 0,
            odd if odd % 2 == 1 => odd.div_ceil(2),
            even => count - even / 2,
        })
        .collect();
    let row = |add: usize| first.iter().map(|at| (at + add) % count).collect();
    let mut rows: Vec<Vec<usize>> = (0..count).map(row).collect();
    // For an odd number, the rows alone do not balance which symbol follows which; their mirror
    // images do.
    if count % 2 == 1 {
        let mirrored: Vec<Vec<usize>> =
            rows.iter().map(|row| row.iter().rev().copied().collect()).collect();
        rows.extend(mirrored);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check_latin(rows: &[Vec<usize>], count: usize, each: usize) {
        for column in 0..count {
            let mut seen = vec![0; count];
            rows.iter().for_each(|row| seen[row[column]] += 1);
            assert!(seen.iter().all(|times| *times == each), "column {column}");
        }
        for row in rows {
            let mut sorted = row.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..count).collect::<Vec<_>>());
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn squares_are_balanced(count in 1usize..40) {
            check_latin(&latin(count), count, 1);
            let rows = williams(count);
            let each = rows.len() / count;
            check_latin(&rows, count, each);
            let mut follows = vec![vec![0; count]; count];
            for pair in rows.iter().flat_map(|row| row.windows(2)) {
                follows[pair[0]][pair[1]] += 1;
            }
            for (a, row) in follows.iter().enumerate() {
                for (b, times) in row.iter().enumerate() {
                    prop_assert_eq!(*times, if a == b { 0 } else { each });
                }
            }
        }
    }
}
