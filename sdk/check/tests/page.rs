//! `spec/model-checks.md`, and the order of the table that it lists.

use htex_check::{CHECKS, model_checks_page};

#[test]
fn generated_page_is_fresh() {
    xtask::generated::file("spec/model-checks.md", model_checks_page().as_bytes());
}

#[test]
fn checks_stand_behind_those_that_they_need() {
    for (i, check) in CHECKS.iter().enumerate() {
        for need in check.needs {
            let earlier = CHECKS[..i].iter().any(|other| other.name == *need);
            assert!(earlier, "{} needs {need}", check.name);
        }
    }
}
