//! Tests with a virtual joystick of SDL, whose motors record the strengths that they are set to
//! (`pad.c`).

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use htex_device::{Adapter, DeviceError, Output, Quantity, Settings, StreamFormat};
use htex_device_builtin::sdl::Sdl;

const RATE_HZ: f64 = 8_000.0;
const LONG: Duration = Duration::from_secs(5);

/// Builds the library of the virtual joystick. Returns `None` if SDL is not installed.
fn library() -> Option<&'static Path> {
    static BUILT: OnceLock<Option<PathBuf>> = OnceLock::new();
    let built = BUILT
        .get_or_init(|| {
            let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pad.c");
            let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("libpad.so");
            let flags = ["-std=gnu11", "-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"];
            let mut cc = Command::new("cc");
            cc.args(flags).arg(source).arg("-o").arg(&out);
            let built = cc.args(["-lSDL2", "-ldl"]).output();
            built.is_ok_and(|run| run.status.success()).then_some(out)
        })
        .as_deref();
    xtask::needs::SDL.met(built.is_some()).then_some(built)?
}

/// The process has only one SDL and one gamepad, so only one test at a time may use them.
struct Pad {
    library: libloading::Library,
    path: &'static Path,
    since: usize,
    _alone: MutexGuard<'static, ()>,
}

impl Pad {
    fn take() -> Option<Self> {
        static ALONE: Mutex<()> = Mutex::new(());
        let path = library()?;
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the library of this test.
        let library = unsafe { libloading::Library::new(path).unwrap() };
        let mut pad = Self { library, path, since: 0, _alone: alone };
        // The gamepad is attached when the adapter initialises SDL.
        Sdl.capabilities(&pad.settings(&[])).unwrap();
        pad.since = pad.call("pad_count");
        Some(pad)
    }

    fn call<R>(&self, name: &str) -> R {
        // SAFETY: the functions that are called so take nothing, and return `R`.
        unsafe {
            let function = self.library.get::<unsafe extern "C" fn() -> R>(name);
            function.unwrap()()
        }
    }

    fn fail(&self, now: i32) {
        // SAFETY: as `pad.c` has it.
        unsafe {
            let fail = self.library.get::<unsafe extern "C" fn(i32)>("pad_fail");
            fail.unwrap()(now);
        }
    }

    /// Returns the strengths that were set since this test began: the time, and the strength of the
    /// large and of the small motor.
    fn told(&self) -> Vec<(i64, u16, u16)> {
        type Get = unsafe extern "C" fn(usize, &mut i64, &mut u16, &mut u16);
        let count: usize = self.call("pad_count");
        let one = |at: usize| {
            let mut told = (0, 0, 0);
            // SAFETY: as `pad.c` has it; `at` is below the count.
            unsafe {
                let get = self.library.get::<Get>("pad_told").unwrap();
                get(at, &mut told.0, &mut told.1, &mut told.2);
            }
            told
        };
        (self.since..count).map(one).collect()
    }

    fn settings(&self, given: &[(&str, &str)]) -> Settings {
        let driver = ("driver", self.path.to_str().unwrap());
        let given: BTreeMap<String, String> = [&[driver], given]
            .concat()
            .iter()
            .map(|(k, v)| ((*k).to_owned(), (*v).to_owned()))
            .collect();
        Settings::resolve(Sdl.descriptor(), None, &given).unwrap()
    }

    fn open(&self, given: &[(&str, &str)]) -> Result<Box<dyn Output>, DeviceError> {
        let format = StreamFormat { rate_hz: RATE_HZ, block_frames: 80 };
        Sdl.open_output(&self.settings(given), &format)
    }

    fn is_at_rest(&self) -> bool {
        matches!(self.told().last(), None | Some((_, 0, 0)))
    }
}

fn sine(hz: f32, peak: f32, seconds: f32) -> Vec<f32> {
    let turn = std::f32::consts::TAU * hz / RATE_HZ as f32;
    let count = (seconds * RATE_HZ as f32) as usize;
    (0..count).map(|n| peak * (turn * n as f32).sin()).collect()
}

fn write_all(device: &mut dyn Output, samples: &[f32]) {
    assert_eq!(device.write(samples, LONG), Ok(samples.len()));
}

#[test]
fn a_low_frequency_is_on_the_large_motor_and_a_high_one_on_the_small() {
    let Some(pad) = Pad::take() else { return };
    for (hz, share) in [(50.0, 0.0), (240.0, 0.5), (480.0, 1.0)] {
        let since = pad.told().len();
        let mut device = pad.open(&[("gain", "1")]).unwrap();
        write_all(device.as_mut(), &sine(hz, 0.5, 0.3));
        device.finish().unwrap();
        let status = device.status();
        assert_eq!((status.frames_written, status.frames_played), (2_400, 2_400));
        let told = pad.told().split_off(since);
        assert_eq!(told.last().map(|t| (t.1, t.2)), Some((0, 0)), "{hz} Hz");
        // SDL reports only changes. The analyser's first window is full after 64 ms.
        let playing: Vec<_> = told.iter().filter(|t| t.1.max(t.2) > 0).collect();
        let late = told[0].0 + 150_000_000;
        let (last, before) = playing.split_last().unwrap();
        let steady = before.iter().filter(|t| t.0 > late).chain([last]);
        for (_, large, small) in steady {
            let [large, small] = [*large, *small].map(|x| f64::from(x) / 65_535.0);
            let level = 0.5 / 2.0_f64.sqrt();
            // A block of 10 ms contains half a period of 50 Hz, and whole periods of the other
            // frequencies except at their ends.
            assert!((large + small - level).abs() < 0.02, "{hz} Hz: {large} {small}");
            assert!((small - share * level).abs() < 0.01, "{hz} Hz: {large} {small}");
        }
    }
}

#[test]
fn a_gain_makes_a_third_of_full_scale_the_strongest() {
    let Some(pad) = Pad::take() else { return };
    let mut device = pad.open(&[]).unwrap();
    write_all(device.as_mut(), &sine(30.0, 0.9, 0.2));
    device.finish().unwrap();
    let strongest = pad.told().iter().map(|t| t.1).max();
    assert_eq!(strongest, Some(u16::MAX));
    assert!(pad.is_at_rest());
}

#[test]
fn dropped_or_dry_it_rests() {
    let Some(pad) = Pad::take() else { return };
    let mut device = pad.open(&[("buffer_ms", "10000")]).unwrap();
    write_all(device.as_mut(), &sine(100.0, 0.5, 6.0));
    wait(|| !pad.is_at_rest());
    drop(device);
    assert!(pad.is_at_rest());

    let mut device = pad.open(&[]).unwrap();
    write_all(device.as_mut(), &sine(100.0, 0.5, 0.1));
    wait(|| !pad.is_at_rest());
    wait(|| pad.is_at_rest());
    // The pad rests a moment before the device knows its error.
    let error = loop {
        if let Err(error) = device.write(&[0.1], LONG) {
            break error;
        }
    };
    assert!(matches!(error, DeviceError::Underflow { .. }), "{error}");
}

#[test]
fn a_pad_that_fails_or_is_pulled_out_says_so_and_rests() {
    let Some(pad) = Pad::take() else { return };
    let until_it_fails = |device: &mut dyn Output| loop {
        if let Err(error) = device.write(&sine(100.0, 0.5, 0.01), LONG) {
            break error.to_string();
        }
    };
    let mut device = pad.open(&[]).unwrap();
    write_all(device.as_mut(), &sine(100.0, 0.5, 0.1));
    wait(|| !pad.is_at_rest());
    pad.fail(1);
    let error = until_it_fails(device.as_mut());
    pad.fail(0);
    assert!(error.contains("Test pad failed") && error.contains("the cable is loose"), "{error}");
    assert!(matches!(device.write(&[0.1], LONG), Err(DeviceError::Closed(_))));

    let mut device = pad.open(&[]).unwrap();
    write_all(device.as_mut(), &sine(100.0, 0.5, 0.1));
    wait(|| !pad.is_at_rest());
    pad.call::<()>("pad_pull_out");
    let error = until_it_fails(device.as_mut());
    assert_eq!(error, "Test pad failed: it was disconnected");
    drop(device);
    let error = pad.open(&[]).err().unwrap().to_string();
    assert!(error.contains("no gamepad `first`: none is connected"), "{error}");
    pad.call::<()>("pad_plug_in");
    let mut device = pad.open(&[("device", "Test pad")]).unwrap();
    write_all(device.as_mut(), &sine(100.0, 0.5, 0.05));
    device.finish().unwrap();
    assert!(pad.is_at_rest());
}

#[test]
fn one_program_drives_a_pad_once() {
    let Some(pad) = Pad::take() else { return };
    let device = pad.open(&[]).unwrap();
    let error = pad.open(&[]).err().unwrap();
    assert!(matches!(error, DeviceError::Busy(_)), "{error}");
    drop(device);
    drop(pad.open(&[]).unwrap());
}

#[test]
fn settings_that_name_nothing_are_refused() {
    let Some(pad) = Pad::take() else { return };
    let sdl = Sdl;
    sdl.descriptor().check().unwrap();
    let can = sdl.capabilities(&pad.settings(&[])).unwrap();
    can.check().unwrap();
    assert_eq!((can.quantity, can.limit, can.paced), (Quantity::Sound, Some(1.0), true));
    let missing =
        sdl.capabilities(&pad.settings(&[("device", "Other pad")])).unwrap_err().to_string();
    assert!(missing.contains("there is Test pad"), "{missing}");
    for no_sdl in ["no-such-library.so", "libm.so.6"] {
        let given = [("driver".to_owned(), no_sdl.to_owned())].into();
        let settings = Settings::resolve(sdl.descriptor(), None, &given).unwrap();
        let error = sdl.capabilities(&settings).unwrap_err();
        assert!(matches!(&error, DeviceError::Setting { name, .. } if name == "driver"), "{error}");
        assert!(error.to_string().contains(no_sdl), "{error}");
    }
}

fn wait(until: impl Fn() -> bool) {
    let since = Instant::now();
    while !until() {
        assert!(since.elapsed() < LONG, "it takes too long");
        std::thread::sleep(Duration::from_millis(1));
    }
}
