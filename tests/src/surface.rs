//! The frozen surfaces of the ABIs, and of two extensions, as canonical text: one line for each
//! constant, status and function, read from the Rust side and from the C header.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use crate::workspace;

/// C declarations of functions, by name.
pub type Prototypes = BTreeMap<String, String>;
/// Constants and statuses by their C name. Values are C text without brackets.
pub type Constants = BTreeMap<String, String>;

/// Where an ABI is defined, and how its names begin.
pub struct Surface {
    /// The header's file name.
    pub header: &'static str,
    /// Prefix of functions.
    pub function: &'static str,
    /// Prefix of constants.
    pub constant: &'static str,
    /// The macro that marks a function as exported; empty if the functions are members of a table.
    pub export: &'static str,
    /// The source with constants, function types and the table.
    pub code: &'static str,
    /// The table of functions.
    pub table: &'static str,
    /// Functions outside the table, and their types.
    pub more: &'static [(&'static str, &'static str)],
    /// The source with the statuses, and their type; `None` if they belong to another surface.
    pub statuses: Option<(&'static str, &'static str)>,
}

/// The model ABI.
pub const MODEL: Surface = Surface {
    header: "htex_model.h",
    function: "htex_model_",
    constant: "HTEX_",
    export: "HTEX_EXPORT(",
    code: "sdk/core/model/src/abi.rs",
    table: "ModelTable",
    more: &[("alloc", "AllocFn"), ("free", "FreeFn")],
    statuses: Some(("sdk/core/model/src/error.rs", "Status")),
};

/// The extension of the model ABI that renders several voices in one call.
pub const VOICES: Surface = Surface {
    header: "htex_voices_1.h",
    function: "htex_voices_1_",
    constant: "HTEX_VOICES_1_",
    export: "HTEX_EXPORT(",
    code: "sdk/core/model/src/voices_1.rs",
    table: "VoicesTable",
    more: &[],
    statuses: None,
};

/// The extension of the model ABI that passes the motion to voices and fits.
pub const MOTION: Surface = Surface {
    header: "htex_motion_1.h",
    function: "htex_motion_1_",
    constant: "HTEX_MOTION_1_",
    export: "HTEX_EXPORT(",
    code: "sdk/core/model/src/motion_1.rs",
    table: "MotionTable",
    more: &[],
    statuses: None,
};

/// The device ABI, whose functions are members of a table.
pub const DEVICE: Surface = Surface {
    header: "htex_device.h",
    function: "htex_device_",
    constant: "HTEX_DEVICE_",
    export: "",
    code: "renderer-adapters/device/src/abi.rs",
    table: "DeviceTable",
    more: &[],
    statuses: Some(("renderer-adapters/device/src/abi.rs", "Code")),
};

impl Surface {
    /// The header's text without comments.
    pub fn header(&self) -> String {
        let path = workspace().join("spec/include").join(self.header);
        let text = fs::read_to_string(path).unwrap();
        let mut code = String::new();
        for (i, part) in text.split("/*").enumerate() {
            let kept = if i == 0 { part } else { part.split_once("*/").unwrap().1 };
            code.push_str(kept);
        }
        code
    }

    /// Functions that the header declares.
    pub fn header_prototypes(&self) -> Prototypes {
        let header = self.header();
        if self.export.is_empty() {
            return self.header_members(&header);
        }
        let mark = format!("{}{}", self.export, self.function);
        let declarations = header.split(&mark).skip(1);
        let prototype = |text: &str| {
            let (name, rest) = text.split_once(')').unwrap();
            let declared = one_line(rest.split_once(';').unwrap().0);
            (format!("{}{name}", self.function), declared)
        };
        declarations.map(prototype).collect()
    }

    /// Members of the table that the header defines.
    fn header_members(&self, header: &str) -> Prototypes {
        let (_, table) = header.split_once("typedef struct").unwrap();
        let members = table.split_once('{').unwrap().1.split_once('}').unwrap().0;
        let members = members.split(';').map(one_line).filter(|text| !text.is_empty());
        members.enumerate().map(|(i, text)| (self.place(i), text)).collect()
    }

    /// The declaration of the function that returns the table, if there is one.
    fn entry(&self) -> Option<String> {
        let prefix = self.function;
        self.export.is_empty().then(|| format!("const {prefix}table *{prefix}adapter(void);\n"))
    }

    /// The name of a member of the table, by its place, which is frozen.
    fn place(&self, i: usize) -> String {
        format!("{}table {i:02}", self.function)
    }

    /// Constants that the header defines.
    pub fn header_constants(&self) -> Constants {
        let define = |line: &str| {
            let (name, value) = line.strip_prefix("#define ")?.split_once(' ')?;
            let is_export = name.contains('(') || name.ends_with("_EXPORT");
            let constant = name.starts_with(self.constant) && !is_export;
            let value = value.trim().trim_matches(['(', ')']);
            constant.then(|| (name.to_owned(), value.to_owned()))
        };
        self.header().lines().filter_map(define).collect()
    }

    /// Functions of the Rust side, as C declarations.
    pub fn rust_prototypes(&self) -> Prototypes {
        let code = rust_code(self.code);
        let mark = format!("pub struct {} {{", self.table);
        let table = code.split_once(&mark).unwrap().1.split_once('}').unwrap().0;
        let fields = table.split(',').filter_map(|field| {
            let (name, kind) = field.trim().strip_prefix("pub ")?.split_once(": ")?;
            Some((name.to_owned(), kind.to_owned()))
        });
        if self.export.is_empty() {
            let member = |(name, kind): (String, String)| match kind
                .strip_prefix("Option<")
                .and_then(|kind| kind.strip_suffix('>'))
            {
                Some(kind) => c_prototype(&format!("(*{name})"), function_type(&code, kind)),
                None => c_declaration(&kind, &name),
            };
            return fields.map(member).enumerate().map(|(i, text)| (self.place(i), text)).collect();
        }
        let more = self.more.iter().map(|(name, kind)| (name.to_string(), kind.to_string()));
        let prototype = |(name, kind): (String, String)| {
            let name = format!("{}{name}", self.function);
            let text = c_prototype(&name, function_type(&code, &kind));
            (name, text)
        };
        fields.chain(more).map(prototype).collect()
    }

    /// Names of the Rust side's constants, in C form.
    pub fn rust_constant_names(&self) -> Vec<String> {
        let code = rust_code(self.code);
        let constants = code.lines().filter_map(|line| {
            let (name, _) = line.strip_prefix("pub const ")?.split_once(':')?;
            Some(format!("{}{name}", self.constant))
        });
        constants.chain(self.rust_statuses().into_keys()).collect()
    }

    /// Statuses of the Rust side, in C form.
    pub fn rust_statuses(&self) -> Constants {
        let Some((file, name)) = self.statuses else {
            return Constants::new();
        };
        let code = rust_code(file);
        let (_, variants) = code.split_once(&format!("pub enum {name} {{")).unwrap();
        let variants = variants.split_once('}').unwrap().0;
        let status = |text: &str| {
            let (name, value) = text.trim().split_once(" = ")?;
            let name = format!("{}{}", self.constant, upper_case(name));
            Some((name, value.to_owned()))
        };
        variants.split(',').filter_map(status).collect()
    }

    /// Returns the surface with these constants: one line for each constant and function, sorted by
    /// name.
    pub fn listing(&self, constants: &Constants) -> String {
        let constants = constants.iter().map(|(name, value)| format!("{name} {value}\n"));
        let prototypes = self.rust_prototypes();
        let functions = prototypes.iter().map(|(name, text)| match self.export {
            "" => format!("{name}: {text};\n"),
            _ => format!("{text};\n"),
        });
        constants.chain(functions).chain(self.entry()).collect()
    }

    /// Compares the listing with the frozen ones, the newest of which is in use. Each has a version
    /// and the hash of `spec/abi/KIND-VERSION.txt`. Lines are never removed from it.
    pub fn hold_frozen(&self, kind: &str, frozen: &[(&str, u64)], now: &str, thaw: &str) {
        let (newest, hash) = frozen.last().unwrap();
        let found = fnv1a(now);
        assert_eq!(found, *hash, "{thaw}\nHash: {found:#018x}. {newest} is now:\n{now}");
        for (version, hash) in frozen {
            let file = format!("spec/abi/{kind}-{version}.txt");
            let then = fs::read_to_string(workspace().join(&file)).unwrap();
            assert_eq!(fnv1a(&then), *hash, "{file} was edited. {thaw}");
            let versions = format!("{}ABI_M", self.constant);
            for line in then.lines().filter(|l| !l.starts_with(&versions)) {
                assert!(now.lines().any(|l| l == line), "gone since {version}: {line}\n{thaw}");
            }
        }
    }

    /// Checks that the header and the Rust side agree.
    pub fn hold_header(&self, constants: &Constants) {
        assert_eq!(self.header_prototypes(), self.rust_prototypes());
        assert_eq!(self.header_constants(), *constants);
        for name in self.rust_constant_names() {
            let listed = constants.contains_key(&name);
            assert!(listed, "{name} is not in the listing of this test");
        }
    }

    /// Lets the compilers compare the header with the Rust side: constants, which are all integers,
    /// by assertion, and functions by declaring them again, which is an error for another type.
    pub fn compile(&self, constants: &Constants) {
        let folder = tempfile::tempdir().unwrap();
        for (compiler, standard, file, assertion) in [
            ("cc", "-std=c11", "surface.c", "_Static_assert"),
            ("c++", "-std=c++17", "surface.cpp", "static_assert"),
        ] {
            let source = folder.path().join(file);
            fs::write(&source, self.translation_unit(assertion, constants)).unwrap();
            compile(compiler, standard, &source);
        }
    }

    fn translation_unit(&self, assertion: &str, constants: &Constants) -> String {
        let mut unit = format!("#include \"{}\"\n", self.header);
        for (name, value) in constants {
            unit += &format!(
                "{assertion}((long){name} == (long)({value}), \"{name} is not {value}\");\n"
            );
        }
        unit += "#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
        if self.export.is_empty() {
            // A table of the same members, each of which takes the other's value.
            let members = self.rust_prototypes();
            let table = format!("{}table", self.function);
            unit += "typedef struct {\n";
            unit.extend(members.values().map(|text| format!("{text};\n")));
            unit += "} same;\n";
            unit += &format!("{assertion}(sizeof(same) == sizeof({table}), \"size\");\n");
            unit += &format!("void assign(same *a, const {table} *b);\n");
            unit += &format!("void assign(same *a, const {table} *b) {{\n");
            for text in members.values() {
                let name = member_name(text);
                unit += &format!("a->{name} = b->{name};\n");
            }
            unit += "}\n";
            unit.extend(self.entry());
        } else {
            for prototype in self.rust_prototypes().values() {
                unit += &format!("{prototype};\n");
            }
        }
        unit + "#ifdef __cplusplus\n}\n#endif\nint main(void) { return 0; }\n"
    }
}

/// Returns the name in the C declaration of a member: a number or a pointer to a function.
fn member_name(text: &str) -> &str {
    match text.split_once("(*") {
        Some((_, rest)) => rest.split_once(')').unwrap().0,
        None => text.rsplit(' ').next().unwrap(),
    }
}

/// FNV-1a hash of a text.
fn fnv1a(text: &str) -> u64 {
    let step = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, step)
}

fn compile(compiler: &str, standard: &str, source: &Path) {
    let output = Command::new(compiler)
        .args([standard, "-Wall", "-Wextra", "-Werror", "-pedantic", "-fsyntax-only"])
        .arg("-I")
        .arg(workspace().join("spec/include"))
        .arg(source)
        .output()
        .unwrap_or_else(|e| panic!("{compiler} is wanted (apt install build-essential): {e}"));
    assert!(
        output.status.success(),
        "{compiler} {standard}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Returns what follows `pub type KIND =`, without `unsafe extern "C" fn`.
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
    let parameters = if parameters.is_empty() { "void".to_owned() } else { parameters.join(", ") };
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

/// Converts `BadHandle` to `BAD_HANDLE`.
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

/// Returns a source of the workspace without comment lines.
fn rust_code(file: &str) -> String {
    let text = fs::read_to_string(workspace().join(file)).unwrap();
    let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
    code.flat_map(|line| [line, "\n"]).collect()
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
