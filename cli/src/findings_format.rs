//! Formats of findings for continuous integration: annotations of GitHub, and JUnit.

use std::fmt::Write as _;

use clap::ValueEnum;
use htex_base::finding::{FileReport, Severity, plain};

/// A format of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FindingsFormat {
    /// Annotations of GitHub Actions
    Github,
    /// JUnit XML, with a test case for each file
    Junit,
}

/// Returns reports in a format. `suite` names what found them.
pub(crate) fn formatted(format: FindingsFormat, suite: &str, reports: &[FileReport]) -> String {
    match format {
        FindingsFormat::Github => github(reports),
        FindingsFormat::Junit => junit(suite, reports),
    }
}

/// Annotations: <https://docs.github.com/actions/reference/workflow-commands-for-github-actions>.
fn github(reports: &[FileReport]) -> String {
    // A property also ends at a colon or a comma.
    let data = |text: &str| plain(text).replace('%', "%25").replace(['\r', '\n'], "%0A");
    let property = |text: &str| data(text).replace(':', "%3A").replace(',', "%2C");
    let mut lines = String::new();
    for report in reports {
        for finding in &report.findings {
            let kind = match finding.severity {
                Severity::Error => "error",
                Severity::Warning => "warning",
                Severity::Info => "notice",
            };
            let place = match &finding.pointer[..] {
                "" => String::new(),
                pointer => format!(" (at {pointer})"),
            };
            let _ = writeln!(
                lines,
                "::{kind} file={},title={}::{}",
                property(&report.file),
                property(&finding.code),
                data(&format!("{}{place}", finding.message))
            );
        }
    }
    lines
}

/// A test case for each file. It fails if the file is not valid; warnings are in its output.
fn junit(suite: &str, reports: &[FileReport]) -> String {
    let failed = reports.iter().filter(|report| !report.valid).count();
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" failures=\"{failed}\">\n",
        escaped(suite),
        reports.len()
    );
    for report in reports {
        let file = escaped(&report.file);
        let line = |severity: fn(&Severity) -> bool| {
            let found = report.findings.iter().filter(|finding| severity(&finding.severity));
            let lines = found.map(|f| escaped(&format!("{} {}: {}", f.code, f.pointer, f.message)));
            lines.collect::<Vec<_>>().join("\n")
        };
        let (errors, others) = (line(|s| *s == Severity::Error), line(|s| *s != Severity::Error));
        let _ = writeln!(xml, "  <testcase name=\"{file}\" classname=\"{}\">", escaped(suite));
        if !report.valid {
            let _ = writeln!(xml, "    <failure message=\"not valid\">{errors}</failure>");
        }
        if !others.is_empty() {
            let _ = writeln!(xml, "    <system-out>{others}</system-out>");
        }
        xml += "  </testcase>\n";
    }
    xml + "</testsuite>\n"
}

/// Escapes a text of one line.
fn escaped(text: &str) -> String {
    plain(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use htex_base::finding::Report;

    use super::*;

    #[test]
    fn texts_of_others_stay_inside_their_places() {
        let mut findings = htex_base::finding::Findings::default();
        let rule = &htex_format::library::RULES[0];
        findings.add(rule, "/a", "100 % <b>\n::error::x".to_owned());
        let report = Report::new(findings.into_list()).of_file("a,b:\"c\".htex");
        let github = formatted(FindingsFormat::Github, "htex", std::slice::from_ref(&report));
        assert_eq!(
            github,
            "::error file=a%2Cb%3A\"c\".htex,title=LIBRARY_UNRECOGNISED::100 %25 <b>\\n::error::x (at /a)\n"
        );
        let junit = formatted(FindingsFormat::Junit, "htex", &[report]);
        assert!(
            junit.contains("failures=\"1\"") && junit.contains("name=\"a,b:&quot;c&quot;.htex\"")
        );
        assert!(junit.contains("100 % &lt;b&gt;\\n::error::x"), "{junit}");
    }
}
