//! The frozen surface of the model ABI as canonical text: a line for each constant, status and
//! function, read from the Rust side and from the C header.

use std::collections::BTreeMap;
use std::fs;

use crate::workspace;

/// Functions in the words of C, by name.
pub type Prototypes = BTreeMap<String, String>;
/// Constants and statuses by their C name; values as C text without brackets.
pub type Constants = BTreeMap<String, String>;

/// The header's text without comments.
pub fn header() -> String {
    let text = fs::read_to_string(workspace().join("spec/include/htex_model.h")).unwrap();
    let mut code = String::new();
    for (i, part) in text.split("/*").enumerate() {
        let kept = if i == 0 {
            part
        } else {
            part.split_once("*/").unwrap().1
        };
        code.push_str(kept);
    }
    code
}

/// Functions the header declares.
pub fn header_prototypes() -> Prototypes {
    let header = header();
    let declarations = header.split("HTEX_EXPORT(htex_model_").skip(1);
    let prototype = |text: &str| {
        let (name, rest) = text.split_once(')').unwrap();
        let declared = one_line(rest.split_once(';').unwrap().0);
        (format!("htex_model_{name}"), declared)
    };
    declarations.map(prototype).collect()
}

/// Constants the header defines.
pub fn header_constants() -> Constants {
    let define = |line: &str| {
        let (name, value) = line.strip_prefix("#define ")?.split_once(' ')?;
        let constant = name.starts_with("HTEX_") && !name.contains('(');
        let value = value.trim().trim_matches(['(', ')']);
        constant.then(|| (name.to_owned(), value.to_owned()))
    };
    header().lines().filter_map(define).collect()
}

/// Functions the Rust side states, in the words of C.
pub fn rust_prototypes() -> Prototypes {
    let code = rust_code("abi.rs");
    let table = code.split_once("pub struct ModelTable {").unwrap().1;
    let table = table.split_once('}').unwrap().0;
    let fields = table.split(',').filter_map(|field| {
        let (name, kind) = field.trim().strip_prefix("pub ")?.split_once(": ")?;
        Some((name.to_owned(), kind.to_owned()))
    });
    let wasm = [("alloc", "AllocFn"), ("free", "FreeFn")];
    let wasm = wasm.map(|(name, kind)| (name.to_owned(), kind.to_owned()));
    let prototype = |(name, kind): (String, String)| {
        let name = format!("htex_model_{name}");
        let text = c_prototype(&name, function_type(&code, &kind));
        (name, text)
    };
    fields.chain(wasm).map(prototype).collect()
}

/// What stands behind `pub type KIND =` without `unsafe extern "C" fn`.
fn function_type<'a>(code: &'a str, kind: &str) -> &'a str {
    let (_, text) = code.split_once(&format!("pub type {kind} =")).unwrap();
    let text = text.split_once(';').unwrap().0;
    text.split_once("extern \"C\" fn").unwrap().1
}

fn c_prototype(name: &str, text: &str) -> String {
    let (parameters, answer) = text.split_once(')').unwrap();
    let parameters: Vec<String> = parameters
        .trim_start_matches('(')
        .split(',')
        .filter_map(|p| p.trim().split_once(": "))
        .map(|(name, kind)| c_declaration(kind, name))
        .collect();
    let parameters = if parameters.is_empty() {
        "void".to_owned()
    } else {
        parameters.join(", ")
    };
    let answer = answer.trim().strip_prefix("-> ").unwrap_or("()");
    c_declaration(answer, &format!("{name}({parameters})"))
}

fn c_declaration(kind: &str, name: &str) -> String {
    let (constant, kind) = match kind.trim().strip_prefix("*const ") {
        Some(kind) => ("const ", format!("*{kind}")),
        None => ("", kind.trim().replace("*mut ", "*")),
    };
    let (star, kind) = kind.strip_prefix('*').map_or(("", &*kind), |k| ("*", k));
    let c = match kind {
        "()" => "void",
        "f64" => "double",
        "f32" => "float",
        "usize" => "size_t",
        "u8" => "uint8_t",
        "u32" => "uint32_t",
        "u64" => "uint64_t",
        "i64" => "int64_t",
        other => panic!("the ABI has no type {other}"),
    };
    format!("{constant}{c} {star}{name}")
}

/// Names of the constants that the Rust side states, as C has them.
pub fn rust_constant_names() -> Vec<String> {
    let constants = rust_code("abi.rs");
    let constants = constants.lines().filter_map(|line| {
        let (name, _) = line.strip_prefix("pub const ")?.split_once(':')?;
        Some(format!("HTEX_{name}"))
    });
    constants.chain(rust_statuses().into_keys()).collect()
}

/// Statuses that the Rust side states, as C has them.
pub fn rust_statuses() -> Constants {
    let code = rust_code("error.rs");
    let (_, variants) = code.split_once("pub enum Status {").unwrap();
    let variants = variants.split_once('}').unwrap().0;
    let status = |text: &str| {
        let (name, value) = text.trim().split_once(" = ")?;
        Some((format!("HTEX_{}", upper_case(name)), value.to_owned()))
    };
    variants.split(',').filter_map(status).collect()
}

/// `BadHandle` as `BAD_HANDLE`.
fn upper_case(name: &str) -> String {
    let mut text = String::new();
    for (i, letter) in name.chars().enumerate() {
        if i > 0 && letter.is_uppercase() {
            text.push('_');
        }
        text.extend(letter.to_uppercase());
    }
    text
}

/// A source of the model crate without comment lines.
fn rust_code(file: &str) -> String {
    let path = workspace().join("sdk/model/src").join(file);
    let text = fs::read_to_string(path).unwrap();
    let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
    code.flat_map(|line| [line, "\n"]).collect()
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
