//! Options of the libraries as flags of this command.

use std::borrow::Cow;

/// Options that messages of the libraries name in backquotes, with or without a value (`rate`, `map lateral=fx`), and their
/// flags.
const FLAGS: [(&str, &str); 14] = [
    ("at", "--at"),
    ("force", "--force"),
    ("from", "--from"),
    ("map", "--map"),
    ("most_numbers", "--most-numbers"),
    ("profile", "--profile"),
    ("quantity", "--quantity"),
    ("rate", "--rate"),
    ("scale", "--scale"),
    ("segments", "--segments"),
    ("setting", "--set"),
    ("speed", "--speed"),
    ("strict", "--strict"),
    ("to", "--to"),
];

/// The text with the options as flags: `--rate`.
pub(crate) fn with_flags(text: &str) -> Cow<'_, str> {
    let mut result = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('`') {
        result.push_str(before);
        result.push('`');
        if let Some((option, flag)) = FLAGS.iter().find(|(option, _)| begins(after, option)) {
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

#[test]
fn options_become_flags() {
    for (text, expected) in [
        ("give `rate` HZ", "give `--rate` HZ"),
        ("`from`, `to`", "`--from`, `--to`"),
        ("with `map speed=V:1000`", "with `--map speed=V:1000`"),
        ("give `setting driver=x`", "give `--set driver=x`"),
        ("by `most_numbers`", "by `--most-numbers`"),
        ("column `speeds`, `to_`", "column `speeds`, `to_`"),
        ("`model`: at", "`model`: at"),
        ("an open ` rate", "an open ` rate"),
    ] {
        assert_eq!(with_flags(text), expected);
    }
}
