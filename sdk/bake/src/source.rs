//! Blocks as source code.

use std::fmt::Write;

/// Bytes in a line.
const IN_LINE: usize = 16;

/// Returns a C header that defines a block as an array of bytes named after `stem`.
///
/// ```
/// let text = htex_bake::c_header("my-texture", &[1, 2]);
/// assert!(text.contains("static const uint8_t my_texture[2] = {"));
/// ```
pub fn c_header(stem: &str, bytes: &[u8]) -> String {
    let name = identifier(stem);
    let guard = name.to_ascii_uppercase();
    let lines = lines(bytes);
    format!(
        "/* A baked texture for htex_player.h (spec/baked-1.md). */\n#ifndef {guard}_BAKED_H\n#define {guard}_BAKED_H\n\n\
         #include <stdint.h>\n\nstatic const uint8_t {name}[{}] = {{\n{lines}}};\n\n#endif\n",
        bytes.len()
    )
}

/// Returns Rust source that defines a block as an array of bytes named after `stem`.
///
/// ```
/// let text = htex_bake::rust_source("my-texture", &[1, 2]);
/// assert!(text.contains("pub static MY_TEXTURE: [u8; 2] = ["));
/// ```
pub fn rust_source(stem: &str, bytes: &[u8]) -> String {
    let name = identifier(stem).to_ascii_uppercase();
    let lines = lines(bytes);
    format!(
        "/// A baked texture for the crate `htex-player` (spec/baked-1.md).\n#[rustfmt::skip]\n\
         pub static {name}: [u8; {}] = [\n{lines}];\n",
        bytes.len()
    )
}

fn lines(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(5 * bytes.len());
    for line in bytes.chunks(IN_LINE) {
        text.push_str("   ");
        for byte in line {
            let _ = write!(text, " {byte},");
        }
        text.push('\n');
    }
    text
}

/// Returns an identifier of C and Rust: other characters become underscores. The prefix keeps digits from being first, and
/// the name from being a keyword.
fn identifier(stem: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = stem.chars().map(plain).collect();
    let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.contains('_');
    match is_word {
        true => name,
        false => format!("texture_{name}"),
    }
}
