//! Reads JSON. An error names the place of the fault: a JSON pointer or, if the text is not JSON,
//! line and column.

use htex_base::finding::escape;
use htex_format::{JsonError, parse_json};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use serde_path_to_error::Segment;

use crate::error::Fault;

/// Largest file that is imported, bytes.
pub const MOST_BYTES: u64 = 16 << 20;

/// Reads a value from a JSON text, which may have at most [`MOST_BYTES`] bytes.
pub(crate) fn read<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Fault> {
    if bytes.len() as u64 > MOST_BYTES {
        let problem = format!("it has {} bytes, and at most {MOST_BYTES} are read", bytes.len());
        return Err(Fault::whole(problem));
    }
    // Some editors write a byte order mark.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    // First parsed to a generic value. This finds keys that appear twice, and lets type errors name
    // their place.
    let value = parse_json(bytes).map_err(of_json)?;
    typed(value)
}

fn typed<T: DeserializeOwned>(value: Value) -> Result<T, Fault> {
    serde_path_to_error::deserialize(value).map_err(|error| {
        let pointer: String = error.path().iter().map(step).collect();
        Fault::new(pointer, error.into_inner().to_string())
    })
}

fn of_json(error: JsonError) -> Fault {
    match error {
        JsonError::Syntax(error) => {
            let place = format!("line {} column {}", error.line(), error.column());
            let text = error.to_string();
            // The parser's error text ends with the place, which the fault already states.
            let problem = text.split(" at line ").next().unwrap_or(&text);
            Fault::new(place, format!("it is not JSON: {problem}"))
        }
        JsonError::Twice(pointer) => Fault::new(pointer, "the key appears twice; keep one of them"),
        error => Fault::whole(error.to_string()),
    }
}

fn step(segment: &Segment) -> String {
    match segment {
        Segment::Seq { index } => format!("/{index}"),
        Segment::Map { key } => format!("/{}", escape(key)),
        // The name of a variant is already a key of its object. Unknown segments have no name.
        Segment::Enum { variant } => format!("/{}", escape(variant)),
        Segment::Unknown => String::new(),
    }
}

/// Writes a value as JSON with line breaks.
pub(crate) fn written(value: &impl Serialize) -> Vec<u8> {
    let mut bytes = serde_json::to_vec_pretty(value).unwrap_or_default();
    bytes.push(b'\n');
    bytes
}

/// Checks that a number is within a range. `what` names the number in the message.
pub(crate) fn within(
    pointer: impl FnOnce() -> String,
    what: &str,
    value: f64,
    range: std::ops::RangeInclusive<f64>,
) -> Result<(), Fault> {
    if range.contains(&value) {
        return Ok(());
    }
    let (least, most) = (range.start(), range.end());
    Err(Fault::new(pointer(), format!("{what} is {value}; it must be {least} to {most}")))
}
