//! Lists what the suites before this one skipped. Cargo runs packages, and the suites in a package,
//! in the order of their names, so this one is the last.

use xtask::needs;

/// Missing software is listed with the test's name; installed software is not.
#[test]
fn what_was_skipped() {
    let before = needs::told().unwrap();
    assert!(!needs::AJV.met(false));
    let own = needs::told().unwrap();
    assert!(
        own.len() == 1 && own[0].contains("what_was_skipped") && own[0].contains(needs::AJV.how)
    );
    assert!(!needs::AJV.met(false) && needs::AJV.met(true));
    assert_eq!(needs::told().unwrap().len(), 0);
    tell(&before);
}

fn tell(sentences: &[String]) {
    if !sentences.is_empty() {
        needs::say(&format!("\nskipped in part or as a whole:\n{}", sentences.concat()));
    }
}
