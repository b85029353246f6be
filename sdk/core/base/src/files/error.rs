//! File errors that include the name of the file.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Error for a file that could not be read or written, or whose content cannot be used.
///
/// ```
/// use htex_base::files::{AtFile, FileError};
///
/// fn read(file: &std::path::Path) -> Result<String, FileError> {
///     std::fs::read_to_string(file).reading(file)
/// }
/// let error = read("absent.csv".as_ref()).unwrap_err();
/// assert!(error.to_string().starts_with("cannot read absent.csv: "));
/// let error = "a".parse::<f64>().map_err(FileError::in_file("gain.txt")).unwrap_err();
/// assert_eq!(error.to_string(), "gain.txt: invalid float literal");
/// ```
#[derive(Debug)]
pub struct FileError {
    /// The file or folder.
    pub file: PathBuf,
    pub problem: FileProblem,
}

/// What is wrong with a file.
#[derive(Debug)]
pub enum FileProblem {
    /// The file could not be read.
    Read(io::Error),
    /// The file could not be written.
    Write(io::Error),
    /// The content of the file cannot be used. The text states the problem, and what to do about
    /// it.
    Content(String),
}

impl FileError {
    /// Creates the error for a file that could not be read.
    pub fn reading(file: impl AsRef<Path>, error: impl Into<io::Error>) -> Self {
        Self::new(file, FileProblem::Read(error.into()))
    }

    /// Creates the error for a file that could not be written.
    pub fn writing(file: impl AsRef<Path>, error: impl Into<io::Error>) -> Self {
        Self::new(file, FileProblem::Write(error.into()))
    }

    /// Creates the error for a file with this problem in its content.
    pub fn content(file: impl AsRef<Path>, problem: impl fmt::Display) -> Self {
        Self::new(file, FileProblem::Content(problem.to_string()))
    }

    /// Adds the name of the file to an error about its content.
    pub fn in_file<E: fmt::Display>(file: impl AsRef<Path>) -> impl FnOnce(E) -> Self {
        move |problem| Self::content(file, problem)
    }

    fn new(file: impl AsRef<Path>, problem: FileProblem) -> Self {
        Self { file: file.as_ref().to_owned(), problem }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let file = self.file.display();
        match &self.problem {
            FileProblem::Read(error) => write!(f, "cannot read {file}: {error}"),
            FileProblem::Write(error) => write!(f, "cannot write {file}: {error}"),
            FileProblem::Content(problem) => write!(f, "{file}: {problem}"),
        }
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.problem {
            FileProblem::Read(error) | FileProblem::Write(error) => Some(error),
            FileProblem::Content(_) => None,
        }
    }
}

/// Converts an error of the system to an error that names the file.
pub trait AtFile<T> {
    /// Adds the name of the file to the error, and states that the program was reading the file.
    ///
    /// # Errors
    /// Returns the error with the name of the file, if the result is an error.
    fn reading(self, file: impl AsRef<Path>) -> Result<T, FileError>;

    /// Adds the name of the file to the error, and states that the program was writing the file.
    ///
    /// # Errors
    /// Returns the error with the name of the file, if the result is an error.
    fn writing(self, file: impl AsRef<Path>) -> Result<T, FileError>;
}

impl<T, E: Into<io::Error>> AtFile<T> for Result<T, E> {
    fn reading(self, file: impl AsRef<Path>) -> Result<T, FileError> {
        self.map_err(|error| FileError::reading(file, error))
    }

    fn writing(self, file: impl AsRef<Path>) -> Result<T, FileError> {
        self.map_err(|error| FileError::writing(file, error))
    }
}
