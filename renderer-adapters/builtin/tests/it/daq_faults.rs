//! Injects every fault at every driver call. The output must end at zero, or an error must say that
//! it may not be at zero.

use crate::daq_simulated as simulated;

use std::time::Duration;

use htex_device::DeviceError;
use simulated::Card;

const LONG: Duration = Duration::from_secs(20);
/// The driver functions that are called while a device is open.
const FUNCTIONS: [&str; 13] = [
    "DAQmxCreateTask",
    "DAQmxCreateAOVoltageChan",
    "DAQmxCfgSampClkTiming",
    "DAQmxCfgOutputBuffer",
    "DAQmxSetWriteRegenMode",
    "DAQmxStartTask",
    "DAQmxStopTask",
    "DAQmxClearTask",
    "DAQmxIsTaskDone",
    "DAQmxGetWriteSpaceAvail",
    "DAQmxGetWriteTotalSampPerChanGenerated",
    "DAQmxWriteAnalogF64",
    "DAQmxResetDevice",
];
const NOT_ZERO: &str = "could not be set to zero: switch the amplifier off";

/// Plays a burst that ends at two volts of the card, so that the device has to bring the output to
/// zero.
fn play(card: &Card) -> Result<(), DeviceError> {
    play_with("50", card)
}

fn play_with(buffer_ms: &str, card: &Card) -> Result<(), DeviceError> {
    let mut device = card.open(&[("buffer_ms", buffer_ms), ("ramp_ms", "5")])?;
    for _ in 0..3 {
        device.write(&[100.0; 700], LONG)?;
    }
    device.finish()
}

/// Plays the same burst, but drops the device in the middle.
fn abandon(card: &Card) {
    if let Ok(mut device) = card.open(&[("buffer_ms", "50"), ("ramp_ms", "5")]) {
        let _ = device.write(&[100.0; 900], LONG);
    }
}

fn ends_at_zero(card: &Card) -> bool {
    card.recorded().last().is_none_or(|volts| *volts == 0.0)
}

/// Counts the calls of each function in a run without a fault.
fn calls(run: impl Fn(&Card)) -> Vec<(&'static str, u64)> {
    let card = Card::new();
    card.set("fault", "none:1:error=0");
    run(&card);
    FUNCTIONS.map(|function| (function, card.calls(function))).to_vec()
}

/// Selects the first calls, some calls in the middle, and the last calls.
fn some(count: u64) -> impl Iterator<Item = u64> {
    (1..=count + 1).filter(move |call| *call <= 4 || *call + 3 >= count || call % 16 == 0)
}

#[test]
fn every_fault_at_every_call_ends_at_zero_or_says_so() {
    let (mut tried, mut said) = (0, 0);
    for (function, count) in calls(|card| play(card).unwrap()) {
        for call in some(count) {
            let kinds = ["error=-200077", "error=-50103", "error=-200290", "unplug"];
            let writes = ["short=0", "short=-200292"];
            let is_write = function == "DAQmxWriteAnalogF64";
            let kinds = kinds.iter().chain(writes.iter().filter(|_| is_write));
            for (kind, lasts) in kinds.flat_map(|kind| [(kind, ""), (kind, "+")]) {
                let fault = format!("{function}:{call}{lasts}:{kind}");
                let card = Card::new();
                card.set("fault", &fault);
                let played = play(&card);
                let told = played.as_ref().is_err_and(|error| error.to_string().contains(NOT_ZERO));
                assert!(ends_at_zero(&card) || told, "{fault}: {played:?}");
                // A warning without cause is wrong, except if the last write of zero succeeded but
                // reported a failure.
                tried += 1;
                said += usize::from(told);
                // A single fault never leaves a voltage, unless the card was removed.
                assert!(!lasts.is_empty() || *kind == "unplug" || ends_at_zero(&card), "{fault}");
            }
        }
    }
    println!("{tried} faults, {said} of them said that the output is not at zero");
    assert!(said > 0 && tried > 300, "{tried} {said}");
}

#[test]
fn a_device_that_is_dropped_ends_at_zero_whatever_fails_once() {
    for (function, count) in calls(abandon) {
        for call in some(count) {
            for kind in ["error=-200077", "error=-50103", "short=0", "short=-200292"] {
                let fault = format!("{function}:{call}:{kind}");
                let card = Card::new();
                card.set("fault", &fault);
                abandon(&card);
                assert!(ends_at_zero(&card), "{fault}");
            }
        }
    }
}

/// If the driver hangs in one call for a while, the output still goes to zero, but late.
#[test]
fn a_driver_that_hangs_in_a_call_comes_to_zero_late() {
    for function in FUNCTIONS {
        let card = Card::new();
        card.set("fault", &format!("{function}:2:hang=300"));
        let _ = play(&card);
        assert!(ends_at_zero(&card), "{function}");
    }
}

/// If a call of a running stream hangs, the output goes to zero long before the call returns,
/// without the session that the call holds. When the call returns, the stream ends and outputs
/// nothing more.
#[test]
fn a_call_that_does_not_return_is_overtaken_by_zero() {
    let begins = std::time::Instant::now;
    for function in [
        "DAQmxIsTaskDone",
        "DAQmxGetWriteSpaceAvail",
        "DAQmxGetWriteTotalSampPerChanGenerated",
        "DAQmxWriteAnalogF64",
    ] {
        let card = Card::new();
        card.set("clock", "wall");
        card.set("fault", &format!("{function}:6:hang=4000"));
        std::thread::scope(|scope| {
            let begun = begins();
            // A buffer large enough not to run dry on a busy machine.
            let play = scope.spawn(|| play_with("380", &card));
            let is_felt = || card.recorded().iter().any(|volts| *volts != 0.0);
            while !(is_felt() && ends_at_zero(&card)) {
                assert!(!play.is_finished(), "{function}: it returned first");
                std::thread::sleep(Duration::from_millis(10));
            }
            println!("{function}: zero after {:.2} s", begun.elapsed().as_secs_f64());
            let error = play.join().unwrap().unwrap_err().to_string();
            assert!(error.contains("has not returned"), "{function}: {error}");
            assert!(ends_at_zero(&card), "{function}");
        });
    }
}
