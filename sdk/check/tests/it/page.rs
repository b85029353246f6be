//! Tests `spec/model-checks.md`, the order of the table that it lists, and the templates' headers.

use htex_check::harness::Check;
use htex_check::model::model_checks_page;
use htex_check::{device, model};

#[test]
fn generated_page_is_fresh() {
    xtask::generated::file("spec/model-checks.md", model_checks_page().as_bytes());
}

#[test]
fn generated_headers_of_the_templates_are_those_of_the_specification() {
    for header in [
        "htex_device.h",
        "htex_model.h",
        "htex_model_parts.h",
        "htex_model_wasm.h",
        "htex_motion_1.h",
    ] {
        let bytes = std::fs::read(format!("../../spec/include/{header}")).unwrap();
        xtask::generated::file(format!("sdk/check/templates/include/{header}"), &bytes);
    }
}

#[test]
fn checks_stand_behind_those_that_they_need() {
    fn stand<Case>(checks: &[Check<Case>]) {
        for (i, check) in checks.iter().enumerate() {
            for need in check.needs {
                let earlier = checks[..i].iter().any(|other| other.name == *need);
                assert!(earlier, "{} needs {need}", check.name);
            }
        }
    }
    stand(model::CHECKS);
    stand(device::CHECKS);
}
