//! Writes limits of memory and tables into a module, because a browser enforces only the limits
//! that the module itself states.

use crate::WasmLimits;
use crate::sandbox::BudgetError;

/// Size of a page of memory, bytes.
const PAGE: usize = 1 << 16;
/// Ids of module sections.
const IMPORT: u8 = 2;
const TABLE: u8 = 4;
const MEMORY: u8 = 5;
/// Flag of a memory or table: its limits include a maximum.
const HAS_MAXIMUM: u8 = 1;

/// Error: a module cannot be compiled.
// The type is in this file and not beside the compilation, because the tests of this file also run
// outside a browser.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub(super) enum CompileError {
    #[error("the module is larger than the {bytes} bytes allowed")]
    TooLarge { bytes: usize },
    #[error(transparent)]
    Budget(#[from] BudgetError),
    #[error("invalid module: {what}")]
    Invalid { what: String },
    #[error(
        "the module has imports; a model may import nothing (build it for wasm32-unknown-unknown, without files, clocks and \
         randomness)"
    )]
    Import,
    #[error("the module was stopped: its memory is limited to {bytes} bytes")]
    Memory { bytes: usize },
    #[error("the module was stopped: a table is limited to {elements} elements")]
    Table { elements: usize },
    #[error("the module has memories or tables of a kind that models may not have")]
    Kind,
}

/// Returns the module with its memory and tables limited to `limits`.
pub(super) fn limited(module: &[u8], limits: &WasmLimits) -> Result<Vec<u8>, CompileError> {
    if module.len() > limits.module_bytes {
        return Err(CompileError::TooLarge { bytes: limits.module_bytes });
    }
    let mut rest = module.strip_prefix(b"\0asm\x01\0\0\0").ok_or_else(|| {
        let what = "it does not begin with the bytes of WASM, version 1".to_owned();
        CompileError::Invalid { what }
    })?;
    let mut out = module[..8].to_vec();
    while let Some((&id, behind)) = rest.split_first() {
        rest = behind;
        let len = number(&mut rest).ok_or_else(|| unreadable(id))?;
        let (body, behind) = rest.split_at_checked(len as usize).ok_or_else(|| unreadable(id))?;
        rest = behind;
        match id {
            // Imports are refused, so all memories and tables are in the two sections below.
            IMPORT if body != [0] => return Err(CompileError::Import),
            MEMORY | TABLE => {
                let body = within(id, body, limits)?;
                out.push(id);
                push(&mut out, body.len() as u32);
                out.extend(body);
            }
            _ => {
                out.push(id);
                push(&mut out, len);
                out.extend(body);
            }
        }
    }
    Ok(out)
}

/// Returns a section's memories or tables, and adds the maxima.
fn within(id: u8, mut body: &[u8], limits: &WasmLimits) -> Result<Vec<u8>, CompileError> {
    let (most, above) = match id {
        MEMORY => {
            let bytes = limits.memory_bytes;
            (bytes / PAGE, CompileError::Memory { bytes })
        }
        _ => {
            let elements = limits.table_elements;
            (elements, CompileError::Table { elements })
        }
    };
    let count = number(&mut body).ok_or_else(|| unreadable(id))?;
    if id == MEMORY && count > 1 {
        return Err(CompileError::Kind);
    }
    let mut out = Vec::new();
    push(&mut out, count);
    for _ in 0..count {
        if id == TABLE {
            // The type must be a reference type of one byte. The encodings of all other types begin
            // with a different byte.
            let kind = byte(&mut body).ok_or_else(|| unreadable(id))?;
            if !matches!(kind, 0x70 | 0x6f) {
                return Err(CompileError::Kind);
            }
            out.push(kind);
        }
        let flags = byte(&mut body).ok_or_else(|| unreadable(id))?;
        // Other flags mean shared or 64-bit memories.
        if flags > HAS_MAXIMUM {
            return Err(CompileError::Kind);
        }
        let least = number(&mut body).ok_or_else(|| unreadable(id))?;
        let stated = match flags {
            HAS_MAXIMUM => number(&mut body).ok_or_else(|| unreadable(id))?,
            _ => u32::MAX,
        };
        if least as usize > most {
            return Err(above);
        }
        out.push(HAS_MAXIMUM);
        push(&mut out, least);
        push(&mut out, stated.min(u32::try_from(most).unwrap_or(u32::MAX)));
    }
    if body.is_empty() { Ok(out) } else { Err(unreadable(id)) }
}

fn unreadable(id: u8) -> CompileError {
    CompileError::Invalid { what: format!("its section {id} cannot be read") }
}

fn byte(rest: &mut &[u8]) -> Option<u8> {
    let (first, behind) = rest.split_first()?;
    *rest = behind;
    Some(*first)
}

/// Reads a number of at most 32 bits (LEB128).
fn number(rest: &mut &[u8]) -> Option<u32> {
    let mut value = 0u64;
    for shift in [0, 7, 14, 21, 28] {
        let next = byte(rest)?;
        value |= u64::from(next & 0x7f) << shift;
        if next < 0x80 {
            return u32::try_from(value).ok();
        }
    }
    None
}

fn push(out: &mut Vec<u8>, mut value: u32) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

#[cfg(all(test, feature = "wasm"))]
mod tests {
    use super::*;
    use wasmparser::{Parser, Payload, Validator};

    /// Returns the maxima of the memories and tables of a valid module.
    fn maxima(module: &[u8]) -> Vec<Option<u64>> {
        Validator::new().validate_all(module).unwrap();
        let mut all = Vec::new();
        for payload in Parser::new(0).parse_all(module) {
            match payload.unwrap() {
                Payload::MemorySection(section) => {
                    all.extend(section.into_iter().map(|m| m.unwrap().maximum));
                }
                Payload::TableSection(section) => {
                    all.extend(section.into_iter().map(|t| t.unwrap().ty.maximum));
                }
                _ => {}
            }
        }
        all
    }

    #[test]
    fn memories_and_tables_get_maxima() {
        let limits = WasmLimits::default().with_memory_bytes(10 * PAGE).with_table_elements(300);
        for (text, expected) in [
            ("(module (memory 1) (table 2 funcref))", vec![300, 10]),
            ("(module (memory 1 4) (table 2 200 funcref) (table 1 externref))", vec![200, 300, 4]),
            ("(module (memory 10 65536) (func (export \"f\")))", vec![10]),
            (
                "(module (table 300 funcref) (func $f) (elem (i32.const 0) $f) (memory 0) (data (i32.const 0) \"\"))",
                vec![300, 10],
            ),
        ] {
            let module = limited(&wat::parse_str(text).unwrap(), &limits).unwrap();
            let expected: Vec<_> = expected.into_iter().map(Some).collect();
            assert_eq!(maxima(&module), expected, "{text}");
        }
    }

    #[test]
    fn modules_above_the_limits_are_refused() {
        let limits = WasmLimits::default().with_memory_bytes(10 * PAGE);
        for (text, words) in [
            ("(module (memory 11))", "memory is limited to 655360 bytes"),
            ("(module (table 10001 funcref))", "limited to 10000 elements"),
            ("(module (import \"a\" \"b\" (func)))", "import nothing"),
            ("(module (memory 1) (memory 1))", "of a kind"),
            ("(module (memory i64 1))", "of a kind"),
        ] {
            let error = limited(&wat::parse_str(text).unwrap(), &limits).unwrap_err();
            assert!(error.to_string().contains(words), "{text}: {error}");
        }
        let invalid = |what: &str| Err(CompileError::Invalid { what: what.to_owned() });
        let expected = invalid("it does not begin with the bytes of WASM, version 1");
        assert_eq!(limited(b"PK", &limits), expected);
        let cut = b"\0asm\x01\0\0\0\x05\x04\x01\x00";
        assert_eq!(limited(cut, &limits), invalid("its section 5 cannot be read"));
    }
}
