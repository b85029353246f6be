//! The output buffer of a model's interpolation.

/// An output buffer to which a model writes numbers. Numbers that do not fit are counted but not
/// stored, so that the caller can provide a larger buffer.
///
/// ```
/// let mut buffer = [0.0; 2];
/// let mut numbers = htex_model::Numbers::new(&mut buffer);
/// numbers.extend(&[1.0, 2.0, 3.0]);
/// assert_eq!((numbers.count(), numbers.written()), (3, &[1.0, 2.0][..]));
/// ```
#[derive(Debug)]
pub struct Numbers<'a> {
    buffer: &'a mut [f64],
    count: usize,
}

impl<'a> Numbers<'a> {
    /// Makes an empty output over a buffer.
    pub fn new(buffer: &'a mut [f64]) -> Self {
        Self { buffer, count: 0 }
    }

    /// Writes a number. If the buffer is full, the number is counted but not stored.
    pub fn push(&mut self, number: f64) {
        if let Some(place) = self.buffer.get_mut(self.count) {
            *place = number;
        }
        self.count += 1;
    }

    /// Writes several numbers.
    pub fn extend(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|number| self.push(*number));
    }

    /// Returns how many numbers the model wrote, including the numbers that did not fit into the
    /// buffer.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns the values in the buffer.
    pub fn written(&self) -> &[f64] {
        &self.buffer[..self.count.min(self.buffer.len())]
    }
}
