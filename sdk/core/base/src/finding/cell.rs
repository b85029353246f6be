//! Text for the cells of a table that the user may open in a spreadsheet.

use std::borrow::Cow;

/// Returns text for a table cell. If a spreadsheet would treat the text as a formula, this function
/// adds an apostrophe at the start. The apostrophe marks the cell as text. A formula could open an
/// address or run a program.
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
