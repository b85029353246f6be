//! Named settings for reading recordings.

use std::path::PathBuf;

use htex_format::Quantity;

use super::one_or_more;
use super::setting::settings;
use crate::{AuthorError, Averaging, SegmentChoice, SpectrumOptions};
use htex_recording::read_response;
use htex_recording::{ColumnMap, ReadOptions, Tracker};

settings! {
    /// Settings for reading recordings. A setting that is missing has its default value.
    ///
    /// ```
    /// use htex_author::settings::ReadingSettings;
    /// let settings = ReadingSettings { rate_hz: Some(20_000.0), ..Default::default() };
    /// assert_eq!(settings.read_options(1)?[0].rate_hz, Some(20_000.0));
    /// assert_eq!(settings.recorded()["rate"], "20000");
    /// # Ok::<(), htex_author::AuthorError>(())
    /// ```
    pub struct ReadingSettings {
        /// Sample rate of the recordings, hertz, for files that do not state it.
        #[cfg_attr(feature = "schemars", schemars(range(max = htex_recording::MAX_RATE_HZ), extend("exclusiveMinimum" = 0)))]
        #[cfg_attr(feature = "clap", arg(
            value_name = "HZ",
            help = "Sample rate, Hz; needed if the file does not state it (NPY, CSV without a time \
                    column)"
        ))]
        pub rate_hz: Option<f64> = "rate",

        /// The column map: roles and scales of the recordings' columns, in the syntax of the
        /// command's `--map`.
        #[cfg_attr(feature = "clap", arg(
            value_name = "MAP",
            help = "What the columns or channels of a recording mean, and their scales: \
                    ROLE=COLUMN, ROLE=COLUMN:SCALE or ROLE=EXPRESSION, separated by commas, e.g. \
                    lateral=lateral_V:0.4444,normal=-(fz1+fz2)*0.31. Roles and their units after \
                    scaling: lateral, lateral_x, lateral_y and normal (N), speed (mm/s), time (s), \
                    x and y (mm). For a --quantity other than the lateral force, use signal, \
                    signal_x, signal_y and signal_z instead of lateral (in the unit of the \
                    quantity). A column is a name, a number (#3) or a path (/run1/fx). Put a name \
                    that contains an operator in quotes"
        ))]
        pub map: Option<String> = "map",

        /// Tracker files with the finger's motion: one file for each recording, or one file for all
        /// recordings.
        #[serde(deserialize_with = "one_or_more")]
        #[cfg_attr(feature = "schemars", schemars(
            with = "Option<String>",
            description = "File of a tracker with the finger's motion for each recording, a template, relative to the recipe."
        ))]
        #[cfg_attr(feature = "clap", arg(
            value_name = "FILE",
            help = "Read the finger's motion from this file of a tracker, which may have its own \
                    sample rate. The file has the columns time, x and y (or time and speed). Its \
                    times are on the clock of the recording; a recording without times begins at 0 \
                    s. Give one file for each recording, or one for all"
        ))]
        pub tracker: Option<Vec<PathBuf>> = "tracker",

        /// The column map of the trackers: roles and scales of their columns, in the syntax of the
        /// command's `--tracker-map`.
        #[cfg_attr(feature = "clap", arg(
            value_name = "MAP",
            requires = "tracker",
            help = "What the columns of the tracker's file mean, and their scales, written as for \
                    --map, e.g. time=stamp_ms:0.001,x=#2,y=#3"
        ))]
        pub tracker_map: Option<String> = "tracker-map",

        /// Physical quantity of the texture's signal, such as a lateral force.
        #[cfg_attr(feature = "clap", arg(
            value_enum,
            default_value = "lateral-force",
            help = "Quantity of the texture's signal: a force (N), an acceleration, e.g. of a tool \
                    tip (m/s2), a velocity (m/s) or a displacement (m)"
        ))]
        pub quantity: Option<Quantity> = "quantity",

        /// Value of a full-scale sample in files that contain only samples (WAV, FLAC, NPY), in the
        /// quantity's unit; not 0.
        #[cfg_attr(feature = "schemars", schemars(extend("not" = { "const": 0 })))]
        #[cfg_attr(feature = "clap", arg(
            value_name = "UNITS",
            help = "Value for which a full-scale sample stands in WAV, FLAC and NPY files, in the \
                    unit of --quantity"
        ))]
        pub scale: Option<f64> = "scale",

        /// File with the frequency response of the recording setup. Spectra are divided by this
        /// response.
        #[cfg_attr(feature = "schemars", schemars(description = "File of the setup's response, relative to the recipe."))]
        #[cfg_attr(feature = "clap", arg(
            value_name = "CSV",
            help = "Divide the spectra by this frequency response of the recording setup: CSV with \
                    the columns frequency_hz, magnitude and, if known, phase_rad"
        ))]
        pub response: Option<PathBuf> = "frf",

        /// Start of the part to read, in seconds after the file's first sample.
        #[cfg_attr(feature = "clap", arg(value_name = "S", help = "Read the recording from this time on, s"))]
        pub from_s: Option<f64> = "from",

        /// End of the part to read, in seconds after the file's first sample.
        #[cfg_attr(feature = "clap", arg(value_name = "S", help = "Read the recording up to this time, s"))]
        pub to_s: Option<f64> = "to",

        /// Largest number of values that may be kept in memory.
        #[cfg_attr(feature = "schemars", schemars(skip))]
        #[cfg_attr(feature = "clap", arg(
            long = "most-numbers",
            value_name = "N",
            default_value = "40000000",
            help = "Maximum number of values of a recording to keep in memory. Each value takes 8 \
                    to 40 bytes. Columns that are not used do not count"
        ))]
        pub most_values: Option<usize>,

        /// Method of choosing segments.
        #[cfg_attr(feature = "clap", arg(
            value_enum,
            help = "Which segments of the recording to use. `sweeps`: the middle of each complete \
                    sweep. `windows`: evenly spaced windows. `auto`: sweeps if they represent at \
                    least half of the sliding, otherwise windows; a sweep represents at most 2 s \
                    [default: auto]"
        ))]
        pub segments: Option<SegmentChoice> = "segments",

        /// Method of averaging segments.
        #[cfg_attr(feature = "clap", arg(
            value_enum,
            help = "How to average the segments. `rms` averages the power, so that noise keeps its \
                    level. `magnitude` averages the magnitudes, as the paper probably does; noise \
                    is then 1.05 dB too low. `complex` averages the complex spectra, so that only \
                    signals with the same phase in all segments remain [default: rms]"
        ))]
        pub averaging: Option<Averaging> = "averaging",
    }
}

impl ReadingSettings {
    /// Returns the options for reading each of `count` recordings.
    ///
    /// # Errors
    /// Returns an error if a column map cannot be read, or if the number of trackers is neither one
    /// nor `count`.
    pub fn read_options(&self, count: usize) -> Result<Vec<ReadOptions>, AuthorError> {
        let options = ReadOptions::default()
            .with_rate_hz(self.rate_hz)
            .with_map(parsed("map", self.map.as_deref())?)
            .with_quantity(self.quantity.unwrap_or_default())
            .with_scale(self.scale)
            .with_from_s(self.from_s)
            .with_to_s(self.to_s)
            .with_most_values(self.most_values);
        let map = parsed("tracker_map", self.tracker_map.as_deref())?;
        let tracked = |file: &PathBuf| {
            let tracker = Tracker::new(file).with_map(map.clone());
            options.clone().with_tracker(tracker)
        };
        match self.tracker.as_deref().unwrap_or_default() {
            [] => Ok(vec![options; count]),
            [one] => Ok(vec![tracked(one); count]),
            all if all.len() == count => Ok(all.iter().map(tracked).collect()),
            all => Err(AuthorError::Trackers { trackers: all.len(), recordings: count }),
        }
    }

    /// Returns whether a setting determines how columns of the recordings are read. Such settings
    /// are the rate, the scale, the map, the tracker, and a quantity other than the default.
    #[must_use]
    pub fn says_columns(&self) -> bool {
        let scaled = self.rate_hz.or(self.scale).is_some();
        let is_other = self.quantity.unwrap_or_default() != Quantity::default();
        scaled || self.map.is_some() || self.tracker.is_some() || is_other
    }

    /// Returns the options for computing spectra. If a file with the setup's response is given,
    /// this method reads it.
    ///
    /// # Errors
    /// Returns an error if the response cannot be read.
    pub fn spectrum_options(&self) -> Result<SpectrumOptions, AuthorError> {
        let response = self.response.as_deref().map(read_response);
        Ok(SpectrumOptions::default()
            .with_segments(self.segments.unwrap_or_default())
            .with_averaging(self.averaging.unwrap_or_default())
            .with_response(response.transpose()?))
    }
}

/// Reads a map of columns.
fn parsed(keyword: &'static str, text: Option<&str>) -> Result<Option<ColumnMap>, AuthorError> {
    let map = text.map(|text| {
        let map = text.parse::<ColumnMap>();
        map.map_err(|error| AuthorError::Map {
            keyword,
            text: text.to_owned(),
            error: Box::new(error),
        })
    });
    map.transpose()
}
