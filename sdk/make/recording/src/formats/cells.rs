//! Splitting a line of delimited text into cells.

/// The text between two cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Delimiter {
    Byte(u8),
    Whitespace,
}

/// Returns the delimiter that splits the first two rows into the same number of cells. If several
/// do, returns the one with the most cells.
pub(crate) fn sniff(first: &str, second: &str) -> Delimiter {
    let count = |line, delimiter| {
        let mut cells = Vec::new();
        split(line, delimiter, &mut cells);
        cells.len()
    };
    let bytes = [b'\t', b';', b','].map(Delimiter::Byte);
    let agreed = |delimiter: &Delimiter| {
        let cells = count(first, *delimiter);
        cells > 1 && cells == count(second, *delimiter)
    };
    let most = |delimiter: &Delimiter| count(first, *delimiter);
    if let Some(delimiter) = bytes.into_iter().filter(agreed).max_by_key(most) {
        return delimiter;
    }
    // Spaces are tried only now, because cells that are separated by commas may contain spaces.
    if agreed(&Delimiter::Whitespace) {
        return Delimiter::Whitespace;
    }
    bytes.into_iter().max_by_key(most).unwrap_or(Delimiter::Byte(b','))
}

pub(crate) fn split<'a>(line: &'a str, delimiter: Delimiter, cells: &mut Vec<&'a str>) {
    match delimiter {
        Delimiter::Whitespace => cells.extend(line.split_ascii_whitespace()),
        Delimiter::Byte(delimiter) => split_bytes(line, delimiter, cells),
    }
}

/// Splits at a one-byte delimiter outside double quotes. Removes spaces and quotes around each
/// cell.
fn split_bytes<'a>(line: &'a str, delimiter: u8, cells: &mut Vec<&'a str>) {
    let mut start = 0;
    let mut quoted = false;
    for (at, byte) in line.bytes().enumerate() {
        if byte == delimiter && !quoted {
            cells.push(bare(&line[start..at]));
            start = at + 1;
        } else if byte == b'"' {
            quoted = !quoted;
        }
    }
    cells.push(bare(&line[start..]));
}

fn bare(cell: &str) -> &str {
    let cell = cell.trim_ascii();
    match cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')) {
        Some(inner) => inner.trim_ascii(),
        None => cell,
    }
}
