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
            "Path of the file. The file appears, or replaces an existing one, when the output finishes.",
        ),
        setting(
            "format",
            SettingKind::choice(&["auto", "wav", "csv", "npy", "raw"]),
            "auto",
            "auto: the file's extension selects the format. wav: one channel, at most 4 GiB. csv: \
             columns for the time in seconds and for the quantity in its unit. npy: one dimension. \
             raw: little-endian, no header.",
        ),
        setting(
            "encoding",
            SettingKind::choice(&["f32", "i24", "i16"]),
            "f32",
            "f32: the quantity in its unit. i24: integers in steps of full_scale / 2^23. i16: \
             integers in steps of full_scale / 2^15. npy does not support i24, and csv supports \
             only f32.",
        ),
        setting(
            "full_scale",
            number(1e-6, MOST),
            "1",
            "Value for which full scale stands with i24 and i16, in the quantity's unit. Must be 1 \
             with f32.",
        ),
        setting(
            "quantity",
            SettingKind::choice(&Quantity::ALL.map(Quantity::name)),
            "lateral_force",
            "Quantity of the samples: a mechanical quantity at the finger or tool, in N, m/s2, m/s or m; \
             the drive voltage of an electrovibration display, in V; or sound.",
        ),
        setting(
            "limit_v",
            number(0.0, MOST),
            "0",
            "Largest magnitude of the samples, volts. Only for the quantity display_voltage, which \
             requires a value above 0.",
        ),
        setting(
            "carrier_hz",
            number(0.0, 500_000.0),
            "0",
            "Frequency of the carrier that the display needs, hertz. Only for the quantity \
             display_voltage. 0: no carrier.",
        ),
    ]
}
