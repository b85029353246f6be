//! Writing the points as CSV.

use htex_base::finding::as_text;
use htex_format::{By, Measure};

use crate::tradeoff::{Point, Tradeoff};

/// Returns the cells of a point with their column names: the fields that [`Point`] has in JSON,
/// except the knobs.
fn cells(p: &Point) -> Vec<(&'static str, String)> {
    let mut cells = Vec::new();
    let mut add = |name: &'static str, cell: String| cells.push((name, cell));
    add("recording", text(&p.recording));
    add("model", text(&p.model));
    add("setting", text(&p.setting));
    add("fit_ms", p.fit_ms.to_string());
    add("fit_spread", p.fit_spread.to_string());
    add("first_sample_us", p.first_sample_us.to_string());
    add("first_sample_spread", p.first_sample_spread.to_string());
    add("ns_per_sample", p.ns_per_sample.to_string());
    add("spread", p.spread.to_string());
    add("bytes", p.bytes.to_string());
    add("kept_bytes", p.kept_bytes.to_string());
    let number = |(name, value): (_, Option<f64>)| (name, value.unwrap_or(f64::NAN).to_string());
    let shares = p.shares.keyed().map(|(name, share)| (name, Some(share)));
    let by_magnitude = p.by_magnitude.keyed(By::Magnitude, Measure::of_both());
    let held_out =
        [("held_out_error", p.held_out_error), ("held_out_error_db", p.held_out_error_db)];
    let by_magnitude = held_out.into_iter().chain(by_magnitude.0);
    let numbers = by_magnitude.chain(shares);
    cells.extend(numbers.chain(p.by_samples.keyed().0).map(number));
    cells.push(("on_front", p.on_front.to_string()));
    cells.push(("on_time_front", p.on_time_front.to_string()));
    cells
}

/// Writes a header line, then one line for every combination of a setting and a recording.
pub fn csv(tradeoff: &Tradeoff) -> String {
    let mut lines = Vec::new();
    for point in &tradeoff.points {
        let (names, cells): (Vec<_>, Vec<_>) = cells(point).into_iter().unzip();
        if lines.is_empty() {
            lines.push(names.join(","));
        }
        lines.push(cells.join(","));
    }
    lines.join("\n") + "\n"
}

/// Formats a text cell: quoted if necessary, and marked as text.
fn text(text: &str) -> String {
    let text = &*as_text(text);
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
