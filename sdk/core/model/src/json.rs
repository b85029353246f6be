//! The JSON text of a descriptor, generated at compile time. Therefore, a WASM module contains the
//! JSON text, but no code that writes JSON.

use crate::decimal::whole;
use crate::exact::exact;
use crate::{Kind, Scale, StaticDescriptor, StaticField, StaticOption, Store};

/// Returns the length of a descriptor's JSON text in bytes.
pub const fn length(descriptor: &StaticDescriptor) -> usize {
    // A buffer of length 0 stores nothing, but all bytes are counted. The length needs a separate
    // function, because a const function cannot return a text whose length it has only just
    // computed.
    written::<0>(descriptor).len
}

/// Returns a descriptor's JSON text; `N` is the [`length`] of the same descriptor.
pub const fn text<const N: usize>(descriptor: &StaticDescriptor) -> [u8; N] {
    written(descriptor).bytes
}

const fn written<const N: usize>(descriptor: &StaticDescriptor) -> Writer<N> {
    let mut json = Writer { bytes: [0; N], len: 0 };
    json.descriptor(descriptor);
    json
}

/// Writes the bytes that fit into the buffer, and counts all bytes.
struct Writer<const N: usize> {
    bytes: [u8; N],
    len: usize,
}

impl<const N: usize> Writer<N> {
    const fn descriptor(&mut self, it: &StaticDescriptor) {
        self.member(b"{\"id\":", it.id);
        self.member(b",\"name\":", it.name);
        self.member(b",\"version\":", it.version);
        self.member(b",\"summary\":", it.summary);
        self.raw(b",\"fields\":[");
        let mut i = 0;
        while i < it.fields.len() {
            self.comma(i);
            self.field(&it.fields[i]);
            i += 1;
        }
        self.raw(b"],\"options\":[");
        let mut i = 0;
        while i < it.options.len() {
            self.comma(i);
            self.option(&it.options[i]);
            i += 1;
        }
        self.raw(b"]");
        if it.keeps_level {
            self.raw(b",\"keeps_level\":true");
        }
        if it.only_named {
            self.raw(b",\"only_named\":true");
        }
        self.raw(b"}");
    }

    const fn field(&mut self, it: &StaticField) {
        self.member(b"{\"name\":", it.name);
        self.member(b",\"unit\":", it.unit);
        self.raw(b",\"kind\":{\"type\":");
        match it.kind {
            Kind::Scalar => self.raw(b"\"scalar\"}"),
            Kind::List { max_len } => {
                self.raw(b"\"list\",\"max_len\":");
                self.raw(whole(max_len as u64).bytes());
                self.raw(b"}");
            }
        }
        self.number(b",\"min\":", it.min);
        self.number(b",\"max\":", it.max);
        self.raw(b",\"store\":{\"type\":");
        self.store(it.store);
        if let Some(default) = it.default {
            self.number(b",\"default\":", default);
        }
        if let Some(usual) = it.usual {
            self.number(b",\"usual\":{\"min\":", usual.min);
            self.number(b",\"max\":", usual.max);
            let scale = match usual.scale {
                Scale::Linear => "linear",
                Scale::Log => "log",
            };
            self.member(b",\"scale\":", scale);
            self.raw(b"}");
        }
        self.member(b",\"description\":", it.description);
        self.raw(b"}");
    }

    const fn store(&mut self, store: Store) {
        match store {
            Store::F64 => self.raw(b"\"f64\"}"),
            Store::F32 => self.raw(b"\"f32\"}"),
            Store::U16 { scale, offset, log } => self.steps(b"\"u16\"", scale, offset, log),
            Store::U8 { scale, offset, log } => self.steps(b"\"u8\"", scale, offset, log),
            Store::Packed { scale, offset, log } => self.steps(b"\"packed\"", scale, offset, log),
        }
    }

    const fn steps(&mut self, kind: &[u8], scale: f64, offset: f64, log: bool) {
        self.raw(kind);
        self.number(b",\"scale\":", scale);
        self.number(b",\"offset\":", offset);
        self.flag(b",\"log\":", log);
        self.raw(b"}");
    }

    const fn option(&mut self, it: &StaticOption) {
        self.member(b"{\"name\":", it.name);
        self.member(b",\"unit\":", it.unit);
        self.number(b",\"min\":", it.min);
        self.number(b",\"max\":", it.max);
        self.number(b",\"default\":", it.default);
        self.flag(b",\"integer\":", it.integer);
        self.raw(b",\"choices\":[");
        let mut i = 0;
        while i < it.choices.len() {
            self.comma(i);
            self.string(it.choices[i]);
            i += 1;
        }
        self.raw(b"]");
        self.numbers(b",\"sweep\":", it.sweep);
        self.numbers(b",\"sweep_alone\":", it.sweep_alone);
        if let Some(option) = it.not_above {
            self.member(b",\"not_above\":", option);
        }
        self.member(b",\"description\":", it.description);
        self.raw(b"}");
    }

    /// Writes an array, unless it is empty.
    const fn numbers(&mut self, key: &[u8], numbers: &[f64]) {
        let mut i = 0;
        while i < numbers.len() {
            if i == 0 {
                self.raw(key);
                self.number(b"[", numbers[i]);
            } else {
                self.number(b",", numbers[i]);
            }
            i += 1;
        }
        if i > 0 {
            self.raw(b"]");
        }
    }

    const fn member(&mut self, key: &[u8], text: &str) {
        self.raw(key);
        self.string(text);
    }

    const fn number(&mut self, key: &[u8], number: f64) {
        self.raw(key);
        self.raw(exact(number).text().bytes());
    }

    const fn flag(&mut self, key: &[u8], flag: bool) {
        self.raw(key);
        self.raw(if flag { b"true" } else { b"false" });
    }

    const fn comma(&mut self, before: usize) {
        if before > 0 {
            self.byte(b',');
        }
    }

    const fn string(&mut self, text: &str) {
        self.byte(b'"');
        let (bytes, mut i) = (text.as_bytes(), 0);
        while i < bytes.len() {
            self.escaped(bytes[i]);
            i += 1;
        }
        self.byte(b'"');
    }

    const fn escaped(&mut self, byte: u8) {
        const HEX: &[u8; 16] = b"0123456789abcdef";
        match byte {
            b'"' | b'\\' => {
                self.byte(b'\\');
                self.byte(byte);
            }
            0..0x20 => {
                self.raw(b"\\u00");
                self.byte(HEX[(byte >> 4) as usize]);
                self.byte(HEX[(byte & 15) as usize]);
            }
            _ => self.byte(byte),
        }
    }

    const fn raw(&mut self, bytes: &[u8]) {
        let mut i = 0;
        while i < bytes.len() {
            self.byte(bytes[i]);
            i += 1;
        }
    }

    const fn byte(&mut self, byte: u8) {
        if self.len < N {
            self.bytes[self.len] = byte;
        }
        self.len += 1;
    }
}

#[cfg(all(test, feature = "host"))]
mod tests {
    use super::*;
    use crate::{Descriptor, UsualRange};

    const STEPS: Store = Store::U8 { scale: 1.0 / 3.0, offset: -18.0, log: true };
    const ALL: StaticDescriptor =
        StaticDescriptor::new("org.example.all", "A \"B\" \\ ü\n\u{1f}", "1.2.3", "Σ.")
            .keeping_level()
            .only_named()
            .fields(&[
                StaticField::scalar("a", "1", (-1e6, 1e-20), "")
                    .defaulted(-0.1)
                    .usual(UsualRange::linear(-1.5, 1e-21)),
                StaticField::list("b", "Hz", (0.0, f64::MAX), 65_535, "List.")
                    .stored(STEPS)
                    .usual(UsualRange::log(0.1, 10.0)),
                StaticField::scalar("c", "1", (0.0, 1.0), "").stored(Store::F64),
                StaticField::scalar("d", "1", (0.0, 1.0), "").stored(Store::U16 {
                    scale: 0.03125,
                    offset: 0.0,
                    log: false,
                }),
                StaticField::list("e", "1", (0.0, 255.0), 64, "").stored(Store::Packed {
                    scale: 1.0,
                    offset: 0.0,
                    log: false,
                }),
            ])
            .options(&[
                StaticOption::number("n", "dB", (0.05, 6.0), 0.12, "Number.").not_above("i"),
                StaticOption::integer("i", (3, 64), 10, "Integer.").sweep(&[3.0, 64.0]),
                StaticOption::choice("c", &["x", "y", "z"], "Choice.").sweep_alone(&[2.0]),
            ]);

    /// The JSON text parses to the constants from which it was generated.
    #[test]
    fn the_text_is_the_descriptor() {
        const LEN: usize = length(&ALL);
        const TEXT: [u8; LEN] = text(&ALL);
        let read: Descriptor = serde_json::from_slice(&TEXT).unwrap();
        assert_eq!(read, Descriptor::from(&ALL));
    }
}
