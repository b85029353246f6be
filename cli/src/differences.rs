//! Prints how two textures differ.

use std::fmt::Write as _;

use htex_author::{DifferenceAt, EntryChange, TextureDifference};
use htex_base::finding::plain;
use htex_format::{Condition, Measure};
use serde_json::Value;

use crate::assets::{motion_text, short_name};

/// Returns one line for each difference.
pub(crate) fn lines(difference: &TextureDifference) -> Vec<String> {
    let TextureDifference { metadata, models_removed, models_added, models, .. } = difference;
    let mut lines: Vec<String> = metadata.iter().map(entry).collect();
    for (what, conditions) in
        [("removed", &difference.conditions_removed), ("added", &difference.conditions_added)]
    {
        lines.extend(conditions.iter().map(|c| format!("condition {what}: {}", motion_text(c))));
    }
    for (what, ids) in [("removed", models_removed), ("added", models_added)] {
        lines.extend(ids.iter().map(|id| format!("model {what}: {}", plain(id))));
    }
    for model in models {
        let name = short_name(&model.model);
        lines.extend(model.at.iter().map(|at| spectra(&plain(name), at)));
    }
    lines
}

fn entry(EntryChange { name, from, to }: &EntryChange) -> String {
    let text = |value: &Value| match value {
        Value::Null => "none".to_owned(),
        Value::String(text) => plain(text).into_owned(),
        other => plain(&other.to_string()).into_owned(),
    };
    format!("{}: {} → {}", plain(name), text(from), text(to))
}

/// Returns the measures of two spectra at a motion.
fn spectra(model: &str, at: &DifferenceAt) -> String {
    let condition = Condition {
        speed_mm_s: Some(at.speed_mm_s),
        force_n: Some(at.force_n),
        ..Condition::default()
    };
    let mut line = format!("{model} at {}: ", motion_text(&condition));
    match at.level_db {
        Some(db) => _ = write!(line, "level {db:+.2} dB"),
        None => line += "one is silent",
    }
    for measure in Measure::stored() {
        if let Some(value) = at.difference.quality.get(measure) {
            let row = measure.row();
            let text = format!(", {} {value:.*} {}", row.short, row.decimals, row.unit);
            line += text.trim_end();
        }
    }
    let felt = &at.difference.felt.error;
    _ = write!(
        line,
        ", felt {:.2} dB RMS, {:.2} dB at most ({})",
        felt.error_rms_db,
        felt.largest_error_db,
        felt.verdict()
    );
    line
}
