//! A model of your own: flat noise between two frequencies. It is fitted to a simulated recording,
//! stored, and played. `cargo run --release -p htex --features author --example own_model`

use htex::author::simulate::{SimulationOptions, Surface, simulate};
use htex::author::{AssetRequest, Exploration, ModelRequest, Take, fit_asset};
use htex::format::{Asset, ErrorMeasure};
use htex::model::{Band, Curve, Error, Fit, FitInput, ShapedModel, StaticDescriptor, StaticField};
use htex::{Registry, Texture, VoiceOptions, model::Values};

struct Plateau {
    edges_hz: (f64, f64),
    band: Band,
}

impl Curve for Plateau {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        Ok(Self { edges_hz: (parameters.scalar(0), parameters.scalar(1)), band })
    }
    fn band(&self) -> Band {
        self.band
    }
    fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        f64::from((self.edges_hz.0..=self.edges_hz.1).contains(&frequency_hz))
    }
}

impl ShapedModel for Plateau {
    type Curve = Self;
    const DESCRIPTOR: StaticDescriptor =
        StaticDescriptor::new("org.example.plateau", "Plateau", "1.0.0", "Flat noise.").fields(&[
            StaticField::scalar("low_hz", "Hz", (0.0, 2_000.0), "Lowest frequency."),
            StaticField::scalar("high_hz", "Hz", (0.0, 2_000.0), "Highest frequency."),
        ]);
    /// Finds the frequencies between which the spectrum exceeds a twentieth of its level.
    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        let floor = input.level_rms() / 20.0;
        let mut loud = input.frequency_hz.iter().zip(input.magnitude).filter(|(_, m)| **m > floor);
        let (low, _) = loud.next().ok_or_else(|| Error::cannot_fit("the spectrum is zero"))?;
        let parameters = vec![*low, loud.next_back().map_or(*low, |(high, _)| *high)];
        Ok(Fit { parameters, level_rms: input.level_rms() })
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut registry = Registry::builtin();
    registry.add_model::<Plateau>()?;
    let recording = simulate(&SimulationOptions::new(Surface::Sandpaper))?.to_recording("made")?;
    let given = Exploration { speed_mm_s: Some(80.0), force_n: Some(0.4) };
    let model = ModelRequest::new(registry.find("org.example.plateau")?);
    let request = AssetRequest::new("Sandpaper").with_models([model]);
    let file = fit_asset(&[Take { recording, given }], &request)?.asset.to_bytes()?;
    let texture = Texture::with_registry(Asset::from_bytes(&file)?, registry);
    let plateau = texture.representation("plateau")?;
    println!("{:?} dB in nine bands", plateau.data().error_db(ErrorMeasure::NineBand));
    let mut voice = plateau.voice(&VoiceOptions::default())?;
    let sum: f32 = voice.samples().take(20_000).map(|x| x.map(|x| x * x)).sum::<Result<_, _>>()?;
    println!("{:.3} mN RMS", (sum / 20_000.0).sqrt() * 1e3);
    Ok(())
}
