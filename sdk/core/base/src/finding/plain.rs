//! Escapes untrusted text in messages.

use std::borrow::Cow;

/// Escapes control characters and invisible formatting characters (direction marks, zero-width
/// characters, tags, Unicode line separators) in the form `\u{1b}`. A message that quotes a file
/// must not control the terminal, and must not appear to show text that is not in the file.
///
/// ```
/// assert_eq!(htex_base::finding::plain("a\tb\x1b[2J"), r"a\tb\u{1b}[2J");
/// ```
pub fn plain(text: &str) -> Cow<'_, str> {
    if !text.contains(steers) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if steers(c) { plain.extend(c.escape_default()) } else { plain.push(c) }
    }
    Cow::Owned(plain)
}

/// Returns whether [`plain`] escapes a character: a control character, or an invisible character
/// that changes the text around it.
pub fn steers(c: char) -> bool {
    // All of Unicode's format characters (Cf) except the visible ones, and the plane with tags and
    // selectors.
    let is_mark = matches!(c, '\u{00ad}' | '\u{061c}' | '\u{180e}' | '\u{feff}')
        || matches!(c, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}')
        || matches!(c, '\u{fff9}'..='\u{fffb}' | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}')
        || matches!(c, '\u{13430}'..='\u{1343f}' | '\u{e0000}'..='\u{e0fff}');
    c.is_control() || is_mark
}
