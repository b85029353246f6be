//! The adapter's descriptor.

use std::sync::LazyLock;

use htex_device::{Descriptor, Quantity, Setting, SettingKind};

/// Largest allowed limit (volts), and largest full scale in the quantity's unit.
const MOST: f64 = 1_000.0;

pub(crate) static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
    id: "org.htex.file".to_owned(),
    name: "File".to_owned(),
    version: "1.0.0".to_owned(),
    summary: "Writes the samples to a file: WAV, CSV, NPY or raw, of any length.".to_owned(),
    settings: settings(),
    ..Descriptor::default()
});

fn settings() -> Vec<Setting> {
    let number = |min, max| SettingKind::Number { min, max };
    let setting = |name, kind, default, description| {
        Setting::new(name, kind, description).with_default(default)
    };
    vec![
        Setting::new(
            "path",
            SettingKind::Path,
            "The file; it appears, or is replaced, when the device is finished.",
        ),
        setting(
            "format",
            SettingKind::choice(&["auto", "wav", "csv", "npy", "raw"]),
            "auto",
            "auto: by the file's extension. wav: one channel, at most 4 GiB. csv: time in seconds \
             and the quantity, in its unit. npy: one dimension. raw: little-endian, no header.",
        ),
        setting(
            "encoding",
            SettingKind::choice(&["f32", "i24", "i16"]),
            "f32",
            "f32 holds the quantity in its unit. i24 and i16 hold steps of full_scale / 2^23 and \
             full_scale / 2^15; npy has no i24, csv no integers.",
        ),
        setting(
            "full_scale",
            number(1e-6, MOST),
            "1",
            "What the full scale of i24 and i16 stands for, in the quantity's unit; 1 for f32.",
        ),
        setting(
            "quantity",
            SettingKind::choice(&Quantity::ALL.map(Quantity::name)),
            "lateral_force",
            "What the samples are: what a finger or tool meets, in N, m/s2, m/s or m; the volts an \
             electrovibration display is driven with; or sound.",
        ),
        setting(
            "limit_v",
            number(0.0, MOST),
            "0",
            "Of a display_voltage, which must have one: the largest magnitude, volts. 0: none.",
        ),
        setting(
            "carrier_hz",
            number(0.0, 500_000.0),
            "0",
            "Of a display_voltage: the carrier that the display wants, hertz. 0: none.",
        ),
    ]
}
