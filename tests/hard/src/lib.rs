//! Hard cases: an input, the part or model it goes through, an operation, and what is promised:
//! finite and within a stated bound, or a refusal by name. One table, which is tested
//! (`tests/table.rs`) and written out (`spec/hard-cases.md`).
//!
//! The bounds are part of the project; what a machine measures below them is printed by the tests.
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
    /// What comes in.
    pub input: &'static str,
    /// The model, or the part of the library.
    pub subject: &'static str,
    /// What is done.
    pub operation: &'static str,
    /// What is promised of it.
    pub promise: Promise,
}

/// What is promised of a case.
#[derive(Debug)]
pub enum Promise {
    /// Finite, and no farther than `bound` from what it is compared `with`.
    Within {
        /// Largest error.
        bound: f64,
        /// Unit of the error.
        unit: &'static str,
        /// What it is compared with.
        with: &'static str,
        /// The largest error found; NaN, which no bound holds, where something is not finite.
        worst: fn() -> f64,
    },
    /// Not done, and said so.
    Refused {
        /// What the refusal says, or a part of it.
        by: &'static str,
        /// The refusal; what happened instead, if it is not refused.
        said: fn() -> String,
    },
}

/// What a result is compared with, and how near it is.
#[derive(Debug, Clone, Copy)]
pub struct Bound(pub f64, pub &'static str, pub &'static str);

/// A row whose result lies within `bound`: largest error, its unit, what it is compared with.
pub(crate) const fn within(
    input: &'static str,
    subject: &'static str,
    operation: &'static str,
    Bound(bound, unit, with): Bound,
    worst: fn() -> f64,
) -> Case {
    Case {
        input,
        subject,
        operation,
        promise: Promise::Within {
            bound,
            unit,
            with,
            worst,
        },
    }
}

/// A row that is refused in words that hold `by`.
pub(crate) const fn refused(
    input: &'static str,
    subject: &'static str,
    operation: &'static str,
    by: &'static str,
    said: fn() -> String,
) -> Case {
    Case {
        input,
        subject,
        operation,
        promise: Promise::Refused { by, said },
    }
}

/// The larger of two errors; NaN if either is.
pub(crate) fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        return f64::NAN;
    }
    a.max(b)
}

/// 0 if all is as it must be; a row of [`none`] promises just that.
pub(crate) fn failures(of: impl IntoIterator<Item = bool>) -> f64 {
    of.into_iter().filter(|holds| !holds).count() as f64
}

/// No failure.
pub(crate) const fn none(what: &'static str) -> Bound {
    Bound(0.0, "failures", what)
}

/// Cases of one kind.
#[derive(Debug)]
pub struct Section {
    /// Heading.
    pub title: &'static str,
    /// What they have in common.
    pub about: &'static str,
    /// The rows.
    pub cases: &'static [Case],
}

/// The table.
pub fn sections() -> Vec<Section> {
    cases::sections()
}

impl Case {
    /// Runs the case; the error found, or the refusal, as a text for the test's output.
    ///
    /// # Errors
    /// What was promised and what came instead.
    pub fn run(&self) -> Result<String, String> {
        let name = format!("{} | {} | {}", self.input, self.subject, self.operation);
        match self.promise {
            Promise::Within {
                bound, unit, worst, ..
            } => {
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
