//! Flags of this command that set what messages of the libraries describe.

use std::borrow::Cow;

use htex_author::AuthorError;
use htex_author::recording::{ReadError, ReadProblem};

/// Flags by the code of a finding in a recording.
const BY_CODE: &[(&str, &str)] = &[
    ("RECORDING_UNREADABLE", "--map, --rate, --quantity"),
    ("RECORDING_UNUSABLE", "--segments, --from, --to"),
    ("RECORDING_CLOCK_GAP", "--from, --to"),
    ("RECORDING_CLOCK_JITTER", "--rate"),
    ("RECORDING_STUCK", "--from, --to"),
    ("RECORDING_SILENT", "--from, --to, --map"),
    ("RECORDING_SPIKE", "--from, --to"),
    ("RECORDING_FORCE_OUTLIER", "--force"),
    ("RECORDING_FRICTION_IMPLAUSIBLE", "--map"),
    ("RECORDING_SPEED_ZERO", "--speed"),
    ("RECORDING_SPEED_IMPLAUSIBLE", "--map"),
    ("RECORDING_READ_IN_WINDOWS", "--segments sweeps"),
    ("RECORDING_OFF_TARGET", "--speed, --force, --at"),
    ("RECORDING_UNSTEADY", "--from, --to, --at"),
    ("RECORDING_UNEVEN", "--from, --to"),
];

/// Flags that turn on the check of a finding, by its code.
const CHECKED_BY: &[(&str, &str)] = &[
    ("PLUGIN_UNUSABLE", "--embedded-plugins"),
    ("EXTENSION_SCHEMA_BROKEN", "--extension-schema"),
];

/// Flags by words of the reader's warnings, which have no code of their own.
const BY_WORDS: &[(&str, &str)] = &[
    ("give the scale if", "--scale"),
    ("map it with its scale", "--map"),
];

/// Options that messages about scenes and devices name in backquotes, with or without a value (`setting driver=x`), and
/// their flags.
const QUOTED: [(&str, &str); 2] = [("profile", "--profile"), ("setting", "--set")];

/// The flags that help against a finding with this code.
pub(crate) fn of_code(code: &str) -> Option<&'static str> {
    listed(BY_CODE, code)
}

/// The flag of `htex validate` that turns on the check of findings with this code.
pub(crate) fn of_check(code: &str) -> Option<&'static str> {
    listed(CHECKED_BY, code)
}

fn listed(table: &[(&str, &'static str)], code: &str) -> Option<&'static str> {
    let entry = table.iter().find(|(known, _)| *known == code);
    entry.map(|(_, flags)| *flags)
}

/// The flags that help against a finding or a warning, given as a sentence.
fn of_sentence(sentence: &str) -> Option<&'static str> {
    let mut words = sentence.split(|c: char| !c.is_ascii_uppercase() && c != '_');
    words.find_map(of_code).or_else(|| {
        let mut known = BY_WORDS.iter();
        let entry = known.find(|(words, _)| sentence.contains(words));
        entry.map(|(_, flags)| *flags)
    })
}

/// The flags that help against an error of reading a recording.
pub(crate) fn of_read_error(error: &ReadError) -> Option<&'static str> {
    match &error.problem {
        ReadProblem::TooManyValues { .. } => Some("--most-numbers"),
        ReadProblem::Time { .. } | ReadProblem::NoRate => Some("--rate"),
        ReadProblem::Columns { .. } => Some("--map, --quantity"),
        ReadProblem::Lengths { .. } => Some("--map"),
        ReadProblem::Option { option, .. } => match *option {
            "rate_hz" => Some("--rate"),
            "scale" => Some("--scale"),
            "map" => Some("--map"),
            "tracker" => Some("--tracker, --tracker-map"),
            _ => None,
        },
        _ => None,
    }
}

/// The flags that help against an error of measuring a response.
#[cfg(feature = "lab")]
pub(crate) fn of_response_error(error: &htex_lab::response::ResponseError) -> Option<&'static str> {
    use htex_lab::response::ResponseError;
    match error {
        ResponseError::Columns { .. } | ResponseError::Constant { .. } => Some("--input, --output"),
        ResponseError::NoHits { .. } => Some("--input, --continuous"),
        ResponseError::Short { .. } => Some("--window"),
        ResponseError::Option { option, .. } => listed(BY_OPTION, option),
        _ => None,
    }
}

/// Flags by the words for an option of measuring a response.
#[cfg(feature = "lab")]
const BY_OPTION: &[(&str, &str)] = &[
    ("the window (s)", "--window"),
    ("the lowest frequency (Hz)", "--low"),
    ("the highest frequency (Hz)", "--high"),
    ("the limit of the input", "--input-limit"),
    ("the limit of the output", "--output-limit"),
    ("the time before the trigger (s)", "--pre-trigger"),
    ("the trigger", "--trigger"),
    ("the level of a double hit", "--double"),
    ("the force window (s)", "--force-window"),
    ("the exponential window (s)", "--exponential"),
];

/// The flags that help against an error of fitting.
pub(crate) fn of_author_error(error: &AuthorError) -> Option<&'static str> {
    match error {
        AuthorError::NoSegments { .. } => Some("--segments windows"),
        AuthorError::OffTarget { .. } => Some("--speed, --force, --at, --map"),
        AuthorError::NoMotion { .. } => Some("--map, --speed, --force, --grid"),
        AuthorError::NothingSteady { .. } => Some("--map, --grid"),
        AuthorError::GridConstant { .. }
        | AuthorError::GridFew { .. }
        | AuthorError::GridEmpty { .. } => Some("--grid"),
        AuthorError::UnknownConditions { .. } => Some("--at speed=80,force=0.4"),
        AuthorError::Strict { .. } => Some("--strict; `htex explain CODE` describes each"),
        AuthorError::Read(error) => of_read_error(error),
        _ => None,
    }
}

/// A finding or a warning with the flags that help.
pub(crate) fn with_flags(sentence: &str) -> Cow<'_, str> {
    with(sentence, of_sentence(sentence))
}

/// A message with options of scenes and devices as flags, and with the flags that help, before its last stop or colon.
pub(crate) fn with<'a>(message: &'a str, flags: Option<&str>) -> Cow<'a, str> {
    let message = with_quoted(message);
    let Some(flags) = flags else {
        return message;
    };
    let body = message.strip_suffix(['.', ':']).unwrap_or(&message);
    let end = &message[body.len()..];
    Cow::Owned(format!("{body} (see {flags}){end}"))
}

/// The text with the options that it quotes as flags: `--set`.
fn with_quoted(text: &str) -> Cow<'_, str> {
    let mut result = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('`') {
        result.push_str(before);
        result.push('`');
        if let Some((option, flag)) = QUOTED.iter().find(|(option, _)| begins(after, option)) {
            result.push_str(flag);
            rest = &after[option.len()..];
        } else {
            rest = after;
        }
    }
    match result.is_empty() {
        true => Cow::Borrowed(text),
        false => Cow::Owned(result + rest),
    }
}

/// Whether a quotation begins with this option.
fn begins(quoted: &str, option: &str) -> bool {
    let rest = quoted.strip_prefix(option);
    rest.is_some_and(|rest| rest.starts_with(['`', ' ']))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quoted_options_become_flags() {
        for (text, expected) in [
            ("give `profile` X", "give `--profile` X"),
            ("give `setting driver=x`", "give `--set driver=x`"),
            (
                "column `settings`, `profile_`",
                "column `settings`, `profile_`",
            ),
            ("an open ` setting", "an open ` setting"),
        ] {
            assert_eq!(with_flags(text), expected);
        }
    }

    #[test]
    fn flags_follow_what_they_help_against() {
        for (text, expected) in [
            (
                "a.csv: RECORDING_STUCK: constant; leave it out",
                "a.csv: RECORDING_STUCK: constant; leave it out (see --from, --to)",
            ),
            (
                "Samples are assumed to be in N; give the scale if they are not.",
                "Samples are assumed to be in N; give the scale if they are not (see --scale).",
            ),
            (
                "a.csv: RECORDING_CLIPPED: clipped",
                "a.csv: RECORDING_CLIPPED: clipped",
            ),
        ] {
            assert_eq!(with_flags(text), expected);
        }
    }

    #[test]
    fn codes_of_the_tables_are_codes_of_findings() {
        for (code, _) in BY_CODE {
            assert!(htex_author::findings::explain(code).is_some(), "{code}");
        }
        for (code, _) in CHECKED_BY {
            assert!(htex_format::explain(code).is_some(), "{code}");
        }
    }
}
