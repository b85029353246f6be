//! Tests playback through the simulated card: the output is bit-exact, and zero after errors.

use crate::daq_simulated as simulated;

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::time::Duration;

use htex_device::{Adapter, DeviceError, Output, Quantity, Rates, Settings};
use htex_device_builtin::daq::Daq;
use simulated::{Card, GAIN, PAPER, RATE_HZ};

const LONG: Duration = Duration::from_secs(20);

#[test]
fn what_comes_out_is_what_was_written() {
    let card = Card::new();
    let samples = burst(9_000);
    let mut device = card.open(&[]).unwrap();
    assert_eq!(card.recorded(), [0.0], "an open device is at zero");
    for block in samples.chunks(700) {
        assert_eq!(device.write(block, LONG).unwrap(), block.len());
        let latency_s = device.status().latency_s;
        assert!(latency_s > 0.0 && latency_s <= 0.2, "{latency_s}");
    }
    device.finish().unwrap();
    let status = device.status();
    assert_eq!((status.frames_written, status.frames_played), (9_000, 9_000));
    assert_eq!((status.underruns, status.peak), (0, f64::from(peak(&samples))));
    drop(device);
    // Expected: one zero at opening, half a buffer (200 ms) of zeros, the samples, zeros.
    let recorded = card.recorded();
    let (before, rest) = recorded.split_at(1 + 2_000);
    let (played, after) = rest.split_at(samples.len());
    let volts: Vec<f64> = samples.iter().map(|v| f64::from(*v) / GAIN).collect();
    assert!(played == volts);
    assert!(!after.is_empty() && before.iter().chain(after).all(|v| *v == 0.0));
}

#[test]
fn a_wall_clock_takes_samples_at_its_pace() {
    let card = Card::new();
    card.set("clock", "wall");
    let samples = burst(2_000);
    let mut device = card.open(&[("buffer_ms", "380")]).unwrap();
    assert_eq!(device.write(&samples, LONG).unwrap(), samples.len());
    assert!(device.status().frames_played == 0, "the zeros before are 190 ms long");
    device.finish().unwrap();
    let volts: Vec<f64> = samples.iter().map(|v| f64::from(*v) / GAIN).collect();
    assert!(card.recorded()[1 + 3_800..].starts_with(&volts));
}

#[test]
fn a_stream_that_is_not_zero_at_its_ends_is_led_there() {
    let card = Card::new();
    let mut device = card.open(&[("ramp_ms", "50")]).unwrap();
    device.write(&[100.0; 2_000], LONG).unwrap();
    device.finish().unwrap();
    let recorded = card.recorded();
    let high = recorded.iter().filter(|v| **v == 2.0).count();
    assert_eq!(high, 2_000, "samples are as they were, and none is held longer");
    let steepest = recorded.windows(2).map(|v| (v[1] - v[0]).abs()).fold(0.0, f64::max);
    assert!(steepest <= 2.0 / 1_000.0 + 1e-12, "2 V in 50 ms: {steepest} V a sample");
    assert_eq!((recorded[0], recorded[recorded.len() - 1]), (0.0, 0.0));
}

/// Samples wait no longer than `buffer_ms`, even after a ramp that is longer than the buffer. On a
/// busy machine, a pause of 20 ms may let the stream run dry. The test then tries again.
#[test]
fn a_short_buffer_is_a_short_wait() {
    let played = (0..10).find_map(|_| short_buffer().ok());
    played.expect("a stream that does not run dry in ten attempts");
}

fn short_buffer() -> Result<(), DeviceError> {
    let card = Card::new();
    let short = [("buffer_ms", "20"), ("ramp_ms", "50")];
    let mut device = card.open_blocks(100, &short).unwrap();
    let mut waited = Vec::new();
    for _ in 0..3 {
        device.write(&[100.0; 2_000], LONG)?;
        waited.push(device.status().latency_s);
    }
    device.finish()?;
    assert!(waited.iter().all(|s| *s <= 0.02), "{waited:?}");
    let last_s = device.status().latency_s;
    assert!(last_s > 0.0 && last_s <= 0.02, "{last_s}");
    let recorded = card.recorded();
    assert_eq!(recorded.iter().filter(|v| **v == 2.0).count(), 6_000);
    let steps = recorded.windows(2).map(|v| (v[1] - v[0]).abs());
    assert!(steps.fold(0.0, f64::max) <= 2.0 / 1_000.0 + 1e-12);
    Ok(())
}

#[test]
fn no_sample_beyond_the_limit_comes_out() {
    for wrong in [150.01, -151.0, f32::NAN, f32::INFINITY] {
        let card = Card::new();
        let mut device = card.open(&[]).unwrap();
        device.write(&[150.0; 3_000], LONG).unwrap();
        let error = device.write(&[1.0, wrong, 1.0], LONG).unwrap_err();
        let DeviceError::OverLimit { frame, limit, .. } = error else { unreachable!("{error}") };
        assert_eq!((frame, limit), (3_001, 150.0));
        goes_to_zero(&card);
        is_closed(&mut *device);
        assert!(card.recorded().iter().all(|v| (0.0..=3.0).contains(v)));
    }
}

/// A call may have more samples than the buffer. Its last sample is checked before its first sample
/// is output.
#[test]
fn a_wrong_sample_at_the_end_of_a_long_call_stops_all_of_it() {
    let card = Card::new();
    let mut device = card.open(&[]).unwrap();
    let mut samples = vec![150.0; 100_000];
    samples.push(151.0);
    let error = device.write(&samples, LONG).unwrap_err();
    let DeviceError::OverLimit { frame, .. } = error else { unreachable!("{error}") };
    assert_eq!(frame, 100_000);
    assert!(card.recorded().iter().all(|v| *v == 0.0));
}

/// Returns the largest magnitude of the mean over any 100 ms, volts at the display.
fn direct_v(card: &Card) -> f64 {
    let recorded = card.recorded();
    let window = (0.1 * RATE_HZ) as usize;
    let zeros = vec![0.0; window];
    let all = [&zeros[..], &recorded, &zeros].concat();
    let means = all.windows(window).map(|part| part.iter().sum::<f64>() / window as f64);
    GAIN * means.fold(0.0, |most, mean| mean.abs().max(most))
}

/// Samples whose mean over 100 ms exceeds the limit are not output, whatever the block size. The
/// output goes to zero with an error.
#[test]
fn no_direct_voltage_beyond_the_limit_comes_out() {
    for (volts, limit_v, block) in
        [(100.0, "1", 256), (-100.0, "1", 300), (20.0, "5", 4_000), (1.2, "1", 500)]
    {
        let card = Card::new();
        // A tone without a mean, followed by a tone with one.
        let tone = |i: usize| (40.0 * (TAU * i as f64 / 8.0).sin()) as f32;
        let mut samples: Vec<f32> = (0..8_000).map(tone).collect();
        samples.extend((8_000..20_000).map(|i| tone(i) + volts));
        let mut device = card.open(&[("dc_limit_v", limit_v)]).unwrap();
        let error = samples.chunks(block).find_map(|part| device.write(part, LONG).err());
        let Some(DeviceError::DirectVoltage { frame, mean_v, .. }) = error else {
            unreachable!("{error:?}")
        };
        goes_to_zero(&card);
        is_closed(&mut *device);
        let limit: f64 = limit_v.parse().unwrap();
        assert!(frame >= 8_000 && mean_v.abs() > limit, "{frame} {mean_v}");
        let direct_v = direct_v(&card);
        println!("{volts} V: {direct_v:.3} V came out");
        assert!(direct_v <= limit * (1.0 + 1e-5), "{direct_v}");
    }
    // A mean equal to the limit is output.
    let card = Card::new();
    let mut device = card.open(&[("dc_limit_v", "2")]).unwrap();
    device.write(&[2.0; 9_000], LONG).unwrap();
    device.finish().unwrap();
}

/// A player that begins or ends in the middle of a carrier causes no direct voltage on the way to
/// zero.
#[test]
fn a_carrier_that_is_cut_is_led_to_zero_as_a_carrier() {
    for phase in [0.0, 0.7, 2.0] {
        let card = Card::new();
        let wave = |i: usize| (140.0 * (TAU * 7_000.0 * i as f64 / RATE_HZ + phase).cos()) as f32;
        let samples: Vec<f32> = (0..9_001).map(wave).collect();
        let mut device = card.open(&[("dc_limit_v", "1")]).unwrap();
        device.write(&samples, LONG).unwrap();
        device.finish().unwrap();
        let direct_v = direct_v(&card);
        println!("{direct_v:.3} V");
        assert!(direct_v < 0.5, "{direct_v} V");
        let played = card.recorded();
        let felt = played.iter().filter(|v| **v != 0.0).count();
        assert!(felt > 9_001 + 700, "a ramp at each end: {felt}");
    }
}

/// The device refuses a rate too low for the carrier, and a buffer that would delay the zero.
#[test]
fn what_endangers_a_finger_is_refused() {
    for rate_hz in [7_000.0, 3_500.0, 1_000.0, 7_001.0, 14_000.0, 17_499.0] {
        let card = Card::new();
        let error = card.open_at(rate_hz, &[]).err().unwrap().to_string();
        assert!(error.contains("2.5 times its carrier of 7000 Hz"), "{error}");
        assert!(card.recorded().is_empty());
    }
    let card = Card::new();
    for (buffer_ms, ramp_ms) in [("390", "20"), ("200", "250")] {
        let error = card.open(&[("buffer_ms", buffer_ms), ("ramp_ms", ramp_ms)]);
        assert!(error.err().unwrap().to_string().contains("at most 400 ms together"));
    }
    let fast = Daq.capabilities(&card.settings(&[("carrier_hz", "100000")]));
    let Rates::Range { min_hz, .. } = fast.unwrap().rates else { unreachable!() };
    assert_eq!(min_hz, 250_000.0);
}

#[test]
fn a_hung_writer_ends_at_zero() {
    let card = Card::new();
    let mut device = card.open(&[("buffer_ms", "50")]).unwrap();
    device.write(&[100.0; 800], LONG).unwrap();
    // Without any call, the device's own thread notices that the buffer ran dry.
    let waited = (0..2_000).any(|_| {
        std::thread::sleep(Duration::from_millis(10));
        card.recorded().ends_with(&[2.0, 0.0])
    });
    assert!(waited);
    let error = device.write(&[100.0], LONG).unwrap_err();
    let DeviceError::Underflow { frames, ref advice, .. } = error else { unreachable!("{error}") };
    assert!(advice.contains("`setting buffer_ms=100` (now 50 ms)"), "{advice}");
    assert_eq!((frames, device.status().underruns), (800, 1));
    is_closed(&mut *device);
    assert!(device.finish().is_err());
}

/// A clock that stands still would leave the last voltage at the output. The device's own thread
/// writes zero, whether or not samples are written.
#[test]
fn a_clock_that_stands_still_ends_at_zero() {
    let card = Card::new();
    card.set("clock", "wall");
    let mut device = card.open(&[]).unwrap();
    device.write(&[100.0; 6_000], LONG).unwrap();
    assert_ne!(card.recorded().last(), Some(&0.0));
    card.set("clock", "still");
    let begun = std::time::Instant::now();
    while card.recorded().last() != Some(&0.0) {
        assert!(begun.elapsed() < LONG, "the voltage stays");
        std::thread::sleep(Duration::from_millis(10));
    }
    println!("zero after {:.2} s", begun.elapsed().as_secs_f64());
    let error = device.write(&[100.0], LONG).unwrap_err().to_string();
    assert!(error.contains("stands still"), "{error}");
}

#[test]
fn a_device_dropped_in_the_middle_goes_to_zero() {
    let card = Card::new();
    let mut device = card.open(&[]).unwrap();
    device.write(&[100.0; 9_000], LONG).unwrap();
    drop(device);
    let recorded = card.recorded();
    assert!(recorded.ends_with(&[2.0, 0.0]), "at once, without what was buffered");
    assert!(recorded.len() < 9_000 + 2_000);
}

#[test]
fn an_output_in_use_is_left_to_its_user() {
    let card = Card::new();
    let mut first = card.open(&[]).unwrap();
    let is_busy = || matches!(card.open(&[]), Err(DeviceError::Busy(_)));
    assert!(is_busy(), "from its opening on");
    first.write(&[100.0; 3_000], LONG).unwrap();
    assert!(is_busy());
    first.finish().unwrap();
    assert_eq!(first.status().frames_played, 3_000);
    assert!(card.open(&[]).is_ok());
}

#[test]
fn a_card_pulled_out_is_an_error_that_says_so() {
    let card = Card::new();
    card.set("unplug_after", "4000");
    let mut device = card.open(&[]).unwrap();
    let error = (0..100).find_map(|_| device.write(&[100.0; 500], LONG).err()).unwrap().to_string();
    assert!(error.contains("-88705") && error.contains("could not be set to zero"), "{error}");
    is_closed(&mut *device);
    assert_eq!(card.recorded().len(), 4_000);
    let gone = card.open(&[]).err().unwrap();
    assert!(matches!(gone, DeviceError::Missing(_)), "{gone}");
}

#[test]
fn what_the_rig_can_do() {
    let card = Card::new();
    let can = |given| Daq.capabilities(&card.settings(given));
    let paper = can(&[]).unwrap();
    paper.check().unwrap();
    assert_eq!(paper.quantity, Quantity::DisplayVoltage);
    assert_eq!((paper.limit, paper.carrier_hz, paper.paced), (Some(150.0), Some(7_000.0), true));
    assert_eq!(paper.step, Some(20.0 / 65_536.0 * GAIN));
    let Rates::Range { max_hz, .. } = paper.rates else { unreachable!() };
    assert_eq!((max_hz, paper.default_rate_hz), (900_000.0, RATE_HZ));
    let weak = can(&[("amplifier_gain", "10"), ("carrier_hz", "0")]).unwrap();
    assert_eq!((weak.limit, weak.carrier_hz), (Some(100.0), None), "what the card can reach");
}

#[test]
fn what_is_missing_is_named() {
    let card = Card::new();
    let fast = card.open_at(1e6, &[]).err().unwrap();
    assert!(matches!(fast, DeviceError::Rate { .. }) && fast.to_string().contains("900000"));
    let other = card.open(&[("device", "Dev2/ao0")]).err().unwrap().to_string();
    assert!(
        other.contains("`Dev2/ao0` is not connected; connected is Dev1/ao0, Dev1/ao1"),
        "{other}"
    );
    let none = card.open(&[("driver", "/no/such/library")]).err().unwrap().to_string();
    assert!(
        none.starts_with(
            "setting `driver`: `/no/such/library` cannot be loaded as the NI-DAQmx library: "
        ),
        "{none}"
    );
    if let Err(error) = Daq.endpoints() {
        assert!(error.to_string().contains("ni.com"), "{error}");
    }
}

#[test]
fn gain_and_limit_have_no_default() {
    let none = BTreeMap::new();
    let adapter = Daq;
    let descriptor = adapter.descriptor();
    descriptor.check().unwrap();
    assert!(Settings::resolve(descriptor, None, &none).is_err());
    for profile in [PAPER, "generic"] {
        assert!(Settings::resolve(descriptor, Some(profile), &none).is_ok());
    }
}

/// Returns volts at the display: a 7 kHz carrier under an envelope that begins and ends at zero.
fn burst(frames: usize) -> Vec<f32> {
    let at = |i: usize| {
        let envelope = (0.5 * TAU * i as f64 / (frames - 1) as f64).sin().max(0.0);
        let carrier = (TAU * 7_000.0 * i as f64 / RATE_HZ).cos();
        (120.0 * envelope.sqrt() * carrier) as f32
    };
    let mut samples: Vec<f32> = (0..frames).map(at).collect();
    samples[frames - 1] = 0.0;
    samples
}

fn peak(samples: &[f32]) -> f32 {
    samples.iter().fold(0.0, |peak, v| v.abs().max(peak))
}

fn goes_to_zero(card: &Card) {
    assert_eq!(card.recorded().last(), Some(&0.0));
}

fn is_closed(device: &mut dyn Output) {
    let closed = device.write(&[0.0], LONG).unwrap_err();
    assert!(matches!(closed, DeviceError::Closed(_)), "{closed}");
}
