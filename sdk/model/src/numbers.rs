//! Room for numbers that a model answers.

/// Numbers that a model writes one after the other, as many as there is room for; the others are
/// only counted, so that the caller can make room for them.
///
/// ```
/// let mut room = [0.0; 2];
/// let mut numbers = htex_model::Numbers::new(&mut room);
/// numbers.extend(&[1.0, 2.0, 3.0]);
/// assert_eq!((numbers.count(), numbers.written()), (3, &[1.0, 2.0][..]));
/// ```
#[derive(Debug)]
pub struct Numbers<'a> {
    room: &'a mut [f64],
    count: usize,
}

impl<'a> Numbers<'a> {
    /// None yet.
    pub fn new(room: &'a mut [f64]) -> Self {
        Self { room, count: 0 }
    }

    /// Writes one more.
    pub fn push(&mut self, number: f64) {
        if let Some(place) = self.room.get_mut(self.count) {
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

    /// Those that there was room for.
    pub fn written(&self) -> &[f64] {
        &self.room[..self.count.min(self.room.len())]
    }
}
