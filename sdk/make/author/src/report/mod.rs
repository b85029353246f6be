//! SVG plots, heat tables and self-contained HTML reports.
//!
//! This module converts data to text. The output depends only on the data, because this module
//! reads neither files nor the clock. It does no signal processing. Pages contain their own style
//! sheet, use no scripts and load no external resources.
//!
//! ```
//! use htex_author::report::{Axis, Plot, Series};
//! let mut plot = Plot::new("Vinyl", Axis::log("frequency / Hz"), Axis::linear("magnitude / mN"));
//! plot.series.push(Series::line("recording", vec![(20.0, 1.5), (200.0, 4.0), (1000.0, 0.2)]));
//! assert!(plot.to_svg().starts_with("<svg "));
//! ```
#![forbid(unsafe_code)]

mod axis;
mod chain;
mod color;
mod curves;
mod legend;
mod markup;
mod number;
mod page;
mod plot;
mod projection;
mod series;
mod stack;
mod svg;
mod table;
mod textures;
mod ticks;

pub use axis::{Axis, Scale};
pub use chain::{Chain, ChainStage};
pub(crate) use color::RECORDING_COLOR;
pub use color::{model_color, series_color};
pub use number::fixed;
pub use page::{Page, code_block, details, figures, link, list, paragraph, preview};
pub use plot::Plot;
pub use series::{Line, Series};
pub use stack::stacked;
pub use table::{Cell, HeatScale, Row, Table};
pub use textures::{
    Measure, ModelResult, Share, Texture, TextureReport, spectra_picture, texture_report,
};
pub use ticks::{Tick, ticks};
