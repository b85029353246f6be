//! Converts a part file to a recording, at the end of a take or after a program was killed.

use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, FileError, OwnFolder};
use serde::Serialize;

use crate::error::LabError;
use crate::record::files::{self, Outcome};
use crate::record::judge::{Verdict, judge};
use crate::record::part::read_part;
use crate::record::write::write_take;

/// A take that was completed or recovered.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TakeReport {
    pub file: PathBuf,
    pub outcome: Outcome,
    /// Number of the take.
    pub number: u32,
    pub recorded_s: f64,
    pub verdict: Verdict,
    /// Arguments with which `htex fit` reads the recording.
    pub fit: Vec<String>,
}

/// A take was cut short by an error. Adds to this error the path of the file that contains the
/// beginning of the take.
pub(crate) fn with_kept(error: LabError, kept: Option<TakeReport>) -> LabError {
    let after_s = kept.as_ref().map_or(0.0, |kept| kept.recorded_s);
    let kept = kept.map(|kept| kept.file);
    match error {
        LabError::Ended { seconds, .. } => LabError::Ended { after_s, seconds, kept },
        LabError::Left { .. } => LabError::Left { kept },
        error => LabError::Interrupted { error: Box::new(error), kept },
    }
}

/// Writes the recording of a part file, and removes the part file. Returns `None` if nothing was
/// recorded.
pub(crate) fn finish(folder: &Path, path: &Path) -> Result<Option<TakeReport>, LabError> {
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
            Some(TakeReport {
                file: written.recording,
                outcome,
                number: data.header.number,
                recorded_s: data.recorded_s(),
                verdict,
                fit: written.fit,
            })
        }
    };
    // The part file is removed only now, when the recording is on disk. If the program crashes
    // earlier, the take can be recovered.
    let name = path.file_name().unwrap_or_default();
    OwnFolder::new(folder).remove(Path::new(name)).writing(path)?;
    Ok(recorded)
}

/// Finds the takes that a killed program left in a folder, converts them to recordings, and returns
/// the recordings. Complete takes among them are judged in the same way as any other complete take.
/// Takes that another program is still recording are not changed.
///
/// # Errors
/// Returns an error if the header of a part file is damaged, or if a recording cannot be written.
pub fn recover(folder: &Path) -> Result<Vec<TakeReport>, LabError> {
    let parts = files::part_files(folder).map_err(FileError::in_file(folder))?;
    let mut recovered = Vec::new();
    for path in &parts {
        match finish(folder, path) {
            Err(LabError::Busy { .. }) => {}
            take => recovered.extend(take?),
        }
    }
    Ok(recovered)
}
