//! Heat tables: each cell shows its value as a number and as a shade.

use crate::report::color::{Rgb, diverging, sequential};
use crate::report::markup::Element;
use crate::report::number::{MISSING, fixed};

/// Mapping from values to shades.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HeatScale {
    /// No shades.
    None,
    /// Light at `low`, dark at `high`.
    Sequential {
        /// Value of the lightest shade.
        low: f64,
        /// Value of the darkest shade.
        high: f64,
    },
    /// White at zero, blue towards `-extent`, orange towards `extent`.
    Diverging {
        /// Magnitude of the values with the strongest shades.
        extent: f64,
    },
}

impl HeatScale {
    fn shade(self, value: f64) -> Option<Rgb> {
        let usable = |fraction: f64| Some(fraction).filter(|f| f.is_finite());
        match self {
            Self::None => None,
            Self::Sequential { low, high } => usable((value - low) / (high - low)).map(sequential),
            Self::Diverging { extent } => usable(value / extent).map(diverging),
        }
    }
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A value shaded by the table's scale, followed by a mark such as `"*"` (may be empty).
    Shaded(f64, &'static str),
    /// A value without a shade.
    Plain(f64),
    /// Text. If the second string is not empty, it is shown below the text in a smaller size.
    Text(String, String),
    /// An unknown value.
    Missing,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub header: String,
    /// The cells, one for each column.
    pub cells: Vec<Cell>,
}

/// A table with a header for each row and column.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Name of the quantity that the cells show, with its unit.
    pub caption: String,
    /// Header of the column that holds the row headers.
    pub corner: String,
    /// The column headers.
    pub columns: Vec<String>,
    /// The rows, from the top.
    pub rows: Vec<Row>,
    /// Mapping from values to shades.
    pub scale: HeatScale,
    pub decimals: usize,
}

impl Table {
    /// Returns the table as an HTML element. The table's frame scrolls if the page is too narrow.
    pub fn to_html(&self) -> String {
        let table = Element::new("table")
            .child(&Element::new("caption").text(&self.caption))
            .child(&Element::new("thead").child(&self.head()))
            .child(&Element::new("tbody").children(self.rows.iter().map(|row| self.row(row))));
        let frame = Element::new("div").set("class", "scroll").set("tabindex", "0");
        frame.child(&table).render()
    }

    fn head(&self) -> Element {
        let header = |text: &String| Element::new("th").set("scope", "col").text(text);
        let all = std::iter::once(&self.corner).chain(&self.columns);
        Element::new("tr").children(all.map(header))
    }

    fn row(&self, row: &Row) -> Element {
        let header = Element::new("th").set("scope", "row").text(&row.header);
        let known = row.cells.iter().chain(std::iter::repeat(&Cell::Missing));
        let cells = known.take(self.columns.len()).map(|cell| self.cell(cell));
        Element::new("tr").child(&header).children(cells)
    }

    fn cell(&self, cell: &Cell) -> Element {
        let td = Element::new("td");
        match cell {
            Cell::Shaded(value, mark) if value.is_finite() => {
                let text = format!("{}{mark}", fixed(*value, self.decimals));
                shaded(td, self.scale.shade(*value)).text(&text)
            }
            Cell::Plain(value) => td.text(&fixed(*value, self.decimals)),
            Cell::Text(text, below) if below.is_empty() => td.text(text),
            Cell::Text(text, below) => td.text(text).child(&Element::new("small").text(below)),
            Cell::Shaded(..) | Cell::Missing => td.text(MISSING),
        }
    }
}

fn shaded(td: Element, shade: Option<Rgb>) -> Element {
    match shade {
        Some(shade) => {
            let style = format!("background:{};color:{}", shade.hex(), shade.ink());
            td.set("style", &style)
        }
        None => td,
    }
}
