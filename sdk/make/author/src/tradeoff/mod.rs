//! Accuracy against cost: measures models and their options on recordings, and compares their
//! errors with their size in bytes and their time.
//!
//! [`sweep`] fits, measures and times all settings on some [`Subject`]s: the options of models,
//! options for playing (knobs), and two baselines for comparison. [`Tradeoff::new`] finds fronts,
//! knees and warnings in the result; [`page`] and [`csv`] write it. An interrupted sweep continues
//! from its [`Journal`].
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
