//! The data of a take, on disk and in memory.

use htex_author::recording::{MAX_RATE_HZ, Role};
use htex_format::Quantity;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::record::coverage::Requirements;
use crate::record::files::{self, Format};
use crate::record::setup::LONGEST_S;

/// Roles that are axes of the texture's signal.
const AXES: [&str; 7] =
    ["lateral", "lateral_x", "lateral_y", "signal", "signal_x", "signal_y", "signal_z"];

/// The header of a take, which states how the take was recorded. It is the first line of a part
/// file, and the object `take` in the JSON next to a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct TakeHeader {
    /// Version of this structure: 1.
    #[schemars(extend("const" = 1))]
    pub htex_take: u32,
    /// Name that all takes of the session share.
    #[schemars(regex(pattern = files::NAME_PATTERN))]
    pub name: String,
    /// Number of the take, from 1.
    #[schemars(range(min = 1))]
    pub number: u32,
    /// Name and version of the program that recorded the take.
    pub tool: String,
    /// The source, as the user named it.
    pub source: String,
    /// The map of channels, if one was given.
    pub map: Option<String>,
    /// Calibration matrices, row by row.
    pub calibrations: Vec<Vec<f64>>,
    /// Quantity of the texture's signal.
    pub quantity: Quantity,
    /// Sample rate, hertz; a whole number for a WAV file.
    #[schemars(range(max = MAX_RATE_HZ), extend("exclusiveMinimum" = 0))]
    pub rate_hz: f64,
    /// Length of a complete take, seconds.
    #[schemars(range(max = LONGEST_S), extend("exclusiveMinimum" = 0))]
    pub seconds: f64,
    /// The role and the unit of each recorded signal. No role occurs twice.
    #[schemars(with = "Vec<SignalText>", length(min = 1))]
    pub signals: Vec<(String, String)>,
    /// For each signal, the mean that was subtracted as tare. Empty if the session has no tare.
    pub tare: Vec<f64>,
    /// The role and the unit of each signal of the tracker, except the time. No role occurs twice.
    /// Empty if there is no tracker.
    #[schemars(with = "Vec<SignalText>")]
    pub tracker: Vec<(String, String)>,
    pub target_speed_mm_s: Option<f64>,
    /// Target normal force, newtons.
    pub target_force_n: Option<f64>,
    /// Allowed relative difference of speed and force from their targets.
    pub tolerance: f64,
    /// Requirements that the take must meet to be accepted.
    pub required: Requirements,
    /// Format of the recording: see [`Format`].
    pub format: Format,
}

/// Longest unit of a signal, bytes.
const MOST_UNIT: usize = 16;

/// Returns the names of the roles that a take's signal may have: all except the time.
fn roles() -> impl Iterator<Item = &'static str> {
    let names = Role::ALL.iter().map(|role| role.name());
    names.filter(|name| *name != "time")
}

/// Schema of a signal: its role, and its unit in printable ASCII without commas.
struct SignalText;

impl JsonSchema for SignalText {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Signal".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let roles: Vec<&str> = roles().collect();
        schemars::json_schema!({
            "description": "A signal: its role and its unit.",
            "type": "array",
            "prefixItems": [
                { "enum": roles },
                { "type": "string", "pattern": format!("^[!-+\\--~]{{0,{MOST_UNIT}}}$") },
            ],
            "minItems": 2,
            "maxItems": 2,
        })
    }
}

/// Returns the JSON Schema of a take's header, version 1: `spec/schemas/take-1.json`.
pub fn take_schema() -> Value {
    htex_base::schema::crossing::<TakeHeader>("take-1.json", "header of a take of htex 1")
}

/// A take in memory: its header and its samples.
#[derive(Debug, Clone, PartialEq)]
pub struct TakeData {
    pub header: TakeHeader,
    /// Samples of each signal, all of the same length.
    pub signals: Vec<Vec<f64>>,
    /// Columns of the tracker: first the times since the start of the take (s), then the values of
    /// each signal.
    pub tracker: Vec<Vec<f64>>,
}

impl TakeData {
    /// Creates a take without samples.
    #[must_use]
    pub fn empty(header: TakeHeader) -> Self {
        let signals = vec![Vec::new(); header.signals.len()];
        let tracked = match header.tracker.len() {
            0 => 0,
            signals => signals + 1,
        };
        Self { header, signals, tracker: vec![Vec::new(); tracked] }
    }

    #[must_use]
    pub fn frames(&self) -> usize {
        self.signals.first().map_or(0, Vec::len)
    }

    #[must_use]
    pub fn recorded_s(&self) -> f64 {
        self.frames() as f64 / self.header.rate_hz
    }

    /// Returns whether the take has as many frames as a complete take.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.frames() >= self.header.frames()
    }

    /// Appends interleaved frames.
    pub(crate) fn extend(&mut self, frames: &[f64]) {
        spread(&mut self.signals, frames);
    }

    /// Appends interleaved rows of the tracker. Leaves out rows that are not finite or that are not
    /// later than the previous row, because positions could not be interpolated between them.
    pub(crate) fn extend_tracker(&mut self, rows: &[f64]) {
        // Without a tracker there are no columns, and chunks of length 0 would cause a panic.
        for row in rows.chunks_exact(self.tracker.len().max(1)) {
            let last_s = self.tracker.first().and_then(|time_s| time_s.last());
            if row.iter().all(|value| value.is_finite()) && last_s.is_none_or(|t| row[0] > *t) {
                spread(&mut self.tracker, row);
            }
        }
    }
}

impl TakeHeader {
    /// Reads a header from JSON.
    ///
    /// # Errors
    /// Returns a text that states what is wrong: the header has another version, unknown keys, or
    /// values that no session writes.
    pub fn of_json(json: Value) -> Result<Self, String> {
        let version = &json["htex_take"];
        if *version != 1 {
            return Err(format!("its version is {version}, and this htex reads 1"));
        }
        htex_base::schema::check_keys::<Self>(&json)?;
        let header: Self = serde_json::from_value(json).map_err(|error| error.to_string())?;
        match header.problem() {
            None => Ok(header),
            Some(problem) => Err(problem.to_owned()),
        }
    }

    /// Returns the number of frames in a complete take.
    #[must_use]
    pub fn frames(&self) -> usize {
        (self.seconds * self.rate_hz).round() as usize
    }

    /// Returns a problem with the header, if it has values that no session would have written. A
    /// part file may be damaged, or may come from another program.
    fn problem(&self) -> Option<&'static str> {
        let has_known_roles = |signals: &[(String, String)]| {
            let mut names: Vec<&str> = signals.iter().map(|(role, _)| &role[..]).collect();
            let all = names.len();
            names.sort_unstable();
            names.dedup();
            names.len() == all && names.iter().all(|name| roles().any(|role| role == *name))
        };
        let has_units = |signals: &[(String, String)]| {
            let is_unit = |unit: &str| {
                let is_sound = |b: u8| b.is_ascii_graphic() && b != b',';
                unit.len() <= MOST_UNIT && unit.bytes().all(is_sound)
            };
            signals.iter().all(|(_, unit)| is_unit(unit))
        };
        // A WAV file stores its rate as a whole number of 32 bits.
        let is_whole = self.rate_hz.fract() == 0.0 && self.rate_hz <= f64::from(u32::MAX);
        let checks = [
            (self.number >= 1, "its number is 0; takes count from 1"),
            (files::check_name(&self.name).is_ok(), "its name is no name of a take"),
            (self.rate_hz > 0.0 && self.rate_hz <= MAX_RATE_HZ, "its sample rate is out of range"),
            (self.seconds > 0.0 && self.seconds <= LONGEST_S, "its length is out of range"),
            (
                (0.0..=1.0).contains(&self.required.on_target),
                "the share on target that it requires is out of range",
            ),
            (!self.signals.is_empty(), "it has no signals"),
            (
                has_known_roles(&self.signals) && has_known_roles(&self.tracker),
                "its signals do not belong to a take",
            ),
            (has_units(&self.signals) && has_units(&self.tracker), "its units are no units"),
            (self.format != Format::Wav || is_whole, "its sample rate is not possible in a WAV"),
        ];
        let failed = checks.into_iter().find(|(holds, _)| !holds);
        failed.map(|(_, problem)| problem)
    }

    /// Returns the index of the signal with this role.
    #[must_use]
    pub fn signal(&self, role: &str) -> Option<usize> {
        self.signals.iter().position(|(own, _)| own == role)
    }
}

/// Returns the indices of the signals that are axes of the texture's signal, in the order of
/// [`AXES`]. Without any, returns the index of the normal force.
pub(crate) fn texture_axes(signals: &[(String, String)]) -> Vec<usize> {
    let position = |role: &&str| signals.iter().position(|(own, _)| own == role);
    let axes: Vec<usize> = AXES.iter().filter_map(position).collect();
    if axes.is_empty() { position(&"normal").into_iter().collect() } else { axes }
}

fn spread(columns: &mut [Vec<f64>], rows: &[f64]) {
    let width = columns.len().max(1);
    for row in rows.chunks_exact(width) {
        for (column, value) in columns.iter_mut().zip(row) {
            column.push(*value);
        }
    }
}
