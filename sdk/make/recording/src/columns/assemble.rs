//! Builds a recording from the columns of a file.

use htex_base::finding::Notice;
use htex_format::Quantity;

use crate::columns::by_order::by_order;
use crate::columns::clock::{self, ReadNotices};
use crate::columns::map::Role;
use crate::columns::motion;
use crate::columns::select::{Chosen, Selection, Values, all_axis_roles, select};
use crate::error::{Fault, cell};
use crate::options::ReadOptions;
use crate::recording::{Recording, RecordingError};
use crate::sheet::{Layout, Sheet, even_numbers};

/// A recording, with the time of each sample if the file has times.
pub(crate) struct TimedRecording {
    pub(crate) recording: Recording,
    pub(crate) time_s: Option<Vec<f64>>,
}

/// Reads a recording from the columns that the map assigns or whose names are known. If the file's
/// channels have no names and there is no map, the order of the channels decides their roles.
pub(crate) fn assemble(
    file: &str,
    sheet: &mut dyn Sheet,
    options: &ReadOptions,
) -> Result<TimedRecording, Fault> {
    match (sheet.layout(), &options.map) {
        (Layout::Channels { are_integers }, None) => Ok(TimedRecording {
            recording: by_order(file, sheet, are_integers, options)?,
            time_s: None,
        }),
        _ => by_name(file, sheet, options),
    }
}

fn by_name(
    file: &str,
    sheet: &mut dyn Sheet,
    options: &ReadOptions,
) -> Result<TimedRecording, Fault> {
    let mut selection = select(sheet.columns(), options.map.as_ref(), options.quantity)?;
    let mut signals = Signals::read(sheet, &selection)?;
    let mut noticed =
        ReadNotices { warnings: std::mem::take(&mut selection.warnings), ..ReadNotices::default() };
    noticed.warnings.extend(signals.warnings());
    let time_s = signals.take_signal(Role::Time);
    let own_hz = match &time_s {
        Some(_) => None,
        None => sheet.rate_hz(signals.wanted())?,
    };
    let given_hz = clock::given(own_hz, options.rate_hz, &mut noticed);
    let rate_hz = clock::rate(file, sheet, time_s.as_deref(), given_hz, &mut noticed)?;
    let simulated = signals.simulated;
    let mut recording = signals.into_recording(options.quantity, file, rate_hz)?;
    recording.simulated = simulated;
    recording.clock_findings = noticed.findings.into_list();
    recording.warnings = noticed.warnings;
    Ok(TimedRecording { recording, time_s })
}

/// The values of each role.
pub(crate) struct Signals {
    /// The columns that were read.
    wanted: Vec<usize>,
    /// The values of each role; taking a role's values removes them.
    roles: Vec<(Role, Vec<f64>)>,
    simulated: bool,
    warnings: Vec<Notice>,
}

impl Signals {
    /// Reads each of the selected columns once and computes the values of the roles.
    pub(crate) fn read(sheet: &mut dyn Sheet, selection: &Selection) -> Result<Self, Fault> {
        let mut wanted: Vec<usize> = selection.chosen.iter().flat_map(Chosen::columns).collect();
        htex_dsp::order::sort(&mut wanted);
        wanted.dedup();
        let mut numbers = even_numbers(sheet, &wanted)?;
        let rows = numbers.columns.first().map_or(0, Vec::len);
        let mut roles = Vec::with_capacity(selection.chosen.len());
        for (at, chosen) in selection.chosen.iter().enumerate() {
            let later = &selection.chosen[at + 1..];
            let values = values(chosen, later, &wanted, &mut numbers.columns, rows);
            check_computed(sheet, chosen, &values)?;
            roles.push((chosen.role, values));
        }
        Ok(Self {
            wanted,
            roles,
            simulated: numbers.simulated,
            warnings: numbers.warnings.into_iter().map(Notice::from).collect(),
        })
    }

    /// Returns the columns that were read.
    pub(crate) fn wanted(&self) -> &[usize] {
        &self.wanted
    }

    /// Takes the warnings that arose while reading.
    pub(crate) fn warnings(&mut self) -> Vec<Notice> {
        std::mem::take(&mut self.warnings)
    }

    pub(crate) fn take_signal(&mut self, role: Role) -> Option<Vec<f64>> {
        let mut roles = self.roles.iter_mut();
        let (_, values) = roles.find(|(own, values)| *own == role && !values.is_empty())?;
        Some(std::mem::take(values))
    }

    pub(crate) fn take_all(&mut self, roles: &[Role]) -> Vec<Vec<f64>> {
        roles.iter().filter_map(|role| self.take_signal(*role)).collect()
    }

    fn into_recording(
        mut self,
        quantity: Quantity,
        file: &str,
        rate_hz: f64,
    ) -> Result<Recording, RecordingError> {
        let roles: Vec<Role> = all_axis_roles(quantity).collect();
        let axes = self.take_all(&roles);
        let normal = match quantity {
            Quantity::NormalForce => axes.first().cloned(),
            _ => self.take_signal(Role::Normal),
        };
        let mut recording = Recording::from_axes(quantity, file, rate_hz, axes)?;
        if let Some(normal) = normal {
            recording = recording.with_normal(normal)?;
        }
        if let Some(speed) = self.take_signal(Role::Speed) {
            return recording.with_speed(speed);
        }
        let position = self.take_all(&[Role::X, Role::Y]);
        if position.is_empty() {
            return Ok(recording);
        }
        let coordinates: Vec<&[f64]> = position.iter().map(Vec::as_slice).collect();
        recording.with_speed(motion::speed_mm_s(&coordinates, rate_hz))
    }
}

/// Computes a role's values. A column that no later role needs is moved out of `columns`, not
/// copied.
fn values(
    chosen: &Chosen,
    later: &[Chosen],
    wanted: &[usize],
    columns: &mut [Vec<f64>],
    rows: usize,
) -> Vec<f64> {
    // Every column of the selection is among the wanted ones.
    let place = |column: usize| wanted.binary_search(&column).unwrap_or(0);
    match &chosen.values {
        Values::Formula { formula, .. } => {
            formula.values(rows, chosen.scale, |column| &columns[place(column)][..])
        }
        Values::Column(column) => {
            let is_needed = later.iter().any(|other| other.columns().contains(column));
            let own = &mut columns[place(*column)];
            let mut values = if is_needed { own.clone() } else { std::mem::take(own) };
            if chosen.scale != 1.0 {
                values.iter_mut().for_each(|value| *value *= chosen.scale);
            }
            values
        }
    }
}

/// Refuses an expression whose values are not finite, such as a division by zero.
fn check_computed(sheet: &dyn Sheet, chosen: &Chosen, values: &[f64]) -> Result<(), Fault> {
    let Values::Formula { text, .. } = &chosen.values else {
        return Ok(());
    };
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(row) => {
            let problem = format!("the expression is {} there", values[row]);
            Err(cell(sheet.place(row), &htex_base::finding::plain(text), problem))
        }
    }
}
