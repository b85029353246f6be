//! The rules for all kinds of files, in one list.

use htex_base::finding::Rule;

/// All rules of this program, grouped by subject.
const TABLES: &[&[Rule]] = &[
    htex_format::RULES,
    htex_format::library::RULES,
    htex_scene::RULES,
    htex_author::findings::RULES,
    #[cfg(feature = "build")]
    htex_build::RULES,
    #[cfg(feature = "lab")]
    htex_lab::study::RULES,
];

pub(crate) fn rules() -> impl Iterator<Item = &'static Rule> {
    TABLES.iter().copied().flatten()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_code_is_that_of_one_rule() {
        let codes: BTreeSet<&str> = rules().map(|rule| rule.code).collect();
        assert_eq!(codes.len(), rules().count());
    }
}
