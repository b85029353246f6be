//! Recordings as CSV.

use htex_format::Quantity;

use super::blocks::Blocks;
use super::clock::{self, Noticed};
use super::map::Role;
use super::motion;
use super::select::{Selection, all_axis_roles, select};
use super::table::Table;
use super::{ReadError, ReadOptions};
use crate::recording::{Recording, RecordingError};

/// Reads a CSV, block by block.
pub(crate) fn read(mut blocks: Blocks<'_>, options: &ReadOptions) -> Result<Recording, ReadError> {
    let file = blocks.file;
    if options.scale.is_some() {
        return Err(ReadError::Option {
            file: file.to_owned(),
            option: "scale",
            problem: "a scale is for WAV and NPY; scale a CSV's columns in the column map, as in lateral=COLUMN:SCALE"
                .into(),
        });
    }
    let head = blocks.head()?;
    let mut table = Table::new(file, &head)?;
    let mut selection = select(&table, options.map.as_ref(), options.quantity)?;
    let wanted: Vec<usize> = selection
        .chosen
        .iter()
        .map(|chosen| chosen.column)
        .collect();
    let mut numbers = table.numbers(&wanted, &mut blocks)?;
    for (values, chosen) in numbers.columns.iter_mut().zip(&selection.chosen) {
        if chosen.scale != 1.0 {
            values.iter_mut().for_each(|value| *value *= chosen.scale);
        }
    }
    let mut noticed = Noticed {
        warnings: std::mem::take(&mut selection.warnings),
        ..Noticed::default()
    };
    let mut signals = Signals {
        selection,
        columns: numbers.columns,
    };
    let time_s = signals.take(Role::Time);
    let rate_hz = clock::rate(&table, time_s.as_deref(), options.rate_hz, &mut noticed)?;
    let mut recording = signals
        .into_recording(options.quantity, file, rate_hz)
        .map_err(|source| ReadError::Recording {
            file: file.to_owned(),
            source,
        })?;
    recording.simulated = numbers.simulated;
    recording.clock_findings = noticed.findings.into_list();
    recording.warnings = noticed.warnings;
    Ok(recording)
}

/// The columns that were read, in the order of the selection; each is removed once.
struct Signals {
    selection: Selection,
    columns: Vec<Vec<f64>>,
}

impl Signals {
    fn take(&mut self, role: Role) -> Option<Vec<f64>> {
        let position = self.selection.position(role)?;
        self.columns.get_mut(position).map(std::mem::take)
    }

    fn take_all(&mut self, roles: &[Role]) -> Vec<Vec<f64>> {
        roles.iter().filter_map(|role| self.take(*role)).collect()
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
            _ => self.take(Role::Normal),
        };
        let mut recording = Recording::of(quantity, file, rate_hz, axes)?;
        if let Some(normal) = normal {
            recording = recording.with_normal(normal)?;
        }
        if let Some(speed) = self.take(Role::Speed) {
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
