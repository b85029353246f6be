//! File errors that include the name of the file.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Error for a file that could not be read or written.
///
/// ```
/// use htex_base::files::{AtFile, FileError};
///
/// fn read(file: &std::path::Path) -> Result<String, FileError> {
///     std::fs::read_to_string(file).reading(file)
/// }
/// let error = read("absent.csv".as_ref()).unwrap_err();
/// assert!(error.to_string().starts_with("cannot read absent.csv: "));
/// ```
#[derive(Debug)]
pub struct FileError {
    /// The file or folder.
    pub file: PathBuf,
    /// Whether the program was writing the file. If false, it was reading the file.
    pub is_output: bool,
    pub error: io::Error,
}

impl FileError {
    /// Creates the error for a file that could not be read.
    pub fn reading(file: impl AsRef<Path>, error: impl Into<io::Error>) -> Self {
        Self::new(file.as_ref(), false, error.into())
    }

    /// Creates the error for a file that could not be written.
    pub fn writing(file: impl AsRef<Path>, error: impl Into<io::Error>) -> Self {
        Self::new(file.as_ref(), true, error.into())
    }

    fn new(file: &Path, is_output: bool, error: io::Error) -> Self {
        let file = file.to_owned();
        Self { file, is_output, error }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verb = if self.is_output { "write" } else { "read" };
        write!(f, "cannot {verb} {}: {}", self.file.display(), self.error)
    }
}

impl std::error::Error for FileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.error)
    }
}

/// Error for a file whose content cannot be used.
///
/// ```
/// use htex_base::files::ContentError;
///
/// let error = "a".parse::<f64>().map_err(ContentError::in_file("gain.txt")).unwrap_err();
/// assert_eq!(error.to_string(), "gain.txt: invalid float literal");
/// ```
#[derive(Debug)]
pub struct ContentError {
    /// The file or folder.
    pub file: PathBuf,
    /// The problem, and what to do about it.
    pub problem: String,
}

impl ContentError {
    /// Creates the error for a file with this problem.
    pub fn new(file: impl AsRef<Path>, problem: impl fmt::Display) -> Self {
        Self { file: file.as_ref().to_owned(), problem: problem.to_string() }
    }

    /// Converts an error about the content of a file to an error that names the file.
    pub fn in_file<E: fmt::Display>(file: impl AsRef<Path>) -> impl FnOnce(E) -> Self {
        move |problem| Self::new(file, problem)
    }
}

impl fmt::Display for ContentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file.display(), self.problem)
    }
}

impl std::error::Error for ContentError {}

/// Converts an error of the system to an error that names the file.
pub trait AtFile<T> {
    /// Names the file, and says that the program was reading it.
    ///
    /// # Errors
    /// If the result is an error.
    fn reading(self, file: impl AsRef<Path>) -> Result<T, FileError>;

    /// Names the file, and says that the program was writing it.
    ///
    /// # Errors
    /// If the result is an error.
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
