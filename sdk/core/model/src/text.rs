//! Builds error texts without the text formatting of the standard library. That formatting code
//! alone is larger than a small WASM module.

use alloc::string::String;

use crate::decimal::{rounded, whole};

/// A piece of a text.
#[derive(Debug, Clone, Copy)]
pub enum TextPart<'a> {
    /// A string.
    Words(&'a str),
    /// A whole number.
    Whole(u64),
    /// A number, written with up to nine significant digits.
    Number(f64),
}

impl<'a> From<&'a str> for TextPart<'a> {
    fn from(words: &'a str) -> Self {
        Self::Words(words)
    }
}

impl From<usize> for TextPart<'_> {
    fn from(number: usize) -> Self {
        Self::Whole(number as u64)
    }
}

impl From<u32> for TextPart<'_> {
    fn from(number: u32) -> Self {
        Self::Whole(u64::from(number))
    }
}

impl From<f64> for TextPart<'_> {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// Concatenates the parts to one text. The macro [`text!`](crate::text!) calls this function, and
/// is shorter to write.
#[cold]
pub fn concat(parts: &[TextPart<'_>]) -> String {
    let mut text = String::new();
    for part in parts {
        match *part {
            TextPart::Words(words) => text.push_str(words),
            TextPart::Whole(number) => push_ascii(&mut text, whole(number).bytes()),
            TextPart::Number(number) => push_number(&mut text, number),
        }
    }
    text
}

fn push_number(text: &mut String, number: f64) {
    if number.is_nan() {
        text.push_str("NaN");
    } else if number.is_infinite() {
        text.push_str(if number > 0.0 { "inf" } else { "-inf" });
    } else {
        push_ascii(text, rounded(number).text().bytes());
    }
}

fn push_ascii(text: &mut String, bytes: &[u8]) {
    bytes.iter().for_each(|&byte| text.push(char::from(byte)));
}

/// Makes a [`String`] from words and numbers, for the message of an [`Error`](crate::Error).
///
/// ```
/// let (peak_hz, lines) = (0.1, 3usize);
/// let text = htex_model::text!["a peak at ", peak_hz, " Hz and ", lines, " lines"];
/// assert_eq!(text, "a peak at 0.1 Hz and 3 lines");
/// ```
#[macro_export]
macro_rules! text {
    ($($part:expr),* $(,)?) => {
        $crate::text::concat(&[$($crate::text::TextPart::from($part)),*])
    };
}
