//! All rules for tables of ratings and of spectra, in one table.

use htex_format::{Rule, rules_page};

const HEAD: &str = "\
# Findings in tables of ratings and of spectra

Generated from the table of rules in `sdk/lab/src/analyse/rules.rs` by
`cargo xtask generate`.

`htex study analyse` checks its CSV files. A finding has a code, a severity, a pointer and a message. The pointer is the line
of the file, counted from 1 with the header, and the column by name: `/12/rating`; it is empty for the file as a whole. A table
with an error is not analysed. Codes never change their meaning.
";

/// The rule of a code, such as `RATING_INVALID`, or of a code of the format (`FINDINGS_TRUNCATED`); `None` if no rule has
/// this code.
pub fn explain(code: &str) -> Option<&'static Rule> {
    RULES
        .iter()
        .find(|rule| rule.code == code)
        .or_else(|| htex_format::explain(code))
}

/// The page with all rules: `spec/analysis-findings.md`.
pub fn findings_page() -> String {
    rules_page(HEAD, RULES)
}

htex_format::rule_table! {
    TABLE_TOO_LARGE Error:
        "The file is larger than 256 MiB.",
        "A reader limits what it reads from an untrusted file.",
        "Name the table of ratings or of spectra; a study of a thousand people takes a few megabytes.";
    TABLE_NOT_UTF8 Error:
        "The file is not text in UTF-8.",
        "Names with other encodings would be read as other names.",
        "Save it as CSV in UTF-8.";
    TABLE_EMPTY Error:
        "The table has no rows.",
        "There is nothing to analyse.",
        "Name a table with a header line and a line for each answer.";
    TABLE_COLUMN_MISSING Error:
        "A column is missing.",
        "Columns are found by the names of the first line.",
        "Name the columns as the message lists them, separated by commas.";
    TABLE_COLUMN_DUPLICATE Error:
        "Two columns have the same name.",
        "It is undefined which of them holds the values.",
        "Remove or rename one.";
    TABLE_COLUMN_UNKNOWN Info:
        "A column is not used.",
        "Tables may hold more than the analysis needs.",
        "Nothing, unless its name is misspelt.";
    TABLE_FIELDS Error:
        "A line has another number of fields than the header.",
        "Its values would be read from the wrong columns.",
        "Correct the line; a field with a comma is written in quotation marks.";
    TABLE_NAME_EMPTY Error:
        "A name is empty.",
        "Every value belongs to a participant, a texture and a model.",
        "Fill it in, or remove the line.";
    RATING_INVALID Error:
        "A rating is not a number.",
        "A missing answer cannot be guessed.",
        "Write a number with a decimal point; remove the line of an answer that was not given.";
    RATING_OFF_SCALE Error:
        "A rating is not on the scale that was given (--scale).",
        "It is a slip of typing, or the rating of another study.",
        "Correct it, or remove the line; give the study's scale as in `--scale 0-6`.";
    RATING_DUPLICATE Error:
        "The same trial is rated twice.",
        "Participant, texture, model and repetition name one trial; it is undefined which of its ratings counts.",
        "Remove one of the lines, or number the repetitions.";
    RATINGS_CELL_MISSING Error:
        "A participant has not rated a model in a texture.",
        "Tests of repeated measures compare all conditions within each participant.",
        "Complete the study, or leave out the participant (--leave-out-incomplete).";
    RATINGS_LEFT_OUT Warning:
        "A participant with missing ratings was left out.",
        "It was asked for. Results hold for those who completed the study.",
        "State it where the results are published.";
    RATINGS_NONE_COMPLETE Error:
        "No participant has rated every model in every texture.",
        "Nothing is left to compare.",
        "Check the names of textures and models for variants of spelling.";
    RATINGS_TOO_MANY_CONDITIONS Error:
        "There are more than 1000 combinations of textures and models.",
        "A limit for untrusted files; the tests compare all conditions with one another.",
        "Analyse a part of the study.";
    RATINGS_UNBALANCED Warning:
        "Conditions have different numbers of repetitions.",
        "Tests use the mean of each condition, and those of fewer repetitions vary more.",
        "Complete the study, or state it where the results are published.";
    RATINGS_PARTICIPANT_CONSTANT Warning:
        "A participant gave all conditions the same rating.",
        "Such answers tell no condition from another; their z-scores are taken as 0.",
        "Check whether the participant understood the scale.";
    RATINGS_ATTRIBUTES Error:
        "The table has ratings of several attributes.",
        "Ratings of roughness and of similarity cannot be averaged.",
        "Export one attribute (`htex study export --attribute`), or keep the lines of one.";
    RATINGS_HIDDEN_REFERENCE Info:
        "Lines of hidden references are not analysed.",
        "A hidden reference is the real texture compared with itself; it shows who can rate, and is no model.",
        "Nothing.";
    RATINGS_SIMULATED Warning:
        "Ratings are of simulated participants.",
        "They show that a study works, and nothing about people.",
        "Do not publish them as results.";
    SPECTRA_GRID_INVALID Error:
        "The columns of magnitudes are not 20, 25, ..., 1000 Hz.",
        "Spectra are compared bin by bin.",
        "Write a column for each frequency from 20 to 1000 Hz in steps of 5, named by its number.";
    SPECTRA_MAGNITUDE_INVALID Error:
        "A magnitude is not a number of at least 0.",
        "Magnitudes of a texture spectrum are forces in newtons, or all in another unit.",
        "Correct it, or remove the line.";
    SPECTRA_DUPLICATE Error:
        "A spectrum is given twice.",
        "It is undefined which of them was felt.",
        "Remove one, or number them in a column `repetition`: their magnitudes are averaged.";
    SPECTRA_RECORDED_MISSING Error:
        "The recorded spectrum of a texture is missing.",
        "Felt spectra are compared with that of the real texture.",
        "Add a line with `recorded` as participant and as model.";
    SPECTRA_CELL_MISSING Error:
        "The felt spectrum of a rated condition is missing.",
        "The regression needs ratings and spectra of the same conditions.",
        "Add it, or analyse the ratings alone.";
    SPECTRA_UNRATED Info:
        "A felt spectrum has no rating and is not used.",
        "Conditions are those of the ratings.",
        "Nothing, unless its names are misspelt.";
}
