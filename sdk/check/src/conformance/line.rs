//! The command line of a reader.

use std::process::Command;

use super::ConformanceError;

/// The command line of a reader, with placeholders for values that differ from file to file.
///
/// Words are separated by white space. Text between `'` or between `"` belongs to one word. There
/// are no other special characters, because no shell reads the line.
///
/// ```
/// use htex_check::conformance::CommandLine;
/// let line: CommandLine = "node 'my reader.js' {part} {file}".parse()?;
/// assert_eq!(line.words(), ["node", "my reader.js", "{part}", "{file}"]);
/// # Ok::<(), htex_check::conformance::ConformanceError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CommandLine {
    text: String,
    words: Vec<String>,
}

/// The texts that replace the placeholders in the line.
pub(super) struct Filled<'a> {
    pub(super) file: &'a str,
    pub(super) part: &'a str,
    pub(super) options: &'a str,
}

const FILE: &str = "{file}";
const PART: &str = "{part}";
const OPTIONS: &str = "{options}";

impl std::str::FromStr for CommandLine {
    type Err = ConformanceError;

    fn from_str(text: &str) -> Result<Self, ConformanceError> {
        let wrong = |problem: &str| ConformanceError::Command {
            command: text.to_owned(),
            problem: problem.to_owned(),
        };
        let words = split(text).ok_or_else(|| wrong("has a quotation mark that is not closed"))?;
        if words.is_empty() {
            return Err(wrong("is empty; give a program and its arguments"));
        }
        if !words.iter().skip(1).any(|word| word.contains(FILE)) {
            return Err(wrong("has no `{file}` among its arguments; write it where the file goes"));
        }
        Ok(Self { text: text.to_owned(), words })
    }
}

impl CommandLine {
    /// Returns the words, without their quotation marks.
    pub fn words(&self) -> &[String] {
        &self.words
    }

    /// Returns the original text of the line.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns whether the reader is told limits and arguments.
    pub(super) fn takes_options(&self) -> bool {
        self.words.iter().any(|word| word.contains(OPTIONS))
    }

    /// Returns the command for one file. Words are filled in after the line was split, so a path may
    /// contain spaces and quotation marks.
    pub(super) fn command(&self, filled: &Filled<'_>) -> Command {
        let mut words = self.words.iter().map(|word| fill(word, filled));
        let mut command = Command::new(words.next().unwrap_or_default());
        command.args(words);
        command
    }
}

/// Replaces the placeholders in one word from left to right. Placeholders inside a filled-in text
/// are not replaced.
fn fill(word: &str, filled: &Filled<'_>) -> String {
    let places = [(FILE, filled.file), (PART, filled.part), (OPTIONS, filled.options)];
    let (mut rest, mut text) = (word, String::new());
    while let Some(open) = rest.find('{') {
        let (before, from) = rest.split_at(open);
        text += before;
        match places.iter().find(|(place, _)| from.starts_with(place)) {
            Some((place, value)) => {
                text += value;
                rest = &from[place.len()..];
            }
            None => {
                text.push('{');
                rest = &from[1..];
            }
        }
    }
    text + rest
}

/// Splits a line into words; `None` if a quotation mark is not closed.
fn split(text: &str) -> Option<Vec<String>> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in text.chars() {
        match quote {
            Some(mark) if c == mark => quote = None,
            None if c == '\'' || c == '"' => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            None if c.is_whitespace() => words.extend(word.take()),
            _ => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    quote.is_none().then_some(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_split_and_filled_in_without_a_shell() {
        let line: CommandLine = "'a b' \"\" x{part}=\"{file}\" {a} {options}".parse().unwrap();
        let filled = Filled { file: "/my {part}/f 'x'", part: "assets", options: "{\"a\":1}" };
        let command = line.command(&filled);
        assert_eq!(command.get_program(), "a b");
        let arguments: Vec<_> = command.get_args().collect();
        assert_eq!(arguments, ["", "xassets=/my {part}/f 'x'", "{a}", "{\"a\":1}"]);
        let refused = ["", " ", "reader", "{file}", "reader '{file}"];
        for text in refused {
            assert!(text.parse::<CommandLine>().is_err(), "{text}");
        }
    }
}
