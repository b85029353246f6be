//! Tests which errors a host gets through the C functions from a faulty input that is written in
//! Rust.

use std::collections::BTreeMap;
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use htex_device::abi::DeviceTable;
use htex_device::{
    Adapter, Channel, Descriptor, DeviceError, Devices, Direction, Endpoint, Input, InputFrames,
    InputStream, LibraryFault, NativeAdapter, Setting, SettingKind, Settings,
};

/// An input with two counting channels, in which the setting `fault` chooses what is wrong.
#[derive(Default)]
struct Counter;

struct Open {
    fault: String,
    stream: InputStream,
    next: u32,
}

static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
    id: "org.example.counter".to_owned(),
    name: "Counter".to_owned(),
    version: "1.0.0".to_owned(),
    summary: "Counts.".to_owned(),
    direction: Direction::Input,
    target: Some("fault".to_owned()),
    settings: vec![Setting::hardware("fault", SettingKind::Text, "", "What is wrong.")],
    ..Descriptor::default()
});

impl Adapter for Counter {
    fn descriptor(&self) -> &Descriptor {
        &DESCRIPTOR
    }

    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
        panic!("no endpoints")
    }

    fn open_input(&self, settings: &Settings) -> Result<Box<dyn Input>, DeviceError> {
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
        let rate_hz = match &fault[..] {
            "nan rate" => f64::NAN,
            "zero rate" => 0.0,
            _ => 1000.0,
        };
        Ok(Box::new(Open { fault, stream: InputStream { rate_hz, channels }, next: 0 }))
    }
}

impl Input for Open {
    fn stream(&self) -> &InputStream {
        &self.stream
    }

    fn start(&mut self) -> Result<(), DeviceError> {
        Ok(())
    }

    fn read(&mut self, samples: &mut [f64], _: Duration) -> Result<InputFrames, DeviceError> {
        for sample in samples.iter_mut() {
            *sample = f64::from(self.next);
            self.next += 1;
        }
        let frames = samples.len() / 2;
        match &self.fault[..] {
            "panic" => panic!("half a frame"),
            "too many" => Ok(InputFrames::Count(frames + 1)),
            "nan" => {
                samples[3] = f64::NAN;
                Ok(InputFrames::Count(frames))
            }
            "overrun" if self.next > 20 => Err(DeviceError::Overrun {
                device: "Counter".to_owned(),
                frames: 0,
                advice: "count slower".to_owned(),
            }),
            "end" if self.next > 20 => Ok(InputFrames::End),
            _ => Ok(InputFrames::Count(frames)),
        }
    }

    fn finish(&mut self) -> Result<(), DeviceError> {
        Ok(())
    }
}

htex_device::export_device!(Counter, symbols: "never");

fn adapter() -> NativeAdapter {
    NativeAdapter::from_table("counter", &TABLE).unwrap()
}

fn open(fault: &str) -> Result<Box<dyn Input>, DeviceError> {
    let devices = Devices::new(vec![Arc::new(adapter())]);
    devices.open_input(&format!("counter:{fault}"), None, &BTreeMap::new())
}

fn read(source: &mut dyn Input, frames: usize) -> Result<InputFrames, DeviceError> {
    let mut samples = vec![0.0; 2 * frames];
    source.read(&mut samples, Duration::ZERO)
}

#[test]
fn samples_come_as_they_are() {
    let mut source = open("").unwrap();
    assert_eq!((source.stream().rate_hz, source.stream().channels.len()), (1000.0, 2));
    assert_eq!(source.stream().channels[1], Channel::new("b", "N"));
    source.start().unwrap();
    // The buffer has one value more than two frames need. That value must stay unchanged.
    let mut samples = [-1.0; 5];
    let delivered = source.read(&mut samples, Duration::ZERO);
    assert_eq!(delivered, Ok(InputFrames::Count(2)));
    assert_eq!(samples, [0.0, 1.0, 2.0, 3.0, -1.0]);
    assert_eq!(source.read(&mut [], Duration::ZERO), Ok(InputFrames::Count(0)));
    source.finish().unwrap();
}

#[test]
fn an_invalid_stream_is_refused_when_the_input_is_opened() {
    for (fault, words) in [
        ("no channels", "0 channels; 1 to 1024"),
        ("alike", "two channels are named `a`"),
        ("control", "channel 1: "),
        ("nan rate", "stream: invalid type: null"),
        ("zero rate", "a rate of 0 Hz"),
    ] {
        let Err(error) = open(fault) else { panic!("{fault} is opened") };
        let is_abi = matches!(&error, DeviceError::Library { library, .. } if library == "counter");
        assert!(is_abi && error.to_string().contains(words), "{fault}: {error}");
    }
    let error = open("rate refused").err().unwrap();
    let sentence = "Counter does not run at 5 Hz; it runs at 1 Hz";
    assert_eq!(error.to_string(), sentence);
}

#[test]
fn what_a_read_may_not_return_ends_the_input() {
    let closed = Err(DeviceError::Closed("Counter".to_owned()));
    for (fault, words) in [
        ("too many", "read: it delivered 9 frames of 8"),
        ("nan", "read: frame 1 of channel `b` is NaN"),
        ("panic", "the device panicked: half a frame"),
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
    assert_eq!(read(source.as_mut(), 8), Ok(InputFrames::Count(8)));
    let lost = DeviceError::Overrun {
        device: "Counter".to_owned(),
        frames: 8,
        advice: "count slower".to_owned(),
    };
    assert_eq!(read(source.as_mut(), 8), Err(lost));
    let mut source = open("end").unwrap();
    assert_eq!(read(source.as_mut(), 8), Ok(InputFrames::Count(8)));
    assert_eq!(read(source.as_mut(), 8), Ok(InputFrames::End));
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

/// Returns the fault for which the host refuses a table, and its message.
fn refused(table: DeviceTable) -> (LibraryFault, String) {
    match NativeAdapter::from_table("counter", Box::leak(Box::new(table))) {
        Err(DeviceError::Library { fault, what, .. }) => (fault, what),
        other => panic!("{other:?}"),
    }
}

#[test]
fn another_version_and_a_text_that_is_none_are_refused() {
    for marker in [0x4844_0200, 0x4854_0100] {
        let sentence =
            format!("the marker {marker:#x} is not of device ABI 1.x, which this host loads");
        assert_eq!(refused(DeviceTable { marker, ..TABLE }), (LibraryFault::Marker, sentence));
    }
    for descriptor in [no_text, endless as htex_device::abi::DescriptorJson] {
        let refusal = refused(DeviceTable { descriptor: Some(descriptor), ..TABLE });
        assert_eq!(refusal.0, LibraryFault::Descriptor, "{refusal:?}");
    }
    let newer = DeviceTable { marker: 0x4844_0107, size: TABLE.size + 8, ..TABLE };
    NativeAdapter::from_table("counter", Box::leak(Box::new(newer))).unwrap();
}

/// A library must have the functions of its own direction. It does not need the others.
#[test]
fn a_table_without_a_function_of_its_direction_is_refused() {
    for (table, name) in [
        (DeviceTable { read: None, ..TABLE }, "read"),
        (DeviceTable { close: None, ..TABLE }, "close"),
    ] {
        let what = format!("the table has no `{name}`");
        assert_eq!(refused(table), (LibraryFault::Function, what));
    }
    let short = DeviceTable { size: TABLE.size - 1, ..TABLE };
    assert_eq!(refused(short).0, LibraryFault::Function);
    let input = DeviceTable { capabilities: None, write: None, status: None, ..TABLE };
    let input = NativeAdapter::from_table("counter", Box::leak(Box::new(input))).unwrap();
    let settings = Settings::resolve(&DESCRIPTOR, None, &BTreeMap::new()).unwrap();
    input.open_input(&settings).unwrap().start().unwrap();
    let error = input.capabilities(&settings).unwrap_err();
    assert_eq!(error.to_string(), "Counter is not an output; choose another device");
}
