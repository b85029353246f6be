//! Plays through the OpenXR loader of the Khronos Group, which finds the runtime by the manifest
//! that the environment names.
#![cfg(all(feature = "openxr", target_os = "linux"))]
#![allow(clippy::unwrap_used, unsafe_code)] // A failed unwrap is a failed test; the environment is set.

#[allow(dead_code)]
#[path = "paced/parametric_mock/mod.rs"]
mod mock;

use htex_device::{Adapter, StreamFormat};
use htex_device_builtin::parametric::Parametric;
use mock::{Frame, Mock, RATE_HZ, settings, sine, write_all};

#[test]
fn the_installed_loader_finds_the_runtime() {
    // SAFETY: the system's own library.
    let there = unsafe { libloading::Library::new("libopenxr_loader.so.1") }.is_ok();
    if !xtask::needs::OPENXR.met(there) {
        return;
    }
    let Some(mock) = Mock::new() else { return };
    let manifest = mock.path.with_extension("json");
    let library = mock.path.display();
    let text = format!(
        r#"{{ "file_format_version": "1.0.0", "runtime": {{ "library_path": "{library}" }} }}"#
    );
    std::fs::write(&manifest, text).unwrap();
    // SAFETY: this process has one test, which has started no other thread.
    unsafe { std::env::set_var("XR_RUNTIME_JSON", &manifest) };
    let adapter = Parametric;
    let endpoints = adapter.endpoints().unwrap();
    let names: Vec<&str> = endpoints.iter().map(|e| e.name.as_str()).collect();
    assert_eq!(names, ["left", "right"]);
    let format = StreamFormat { rate_hz: RATE_HZ, block_frames: 80 };
    let mut device = adapter.open_output(&settings(&[]).unwrap(), &format).unwrap();
    write_all(device.as_mut(), &sine(200.0, 0.5, 0.2, RATE_HZ));
    device.finish().unwrap();
    drop(device);
    let lines = mock.record();
    assert!(!lines.iter().any(|line| line.starts_with("broken")), "{lines:#?}");
    let frames: Vec<Frame> = lines.iter().filter_map(|line| Frame::of(line)).collect();
    assert_eq!(frames[0].kind, "first");
    let last = frames.last().unwrap();
    assert_eq!((last.kind.as_str(), last.amplitudes.last().unwrap().1), ("last", 0.0));
}
