//! What the writer of a library states about a texture in addition to the texture's manifest.

use crate::library::coarse_spectrum::CoarseSpectrum;

/// Values that the writer of a library computes for a texture, so that programs can search for the
/// texture. The library stores them in addition to the facts in the manifest. Only a program with
/// the texture's model can compute these values. Therefore, programs that only read and validate
/// libraries do not check the values.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Description {
    /// The texture's spectrum at its default condition; `None` if the texture is silent, or if the
    /// writer does not know the texture's models.
    pub spectrum: Option<CoarseSpectrum>,
    /// The felt difference between the texture and its recordings at the worst condition: RMS over
    /// third-octave bands, decibels. `None` if it is not known.
    pub felt_error_rms_db: Option<f64>,
    /// The held-out error of the texture at the worst recorded condition: RMS over third-octave
    /// bands, decibels. `None` if the texture does not state it.
    pub held_out_error_db: Option<f64>,
}

impl Description {
    /// Returns this description. Values that it lacks are taken from `other`.
    #[cfg(feature = "write")]
    pub(crate) fn or(self, other: Self) -> Self {
        Self {
            spectrum: self.spectrum.or(other.spectrum),
            felt_error_rms_db: self.felt_error_rms_db.or(other.felt_error_rms_db),
            held_out_error_db: self.held_out_error_db.or(other.held_out_error_db),
        }
    }
}
