//! Descriptors of plugins that can be read without running the plugin.
//!
//! A WASM module carries its descriptor in a custom section, [`SECTION`]. A native library, or a
//! module without this section, has a file beside it that contains the descriptor and the hash of
//! the plugin.

use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::files::read_regular;

/// Name of the custom section of a WASM module.
pub const SECTION: &str = "htex.descriptor";
/// The largest plugin that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;
/// The largest description, bytes: twice the largest descriptor.
const MOST_DESCRIPTION_BYTES: u64 = 1 << 21;
/// The first eight bytes of a module of the binary format 1.
const MODULE_START: &[u8] = b"\0asm\x01\0\0\0";

/// The content of `PLUGIN.descriptor.json`.
#[derive(Serialize, Deserialize)]
struct Description {
    htex_descriptor: String,
    /// BLAKE3 of the plugin, in hexadecimal digits.
    blake3: String,
    descriptor: Value,
}

/// Returns the path of the description beside a plugin.
pub fn description_path(plugin: &Path) -> PathBuf {
    let mut path = plugin.as_os_str().to_owned();
    path.push(".descriptor.json");
    path.into()
}

/// Returns the text of a plugin's description file, with this descriptor and the hash of the
/// plugin's bytes.
///
/// # Errors
/// Returns an error if the descriptor is not JSON.
pub fn description(plugin: &[u8], descriptor: &str) -> Result<String, serde_json::Error> {
    let description = Description {
        htex_descriptor: "1.0".to_owned(),
        blake3: blake3::hash(plugin).to_hex().to_string(),
        descriptor: serde_json::from_str(descriptor)?,
    };
    Ok(serde_json::to_string_pretty(&description)? + "\n")
}

/// Returns the descriptor of a plugin as JSON, without running the plugin. Returns `None` if the
/// plugin has no stored descriptor, or if the hash in the description file beside the plugin does
/// not match the plugin's bytes.
///
/// # Errors
/// Errors of the system.
pub fn read_descriptor(plugin: &Path) -> io::Result<Option<String>> {
    let bytes = read_regular(plugin, MOST_BYTES)?;
    if let Some(section) = section(&bytes) {
        return Ok(Some(String::from_utf8_lossy(section).into_owned()));
    }
    let description = match read_regular(&description_path(plugin), MOST_DESCRIPTION_BYTES) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        read => read?,
    };
    let described = serde_json::from_slice::<Description>(&description).ok();
    let own = described.filter(|d| d.blake3 == blake3::hash(&bytes).to_hex().as_str());
    Ok(own.map(|description| description.descriptor.to_string()))
}

/// Returns the content of a module's descriptor section.
pub fn section(module: &[u8]) -> Option<&[u8]> {
    sections(module).find_map(|section| section.descriptor)
}

/// Returns a copy of the module with this descriptor in its descriptor section, in place of any
/// earlier descriptor; `None` if the bytes are not a module.
pub fn with_section(module: &[u8], descriptor: &str) -> Option<Vec<u8>> {
    let mut all = module.get(..MODULE_START.len())?.to_vec();
    let mut read = all.len();
    for section in sections(module) {
        read += section.bytes.len();
        if section.descriptor.is_none() {
            all.extend(section.bytes);
        }
    }
    // The remaining bytes are the beginning of a section that is cut off.
    if read != module.len() {
        return None;
    }
    let mut content = Vec::new();
    put(&mut content, SECTION.len());
    content.extend(SECTION.as_bytes());
    content.extend(descriptor.as_bytes());
    all.push(0);
    put(&mut all, content.len());
    all.extend(content);
    Some(all)
}

/// A section of a module.
struct Section<'a> {
    /// The section with its head.
    bytes: &'a [u8],
    /// The content of the section with the descriptor, without its name.
    descriptor: Option<&'a [u8]>,
}

/// Returns the sections of a module up to the first that is cut off.
fn sections(module: &[u8]) -> impl Iterator<Item = Section<'_>> {
    let mut rest = module.strip_prefix(MODULE_START).unwrap_or_default();
    std::iter::from_fn(move || {
        let start = rest;
        let (&id, after) = rest.split_first()?;
        let (len, after) = number(after)?;
        let (content, after) = after.split_at_checked(len)?;
        rest = after;
        let bytes = &start[..start.len() - after.len()];
        let descriptor = (id == 0).then(|| named(content)).flatten();
        Some(Section { bytes, descriptor })
    })
}

/// If this is the content of the custom section with the descriptor, returns the bytes after the
/// section's name.
fn named(content: &[u8]) -> Option<&[u8]> {
    let (len, content) = number(content)?;
    let (name, content) = content.split_at_checked(len)?;
    (name == SECTION.as_bytes()).then_some(content)
}

/// Reads an unsigned LEB128 number of at most 32 bits, and returns what follows it.
fn number(bytes: &[u8]) -> Option<(usize, &[u8])> {
    let mut value = 0_u64;
    for (i, &byte) in bytes.iter().take(5).enumerate() {
        value |= u64::from(byte & 0x7f) << (7 * i);
        if byte & 0x80 == 0 {
            return Some((usize::try_from(value).ok()?, &bytes[i + 1..]));
        }
    }
    None
}

fn put(out: &mut Vec<u8>, mut value: usize) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_module_carries_one_descriptor_and_stays_the_same_otherwise() {
        let bare = MODULE_START;
        assert_eq!(section(bare), None);
        let long = "x".repeat(300);
        let first = with_section(bare, &long).unwrap();
        assert_eq!(section(&first), Some(long.as_bytes()));
        let second = with_section(&first, "{}").unwrap();
        assert_eq!(section(&second), Some(&b"{}"[..]));
        assert_eq!(second.len(), bare.len() + 1 + 1 + 1 + SECTION.len() + 2);
        for cut in 0..second.len() {
            let part = &second[..cut];
            assert_eq!(section(part), None, "{cut}");
            assert_eq!(with_section(part, "{}").is_some(), cut == bare.len(), "{cut}");
        }
    }

    #[test]
    fn a_description_of_other_bytes_is_not_believed() {
        let folder = tempfile::tempdir().unwrap();
        let library = folder.path().join("a.so");
        std::fs::write(&library, b"one").unwrap();
        assert_eq!(read_descriptor(&library).unwrap(), None);
        let text = description(b"one", r#"{"id":"x"}"#).unwrap();
        std::fs::write(description_path(&library), text).unwrap();
        assert_eq!(read_descriptor(&library).unwrap().as_deref(), Some(r#"{"id":"x"}"#));
        std::fs::write(&library, b"two").unwrap();
        assert_eq!(read_descriptor(&library).unwrap(), None);
    }
}
