//! The groups of subcommands in `htex --help`.

use std::fmt::Write as _;

use clap::Command;

/// Each group's heading and its subcommands, in the order of the help.
const GROUPS: [(&str, &[&str]); 8] = [
    (
        "Make textures",
        &["demo", "simulate", "process", "fit", "make", "mix", "edit", "import", "tradeoff"],
    ),
    ("Inspect", &["info", "spectrum", "compare", "validate", "explain", "formats"]),
    ("Play", &["synth", "play", "render", "plan", "gain", "export", "bake"]),
    ("Libraries", &["build", "lib"]),
    ("Plugins and devices", &["plugin", "device", "registry", "conformance"]),
    ("Signatures", &["key", "sign", "verify"]),
    ("Laboratory", &["record", "response", "study", "studio"]),
    ("Tools", &["completions", "man", "schema"]),
];

/// Lists the subcommands of a command in their groups, because clap itself supports only one group.
pub(crate) fn with_groups(command: Command) -> Command {
    let mut lists = String::new();
    for (heading, names) in GROUPS {
        let found = names.iter().filter_map(|name| command.find_subcommand(name));
        let found = found.filter(|one| !one.is_hide_set());
        let lines: String = found.map(line).collect();
        if !lines.is_empty() {
            let _ = write!(lists, "{heading}:\n{lines}\n");
        }
    }
    command.help_template(format!(
        "{{before-help}}{{about-with-newline}}\n{{usage-heading}} {{usage}}\n\n{lists}Options:\n\
         {{options}}{{after-help}}"
    ))
}

fn line(command: &Command) -> String {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    format!("  {:11}  {about}\n", command.get_name())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_visible_subcommand_is_in_a_group_and_on_a_short_line() {
        let command = crate::command();
        let visible = command.get_subcommands().filter(|one| !one.is_hide_set());
        for subcommand in visible {
            let name = subcommand.get_name();
            let groups = GROUPS.iter().filter(|(_, names)| names.contains(&name));
            assert_eq!(groups.count(), 1, "{name}");
            let line = line(subcommand);
            assert!(line.trim_end().chars().count() <= 60, "{line}");
        }
        for name in GROUPS.iter().flat_map(|(_, names)| *names) {
            assert!(command.find_subcommand(name).is_some(), "{name}");
        }
    }
}
