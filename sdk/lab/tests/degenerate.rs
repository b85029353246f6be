//! Tables of any kind: read or refused without a panic, and no number of an analysis is NaN.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use htex_dsp::Band;
use htex_lab::analyse::{Incomplete, Ratings, Spectra, analyse};
use proptest::prelude::*;

/// Tables of whole ratings, with ties, constants, one participant, one texture or one model.
fn ratings([people, textures, models]: [usize; 3], values: &[u8]) -> String {
    let mut table = "participant,texture,model,repetition,rating\n".to_owned();
    let mut values = values.iter().cycle();
    for p in 0..people {
        for t in 0..textures {
            for m in 0..models {
                table += &format!("p{p},t{t},m{m},1,{}\n", values.next().unwrap());
            }
        }
    }
    table
}

/// Spectra of few different magnitudes, so that bins and whole spectra are equal.
fn spectra([people, textures, models]: [usize; 3], values: &[u8]) -> String {
    let grid: Vec<String> = Band::TACTILE.grid_hz().iter().map(f64::to_string).collect();
    let mut values = values.iter().cycle();
    let mut line = |names: String| {
        let row: Vec<String> = grid
            .iter()
            .map(|_| values.next().unwrap().to_string())
            .collect();
        format!("{names},{}\n", row.join(","))
    };
    let mut table = format!("participant,texture,model,{}\n", grid.join(","));
    for t in 0..textures {
        table += &line(format!("recorded,t{t},recorded"));
        for p in 0..people {
            (0..models).for_each(|m| table += &line(format!("p{p},t{t},m{m}")));
        }
    }
    table
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_number_is_nan(
        shape in [1usize..6, 1usize..4, 1usize..5],
        rated in prop::collection::vec(0u8..4, 1..40),
        felt in prop::collection::vec(0u8..3, 1..400),
    ) {
        let ratings = Ratings::read(ratings(shape, &rated).as_bytes(), Incomplete::Refuse).unwrap().table;
        let spectra = Spectra::read(spectra(shape, &felt).as_bytes(), &ratings).unwrap().table;
        let analysis = analyse(&ratings, Some(&spectra), "test");
        // JSON writes a number that is not finite as null.
        let json = serde_json::to_string(&analysis).unwrap();
        prop_assert!(!json.contains("null"), "{json}");
        for (_, text) in analysis.to_csv().into_iter().chain([("", analysis.to_text()), ("", analysis.to_html("test"))]) {
            prop_assert!(!text.contains("NaN") && !text.contains(" inf"), "{text}");
        }
        let again: htex_lab::analyse::Analysis = serde_json::from_str(&json).unwrap();
        prop_assert_eq!(again.notes, analysis.notes);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400), text in "[a-c,1-9\"\n\r]{0,300}") {
        let header = "participant,texture,model,repetition,rating\n";
        let _ = Ratings::read(&bytes, Incomplete::Refuse);
        let table = format!("{header}{text}");
        match Ratings::read(table.as_bytes(), Incomplete::LeaveOut) {
            Ok(ratings) => {
                prop_assert!(analyse(&ratings.table, None, "test").cell_means.iter().all(|c| c.mean.is_finite()));
                let _ = Spectra::read(&bytes, &ratings.table);
            }
            Err(invalid) => prop_assert!(!invalid.findings.is_empty()),
        }
    }
}
