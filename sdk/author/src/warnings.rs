//! Warnings of several recordings: what is said of many of them is one sentence, with their names.

/// Sentences in the order in which they came, each with the recordings that it is about.
#[derive(Debug, Default)]
pub(crate) struct Warnings(Vec<Warning>);

#[derive(Debug)]
struct Warning {
    /// As it was first said.
    sentence: String,
    /// Without the recording's name in front.
    text: String,
    recordings: Vec<String>,
}

impl Warnings {
    /// Adds what is said of a recording.
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

    /// The sentences, each once.
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
