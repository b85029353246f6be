//! Output buffer for numbers that a model writes.

/// Numbers that a model writes one after the other, as many as fit into the buffer; the others are
/// only counted, so that the caller can provide a larger one.
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
    /// None yet.
    pub fn new(buffer: &'a mut [f64]) -> Self {
        Self { buffer, count: 0 }
    }

    /// Writes one more.
    pub fn push(&mut self, number: f64) {
        if let Some(place) = self.buffer.get_mut(self.count) {
            *place = number;
        }
        self.count += 1;
    }

    /// Writes some more.
    pub fn extend(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|number| self.push(*number));
    }

    /// How many there are, written or not.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Those that fit into the buffer.
    pub fn written(&self) -> &[f64] {
        &self.buffer[..self.count.min(self.buffer.len())]
    }
}
