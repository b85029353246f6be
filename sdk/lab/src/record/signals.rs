//! From the channels of a source to forces and positions.

use htex_author::recording::{ColumnMap, Role, RowMap};
use htex_device::Channel;
use htex_finding::Notice;
use htex_format::Quantity;

use crate::record::calibration::{AXES, Calibration};
use crate::record::error::RecordError;

/// Conversion of a source's channels: calibration of six-axis sensors, then the map to roles, then
/// tare.
#[derive(Debug)]
pub struct Signals {
    width: usize,
    calibrations: Vec<Calibration>,
    map: RowMap,
    /// Indices of the recorded values among those of the map: a time of the source is not recorded.
    kept: Vec<usize>,
    roles: Vec<Role>,
    offsets: Vec<f64>,
}

impl Signals {
    /// Makes the conversion. The n-th calibration is of the n-th six channels, which become
    /// `fx, fy, fz, tx, ty, tz` (of several sensors `fx1`, `fx2` and so on); other channels keep
    /// their names. The map, or the names, assign them to roles: two sensors are summed by
    /// `lateral_x=fx1+fx2`.
    ///
    /// # Errors
    /// When there are fewer channels than the calibrations need, or the channels do not fit the
    /// map.
    pub fn new(
        source: &str,
        channels: &[Channel],
        calibrations: Vec<Calibration>,
        map: Option<&ColumnMap>,
        quantity: Quantity,
    ) -> Result<Self, RecordError> {
        if channels.len() < AXES * calibrations.len() {
            return Err(RecordError::Setup {
                what: "the number of channels",
                value: channels.len().to_string(),
                allowed: "each calibration needs six channels, the first six, the next six and so on",
            });
        }
        let names = named(channels, calibrations.len());
        let map = RowMap::new(source, &names, map, quantity)?;
        let roles = map.roles();
        let kept: Vec<usize> = (0..roles.len()).filter(|i| roles[*i] != Role::Time).collect();
        Ok(Self {
            width: channels.len(),
            calibrations,
            roles: kept.iter().map(|i| roles[*i]).collect(),
            offsets: Vec::new(),
            kept,
            map,
        })
    }

    /// Role and unit of each signal.
    #[must_use]
    pub fn list(&self) -> Vec<(String, String)> {
        let pair = |role: &Role| (role.name().to_owned(), self.map.unit(*role).to_owned());
        self.roles.iter().map(pair).collect()
    }

    /// Index of the signal of a role.
    #[must_use]
    pub fn position(&self, role: Role) -> Option<usize> {
        self.roles.iter().position(|own| *own == role)
    }

    /// Assumptions about units, each a full sentence.
    #[must_use]
    pub fn warnings(&self) -> &[Notice] {
        self.map.warnings()
    }

    /// Calibration matrices, row by row.
    pub(crate) fn calibrations(&self) -> Vec<Vec<f64>> {
        self.calibrations.iter().map(Calibration::numbers).collect()
    }

    /// The means that are subtracted; empty before [`Self::tare`].
    #[must_use]
    pub fn offsets(&self) -> &[f64] {
        &self.offsets
    }

    /// Subtracts these means from now on, instead of those before, and none if there are none;
    /// positions and speeds are left as they are.
    pub fn tare(&mut self, means: &[f64]) {
        let moves = |role: &Role| matches!(role, Role::Speed | Role::X | Role::Y);
        let pairs = self.roles.iter().zip(means);
        self.offsets = pairs.map(|(role, mean)| if moves(role) { 0.0 } else { *mean }).collect();
    }

    /// Returns the values of each signal, from interleaved samples of all channels.
    #[must_use]
    pub fn values(&self, samples: &[f64]) -> Vec<Vec<f64>> {
        let mut channels = vec![Vec::with_capacity(samples.len() / self.width); self.width];
        for frame in samples.chunks_exact(self.width) {
            for (sensor, calibration) in self.calibrations.iter().enumerate() {
                let mut volts = [0.0; AXES];
                volts.copy_from_slice(&frame[AXES * sensor..AXES * (sensor + 1)]);
                let forces = calibration.forces(volts);
                for (channel, force) in channels[AXES * sensor..].iter_mut().zip(forces) {
                    channel.push(force);
                }
            }
            let plain = AXES * self.calibrations.len();
            for (channel, sample) in channels[plain..].iter_mut().zip(&frame[plain..]) {
                channel.push(*sample);
            }
        }
        let mut all = self.map.values(&channels);
        let mut values: Vec<Vec<f64>> =
            self.kept.iter().map(|i| std::mem::take(&mut all[*i])).collect();
        for (values, offset) in values.iter_mut().zip(&self.offsets) {
            values.iter_mut().for_each(|value| *value -= offset);
        }
        values
    }
}

/// Names and units of the channels, those of calibrated sensors replaced by their axes.
fn named(channels: &[Channel], sensors: usize) -> Vec<(String, String)> {
    let number = |sensor: usize| (sensors > 1).then_some(sensor + 1);
    let calibrated = (0..sensors).flat_map(|sensor| Calibration::names(number(sensor)));
    let plain = channels
        .iter()
        .skip(AXES * sensors)
        .map(|channel| (channel.name.clone(), channel.unit.clone()));
    calibrated.chain(plain).collect()
}
