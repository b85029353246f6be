//! Converts the channels of a source to forces and positions.

use htex_author::recording::{ColumnMap, Role, RowMap};
use htex_base::finding::Notice;
use htex_device::Channel;
use htex_format::Quantity;

use crate::error::LabError;
use crate::record::calibration::{AXES, Calibration};

/// Converts a source's channels in three steps: calibration of six-axis sensors, mapping to roles,
/// and tare.
#[derive(Debug)]
pub struct Signals {
    width: usize,
    calibrations: Vec<Calibration>,
    map: RowMap,
    /// Indices of the recorded values among the mapped values. If the source delivers a time, the
    /// time is not recorded.
    kept: Vec<usize>,
    roles: Vec<Role>,
    offsets: Vec<f64>,
}

impl Signals {
    /// Creates the conversion. The first calibration applies to the first six channels, the second
    /// one to the next six, and so on. The six channels of a sensor get the names `fx, fy, fz, tx,
    /// ty, tz`; if there are several sensors, the number of the sensor is appended (`fx1`, `fx2`,
    /// …). Other channels keep their names. The map assigns channels to roles; without a map, the
    /// names of the channels determine the roles. For example, `lateral_x=fx1+fx2` sums two
    /// sensors.
    ///
    /// # Errors
    /// Returns an error if there are fewer channels than the calibrations need, or if the channels
    /// do not fit the map.
    pub fn new(
        source: &str,
        channels: &[Channel],
        calibrations: Vec<Calibration>,
        map: Option<&ColumnMap>,
        quantity: Quantity,
    ) -> Result<Self, LabError> {
        if channels.len() < AXES * calibrations.len() {
            return Err(LabError::Setup {
                what: "the number of channels",
                value: channels.len().to_string(),
                allowed: "each calibration needs six channels, the first six, the next six and so on",
            });
        }
        let names = channel_names(channels, calibrations.len());
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

    /// Returns the role and unit of each signal.
    #[must_use]
    pub fn list(&self) -> Vec<(String, String)> {
        let pair = |role: &Role| (role.name().to_owned(), self.map.unit(*role).to_owned());
        self.roles.iter().map(pair).collect()
    }

    /// Returns the index of the signal with this role.
    #[must_use]
    pub fn position(&self, role: Role) -> Option<usize> {
        self.roles.iter().position(|own| *own == role)
    }

    /// Returns the assumptions that were made about units, each as a full sentence.
    #[must_use]
    pub fn warnings(&self) -> &[Notice] {
        self.map.warnings()
    }

    /// Returns the calibration matrices, row by row.
    pub(crate) fn calibrations(&self) -> Vec<Vec<f64>> {
        self.calibrations.iter().map(Calibration::numbers).collect()
    }

    /// Returns the means that are subtracted; empty before [`Self::tare`].
    #[must_use]
    pub fn offsets(&self) -> &[f64] {
        &self.offsets
    }

    /// Sets the means that are subtracted from now on. The new means replace all earlier means;
    /// with an empty list, nothing is subtracted. Positions and speeds are never changed.
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
                // There are only six forces, so the channels of the next sensor do not change.
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

/// Returns the names and units of the channels. Channels of calibrated sensors are replaced by the
/// sensor's axes.
fn channel_names(channels: &[Channel], sensors: usize) -> Vec<(String, String)> {
    let number = |sensor: usize| (sensors > 1).then_some(sensor + 1);
    let calibrated = (0..sensors).flat_map(|sensor| Calibration::names(number(sensor)));
    let plain = channels
        .iter()
        .skip(AXES * sensors)
        .map(|channel| (channel.name.clone(), channel.unit.clone()));
    calibrated.chain(plain).collect()
}
