//! Tests which calls a motor gets and when, and that it is always at rest at the end.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use htex_device::{Descriptor, DeviceError, Output, Settings, StreamFormat};
use htex_device_builtin::motor::{Block, Motor, PacedOutput, Plan, reducing_settings};

const RATE_HZ: f64 = 8_000.0;
const LONG: Duration = Duration::from_secs(5);

/// A call to the motor.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Told {
    Play { after: Duration, level: f64, frames: usize },
    End,
    Stop,
    Closed,
}

#[derive(Clone)]
struct Log {
    since: Instant,
    told: Arc<Mutex<Vec<Told>>>,
    /// Index of the block that fails, from 0.
    fails_at: usize,
}

impl Log {
    fn new(fails_at: usize) -> Self {
        Self { since: Instant::now(), told: Arc::default(), fails_at }
    }

    fn all(&self) -> Vec<Told> {
        self.told.lock().unwrap().clone()
    }

    fn plays(&self) -> Vec<(Duration, f64, usize)> {
        let play = |told: Told| match told {
            Told::Play { after, level, frames } => Some((after, level, frames)),
            _ => None,
        };
        self.all().into_iter().filter_map(play).collect()
    }

    fn ends_with(&self, told: &[Told]) -> bool {
        self.all().ends_with(told)
    }

    fn open(&self, settings: &[(&str, &str)]) -> PacedOutput {
        let plan = plan(settings);
        let format = StreamFormat { rate_hz: RATE_HZ, block_frames: 64 };
        let motor = Box::new(Logged(self.clone()));
        PacedOutput::open("Motor", motor, &plan, plan.capabilities(), &format).unwrap()
    }
}

struct Logged(Log);

impl Motor for Logged {
    fn play(&mut self, block: &Block<'_>) -> Result<(), String> {
        let mut told = self.0.told.lock().unwrap();
        if told.len() == self.0.fails_at {
            return Err("the cable is loose".to_owned());
        }
        told.push(Told::Play {
            after: self.0.since.elapsed(),
            level: block.measured.level_rms,
            frames: block.samples.len(),
        });
        Ok(())
    }

    fn end(&mut self) -> Result<(), String> {
        self.0.told.lock().unwrap().push(Told::End);
        Ok(())
    }

    fn stop(&mut self) -> Result<(), String> {
        self.0.told.lock().unwrap().push(Told::Stop);
        Ok(())
    }
}

impl Drop for Logged {
    fn drop(&mut self) {
        self.0.told.lock().unwrap().push(Told::Closed);
    }
}

fn plan(settings: &[(&str, &str)]) -> Plan {
    let descriptor = Descriptor {
        id: "org.example.motor".to_owned(),
        name: "Motor".to_owned(),
        version: "1.0.0".to_owned(),
        summary: "A motor.".to_owned(),
        settings: reducing_settings(),
        ..Descriptor::default()
    };
    descriptor.check().unwrap();
    let given: BTreeMap<String, String> =
        settings.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    Plan::new(&Settings::resolve(&descriptor, None, &given).unwrap())
}

fn write_all(device: &mut PacedOutput, samples: &[f32]) {
    assert_eq!(device.write(samples, LONG), Ok(samples.len()));
}

#[test]
fn blocks_come_at_the_pace_of_the_clock_and_the_end_is_rest() {
    let log = Log::new(usize::MAX);
    let mut device = log.open(&[]);
    let levels = [0.5_f32, 0.25, 0.0, 1.0];
    for level in levels {
        write_all(&mut device, &[level; 800]);
    }
    // An incomplete block.
    write_all(&mut device, &[0.5; 40]);
    assert!(device.status().latency_s > 0.0);
    device.finish().unwrap();
    let status = device.status();
    assert_eq!((status.frames_written, status.frames_played), (3_240, 3_240));
    assert_eq!((status.underruns, status.latency_s, status.peak), (0, 0.0, 1.0));
    let plays = log.plays();
    assert_eq!(plays.len(), 41);
    assert_eq!(plays[40].2, 40);
    for (i, (_, level, _)) in plays[..40].iter().enumerate() {
        assert!((level - f64::from(levels[i / 10])).abs() < 1e-6, "{i} {level}");
    }
    // 400 ms in total. On a loaded machine the thread may be late, and catches up by at most one
    // block.
    assert!(plays[40].0.saturating_sub(plays[0].0) >= Duration::from_millis(385));
    assert!(log.ends_with(&[Told::End, Told::Closed]));
    let closed = device.write(&[0.0], LONG).unwrap_err();
    assert!(matches!(closed, DeviceError::Closed(_)), "{closed}");
    assert!(matches!(device.finish(), Err(DeviceError::Closed(_))));
}

#[test]
fn a_dropped_device_rests_at_once() {
    let log = Log::new(usize::MAX);
    let mut device = log.open(&[("buffer_ms", "10000"), ("block_ms", "100")]);
    write_all(&mut device, &[0.5; 48_000]);
    let since = Instant::now();
    drop(device);
    assert!(since.elapsed() < Duration::from_millis(90), "it waits for a block");
    assert!(log.ends_with(&[Told::Stop, Told::Closed]));
}

#[test]
fn a_sample_over_the_limit_rests_at_once() {
    for bad in [1.5, f32::NAN, f32::INFINITY] {
        let log = Log::new(usize::MAX);
        let mut device = log.open(&[]);
        write_all(&mut device, &[0.5; 700]);
        let error = device.write(&[0.5, bad], LONG).unwrap_err();
        assert!(matches!(error, DeviceError::OverLimit { frame: 701, .. }), "{error}");
        assert!(log.ends_with(&[Told::Stop, Told::Closed]));
        assert!(matches!(device.finish(), Err(DeviceError::Closed(_))));
    }
}

/// If the writer hangs, the thread stops the motor by itself.
#[test]
fn a_device_that_runs_dry_rests_and_says_so() {
    let log = Log::new(usize::MAX);
    let mut device = log.open(&[]);
    write_all(&mut device, &[0.5; 500]);
    let since = Instant::now();
    while !log.ends_with(&[Told::Stop, Told::Closed]) {
        assert!(since.elapsed() < LONG, "{:?}", log.all());
        std::thread::sleep(Duration::from_millis(1));
    }
    assert_eq!(log.plays().len(), 6, "a block that is not full is not played");
    let error = device.write(&[0.5; 80], LONG).unwrap_err();
    assert!(matches!(error, DeviceError::Underflow { frames: 480, .. }), "{error}");
    assert!(error.to_string().contains("buffer_ms"));
    assert!(matches!(device.write(&[0.5], LONG), Err(DeviceError::Closed(_))));
    assert_eq!(device.status().underruns, 1);
}

#[test]
fn a_motor_that_fails_is_stopped_and_its_reason_is_told_once() {
    let log = Log::new(3);
    let mut device = log.open(&[]);
    let since = Instant::now();
    let error = loop {
        match device.write(&[0.5; 80], LONG) {
            Ok(_) => assert!(since.elapsed() < LONG),
            Err(error) => break error,
        }
    };
    assert_eq!(error.to_string(), "Motor failed: the cable is loose");
    assert!(log.ends_with(&[Told::Stop, Told::Closed]));
    assert!(matches!(device.finish(), Err(DeviceError::Closed(_))));
}

/// A write with a timeout of zero takes the samples that fit. A write that may wait returns when
/// there is space again.
#[test]
fn a_write_takes_what_fits() {
    let log = Log::new(usize::MAX);
    let mut device = log.open(&[("buffer_ms", "20")]);
    assert_eq!(device.write(&[0.1; 1_000], Duration::ZERO), Ok(160));
    assert_eq!(device.write(&[], Duration::ZERO), Ok(0));
    let since = Instant::now();
    let taken = device.write(&[0.1; 100_000], Duration::from_millis(50)).unwrap();
    assert!(since.elapsed() >= Duration::from_millis(50) && taken >= 160, "{taken}");
    assert_eq!(device.status().frames_written, 160 + taken as u64);
}

#[test]
fn nothing_written_is_rest_too() {
    let log = Log::new(usize::MAX);
    let mut device = log.open(&[]);
    device.finish().unwrap();
    assert_eq!(log.all(), [Told::End, Told::Closed]);
}

#[test]
fn a_rate_that_it_does_not_have_is_refused() {
    let plan = plan(&[]);
    let format = StreamFormat { rate_hz: 1_000.0, block_frames: 64 };
    let motor = Box::new(Logged(Log::new(0)));
    let refused = PacedOutput::open("Motor", motor, &plan, plan.capabilities(), &format);
    assert!(matches!(refused.err().unwrap(), DeviceError::Rate { .. }));
}
