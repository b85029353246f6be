//! Shows settings in messages of the libraries as flags of this command.

use std::borrow::Cow;

use htex_base::finding::Hint;

/// Settings that messages about scenes and devices name in backquotes, with or without a value
/// (`setting driver=x`), and the flags for them.
const QUOTED: [(&str, &str); 2] = [("profile", "--profile"), ("setting", "--set")];

/// Returns the settings of a hint as flags. A setting has the same name as its flag.
pub(crate) fn flags_of(hint: Hint) -> Option<String> {
    let flag = |setting: &&str| format!("--{}", setting.replace('_', "-"));
    let flags: Vec<String> = hint.settings().iter().map(flag).collect();
    (!flags.is_empty()).then(|| flags.join(", "))
}

/// Adds the flags that would fix the problem to a message.
pub(crate) fn with_hint(message: &str, hint: Hint) -> Cow<'_, str> {
    with_flags(message, flags_of(hint))
}

/// Shows settings of scenes and devices in a message as flags, and adds the flags that would fix
/// the problem before its last stop or colon.
pub(crate) fn with_flags(message: &str, flags: Option<String>) -> Cow<'_, str> {
    let message = with_quoted(message);
    let Some(flags) = flags else {
        return message;
    };
    let body = message.strip_suffix(['.', ':']).unwrap_or(&message);
    let end = &message[body.len()..];
    Cow::Owned(format!("{body} (see {flags}){end}"))
}

/// Shows settings that a message about scenes or devices quotes as flags, e.g. `--set`.
pub(crate) fn with_quoted(text: &str) -> Cow<'_, str> {
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
    if result.is_empty() { Cow::Borrowed(text) } else { Cow::Owned(result + rest) }
}

/// Whether a quotation begins with this option.
fn begins(quoted: &str, option: &str) -> bool {
    let rest = quoted.strip_prefix(option);
    rest.is_some_and(|rest| rest.starts_with(['`', ' ']))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::rules::rules;

    #[test]
    fn quoted_settings_become_flags() {
        for (text, expected) in [
            ("give `profile` X", "give `--profile` X"),
            ("give `setting driver=x`", "give `--set driver=x`"),
            ("column `settings`, `profile_`", "column `settings`, `profile_`"),
            ("an open ` setting", "an open ` setting"),
        ] {
            assert_eq!(with_hint(text, Hint::NONE), expected);
        }
    }

    #[test]
    fn flags_stand_before_the_end_of_the_sentence() {
        let hint = Hint::new(&["from", "most_numbers"]);
        for (text, expected) in [
            ("leave it out", "leave it out (see --from, --most-numbers)"),
            ("Leave it out.", "Leave it out (see --from, --most-numbers)."),
        ] {
            assert_eq!(with_hint(text, hint), expected);
        }
    }

    #[test]
    fn hints_of_rules_are_flags_of_the_command() {
        let mut known = BTreeSet::new();
        for command in crate::command().get_subcommands() {
            known
                .extend(command.get_arguments().filter_map(clap::Arg::get_long).map(str::to_owned));
        }
        for rule in rules() {
            for setting in [rule.hint, rule.checked_by].iter().flat_map(|hint| hint.settings()) {
                let flag = setting.split(' ').next().unwrap_or_default().replace('_', "-");
                assert!(known.contains(&flag), "{}: {flag}", rule.code);
            }
        }
    }
}
