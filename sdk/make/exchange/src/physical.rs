//! Values that imported files do not contain: the full scale (the physical value of the number 1 in
//! the file), and the motion of the finger.

use htex_author::Exploration;
use htex_format::Quantity;

use crate::error::{ExchangeError, Missing, in_file};
use crate::format::{Format, Naming, Reads};
use crate::map;

/// Values that the user gives because a file with a signal or an image does not contain them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Physical {
    /// The physical value of the number 1 in the file, or of white in an image. The value is in the
    /// unit of the quantity, such as newtons for a lateral force.
    pub full_scale: Option<f64>,
    pub quantity: Quantity,
    /// Speed of the finger, mm/s.
    pub speed_mm_s: Option<f64>,
    /// Normal force of the finger, newtons.
    pub force_n: Option<f64>,
    /// Distance between the pixels of an image, mm. If the user gives this distance, it replaces
    /// the distance in the file.
    pub pitch_mm: Option<f64>,
}

const FULL_SCALE: Missing = Missing { setting: "full_scale", words: "how strong 1 is" };
const SPEED: Missing = Missing { setting: "speed", words: "at which speed it is felt" };
const FORCE: Missing = Missing { setting: "force", words: "at which force" };
pub(crate) const PITCH: Missing =
    Missing { setting: "pitch", words: "how far apart its pixels are" };
/// Largest normal force, newtons.
const MOST_FORCE_N: f64 = 1e3;

/// Reads a file, and returns the values that the file lacks and that the user must therefore give
/// for an import. The result is empty for a file that contains or fully describes an asset. `file`
/// is the file's name.
///
/// # Errors
/// Returns an error if no format has the file's extension, or the file is invalid. The error names
/// the place.
///
/// ```
/// let file = br#"{"Version": 1, "Pattern": [{"Event": {"Time": 0, "EventType": "HapticTransient"}}]}"#;
/// let missing = htex_exchange::missing("tap.ahap", file)?;
/// let settings: Vec<&str> = missing.iter().map(|missing| missing.setting).collect();
/// assert_eq!(settings, ["full_scale", "speed", "force"]);
/// # Ok::<(), htex_exchange::ExchangeError>(())
/// ```
pub fn missing(file: &str, bytes: &[u8]) -> Result<Vec<Missing>, ExchangeError> {
    let format = Format::of_file(file)?;
    let mut missing = format.reads.map_or(Vec::new(), |reads| reads.missing());
    match format.reads {
        Some(Reads::Asset(read)) => {
            read(bytes, &Naming::default()).map_err(in_file(file))?;
        }
        Some(Reads::Map) => {
            let image = map::read(bytes).map_err(in_file(file))?;
            if image.pitch_mm.is_some() {
                missing.retain(|missing| *missing != PITCH);
            }
        }
        _ => {
            // The faster the finger moves, the shorter a file over space becomes. So the file is
            // read at the highest speed.
            format.signal(file, bytes, Exploration::MOST_SPEED_MM_S, None)?;
        }
    }
    Ok(missing)
}

impl Reads {
    /// Returns the values that some or all files of this format lack. For images, the result
    /// includes the distance between pixels, because only some images state it.
    #[must_use]
    pub fn missing(&self) -> Vec<Missing> {
        match self {
            Self::Asset(_) => Vec::new(),
            Self::Positions { .. } | Self::Signal(_) => vec![FULL_SCALE, SPEED, FORCE],
            Self::Map => vec![FULL_SCALE, SPEED, FORCE, PITCH],
        }
    }
}

impl Physical {
    /// Checks that all values that the format needs are given and in range.
    ///
    /// # Errors
    /// Returns an error if a value is missing or out of range. The error names all missing values,
    /// or the first value that is out of range.
    pub fn check(&self, format: &Format) -> Result<(), ExchangeError> {
        self.values(format).map(drop)
    }

    /// Returns the values, if all values that the format needs are given and in range.
    pub(crate) fn values(&self, format: &Format) -> Result<PhysicalValues, ExchangeError> {
        let all = [(FULL_SCALE, self.full_scale), (SPEED, self.speed_mm_s), (FORCE, self.force_n)];
        let (Some(full_scale), Some(speed), Some(force)) =
            (self.full_scale, self.speed_mm_s, self.force_n)
        else {
            let missing = all.iter().filter(|(_, given)| given.is_none());
            return Err(ExchangeError::Missing {
                format: format.title,
                missing: missing.map(|(missing, _)| *missing).collect(),
            });
        };
        let above = |name, value: f64, most: f64, range| {
            // Written so that NaN is also refused.
            if value > 0.0 && value <= most {
                Ok(())
            } else {
                Err(ExchangeError::OutOfRange { name, value, range })
            }
        };
        let most_mm_s = Exploration::MOST_SPEED_MM_S;
        above("full_scale", full_scale, 1e6, "more than 0, at most 1e6")?;
        above("speed", speed, most_mm_s, "more than 0 mm/s, at most 10,000 mm/s")?;
        above("force", force, MOST_FORCE_N, "more than 0 N, at most 1000 N")?;
        if let Some(pitch_mm) = self.pitch_mm {
            let most = *map::PITCH_MM.end();
            above("pitch", pitch_mm, most, "more than 0 mm, at most 64 mm")?;
        }
        Ok(PhysicalValues { full_scale, speed_mm_s: speed, force_n: force })
    }
}

/// Values that a file does not state. They were checked and are in range.
#[derive(Clone, Copy)]
pub(crate) struct PhysicalValues {
    pub(crate) full_scale: f64,
    pub(crate) speed_mm_s: f64,
    pub(crate) force_n: f64,
}
