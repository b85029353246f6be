//! Models that are called through a table of native functions: built-in models and native
//! libraries.

use htex_model::abi::ModelTable;
use htex_model::motion_1::MotionTable;
use htex_model::voices_1::VoicesTable;
use htex_model::{Band, FitInput, Motion};

use crate::probe::{ProbeArguments, Unusable};
use crate::raw::{RawModel, RawVoice, Together};

/// A model that is called through a table of native functions.
#[derive(Clone, Copy)]
pub(crate) struct TableModel {
    table: &'static ModelTable,
    /// Present if the model has the extension `htex.voices/1`.
    voices: Option<&'static VoicesTable>,
    /// Present if the model has the extension `htex.motion/1`.
    motion: Option<&'static MotionTable>,
}

impl TableModel {
    pub(crate) fn new(
        table: &'static ModelTable,
        voices: Option<&'static VoicesTable>,
        motion: Option<&'static MotionTable>,
    ) -> Self {
        Self { table, voices, motion }
    }

    pub(crate) fn table(&self) -> &'static ModelTable {
        self.table
    }
}

// Each call below passes slices that are readable or writable for their whole length during the
// call, as the ABI requires. Only a voice's `TableVoice` has the voice's handle.
impl RawModel for TableModel {
    fn abi_version(&self) -> u32 {
        (self.table.abi_version)()
    }

    fn descriptor(&self, out: &mut [u8]) -> i64 {
        // SAFETY: a live slice.
        unsafe { (self.table.descriptor)(out.as_mut_ptr(), out.len()) }
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        // SAFETY: a live slice.
        unsafe { (self.table.last_error)(out.as_mut_ptr(), out.len()) }
    }

    fn fit(&self, input: &FitInput<'_>, parameters: &mut [f64], level_rms: &mut f64) -> i64 {
        let bins = input.frequency_hz.len().min(input.magnitude.len());
        if let Some(motion) = self.motion {
            let (speed_mm_s, force_n) = input.condition.numbers();
            // SAFETY: the slices are live. For the two slices of the spectrum, the shorter length
            // is used.
            return unsafe {
                (motion.fit)(
                    input.band.low_hz,
                    input.band.high_hz,
                    input.frequency_hz.as_ptr(),
                    input.magnitude.as_ptr(),
                    bins,
                    input.signal.as_ptr(),
                    input.signal.len(),
                    input.signal_rate_hz,
                    input.options.as_ptr(),
                    input.options.len(),
                    speed_mm_s,
                    force_n,
                    parameters.as_mut_ptr(),
                    parameters.len(),
                    level_rms,
                )
            };
        }
        // SAFETY: the slices are live. For the two slices of the spectrum, the shorter length is
        // used.
        unsafe {
            (self.table.fit)(
                input.band.low_hz,
                input.band.high_hz,
                input.frequency_hz.as_ptr(),
                input.magnitude.as_ptr(),
                bins,
                input.signal.as_ptr(),
                input.signal.len(),
                input.signal_rate_hz,
                input.options.as_ptr(),
                input.options.len(),
                parameters.as_mut_ptr(),
                parameters.len(),
                level_rms,
            )
        }
    }

    fn magnitude(
        &self,
        parameters: &[f64],
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> i64 {
        // SAFETY: the slices are live. For both slices, the shorter length is used.
        unsafe {
            (self.table.magnitude)(
                parameters.as_ptr(),
                parameters.len(),
                band.low_hz,
                band.high_hz,
                frequency_hz.as_ptr(),
                magnitude.as_mut_ptr(),
                frequency_hz.len().min(magnitude.len()),
            )
        }
    }

    fn interpolate(&self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        // SAFETY: live slices.
        unsafe {
            (self.table.interpolate)(
                sets.as_ptr(),
                sets.len(),
                weights.as_ptr(),
                weights.len(),
                parameters.as_mut_ptr(),
                parameters.len(),
            )
        }
    }

    fn extension(&self, id: &[u8]) -> i64 {
        // SAFETY: a live slice.
        unsafe { (self.table.extension)(id.as_ptr(), id.len()) }
    }

    fn follows_motion(&self) -> bool {
        self.motion.is_some()
    }

    fn unusable_arrays(&self, arguments: &ProbeArguments<'_>) -> Option<Vec<Unusable>> {
        Some(self.probe(arguments))
    }

    fn voice_rate(&self, parameters: &[f64], band: Band, wanted_hz: f64) -> f64 {
        let (low, high) = band.edges();
        // SAFETY: a live slice.
        unsafe {
            (self.table.voice_rate)(parameters.as_ptr(), parameters.len(), low, high, wanted_hz)
        }
    }

    fn voice_new(
        &self,
        parameters: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Box<dyn RawVoice>, i64> {
        let (low, high) = band.edges();
        // SAFETY: a live slice.
        let handle = unsafe {
            (self.table.voice_new)(parameters.as_ptr(), parameters.len(), low, high, rate_hz, seed)
        };
        if handle <= 0 {
            return Err(handle);
        }
        Ok(Box::new(TableVoice { model: *self, handle, freed: false }))
    }
}

/// A voice and its handle. No other value contains the handle.
struct TableVoice {
    model: TableModel,
    handle: i64,
    freed: bool,
}

impl RawVoice for TableVoice {
    fn render(&mut self, out: &mut [f32]) -> i64 {
        // SAFETY: a live slice; `&mut self` restricts the handle to one thread at a time.
        unsafe { (self.model.table.voice_render)(self.handle, out.as_mut_ptr(), out.len()) }
    }

    fn retune(&mut self, parameters: &[f64]) -> i64 {
        // SAFETY: a live slice; `&mut self` restricts the handle to one thread at a time.
        unsafe {
            (self.model.table.voice_retune)(self.handle, parameters.as_ptr(), parameters.len())
        }
    }

    fn set_motion(&mut self, motion: Motion) -> i64 {
        let Some(table) = self.model.motion else {
            return 0;
        };
        // SAFETY: `&mut self` restricts the handle to one thread at a time.
        unsafe {
            (table.set)(
                self.handle,
                motion.speed_mm_s,
                motion.force_n,
                motion.position_mm,
                motion.x_mm,
                motion.y_mm,
            )
        }
    }

    fn interpolate(&mut self, sets: &[f64], weights: &[f64], parameters: &mut [f64]) -> i64 {
        self.model.interpolate(sets, weights, parameters)
    }

    fn free(&mut self) -> i64 {
        self.freed = true;
        (self.model.table.voice_free)(self.handle)
    }

    fn together(&self) -> Option<Together> {
        Some(Together {
            render: self.model.voices?.render,
            table: self.model.table,
            handle: self.handle,
        })
    }

    fn last_error(&self, out: &mut [u8]) -> i64 {
        // SAFETY: a live slice.
        unsafe { (self.model.table.last_error)(out.as_mut_ptr(), out.len()) }
    }
}

impl Drop for TableVoice {
    fn drop(&mut self) {
        if !self.freed {
            // `drop` cannot report an error of the model.
            (self.model.table.voice_free)(self.handle);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use htex_model::{
        Error, Fit, FitCondition, FitInput, Model, MotionVoice, Numbers, StaticDescriptor,
        StaticField, Values, Voice,
    };

    use super::*;
    use crate::{LoadedModel, Origin};

    /// A model for tests. Its samples are positions, and its parameter is the speed of the
    /// recording.
    struct Ruler;
    struct Finger(f32);

    htex_model::export_model!(Ruler, symbols: "plugin", extensions: [motion]);

    impl Model for Ruler {
        type Voice = Finger;
        const DESCRIPTOR: StaticDescriptor =
            StaticDescriptor::new("org.example.ruler", "Ruler", "1.0.0", "Positions.")
                .fields(&[StaticField::scalar("speed_mm_s", "mm/s", (0.0, 1e3), "Speed.")]);

        fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
            Ok(Fit {
                parameters: vec![input.condition.speed_mm_s.unwrap_or(1.0)],
                level_rms: input.condition.force_n.unwrap_or(1.0),
            })
        }

        fn magnitude(_: &Values<'_>, _: Band, _: &[f64], m: &mut [f64]) -> Result<(), Error> {
            m.fill(0.0);
            Ok(())
        }

        fn interpolate(sets: &[Values<'_>], _: &[f64], out: &mut Numbers<'_>) -> Result<(), Error> {
            out.extend(sets[0].flat());
            Ok(())
        }

        fn voice(_: &Values<'_>, _: Band, _: f64, _: u64) -> Result<Finger, Error> {
            Ok(Finger(0.0))
        }
    }

    impl Voice for Finger {
        fn render(&mut self, out: &mut [f32]) {
            out.fill(self.0);
        }

        fn retune(&mut self, _: &Values<'_>) -> Result<(), Error> {
            Ok(())
        }
    }

    impl MotionVoice for Finger {
        fn set_motion(&mut self, motion: Motion) {
            self.0 = motion.position_mm as f32;
        }
    }

    #[test]
    fn a_built_in_model_receives_the_motion_if_its_table_has_the_extension() {
        let motion =
            Motion { speed_mm_s: 80.0, force_n: 0.4, position_mm: 12.0, x_mm: 12.0, y_mm: 0.0 };
        let condition = FitCondition { speed_mm_s: Some(80.0), force_n: Some(0.4) };
        for follows in [true, false] {
            let motion_table = MOTION.as_ref().filter(|_| follows);
            let table = TableModel::new(&TABLE, Some(&VOICES), motion_table);
            let model = LoadedModel::new(Origin::Builtin, Arc::new(table)).unwrap();
            assert_eq!(model.follows_motion(), follows);
            let band = crate::Band::TACTILE;
            let request = FitInput {
                band,
                frequency_hz: &[50.0, 100.0, 150.0],
                magnitude: &[1.0; 3],
                signal: &[],
                signal_rate_hz: 1.0,
                options: &[],
                condition,
            };
            let fit = model.fit(&request).unwrap();
            let known = if follows { (80.0, 0.4) } else { (1.0, 1.0) };
            assert_eq!((fit.parameters[0], fit.level_rms), known);
            let mut voice = model.voice(&fit.parameters, band, 2_000.0, 1).unwrap();
            voice.set_motion(motion).unwrap();
            let mut out = [0.0];
            voice.render(&mut out).unwrap();
            assert_eq!(out[0], if follows { 12.0 } else { 0.0 });
        }
    }
}
