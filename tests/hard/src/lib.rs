//! Hard cases. Each has an input, a model or a part of the library, an operation, and a promise: a
//! finite result within a stated bound, or a refusal with a named error. The table is tested
//! (`tests/it/table.rs`) and published (`spec/hard-cases.md`).
//!
//! The bounds are part of the project. The tests print the errors that a machine measures.
#![allow(clippy::unwrap_used, clippy::panic)] // Test code: a failure is a failed test.
#![forbid(unsafe_code)]

pub mod big;
mod cases;
pub mod exact;
pub mod long;
mod page;
pub mod seen;
pub mod signals;

pub use page::page;

/// One row of the table.
#[derive(Debug)]
pub struct Case {
    pub input: &'static str,
    /// The model, or the part of the library.
    pub subject: &'static str,
    pub operation: &'static str,
    pub promise: Promise,
}

/// The promise of a case.
#[derive(Debug)]
pub enum Promise {
    /// Finite, and within `bound` of the reference `with`.
    Within {
        /// Largest error.
        bound: f64,
        /// Unit of the error.
        unit: &'static str,
        /// The reference.
        with: &'static str,
        /// The largest error; NaN, which exceeds every bound, if something is not finite.
        worst: fn() -> f64,
    },
    /// Refused with an error.
    Refused {
        /// The error's text, or a part of it.
        by: &'static str,
        /// Runs the case. Returns the error's text, or what happened instead.
        said: fn() -> String,
    },
}

/// The bound of an error, its unit, and the reference.
#[derive(Debug, Clone, Copy)]
pub struct Bound(pub f64, pub &'static str, pub &'static str);

/// A row whose result lies within `bound`: the largest error, its unit, and the reference.
pub(crate) const fn within(
    input: &'static str,
    subject: &'static str,
    operation: &'static str,
    Bound(bound, unit, with): Bound,
    worst: fn() -> f64,
) -> Case {
    Case { input, subject, operation, promise: Promise::Within { bound, unit, with, worst } }
}

/// A row that is refused with a text that contains `by`.
pub(crate) const fn refused(
    input: &'static str,
    subject: &'static str,
    operation: &'static str,
    by: &'static str,
    said: fn() -> String,
) -> Case {
    Case { input, subject, operation, promise: Promise::Refused { by, said } }
}

/// The larger of two errors; NaN if either is NaN.
pub(crate) fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        return f64::NAN;
    }
    a.max(b)
}

/// Number of conditions that do not hold. A row with [`none`] promises 0.
pub(crate) fn failures(of: impl IntoIterator<Item = bool>) -> f64 {
    of.into_iter().filter(|holds| !holds).count() as f64
}

/// A bound that allows no failure.
pub(crate) const fn none(what: &'static str) -> Bound {
    Bound(0.0, "failures", what)
}

/// Cases of one kind.
#[derive(Debug)]
pub struct Section {
    /// Heading.
    pub title: &'static str,
    /// Description.
    pub about: &'static str,
    /// The rows.
    pub cases: &'static [Case],
}

pub fn sections() -> Vec<Section> {
    cases::sections()
}

impl Case {
    /// Runs the case. Returns the measured error, or the refusal, as text for the test's output.
    ///
    /// # Errors
    /// The promise and the result.
    pub fn run(&self) -> Result<String, String> {
        let name = format!("{} | {} | {}", self.input, self.subject, self.operation);
        match self.promise {
            Promise::Within { bound, unit, worst, .. } => {
                let found = worst();
                let text = format!("{name}: {found:.3e} {unit} (at most {bound:e})");
                if found <= bound { Ok(text) } else { Err(text) }
            }
            Promise::Refused { by, said } => {
                let found = said();
                let text = format!("{name}: {found}");
                if found.contains(by) {
                    Ok(text)
                } else {
                    Err(format!("{text}; a refusal that says `{by}` was promised"))
                }
            }
        }
    }
}
