//! Warnings of several recordings: equal warnings become one sentence with the recordings' names.

/// Warnings in the order of their first occurrence, each with its recordings.
#[derive(Debug, Default)]
pub(crate) struct Warnings(Vec<Warning>);

#[derive(Debug)]
struct Warning {
    /// The sentence as first given.
    sentence: String,
    /// The sentence without the recording's name.
    text: String,
    recordings: Vec<String>,
}

impl Warnings {
    /// Adds the warnings of a recording.
    pub(crate) fn add(&mut self, recording: &str, sentences: Vec<String>) {
        let name = format!("{recording}: ");
        for sentence in sentences {
            let text = sentence.strip_prefix(&name).unwrap_or(&sentence);
            match self.0.iter_mut().find(|warning| warning.text == text) {
                Some(warning) => warning.recordings.push(recording.to_owned()),
                None => self.0.push(Warning {
                    text: text.to_owned(),
                    recordings: vec![recording.to_owned()],
                    sentence,
                }),
            }
        }
    }

    /// Returns the sentences, each once.
    pub(crate) fn into_sentences(self) -> Vec<String> {
        self.0.into_iter().map(Warning::into_sentence).collect()
    }
}

impl Warning {
    fn into_sentence(self) -> String {
        match self.recordings.len() {
            1 => self.sentence,
            n => format!(
                "{n} recordings ({}): {}",
                self.recordings.join(", "),
                self.text
            ),
        }
    }
}
