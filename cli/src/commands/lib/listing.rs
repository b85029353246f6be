//! Prints lists of entries as table lines or a JSON array, while the index is still being read.

use htex_base::finding::plain;
use htex_format::Law;
use htex_format::library::{Entry, Interval};
use serde::Serialize;

use crate::assets::short_name;
use crate::failure::Result;
use crate::output::{json_line, print, write};

/// Number of bytes that are buffered before they are written.
const BUFFER_BYTES: usize = 64 << 10;

/// A list that is being printed.
pub(super) struct Listing {
    is_json: bool,
    text: String,
    count: u64,
}

impl Listing {
    pub(super) fn new(is_json: bool) -> Self {
        Self { is_json, text: String::new(), count: 0 }
    }

    pub(super) fn add(&mut self, entry: &Entry) -> Result<()> {
        self.add_line(entry, &row(entry))
    }

    /// Adds any kind of entry, given both as a value for JSON and as a line for the table.
    pub(super) fn add_line(&mut self, value: &impl Serialize, line: &str) -> Result<()> {
        if self.is_json {
            let json = json_line(value)?;
            self.text += if self.count == 0 { "[" } else { ",\n " };
            self.text += &json;
        } else {
            self.text += line;
        }
        self.count += 1;
        if self.text.len() >= BUFFER_BYTES {
            self.flush()?;
        }
        Ok(())
    }

    /// Ends the list. Returns the number of entries.
    pub(super) fn finish(mut self) -> Result<u64> {
        if self.is_json {
            self.text += if self.count == 0 { "[]\n" } else { "]\n" };
        }
        self.flush()?;
        Ok(self.count)
    }

    fn flush(&mut self) -> Result<()> {
        let text = std::mem::take(&mut self.text);
        // `print` escapes control characters as `\u{…}`, which is not valid JSON.
        if self.is_json { write(&text) } else { print(&text) }
    }
}

pub(super) fn row(entry: &Entry) -> String {
    let models: Vec<&str> = entry.models.iter().map(|id| short_name(id)).collect();
    let (speed, force) = (entry.conditions.speed_mm_s, entry.conditions.force_n);
    format!(
        "{:32} {:>7} B  {:>12}  {:>10}  {:16}  {}  {}\n",
        plain(&entry.name),
        entry.bytes,
        range(speed, "mm/s"),
        range(force, "N"),
        law(&entry.law),
        plain(&models.join(" ")),
        plain(&entry.tags.join(", "))
    )
}

/// Formats the law as three exponents: frequencies over speed (`f`), level over speed (`v`), and
/// level over force (`F`).
fn law(law: &Law) -> String {
    let [a, b, c] = [law.frequency_speed, law.level_speed, law.level_force]
        .map(|exponent| number(exponent.exponent));
    format!("f^{a} v^{b} F^{c}")
}

pub(super) fn range(interval: Option<Interval>, unit: &str) -> String {
    match interval {
        None => format!("? {unit}"),
        Some(Interval { min, max }) if min == max => format!("{} {unit}", number(min)),
        Some(Interval { min, max }) => format!("{}-{} {unit}", number(min), number(max)),
    }
}

fn number(x: f64) -> String {
    let text = format!("{x:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
