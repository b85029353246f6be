//! For every rule of studies, there is a study that breaks it.

use std::collections::BTreeSet;

use htex_base::finding::Findings;
use htex_lab::study::{RULES, findings_page, read_study, study_schema};

const STUDY: &str = "htex_study = '1.0'\nmotion = 'live'\ndevice = { adapter = 'file' }\n";
const TEXTURE: &str = "[[textures]]\nasset = 'vinyl.htex'\n";

/// The text before the textures (in place of `STUDY` if it has a version), the code, and the
/// pointer.
const CASES: &[(&str, &str, &str)] = &[
    ("a = [", "STUDY_SYNTAX", ""),
    ("repetitions = 'five'", "STUDY_TYPE", "/repetitions"),
    ("participants = 9000000000", "STUDY_PARTICIPANTS_INVALID", "/participants"),
    ("participants = -3", "STUDY_TYPE", "/participants"),
    ("trial_s = nan", "STUDY_TYPE", "/trial_s"),
    ("order = 'shuffled'", "STUDY_TYPE", "/order"),
    ("version motion = 'live'", "STUDY_SYNTAX", ""),
    ("repetition = 5", "STUDY_UNKNOWN_KEY", "/repetition"),
    ("gain = { start = 3 }", "STUDY_UNKNOWN_KEY", "/gain/start"),
    ("participants = 0", "STUDY_PARTICIPANTS_INVALID", "/participants"),
    ("participants = ['a', 'A']", "STUDY_PARTICIPANTS_INVALID", "/participants/1"),
    ("participants = ['../a']", "STUDY_PARTICIPANTS_INVALID", "/participants/0"),
    ("models = ['ar', 'ar']", "STUDY_NAME_INVALID", "/models/1"),
    ("models = []", "STUDY_MODELS_INVALID", "/models"),
    ("models = ['auto']", "STUDY_MODELS_INVALID", "/models/0"),
    ("hidden_reference = 'ar'", "STUDY_MODELS_INVALID", "/hidden_reference"),
    ("attributes = []", "STUDY_NUMBER_INVALID", "/attributes"),
    ("attributes = [{ name = '', question = '?' }]", "STUDY_NAME_INVALID", "/attributes/0"),
    ("repetitions = 0", "STUDY_NUMBER_INVALID", "/repetitions"),
    ("trial_s = 0", "STUDY_NUMBER_INVALID", "/trial_s"),
    ("training = { trials = 0 }", "STUDY_NUMBER_INVALID", "/training/trials"),
    ("rests = { every = 0 }", "STUDY_NUMBER_INVALID", "/rests/every"),
    ("masking_noise = { level_dbfs = 0 }", "STUDY_NUMBER_INVALID", "/masking_noise/level_dbfs"),
    ("gain = { lowest_db = 3 }", "STUDY_NUMBER_INVALID", "/gain/lowest_db"),
    ("scale = { min = 6, max = 0 }", "STUDY_SCALE_INVALID", "/scale"),
    ("scale = { max = 10 }", "STUDY_SCALE_INVALID", "/scale"),
    ("phases = ['training']", "STUDY_PHASES_INVALID", "/phases"),
    ("phases = ['testing', 'testing']", "STUDY_PHASES_INVALID", "/phases"),
    ("phases = ['testing']\ngain = { model = 'ar' }", "STUDY_PHASE_UNUSED", "/gain"),
    ("participants = 1000\nrepetitions = 1000", "STUDY_TOO_LARGE", ""),
];

/// Whole files.
const FILES: &[(&str, &str, &str)] = &[
    ("", "STUDY_VERSION_MISSING", ""),
    ("htex_study = 1", "STUDY_VERSION_INVALID", "/htex_study"),
    ("htex_study = '2.0'", "STUDY_VERSION_UNSUPPORTED", "/htex_study"),
    ("htex_study = '1.7'", "STUDY_VERSION_UNSUPPORTED", "/htex_study"),
    ("htex_study = '1.0'", "STUDY_TYPE", ""),
    (
        "htex_study = '1.0'\nmotion = 'live'\ndevice = {}\ntextures = []",
        "STUDY_TEXTURES_INVALID",
        "/textures",
    ),
];

fn found(text: &str) -> Vec<(String, String)> {
    let mut findings = Findings::default();
    let study = read_study(text.as_bytes(), &mut findings);
    let all = findings.into_list();
    assert_eq!(study.is_some(), all.is_empty(), "{text}");
    all.into_iter().map(|f| (f.code, f.pointer)).collect()
}

#[test]
fn every_rule_is_broken_by_a_study() {
    assert_eq!(found(&format!("{STUDY}{TEXTURE}")), []);
    let deep = format!("{STUDY}x = {}{}\n{TEXTURE}", "[".repeat(20), "]".repeat(20));
    let large = format!("{STUDY}{TEXTURE}# {}", "x".repeat(1 << 20));
    let twice = format!("{STUDY}{TEXTURE}{TEXTURE}");
    let given =
        CASES.iter().map(|(text, code, at)| (format!("{STUDY}{text}\n{TEXTURE}"), *code, *at));
    let whole = FILES.iter().map(|(text, code, at)| (text.to_string(), *code, *at));
    let made = [
        (deep, "STUDY_TOO_DEEP", ""),
        (large, "STUDY_FILE_TOO_LARGE", ""),
        (twice, "STUDY_NAME_INVALID", "/textures/1"),
    ];
    let mut broken = BTreeSet::new();
    for (text, code, pointer) in given.chain(whole).chain(made) {
        let expected = (code.to_owned(), pointer.to_owned());
        let found = found(&text);
        assert!(found.contains(&expected), "{}: {found:?}", &text[..text.len().min(300)]);
        broken.insert(code);
    }
    let all: BTreeSet<&str> = RULES.iter().map(|rule| rule.code).collect();
    assert_eq!(broken, all);
}

#[test]
fn a_syntax_error_says_its_line() {
    let mut findings = Findings::default();
    read_study(b"htex_study = '1.0'\nseed = = 3\n", &mut findings);
    let message = &findings.into_list()[0].message;
    assert!(message.starts_with("line 2, column 8: "), "{message}");
}

#[test]
fn generated_page_and_schema_are_fresh() {
    xtask::generated::file("spec/study-findings.md", findings_page().as_bytes());
    let text = format!("{:#}\n", study_schema());
    xtask::generated::file("spec/schemas/study-1.json", text.as_bytes());
}
