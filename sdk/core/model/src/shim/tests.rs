use super::*;
use crate::{Band, Numbers};

/// A model whose voices count up from the seed or from the finger's position.
struct Counting;
struct Counter(f32);

impl Model for Counting {
    type Voice = Counter;
    const DESCRIPTOR: StaticDescriptor =
        StaticDescriptor::new("org.example.counting", "Counting", "1.0.0", "Counts.");
    fn fit(_: &FitInput<'_>) -> Result<crate::Fit, Error> {
        Err(Error::cannot_fit("never"))
    }
    fn magnitude(_: &Values<'_>, _: Band, _: &[f64], _: &mut [f64]) -> Result<(), Error> {
        Ok(())
    }
    fn interpolate(_: &[Values<'_>], _: &[f64], _: &mut Numbers<'_>) -> Result<(), Error> {
        Ok(())
    }
    fn voice(_: &Values<'_>, _: Band, _: f64, seed: u64) -> Result<Counter, Error> {
        Ok(Counter(seed as f32))
    }
}

impl Voice for Counter {
    fn render(&mut self, out: &mut [f32]) {
        for x in out {
            *x = self.0;
            self.0 += 1.0;
        }
    }
    fn retune(&mut self, _: &Values<'_>) -> Result<(), Error> {
        Ok(())
    }
}

impl MotionVoice for Counter {
    fn set_motion(&mut self, motion: Motion) {
        self.0 = motion.position_mm as f32;
    }
}

#[test]
fn a_bad_motion_leaves_the_voice_as_it_was() {
    let state = State::<Counting>::new(b"");
    let handle = state.voice_new(Input(Some(&[])), (20.0, 1_000.0), 2_000.0, 100);
    let good = Motion { speed_mm_s: -80.0, force_n: 0.4, position_mm: -7.0, x_mm: 3.0, y_mm: -4.0 };
    // SAFETY: one thread.
    let set = |handle, motion| unsafe { state.motion_set(handle, motion) };
    let next = || {
        let mut out = [0.0];
        // SAFETY: one thread.
        let answer = unsafe { state.voice_render(handle, Output(Some(&mut out))) };
        assert_eq!(answer, 0);
        out[0]
    };
    let invalid = Status::InvalidArgument as i64;
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1.1e12] {
        let fields: [fn(&mut Motion) -> &mut f64; 5] = [
            |m| &mut m.speed_mm_s,
            |m| &mut m.force_n,
            |m| &mut m.position_mm,
            |m| &mut m.x_mm,
            |m| &mut m.y_mm,
        ];
        for field in fields {
            let mut motion = good;
            *field(&mut motion) = x;
            assert_eq!(set(handle, motion), invalid, "{motion:?}");
        }
    }
    let pulled = Motion { force_n: -0.1, ..good };
    assert_eq!(set(handle, pulled), invalid);
    assert_eq!(set(handle + 1, good), Status::BadHandle as i64);
    assert_eq!(next(), 100.0);
    assert_eq!(set(handle, good), 0);
    assert_eq!(next(), -7.0);
}

#[test]
fn extensions_are_those_the_model_has() {
    let has = |id: &str, motion| extension(Input(Some(id.as_bytes())), motion);
    assert_eq!([has("htex.motion/1", true), has("htex.motion/1", false)], [1, 0]);
    assert_eq!([has("htex.voices/1", true), has("htex.voices/1", false)], [1, 1]);
    assert_eq!([has("htex.motion/2", true), has("", true)], [0, 0]);
}

#[test]
fn what_is_not_known_of_a_condition_is_nan() {
    let read = |speed, force| FitCondition::from_numbers(speed, force);
    let known = read(80.0, f64::NAN).unwrap();
    assert_eq!((known.speed_mm_s, known.force_n), (Some(80.0), None));
    assert!(known.numbers().1.is_nan());
    for (speed, force) in [(-1.0, 0.4), (80.0, -0.1), (f64::INFINITY, 0.4), (80.0, 1e7)] {
        let status = read(speed, force).unwrap_err().status;
        assert_eq!(status, Status::InvalidArgument, "{speed} {force}");
    }
}

/// If one handle of the array is invalid, no voice renders.
#[test]
fn voices_are_rendered_together_or_not_at_all() {
    let state = State::<Counting>::new(b"");
    let none = Input(Some(&[][..]));
    let new = |seed| state.voice_new(none, (20.0, 1_000.0), 2_000.0, seed);
    let (a, b) = (new(100), new(200));
    let render = |handles: &[i64], frames: usize| {
        let mut out = std::vec![-1.0; handles.len() * frames];
        // SAFETY: one thread.
        let answer =
            unsafe { state.voices_render(Input(Some(handles)), frames, Output(Some(&mut out))) };
        (answer, out)
    };
    let freed = new(300);
    assert_eq!(state.voice_free(freed), 0);
    for (handles, status) in [
        (&[a, b, a][..], Status::InvalidArgument),
        (&[a, freed], Status::BadHandle),
        (&[a, 0], Status::BadHandle),
        (&(1..=17).collect::<Vec<_>>(), Status::InvalidArgument),
    ] {
        let (answer, out) = render(handles, 3);
        assert_eq!(answer, status as i64);
        assert!(out.iter().all(|x| *x == -1.0), "{handles:?}");
    }
    assert_eq!(render(&[], 3), (0, std::vec![]));
    assert_eq!(render(&[a, b], 0), (0, std::vec![]));
    assert_eq!(render(&[b, a], 2), (0, std::vec![200.0, 201.0, 100.0, 101.0]));
    // SAFETY: null is refused before it is read.
    let null =
        unsafe { state.voices_render(Input(Some(&[a])), 2, Output::new(core::ptr::null_mut(), 2)) };
    assert_eq!(null, Status::InvalidArgument as i64);
    assert_eq!(render(&[a], 1), (0, std::vec![102.0]));
}

#[test]
fn memory_is_given_and_taken_back() {
    for len in [1, 8, 12_345] {
        let pointer = alloc(len);
        assert!(!pointer.is_null() && (pointer as usize).is_multiple_of(ALLOC_ALIGN));
        // SAFETY: `len` zeroed bytes that were allocated here.
        let bytes = unsafe { core::slice::from_raw_parts_mut(pointer, len) };
        assert!(bytes.iter().all(|&b| b == 0));
        bytes.fill(0xff);
        // SAFETY: freed with the length of the allocation.
        unsafe { free(pointer, len) };
    }
    for impossible in [0, usize::MAX, isize::MAX as usize] {
        assert!(alloc(impossible).is_null());
    }
    // SAFETY: null is allowed.
    unsafe { free(core::ptr::null_mut(), 8) };
}
