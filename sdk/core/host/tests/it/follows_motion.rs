//! Modules with the extension `htex.motion/1`, and modules that claim it without its functions.

use crate::common;

use common::{SAMPLE, limits, load, load_within, text};
use htex_host::{Band, FitCondition, FitInput, HostError, LoadedModel, Motion, Status};

/// Returns 1 for `htex.motion/1`, which it recognises by the sixth letter.
const SAYS_YES: (&str, &str) = (
    "extension",
    "(i64.extend_i32_u (i32.eq (i32.load8_u offset=5 (local.get 0)) (i32.const 0x6d)))",
);
/// The first sample of a block is the position plus x and twice y. Above 100 mm it returns an
/// error.
const SET: &str = "(global $position (mut f64) (f64.const 7))
    (func (export \"htex_motion_1_set\") (param i64 f64 f64 f64 f64 f64) (result i64)
      (if (f64.gt (local.get 3) (f64.const 100)) (then (return (i64.const -1))))
      (global.set $position (f64.add (local.get 3)
        (f64.add (local.get 4) (f64.mul (f64.const 2) (local.get 5)))))
      (i64.const 0))";
/// The parameter is the force and the level is the speed; 0.25 and 2 if they are unknown.
const FIT: &str = "(func (export \"htex_motion_1_fit\")
      (param f64 f64 i32 i32 i32 i32 i32 f64 i32 i32 f64 f64 i32 i32 i32) (result i64)
      (f64.store (local.get 12)
        (select (local.get 11) (f64.const 0.25) (f64.eq (local.get 11) (local.get 11))))
      (f64.store (local.get 14)
        (select (local.get 10) (f64.const 2) (f64.eq (local.get 10) (local.get 10))))
      (i64.const 1))";
const RENDER: (&str, &str) = (
    "voice_render",
    "(f32.store (local.get 1) (f32.demote_f64 (global.get $position))) (i64.const 0)",
);

fn following() -> LoadedModel {
    let wat = text("1.0.0", &[SAYS_YES, RENDER], &format!("{SET} {FIT}"));
    load_within(&wat, &limits()).unwrap()
}

fn at(position_mm: f64) -> Motion {
    Motion { speed_mm_s: -80.0, force_n: 0.4, position_mm, x_mm: 0.0, y_mm: 0.0 }
}

#[test]
fn a_voice_is_told_where_the_finger_is() {
    let model = following();
    assert!(model.follows_motion());
    let mut voices = [1, 2].map(|seed| model.voice(&[0.5], Band::TACTILE, 2_000.0, seed).unwrap());
    voices[0].set_motion(at(42.0)).unwrap();
    let mut out = [0.0];
    let mut next = |voice: usize| {
        voices[voice].render(&mut out).unwrap();
        out[0]
    };
    assert_eq!([next(0), next(1)], [42.0, 7.0], "each voice has its own");
    let place = Motion { x_mm: 10.0, y_mm: -4.0, ..at(42.0) };
    voices[0].set_motion(place).unwrap();
    let mut out = [0.0];
    voices[0].render(&mut out).unwrap();
    assert_eq!(out[0], 44.0, "and in which place");
    voices[0].set_motion(at(42.0)).unwrap();
    // The host refuses motions outside the ranges of the extension. The model refuses those that it
    // does not accept.
    let refused = |error: HostError, words: &str| match error {
        HostError::Call { status, message, .. } => {
            assert_eq!(status, Status::InvalidArgument);
            assert!(message.contains(words), "{message}");
        }
        other => panic!("{other}"),
    };
    for x in [f64::NAN, f64::INFINITY, 1e13] {
        refused(voices[0].set_motion(at(x)).unwrap_err(), "`position_mm` is");
        let aside = Motion { y_mm: x, ..at(42.0) };
        refused(voices[0].set_motion(aside).unwrap_err(), "`y_mm` is");
    }
    refused(voices[0].set_motion(at(101.0)).unwrap_err(), "no reason given");
    voices[0].render(&mut out).unwrap();
    assert_eq!(out[0], 42.0, "it plays on as before");
}

#[test]
fn a_fit_is_told_what_is_known_of_the_recording() {
    let fit = |model: &LoadedModel, speed_mm_s, force_n| {
        let grid = Band::TACTILE.grid_hz();
        let request = FitInput {
            band: Band::TACTILE,
            frequency_hz: &grid,
            magnitude: &vec![1.0; grid.len()],
            signal: &[],
            signal_rate_hz: 20_000.0,
            options: &[],
            condition: FitCondition { speed_mm_s, force_n },
        };
        let fit = model.fit(&request).unwrap();
        (fit.level_rms, fit.parameters[0])
    };
    let model = following();
    assert_eq!(fit(&model, Some(80.0), Some(0.5)), (80.0, 0.5));
    assert_eq!(fit(&model, Some(80.0), None), (80.0, 0.25));
    assert_eq!(fit(&model, None, Some(0.5)), (2.0, 0.5));
    // A model without the extension does not receive the condition.
    let other = load(&[]).unwrap();
    assert_eq!(fit(&other, Some(80.0), Some(0.3)), (1.0, 0.5));
}

#[test]
fn a_model_without_it_hears_of_no_motion() {
    let model = load(&[]).unwrap();
    assert!(!model.follows_motion());
    let mut voice = model.voice(&[0.5], Band::TACTILE, 2_000.0, 1).unwrap();
    voice.set_motion(at(42.0)).unwrap();
    let mut out = [0.0];
    voice.render(&mut out).unwrap();
    assert_eq!(out[0], SAMPLE);
}

#[test]
fn a_module_that_says_yes_must_have_all_of_it() {
    for (there, missing) in
        [(SET, "htex_motion_1_fit"), (FIT, "htex_motion_1_set"), ("", "htex_motion_1_set")]
    {
        let wat = text("1.0.0", &[SAYS_YES], there);
        let error = load_within(&wat, &limits()).unwrap_err().to_string();
        assert!(error.contains(missing), "{error}");
    }
    let wrong =
        SET.replace("(param i64 f64 f64 f64 f64 f64)", "(param i64 f64 f64 f64 f64 f64 f64)");
    let wat = text("1.0.0", &[SAYS_YES], &format!("{wrong} {FIT}"));
    let error = load_within(&wat, &limits()).unwrap_err().to_string();
    assert!(error.contains("does not have the arguments"), "{error}");
    // A module that fails in `htex_model_extension` has no extension, and is loaded.
    let model = load(&[("extension", "unreachable")]).unwrap();
    assert!(!model.follows_motion());
    assert!(model.voice(&[0.5], Band::TACTILE, 2_000.0, 1).is_ok());
}
