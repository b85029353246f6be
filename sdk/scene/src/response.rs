//! The response of finger and display, which a scene may compensate.

use std::path::Path;

use htex_author::read::ReadError;
use htex_author::response::read_response;

pub use htex_author::SetupResponse as Response;

/// Reads a response from a CSV with the columns `frequency_hz` and `magnitude`: output over input,
/// in any unit, since only its shape is compensated.
///
/// # Errors
/// As [`read_response`]; and when no magnitude is above 0.
pub fn open(path: &Path) -> Result<Response, ReadError> {
    let response = read_response(path)?;
    if response.magnitude.iter().all(|m| *m == 0.0) {
        let file = path.file_name().unwrap_or(path.as_os_str());
        return Err(ReadError::Option {
            file: file.to_string_lossy().into_owned(),
            problem: "every magnitude is 0, and nothing can make up for that; measure anew".into(),
        });
    }
    Ok(response)
}
