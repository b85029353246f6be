//! Plans are balanced, and the same on every machine.

use std::collections::BTreeMap;

use htex_base::finding::Findings;
use htex_lab::study::{Plan, Study, Trial, read_study};
use proptest::prelude::*;

const ORDERS: [&str; 5] =
    ["random", "blocked_by_repetition", "blocked_by_texture", "latin_square", "williams_square"];

fn study(text: &str) -> Study {
    let head = "htex_study = '1.0'\nmotion = 'live'\ndevice = { adapter = 'file' }\n";
    let mut findings = Findings::default();
    let study = read_study(format!("{head}{text}").as_bytes(), &mut findings);
    study.unwrap_or_else(|| unreachable!("{:?}", findings.into_list()))
}

fn of(order: &str, textures: usize, models: usize, repetitions: usize, seed: u64) -> Study {
    let models: Vec<String> = (0..models).map(|i| format!("\"m{i}\"")).collect();
    let mut text = format!(
        "order = '{order}'\nseed = {seed}\nrepetitions = {repetitions}\nparticipants = 7\nmodels = [{}]\n",
        models.join(", ")
    );
    for i in 0..textures {
        text += &format!("[[textures]]\nasset = 't{i}.htex'\n");
    }
    study(&text)
}

fn condition(trial: &Trial) -> (String, String) {
    (trial.texture.clone(), trial.model.clone())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_condition_is_rated_as_often_as_asked(
        order in 0usize..5, textures in 1usize..5, models in 1usize..6, repetitions in 1usize..5, seed in 0u64..1 << 40,
    ) {
        let study = of(ORDERS[order], textures, models, repetitions, seed);
        let plan = Plan::new(&study);
        prop_assert_eq!(&plan, &Plan::new(&study));
        for participant in &plan.participants {
            let mut seen: BTreeMap<_, Vec<u32>> = BTreeMap::new();
            for (i, trial) in participant.trials.iter().enumerate() {
                prop_assert_eq!(trial.number as usize, i + 1);
                seen.entry(condition(trial)).or_default().push(trial.repetition);
            }
            prop_assert_eq!(seen.len(), textures * models);
            let all: Vec<u32> = (1..=repetitions as u32).collect();
            prop_assert!(seen.values().all(|repetitions| *repetitions == all));
            prop_assert_eq!(participant.gain.len(), textures);
            if order == 2 {
                let mut blocks: Vec<&str> = participant.trials.iter().map(|t| &t.texture[..]).collect();
                blocks.dedup();
                prop_assert_eq!(blocks.len(), textures, "one block for each texture");
            }
            // Blocks, and rows of squares, contain each condition once.
            if [1, 3, 4].contains(&order) {
                for block in participant.trials.chunks(textures * models) {
                    let first = block[0].repetition;
                    prop_assert!(block.iter().all(|trial| trial.repetition == first));
                }
            }
        }
    }
}

/// Over as many rows as the square has, each condition occurs once at each place and follows every
/// other condition once.
#[test]
fn participants_together_make_a_whole_square() {
    let mut study = of("williams_square", 2, 2, 1, 3);
    study.participants = htex_lab::study::Participants::Count(4);
    let plan = Plan::new(&study);
    let rows: Vec<Vec<_>> =
        plan.participants.iter().map(|p| p.trials.iter().map(condition).collect()).collect();
    let mut pairs: Vec<_> = rows.iter().flat_map(|row| row.windows(2)).collect();
    pairs.sort();
    pairs.dedup();
    assert_eq!(pairs.len(), 4 * 3, "each ordered pair once");
    for place in 0..4 {
        let mut at: Vec<_> = rows.iter().map(|row| &row[place]).collect();
        at.sort();
        at.dedup();
        assert_eq!(at.len(), 4, "place {place}");
    }
}

/// These hashes come from a plan made on x86-64 Linux. Other machines must give the same.
#[test]
fn a_seed_has_the_same_plan_on_every_machine() {
    let golden = [
        "980c2874569a3f56",
        "0688a32888e4a8d2",
        "6f4dbef4f62ce6f6",
        "f5db5c191f56be1e",
        "b210002cd7f12619",
    ];
    for (order, golden) in ORDERS.into_iter().zip(golden) {
        let study = of(order, 5, 5, 5, 42);
        let json = serde_json::to_vec(&Plan::new(&study)).unwrap();
        let hash = blake3::hash(&json).to_hex();
        assert_eq!(&hash[..16], golden, "{order}");
    }
}

#[test]
fn the_defaults_are_the_papers_study() {
    let study = study("[[textures]]\nasset = 'sub/fine fabric.htex'\n");
    assert_eq!(study.models, ["ar", "mfcc", "speak", "sbeta", "sslope"]);
    assert_eq!((study.repetitions, study.trial_s), (5, 10.0));
    assert_eq!((study.scale.min, study.scale.max), (0, 6));
    assert_eq!((&study.scale.low[..], &study.scale.high[..]), ("Different", "Same"));
    let plan = Plan::new(&study);
    assert_eq!(plan.participants.len(), 14);
    assert_eq!(plan.participants[6].participant, "P07");
    assert_eq!(plan.participants[0].gain, ["fine fabric"]);
    assert_ne!(plan.participants[0].trials, plan.participants[1].trials);
}
