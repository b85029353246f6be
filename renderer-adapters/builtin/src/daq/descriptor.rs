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
        ..Descriptor::default()
    }
}

fn settings() -> Vec<Setting> {
    let text = SettingKind::Text;
    let number = |min, max| SettingKind::Number { min, max };
    vec![
        Setting::hardware(
            "device",
            text.clone(),
            "Dev1/ao0",
            "Name of the analog output in NI MAX.",
        ),
        Setting::new(
            "amplifier_gain",
            number(0.001, 10_000.0),
            "Volts at the display for one volt of the card. Measure it at the carrier's frequency.",
        )
        .with_from_scene(FromScene::Never),
        Setting::new(
            "limit_v",
            number(0.0, 1_000.0),
            "Largest voltage at the display, positive or negative, volts. A sample beyond it is never output.",
        )
        .with_from_scene(FromScene::Less),
        Setting::hardware(
            "dac_full_scale_v",
            number(0.1, 100.0),
            "10",
            "Largest voltage of the card's output, positive or negative, volts.",
        ),
        Setting::hardware(
            "dac_bits",
            number(1.0, 32.0),
            "16",
            "Resolution of the card's output, bits.",
        ),
        Setting::hardware(
            "dc_limit_v",
            number(0.01, 1_000.0),
            "1",
            "Largest direct voltage at the display, positive or negative, volts. The direct \
             voltage is the mean over any 100 ms. Samples that would exceed this limit are not \
             output, and the output goes to zero.",
        )
        .with_from_scene(FromScene::Less),
        Setting::hardware(
            "carrier_hz",
            number(0.0, 100_000.0),
            "7000",
            "Frequency of the carrier, hertz, at most the sample rate divided by 2.5. 0: no \
             carrier; then also set `dc_limit_v`.",
        ),
        Setting::hardware(
            "buffer_ms",
            number(10.0, MOST_TO_ZERO_MS),
            "200",
            "Duration of the samples that are kept ready for the card, milliseconds. A larger \
             buffer is safer, a smaller one has less latency. The sum of `buffer_ms` and `ramp_ms` \
             is at most 400.",
        )
        .with_live_default("20")
        .with_from_scene(FromScene::Less),
        Setting::hardware(
            "ramp_ms",
            number(1.0, MOST_TO_ZERO_MS),
            "20",
            "Duration of the ramps from zero to the first sample and from the last sample to zero, \
             milliseconds. There is no ramp for a sample that is zero. The sum of `buffer_ms` and \
             `ramp_ms` is at most 400.",
        )
        .with_from_scene(FromScene::More),
        Setting::hardware(
            "driver",
            text,
            "",
            "File of the NI-DAQmx library. Empty: the installed library.",
        ),
    ]
}

fn paper() -> Profile {
    profile(
        "pcie-6321_tabor-9200a_sct3250",
        "The rig of Balasubramanian & Vardar (2026). The paper states: NI PCIe-6321, Tabor 9200A, \
         3M SCT3250, carrier 7 kHz, at most 150 V peak at the display. The card has 16 bits and \
         outputs -10 to 10 V. The paper does not state the amplifier's gain. The profile assumes \
         50, so measure yours.",
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
        "A card without an amplifier: -10 to 10 V at the card's output, no carrier, and direct voltage up to 10 V \
         (dc_limit_v). Not for a display that a finger touches.",
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
