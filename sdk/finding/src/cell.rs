//! Text in a cell of a table that a person opens.

use std::borrow::Cow;

/// Returns text for a cell. What a spreadsheet would take for a formula, which may open an address
/// or run a program, gets an apostrophe in front, which marks text.
///
/// ```
/// assert_eq!(htex_finding::as_text("=HYPERLINK(1)"), "'=HYPERLINK(1)");
/// assert_eq!(htex_finding::as_text("cotton"), "cotton");
/// ```
pub fn as_text(text: &str) -> Cow<'_, str> {
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}
