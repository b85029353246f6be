//! All rules for studies, in one table.

use htex_base::finding::{colophon, rules_page};

const HEAD: &str = "\
# Findings in studies

A finding has a code, a severity, a JSON pointer into the study (`/textures/0/asset`; empty for the file as a whole) and a
message. A study can be run when no finding is an error. Motions, devices and assets follow the rules of scenes as well, with
their codes. Codes never change their meaning.
";

/// Generates the page with all rules: `spec/study-findings.md`.
pub fn findings_page() -> String {
    rules_page(HEAD, RULES) + &colophon("sdk/lab/src/study/rules.rs")
}

htex_base::finding::rule_table! {
    STUDY_FILE_TOO_LARGE Error:
        "The study file is larger than 1 MiB.",
        "A study names its assets and holds none of them; so large a file is probably another one.",
        "Name the study's own file.";
    STUDY_SYNTAX Error:
        "The study is not TOML.",
        "It is a TOML document in UTF-8 (toml.io).",
        "Correct it at the place the message names.";
    STUDY_TOO_DEEP Error:
        "The study nests too deep.",
        "No study needs so many levels.",
        "Remove the unneeded levels.";
    STUDY_TYPE Error:
        "A key is missing or has a value of the wrong type.",
        "The study does not follow `schemas/study-1.json`.",
        "Correct it at the place the pointer names.";
    STUDY_VERSION_MISSING Error:
        "The study has no `htex_study`.",
        "Without the version a reader would have to guess what the rest means.",
        "Add `htex_study = \"1.0\"` as the first line.";
    STUDY_VERSION_INVALID Error:
        "`htex_study` is not a version.",
        "It is a string of two whole numbers without leading zeros, `MAJOR.MINOR`.",
        "Write `htex_study = \"1.0\"`.";
    STUDY_VERSION_UNSUPPORTED Error:
        "The study is of another version.",
        "A study is run exactly as it is written: a key of a newer version must not be ignored.",
        "Update the program, or rewrite the study as version 1.0.";
    STUDY_UNKNOWN_KEY Error:
        "A key is unknown in this version.",
        "An unknown key has no effect, and the study would not be the intended one.",
        "Correct its spelling, or remove it.";
    STUDY_PARTICIPANTS_INVALID Error:
        "The participants cannot be told apart, or there are none or more than 1000.",
        "A participant's name is the name of a file of answers: letters, digits, `-` and `_`, at most 64, different also without case.",
        "Give a number from 1 to 1000, or correct the names.";
    STUDY_TEXTURES_INVALID Error:
        "There is no texture, or there are more than 256.",
        "A study compares textures.",
        "Add a table `[[textures]]` with an asset.";
    STUDY_NAME_INVALID Error:
        "A name is empty, longer than 100 characters, has control characters, or occurs twice.",
        "Results are told apart by the names of textures, models and attributes.",
        "Give each another `name`.";
    STUDY_MODELS_INVALID Error:
        "There is no model, there are more than 64, or the hidden reference is one of them.",
        "Each texture is played with each model, and the hidden reference in addition.",
        "Correct `models`, or remove the model from one of the two.";
    STUDY_TOO_LARGE Error:
        "The study has too many trials.",
        "A session of more than 100,000 trials, or a plan of more than a million, is a mistake.",
        "Lower the repetitions, the textures or the models.";
    STUDY_NUMBER_INVALID Error:
        "A number is out of its range.",
        "The message names the range.",
        "Correct it, or leave it out for the default.";
    STUDY_SCALE_INVALID Error:
        "The scale is not two whole numbers from 0 to 9, the lower first.",
        "A rating is one press of a digit.",
        "Write `min` below `max`, such as 0 and 6.";
    STUDY_PHASES_INVALID Error:
        "A phase occurs twice, or `testing` is missing.",
        "A study without testing has no results.",
        "Write `phases = [\"training\", \"gain\", \"testing\"]`, without those that you do not need.";
    STUDY_PHASE_UNUSED Error:
        "A phase has settings and does not take place.",
        "The settings would be ignored.",
        "Add the phase to `phases`, or remove its table.";
}
