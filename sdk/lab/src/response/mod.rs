//! Measures the frequency response of a recording rig or a finger display, from recordings of its
//! input and output.
//!
//! The input is either the force of a hammer in separate hits, or the continuous drive of a
//! display. Each hit, or each window of a continuous drive, is transformed to a spectrum. The
//! averaged auto spectra and cross spectrum give the response ([`Estimator`]) and the coherence.
//! Hits or windows that would distort the average are thrown out. The result lists each of them
//! with its time and [`Reason`].
//!
//! Sources of the formulas:
//! - J. S. Bendat, A. G. Piersol, *Random Data*, 4th ed., Wiley 2010: spectra of segments (section
//!   11.5), H1 and coherence (chapter 6), random errors (chapter 9).
//! - G. T. Rocklin, J. Crowley, H. Vold, *A comparison of H1, H2 and Hv frequency response
//!   functions*, IMAC III, 1985.
//! - W. A. Fladung, *Windows used for impact testing*, IMAC XV, 1997: force and exponential
//!   windows.
//! - P. D. Welch, *The use of fast Fourier transform for the estimation of power spectra*, IEEE
//!   Trans. Audio Electroacoust. 15, 1967: overlapping windows.
//!
//! ```
//! use htex_lab::response::{Record, ResponseSettings, measure};
//! // Five hits of 1 ms on a rig that doubles the force, 0.4 s apart, at 2 kHz.
//! let input: Vec<f64> = (0..4400).map(|i| if i % 800 == 400 { 3.0 } else { 0.0 }).collect();
//! let output = input.iter().map(|x| 2.0 * x).collect();
//! let record = Record::new("hits.csv", 2000.0, input, output)?;
//! let settings = ResponseSettings { window_s: 0.2, ..Default::default() };
//! let response = measure(&[record], &settings)?;
//! assert_eq!((response.averages, response.resolution_hz), (5, 5.0));
//! assert!(response.magnitude.iter().all(|gain| (gain - 2.0).abs() < 1e-12));
//! # Ok::<(), htex_lab::LabError>(())
//! ```

mod average;
mod estimator;
mod frames;
mod hits;
mod measure;
mod overload;
mod picture;
mod pieces;
mod record;
mod settings;

pub use estimator::Estimator;
pub use measure::{MeasuredResponse, Peak, measure};
pub use picture::response_picture;
pub use pieces::{Piece, Reason};
pub use record::{Channel, Record, column_map};
pub use settings::ResponseSettings;
