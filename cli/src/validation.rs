//! Prints validation reports on standard output.

use std::path::Path;

use htex_base::finding::{Report, plain};

use crate::exit::Exit;
use crate::failure::Failure;
use crate::hints::with_hint;
use crate::output::{print, print_json};
use crate::shown::shown;

/// Prints reports as they come, or all of them as JSON. The exit status is 1 if one is not valid.
pub(crate) fn report<'a>(
    reports: impl Iterator<Item = Result<(&'a Path, Report), Failure>>,
    is_json: bool,
) -> Result<Exit, Failure> {
    let (mut all_valid, mut printed) = (true, Vec::new());
    for report in reports {
        let (path, report) = report?;
        all_valid &= report.valid;
        if is_json {
            printed.push(report.of_file(&path.display().to_string()));
        } else {
            print(&text(path, &report))?;
        }
    }
    if is_json {
        print_json(&printed)?;
    }
    Ok(if all_valid { Exit::SUCCESS } else { Exit::FAILURE })
}

fn text(path: &Path, report: &Report) -> String {
    let verdict = if report.valid { "valid" } else { "NOT VALID" };
    let mut text = format!("{}: {verdict}\n", shown(path));
    for finding in &report.findings {
        let place = match plain(&finding.pointer) {
            pointer if pointer.is_empty() => String::new(),
            pointer => format!(" at {pointer}"),
        };
        text += &format!(
            "  {} {}{place}: {}\n",
            finding.severity,
            finding.code,
            with_hint(&finding.message, finding.hint)
        );
        if let Some(rule) = &finding.schema_rule {
            text += &format!("    schema: {}\n", plain(rule));
        }
    }
    text
}
