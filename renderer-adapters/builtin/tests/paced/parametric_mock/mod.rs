//! The mock runtime (`runtime.c`) and the mock vibrator (`vibrator.c`). Each test has its own copy,
//! and so its own state.

use std::collections::BTreeMap;
use std::ffi::{CStr, CString, c_char};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use htex_device::{Adapter, DeviceError, Output, Settings, StreamFormat};
use htex_device_builtin::parametric::Parametric;
use tempfile::TempDir;

pub(crate) const LONG: Duration = Duration::from_secs(5);
pub(crate) const RATE_HZ: f64 = 8_000.0;

/// Compiles a source to a library. Returns `None` if there is no compiler.
fn built(source: &str) -> Option<PathBuf> {
    static BUILT: Mutex<BTreeMap<String, PathBuf>> = Mutex::new(BTreeMap::new());
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    if !built.contains_key(source) {
        let cc = Command::new("cc").arg("--version").output();
        if !xtask::needs::CC.met(cc.is_ok()) {
            return None;
        }
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(source);
        let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap().keep();
        std::fs::write(folder.join("pwle.h"), declared()).unwrap();
        let out = folder.join("libmock.so");
        let flags = ["-std=gnu11", "-O1", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC"];
        let mut cc = Command::new("cc");
        let run =
            cc.args(flags).arg("-I").arg(&folder).arg(file).arg("-o").arg(&out).arg("-lpthread");
        let run = run.output().unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        built.insert(source.to_owned(), out);
    }
    built.get(source).cloned()
}

/// Returns the C declarations from `docs/devices.md` that an application has to implement.
fn declared() -> String {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/devices.md");
    let blocks = xtask::markdown::blocks(&std::fs::read_to_string(page).unwrap());
    let block = blocks.into_iter().find(|block| block.language == "c");
    block.unwrap().text
}

pub(crate) struct Mock {
    _folder: TempDir,
    pub path: PathBuf,
    pub library: libloading::Library,
}

impl Mock {
    /// Builds the mock OpenXR runtime.
    pub(crate) fn new() -> Option<Self> {
        Self::of("runtime.c")
    }

    /// Builds the library of a source.
    pub(crate) fn of(source: &str) -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("libmock.so");
        std::fs::copy(built(source)?, &path).unwrap();
        // SAFETY: the library of this test.
        let library = unsafe { libloading::Library::new(&path).unwrap() };
        Some(Self { _folder: folder, path, library })
    }

    pub(crate) fn set(&self, name: &str, value: f64) {
        type Set = unsafe extern "C" fn(*const c_char, f64) -> i32;
        let name = CString::new(name).unwrap();
        // SAFETY: as `runtime.c` has it.
        let known = unsafe { self.library.get::<Set>("mock_set").unwrap()(name.as_ptr(), value) };
        assert_eq!(known, 1, "{name:?}");
    }

    /// Returns the recorded lines since the last call.
    pub(crate) fn record(&self) -> Vec<String> {
        type Get = unsafe extern "C" fn() -> *const c_char;
        // SAFETY: as `runtime.c` has it; the text is copied before the next call.
        let text = unsafe { CStr::from_ptr(self.library.get::<Get>("mock_record").unwrap()()) };
        text.to_str().unwrap().lines().map(str::to_owned).collect()
    }

    pub(crate) fn settings(&self, given: &[(&str, &str)]) -> Settings {
        let runtime = ("runtime", self.path.to_str().unwrap());
        settings(&[&[runtime], given].concat()).unwrap()
    }

    pub(crate) fn open(&self, given: &[(&str, &str)]) -> Result<Box<dyn Output>, DeviceError> {
        let adapter = Parametric;
        let settings = self.settings(given);
        let rate_hz = adapter.capabilities(&settings)?.default_rate_hz;
        self.open_at(rate_hz, given)
    }

    pub(crate) fn open_at(
        &self,
        rate_hz: f64,
        given: &[(&str, &str)],
    ) -> Result<Box<dyn Output>, DeviceError> {
        let format = StreamFormat { rate_hz, block_frames: 80 };
        Parametric.open_output(&self.settings(given), &format)
    }
}

pub(crate) fn settings(given: &[(&str, &str)]) -> Result<Settings, DeviceError> {
    let given: BTreeMap<String, String> =
        given.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect();
    Settings::resolve(Parametric.descriptor(), None, &given)
}

pub(crate) fn sine(hz: f64, peak: f64, seconds: f64, rate_hz: f64) -> Vec<f32> {
    let turn = std::f64::consts::TAU * hz / rate_hz;
    let count = (seconds * rate_hz) as usize;
    let sample = |n: usize| (peak * (turn * n as f64).sin()) as f32;
    (0..count).map(sample).collect()
}

pub(crate) fn write_all(device: &mut dyn Output, samples: &[f32]) {
    assert_eq!(device.write(samples, LONG), Ok(samples.len()));
}

/// A frame of points as the runtime received it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frame {
    pub hand: String,
    pub kind: String,
    pub at_ns: i64,
    pub range_hz: (f64, f64),
    pub amplitudes: Vec<(i64, f64)>,
    pub frequencies: Vec<(i64, f64)>,
}

impl Frame {
    /// Parses a recorded line. Returns `None` if it is not a frame.
    pub(crate) fn of(line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split(' ').collect();
        if words[0] != "points" {
            return None;
        }
        let at = words.iter().position(|word| *word == "frequency").unwrap();
        let points = |words: &[&str]| -> Vec<(i64, f64)> {
            let point = |word: &&str| {
                let (time, value) = word.split_once(':').unwrap();
                (time.parse().unwrap(), value.parse().unwrap())
            };
            words.iter().map(point).collect()
        };
        Some(Self {
            hand: words[1].to_owned(),
            kind: words[2].to_owned(),
            at_ns: words[4].parse().unwrap(),
            range_hz: (words[6].parse().unwrap(), words[7].parse().unwrap()),
            amplitudes: points(&words[9..at]),
            frequencies: points(&words[at + 1..]),
        })
    }
}
