//! Makes inputs that differ from a valid one in one value, or in two adjacent values, which take
//! every extreme that can be written, always in the same order.
//!
//! `tests/tests/it/edges.rs` sets values, cells and bytes of the seeds to every boundary; the
//! fuzzer covers the rest.

use serde_json::Value;

/// Numbers as text, from the smallest to those that overflow every type.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "0.5",
    "255",
    "256",
    "65535",
    "65536",
    "2147483648",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "-9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "5e-324",
    "1e-300",
    "1e16",
    "1e22",
    "3.5e38",
    "1e154",
    "1e300",
    "-1e300",
    "1.7976931348623157e308",
    "1e999",
];
/// The numbers used for pairs of values.
const FEW: &[&str] = &["0", "-1", "1", "5e-324", "1e19", "1e300", "1e308"];
/// The increments of a column.
const CLIMBS: &[f64] = &[5e-324, 1e-308, 1e-300, 1e-12, 1e-9, 1e-6, 1e6, 1e15, 1e300, 1e307];
/// JSON values that are not numbers.
const WORDS: &[&str] = &[
    "null",
    "true",
    "\"\"",
    "\"\\u0000\"",
    "\"\\u001b[31m\\n\"",
    "\"../x\"",
    "\"/x\"",
    "\"1.0\"",
    "\"1.4294967296\"",
    "\"99.0\"",
    "\"org.htex.ar\"",
    "[]",
    "[null]",
    "[0]",
    "{}",
    "{\"\":0}",
];
/// Cells that are not numbers.
const CELLS: &[&str] = &["", " ", "nan", "inf", "-inf", "0x10", "1,5", "\u{1b}[31m", "\"", "é"];
/// Length of the long text that replaces another.
const LONG: usize = 5000;
/// Placeholder for the inserted text.
const MARK: &str = "\"~here~\"";
const SECOND_MARK: &str = "\"~there~\"";
/// Number of bytes changed at the beginning and at the end.
const BYTES: usize = 512;

/// Changes a JSON document: each value is replaced by each extreme, duplicated, or left out, and
/// two adjacent numbers in an object or list are replaced by extremes.
///
/// # Panics
/// When the document is not JSON.
pub fn json(document: &[u8], each: &mut dyn FnMut(&[u8])) {
    let sound: Value = serde_json::from_slice(document).expect("a seed is JSON");
    let mut pointers = Vec::new();
    walk(&sound, String::new(), &mut pointers);
    let long = format!("\"{}\"", "a\\n".repeat(LONG / 2));
    for pointer in &pointers {
        let marked = marked(&sound, pointer, MARK);
        let (was, key) = (sound.pointer(pointer), pointer.rsplit('/').next());
        let was = was.expect("it was walked").to_string();
        let twice = if parent(&sound, pointer).is_some_and(Value::is_object) {
            format!("{was},\"{}\":{was}", key.unwrap_or_default())
        } else {
            format!("{was},{was}")
        };
        for edge in NUMBERS.iter().chain(WORDS).chain([&&*long, &&*twice]) {
            each(marked.replace(MARK, edge).as_bytes());
        }
        each(without(&sound, pointer).as_bytes());
    }
    for (one, other) in neighbours(&sound, &pointers) {
        let mut both = sound.clone();
        mark(&mut both, one, MARK);
        mark(&mut both, other, SECOND_MARK);
        let both = both.to_string();
        for edge in FEW {
            let half = both.replace(MARK, edge);
            for other in FEW {
                each(half.replace(SECOND_MARK, other).as_bytes());
            }
        }
    }
}

fn walk(value: &Value, at: String, pointers: &mut Vec<String>) {
    match value {
        Value::Object(members) => {
            for (key, member) in members {
                walk(member, format!("{at}/{}", escaped(key)), pointers);
            }
        }
        Value::Array(items) => {
            for (i, item) in items.iter().enumerate() {
                walk(item, format!("{at}/{i}"), pointers);
            }
        }
        _ => {}
    }
    pointers.push(at);
}

/// Escapes a key as JSON pointers require.
fn escaped(key: &str) -> String {
    key.replace('~', "~0").replace('/', "~1")
}

fn mark(document: &mut Value, pointer: &str, mark: &str) {
    let mark = mark.trim_matches('"').to_owned();
    *document.pointer_mut(pointer).expect("it was walked") = Value::String(mark);
}

fn marked(sound: &Value, pointer: &str, with: &str) -> String {
    let mut document = sound.clone();
    mark(&mut document, pointer, with);
    document.to_string()
}

fn parent<'a>(document: &'a Value, pointer: &str) -> Option<&'a Value> {
    document.pointer(&pointer[..pointer.rfind('/')?])
}

/// Returns the document without this value.
fn without(sound: &Value, pointer: &str) -> String {
    let Some(slash) = pointer.rfind('/') else {
        return String::new();
    };
    let (mut document, key) = (sound.clone(), &pointer[slash + 1..]);
    match document.pointer_mut(&pointer[..slash]) {
        Some(Value::Object(members)) => {
            members.retain(|name, _| escaped(name) != key);
        }
        Some(Value::Array(items)) => {
            items.remove(key.parse::<usize>().expect("the index of an item"));
        }
        _ => unreachable!("only these two have members"),
    }
    document.to_string()
}

/// Returns adjacent numbers in the same object or list.
fn neighbours<'a>(sound: &Value, pointers: &'a [String]) -> Vec<(&'a str, &'a str)> {
    let is_number = |pointer: &&String| sound.pointer(pointer).is_some_and(Value::is_number);
    let numbers: Vec<&str> = pointers.iter().filter(is_number).map(|p| &**p).collect();
    let folder = |pointer: &str| pointer.rfind('/').map(|slash| pointer[..slash].to_owned());
    let pairs = numbers.windows(2).map(|pair| (pair[0], pair[1]));
    pairs.filter(|(a, b)| folder(a) == folder(b)).collect()
}

/// Changes a table: each cell is replaced by each extreme, each column is replaced as a whole,
/// either alternating or increasing by an extreme step, and each row is left out.
///
/// # Panics
/// When the table is not text.
pub fn table(document: &[u8], each: &mut dyn FnMut(&[u8])) {
    let text = std::str::from_utf8(document).expect("a seed is text");
    let comma = if text.contains(';') { ";" } else { "," };
    let rows: Vec<Vec<&str>> = text.lines().map(|row| row.split(comma).collect()).collect();
    let write = |rows: &[Vec<&str>]| -> String {
        let lines = rows.iter().map(|row| row.join(comma) + "\n");
        lines.collect()
    };
    let edges = || NUMBERS.iter().chain(CELLS).copied();
    for (r, row) in rows.iter().enumerate() {
        for c in 0..row.len() {
            let mut other = rows.clone();
            for edge in edges() {
                other[r][c] = edge;
                each(write(&other).as_bytes());
            }
        }
        let mut other = rows.clone();
        other.remove(r);
        each(write(&other).as_bytes());
    }
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let turns = FEW.iter().flat_map(|a| FEW.iter().map(move |b| (*a, *b)));
    let turns: Vec<_> = turns.chain(edges().map(|edge| (edge, edge))).collect();
    let climbs: Vec<Vec<String>> = CLIMBS.iter().map(|by| climb(*by, rows.len())).collect();
    for c in 0..columns {
        let mut with = |cell_of: &dyn Fn(usize) -> String| {
            let cells: Vec<String> = (0..rows.len()).map(cell_of).collect();
            let mut other = rows.clone();
            let column = other.iter_mut().zip(&cells).skip(1);
            for (row, new) in column {
                if let Some(cell) = row.get_mut(c) {
                    *cell = new;
                }
            }
            each(write(&other).as_bytes());
        };
        for (even, odd) in &turns {
            with(&|r| if r % 2 == 0 { *even } else { *odd }.to_owned());
        }
        for climb in &climbs {
            with(&|r| climb[r].clone());
        }
    }
}

fn climb(by: f64, rows: usize) -> Vec<String> {
    (0..rows).map(|r| format!("{:e}", by * r as f64)).collect()
}

/// Changes the first and last bytes of a binary file: each byte, and each group of four as a
/// little-endian number, is replaced by extremes, and the file is cut before each.
pub fn bytes(document: &[u8], each: &mut dyn FnMut(&[u8])) {
    let last = document.len().saturating_sub(BYTES).max(BYTES);
    let places = (0..document.len()).filter(|at| *at < BYTES || *at >= last);
    for at in places {
        each(&document[..at]);
        let was = document[at];
        for edge in [0, 1, was ^ 1, was ^ 0x80, 0x7f, 0x80, 0xff] {
            let mut other = document.to_vec();
            other[at] = edge;
            each(&other);
        }
        for edge in [0, 1, i32::MAX as u32, i32::MIN as u32, u32::MAX - 1, u32::MAX] {
            let mut other = document.to_vec();
            if let Some(four) = other.get_mut(at..at + 4) {
                four.copy_from_slice(&edge.to_le_bytes());
                each(&other);
            }
        }
    }
}
