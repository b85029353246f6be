//! Faults of a source in Rust, as a host sees them through the C functions.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use htex_device::source::abi::SourceTable;
use htex_device::{
    AbiFault, Channel, Delivered, Descriptor, DeviceError, Endpoint, FromScene,
    NativeSourceAdapter, Setting, SettingKind, Settings, Source, SourceAdapter, Sources,
};

/// A source with two counting channels, in which the setting `fault` chooses what is wrong.
#[derive(Default)]
struct Counter;

struct Open {
    fault: String,
    channels: Vec<Channel>,
    next: u32,
}

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
    id: "org.example.counter".to_owned(),
    name: "Counter".to_owned(),
    version: "1.0.0".to_owned(),
    summary: "Counts.".to_owned(),
    settings: vec![Setting {
        name: "fault".to_owned(),
        kind: SettingKind::Text,
        default: Some(String::new()),
        live_default: None,
        from_scene: FromScene::Never,
        description: "What is wrong.".to_owned(),
    }],
    profiles: Vec::new(),
    mapping: None,
});

impl SourceAdapter for Counter {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn target(&self) -> &str {
        "fault"
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        panic!("no endpoints")
    }

    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError> {
        let fault = settings.text("fault").to_owned();
        let names: &[&str] = match &fault[..] {
            "no channels" => &[],
            "alike" => &["a", "a"],
            "control" => &["a", "b\u{1b}[2J"],
            "rate refused" => {
                return Err(DeviceError::Rate {
                    device: "Counter".to_owned(),
                    rate_hz: 5.0,
                    rates: "1 Hz".to_owned(),
                });
            }
            _ => &["a", "b"],
        };
        let channels = names.iter().map(|name| Channel::new(*name, "N")).collect();
        Ok(Box::new(Open { fault, channels, next: 0 }))
    }
}

impl Source for Open {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn rate_hz(&self) -> f64 {
        match &self.fault[..] {
            "nan rate" => f64::NAN,
            "zero rate" => 0.0,
            _ => 1000.0,
        }
    }

    fn start(&mut self) -> Result<(), DeviceError> {
        Ok(())
    }

    fn read(&mut self, samples: &mut [f64], _: Duration) -> Result<Delivered, DeviceError> {
        for sample in samples.iter_mut() {
            *sample = f64::from(self.next);
            self.next += 1;
        }
        let frames = samples.len() / 2;
        match &self.fault[..] {
            "panic" => panic!("half a frame"),
            "too many" => Ok(Delivered::Frames(frames + 1)),
            "nan" => {
                samples[3] = f64::NAN;
                Ok(Delivered::Frames(frames))
            }
            "overrun" if self.next > 20 => Err(DeviceError::Overrun {
                source_name: "Counter".to_owned(),
                frames: 0,
                advice: "count slower".to_owned(),
            }),
            "end" if self.next > 20 => Ok(Delivered::End),
            _ => Ok(Delivered::Frames(frames)),
        }
    }

    fn stop(&mut self) -> Result<(), DeviceError> {
        Ok(())
    }
}

htex_device::export_source!(Counter, symbols: "never");

fn adapter() -> NativeSourceAdapter {
    NativeSourceAdapter::from_table("counter", &SOURCE_TABLE).unwrap()
}

fn open(fault: &str) -> Result<Box<dyn Source>, DeviceError> {
    Sources::new(vec![Arc::new(adapter())]).open(
        &format!("counter:{fault}"),
        None,
        &BTreeMap::new(),
    )
}

fn read(source: &mut dyn Source, frames: usize) -> Result<Delivered, DeviceError> {
    let mut samples = vec![0.0; 2 * frames];
    source.read(&mut samples, Duration::ZERO)
}

#[test]
fn samples_come_as_they_are() {
    let mut source = open("").unwrap();
    assert_eq!((source.rate_hz(), source.channels().len()), (1000.0, 2));
    assert_eq!(source.channels()[1], Channel::new("b", "N"));
    source.start().unwrap();
    // The buffer has one value more than two frames need. That value must stay unchanged.
    let mut samples = [-1.0; 5];
    let delivered = source.read(&mut samples, Duration::ZERO);
    assert_eq!(delivered, Ok(Delivered::Frames(2)));
    assert_eq!(samples, [0.0, 1.0, 2.0, 3.0, -1.0]);
    assert_eq!(source.read(&mut [], Duration::ZERO), Ok(Delivered::Frames(0)));
    source.stop().unwrap();
}

#[test]
fn an_invalid_stream_is_refused_when_the_source_is_opened() {
    for (fault, words) in [
        ("no channels", "0 channels; 1 to 1024"),
        ("alike", "two channels are named `a`"),
        ("control", "channel 1: "),
        ("nan rate", "stream: invalid type: null"),
        ("zero rate", "a rate of 0 Hz"),
    ] {
        let Err(error) = open(fault) else { panic!("{fault} is opened") };
        let is_abi = matches!(&error, DeviceError::Abi { library, .. } if library == "counter");
        assert!(is_abi && error.to_string().contains(words), "{fault}: {error}");
    }
    let error = open("rate refused").err().unwrap();
    let sentence = "Counter does not run at 5 Hz; it runs at 1 Hz";
    assert_eq!(error.to_string(), sentence);
}

#[test]
fn what_a_read_may_not_return_ends_the_source() {
    let closed = Err(DeviceError::Closed("Counter".to_owned()));
    for (fault, words) in [
        ("too many", "read: it delivered 9 frames of 8"),
        ("nan", "read: frame 1 of channel `b` is NaN"),
        ("panic", "the source panicked: half a frame"),
    ] {
        let mut source = open(fault).unwrap();
        let error = read(source.as_mut(), 8).unwrap_err();
        assert!(error.to_string().contains(words), "{fault}: {error}");
        assert_eq!(read(source.as_mut(), 8), closed);
    }
    let error = adapter().endpoints().unwrap_err();
    assert!(error.to_string().contains("no endpoints"), "{error}");
}

#[test]
fn an_overrun_and_the_end_keep_their_kind() {
    let mut source = open("overrun").unwrap();
    assert_eq!(read(source.as_mut(), 8), Ok(Delivered::Frames(8)));
    let lost = DeviceError::Overrun {
        source_name: "Counter".to_owned(),
        frames: 8,
        advice: "count slower".to_owned(),
    };
    assert_eq!(read(source.as_mut(), 8), Err(lost));
    let mut source = open("end").unwrap();
    assert_eq!(read(source.as_mut(), 8), Ok(Delivered::Frames(8)));
    assert_eq!(read(source.as_mut(), 8), Ok(Delivered::End));
}

extern "C" fn next_major() -> u32 {
    0x4853_0200
}

extern "C" fn newer_minor() -> u32 {
    0x4853_0107
}

/// Returns text that is not UTF-8, with a valid length.
unsafe extern "C" fn no_text(out: *mut u8, capacity: usize) -> i64 {
    // SAFETY: the host's buffer has this length.
    unsafe { std::slice::from_raw_parts_mut(out, capacity) }.fill(0xff);
    8
}

extern "C" fn endless(_: *mut u8, _: usize) -> i64 {
    i64::MAX
}

/// Returns the fault for which the host refuses a table.
fn refused(table: SourceTable) -> AbiFault {
    match NativeSourceAdapter::from_table("counter", Box::leak(Box::new(table))) {
        Err(DeviceError::Abi { fault, .. }) => fault,
        other => panic!("{other:?}"),
    }
}

#[test]
fn another_version_and_a_text_that_is_none_are_refused() {
    let marker = refused(SourceTable { abi_version: next_major, ..SOURCE_TABLE });
    let sentence = "the marker 0x48530200 is not of source ABI 1.x, which this host loads";
    assert_eq!(marker.to_string(), sentence);
    for descriptor in [no_text, endless as htex_device::abi::DescriptorJson] {
        let fault = refused(SourceTable { descriptor, ..SOURCE_TABLE });
        assert!(matches!(fault, AbiFault::Descriptor(_)), "{fault}");
    }
    let newer = SourceTable { abi_version: newer_minor, ..SOURCE_TABLE };
    NativeSourceAdapter::from_table("counter", Box::leak(Box::new(newer))).unwrap();
}
