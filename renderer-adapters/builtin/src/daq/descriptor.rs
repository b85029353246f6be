//! The adapter's descriptor: settings, and profiles of rigs.

use std::collections::BTreeMap;

use htex_device::{Descriptor, FromScene, Profile, Setting, SettingKind};

use crate::daq::rig::MOST_TO_ZERO_MS;

pub(crate) fn descriptor() -> Descriptor {
    Descriptor {
        id: "org.htex.daq".to_owned(),
        name: "NI-DAQmx".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        summary: "Electrovibration through the analog output of a National Instruments card and \
                  an amplifier."
            .to_owned(),
        settings: settings(),
        profiles: vec![paper(), generic()],
        mapping: None,
    }
}

fn settings() -> Vec<Setting> {
    let text = SettingKind::Text;
    let number = |min, max| SettingKind::Number { min, max };
    vec![
        setting(
            "device",
            text.clone(),
            FromScene::Never,
            Some("Dev1/ao0"),
            "Analog output, as NI MAX names it.",
        ),
        setting(
            "amplifier_gain",
            number(0.001, 10_000.0),
            FromScene::Never,
            None,
            "Volts at the display for one volt of the card. Measure it at the carrier's frequency.",
        ),
        setting(
            "limit_v",
            number(0.0, 1_000.0),
            FromScene::Less,
            None,
            "Largest voltage at the display, volts either way; no sample beyond it is put out.",
        ),
        setting(
            "dac_full_scale_v",
            number(0.1, 100.0),
            FromScene::Never,
            Some("10"),
            "Largest voltage of the card's output, volts either way.",
        ),
        setting(
            "dac_bits",
            number(1.0, 32.0),
            FromScene::Never,
            Some("16"),
            "Resolution of the card's output, bits.",
        ),
        setting(
            "dc_limit_v",
            number(0.01, 1_000.0),
            FromScene::Less,
            Some("1"),
            "Largest direct voltage at the display, volts either way: the mean over any 100 ms. What exceeds it is not put out, \
             and the output goes to zero.",
        ),
        setting(
            "carrier_hz",
            number(0.0, 100_000.0),
            FromScene::Never,
            Some("7000"),
            "Carrier that the signal is to have, hertz, at most the rate over 2.5; 0: none, and then `dc_limit_v` is to be said.",
        ),
        Setting {
            live_default: Some("20".to_owned()),
            ..setting(
                "buffer_ms",
                number(10.0, MOST_TO_ZERO_MS),
                FromScene::Less,
                Some("200"),
                "Samples kept ready for the card, milliseconds: more is safer, less is quicker. With the ramp at most 400.",
            )
        },
        setting(
            "ramp_ms",
            number(1.0, MOST_TO_ZERO_MS),
            FromScene::More,
            Some("20"),
            "Ramp before a first, and after a last sample that is not zero, milliseconds. With the buffer at most 400.",
        ),
        setting(
            "driver",
            text,
            FromScene::Never,
            Some(""),
            "File of the NI-DAQmx library; empty: the one that is installed.",
        ),
    ]
}

fn setting(
    name: &str,
    kind: SettingKind,
    from_scene: FromScene,
    default: Option<&str>,
    description: &str,
) -> Setting {
    Setting {
        name: name.to_owned(),
        kind,
        default: default.map(str::to_owned),
        live_default: None,
        from_scene,
        description: description.to_owned(),
    }
}

fn paper() -> Profile {
    profile(
        "pcie-6321_tabor-9200a_sct3250",
        "The rig of Balasubramanian & Vardar (2026). From the paper: NI PCIe-6321, Tabor 9200A, 3M \
         SCT3250, carrier 7 kHz, at most 150 V peak at the display. Of the card: 16 bits, -10 to 10 \
         V. Assumed, as the paper does not say: an amplifier gain of 50; measure yours.",
        &[
            ("amplifier_gain", "50"),
            ("limit_v", "150"),
            ("dac_full_scale_v", "10"),
            ("dac_bits", "16"),
            ("carrier_hz", "7000"),
        ],
    )
}

fn generic() -> Profile {
    profile(
        "generic",
        "A card without an amplifier: volts of its output, -10 to 10 V, no carrier asked for, and so direct voltage up to the \
         whole 10 V (dc_limit_v): not for a display that a finger touches.",
        &[("dc_limit_v", "10"), ("amplifier_gain", "1"), ("limit_v", "10"), ("carrier_hz", "0")],
    )
}

fn profile(name: &str, summary: &str, settings: &[(&str, &str)]) -> Profile {
    let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
    Profile {
        name: name.to_owned(),
        summary: summary.to_owned(),
        settings: settings.iter().map(owned).collect::<BTreeMap<_, _>>(),
    }
}
