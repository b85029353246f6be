//! Finds out how to read the recording of a take, from the JSON next to the recording.

use std::io::{self, Read};
use std::path::{Path, PathBuf};

use htex_author::recording::read_recording;
use htex_author::settings::ReadingSettings;
use htex_author::{Averaging, Exploration, SpectrumOptions, Take, TextureSpectrum, segment_take};
use htex_base::files::{FileError, open_regular, read_regular};
use htex_format::Quantity;
use serde::Deserialize;
use serde_json::Value;

use crate::error::LabError;
use crate::record::data::TakeHeader;
use crate::record::files::{self, Outcome};
use crate::record::live::LiveSpectrum;
use crate::record::write::reading;

/// Largest JSON file that is read, bytes. The JSON of a take has a few thousand bytes.
pub(crate) const MOST_BYTES: u64 = 1 << 20;

/// A recording made by `htex record` or in a study, with the settings to read it: columns, rate,
/// quantity and the tracker's file.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownTake {
    pub recording: PathBuf,
    pub settings: ReadingSettings,
}

impl KnownTake {
    /// Finds a take. `file` is the take's recording, or the JSON next to the recording. Returns
    /// `None` if there is no such JSON, or if the JSON belongs to a recording in another format.
    ///
    /// # Errors
    /// Returns [`LabError::File`] if the JSON describes a take but has another version or unknown
    /// keys.
    ///
    /// ```
    /// // Not a take: nothing is known but the file itself.
    /// assert_eq!(htex_lab::record::KnownTake::find("other.npy".as_ref())?, None);
    /// # Ok::<(), htex_lab::LabError>(())
    /// ```
    pub fn find(file: &Path) -> Result<Option<Self>, LabError> {
        let beside = file.with_extension("json");
        let header = match header(&beside) {
            Ok(Some(header)) => header,
            Err(error) if error.kind() == io::ErrorKind::InvalidData => {
                return Err(FileError::content(beside, error).into());
            }
            _ => return Ok(None),
        };
        let recording = file.with_extension(header.format.extension());
        let extension = file.extension().unwrap_or_default();
        let is_its = extension.eq_ignore_ascii_case(header.format.extension());
        let recording = if is_its {
            file.to_owned()
        } else if beside == file {
            recording
        } else {
            return Ok(None);
        };
        let settings = settings(&recording, &header);
        Ok(Some(Self { recording, settings }))
    }

    /// Returns the settings for reading the take. The columns, rate, quantity and tracker come from
    /// the take, and all other settings from `given`.
    #[must_use]
    pub fn with_given(self, given: &ReadingSettings) -> ReadingSettings {
        let given = given.clone();
        ReadingSettings {
            response: given.response,
            from_s: given.from_s,
            to_s: given.to_s,
            most_values: given.most_values,
            segments: given.segments,
            averaging: given.averaging,
            ..self.settings
        }
    }
}

/// Reads the header of a take from the JSON next to its recording; `None` if the file does not
/// describe a take. For a header of another version, returns the error
/// [`io::ErrorKind::InvalidData`].
pub(crate) fn header(beside: &Path) -> io::Result<Option<TakeHeader>> {
    let mut bytes = Vec::new();
    // A longer file is cut off. It is then invalid JSON and does not count as a take.
    open_regular(beside)?.take(MOST_BYTES).read_to_end(&mut bytes)?;
    let mut json = serde_json::from_slice::<Value>(&bytes).unwrap_or_default();
    let take = json.get_mut("take").map(Value::take);
    let take = take.filter(|take| take.get("htex_take").is_some());
    let header = take.map(TakeHeader::of_json).transpose();
    header.map_err(|problem| io::Error::new(io::ErrorKind::InvalidData, format!("take: {problem}")))
}

/// Returns the settings with which the recording of a take must be read.
pub(crate) fn settings(recording: &Path, header: &TakeHeader) -> ReadingSettings {
    let (map, rate_hz) = reading(header);
    ReadingSettings {
        map,
        rate_hz,
        quantity: Some(header.quantity),
        tracker: tracker(recording).map(|file| vec![file]),
        ..ReadingSettings::default()
    }
}

/// Returns the file with the tracker's rows of a recording, if there is one.
fn tracker(recording: &Path) -> Option<PathBuf> {
    let name = Path::new(recording.file_name()?).with_extension("csv");
    let tracker = recording.parent()?.join("tracker").join(name);
    tracker.is_file().then_some(tracker)
}

/// The needed parts of the JSON next to a recording.
#[derive(Deserialize)]
struct Beside {
    outcome: Outcome,
    take: TakeHeader,
}

/// Returns the texture spectrum of the newest accepted take with this name, as `htex fit` would
/// read it. Returns `None` if the folder has no such take of this quantity, or if its files cannot
/// be read any more.
pub(crate) fn kept_spectrum(folder: &Path, name: &str, quantity: Quantity) -> Option<LiveSpectrum> {
    let number = files::kept_number(folder, name)?;
    let stem = files::stem(name, number);
    let beside = folder.join(format!("{stem}.json"));
    let beside = read_regular(&beside, MOST_BYTES).ok()?;
    let Beside { outcome, take } = serde_json::from_slice(&beside).ok()?;
    if outcome != Outcome::Kept || take.quantity != quantity {
        return None;
    }
    let file = folder.join(format!("{stem}.{}", take.format.extension()));
    let options = settings(&file, &take).read_options(1).ok()?.pop()?;
    let take =
        Take { recording: read_recording(&file, &options).ok()?, given: Exploration::default() };
    let reading = segment_take(&take, &SpectrumOptions::default(), false).ok()?;
    let texture = TextureSpectrum::average(&[reading.spectra], Averaging::Rms).ok()?;
    Some(LiveSpectrum::from_texture(&texture))
}
