//! A model that the program itself defines: flat noise between two frequencies. The program
//! registers it, fits it to a simulated recording, and plays the asset.
//!
//! `cargo run --release -p htex --features author --example own_model`

use htex::author::{AssetRequest, Exploration, ModelRequest, Take, fit_asset};
use htex::simulate::{SimulationOptions, Surface, simulate};
use htex::{Asset, Motion, Registry, VoiceOptions};
use htex_model::shaped::{Curve, ShapedModel};
use htex_model::{Band, Error, Fit, FitInput, StaticDescriptor, StaticField, Values};

/// The model: a plateau from `low_hz` to `high_hz`.
struct Plateau;

/// The plateau that the parameters describe, in a band.
struct Edges {
    low_hz: f64,
    high_hz: f64,
    band: Band,
}

impl ShapedModel for Plateau {
    type Curve = Edges;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.example.plateau",
        "Plateau",
        "1.0.0",
        "Flat noise between two frequencies.",
    )
    .fields(&[
        StaticField::scalar("low_hz", "Hz", (0.0, 2_000.0), "Lowest frequency."),
        StaticField::scalar("high_hz", "Hz", (0.0, 2_000.0), "Highest frequency."),
    ]);

    /// The frequencies between which 90 % of the power lies.
    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        let power = || input.magnitude.iter().map(|m| m * m);
        let total: f64 = power().sum();
        if total == 0.0 {
            return Err(Error::cannot_fit("the spectrum is zero"));
        }
        let below = |part: f64| {
            let mut sum = 0.0;
            let bin = power().position(|p| {
                sum += p;
                sum >= part * total
            });
            input.frequency_hz[bin.unwrap_or(input.frequency_hz.len() - 1)]
        };
        Ok(Fit { parameters: vec![below(0.05), below(0.95)], level_rms: (total / 3.0).sqrt() })
    }
}

impl Curve for Edges {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        let mut edges = Self { low_hz: 0.0, high_hz: 0.0, band };
        edges.set(parameters)?;
        Ok(edges)
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        (self.low_hz, self.high_hz) = (parameters.scalar(0), parameters.scalar(1));
        if self.level() > 0.0 {
            return Ok(());
        }
        Err(Error::parameters("no bin of the band lies between `low_hz` and `high_hz`"))
    }

    fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        f64::from((self.low_hz..=self.high_hz).contains(&frequency_hz))
    }

    fn level(&self) -> f64 {
        htex_dsp::grid::curve_level_rms(self.band, |hz| self.magnitude_at(hz))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut registry = Registry::builtin();
    registry.add_model::<Plateau>()?;

    let options = SimulationOptions::new(Surface::Sandpaper);
    let take = Take {
        given: Exploration { speed_mm_s: Some(options.speed_mm_s), force_n: Some(options.force_n) },
        recording: simulate(&options)?.to_recording("simulated")?,
    };
    let model = registry.find("org.example.plateau")?.clone();
    let request = AssetRequest::new("Sandpaper").with_models([ModelRequest::new(&model)]);
    let fitted = fit_asset(&[take], &request)?;

    let asset = Asset::with_registry(fitted.asset, registry);
    let motion = Motion::new(80.0, 0.4);
    println!("{:?}", asset.parameters(Some("plateau"), Some(motion))?);
    let mut voice = asset.voice(&VoiceOptions::default().with_motion(motion))?;
    let mut second = vec![0.0f32; 20_000];
    voice.render(&mut second)?;
    let power: f32 = second.iter().map(|x| x * x).sum::<f32>() / second.len() as f32;
    println!("{:.3} mN RMS", power.sqrt() * 1e3);
    Ok(())
}
