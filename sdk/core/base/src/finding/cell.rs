//! Text in a table cell that may be opened in a spreadsheet.

use std::borrow::Cow;

/// Returns text for a table cell. If a spreadsheet would treat it as a formula, which may open an
/// address or run a program, it gets an apostrophe in front, which marks it as text.
///
/// ```
/// assert_eq!(htex_base::finding::as_text("=HYPERLINK(1)"), "'=HYPERLINK(1)");
/// assert_eq!(htex_base::finding::as_text("cotton"), "cotton");
/// ```
pub fn as_text(text: &str) -> Cow<'_, str> {
    // Spreadsheets skip a tab or a carriage return at the start and then see the formula.
    if text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        Cow::Owned(format!("'{text}"))
    } else {
        Cow::Borrowed(text)
    }
}
