//! What a package installs beside the command: completions, manual pages; and what `--version`
//! says.

use std::fs;

use crate::common::{Place, Run};

fn text(place: &Place, arguments: &[&str]) -> String {
    let output = place.command(arguments).output().unwrap();
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    assert_eq!(Run::of(output).code(), 0, "{arguments:?}");
    text
}

/// The subcommands that `htex --help` lists.
fn subcommands(help: &str) -> Vec<&str> {
    let lines = help.lines().skip_while(|line| !line.starts_with("Usage:")).skip(1);
    let lists = lines.take_while(|line| *line != "Options:");
    lists
        .filter(|line| line.starts_with("  "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect()
}

#[test]
fn every_subcommand_has_a_manual_page_and_is_completed() {
    let place = Place::new();
    let help = text(&place, &["-h"]);
    let names = subcommands(&help);
    assert!(names.len() > 20, "{names:?}");
    text(&place, &["man", "pages"]);
    let scripts = ["bash", "zsh", "fish", "powershell"]
        .map(|shell| (shell, text(&place, &["completions", shell])));
    for name in names {
        let page = fs::read_to_string(place.path(&format!("pages/htex-{name}.1")))
            .unwrap_or_else(|error| panic!("htex-{name}.1: {error}"));
        assert!(page.contains(".SH SYNOPSIS"), "{page}");
        for (shell, script) in &scripts {
            assert!(script.contains(name), "{shell} does not complete {name}");
        }
    }
    let options = fs::read_to_string(place.path("pages/htex-fit.1")).unwrap();
    assert!(options.contains("embed\\-plugin"), "{options}");
}

#[test]
fn a_shell_reads_its_completions() {
    let place = Place::new();
    place.write("htex.bash", text(&place, &["completions", "bash"]));
    let mut bash = std::process::Command::new("bash");
    bash.args(["-c", "source htex.bash && COMP_WORDS=(htex im) COMP_CWORD=1 && _htex htex im htex && echo ${COMPREPLY[@]}"]);
    let Ok(output) = bash.current_dir(place.path("")).output() else {
        return;
    };
    let completed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(completed.trim(), "import");
}

#[test]
fn the_version_says_what_was_built() {
    let place = Place::new();
    let version = text(&place, &["--version"]);
    let (first, rest) = version.split_once('\n').unwrap();
    assert_eq!(first, format!("htex {}", env!("CARGO_PKG_VERSION")));
    for word in ["commit: ", "target: ", "features: "] {
        let line = rest.lines().find_map(|line| line.strip_prefix(word));
        assert!(line.is_some_and(|line| !line.is_empty()), "{version}");
    }
    assert_eq!(text(&place, &["-V"]).trim_end(), first);
}
