//! Spectra that are coarse enough to store in an index, for programs that search for similar
//! textures.

/// Number of points, evenly spaced in log frequency from 20 to 1000 Hz.
pub(crate) const POINTS: usize = 48;
/// The range of the points, hertz.
const LOW_HZ: f64 = 20.0;
const HIGH_HZ: f64 = 1000.0;
/// Range of the levels below the largest one, decibels.
const RANGE_DB: f64 = 40.0;
/// Number of steps in that range.
const STEPS: f64 = 255.0;

/// A texture's spectrum at 48 points, for searches.
///
/// Point *i* is the level from 20·50^(i/48) to 20·50^((i+1)/48) Hz. Levels more than 40 dB below
/// the largest level are raised to this limit.
///
/// ```
/// use htex_format::library::CoarseSpectrum;
/// let frequency_hz: Vec<f64> = (4..=200).map(|i| 5.0 * f64::from(i)).collect();
/// let quiet = CoarseSpectrum::new(&frequency_hz, &[0.01; 197]).expect("it is not silent");
/// let loud = CoarseSpectrum::new(&frequency_hz, &[0.02; 197]).expect("it is not silent");
/// assert!((quiet.distance_db(&loud) - 6.02).abs() < 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseSpectrum {
    /// The largest level, decibels relative to one unit of the texture's quantity.
    pub(crate) largest_db: f32,
    /// The levels: 255 is the largest one, and 0 is 40 dB below it.
    pub(crate) levels: [u8; POINTS],
}

impl CoarseSpectrum {
    /// Reduces magnitudes at ascending frequencies. Returns `None` if the spectrum is silent from
    /// 20 to 1000 Hz.
    ///
    /// A point is the RMS of the magnitudes whose frequencies are in its range. If no frequency is
    /// in the range, the point is the interpolated magnitude at the centre of the range. Outside
    /// the range of the frequencies that the caller passes, the magnitude counts as 0.
    pub fn new(frequency_hz: &[f64], magnitude: &[f64]) -> Option<Self> {
        let edge = |i: usize| LOW_HZ * libm::pow(HIGH_HZ / LOW_HZ, i as f64 / POINTS as f64);
        let mut points = [0.0; POINTS];
        for (i, point) in points.iter_mut().enumerate() {
            let (from, to) = (edge(i), edge(i + 1));
            let first = frequency_hz.partition_point(|f| *f < from);
            // The last point includes 1000 Hz.
            let is_last = i + 1 == POINTS;
            let end = frequency_hz.partition_point(|f| *f < to || is_last && *f <= HIGH_HZ);
            let within = magnitude.get(first..end).unwrap_or_default();
            *point = if within.is_empty() {
                interpolated(frequency_hz, magnitude, libm::sqrt(from * to))
            } else {
                let energy: f64 = within.iter().map(|m| m * m).sum();
                libm::sqrt(energy / within.len() as f64)
            };
        }
        let largest = points.iter().copied().fold(0.0, f64::max);
        let largest_db = 20.0 * libm::log10(largest);
        if !largest_db.is_finite() {
            return None;
        }
        let levels = points.map(|point| {
            let below_db = 20.0 * libm::log10(largest / point);
            libm::round(STEPS * (1.0 - below_db / RANGE_DB)).clamp(0.0, STEPS) as u8
        });
        Some(Self { largest_db: largest_db as f32, levels })
    }

    /// Returns the 48 levels, decibels relative to one unit of the texture's quantity.
    pub fn levels_db(&self) -> [f64; POINTS] {
        let largest = f64::from(self.largest_db);
        self.levels.map(|level| largest - RANGE_DB * (1.0 - f64::from(level) / STEPS))
    }

    /// Returns the RMS difference of the levels, decibels.
    pub fn distance_db(&self, other: &Self) -> f64 {
        let offset = f64::from(self.largest_db) - f64::from(other.largest_db);
        let pairs = self.levels.iter().zip(&other.levels);
        // The differences are computed in steps, which are whole numbers. Therefore, only the
        // offset has rounding errors.
        let differences = pairs.map(|(a, b)| i32::from(*a) - i32::from(*b));
        let (sum, squares) = differences.fold((0, 0), |(sum, squares), difference| {
            (sum + difference, squares + difference * difference)
        });
        let (step, points) = (RANGE_DB / STEPS, POINTS as f64);
        let mean = step * f64::from(sum) / points;
        let mean_square = step * step * f64::from(squares) / points;
        libm::sqrt((mean_square + 2.0 * offset * mean + offset * offset).max(0.0))
    }
}

/// Returns the magnitude at a frequency, interpolated.
fn interpolated(frequency_hz: &[f64], magnitude: &[f64], at_hz: f64) -> f64 {
    let above = frequency_hz.partition_point(|f| *f < at_hz);
    let point = |i: usize| Some((*frequency_hz.get(i)?, *magnitude.get(i)?));
    match (above.checked_sub(1).and_then(point), point(above)) {
        (Some((f0, m0)), Some((f1, m1))) => m0 + (m1 - m0) * (at_hz - f0) / (f1 - f0),
        (None, Some((f1, m1))) if f1 == at_hz => m1,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(magnitude: impl Fn(f64) -> f64) -> Option<CoarseSpectrum> {
        let hertz: Vec<f64> = (4..=200).map(|i| 5.0 * f64::from(i)).collect();
        let magnitude: Vec<f64> = hertz.iter().map(|f| magnitude(*f)).collect();
        CoarseSpectrum::new(&hertz, &magnitude)
    }

    #[test]
    fn levels_are_those_of_the_magnitudes() {
        // This slope is a straight line over log frequency, even where the points are closer
        // together than the frequencies of the grid. Along the slope, a point spans 0.7 dB, and a
        // single frequency of the grid may lie at its edge.
        let slope = of(|f| 0.1 * f / 1000.0).unwrap().levels_db();
        for (i, level) in slope.iter().enumerate() {
            let hertz = 20.0 * 50f64.powf((i as f64 + 0.5) / 48.0);
            let expected = 20.0 * (0.1 * hertz / 1000.0).log10();
            assert!((level - expected).abs() < 0.45, "{hertz} Hz: {level} {expected}");
        }
        assert_eq!(of(|_| 0.0), None);
        let narrow = of(|f| if (200.0..400.0).contains(&f) { 1.0 } else { 0.0 }).unwrap();
        assert_eq!((narrow.levels[0], narrow.levels[47]), (0, 0));
        assert_eq!(narrow.levels[33], 255);
    }

    #[test]
    fn the_distance_is_that_of_the_levels() {
        let a = of(|f| 1.0 / f).unwrap();
        let b = of(|f| 0.002 + 0.3 / f).unwrap();
        let squares = a.levels_db().into_iter().zip(b.levels_db()).map(|(a, b)| (a - b).powi(2));
        let expected = (squares.sum::<f64>() / 48.0).sqrt();
        let distance = a.distance_db(&b);
        assert!(expected > 1.0 && (distance - expected).abs() < 1e-9);
        assert!(distance == b.distance_db(&a) && a.distance_db(&a) == 0.0);
    }
}
