//! The mock runtime must refuse each frame that breaks a rule, and name the rule. Otherwise its
//! silence in other tests would prove nothing.

use crate::parametric_mock as mock;

use std::ffi::{CStr, c_void};
use std::ptr::null;

use htex_device::Adapter;
use mock::Mock;
use openxr_sys::{self as xr, pfn};

const MS: i64 = 1_000_000;

#[derive(Clone, Copy)]
#[repr(C)]
struct Point(i64, f32);

#[derive(Clone, Copy)]
#[repr(C)]
struct Transient(i64, f32, f32);

/// `XrHapticParametricVibrationEXT`.
#[repr(C)]
struct Vibration {
    ty: i32,
    next: *const c_void,
    amplitude_count: u32,
    amplitudes: *const Point,
    frequency_count: u32,
    frequencies: *const Point,
    transient_count: u32,
    transients: *const Transient,
    range: [f32; 2],
    frame: i32,
}

#[derive(Clone)]
struct Given {
    amplitudes: Vec<Point>,
    frequencies: Vec<Point>,
    transients: Vec<Transient>,
    range: [f32; 2],
    frame: i32,
}

/// Calls the runtime as the device does, while another device keeps a session open.
struct Caller {
    apply: pfn::ApplyHapticFeedback,
    element: xr::HapticActionInfo,
}

impl Caller {
    fn new(mock: &Mock) -> Self {
        let info = xr::NegotiateLoaderInfo {
            struct_type: xr::NegotiateLoaderInfo::TYPE,
            struct_version: 1,
            struct_size: size_of::<xr::NegotiateLoaderInfo>(),
            min_interface_version: 1,
            max_interface_version: 1,
            min_api_version: xr::Version::new(1, 0, 0),
            max_api_version: xr::Version::new(1, 1, 0),
        };
        let mut request = xr::NegotiateRuntimeRequest {
            struct_type: xr::NegotiateRuntimeRequest::TYPE,
            struct_version: 1,
            struct_size: size_of::<xr::NegotiateRuntimeRequest>(),
            runtime_interface_version: 0,
            runtime_api_version: xr::Version::default(),
            get_instance_proc_addr: None,
        };
        let instance = xr::Instance::from_raw(1);
        // SAFETY: as the header has these functions.
        unsafe {
            let negotiate = mock
                .library
                .get::<pfn::NegotiateLoaderRuntimeInterface>("xrNegotiateLoaderRuntimeInterface");
            assert_eq!(negotiate.unwrap()(&info, &mut request), xr::Result::SUCCESS);
            let entry = request.get_instance_proc_addr.unwrap();
            let find = |name: &CStr| {
                let mut found = None;
                assert_eq!(entry(instance, name.as_ptr(), &mut found), xr::Result::SUCCESS);
                found.unwrap()
            };
            let to_path: pfn::StringToPath = std::mem::transmute(find(c"xrStringToPath"));
            let mut hand = xr::Path::NULL;
            to_path(instance, c"/user/hand/left".as_ptr(), &mut hand);
            Self {
                apply: std::mem::transmute::<pfn::VoidFunction, pfn::ApplyHapticFeedback>(find(
                    c"xrApplyHapticFeedback",
                )),
                element: xr::HapticActionInfo {
                    ty: xr::HapticActionInfo::TYPE,
                    next: null(),
                    action: xr::Action::from_raw(1),
                    subaction_path: hand,
                },
            }
        }
    }

    fn haptics<T>(&self, haptics: &T) -> xr::Result {
        let header = (&raw const *haptics).cast::<xr::HapticBaseHeader>();
        // SAFETY: a structure that begins with the header.
        unsafe { (self.apply)(xr::Session::from_raw(1), &self.element, header) }
    }

    fn apply(&self, given: &Given) -> xr::Result {
        self.haptics(&Vibration {
            ty: 1_000_775_000,
            next: null(),
            amplitude_count: given.amplitudes.len() as u32,
            amplitudes: given.amplitudes.as_ptr(),
            frequency_count: given.frequencies.len() as u32,
            frequencies: given.frequencies.as_ptr(),
            transient_count: given.transients.len() as u32,
            transients: given.transients.as_ptr(),
            range: given.range,
            frame: given.frame,
        })
    }
}

/// Imported because handles of `openxr-sys` convert through this trait.
use xr::Handle as _;

fn sound(frame: i32) -> Given {
    let from = if frame >= 2 { 100 * MS } else { 0 };
    Given {
        amplitudes: vec![Point(from, 0.0), Point(from + 100 * MS, 1.0)],
        frequencies: vec![Point(from, 0.5), Point(from + 100 * MS, 0.5)],
        transients: vec![],
        range: if frame >= 2 { [0.0; 2] } else { [100.0, 200.0] },
        frame,
    }
}

#[test]
fn each_rule_bites() {
    let Some(mock) = Mock::new() else { return };
    mock.set("first_ns", 50e6);
    let device = mock.open(&[]).unwrap();
    let caller = Caller::new(&mock);
    let refused = |before: Option<i32>, given: &Given, rule: &str| {
        if let Some(frame) = before {
            assert_eq!(caller.apply(&sound(frame)), xr::Result::SUCCESS);
        }
        mock.record();
        assert_eq!(caller.apply(given), xr::Result::ERROR_VALIDATION_FAILURE, "{rule}");
        assert_eq!(mock.record(), [format!("broken {rule}")]);
    };
    let many = vec![Point(0, 0.5); 501];
    type Change<'a> = &'a dyn Fn(&mut Given);
    let one: [(i32, &str, Change<'_>); 15] = [
        (0, "amplitude-count", &|g| g.amplitudes.truncate(1)),
        (1, "amplitude-count", &|g| g.amplitudes.truncate(1)),
        (0, "most-points", &|g| g.amplitudes = many.clone()),
        (0, "most-points", &|g| g.frequencies = many.clone()),
        (0, "most-points", &|g| g.transients = vec![Transient(0, 0.5, 0.5); 501]),
        (1, "first-amplitude-at-0", &|g| g.amplitudes[0].0 = 1),
        (1, "first-frequency-at-0", &|g| g.frequencies[0].0 = 1),
        (1, "first-frame-duration", &|g| g.amplitudes[1].0 = 49 * MS),
        (0, "one-frequency-unspecified", &|g| g.range = [0.0, 200.0]),
        (0, "frequency-range", &|g| g.range = [100.0, 1_001.0]),
        (0, "frequency-order", &|g| g.range = [300.0, 200.0]),
        (0, "amplitudes-in-order", &|g| g.amplitudes.insert(1, Point(200 * MS, 0.1))),
        (0, "frequencies-in-order", &|g| g.frequencies.insert(1, Point(200 * MS, 0.1))),
        (0, "transients-in-order", &|g| g.transients = vec![Transient(9, 0.5, 0.5); 2]),
        (0, "after-the-last-amplitude", &|g| g.frequencies[1].0 = 101 * MS),
    ];
    for (frame, rule, change) in one {
        let mut given = sound(frame);
        change(&mut given);
        refused(None, &given, rule);
    }
    let values: [(&str, Change<'_>); 4] = [
        ("amplitude-0-to-1", &|g| g.amplitudes[1].1 = 1.01),
        ("amplitude-0-to-1", &|g| g.amplitudes[1].1 = f32::NAN),
        ("frequency-0-to-1", &|g| g.frequencies[0].1 = -0.01),
        ("transient-0-to-1", &|g| g.transients = vec![Transient(9, 0.5, 1.5)]),
    ];
    for (rule, change) in values {
        let mut given = sound(0);
        change(&mut given);
        refused(None, &given, rule);
    }
    // No stream is running after a single event, or after the last frame.
    refused(Some(0), &sound(2), "no-stream");
    let stream: [(&str, Change<'_>); 3] = [
        ("frequency-in-a-later-frame", &|g| g.range = [100.0, 200.0]),
        ("amplitudes-in-order", &|g| g.amplitudes[0].0 = 99 * MS),
        ("frequencies-in-order", &|g| g.frequencies[0].0 = 99 * MS),
    ];
    for (rule, change) in stream {
        let mut given = sound(2);
        change(&mut given);
        refused(Some(1), &given, rule);
    }
    assert_eq!(caller.apply(&sound(1)), xr::Result::SUCCESS);
    assert_eq!(caller.apply(&sound(3)), xr::Result::SUCCESS);
    refused(None, &sound(2), "no-stream");
    drop(device);
}

#[test]
fn each_rule_of_samples_bites() {
    let Some(mock) = Mock::new() else { return };
    let device = mock.open(&[]).unwrap();
    htex_device_builtin::parametric::Parametric.descriptor().check().unwrap();
    let caller = Caller::new(&mock);
    let (samples, mut taken) = ([0.5_f32, -1.0, 1.0], 0_u32);
    let sound = xr::HapticPcmVibrationFB {
        ty: xr::HapticPcmVibrationFB::TYPE,
        next: null(),
        buffer_size: 3,
        buffer: samples.as_ptr(),
        sample_rate: 2_000.0,
        append: xr::FALSE,
        samples_consumed: &mut taken,
    };
    assert_eq!(caller.haptics(&sound), xr::Result::SUCCESS);
    mock.record();
    let loud = [0.5_f32, -1.01, 1.0];
    let wrong = [
        ("bufferSize", xr::HapticPcmVibrationFB { buffer_size: 0, ..sound }),
        ("sampleRate", xr::HapticPcmVibrationFB { sample_rate: 0.0, ..sound }),
        ("sample-1-to-1", xr::HapticPcmVibrationFB { buffer: loud.as_ptr(), ..sound }),
        (
            "samplesConsumed",
            xr::HapticPcmVibrationFB { samples_consumed: std::ptr::null_mut(), ..sound },
        ),
    ];
    for (rule, wrong) in wrong {
        assert_eq!(caller.haptics(&wrong), xr::Result::ERROR_VALIDATION_FAILURE, "{rule}");
        assert_eq!(mock.record(), [format!("broken {rule}")]);
    }
    drop(device);
}
