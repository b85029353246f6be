//! Writes blocks as source code in C and Rust.

use std::fmt::Write;

use crate::bake::BakeResult;

/// Number of bytes per line.
const IN_LINE: usize = 16;

/// Prefix of names that would otherwise begin with a digit or be a reserved word.
const PREFIX: &str = "texture_";

/// Reserved words, which an array in C or C++ cannot have as its name.
const RESERVED: &[&str] = &[
    "alignas",
    "alignof",
    "and",
    "and_eq",
    "asm",
    "auto",
    "bitand",
    "bitor",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "char16_t",
    "char32_t",
    "char8_t",
    "class",
    "co_await",
    "co_return",
    "co_yield",
    "compl",
    "concept",
    "const",
    "const_cast",
    "consteval",
    "constexpr",
    "constinit",
    "continue",
    "decltype",
    "default",
    "delete",
    "do",
    "double",
    "dynamic_cast",
    "else",
    "enum",
    "explicit",
    "export",
    "extern",
    "false",
    "float",
    "for",
    "friend",
    "goto",
    "if",
    "inline",
    "int",
    "long",
    "mutable",
    "namespace",
    "new",
    "noexcept",
    "not",
    "not_eq",
    "nullptr",
    "operator",
    "or",
    "or_eq",
    "private",
    "protected",
    "public",
    "register",
    "reinterpret_cast",
    "requires",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "static",
    "static_assert",
    "static_cast",
    "struct",
    "switch",
    "template",
    "this",
    "thread_local",
    "throw",
    "true",
    "try",
    "typedef",
    "typeid",
    "typename",
    "typeof",
    "typeof_unqual",
    "union",
    "unsigned",
    "using",
    "virtual",
    "void",
    "volatile",
    "wchar_t",
    "while",
    "xor",
    "xor_eq",
];

/// Converts the stem of a file name to a valid name of an array in C and C++ ([`is_c_name`]).
/// Characters that are not allowed become underscores, but never two underscores in a row.
///
/// ```
/// assert_eq!(htex_play::bake::c_name("my--texture"), "my_texture");
/// assert_eq!(htex_play::bake::c_name("cloth"), "texture_cloth");
/// assert_eq!(htex_play::bake::c_name("static-assert"), "texture_static_assert");
/// ```
pub fn c_name(stem: &str) -> String {
    let name = identifier(stem);
    if is_c_name(&name) { name } else { format!("{PREFIX}{name}") }
}

/// Converts the stem of a file name to the name of a constant in Rust.
///
/// ```
/// assert_eq!(htex_play::bake::rust_name("my-texture"), "MY_TEXTURE");
/// ```
pub fn rust_name(stem: &str) -> String {
    identifier(stem).to_ascii_uppercase()
}

/// Returns whether an array in C and C++ may have this name. A valid name is a letter, followed by
/// letters, digits and single underscores. A reserved word, such as a keyword, is not a valid name.
///
/// ```
/// assert!(htex_play::bake::is_c_name("felt2"));
/// assert!(!htex_play::bake::is_c_name("2felt") && !htex_play::bake::is_c_name("float") && !htex_play::bake::is_c_name("_x"));
/// ```
pub fn is_c_name(name: &str) -> bool {
    let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
    name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(is_word)
        && !name.contains("__")
        && !RESERVED.contains(&name)
        && !is_integer_type(name)
}

/// Whether `stdint.h`, which the header includes, may define a type of this name.
fn is_integer_type(name: &str) -> bool {
    let name = name.strip_prefix('u').unwrap_or(name);
    name.starts_with("int") && name.ends_with("_t")
}

/// Returns whether a constant in Rust may have this name: a capital letter, then capital letters,
/// digits and underscores.
///
/// ```
/// assert!(htex_play::bake::is_rust_name("FELT_2"));
/// assert!(!htex_play::bake::is_rust_name("felt"));
/// ```
pub fn is_rust_name(name: &str) -> bool {
    let is_capital = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
    name.starts_with(|c: char| c.is_ascii_uppercase()) && name.chars().all(is_capital)
}

/// Returns a C header that defines a block as an array of bytes with this name. The header also
/// defines a macro for `HTEX_PLAYER_MEMORY`: how many numbers the memory of a player for this block
/// contains. For an array `felt`, the macro is `FELT_NUMBERS`. Comments state the author and the
/// licence.
pub fn c_header(name: &str, baked: &BakeResult) -> String {
    let (bytes, numbers) = (&baked.bytes, baked.numbers);
    let macros = name.to_ascii_uppercase();
    let lines = lines(bytes);
    let comment = |line: &str| format!("/* {line} */\n");
    let rights: String = baked.rights.to_text().lines().map(comment).collect();
    format!(
        "{rights}/* A baked texture for htex_player.h (spec/baked-1.md). */\n#ifndef {macros}_BAKED_H\n#define {macros}_BAKED_H\n\n\
         #include <stdint.h>\n\n/* For HTEX_PLAYER_MEMORY. */\n#define {macros}_NUMBERS {numbers}\n\n\
         static const uint8_t {name}[{}] = {{\n{lines}}};\n\n#endif\n",
        bytes.len()
    )
}

/// Returns Rust source code that defines a block as an array of bytes with this name.
pub fn rust_source(name: &str, baked: &BakeResult) -> String {
    let bytes = &baked.bytes;
    let lines = lines(bytes);
    let rights = baked.rights.commented("// ");
    format!(
        "{rights}/// A baked texture for the crate `htex-player` (spec/baked-1.md).\n#[rustfmt::skip]\n\
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

/// Returns an identifier for C and Rust. Characters that are not allowed become underscores, but
/// never two underscores in a row.
fn identifier(stem: &str) -> String {
    let mut name = String::new();
    for c in stem.chars() {
        let c = if c.is_ascii_alphanumeric() { c } else { '_' };
        if c != '_' || !name.ends_with('_') {
            name.push(c);
        }
    }
    let is_word = name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.contains('_');
    if is_word { name } else { format!("{PREFIX}{}", name.trim_start_matches('_')) }
}
