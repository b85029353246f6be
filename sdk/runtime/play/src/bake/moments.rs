//! Computes the spectrum and level of a representation at any motion. The motion changes spectrum
//! and level in the same way as in a voice.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

use crate::exploration::CEILING;
use crate::{Conditions, Error, Interval, Motion, Representation};
use htex_format::{Fluctuation, Quantity, Rights};
use htex_host::{Band, Descriptor, LoadedModel};
use htex_player::Law;

use crate::bake::reading::Bands;

/// A representation of an asset.
pub(crate) struct Moments<'a> {
    representation: Representation<'a>,
    model: LoadedModel,
    conditions: Conditions,
    bands: Bands,
    /// The moments computed so far. The key is the bits of speed and force.
    known: RefCell<BTreeMap<[u64; 2], Rc<Moment>>>,
}

/// The texture at one motion.
pub(crate) struct Moment {
    pub(crate) parameters: Vec<f64>,
    /// RMS in the asset's unit.
    pub(crate) level_rms: f64,
    /// Factor for all frequencies.
    pub(crate) ratio: f64,
    pub(crate) motion: Motion,
    /// Magnitude at unit RMS on the band's grid, as a Hann window would measure it from a recording
    /// of the host's voice.
    pub(crate) stated: Vec<f64>,
}

impl Moment {
    /// Returns the bits of all values that determine the shape of the spectrum.
    pub(crate) fn shape(&self) -> Vec<u64> {
        let numbers = self.parameters.iter().chain([&self.ratio]);
        numbers.map(|x| x.to_bits()).collect()
    }
}

impl<'a> Moments<'a> {
    pub(crate) fn new(representation: Representation<'a>) -> Result<Self, Error> {
        let model = representation.model()?;
        if model.follows_motion() {
            return Err(Error::FollowsMotion { model: representation.id().to_owned() });
        }
        Ok(Self {
            model,
            conditions: representation.conditions()?,
            bands: Bands::new(representation.texture().band()),
            known: RefCell::default(),
            representation,
        })
    }

    pub(crate) fn id(&self) -> &str {
        self.representation.id()
    }

    pub(crate) fn quantity(&self) -> Quantity {
        self.representation.texture().quantity()
    }

    /// Returns the fluctuation in time that the asset states, if it is not 0.
    pub(crate) fn fluctuation(&self) -> Option<Fluctuation> {
        self.representation.texture().manifest().fluctuation.filter(|f| !f.is_zero())
    }

    pub(crate) fn rights(&self) -> Rights {
        Rights::from_manifest(self.representation.texture().manifest())
    }

    pub(crate) fn model(&self) -> &Descriptor {
        self.model.descriptor()
    }

    pub(crate) fn band(&self) -> Band {
        self.representation.texture().band()
    }

    pub(crate) fn bands(&self) -> &Bands {
        &self.bands
    }

    /// Returns the exponents of the scaling law that applies. An exponent of the speed is 0 if the
    /// asset does not state its speeds, and likewise for the force.
    pub(crate) fn law(&self) -> Law {
        let range = self.conditions.range();
        let law = range.law;
        let over = |is_known: bool, exponent: f64| if is_known { exponent as f32 } else { 0.0 };
        let (speed, force) = (range.speed.is_known(), range.force.is_known());
        Law {
            frequency_speed: over(speed, law.frequency_speed.exponent),
            level_speed: over(speed, law.level_speed.exponent),
            level_force: over(force, law.level_force.exponent),
        }
    }

    /// Returns the ceiling of the level: the scaling law does not raise the level above it.
    pub(crate) fn ceiling_rms(&self) -> f64 {
        let levels = self.representation.data().at.iter().map(|at| at.level_rms);
        CEILING * levels.fold(0.0, f64::max)
    }

    /// Returns the lowest and the highest recorded speed, mm/s, if they are known.
    pub(crate) fn recorded_speeds_mm_s(&self) -> Option<(f64, f64)> {
        match self.conditions.range().speed {
            Interval::Between { low, high } => Some((low, high)),
            Interval::Unknown => None,
        }
    }

    pub(crate) fn moment(&self, motion: Motion) -> Result<Rc<Moment>, Error> {
        let key = [motion.speed_mm_s, motion.force_n].map(f64::to_bits);
        if let Some(known) = self.known.borrow().get(&key) {
            return Ok(Rc::clone(known));
        }
        let (parameters, level_rms) = self.representation.parameters(Some(motion))?;
        let scaling = self.conditions.scaling(motion, CEILING);
        let moment = Rc::new(Moment {
            stated: self.model.read_magnitude(&parameters, self.band())?,
            parameters,
            level_rms: level_rms * scaling.level,
            ratio: scaling.frequency,
            motion,
        });
        self.known.borrow_mut().insert(key, Rc::clone(&moment));
        Ok(moment)
    }

    /// Returns the magnitude at unit RMS. `hz` are frequencies of the recording, i.e. before they
    /// are multiplied by the moment's ratio.
    pub(crate) fn magnitude(&self, moment: &Moment, hz: &[f64]) -> Result<Vec<f64>, Error> {
        Ok(self.model.magnitude(&moment.parameters, self.band(), hz)?)
    }
}
