//! Power per hour.

/// Mean squares of consecutive parts of a stream.
#[derive(Debug)]
pub struct Power {
    part: u64,
    sum: f64,
    count: u64,
    /// Mean square of each complete part.
    pub parts: Vec<f64>,
}

impl Power {
    /// Makes parts with this many samples.
    pub fn new(part: u64) -> Self {
        Self { part: part.max(1), sum: 0.0, count: 0, parts: Vec::new() }
    }

    pub fn add(&mut self, mut samples: &[f32]) {
        while !samples.is_empty() {
            let left = (self.part - self.count).min(samples.len() as u64) as usize;
            let (now, later) = samples.split_at(left);
            // Blocks are short, so their sums are added in f64.
            self.sum += now.iter().map(|&x| f64::from(x) * f64::from(x)).sum::<f64>();
            self.count += left as u64;
            samples = later;
            if self.count == self.part {
                self.parts.push(self.sum / self.part as f64);
                (self.sum, self.count) = (0.0, 0);
            }
        }
    }
}

/// Decibels between the loudest and the softest part.
pub fn drift_db(parts: &[f64]) -> f64 {
    let most = parts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = parts.iter().copied().fold(f64::INFINITY, f64::min);
    10.0 * (most / least).log10()
}
