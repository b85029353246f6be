//! Creates the header of a session, which states what its answers belong to.

use std::collections::BTreeMap;
use std::path::Path;

use htex_base::files::AtFile;

use crate::study::Study;
use crate::study::error::StudyError;
use crate::study::lines::{DeviceUsed, Header, Simulated, SourceUsed, VERSION};
use crate::study::plan::ParticipantPlan;
use crate::study::read::files_of;

impl Header {
    /// Creates the header of a participant's session. `path` is the study's file. The contents of
    /// this file and of all files that it names are hashed.
    ///
    /// # Errors
    /// [`StudyError::File`] if one of the files cannot be read.
    pub fn new(
        study: &Study,
        path: &Path,
        plan: &ParticipantPlan,
        device: DeviceUsed,
        tool: String,
    ) -> Result<Self, StudyError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut files = BTreeMap::from([("study".to_owned(), hash(path)?)]);
        for file in files_of(study) {
            let name = format!("file {}", file.display());
            files.insert(name, hash(&folder.join(&file))?);
        }
        Ok(Self {
            htex_answers: VERSION.to_owned(),
            study: study.name.clone(),
            participant: plan.participant.clone(),
            files,
            device,
            begun: None,
            ratings: plan.trials.len() * study.attributes.len(),
            source: None,
            tool,
            simulated: None,
        })
    }

    /// Adds the date and time at which the file was begun.
    #[must_use]
    pub fn with_begun(mut self, date: Option<String>) -> Self {
        self.begun = date;
        self
    }

    /// Adds a source of felt forces.
    #[must_use]
    pub fn with_source(mut self, source: Option<SourceUsed>) -> Self {
        self.source = source;
        self
    }

    /// Marks the participant as simulated.
    #[must_use]
    pub fn with_simulated(mut self, simulated: Option<Simulated>) -> Self {
        self.simulated = simulated;
        self
    }
}

fn hash(file: &Path) -> Result<String, StudyError> {
    let bytes = std::fs::read(file).reading(file)?;
    Ok(blake3::hash(&bytes).to_hex().to_string())
}
