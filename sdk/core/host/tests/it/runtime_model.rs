//! Models that are objects: their errors, panics and voices.

use std::sync::Arc;

use htex_host::{
    Band, Descriptor, FitCondition, HostError, LoadedModel, Origin, Registry, RuntimeModel,
    RuntimeVoice, Status,
};
use htex_model::{Error, Fit, FitInput, StaticDescriptor, StaticField, Values};

const ID: &str = "org.example.steps";
const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(ID, "Steps", "1.0.0", "Steps.")
    .fields(&[StaticField::scalar("step", "1", (0.0, 10.0), "Step.")]);

/// A model whose step is the first magnitude. A magnitude of 7 cannot be fitted, and 9 panics. Its
/// samples are 0, step, 2·step, …
struct Steps;
struct StepVoice {
    step: f32,
    next: f32,
}

impl RuntimeModel for Steps {
    fn fit(&self, input: &FitInput<'_>) -> Result<Fit, Error> {
        let step = input.magnitude[0];
        if step == 7.0 {
            return Err(Error::cannot_fit("seven"));
        }
        assert!(step != 9.0, "nine");
        Ok(Fit { parameters: vec![step], level_rms: 1.0 })
    }

    fn magnitude(
        &self,
        parameters: &Values<'_>,
        _: Band,
        _: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        magnitude.fill(parameters.scalar(0));
        Ok(())
    }

    fn voice(
        &self,
        parameters: &Values<'_>,
        _: Band,
        _: f64,
        seed: u64,
    ) -> Result<Box<dyn RuntimeVoice>, Error> {
        Ok(Box::new(StepVoice { step: parameters.scalar(0) as f32, next: seed as f32 }))
    }
}

impl RuntimeVoice for StepVoice {
    fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        for x in out {
            if self.next == 8.0 {
                return Err(Error::new(Status::Failed, "eight"));
            }
            *x = self.next * self.step;
            self.next += 1.0;
        }
        Ok(())
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.step = parameters.scalar(0) as f32;
        Ok(())
    }
}

fn steps() -> LoadedModel {
    let mut registry = Registry::builtin();
    let descriptor = Descriptor::from(&DESCRIPTOR);
    registry.add_runtime_model("a test", descriptor, Arc::new(Steps)).unwrap();
    registry.find("steps").unwrap().clone()
}

fn fit(magnitude: [f64; 3], options: &[f64]) -> Result<Fit, HostError> {
    steps().fit(&FitInput {
        band: Band::TACTILE,
        frequency_hz: &[50.0, 100.0, 150.0],
        magnitude: &magnitude,
        signal: &[],
        signal_rate_hz: 20_000.0,
        options,
        condition: FitCondition::default(),
    })
}

fn status(error: HostError) -> (Status, String) {
    match error {
        HostError::Call { status, message, .. } => (status, message),
        other => panic!("{other}"),
    }
}

#[test]
fn the_calls_reach_the_object() {
    let model = steps();
    assert_eq!(*model.origin(), Origin::Runtime("a test".to_owned()));
    assert_eq!(*model.descriptor(), Descriptor::from(&DESCRIPTOR));
    assert!(!model.follows_motion() && !model.has_extension("htex.voices/1").unwrap());
    assert_eq!(fit([2.0; 3], &[]).unwrap().parameters, [2.0]);
    let band = Band::TACTILE;
    assert_eq!(model.magnitude(&[3.0], band, &[50.0]).unwrap(), [3.0]);
    let mixed = model.interpolate(&[&[1.0], &[3.0]], &[0.25, 0.75]);
    assert_eq!(mixed.unwrap(), [2.5]);
    let mut voice = model.voice(&[2.0], band, 20_000.0, 1).unwrap();
    let mut out = [0.0; 3];
    voice.render(&mut out).unwrap();
    assert_eq!(out, [2.0, 4.0, 6.0]);
    voice.retune(&[1.0]).unwrap();
    voice.render(&mut out).unwrap();
    assert_eq!(out, [4.0, 5.0, 6.0]);
    voice.retune_mix(&[1.0, 3.0], &[0.5, 0.5], &mut [0.0]).unwrap();
    voice.render(&mut out[..1]).unwrap();
    assert_eq!(out[0], 14.0);
}

#[test]
fn errors_and_panics_are_those_of_the_call() {
    let seven = status(fit([7.0; 3], &[]).unwrap_err());
    assert_eq!(seven, (Status::CannotFit, "seven".to_owned()));
    let (nine, _) = status(fit([9.0; 3], &[]).unwrap_err());
    assert_eq!(nine, Status::Panicked);
    let (eleven, text) = status(fit([11.0; 3], &[]).unwrap_err());
    assert_eq!(eleven, Status::InvalidParameters);
    assert!(text.contains("`step`"), "{text}");
    let (negative, _) = status(fit([1.0, -1.0, 1.0], &[]).unwrap_err());
    assert_eq!(negative, Status::InvalidArgument);
    let (option, _) = status(fit([1.0; 3], &[1.0]).unwrap_err());
    assert_eq!(option, Status::InvalidOption);

    let (model, band) = (steps(), Band::TACTILE);
    let (hz, _) = status(model.magnitude(&[1.0], band, &[f64::NAN]).unwrap_err());
    assert_eq!(hz, Status::InvalidArgument);
    let (long, _) = status(model.magnitude(&[1.0, 2.0], band, &[50.0]).unwrap_err());
    assert_eq!(long, Status::InvalidParameters);
    let weights = model.interpolate(&[&[1.0], &[3.0]], &[0.5, 0.6]);
    assert_eq!(status(weights.unwrap_err()).0, Status::InvalidArgument);
    let rate = model.voice_rate_hz(&[1.0], band, 0.0).unwrap_err();
    assert_eq!(status(rate).0, Status::InvalidArgument);
}

#[test]
fn a_voice_that_fails_plays_zeros_and_a_freed_one_is_refused() {
    let mut voice = steps().voice(&[1.0], Band::TACTILE, 20_000.0, 6).unwrap();
    let mut out = [1.0; 4];
    let eight = status(voice.render(&mut out).unwrap_err());
    assert_eq!(eight, (Status::Failed, "eight".to_owned()));
    assert_eq!(out, [0.0; 4]);
    voice.free_and_keep_handle().unwrap();
    for freed in [voice.render(&mut out), voice.retune(&[1.0]), voice.free_and_keep_handle()] {
        assert_eq!(status(freed.unwrap_err()).0, Status::BadHandle);
    }
}
