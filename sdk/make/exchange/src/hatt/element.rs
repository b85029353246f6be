//! An XML element and its content.

use crate::error::Fault;

/// Longest quotation from a file, characters.
const MOST_QUOTED: usize = 100;

/// Returns the beginning of a text from the file, on one line.
pub(super) fn short(text: &str) -> String {
    let shown: String = text.chars().take(MOST_QUOTED).collect();
    shown.escape_debug().to_string()
}

/// Describes a place in the file: `line 12, ARcoeff`, or `line 12` outside of all elements.
pub(super) fn place(line: usize, element: Option<&str>) -> String {
    match element {
        None => format!("line {line}"),
        Some(element) => format!("line {line}, {}", short(element)),
    }
}

/// An XML element.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) attributes: Vec<(String, String)>,
    pub(super) text: String,
    pub(super) children: Vec<Element>,
    pub(super) line: usize,
}

impl Element {
    pub(super) fn place(&self) -> String {
        place(self.line, Some(&self.name))
    }

    pub(super) fn fault(&self, problem: impl AsRef<str>) -> Fault {
        Fault::new(self.place(), problem)
    }

    /// Returns all children with this name.
    pub(super) fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.name == name)
    }

    /// Returns the child with this name, or `None` if there is none. Several such children are an
    /// error.
    pub(super) fn one(&self, name: &str) -> Result<Option<&Element>, Fault> {
        let mut found = self.children.iter().filter(|child| child.name == name);
        let first = found.next();
        match found.next() {
            Some(second) => Err(second.fault("it is there twice; keep one of them")),
            None => Ok(first),
        }
    }

    /// Returns the child with this name. A missing child is an error.
    pub(super) fn required(&self, name: &str) -> Result<&Element, Fault> {
        let found = self.one(name)?;
        found.ok_or_else(|| self.fault(format!("it has no element {name}")))
    }

    /// Returns the beginning of the element's text, in quotation marks.
    pub(super) fn quoted(&self) -> String {
        format!("\"{}\"", short(self.text.trim()))
    }

    /// Returns the number in the element's text.
    pub(super) fn number(&self) -> Result<f64, Fault> {
        let number = self.text.trim().parse::<f64>().ok();
        let number = number.filter(|number| number.is_finite());
        number.ok_or_else(|| self.fault(format!("{} is no number", self.quoted())))
    }

    /// Returns the number in the element's text, which must be within a range.
    pub(super) fn number_in(&self, low: f64, high: f64) -> Result<f64, Fault> {
        let number = self.number()?;
        if (low..=high).contains(&number) {
            Ok(number)
        } else {
            Err(self.fault(format!("{number} is none from {low} to {high}")))
        }
    }

    /// Returns the count in the element's text.
    pub(super) fn count(&self) -> Result<usize, Fault> {
        let count = self.text.trim().parse().ok();
        count.ok_or_else(|| self.fault(format!("{} is no count", self.quoted())))
    }

    /// Returns the numbers of a list. Its children are named `value`.
    pub(super) fn values(&self) -> Result<Vec<f64>, Fault> {
        self.all("value").map(Element::number).collect()
    }
}
