//! Checks the rules for `.hjif` files. Some rules are limits of this reader. All other rules are
//! from the conformance check of the reference software (source/IOHaptics/src/IOJson.cpp,
//! `semanticConformanceCheck…`). Only the parts of a file that this reader reads are checked.

mod band;

use std::collections::BTreeSet;

use super::{Channel, Hjif, Perception, ReferenceDevice};
use crate::error::Fault;
use crate::json::within;

/// Highest timescale: first in the profile Main, then in the profile Simple Parametric.
const MOST_TIMESCALE: f64 = 48_000.0;
const PARAMETRIC_TIMESCALE: f64 = 1_000.0;
/// Largest position, in ticks.
const MOST_TICKS: f64 = 4_294_967_295.0;
/// Highest frequency of a band, in hertz or waves per metre.
const MOST_HZ: f64 = 1e7;
/// Largest gain of a channel.
const MOST_GAIN: f64 = 1e6;
/// Largest number of channels in a perception and of bands in a channel. In each array, the first
/// number is for level 1 and the second for level 2.
const MOST_CHANNELS: [usize; 2] = [128, 65_536];
const MOST_BANDS: [usize; 2] = [7, 65_536];

/// The profile and level of a file.
#[derive(Clone, Copy)]
struct Kind {
    is_parametric: bool,
    most_channels: usize,
    most_bands: usize,
}

pub(super) fn check(hjif: &Hjif) -> Result<(), Fault> {
    let kind = Kind::new(hjif)?;
    let timescales = if kind.is_parametric {
        PARAMETRIC_TIMESCALE..=PARAMETRIC_TIMESCALE
    } else {
        1.0..=MOST_TIMESCALE
    };
    let timescale = f64::from(hjif.timescale);
    within(|| "/timescale".to_owned(), "the timescale", timescale, timescales)?;
    if hjif.perceptions.is_empty() {
        let problem = "there is no perception; a file has one or more";
        return Err(Fault::new("/perceptions", problem));
    }
    unique("/perceptions", hjif.perceptions.iter().map(|p| Some(p.id)))?;
    for (index, perception) in hjif.perceptions.iter().enumerate() {
        check_perception(perception, kind, &format!("/perceptions/{index}"))?;
    }
    if hjif.chosen().is_some() {
        return Ok(());
    }
    let modalities = hjif.perceptions.iter().map(|p| &p.perception_modality[..]);
    let there: BTreeSet<&str> = modalities.collect();
    let there = Vec::from_iter(there).join(", ");
    let problem = format!("no perception vibrates: they are {there}");
    Err(Fault::new("/perceptions", problem))
}

impl Kind {
    fn new(hjif: &Hjif) -> Result<Self, Fault> {
        let is_parametric = match &hjif.profile[..] {
            "Main" => false,
            "Simple Parametric" => true,
            other => {
                let problem =
                    format!("there is no profile {other:?}; there are Main and Simple Parametric");
                return Err(Fault::new("/profile", problem));
            }
        };
        let level = f64::from(hjif.level);
        within(|| "/level".to_owned(), "the level", level, 1.0..=2.0)?;
        let of_level = |[first, second]: [usize; 2]| if hjif.level == 1 { first } else { second };
        Ok(Self {
            is_parametric,
            most_channels: of_level(MOST_CHANNELS),
            most_bands: of_level(MOST_BANDS),
        })
    }
}

fn check_perception(perception: &Perception, kind: Kind, at: &str) -> Result<(), Fault> {
    let exponent = f64::from(perception.unit_exponent);
    let of = || format!("{at}/unit_exponent");
    within(of, "the exponent", exponent, -9.0..=3.0)?;
    let devices = &perception.reference_devices;
    unique(&format!("{at}/reference_devices"), devices.iter().map(|d| Some(d.id)))?;
    for (index, device) in devices.iter().enumerate() {
        check_device(device, &format!("{at}/reference_devices/{index}"))?;
    }
    let library = &perception.effect_library;
    unique(&format!("{at}/effect_library"), library.iter().map(|e| e.id))?;
    for (index, effect) in library.iter().enumerate() {
        band::check_effect(effect, &format!("{at}/effect_library/{index}"))?;
    }
    let channels = &perception.channels;
    let of = || format!("{at}/channels");
    let most = kind.most_channels as f64;
    within(of, "the number of channels", channels.len() as f64, 0.0..=most)?;
    unique(&of(), channels.iter().map(|c| Some(c.id)))?;
    let known: BTreeSet<i64> = band::basis_ids(library);
    let devices: BTreeSet<i64> = devices.iter().map(|device| device.id).collect();
    for (index, channel) in channels.iter().enumerate() {
        let at = format!("{at}/channels/{index}");
        check_channel(channel, &devices, &at)?;
        let most = kind.most_bands as f64;
        let count = channel.bands.len() as f64;
        within(|| format!("{at}/bands"), "the number of bands", count, 0.0..=most)?;
        for (index, band) in channel.bands.iter().enumerate() {
            band::check(band, &known, kind.is_parametric, &format!("{at}/bands/{index}"))?;
        }
    }
    Ok(())
}

fn check_channel(channel: &Channel, devices: &BTreeSet<i64>, at: &str) -> Result<(), Fault> {
    let gain = || format!("{at}/gain");
    within(gain, "the gain", channel.gain, -MOST_GAIN..=MOST_GAIN)?;
    let mixing = channel.mixing_coefficient;
    let of = || format!("{at}/mixing_coefficient");
    within(of, "the coefficient", mixing, 0.0..=MOST_GAIN)?;
    match channel.reference_device_id {
        Some(id) if !devices.contains(&id) => Err(Fault::new(
            format!("{at}/reference_device_id"),
            format!("there is no reference device {id}"),
        )),
        _ => Ok(()),
    }
}

/// Checks that the frequencies of a device ascend: minimum, resonance, maximum.
fn check_device(device: &ReferenceDevice, at: &str) -> Result<(), Fault> {
    let frequencies = [
        ("minimum_frequency", device.minimum_frequency),
        ("resonance_frequency", device.resonance_frequency),
        ("maximum_frequency", device.maximum_frequency),
    ];
    let mut least = 0.0;
    for (key, frequency) in frequencies {
        if let Some(hertz) = frequency {
            within(|| format!("{at}/{key}"), "the frequency", hertz, least..=MOST_HZ)?;
            least = hertz;
        }
    }
    Ok(())
}

/// Returns a fault if an id occurs twice.
fn unique(at: &str, ids: impl Iterator<Item = Option<i64>>) -> Result<(), Fault> {
    let mut known = BTreeSet::new();
    for (index, id) in ids.enumerate() {
        if let Some(id) = id
            && !known.insert(id)
        {
            let problem = format!("another one has the id {id}; give each its own");
            return Err(Fault::new(format!("{at}/{index}/id"), problem));
        }
    }
    Ok(())
}
