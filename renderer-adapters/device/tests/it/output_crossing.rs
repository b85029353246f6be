//! Tests which errors a host gets through the C functions from a faulty output that is written in
//! Rust.

use std::collections::BTreeMap;
use std::sync::LazyLock;
use std::time::Duration;

use htex_device::{
    Adapter, Capabilities, Descriptor, DeviceError, Endpoint, NativeAdapter, Output, Quantity,
    Rates, Settings, Status, StreamFormat,
};

/// A faulty output: it panics at a sample of 0.5, runs dry at 0.25, and claims too many frames
/// at 2.
#[derive(Default)]
struct Bad;

struct Open(u64);

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
    id: "org.example.bad".to_owned(),
    name: "Bad".to_owned(),
    version: "1.0.0".to_owned(),
    summary: "Fails.".to_owned(),
    ..Descriptor::default()
});

impl Adapter for Bad {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        panic!("no endpoints")
    }

    fn capabilities(&self, _: &Settings) -> Result<Capabilities, DeviceError> {
        Ok(Capabilities {
            quantity: Quantity::DisplayVoltage,
            rates: Rates::List(vec![1e4]),
            default_rate_hz: 1e4,
            limit: Some(10.0),
            step: None,
            carrier_hz: None,
            paced: true,
            block_frames: 16,
        })
    }

    fn open_output(&self, _: &Settings, _: &StreamFormat) -> Result<Box<dyn Output>, DeviceError> {
        Ok(Box::new(Open(0)))
    }
}

impl Output for Open {
    fn write(&mut self, samples: &[f32], _: Duration) -> Result<usize, DeviceError> {
        assert!(!samples.contains(&0.5), "half a volt");
        if samples.contains(&0.25) {
            return Err(DeviceError::Underflow {
                device: "Bad".to_owned(),
                frames: self.0,
                advice: "write larger blocks".to_owned(),
            });
        }
        self.0 += samples.len() as u64;
        // Claims one frame more than it got if a sample is 2.
        Ok(samples.len() + usize::from(samples.contains(&2.0)))
    }

    fn status(&self) -> Status {
        Status { frames_written: self.0, frames_played: self.0, ..Status::default() }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        Ok(())
    }
}

htex_device::export_device!(Bad, symbols: "never");

fn open() -> Box<dyn Output> {
    let adapter = NativeAdapter::from_table("bad", &TABLE).unwrap();
    let settings = Settings::resolve(&DESCRIPTOR, None, &BTreeMap::new()).unwrap();
    let format = StreamFormat { rate_hz: 1e4, block_frames: 16 };
    adapter.open_output(&settings, &format).unwrap()
}

#[test]
fn a_panic_is_an_error_and_closes_the_device() {
    let adapter = NativeAdapter::from_table("bad", &TABLE).unwrap();
    let error = adapter.endpoints().unwrap_err();
    assert!(error.to_string().contains("no endpoints"), "{error}");
    let mut device = open();
    let error = device.write(&[0.5], Duration::ZERO).unwrap_err();
    let is_failed = matches!(&error, DeviceError::Failed { what, .. } if what.contains("half"));
    assert!(is_failed, "{error}");
    let closed = Err(DeviceError::Closed("Bad".to_owned()));
    assert_eq!(device.write(&[0.0], Duration::ZERO), closed);
}

#[test]
fn running_dry_keeps_its_kind() {
    let mut device = open();
    assert_eq!(device.write(&[0.0; 7], Duration::ZERO), Ok(7));
    let dry = DeviceError::Underflow {
        device: "Bad".to_owned(),
        frames: 7,
        advice: "write larger blocks".to_owned(),
    };
    assert_eq!(device.write(&[0.25], Duration::ZERO), Err(dry));
}

/// This display of a library has no setting for direct voltage. Its host therefore limits the mean
/// to 1 V over 100 ms, which is 1,000 frames here.
#[test]
fn a_host_holds_direct_voltage_of_a_display() {
    let mut device = open();
    assert_eq!(device.write(&[9.0; 100], Duration::ZERO), Ok(100));
    assert_eq!(device.write(&[-9.0; 200], Duration::ZERO), Ok(200));
    assert_eq!(device.write(&[9.0; 210], Duration::ZERO), Ok(210));
    let error = device.write(&[0.0, 9.0, 9.0, 9.0], Duration::ZERO);
    let Err(DeviceError::DirectVoltage { frame, mean_v, limit_v }) = error else {
        panic!("{error:?}")
    };
    assert_eq!((frame, limit_v), (512, 1.0));
    assert!((mean_v - 1.008).abs() < 1e-9, "{mean_v}");
    let closed = Err(DeviceError::Closed("Bad".to_owned()));
    assert_eq!(device.write(&[0.0], Duration::ZERO), closed);
    assert_eq!(device.status().frames_written, 510);
}

#[test]
fn more_than_was_offered_is_no_answer() {
    let taken = open().write(&[2.0], Duration::ZERO);
    assert!(matches!(taken, Err(DeviceError::Library { .. })), "{taken:?}");
}
