//! The data of a texture report.

#[derive(Debug, Clone, PartialEq, Default)]
pub struct TextureReport {
    pub title: String,
    /// Paragraphs below the title.
    pub intro: Vec<String>,
    /// The measures by which the page compares the models; each measure becomes a table.
    pub measures: Vec<Measure>,
    /// The textures, in the order of the page.
    pub textures: Vec<Texture>,
    /// For each model, counts of textures with small errors; may be empty.
    pub shares: Vec<Share>,
    /// Further pictures as SVG, shown before the spectra.
    pub pictures: Vec<String>,
    /// The command that generates this page.
    pub command: String,
}

/// Counts for one model: textures whose error is below the difference threshold, and textures whose
/// error is within the recording's own variation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Share {
    /// The model's short name.
    pub short_name: String,
    pub textures: usize,
    /// Number of textures that cannot be felt at all.
    pub below_detection_threshold: usize,
    /// Number of textures whose error is below the difference threshold, in every third octave and
    /// in total.
    pub below_difference_threshold: usize,
    /// Number of textures whose error is below the difference threshold of a person with a
    /// sensitive finger.
    pub below_if_sensitive: usize,
    /// Number of textures whose nine-band error is at most 3.5 times the recording's repeatability.
    pub within_repeatability: usize,
}

/// A measure of how close the models come to the recordings, shown as a table with a row for each
/// texture and a column for each model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Measure {
    /// Caption of the table.
    pub caption: String,
    /// Whether the measure is a correlation, for which 1 is best. Otherwise it is an error in
    /// decibels, for which 0 is best.
    pub is_correlation: bool,
    /// Whether the table also shows the recording's own repeatability, for comparison with the
    /// measure.
    pub repeats: bool,
}

/// One texture at one exploration condition.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Texture {
    pub name: String,
    /// Whether the texture comes from a simulated recording. If so, the page marks the texture as
    /// simulated wherever it names the texture.
    pub simulated: bool,
    /// Unit of the magnitudes: `"N"`, `"m/s2"`, `"m/s"`, `"m"`.
    pub unit: String,
    /// Speed and force as text: `"80 mm/s, 0.40 N"`.
    pub condition: String,
    /// Text that says whether a finger or a tool slid over the texture. It also says how
    /// frequencies and level are predicted for motions that were not recorded. May be empty.
    pub law: String,
    /// Text that says how strongly the texture becomes stronger and weaker in time. May be empty.
    pub fluctuation: String,
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
    /// The models fitted to the texture.
    pub models: Vec<ModelResult>,
    /// Warnings about this texture.
    pub warnings: Vec<String>,
}

/// Result of one model for one texture.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ModelResult {
    /// The model's display name: `"sBeta"`.
    pub model: String,
    /// The model's short name, such as `"sbeta"`. The model's results are in the column with this
    /// name.
    pub short_name: String,
    /// A CSS colour: [`model_color`](crate::report::model_color).
    pub color: String,
    /// The model's magnitude at the texture's frequencies, in the texture's unit.
    pub magnitude: Vec<f64>,
    /// The values of the report's measures, in the order of [`TextureReport::measures`]. Unknown
    /// values at the end may be left out.
    pub measured: Vec<Option<f64>>,
    /// Text below the model's spectrum.
    pub note: String,
    /// Energy of the model relative to the recording in each of the nine bands, decibels.
    pub band_error_db: Vec<f64>,
    /// Size of the parameters, bytes.
    pub payload_bytes: usize,
    /// For a model that is a sum of sinusoids, the frequency (hertz) and amplitude (in the
    /// texture's unit) of each sinusoid. The sinusoids are drawn instead of the magnitude.
    pub lines: Option<Vec<(f64, f64)>>,
}

impl TextureReport {
    /// Returns the first result of each model, in the order in which the models first occur.
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
    /// Returns the name, marked if the texture is simulated.
    pub(crate) fn header(&self) -> String {
        if self.simulated { format!("{} (simulated)", self.name) } else { self.name.clone() }
    }

    /// Returns the unit for plots, and the factor that converts from the texture's unit to it. The
    /// unit is chosen so that the numbers are easy to read.
    pub(crate) fn plotted(&self) -> (f64, &str) {
        match self.unit.as_str() {
            "N" => (1e3, "mN"),
            "m/s2" => (1.0, "m/s²"),
            "m/s" => (1e3, "mm/s"),
            "m" => (1e6, "µm"),
            other => (1.0, other),
        }
    }

    /// Returns the name, and the condition if it is given.
    pub(crate) fn title(&self) -> String {
        match self.condition.as_str() {
            "" => self.header(),
            condition => format!("{}, {condition}", self.header()),
        }
    }

    /// Returns the result of the model `short_name`.
    pub(crate) fn model(&self, short_name: &str) -> Option<&ModelResult> {
        self.models.iter().find(|model| model.short_name == short_name)
    }
}
