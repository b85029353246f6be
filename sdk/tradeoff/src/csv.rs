//! The points as CSV.

use std::fmt::Write;

use crate::{Point, Tradeoff};

type Column = (&'static str, fn(&Point) -> String);

const COLUMNS: &[Column] = &[
    ("recording", |p| text(&p.recording)),
    ("model", |p| text(&p.model)),
    ("setting", |p| text(&p.setting)),
    ("fit_ms", |p| p.fit_ms.to_string()),
    ("fit_spread", |p| p.fit_spread.to_string()),
    ("first_sample_us", |p| p.first_sample_us.to_string()),
    ("first_sample_spread", |p| p.first_sample_spread.to_string()),
    ("ns_per_sample", |p| p.ns_per_sample.to_string()),
    ("spread", |p| p.spread.to_string()),
    ("bytes", |p| p.bytes.to_string()),
    ("kept_bytes", |p| p.kept_bytes.to_string()),
    ("spectral_correlation", |p| {
        p.spectral_correlation.to_string()
    }),
    ("band_error_rms_db", |p| p.band_error_rms_db.to_string()),
    ("third_octave_error_rms_db", |p| {
        p.third_octave_error_rms_db.to_string()
    }),
    ("log_spectral_distance_db", |p| {
        p.log_spectral_distance_db.to_string()
    }),
    ("level_error_db", |p| p.level_error_db.to_string()),
    ("felt_error_rms_db", |p| p.felt_error_rms_db.to_string()),
    ("share_below_difference_threshold", |p| {
        p.share_below_difference_threshold.to_string()
    }),
    ("share_lossless", |p| p.share_lossless.to_string()),
    ("samples_spectral_correlation", |p| {
        p.samples_spectral_correlation.to_string()
    }),
    ("samples_band_error_rms_db", |p| {
        p.samples_band_error_rms_db.to_string()
    }),
    ("samples_band_error_spread_db", |p| {
        p.samples_band_error_spread_db.to_string()
    }),
    ("samples_third_octave_error_rms_db", |p| {
        p.samples_third_octave_error_rms_db.to_string()
    }),
    ("samples_log_spectral_distance_db", |p| {
        p.samples_log_spectral_distance_db.to_string()
    }),
    ("samples_level_error_db", |p| {
        p.samples_level_error_db.to_string()
    }),
    ("samples_felt_error_rms_db", |p| {
        p.samples_felt_error_rms_db.to_string()
    }),
    ("on_front", |p| p.on_front.to_string()),
    ("on_time_front", |p| p.on_time_front.to_string()),
];

/// Writes every setting on every recording, one line each, after a header line.
pub fn csv(tradeoff: &Tradeoff) -> String {
    let names: Vec<&str> = COLUMNS.iter().map(|(name, _)| *name).collect();
    let mut out = names.join(",") + "\n";
    for point in &tradeoff.points {
        let cells: Vec<String> = COLUMNS.iter().map(|(_, cell)| cell(point)).collect();
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{}", cells.join(","));
    }
    out
}

/// Formats a cell of text, quoted if necessary. A cell that a spreadsheet would take for a formula gets an apostrophe in
/// front, which marks text.
fn text(text: &str) -> String {
    let text = if text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        &format!("'{text}")
    } else {
        text
    };
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn text_is_quoted_where_it_must_be() {
        assert_eq!(super::text("a b=1"), "a b=1");
        assert_eq!(super::text("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(super::text("=HYPERLINK(1)"), "'=HYPERLINK(1)");
        assert_eq!(super::text("-a,b"), "\"'-a,b\"");
    }
}
