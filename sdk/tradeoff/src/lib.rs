//! What accuracy costs: every model and knob on recordings, in bytes and in time.
//!
//! [`sweep`] fits, measures and times the settings of [`knobs`] on some [`Subject`]s, beside two
//! baselines, and [`Tradeoff::new`] makes of it fronts, knees and warnings; [`page`] and [`csv`]
//! write that down. A sweep that was interrupted goes on where it stopped ([`Journal`]).
#![forbid(unsafe_code)]

mod accuracy;
mod baseline;
mod contender;
mod csv;
mod error;
mod figure;
mod front;
mod journal;
mod knee;
pub mod knobs;
mod lineup;
mod measured;
mod median;
mod page;
mod point;
mod setting;
mod settings;
mod sound;
mod subject;
mod sweep;
mod timing;
mod tradeoff;

pub use csv::csv;
pub use error::TradeoffError;
pub use figure::{Against, Cost, figure};
pub use front::front;
pub use journal::Journal;
pub use knee::{Knee, knee};
pub use page::page;
pub use point::{Point, QUANTISED, RECORDING};
pub use setting::Setting;
pub use subject::Subject;
pub use sweep::{LeftOut, Model, Progress, Request, Swept, sweep};
pub use tradeoff::{Machine, Tradeoff};
