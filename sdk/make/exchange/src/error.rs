//! Errors of import and export. Each error message says what is wrong, where in the file, and what
//! to do.

use htex_author::AuthorError;

/// A fault in a file: what is wrong, and where.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}{problem}", place_of(.place))]
pub struct Fault {
    /// The place of the fault: a JSON pointer (RFC 6901), or a text such as `line 3 column 7`.
    /// Empty if the fault concerns the whole file.
    pub place: String,
    /// What is wrong at this place, and what to do.
    pub problem: String,
}

fn place_of(place: &str) -> String {
    if place.is_empty() { String::new() } else { format!("{place}: ") }
}

/// Longest text of a place or a problem, characters. Both are limited because they may quote the
/// file.
const MOST_QUOTED: usize = 500;

/// Makes a text that may quote a file safe to print. Keeps its beginning, joins its lines, and
/// removes characters that control a terminal.
fn quoted(text: &str) -> String {
    let mut shown: String = text.chars().take(MOST_QUOTED).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    htex_base::finding::plain(&shown).into_owned()
}

impl Fault {
    pub(crate) fn new(place: impl AsRef<str>, problem: impl AsRef<str>) -> Self {
        Self { place: quoted(place.as_ref()), problem: quoted(problem.as_ref()) }
    }

    /// Makes a fault that concerns the whole file.
    pub(crate) fn whole(problem: impl AsRef<str>) -> Self {
        Self::new("", problem)
    }
}

/// An error of an import or an export.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// No format that can be imported uses this file extension.
    #[error("{file}: no format that is read has this extension; there are {there}")]
    UnknownFormat {
        file: String,
        /// The formats that can be imported, with their extensions.
        there: String,
    },
    /// The file is not valid in its format.
    #[error("{file}: {fault}")]
    File { file: String, fault: Fault },
    /// An asset needs a value that files of this format do not contain, and the user did not give
    /// this value.
    #[error("{}", not_said(.format, .missing, &keyword))]
    Missing { format: &'static str, missing: Vec<Missing> },
    /// The user gave a setting that does not apply to this format.
    #[error("{}", unused(.format, .way, .setting, .takes, &keyword))]
    Unused {
        format: &'static str,
        /// `import`, `export`, `export along a stroke` or `export of a scene`.
        way: &'static str,
        /// The setting as a keyword, such as `full_scale`.
        setting: String,
        /// The settings that the format accepts.
        takes: Vec<&'static str>,
    },
    /// The user gave a number that is out of range.
    #[error("{name} {value}: {range}")]
    OutOfRange {
        /// The setting as a keyword, such as `full_scale`.
        name: &'static str,
        value: f64,
        range: &'static str,
    },
    /// The file, the asset inside the file and the `.license` file next to the file state different
    /// licences or authors.
    #[error("{}", disagree(.setting, .stated, &keyword))]
    Rights {
        /// `license` or `author`.
        setting: &'static str,
        /// What each of these files states.
        stated: String,
    },
    /// No actuator profile, format or coding has this name.
    #[error("there is no {what} `{wanted}`; there are {there}")]
    UnknownName {
        /// `profile`, `format` or `coding`.
        what: &'static str,
        wanted: String,
        there: String,
    },
    /// The actuator cannot play files of this format.
    #[error(
        "{profile} is a motor whose frequency follows its level, and {format} holds samples; choose {instead}"
    )]
    NoSamples {
        profile: String,
        format: &'static str,
        /// Formats that the actuator can play.
        instead: String,
    },
    /// The format cannot store this texture.
    #[error("{format}: {problem}")]
    Cannot { format: &'static str, problem: String },
    /// The asset cannot be played.
    #[error(transparent)]
    Play(#[from] htex_play::Error),
    /// The scene cannot be played.
    #[error("{problem}")]
    Scene { problem: String },
    /// The signal is not a valid recording, a setting of the fit cannot be used, no model could be
    /// fitted to the signal, or the asset cannot be written.
    #[error(transparent)]
    Author(#[from] AuthorError),
}

/// A value that the user must give, because files of a format do not contain it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct Missing {
    /// Keyword of the setting with which the user gives the value, such as `full_scale`.
    pub setting: &'static str,
    /// Description of the value for use in messages, as a phrase.
    pub words: &'static str,
}

impl ExchangeError {
    /// Returns the message, with each setting named as in the calling program. `named` converts a
    /// keyword such as `full_scale` to the name in this program.
    ///
    /// ```
    /// use htex_exchange::{Format, Physical};
    /// let error = Physical::default().check(Format::of_file("tap.ahap")?).unwrap_err();
    /// let told = error.message_with(&|setting| format!("--{}", setting.replace('_', "-")));
    /// assert!(told.ends_with("give --full-scale, --speed and --force"));
    /// # Ok::<(), htex_exchange::ExchangeError>(())
    /// ```
    #[must_use]
    pub fn message_with(&self, named: &dyn Fn(&str) -> String) -> String {
        match self {
            Self::Missing { format, missing } => not_said(format, missing, named),
            Self::Unused { format, way, setting, takes } => {
                unused(format, way, setting, takes, named)
            }
            Self::OutOfRange { name, value, range } => format!("{} {value}: {range}", named(name)),
            Self::Rights { setting, stated } => disagree(setting, stated, named),
            other => other.to_string(),
        }
    }
}

fn disagree(setting: &str, stated: &str, named: &dyn Fn(&str) -> String) -> String {
    format!(
        "the {setting} is stated as {stated}, in the file, its asset or its .license file; give {}",
        named(setting)
    )
}

fn keyword(setting: &str) -> String {
    format!("`{setting}`")
}

fn not_said(format: &str, missing: &[Missing], named: &dyn Fn(&str) -> String) -> String {
    let words = list(missing.iter().map(|m| m.words.to_owned()));
    let settings = list(missing.iter().map(|m| named(m.setting)));
    format!("{format} does not say {words}; give {settings}")
}

fn unused(
    format: &str,
    way: &str,
    setting: &str,
    takes: &[&'static str],
    named: &dyn Fn(&str) -> String,
) -> String {
    let taken = if takes.is_empty() {
        String::new()
    } else {
        format!(" (it takes {})", list(takes.iter().map(|setting| named(setting))))
    };
    let setting = named(setting);
    format!("{format}: its {way} takes no {setting}; leave it out{taken}")
}

/// Makes the error for an unknown name. `there` are the names that exist.
pub(crate) fn unknown_name<'a>(
    what: &'static str,
    wanted: &str,
    there: impl IntoIterator<Item = &'a str>,
) -> ExchangeError {
    let there = list(there.into_iter().map(str::to_owned));
    ExchangeError::UnknownName { what, wanted: quoted(wanted), there }
}

/// Joins parts as `a, b and c`.
pub(crate) fn list(parts: impl Iterator<Item = String>) -> String {
    let parts: Vec<String> = parts.collect();
    match &parts[..] {
        [before @ .., last] if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        parts => parts.concat(),
    }
}

/// Returns a function that adds the file's name to a fault.
pub(crate) fn in_file(file: &str) -> impl Fn(Fault) -> ExchangeError + '_ {
    move |fault| ExchangeError::File { file: file.to_owned(), fault }
}
