//! A test server, and access to it with short pauses.

use std::time::Duration;

use htex_base::storage::{Location, Settings, Storage, StorageError, Variables};
use htex_object_server::{ACCESS_KEY, SECRET_KEY, Server};

/// Largest size of a read, bytes.
pub const MOST: u64 = 64 << 20;

/// The defaults with six retries and pauses of milliseconds, so that a test with seven requests
/// does not take seconds.
pub fn settings() -> Settings {
    let mut settings = Settings::default();
    settings.total = Duration::from_secs(60);
    settings.stall = Duration::from_secs(20);
    settings.retries = 6;
    settings.first_pause = Duration::from_millis(1);
    settings.longest_pause = Duration::from_millis(5);
    settings
}

pub fn storage(server: &Server) -> Storage {
    Storage::new(settings(), server.variables().into_iter().collect())
}

/// Access with the server's variables, in which `over` replaces or adds some. An empty value
/// removes a variable.
pub fn storage_with(server: &Server, over: &[(&str, &str)]) -> Storage {
    let mut all = server.variables();
    all.retain(|(name, _)| over.iter().all(|(other, _)| other != name));
    let pairs = all.iter().map(|(name, value)| (*name, value.as_str()));
    let given = over.iter().copied().filter(|(_, value)| !value.is_empty());
    Storage::new(settings(), pairs.chain(given).collect::<Variables>())
}

pub fn at(uri: &str) -> Location {
    Location::parse(uri.as_ref()).unwrap()
}

/// Bytes in which no two stretches are equal.
pub fn bytes(len: usize) -> Vec<u8> {
    (0..len as u32).flat_map(|i| (i.wrapping_mul(2_654_435_761)).to_le_bytes()).take(len).collect()
}

/// Returns the message of an error, and checks that it contains no secret.
pub fn said<T: std::fmt::Debug>(result: Result<T, StorageError>) -> String {
    let error = result.unwrap_err();
    let (text, debug) = (error.to_string(), format!("{error:?}"));
    for secret in [SECRET_KEY, ACCESS_KEY, "Signature=", "AWS4-HMAC", "S3CR3T"] {
        assert!(!text.contains(secret), "{text}");
        assert!(!debug.contains(secret), "{debug}");
    }
    text
}
