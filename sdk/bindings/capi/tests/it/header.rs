//! `include/htex.h` matches the functions, and its contents are frozen.

use std::path::Path;

use htex_c::HTEX_API_VERSION;

/// FNV-1a hash of the listing of each minor version of this major version, oldest first. New
/// versions only add lines.
const FROZEN: &[(&str, u64)] = &[
    ("1.0", 0x4a97_6c36_6e0f_de5e),
    ("1.1", 0x5681_b27e_73f0_2dd4),
    ("1.2", 0x3eb5_24ba_58cb_c09e),
];

const THAW: &str = "The interface of libhtex is frozen: programs were compiled against it. Take the change back; or, if it only \
    adds, raise the minor version in HTEX_API_VERSION, and add the new listing's version and hash to FROZEN.";

/// The header generated from the current functions.
fn header() -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).unwrap();
    let bindings = cbindgen::generate_with_config(folder, config).unwrap();
    let mut bytes = Vec::new();
    bindings.write(&mut bytes);
    String::from_utf8(bytes).unwrap()
}

#[test]
fn generated_header_is_fresh() {
    xtask::generated::file("sdk/bindings/capi/include/htex.h", header().as_bytes());
}

#[test]
fn generated_listing_is_frozen() {
    let (version, hash) = FROZEN.last().unwrap();
    let (major, minor) = (HTEX_API_VERSION >> 16, HTEX_API_VERSION & 0xffff);
    assert_eq!(*version, format!("{major}.{minor}"), "{THAW}");
    let now = listing(&header());
    assert_eq!(fnv(now.as_bytes()), *hash, "{THAW}");
    let path = format!("spec/abi/libhtex-{version}.txt");
    xtask::generated::file(&path, now.as_bytes());
    for (earlier, hash) in &FROZEN[..FROZEN.len() - 1] {
        let path = format!("../../../spec/abi/libhtex-{earlier}.txt");
        let kept = std::fs::read_to_string(path).unwrap();
        assert_eq!(fnv(kept.as_bytes()), *hash, "{THAW}");
        // The version itself is the only line that may change.
        let mut lines = kept.lines().filter(|line| !line.contains("HTEX_API_VERSION"));
        assert!(lines.all(|line| now.contains(line)), "{THAW}");
    }
}

/// The header, C# and the npm package have the same statuses as the Rust enumeration, and each
/// status has a text.
#[test]
fn all_tables_of_statuses_agree() {
    let header = header();
    let statuses = header.lines().filter_map(|line| {
        let (name, number) = line.trim().strip_prefix("HTEX_STATUS_")?.split_once(" = ")?;
        Some((name, number.trim_end_matches(',').parse::<i32>().ok()?))
    });
    let statuses: Vec<(&str, i32)> = statuses.collect();
    let numbers: Vec<i32> = statuses.iter().map(|(_, number)| *number).collect();
    assert_eq!(numbers, Vec::from_iter(0..statuses.len() as i32));
    let lower = |name: &str| name.to_ascii_lowercase();
    for (name, number) in &statuses {
        // SAFETY: a static text.
        let text = unsafe { std::ffi::CStr::from_ptr(htex_c::htex_status_text(*number)) };
        assert_ne!(text.to_str().unwrap(), "unknown status", "{name}");
    }

    let sharp = std::fs::read_to_string("unity/Runtime/Htex.cs").unwrap();
    let (_, sharp) = sharp.split_once("public enum Status").unwrap();
    let (sharp, _) = sharp.split_once('}').unwrap();
    let own = sharp.lines().filter_map(|line| line.trim().split_once(" = "));
    let own: Vec<(String, String)> =
        own.map(|(name, number)| (lower(name), number.trim_end_matches(',').to_owned())).collect();
    let wanted = statuses.iter();
    let wanted: Vec<(String, String)> =
        wanted.map(|(name, number)| (lower(&name.replace('_', "")), number.to_string())).collect();
    assert_eq!(own, wanted, "Htex.cs");

    let script = std::fs::read_to_string("../web/src/core.js").unwrap();
    let (_, script) = script.split_once("const STATUS = [").unwrap();
    let (script, _) = script.split_once(']').unwrap();
    let own = script.split(',').map(|name| name.trim().trim_matches('"'));
    let own: Vec<&str> = own.filter(|name| !name.is_empty()).collect();
    let wanted = statuses.iter();
    let wanted: Vec<String> = wanted.map(|(name, _)| lower(&name.replace('_', "-"))).collect();
    assert_eq!(own, wanted, "core.js");
}

/// The declarations, one per line, without comments.
fn listing(header: &str) -> String {
    let mut code = String::new();
    let mut rest = header;
    while let Some((before, comment)) = rest.split_once("/*") {
        code.push_str(before);
        rest = comment.split_once("*/").unwrap().1;
    }
    code.push_str(rest);
    let without = |line: &&str| {
        !(line.is_empty()
            || line.starts_with("//")
            || (line.starts_with('#') && !line.starts_with("#define HTEX_API")))
    };
    let lines = code.lines().map(str::trim).filter(without);
    let mut listing = String::new();
    for line in lines {
        let line = line.split("//").next().unwrap().trim_end();
        listing.push_str(line);
        // A declaration or a member ends here.
        let ends =
            line.ends_with([';', ',', '{', '}']) && !line.ends_with(",") || line.starts_with('#');
        listing.push(if ends || is_constant(line) { '\n' } else { ' ' });
    }
    listing
}

/// Whether this is a constant of an enumeration.
fn is_constant(line: &str) -> bool {
    line.starts_with("HTEX_") && line.ends_with(',')
}

fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
