//! Checks what is generated from the table of measures outside this crate: tables in the documents,
//! and a module of the Python package.

use std::fmt::Write;

use htex_format::{By, ErrorMeasure, LeftOut, Measure, MeasureKind};
use xtask::generated::{file, section};

#[test]
fn generated_tables_are_fresh() {
    section("spec/htex-1.md", "measures of quality", &quality());
    section("spec/htex-1.md", "measures of left_out", &left_out());
    section("docs/demonstration.md", "columns of measures", &columns());
    file("sdk/bindings/python/python/htex/_measures.py", python().as_bytes());
}

/// Returns the definition as a table cell.
fn cell(definition: &str) -> &str {
    definition.trim_end_matches('.')
}

fn row(by: By, measure: Measure, definition: &str) -> String {
    let row = measure.row();
    let required = row.required && by == By::Magnitude;
    let range = match row.judged {
        MeasureKind::Correlation => "-1 to 1",
        MeasureKind::Error => "from 0",
        MeasureKind::Difference => "a number",
    };
    let mark = if required { " *" } else { "" };
    format!("| `{}`{mark} | {range} | {} |\n", measure.key(by), cell(definition))
}

fn quality() -> String {
    let mut table = String::from("| key | range | meaning |\n|---|---|---|\n");
    for measure in Measure::stored() {
        if measure == Measure::NineBand {
            table += "| `band_error_db` * | nine numbers | ratio of the energy to the recording's, by band, dB |\n";
        }
        table += &row(By::Magnitude, measure, measure.row().meaning);
    }
    for measure in Measure::stored() {
        let of_samples = measure.row().of_samples;
        table += &of_samples.map_or(String::new(), |text| row(By::Samples, measure, text));
    }
    table
        + "| `rounding_error_db` | from 0 | RMS over the nine bands of the difference between fitted and stored parameters, dB |\n"
}

fn left_out() -> String {
    let rows = LeftOut::measures().map(|m| row(By::Magnitude, m, m.row().meaning));
    format!("| key | range | meaning |\n|---|---|---|\n{}", rows.collect::<String>())
}

fn columns() -> String {
    let mut table = String::from("| column | meaning |\n|---|---|\n");
    for row in Measure::ALL.map(Measure::row) {
        for (column, text) in [(row.column, Some(row.meaning)), (row.played, row.of_samples)] {
            if let Some((column, text)) = column.zip(text) {
                writeln!(table, "| `{column}` | {} |", cell(text)).unwrap();
            }
        }
    }
    table
}

fn python() -> String {
    let choices = ErrorMeasure::ALL.map(|measure| format!("\"{}\"", measure.id()));
    let mut module = format!(
        "\"\"\"The measures of agreement: generated from the table of the Rust sources by `cargo xtask generate`.\"\"\"\n\n\
         from __future__ import annotations\n\nfrom dataclasses import dataclass\nfrom typing import Literal\n\n\
         ErrorMeasure = Literal[{}]\n\"\"\"A measure of the error of a model.\"\"\"\n\n\n\
         @dataclass(frozen=True)\nclass Agreement:\n    \"\"\"Agreement of magnitudes with a reference.\"\"\"\n\n",
        choices.join(", ")
    );
    let mut field = |key: &str, kind: &str, text: &str| {
        writeln!(module, "    {key}: {kind}\n    \"\"\"{text}\"\"\"").unwrap();
    };
    for measure in Measure::stored() {
        match measure {
            Measure::NineBand => field(
                "band_error_db",
                "list[float]",
                "Energy relative to the reference's in each of nine bands, decibels.",
            ),
            Measure::NineBandMatched => field(
                "matching_gain_db",
                "float",
                "Gain that makes the total energies equal, decibels.",
            ),
            _ => {}
        }
        let row = measure.row();
        match row.lacking {
            None => field(row.key, "float", row.meaning),
            Some(when) => {
                let text = format!("{}; ``None`` {when}.", cell(row.meaning));
                field(row.key, "float | None", &text);
            }
        }
    }
    module
}
