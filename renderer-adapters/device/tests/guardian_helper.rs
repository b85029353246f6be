//! Tests an app with its own helper program. This program is at the same time the test, the app,
//! and the helper.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::time::{Duration, Instant};

use htex_device::guardian::{GuardedOutput, hold, is_unconfirmed, is_wanted};
use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Devices, Endpoint, FromScene, Output, Quantity,
    Rates, Setting, SettingKind, Settings, Status, StreamFormat,
};

const FORMAT: StreamFormat = StreamFormat { rate_hz: 1_000.0, block_frames: 4 };

/// A sample whose write does not return.
const HANGS: f32 = 8.0;
/// A sample after which closing the device does not return.
const DROP_HANGS: f32 = 9.0;
const LONG: Duration = Duration::from_secs(3600);
/// Longest wait for an answer if a display states neither buffer nor ramp, seconds.
const D_S: f64 = 1.0;
/// Additional time on a busy machine, seconds.
const BUSY_S: f64 = 10.0;

/// A display whose output is written to a file as lines.
struct Bench(Descriptor);

struct Open {
    log: String,
    frames: usize,
    drop_hangs: bool,
}

impl Drop for Open {
    fn drop(&mut self) {
        if self.drop_hangs {
            std::thread::sleep(LONG);
        }
    }
}

impl Bench {
    fn devices() -> Devices {
        let setting = Setting::new("log", SettingKind::Text, "The file.");
        let setting = setting.with_from_scene(FromScene::Never);
        Devices::new(vec![Arc::new(Self(Descriptor {
            id: "org.example.bench".to_owned(),
            name: "Bench".to_owned(),
            version: "1.0.0".to_owned(),
            summary: "A display of the test.".to_owned(),
            settings: vec![setting],
            ..Descriptor::default()
        }))])
    }
}

impl Adapter for Bench {
    fn descriptor(&self) -> &Descriptor {
        &self.0
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        Ok(vec![])
    }

    fn capabilities(&self, _: &Settings) -> Result<Capabilities, DeviceError> {
        Ok(Capabilities {
            quantity: Quantity::DisplayVoltage,
            rates: Rates::List(vec![FORMAT.rate_hz]),
            default_rate_hz: FORMAT.rate_hz,
            limit: Some(10.0),
            step: None,
            carrier_hz: None,
            paced: true,
            block_frames: FORMAT.block_frames,
        })
    }

    fn open_output(
        &self,
        s: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        if *format != FORMAT {
            return Err(DeviceError::Missing("no such clock".to_owned()));
        }
        let log = s.text("log").to_owned();
        say(&log, "opened at zero");
        Ok(Box::new(Open { log, frames: 0, drop_hangs: false }))
    }
}

impl Output for Open {
    fn write(&mut self, samples: &[f32], _: Duration) -> Result<usize, DeviceError> {
        if samples == [HANGS] {
            std::thread::sleep(LONG);
        }
        self.drop_hangs = samples == [DROP_HANGS];
        say(&self.log, &format!("{samples:?}"));
        self.frames += samples.len();
        Ok(samples.len())
    }

    fn status(&self) -> Status {
        Status { frames_written: self.frames as u64, ..Status::default() }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        say(&self.log, "played to zero");
        Ok(())
    }
}

fn say(log: &str, line: &str) {
    let file = OpenOptions::new().create(true).append(true).open(log);
    writeln!(file.unwrap(), "{line}").unwrap();
}

/// Runs this program in another of its roles.
fn this(part: &str) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.arg(part);
    command
}

fn guarded(log: &str, format: &StreamFormat, helper: &str) -> Result<GuardedOutput, DeviceError> {
    let devices = Bench::devices();
    let known = devices.find_output("bench").unwrap();
    let given = [("log".to_owned(), log.to_owned())].into();
    let settings = Settings::resolve(known.descriptor(), None, &given).unwrap();
    assert!(is_wanted(&known.adapter.capabilities(&settings).unwrap()));
    GuardedOutput::open(known, &settings, format, this(helper))
}

fn lines(log: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(log).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

fn an_app_plays_through_its_helper(log: &Path) {
    let mut device = guarded(&log.display().to_string(), &FORMAT, "helper").unwrap();
    assert_eq!(device.write(&[1.0, 2.0], Duration::ZERO).unwrap(), 2);
    assert_eq!(device.status().frames_written, 2);
    device.finish().unwrap();
    assert!(matches!(device.finish(), Err(DeviceError::Closed(_))));
    assert_eq!(lines(log), ["opened at zero", "[1.0, 2.0]", "played to zero"]);
}

fn an_app_that_aborts_leaves_zero(log: &Path) {
    let ended = this("app").arg(log).status().unwrap();
    assert!(!ended.success());
    let begun = Instant::now();
    while lines(log).len() < 3 && begun.elapsed() < Duration::from_secs(10) {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(lines(log), ["opened at zero", "[3.0]", "played to zero"]);
}

fn errors_of_the_helper_are_those_of_the_app(log: &Path) {
    let log_text = log.display().to_string();
    let other = StreamFormat { block_frames: 5, ..FORMAT };
    let refused = guarded(&log_text, &other, "helper").err().unwrap();
    assert_eq!(refused.to_string(), "no such clock");
    // If the helper ends at once, the app itself opens the device, which is then at zero.
    let gone = guarded(&log_text, &FORMAT, "nothing").err().unwrap();
    assert!(gone.to_string().contains("the output was set to zero"));
    assert_eq!(lines(log), ["opened at zero"]);
}

/// A helper that does not answer is killed. A second helper opens the device, which sets the output
/// to zero.
fn a_helper_that_hangs_is_replaced_by_zero(log: &Path) {
    let mut device = guarded(&log.display().to_string(), &FORMAT, "helper").unwrap();
    let begun = Instant::now();
    let error = device.write(&[HANGS], Duration::from_secs(60)).unwrap_err();
    let waited = begun.elapsed().as_secs_f64();
    let error = error.to_string();
    assert!(error.contains("did not answer within 1.00 s"), "{error}");
    assert!((D_S..D_S + BUSY_S).contains(&waited), "{waited} s");
    second_helper_ends(log);
    assert_eq!(lines(log)[..2], ["opened at zero", "opened at zero"]);
    let closed = device.write(&[1.0], Duration::ZERO).unwrap_err();
    assert!(matches!(closed, DeviceError::Closed(_)), "{closed}");
}

fn second_helper_ends(log: &Path) {
    let begun = Instant::now();
    while is_unconfirmed() || lines(log).last().is_none_or(|line| line != "played to zero") {
        assert!(begun.elapsed().as_secs_f64() < BUSY_S, "{:?}", lines(log));
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Dropping a device waits at most D, whatever its helper does.
fn a_device_is_dropped_in_time(log: &Path) {
    let mut device = guarded(&log.display().to_string(), &FORMAT, "helper").unwrap();
    device.write(&[DROP_HANGS], Duration::ZERO).unwrap();
    let begun = Instant::now();
    drop(device);
    let waited = begun.elapsed().as_secs_f64();
    println!("dropped after {waited:.2} s");
    assert!(waited < D_S + BUSY_S, "{waited} s");
    second_helper_ends(log);
    let zeros = lines(log).iter().filter(|line| *line == "opened at zero").count();
    assert_eq!(zeros, 2, "the second helper opens it");
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.first().map(String::as_str) {
        Some("helper") => {
            let devices = Bench::devices();
            let (from, to) = (std::io::stdin().lock(), std::io::stdout().lock());
            hold(|id| devices.find_output(id).cloned(), from, to);
        }
        Some("app") => {
            let mut device = guarded(&arguments[1], &FORMAT, "helper").unwrap();
            device.write(&[3.0], Duration::ZERO).unwrap();
            std::process::abort();
        }
        Some("nothing") => {}
        // The role of the test, with or without a filter of the test runner.
        _ => {
            for test in [
                an_app_plays_through_its_helper,
                an_app_that_aborts_leaves_zero,
                errors_of_the_helper_are_those_of_the_app,
                a_helper_that_hangs_is_replaced_by_zero,
                a_device_is_dropped_in_time,
            ] {
                let folder = tempfile::tempdir().unwrap();
                test(&folder.path().join("log"));
            }
        }
    }
}
