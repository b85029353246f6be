//! Numbers in elements.

use super::document::Element;
use super::fault::{Fault, short};

impl Element {
    /// The beginning of its text, in quotation marks.
    pub(super) fn quoted(&self) -> String {
        format!("\"{}\"", short(self.text.trim()))
    }

    /// The number that the element holds.
    pub(super) fn number(&self) -> Result<f64, Fault> {
        let number = self.text.trim().parse::<f64>().ok();
        let number = number.filter(|number| number.is_finite());
        number.ok_or_else(|| {
            self.fault(format!("{} is no number", self.quoted()))
        })
    }

    /// As [`Self::number`], within a range.
    pub(super) fn number_in(&self, low: f64, high: f64) -> Result<f64, Fault> {
        let number = self.number()?;
        match (low..=high).contains(&number) {
            true => Ok(number),
            false => Err(self.fault(format!("{number} is none from {low} to {high}"))),
        }
    }

    /// A count.
    pub(super) fn count(&self) -> Result<usize, Fault> {
        let count = self.text.trim().parse().ok();
        count.ok_or_else(|| self.fault(format!("{} is no count", self.quoted())))
    }

    /// The elements of a list, named `value`.
    pub(super) fn values(&self) -> Result<Vec<f64>, Fault> {
        self.all("value").map(Element::number).collect()
    }
}
