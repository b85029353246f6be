//! Text of a stranger, in a message.

use std::borrow::Cow;

/// The text with its control characters written out (`\u{1b}`): a message that quotes a file must not
/// steer the terminal it is read on.
///
/// ```
/// assert_eq!(htex_format::plain("a\tb\x1b[2J"), r"a\tb\u{1b}[2J");
/// ```
pub fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(char::is_control) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        match c.is_control() {
            true => plain.extend(c.escape_default()),
            false => plain.push(c),
        }
    }
    Cow::Owned(plain)
}
