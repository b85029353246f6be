//! The data of a texture report.

#[derive(Debug, Clone, PartialEq, Default)]
pub struct TextureReport {
    pub title: String,
    /// Paragraphs below the title.
    pub intro: Vec<String>,
    /// The measures of the models, a table each.
    pub measures: Vec<Measure>,
    /// The textures, in the order of the page.
    pub textures: Vec<Texture>,
    /// Of the textures, how many each model keeps below the difference threshold; may be empty.
    pub shares: Vec<Share>,
    /// Further pictures, as SVG, before the spectra.
    pub pictures: Vec<String>,
    /// The command that generates this page.
    pub command: String,
}

/// Of some textures, how many a model keeps below the difference threshold, and how many within
/// what the recording varies.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Share {
    /// The model's short name.
    pub short_name: String,
    pub textures: usize,
    /// Those whose difference is below the difference threshold in every third octave.
    pub below_difference_threshold: usize,
    /// Those of them for which that holds for a person with a sensitive finger, too.
    pub below_if_sensitive: usize,
    /// Those whose nine-band error is at or below the recording's repeatability.
    pub within_repeatability: usize,
}

/// A measure of how close the models come: a table of textures by models.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measure {
    /// Caption of the table.
    pub caption: String,
    /// Whether it is a correlation, of which 1 is the best, instead of an error in decibels, of
    /// which 0 is.
    pub is_correlation: bool,
    /// Whether it is compared with the recording's own repeatability.
    pub repeats: bool,
}

/// One texture at one exploration condition.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Texture {
    pub name: String,
    /// Whether it was computed instead of recorded; the page states this wherever it names the
    /// texture.
    pub simulated: bool,
    /// The unit of its magnitudes: `"N"`, `"m/s2"`, `"m/s"`, `"m"`.
    pub unit: String,
    /// Speed and force: `"80 mm/s, 0.40 N"`.
    pub condition: String,
    /// What slid over it, and how frequencies and level follow a motion that was not recorded;
    /// empty if it is not said.
    pub law: String,
    /// Size of the recording's file, bytes.
    pub recording_bytes: u64,
    /// Size of the asset's file, bytes.
    pub asset_bytes: u64,
    /// RMS nine-band difference between two parts of the recording, decibels.
    pub repeatability_rms_db: Option<f64>,
    /// The frequencies of all magnitudes, increasing, hertz.
    pub frequency_hz: Vec<f64>,
    /// The recording's magnitude, in the texture's unit.
    pub recorded: Vec<f64>,
    /// The models fitted to it.
    pub models: Vec<ModelResult>,
    /// Warnings about this texture.
    pub warnings: Vec<String>,
}

/// Result of one model on one texture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModelResult {
    /// The model's display name: `"sBeta"`.
    pub model: String,
    /// The model's short name, which determines its column: `"sbeta"`.
    pub short_name: String,
    /// A CSS colour: [`model_color`](crate::model_color).
    pub color: String,
    /// The model's magnitude at the texture's frequencies, in the texture's unit.
    pub magnitude: Vec<f64>,
    /// What the measures of the report found, in their order; one that is not known may be left out
    /// at the end.
    pub measured: Vec<Option<f64>>,
    /// Text below its spectrum.
    pub note: String,
    /// Energy of the model relative to the recording's in each of the nine bands, decibels.
    pub band_error_db: Vec<f64>,
    /// Size of the parameters, bytes.
    pub payload_bytes: usize,
    /// Frequency (hertz) and amplitude (in the texture's unit) of each sinusoid of a model that is
    /// a sum of sinusoids; drawn instead of the magnitude.
    pub lines: Option<Vec<(f64, f64)>>,
}

impl TextureReport {
    /// Returns the first result of each model, in the order of their first occurrence.
    pub(crate) fn models(&self) -> Vec<&ModelResult> {
        let mut found: Vec<&ModelResult> = Vec::new();
        for model in self.textures.iter().flat_map(|texture| &texture.models) {
            if found.iter().all(|m| m.short_name != model.short_name) {
                found.push(model);
            }
        }
        found
    }
}

impl Texture {
    /// Returns the name, marked if it is simulated.
    pub(crate) fn header(&self) -> String {
        if self.simulated { format!("{} (simulated)", self.name) } else { self.name.clone() }
    }

    /// Returns the unit of the plots and the factor to it from the texture's unit, chosen so that
    /// the numbers are easy to read.
    pub(crate) fn plotted(&self) -> (f64, &str) {
        match self.unit.as_str() {
            "N" => (1e3, "mN"),
            "m/s2" => (1.0, "m/s²"),
            "m/s" => (1e3, "mm/s"),
            "m" => (1e6, "µm"),
            other => (1.0, other),
        }
    }

    /// Returns the name and the condition, if it is given.
    pub(crate) fn title(&self) -> String {
        match self.condition.as_str() {
            "" => self.header(),
            condition => format!("{}, {condition}", self.header()),
        }
    }

    /// Returns the result of the model called `short_name`.
    pub(crate) fn model(&self, short_name: &str) -> Option<&ModelResult> {
        self.models.iter().find(|model| model.short_name == short_name)
    }
}
