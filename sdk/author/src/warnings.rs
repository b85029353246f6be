//! Warnings of several recordings. Equal warnings become one sentence that names the recordings.

use htex_base::finding::Notice;

/// Warnings in the order in which they first occurred, each with its recordings.
#[derive(Debug, Default)]
pub(crate) struct Warnings(Vec<Warning>);

#[derive(Debug)]
struct Warning {
    /// The warning as it was first given.
    notice: Notice,
    /// The sentence without the recording's name.
    text: String,
    recordings: Vec<String>,
}

impl Warnings {
    pub(crate) fn add(&mut self, recording: &str, notices: Vec<Notice>) {
        let name = format!("{recording}: ");
        for notice in notices {
            let text = notice.text.strip_prefix(&name).unwrap_or(&notice.text);
            match self.0.iter_mut().find(|warning| warning.text == text) {
                Some(warning) => warning.recordings.push(recording.to_owned()),
                None => self.0.push(Warning {
                    text: text.to_owned(),
                    recordings: vec![recording.to_owned()],
                    notice,
                }),
            }
        }
    }

    /// Returns the warnings, each once.
    pub(crate) fn into_notices(self) -> Vec<Notice> {
        self.0.into_iter().map(Warning::into_notice).collect()
    }
}

impl Warning {
    fn into_notice(self) -> Notice {
        let Self { recordings, text, .. } = self;
        match recordings.len() {
            1 => self.notice,
            n => Notice {
                text: format!("{n} recordings ({}): {text}", recordings.join(", ")),
                ..self.notice
            },
        }
    }
}
