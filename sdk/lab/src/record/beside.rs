//! How the recording of a take is read, from the JSON beside it.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use htex_author::settings::ReadingSettings;
use serde_json::Value;

use crate::record::data::TakeHeader;
use crate::record::write::reading;

/// Longest JSON that is read, bytes; that of a take has a few thousand.
const MOST_BYTES: u64 = 1 << 20;

/// Settings that read a recording of `htex record` or of a study, from the JSON beside it: columns, rate, quantity and the tracker's
/// file. `None` if there is no such JSON, or if it is of a recording in another format.
///
/// ```
/// // Not a take: nothing is known but the file itself.
/// assert_eq!(htex_lab::record::take_settings("other.npy".as_ref()), None);
/// ```
#[must_use]
pub fn take_settings(recording: &Path) -> Option<ReadingSettings> {
    let header = header(&recording.with_extension("json")).ok()??;
    let extension = recording.extension()?;
    let is_its = extension.eq_ignore_ascii_case(header.format.extension());
    is_its.then(|| settings(recording, &header))
}

/// The header of a take in the JSON beside its recording; `None` if the file is not of a take.
pub(crate) fn header(beside: &Path) -> io::Result<Option<TakeHeader>> {
    let mut bytes = Vec::new();
    File::open(beside)?
        .take(MOST_BYTES)
        .read_to_end(&mut bytes)?;
    let json = serde_json::from_slice::<Value>(&bytes).ok();
    Ok(json.and_then(|mut json| serde_json::from_value(json.get_mut("take")?.take()).ok()))
}

/// Settings that read the recording of a take.
pub(crate) fn settings(recording: &Path, header: &TakeHeader) -> ReadingSettings {
    let (map, rate_hz) = reading(header);
    ReadingSettings {
        map,
        rate_hz,
        quantity: Some(header.quantity),
        trackers: tracker(recording).into_iter().collect(),
        ..ReadingSettings::default()
    }
}

/// The tracker's rows of a recording, if there are any.
fn tracker(recording: &Path) -> Option<PathBuf> {
    let name = Path::new(recording.file_name()?).with_extension("csv");
    let tracker = recording.parent()?.join("tracker").join(name);
    tracker.is_file().then_some(tracker)
}
