//! Every row of the table holds, and the page is generated from the table.

use htex_hard_cases::sections;

#[test]
#[cfg(feature = "pipeline")] // The page has all rows.
fn generated_page_is_fresh() {
    let page = htex_hard_cases::page();
    xtask::generated::file("spec/hard-cases.md", page.as_bytes());
}

/// Runs the cases of a section and prints the measured errors.
fn hold(title: &str) {
    let sections = sections();
    let section = sections.iter().find(|s| s.title == title).unwrap();
    let mut broken = Vec::new();
    for case in section.cases {
        let start = std::time::Instant::now();
        match case.run() {
            Ok(text) => println!("{text}; took {:.1} s", start.elapsed().as_secs_f64()),
            Err(text) => broken.push(text),
        }
    }
    assert!(broken.is_empty(), "\n{}\n", broken.join("\n"));
}

macro_rules! sections {
    ($($(#[$when:meta])? $name:ident: $title:literal),* $(,)?) => {
        $(#[test]
        $(#[$when])?
        fn $name() {
            hold($title);
        })*

        /// Every section has a test here.
        #[test]
        fn every_section_is_held() {
            let held = [$($title),*];
            for section in sections() {
                assert!(held.contains(&section.title), "{}", section.title);
                assert!(!section.cases.is_empty());
            }
        }
    };
}

sections! {
    recordings: "Recordings",
    prediction: "Linear prediction",
    autoregression: "AR",
    arma: "ARMA",
    map: "Friction maps",
    mixing: "Interpolation",
    beta: "Beta density",
    slope: "Slopes",
    cepstrum: "Cepstra",
    voices: "Voices",
    sound: "Sound",
    #[cfg(feature = "pipeline")]
    files: "Recordings to files",
    #[cfg(feature = "pipeline")]
    motion: "Motion and drive",
}
