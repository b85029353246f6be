//! Accuracy against cost. Measures models and their options on recordings, and compares the errors
//! with the size in bytes and with the computing time.
//!
//! [`sweep`] fits, measures and times all settings on recordings ([`Subject`]). A setting is a
//! value for each knob: the fit options of a model, and options for storing and playing. Two
//! baselines are also measured, for comparison. [`Tradeoff::new`] finds Pareto fronts, their knees,
//! and warnings in the result. [`page`] and [`csv`] write this evaluation. An interrupted sweep
//! continues from its [`Journal`].
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod accuracy;
mod against;
mod baseline;
mod contender;
mod csv;
mod error_axis;
mod figure;
mod front;
mod held_out;
mod journal;
mod knee;
pub mod knobs;
mod lineup;
mod measurement;
mod median;
mod outcome;
mod page;
mod point;
mod request;
mod setting;
mod settings;
mod sound;
mod subject;
mod sweep;
mod timing;

pub use against::{Against, Cost};
pub use csv::csv;
pub use error_axis::ErrorAxis;
pub use front::front;
pub use journal::Journal;
pub use knee::{Knee, knee};
pub use outcome::{Machine, Tradeoff};
pub use page::page;
pub(crate) use point::QUANTISED;
pub use point::{Point, RECORDING, RenderedAccuracy, Shares, errors, others};
pub use request::{Model, Request};
pub use setting::Setting;
pub use subject::Subject;
pub use sweep::{LeftOut, Progress, SweepResult, sweep};
