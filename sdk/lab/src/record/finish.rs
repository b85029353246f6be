//! Turns a part file into a recording, at the end of a take or after a program was killed.

use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, ContentError, OwnFolder};
use serde::Serialize;

use crate::record::error::RecordError;
use crate::record::format::Outcome;
use crate::record::judge::{Verdict, judge};
use crate::record::names;
use crate::record::part::read_part;
use crate::record::write::write_take;

/// A take that was completed or recovered.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Recorded {
    pub file: PathBuf,
    pub outcome: Outcome,
    /// Number of the take.
    pub number: u32,
    pub recorded_s: f64,
    pub verdict: Verdict,
    /// Arguments with which `htex fit` reads it.
    pub fit: Vec<String>,
}

/// Creates the error for a take that was cut short, with the file that holds its beginning.
pub(crate) fn with_kept(error: RecordError, kept: Option<Recorded>) -> RecordError {
    let after_s = kept.as_ref().map_or(0.0, |kept| kept.recorded_s);
    let kept = kept.map(|kept| kept.file);
    match error {
        RecordError::Ended { seconds, .. } => RecordError::Ended { after_s, seconds, kept },
        RecordError::Left { .. } => RecordError::Left { kept },
        error => RecordError::Interrupted { error: Box::new(error), kept },
    }
}

/// Writes the recording of a part file and removes the part file; `None` if nothing was recorded.
pub(crate) fn finish(folder: &Path, path: &Path) -> Result<Option<Recorded>, RecordError> {
    let data = read_part(path)?.filter(|data| data.frames() > 0);
    let recorded = match data {
        None => None,
        Some(data) => {
            let verdict = judge(&data);
            let outcome = match (data.is_complete(), verdict.kept) {
                (false, _) => Outcome::Incomplete,
                (true, false) => Outcome::Rejected,
                (true, true) => Outcome::Kept,
            };
            let written = write_take(folder, &data, outcome, &verdict)?;
            Some(Recorded {
                file: written.recording,
                outcome,
                number: data.header.number,
                recorded_s: data.recorded_s(),
                verdict,
                fit: written.fit,
            })
        }
    };
    // Only now, when the recording is on disk. After a crash before this, the take is recovered.
    let name = path.file_name().unwrap_or_default();
    OwnFolder::new(folder).remove(Path::new(name)).writing(path)?;
    Ok(recorded)
}

/// Turns the takes that a killed program left in a folder into recordings, and returns them. A take
/// that was already complete is judged as usual. Takes that another program is recording are left
/// alone.
///
/// # Errors
/// If the header of a part file is damaged, or a recording cannot be written.
pub fn recover(folder: &Path) -> Result<Vec<Recorded>, RecordError> {
    let parts = names::parts(folder).map_err(ContentError::in_file(folder))?;
    let mut recovered = Vec::new();
    for path in &parts {
        match finish(folder, path) {
            Err(RecordError::Busy { .. }) => {}
            take => recovered.extend(take?),
        }
    }
    Ok(recovered)
}
