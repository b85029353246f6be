//! Rules of validation, and the macro that defines tables of rules.

use crate::finding::{Hint, Severity};

/// A rule of validation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rule {
    /// Stable code; its meaning never changes.
    pub code: &'static str,
    /// Severity of a finding for this rule.
    pub severity: Severity,
    /// The stages of reading in which the rule is applied. Empty if this kind of file is not read
    /// in stages.
    pub stages: &'static [Stage],
    pub hint: Hint,
    /// The setting that turns the rule on. A rule with no such setting is always applied.
    pub checked_by: Hint,
    /// The problem, in one line.
    pub summary: &'static str,
    /// Why the problem matters.
    pub explanation: &'static str,
    /// How to correct the problem.
    pub fix: &'static str,
}

/// A stage of reading a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stage {
    /// What the stage checks.
    pub of: &'static str,
    /// Whether reading ends after this stage if the stage found an error.
    pub ends: bool,
}

/// The last stage. This stage checks whether there are more than a hundred findings.
pub const COUNT: Stage =
    Stage { of: "the count of findings beyond the first hundred", ends: false };

/// The rule of the last finding in a report, if there were more than a hundred findings.
pub const FINDINGS_TRUNCATED: &Rule = &Rule {
    code: "FINDINGS_TRUNCATED",
    severity: Severity::Info,
    stages: &[COUNT],
    hint: Hint::NONE,
    checked_by: Hint::NONE,
    summary: "There are more findings than are shown.",
    explanation: "Only the first hundred are reported.",
    fix: "Correct those and validate again.",
};

/// Defines a table of rules: a constant for each rule, and `RULES` with all of them in order. Three
/// optional parts can follow the severity: in `[]` the stages, in `()` the settings that would fix
/// the problem, and after `by` the setting that turns the rule on. A last line `+ RULE;` adds a
/// rule that is defined elsewhere.
///
/// ```
/// htex_base::finding::rule_table! {
///     CLOTH_TORN Error ("needle"): "The cloth is torn.", "Torn cloth snags.", "Mend it.";
/// }
/// assert_eq!(RULES[0].code, "CLOTH_TORN");
/// assert_eq!(*CLOTH_TORN, RULES[0]);
/// ```
#[macro_export]
macro_rules! rule_table {
    ($(
        $name:ident $severity:ident $([$($stage:ident),*])? $(($($setting:literal),*))? $(by $check:literal)?:
        $summary:literal, $explanation:literal, $fix:literal;
    )* $(+ $other:path;)?) => {
        $(
            #[doc = $summary]
            pub const $name: &$crate::finding::Rule = &$crate::finding::Rule {
                code: stringify!($name),
                severity: $crate::finding::Severity::$severity,
                stages: &[$($($stage),*)?],
                hint: $crate::finding::Hint::new(&[$($($setting),*)?]),
                checked_by: $crate::finding::Hint::new(&[$($check)?]),
                summary: $summary,
                explanation: $explanation,
                fix: $fix,
            };
        )*

        /// All rules, in the order of validation.
        pub const RULES: &[$crate::finding::Rule] = &[$(*$name,)* $(*$other)?];
    };
}
