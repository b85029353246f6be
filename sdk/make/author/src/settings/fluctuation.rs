//! A fluctuation given by the user.

use std::str::FromStr;

use htex_format::{Fluctuation, Manifest};

/// Largest standard deviation that an asset can store, decibels, rounded up to hundredths.
const MOST_DB: f64 = 7.97;

/// A fluctuation that the user gives for a texture, or 0 for a texture that does not fluctuate.
///
/// ```
/// use htex_author::settings::GivenFluctuation;
/// let given: GivenFluctuation = "3,1.5".parse()?;
/// assert_eq!(given, GivenFluctuation::new([3.0, 1.5])?);
/// assert!("3".parse::<GivenFluctuation>().is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GivenFluctuation(Option<Fluctuation>);

impl GivenFluctuation {
    /// Takes the standard deviations at 0.5 to 8 Hz and at 8 to 32 Hz, decibels, each from 0 to
    /// 7.97. Two zeros stand for no fluctuation.
    ///
    /// # Errors
    /// When a number is out of range.
    pub fn new(strength_db: [f64; 2]) -> Result<Self, String> {
        match strength_db.into_iter().find(|db| !(0.0..=MOST_DB).contains(db)) {
            Some(db) => Err(format!(
                "{db} dB is not the strength of a fluctuation; write a number from 0 to {MOST_DB}"
            )),
            None => Ok(Self(Fluctuation::from_db(strength_db))),
        }
    }

    /// Writes the fluctuation into a manifest, or removes the manifest's fluctuation.
    pub fn apply(self, manifest: &mut Manifest) {
        manifest.fluctuation = self.0;
    }
}

/// Reads `SLOW,FAST`.
impl FromStr for GivenFluctuation {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<f64>> =
            text.split(',').map(|number| number.trim().parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[slow, fast]) => Self::new([slow, fast]),
            _ => Err("it is two numbers of decibels, SLOW,FAST, e.g. 3,1.5; 0,0 removes the \
                      fluctuation"
                .to_owned()),
        }
    }
}
