//! Generates pages that list rules.

use std::fmt::{Arguments, Write};

use crate::finding::Rule;

/// Generates a page of rules: first `head`, then a table of all codes, then the description of each
/// rule.
pub fn rules_page(head: &str, rules: &[Rule]) -> String {
    let mut page = format!("{head}\n| code | severity | what was found |\n|---|---|---|\n");
    for rule in rules {
        let anchor = rule.code.to_ascii_lowercase();
        let (code, severity, summary) = (rule.code, rule.severity, rule.summary);
        push(&mut page, format_args!("| [{code}](#{anchor}) | {severity} | {summary} |\n"));
    }
    for rule in rules {
        push(
            &mut page,
            format_args!(
                "\n## {}\n\n{}: {}\n\n{}\n\n**What to do:** {}\n",
                rule.code, rule.severity, rule.summary, rule.explanation, rule.fix
            ),
        );
    }
    page
}

fn push(page: &mut String, text: Arguments<'_>) {
    // Writing to a string cannot fail.
    let _ = page.write_fmt(text);
}
