//! Text of a stranger, in a message.

use std::borrow::Cow;

/// The text with its control characters, and those that turn or hide text (marks of direction, of no width, other line
/// ends), written out (`\u{1b}`): a message that quotes a file must not steer the terminal it is read on, nor show what is
/// not there.
///
/// ```
/// assert_eq!(htex_format::plain("a\tb\x1b[2J"), r"a\tb\u{1b}[2J");
/// ```
pub fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(steers) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match steers(c) {
            true => plain.extend(c.escape_default()),
            false => plain.push(c),
        }
    }
    Cow::Owned(plain)
}

fn steers(c: char) -> bool {
    let is_mark = matches!(
        c,
        '\u{061c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}'
    );
    c.is_control() || is_mark
}
