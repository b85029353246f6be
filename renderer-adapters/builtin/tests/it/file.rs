//! Writes files with the device, and reads them back with independent readers.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

use htex_device::{Adapter, DeviceError, NativeAdapter, Output, Quantity, Settings, StreamFormat};
use htex_device_builtin::file::{FileAdapter, TABLE};

type Given<'a> = &'a [(&'a str, &'a str)];

fn settings(path: &Path, given: Given<'_>) -> Result<Settings, DeviceError> {
    let mut all: BTreeMap<String, String> =
        given.iter().map(|(k, v)| (k.to_string(), v.to_string())).collect();
    all.insert("path".to_owned(), path.to_str().unwrap().to_owned());
    Settings::resolve(FileAdapter.descriptor(), None, &all)
}

fn open(
    adapter: &dyn Adapter,
    path: &Path,
    given: Given<'_>,
    rate_hz: f64,
) -> Result<Box<dyn Output>, DeviceError> {
    let format = StreamFormat { rate_hz, block_frames: 64 };
    adapter.open_output(&settings(path, given)?, &format)
}

/// Writes samples in uneven blocks and returns the file. The file must not exist before the device
/// is finished.
fn written(adapter: &dyn Adapter, path: &Path, given: Given<'_>, samples: &[f32]) -> Vec<u8> {
    // A file from an earlier run may exist.
    let _ = fs::remove_file(path);
    let mut device = open(adapter, path, given, 8_000.0).unwrap();
    for block in samples.chunks(37) {
        let taken = device.write(block, Duration::ZERO).unwrap();
        assert_eq!(taken, block.len());
    }
    assert!(!path.exists(), "there before its end");
    device.finish().unwrap();
    let status = device.status();
    assert_eq!(status.frames_played, samples.len() as u64);
    let after = device.write(&[0.0], Duration::ZERO);
    assert!(matches!(after, Err(DeviceError::Closed(_))));
    fs::read(path).unwrap()
}

fn wave() -> Vec<f32> {
    (0..1000).map(|i| 0.9 * (i as f32 * 0.1).sin()).collect()
}

#[test]
fn wav_holds_the_samples() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    let wave = wave();
    written(&FileAdapter, &path, &[], &wave);
    let mut reader = hound::WavReader::open(&path).unwrap();
    assert_eq!((reader.spec().sample_rate, reader.spec().channels), (8_000, 1));
    let read: Vec<f32> = reader.samples::<f32>().map(Result::unwrap).collect();
    assert_eq!(read, wave);
    for (encoding, bits) in [("i16", 16), ("i24", 24)] {
        let integers = [("encoding", encoding), ("full_scale", "2")];
        written(&FileAdapter, &path, &integers, &wave);
        let mut reader = hound::WavReader::open(&path).unwrap();
        assert_eq!(reader.spec().bits_per_sample, bits);
        let step = 2.0 / f64::from(1 << (bits - 1));
        let read: Vec<i32> = reader.samples::<i32>().map(Result::unwrap).collect();
        assert_eq!(read.len(), wave.len());
        for (code, sample) in read.into_iter().zip(&wave) {
            assert!((f64::from(code) * step - f64::from(*sample)).abs() <= 0.5 * step);
        }
    }
}

#[test]
fn npy_raw_and_csv_hold_the_samples() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let wave = wave();
    let bytes: Vec<u8> = wave.iter().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(written(&FileAdapter, &at("a.raw"), &[], &wave), bytes);

    let npy = written(&FileAdapter, &at("a.npy"), &[], &wave);
    let header = |kind| {
        format!("\u{1}\0v\0{{'descr': '{kind}', 'fortran_order': False, 'shape': (1000, ), }}")
    };
    let starts = |npy: &[u8], kind| npy[6..].starts_with(header(kind).as_bytes());
    assert!(npy.starts_with(b"\x93NUMPY") && starts(&npy, "<f4"));
    assert_eq!((npy[127], &npy[128..]), (b'\n', &bytes[..]));
    let i16 = written(&FileAdapter, &at("a.npy"), &[("encoding", "i16")], &wave);
    assert!(starts(&i16, "<i2"));
    let code = (wave[1] * 32_768.0).round_ties_even() as i16;
    assert_eq!(i16[130..132], code.to_le_bytes());

    let i24 = [("encoding", "i24"), ("format", "raw")];
    let i24 = written(&FileAdapter, &at("a.bin"), &i24, &[-0.5, 0.25]);
    assert_eq!(i24, [0, 0, 0xc0, 0, 0, 0x20]);

    let csv = written(&FileAdapter, &at("a.csv"), &[], &wave[..2]);
    let csv = String::from_utf8(csv).unwrap();
    let expected = format!("t_s,lateral_force_n\n0,0\n0.000125,{}\n", wave[1]);
    assert_eq!(csv, expected);
}

#[test]
fn a_drive_has_a_limit_and_a_carrier() {
    let path = Path::new("drive.wav");
    let drive = [
        ("quantity", "display_voltage"),
        ("limit_v", "100"),
        ("carrier_hz", "10000"),
        ("encoding", "i16"),
        ("full_scale", "200"),
    ];
    let can = FileAdapter.capabilities(&settings(path, &drive).unwrap()).unwrap();
    assert_eq!(can.quantity, Quantity::DisplayVoltage);
    assert_eq!((can.limit, can.carrier_hz), (Some(100.0), Some(10_000.0)));
    assert_eq!((can.step, can.default_rate_hz), (Some(200.0 / 32_768.0), 1e5));
    can.check().unwrap();
}

#[test]
fn what_cannot_be_had_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |name: &str, given: Given<'_>, rate_hz: f64| {
        let opened = open(&FileAdapter, &folder.path().join(name), given, rate_hz);
        opened.err().unwrap()
    };
    let settings: [(&str, Given<'_>, &str); 8] = [
        ("a.mp3", &[], "format"),
        ("a.csv", &[("encoding", "i16")], "encoding"),
        ("a.npy", &[("encoding", "i24")], "encoding"),
        ("a.wav", &[("full_scale", "2")], "full_scale"),
        ("a.wav", &[("limit_v", "2")], "limit_v"),
        ("a.wav", &[("carrier_hz", "2")], "carrier_hz"),
        ("a.wav", &[("quantity", "display_voltage")], "limit_v"),
        ("a.wav", &[("encoding", "f64")], "encoding"),
    ];
    for (file, given, blamed) in settings {
        let error = refused(file, given, 1e4);
        let is_blamed = matches!(&error, DeviceError::Setting { name, .. } if name == blamed);
        assert!(is_blamed, "{file} {given:?}: {error}");
    }
    for rate_hz in [99.0, 1.1e6] {
        let error = refused("a.wav", &[], rate_hz);
        assert!(matches!(error, DeviceError::Rate { .. }), "{error}");
    }
    let error = refused("a.wav", &[], 8_000.5);
    assert!(matches!(error, DeviceError::Setting { .. }), "{error}");
    let error = refused("no/such/folder/a.wav", &[], 1e4);
    assert!(matches!(error, DeviceError::File { .. }), "{error}");
    fs::create_dir(folder.path().join("d.wav")).unwrap();
    let error = refused("d.wav", &[], 1e4);
    assert!(matches!(error, DeviceError::File { .. }), "{error}");
}

/// Neither a dropped device nor a failed device leaves a file behind. An old file stays.
#[test]
fn without_an_end_nothing_is_left() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    fs::write(&path, "old").unwrap();
    let mut device = open(&FileAdapter, &path, &[], 8_000.0).unwrap();
    device.write(&[0.5; 100_000], Duration::ZERO).unwrap();
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    drop(device);
    let integers = [("encoding", "i16"), ("full_scale", "0.5")];
    for bad in [0.5, f32::NAN, -0.7] {
        let mut device = open(&FileAdapter, &path, &integers, 8_000.0).unwrap();
        device.write(&[0.1; 3], Duration::ZERO).unwrap();
        let error = device.write(&[0.1, bad], Duration::ZERO).unwrap_err();
        assert!(matches!(error, DeviceError::OverLimit { frame: 4, .. }), "{error}");
        assert!(matches!(device.finish(), Err(DeviceError::Closed(_))));
    }
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

/// The C functions produce the same bytes and the same errors.
#[test]
fn the_abi_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    let native = NativeAdapter::from_table("file", &TABLE).unwrap();
    assert_eq!(native.descriptor(), FileAdapter.descriptor());
    let wave = wave();
    for given in [&[][..], &[("encoding", "i24"), ("full_scale", "3")]] {
        let settings = settings(&path, given).unwrap();
        assert_eq!(
            native.capabilities(&settings).unwrap(),
            FileAdapter.capabilities(&settings).unwrap()
        );
        let through = written(&native, &path, given, &wave);
        assert_eq!(through, written(&FileAdapter, &path, given, &wave));
        fs::remove_file(&path).unwrap();
    }
    let errors = [
        |a: &dyn Adapter, p: &Path| open(a, &p.with_extension("mp3"), &[], 1e4).err(),
        |a: &dyn Adapter, p: &Path| open(a, p, &[], 10.0).err(),
        |a: &dyn Adapter, p: &Path| open(a, &p.join("b.wav"), &[], 1e4).err(),
        |a: &dyn Adapter, p: &Path| {
            let mut device = open(a, p, &[("encoding", "i16")], 1e4).unwrap();
            device.write(&[0.0; 5], Duration::ZERO).unwrap();
            device.write(&[0.0, 2.0], Duration::ZERO).err()
        },
    ];
    for error in errors {
        let direct = error(&FileAdapter, &path);
        assert!(direct.is_some());
        assert_eq!(error(&native, &path).map(|e| e.to_string()), direct.map(|e| e.to_string()));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
