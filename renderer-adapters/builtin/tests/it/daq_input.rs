//! Analog input through the simulated card: every sample arrives once, and errors have the right
//! type.

use crate::daq_simulated as simulated;

use std::time::Duration;

use htex_device::{Adapter, Channel, DeviceError, Input, InputFrames, InputStream};
use htex_device_builtin::daq::DaqInput;
use simulated::Card;

const LONG: Duration = Duration::from_secs(20);
const FUNCTIONS: [&str; 9] = [
    "DAQmxCreateTask",
    "DAQmxCreateAIVoltageChan",
    "DAQmxCfgSampClkTiming",
    "DAQmxCfgInputBuffer",
    "DAQmxStartTask",
    "DAQmxStopTask",
    "DAQmxClearTask",
    "DAQmxGetReadAvailSampPerChan",
    "DAQmxReadAnalogF64",
];

/// Returns rows of six inputs whose values encode their position, within ±5 V.
fn rows(count: usize) -> Vec<Vec<f64>> {
    let at = |row: usize, input: usize| ((row * 7 + input) % 1_000) as f64 / 200.0;
    (0..count).map(|row| (0..6).map(|input| at(row, input)).collect()).collect()
}

/// Reads `frames` frames in pieces of uneven length.
fn read(source: &mut dyn Input, frames: usize) -> Result<Vec<f64>, DeviceError> {
    let width = source.stream().channels.len();
    let mut all = Vec::new();
    for block in [1, 7, 300, 4_096].iter().cycle() {
        let most = (*block).min(frames - all.len() / width);
        let mut samples = vec![0.0; most * width];
        match source.read(&mut samples, LONG)? {
            InputFrames::Count(got) => all.extend(&samples[..got * width]),
            InputFrames::End => break,
        }
        if all.len() == frames * width {
            break;
        }
    }
    Ok(all)
}

#[test]
fn every_sample_is_read_once_and_in_order() {
    let card = Card::new();
    let rows = rows(5_000);
    card.put_in(&rows);
    let mut source = card.open_input(&[("channels", "Dev1/ai0:1,Dev1/ai4")]).unwrap();
    let names = ["ai0", "ai1", "ai4"].map(|name| Channel::new(name, "V"));
    assert_eq!(*source.stream(), InputStream { rate_hz: 20_000.0, channels: names.to_vec() });
    let closed = source.read(&mut [0.0; 3], LONG).unwrap_err();
    assert!(matches!(closed, DeviceError::Closed(_)), "before the start: {closed}");
    source.start().unwrap();
    let expected: Vec<f64> = rows.iter().flat_map(|row| [row[0], row[1], row[4]]).collect();
    assert!(read(&mut *source, 5_000).unwrap() == expected);
    source.finish().unwrap();
    let closed = source.read(&mut [0.0; 3], LONG).unwrap_err();
    assert!(matches!(closed, DeviceError::Closed(_)), "{closed}");
}

#[test]
fn a_range_that_is_too_small_clips_as_the_card_does() {
    let card = Card::new();
    card.put_in(&vec![vec![4.0, -4.0]; 100]);
    let mut source = card.open_input(&[("channels", "Dev1/ai0:1"), ("range_v", "1")]).unwrap();
    source.start().unwrap();
    assert_eq!(read(&mut *source, 2).unwrap(), [1.0, -1.0, 1.0, -1.0]);
    let error = card.open_input(&[("range_v", "20")]).err().unwrap().to_string();
    assert!(error.contains("-200077"), "{error}");
}

#[test]
fn samples_that_are_read_too_late_are_an_overrun() {
    let card = Card::new();
    let mut source = card.open_input(&[("buffer_s", "0.5")]).unwrap();
    source.start().unwrap();
    assert_eq!(read(&mut *source, 1_000).unwrap().len(), 6_000);
    card.set("late_s", "0.4");
    assert_eq!(read(&mut *source, 8_000).unwrap().len(), 48_000, "the buffer holds half a second");
    card.set("late_s", "0.6");
    let error = read(&mut *source, 1).unwrap_err();
    let DeviceError::Overrun { frames, ref advice, .. } = error else { unreachable!("{error}") };
    assert!(
        frames == 9_000 && advice.contains("-200279") && advice.contains("`buffer_s` (now 0.5 s)"),
        "{error}"
    );
    let closed = read(&mut *source, 1).unwrap_err();
    assert!(matches!(closed, DeviceError::Closed(_)), "{closed}");
    source.finish().unwrap();
}

#[test]
fn a_card_pulled_out_is_an_error_that_says_so() {
    let card = Card::new();
    card.set("unplug_after", "4000");
    let mut source = card.open_input(&[]).unwrap();
    source.start().unwrap();
    let error = read(&mut *source, 5_000).unwrap_err();
    assert!(
        matches!(error, DeviceError::Failed { .. }) && error.to_string().contains("-88705"),
        "{error}"
    );
    let gone = card.open_input(&[]).err().unwrap();
    assert!(matches!(gone, DeviceError::Missing(_)), "{gone}");
}

#[test]
fn inputs_that_are_not_there_in_use_or_too_fast_are_named() {
    let card = Card::new();
    let error = |given| card.open_input(given).err().unwrap();
    let missing = error(&[("channels", "Dev2/ai0")]);
    assert!(
        matches!(missing, DeviceError::Missing(_))
            && missing.to_string().contains("`Dev2/ai0` is not connected; Dev1/ai0, "),
        "{missing}"
    );
    let fast = error(&[("rate_hz", "50000")]);
    assert!(
        matches!(fast, DeviceError::Rate { .. }) && fast.to_string().contains("6 channels"),
        "{fast}"
    );
    assert!(matches!(error(&[("channels", "Dev1/ao0")]), DeviceError::Setting { .. }));
    assert!(matches!(error(&[("driver", "/no/such/library")]), DeviceError::Setting { .. }));
    let mut first = card.open_input(&[]).unwrap();
    first.start().unwrap();
    let mut second = card.open_input(&[]).unwrap();
    let busy = second.start().unwrap_err();
    assert!(matches!(busy, DeviceError::Busy(_)), "{busy}");
    assert_eq!(read(&mut *first, 100).unwrap().len(), 600, "the first goes on");
}

#[test]
fn outputs_play_while_inputs_are_read() {
    let card = Card::new();
    let mut source = card.open_input(&[]).unwrap();
    source.start().unwrap();
    let mut device = card.open(&[]).unwrap();
    device.write(&[100.0; 3_000], LONG).unwrap();
    assert_eq!(read(&mut *source, 500).unwrap().len(), 3_000);
    device.finish().unwrap();
    assert_eq!(device.status().frames_played, 3_000);
}

#[test]
fn every_fault_at_every_call_is_an_error_or_harms_no_sample() {
    let rows = rows(400);
    let expected: Vec<f64> = rows.concat();
    let run = |card: &Card| {
        let mut source = card.open_input(&[])?;
        source.start()?;
        let samples = read(&mut *source, 400)?;
        source.finish().map(|()| samples)
    };
    let card = Card::new();
    card.set("fault", "none:1:error=0");
    run(&card).unwrap();
    let mut tried = 0;
    for function in FUNCTIONS {
        for call in 1..=card.calls(function).min(8) {
            for kind in ["error=-200077", "error=-50103", "error=-200279", "unplug"] {
                let card = Card::new();
                card.put_in(&rows);
                card.set("fault", &format!("{function}:{call}:{kind}"));
                let read = run(&card);
                // Clearing a task comes after its last sample, so an error there changes no sample.
                let is_end = function == "DAQmxClearTask";
                match read {
                    Ok(samples) => assert!(
                        samples == expected && (is_end || function == "DAQmxStopTask"),
                        "{function}:{call}:{kind}"
                    ),
                    Err(error) => assert!(error.to_string().contains('-'), "{error}"),
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 60, "{tried}");
}

#[test]
fn the_descriptor_is_sound() {
    DaqInput.descriptor().check().unwrap();
}
