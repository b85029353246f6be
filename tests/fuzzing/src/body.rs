//! Well-typed bodies of WASM functions, generated from bytes.

/// The bytes of an input, used one after the other. After the last one, they are zeros.
pub(crate) struct Bytes<'a>(pub(crate) &'a [u8]);

impl Bytes<'_> {
    pub(crate) fn next(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        *first
    }

    pub(crate) fn number(&mut self) -> u64 {
        u64::from_le_bytes([0; 8].map(|_: u8| self.next()))
    }
}

/// A WASM number type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Type {
    I32,
    I64,
    F64,
}

impl Type {
    fn name(self) -> &'static str {
        match self {
            Self::I32 => "i32",
            Self::I64 => "i64",
            Self::F64 => "f64",
        }
    }
}

/// Parses the parameters and the result of a signature in WebAssembly text.
pub(crate) fn signature(text: &str) -> (Vec<Type>, Option<Type>) {
    let types = |text: &str| -> Vec<Type> {
        let words = text.split([' ', '(', ')']);
        words
            .filter_map(|word| match word {
                "i32" => Some(Type::I32),
                "i64" => Some(Type::I64),
                "f64" => Some(Type::F64),
                _ => None,
            })
            .collect()
    };
    let (parameters, result) = text.split_once("(result").unwrap_or((text, ""));
    (types(parameters), types(result).first().copied())
}

/// Returns the text of a body with these parameters and this result, after up to three statements.
pub(crate) fn body(bytes: &mut Bytes<'_>, parameters: &[Type], result: Option<Type>) -> String {
    let mut body = Body { bytes, parameters };
    let mut text = String::new();
    for _ in 0..body.bytes.next() % 4 {
        text += &body.statement(3);
    }
    if let Some(result) = result {
        text += &body.value(result, 3);
    }
    text
}

struct Body<'a, 'b> {
    bytes: &'a mut Bytes<'b>,
    parameters: &'a [Type],
}

impl Body<'_, '_> {
    fn statement(&mut self, depth: u8) -> String {
        let kind = if depth == 0 { 0 } else { self.bytes.next() % 11 };
        let mut i32 = || self.value(Type::I32, depth.saturating_sub(1));
        match kind {
            1 => format!("(i32.store {} {})", i32(), i32()),
            2 => format!("(memory.fill {} {} {})", i32(), i32(), i32()),
            3 => format!("(memory.copy {} {} {})", i32(), i32(), i32()),
            4 => format!("(drop (call $deep {}))", i32()),
            5 => format!("(call $count {})", i32()),
            6 => format!("(drop (memory.grow {}))", i32()),
            7 => {
                let to = i32();
                format!("(f64.store {to} {})", self.value(Type::F64, depth - 1))
            }
            8 => {
                let when = i32();
                format!("(if {when} (then {}))", self.statement(depth - 1))
            }
            9 => {
                let again = i32();
                format!("(block (loop {} (br_if 0 {again})))", self.statement(depth - 1))
            }
            10 => "(unreachable)".to_owned(),
            _ => "(nop)".to_owned(),
        }
    }

    fn value(&mut self, of: Type, depth: u8) -> String {
        let kind = if depth == 0 { 0 } else { self.bytes.next() % 6 };
        let t = of.name();
        match kind {
            1 => self.parameter(of),
            2 => {
                const SAME: [&str; 3] = ["add", "sub", "mul"];
                let operation = SAME[usize::from(self.bytes.next()) % SAME.len()];
                let left = self.value(of, depth - 1);
                format!("({t}.{operation} {left} {})", self.value(of, depth - 1))
            }
            3 => format!("({t}.load {})", self.value(Type::I32, depth - 1)),
            4 => self.converted(of, depth - 1),
            5 => format!("({t}.const {})", self.usual(of)),
            _ => self.constant(of),
        }
    }

    fn constant(&mut self, of: Type) -> String {
        match of {
            Type::I32 => format!("(i32.const {})", self.bytes.next() as i8),
            Type::I64 => format!("(i64.const {})", self.bytes.next() as i8),
            Type::F64 => {
                let bits = self.bytes.number();
                format!("(f64.reinterpret_i64 (i64.const {}))", bits as i64)
            }
        }
    }

    /// Returns a number close to those that hosts and models use.
    fn usual(&mut self, of: Type) -> &'static str {
        const WHOLE: [&str; 8] = ["0", "1", "-1", "16", "8192", "65536", "524280", "0x48540100"];
        const LONG: [&str; 8] = ["0", "1", "-1", "-7", "256", "65536", "1048577", "-9"];
        const REAL: [&str; 8] = ["0", "1", "0.5", "-1", "nan", "inf", "2000", "1e300"];
        let i = usize::from(self.bytes.next() % 8);
        match of {
            Type::I32 => WHOLE[i],
            Type::I64 => LONG[i],
            Type::F64 => REAL[i],
        }
    }

    fn parameter(&mut self, of: Type) -> String {
        let all = self.parameters.iter().enumerate();
        let fitting: Vec<usize> = all.filter(|(_, t)| **t == of).map(|(i, _)| i).collect();
        match fitting.get(usize::from(self.bytes.next()) % fitting.len().max(1)) {
            Some(i) => format!("(local.get {i})"),
            None => format!("({}.const 1)", of.name()),
        }
    }

    fn converted(&mut self, of: Type, depth: u8) -> String {
        match of {
            Type::I32 => format!("(i32.wrap_i64 {})", self.value(Type::I64, depth)),
            Type::I64 => format!("(i64.extend_i32_u {})", self.value(Type::I32, depth)),
            Type::F64 => format!("(f64.convert_i32_s {})", self.value(Type::I32, depth)),
        }
    }
}
