//! Addresses of single textures in a library: `cloth.htexlib#woven/cotton`.

use crate::library::header::EXTENSION;

/// Splits a texture's address in a library into the library's address and the texture's name.
/// Returns `None` for any other address.
///
/// The library's address is a path or a URI. Its file name ends in `.htexlib`.
///
/// ```
/// use htex_format::library::split_address;
/// assert_eq!(split_address("cloth.htexlib#woven/cotton"), Some(("cloth.htexlib", "woven/cotton")));
/// assert_eq!(
///     split_address("https://example.org/cloth.htexlib?key=1#oak"),
///     Some(("https://example.org/cloth.htexlib?key=1", "oak"))
/// );
/// assert_eq!(split_address("cloth.htexlib"), None);
/// assert_eq!(split_address("cloth#1.htex"), None);
/// ```
#[must_use]
pub fn split_address(address: &str) -> Option<(&str, &str)> {
    let is_library = |library: &str| {
        let path = match library.split_once('?') {
            Some((path, _)) if path.contains("://") => path,
            _ => library,
        };
        let end = path.rsplit_once('.').map(|(_, extension)| extension);
        end.is_some_and(|extension| extension.eq_ignore_ascii_case(EXTENSION))
    };
    // A name may contain `#`, too.
    let mut marks = address.match_indices('#').map(|(at, _)| address.split_at(at));
    let (library, rest) = marks.find(|(library, _)| is_library(library))?;
    Some((library, &rest[1..]))
}
