//! Reading a scene file with any content ends with a scene or a finding.

use crate::common::cases;

use htex_base::finding::Findings;
use htex_scene::{Limits, read_scene};
use proptest::prelude::*;

/// Reads bytes as a scene. A valid scene must stay valid after serialisation.
fn check(bytes: &[u8]) {
    let mut findings = Findings::default();
    let scene = read_scene(bytes, &Limits::default(), &mut findings);
    let has_errors = findings.has_errors();
    let list = findings.into_list();
    assert!(scene.is_some() || has_errors, "no scene and no error finding: {list:?}");
    if let (Some(scene), false) = (scene, has_errors) {
        let text = serde_json::to_vec(&scene).unwrap();
        let again = read_scene(&text, &Limits::default(), &mut Findings::default());
        assert_eq!(again, Some(scene));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..Default::default() })]

    #[test]
    fn a_changed_scene_is_read_or_refused(
        which in any::<prop::sample::Index>(),
        at in any::<prop::sample::Index>(),
        put in prop_oneof![Just("-1e308"), Just("1e999"), Just("null"), Just("\""), Just("{"), Just("é")],
        cut in 0usize..8,
    ) {
        let all = cases::cases();
        let text = which.get(&all).text.as_bytes();
        let at = at.index(text.len());
        let rest = &text[(at + cut).min(text.len())..];
        check(&[&text[..at], put.as_bytes(), rest].concat());
    }
}
