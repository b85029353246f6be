//! `htex studio`: which folder it serves. `sdk/studio/tests/served.test.mjs` opens what is served.

use crate::common::Place;

#[test]
fn a_folder_without_the_page_is_refused_with_how_to_build_it() {
    let place = Place::new();
    let run = place.run(&["studio", "--folder", "."]);
    assert_eq!(run.code(), 1, "{}", run.error());
    for words in [
        "is not in .;",
        "cargo xtask studio --out DIR",
        "HTEX_STUDIO=DIR",
    ] {
        assert!(run.error().contains(words), "{}", run.error());
    }
}

#[test]
fn a_page_that_is_too_large_names_the_file() {
    let place = Place::new();
    place.write("index.html", "<title>studio</title>");
    let large = std::fs::File::create(place.path("large.wasm")).unwrap();
    large.set_len(65 << 20).unwrap();
    let run = place.run(&["studio", "--folder", ".", "--port", "0"]);
    assert_eq!(run.code(), 1, "{}", run.error());
    assert!(run.error().contains("large.wasm"), "{}", run.error());
}
