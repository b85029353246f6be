//! The location of a file: a local path or a URI.

use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};

use percent_encoding::percent_decode_str;

use crate::storage::{StorageError, StorageProblem};

/// The known schemes, for messages.
const KNOWN: &str = "s3://, gs://, az://, https://, http:// and file://";

/// The location of a local or remote file.
///
/// A URL is displayed without its query, because the query may contain a signature.
///
/// ```
/// use htex_base::storage::Location;
///
/// let plain = Location::parse("surfaces/cloth.htex".as_ref())?;
/// assert!(plain.local().is_some());
/// let elsewhere = Location::parse("s3://surfaces/cloth.htex".as_ref())?;
/// assert_eq!(elsewhere.file_name(), Some("cloth.htex".to_owned()));
/// # Ok::<(), htex_base::storage::StorageError>(())
/// ```
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct Location(LocalOrRemote);

#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) enum LocalOrRemote {
    Local(PathBuf),
    Remote(Uri),
}

/// The location of a remote file.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(crate) struct Uri {
    pub(crate) scheme: Scheme,
    /// The bucket, the container, or the host with its port.
    pub(crate) authority: String,
    /// The key as written, or the path of a URL with its escapes. Without the slash at its start.
    pub(crate) path: String,
    /// Query of a URL; `None` for other URIs. It is never displayed.
    pub(crate) query: Option<String>,
}

/// The kind of store.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Scheme {
    S3,
    Gs,
    Az,
    Http,
    Https,
}

impl Location {
    /// Parses a location that the user gave as an argument: a path or a URI.
    ///
    /// In `s3://BUCKET/KEY`, `gs://BUCKET/KEY` and `az://CONTAINER/KEY`, the key is used exactly as
    /// written. `https://…` and `http://…` are URLs. `file:///PATH` may have escapes (`%20`). Any
    /// other argument is a local path, which is used unchanged, even if it is not Unicode.
    ///
    /// # Errors
    /// Returns an error if the argument is a URI that has another scheme, has a user name or
    /// password, is incomplete, or is not Unicode.
    pub fn parse(argument: &OsStr) -> Result<Self, StorageError> {
        let lossy = argument.to_string_lossy();
        let Some((scheme, rest)) = split_scheme(&lossy) else {
            return Ok(Self(LocalOrRemote::Local(argument.into())));
        };
        let wrong = |problem: &str| {
            let problem = problem.to_owned();
            StorageProblem::Uri { problem }.at_place(without_secrets(&lossy))
        };
        if argument.to_str().is_none() {
            return Err(wrong("a URI is Unicode text; write a path without a scheme"));
        }
        let scheme = match &*scheme.to_ascii_lowercase() {
            "file" => return Ok(Self(LocalOrRemote::Local(file_path(rest).map_err(&wrong)?))),
            "s3" => Scheme::S3,
            "gs" => Scheme::Gs,
            "az" => Scheme::Az,
            "http" => Scheme::Http,
            "https" => Scheme::Https,
            _ => {
                let problem = format!(
                    "its scheme is none of {KNOWN}; if it is a file of this machine, write ./ before it"
                );
                return Err(wrong(&problem));
            }
        };
        let uri = Uri::new(scheme, rest).map_err(wrong)?;
        Ok(Self(LocalOrRemote::Remote(uri)))
    }

    /// Returns the path of a local file; `None` for a remote file.
    pub fn local(&self) -> Option<&Path> {
        match &self.0 {
            LocalOrRemote::Local(path) => Some(path),
            LocalOrRemote::Remote(_) => None,
        }
    }

    /// Returns the last part of the path, with the escapes of a URL resolved. Programs use this
    /// part as the name of a local copy.
    pub fn file_name(&self) -> Option<String> {
        match &self.0 {
            LocalOrRemote::Local(path) => Some(path.file_name()?.to_string_lossy().into_owned()),
            LocalOrRemote::Remote(uri) => uri.file_name(),
        }
    }

    /// Returns the location of a file in this folder. `path` is relative to the folder, with `/`
    /// between the parts.
    #[must_use]
    pub fn inside(&self, path: &str) -> Self {
        match &self.0 {
            LocalOrRemote::Local(folder) => Self(LocalOrRemote::Local(folder.join(path))),
            LocalOrRemote::Remote(uri) if uri.path.is_empty() => self.with_key(path),
            LocalOrRemote::Remote(uri) => {
                self.with_key(&format!("{}/{path}", uri.path.trim_end_matches('/')))
            }
        }
    }

    /// Returns the same store with another key.
    pub(crate) fn with_key(&self, key: &str) -> Self {
        match &self.0 {
            LocalOrRemote::Local(path) => Self(LocalOrRemote::Local(path.join(key))),
            LocalOrRemote::Remote(uri) => {
                Self(LocalOrRemote::Remote(Uri { path: key.to_owned(), ..uri.clone() }))
            }
        }
    }

    /// Returns whether a URI is on the same server.
    pub(crate) fn is_same_server(&self, uri: &Uri) -> bool {
        match &self.0 {
            LocalOrRemote::Local(_) => false,
            LocalOrRemote::Remote(own) => {
                own.scheme == uri.scheme && own.authority.eq_ignore_ascii_case(&uri.authority)
            }
        }
    }

    pub(crate) fn place(&self) -> &LocalOrRemote {
        &self.0
    }
}

impl From<PathBuf> for Location {
    fn from(path: PathBuf) -> Self {
        Self(LocalOrRemote::Local(path))
    }
}

impl Uri {
    fn new(scheme: Scheme, rest: &str) -> Result<Self, &'static str> {
        let is_url = matches!(scheme, Scheme::Http | Scheme::Https);
        // The fragment of a URL is never sent. In a key, `#` and `?` are ordinary characters.
        let (rest, query) = match is_url.then(|| rest.split('#').next().unwrap_or(rest)) {
            Some(rest) => match rest.split_once('?') {
                Some((before, query)) => (before, Some(query.to_owned())),
                None => (rest, None),
            },
            None => (rest, None),
        };
        let (authority, path) = rest.split_once('/').unwrap_or((rest, ""));
        if authority.contains('@') {
            return Err(
                "it holds a user name or a password; credentials are read from the environment alone",
            );
        }
        if authority.is_empty() {
            return Err(if is_url {
                "the host is missing, as in https://HOST/PATH"
            } else {
                "the bucket is missing, as in s3://BUCKET/KEY"
            });
        }
        let is_bucket = |c: char| c.is_ascii_alphanumeric() || "-_.$".contains(c);
        if !is_url && !authority.chars().all(is_bucket) {
            return Err(
                "the bucket's name has other characters than letters, digits, `-`, `_` and `.`; correct it",
            );
        }
        Ok(Self { scheme, authority: authority.to_owned(), path: path.to_owned(), query })
    }

    /// Returns the key of a folder, without a slash at its end.
    pub(crate) fn without_last_slash(&self) -> Self {
        Self { path: self.path.trim_end_matches('/').to_owned(), ..self.clone() }
    }

    fn file_name(&self) -> Option<String> {
        let last = self.path.rsplit('/').next().filter(|name| !name.is_empty())?;
        let name = match self.scheme {
            Scheme::Http | Scheme::Https => {
                percent_decode_str(last).decode_utf8_lossy().into_owned()
            }
            _ => last.to_owned(),
        };
        // Resolved escapes must not lead to another folder.
        let is_safe = |c: char| !matches!(c, '/' | '\\' | ':' | '\0');
        let is_name = name.chars().all(is_safe) && name != "." && name != "..";
        is_name.then_some(name)
    }
}

impl Scheme {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::S3 => "s3",
            Self::Gs => "gs",
            Self::Az => "az",
            Self::Http => "http",
            Self::Https => "https",
        }
    }

    pub(crate) fn is_read_only(self) -> bool {
        matches!(self, Self::Http | Self::Https)
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            LocalOrRemote::Local(path) => path.display().fmt(f),
            LocalOrRemote::Remote(uri) => uri.fmt(f),
        }
    }
}

impl fmt::Display for Uri {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let query = if self.query.is_some() { "?…" } else { "" };
        let (scheme, authority, path) = (self.scheme.name(), &self.authority, &self.path);
        write!(f, "{scheme}://{authority}/{path}{query}")
    }
}

impl fmt::Debug for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

impl fmt::Debug for Uri {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self}")
    }
}

/// Splits `scheme://rest`. A single letter before `://` is not a scheme but a Windows drive.
fn split_scheme(text: &str) -> Option<(&str, &str)> {
    let (scheme, rest) = text.split_once("://")?;
    let is_scheme = scheme.len() > 1
        && scheme.starts_with(|c: char| c.is_ascii_alphabetic())
        && scheme.chars().all(|c| c.is_ascii_alphanumeric() || "+-.".contains(c));
    is_scheme.then_some((scheme, rest))
}

/// Returns the local path of `file://…`, with its escapes resolved.
fn file_path(rest: &str) -> Result<PathBuf, &'static str> {
    let (host, _) = rest.split_once('/').unwrap_or((rest, ""));
    if !host.is_empty() && host != "localhost" {
        return Err("a file of this machine has three slashes, as in file:///home/a/cloth.htex");
    }
    let bytes: Vec<u8> = percent_decode_str(&rest[host.len()..]).collect();
    if bytes.is_empty() || bytes.contains(&0) {
        return Err("the path is missing, or has a NUL character");
    }
    os_path(bytes)
}

#[cfg(unix)]
fn os_path(bytes: Vec<u8>) -> Result<PathBuf, &'static str> {
    use std::os::unix::ffi::OsStringExt;
    Ok(std::ffi::OsString::from_vec(bytes).into())
}

#[cfg(not(unix))]
fn os_path(bytes: Vec<u8>) -> Result<PathBuf, &'static str> {
    let text = String::from_utf8(bytes).map_err(|_| "the path is not Unicode")?;
    // file:///C:/cloth.htex
    let has_drive = text.as_bytes().get(2) == Some(&b':');
    Ok(if has_drive { &text[1..] } else { &text[..] }.into())
}

/// Returns a URI for a message about a malformed URI. It omits the part before an `@`, and the
/// query.
fn without_secrets(text: &str) -> String {
    let Some((scheme, rest)) = split_scheme(text) else {
        return text.to_owned();
    };
    // The query may hold a signature, and what stands before an `@` may be a password.
    let (rest, query) = match rest.split_once('?') {
        Some((before, _)) => (before, "?…"),
        None => (rest, ""),
    };
    let (authority, path) = match rest.split_once('/') {
        Some((authority, path)) => (authority, format!("/{path}")),
        None => (rest, String::new()),
    };
    let host = match authority.rsplit_once('@') {
        Some((_, host)) => format!("…@{host}"),
        None => authority.to_owned(),
    };
    format!("{scheme}://{host}{path}{query}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Location {
        Location::parse(text.as_ref()).unwrap()
    }

    #[test]
    fn paths_stay_as_they_are() {
        for text in ["cloth.htex", "/a/b c.csv", "C:\\a.csv", "C://a.csv", "s3:a", "-", "a%20b", ""]
        {
            assert_eq!(parsed(text).local(), Some(Path::new(text)));
            assert_eq!(parsed(text).to_string(), text);
        }
        assert_eq!(parsed("file:///a%20b.csv").local(), Some(Path::new("/a b.csv")));
        assert_eq!(parsed("FILE://localhost/a").local(), Some(Path::new("/a")));
    }

    #[cfg(unix)]
    #[test]
    fn names_need_not_be_unicode() {
        use std::os::unix::ffi::OsStrExt;
        let name = OsStr::from_bytes(b"clo\xfft\x80.csv");
        let location = Location::parse(name).unwrap();
        assert_eq!(location.local(), Some(Path::new(name)));
        assert_eq!(parsed("file:///clo%FFt").local().unwrap().as_os_str().as_bytes(), b"/clo\xfft");
        assert!(Location::parse(OsStr::from_bytes(b"s3://b/clo\xff")).is_err());
    }

    #[test]
    fn keys_are_literal_and_queries_are_not_shown() {
        let key = parsed("s3://bucket/a b/%20?c#d.csv");
        let LocalOrRemote::Remote(uri) = key.place() else { panic!() };
        assert_eq!((&*uri.authority, &*uri.path), ("bucket", "a b/%20?c#d.csv"));
        assert_eq!(key.file_name().as_deref(), Some("%20?c#d.csv"));
        let url = parsed("https://host:8/a%20b.csv?sig=SECRET#part");
        assert_eq!(url.to_string(), "https://host:8/a%20b.csv?…");
        assert_eq!(format!("{url:?}"), url.to_string());
        assert_eq!(url.file_name().as_deref(), Some("a b.csv"));
        for hidden in
            ["https://h/..%2fetc", "https://h/%2e%2e", "s3://b/a/", "https://h", "s3://b/a/.."]
        {
            assert_eq!(parsed(hidden).file_name(), None, "{hidden}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_without_secrets() {
        for (text, words) in [
            ("https://me:SECRET@host/a?sig=SECRET", "password"),
            ("ftp://me:SECRET@host/a", "its scheme"),
            ("s3:///key", "bucket"),
            ("https:///key", "host"),
            ("file://server/a", "three slashes"),
        ] {
            let error = Location::parse(text.as_ref()).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
            assert!(!error.contains("SECRET"), "{error}");
        }
    }
}
