//! Applies a column map to signals that arrive in blocks, such as the channels of an acquisition
//! card.

use htex_base::finding::Notice;
use htex_format::Quantity;

use crate::ReadError;
use crate::columns::find::no_scale;
use crate::columns::map::{ColumnMap, Role};
use crate::columns::names::{Unit, base_unit, unit_in, unit_of};
use crate::columns::select::{Selection, Values, select, select_motion};
use crate::error::ReadProblem;
use crate::sheet::Columns;

/// Converts channels to the values of roles, in the roles' units. The rules are the same as for
/// files: the column map assigns roles first, and the names of the other channels may then
/// determine further roles.
///
/// ```
/// use htex_recording::{ColumnMap, Role, RowMap};
/// use htex_format::Quantity;
///
/// let map: ColumnMap = "lateral=ai0:0.5,normal=-(ai1+ai2)*2".parse()?;
/// let channels = ["ai0", "ai1", "ai2"].map(|name| (name.to_owned(), "V".to_owned()));
/// let map = RowMap::new("Dev1", &channels, Some(&map), Quantity::LateralForce)?;
/// assert_eq!(map.roles(), [Role::Lateral, Role::Normal]);
/// // Two samples of each channel.
/// let values = map.values(&[vec![1.0, 2.0], vec![-1.0, 0.0], vec![0.5, -3.0]]);
/// assert_eq!(values, [[0.5, 1.0], [1.0, 6.0]]);
/// # Ok::<(), htex_recording::ReadError>(())
/// ```
#[derive(Debug)]
pub struct RowMap {
    selection: Selection,
    quantity: Quantity,
}

impl RowMap {
    /// Assigns roles to channels. Pass the name and the unit of each channel. If the unit is
    /// unknown, pass an empty text. If the name also contains a unit, the unit in the name takes
    /// precedence.
    ///
    /// # Errors
    /// Returns [`ReadProblem::Columns`] in the same cases as for a file with these columns.
    /// `source` names the origin of the channels in messages.
    pub fn new(
        source: &str,
        channels: &[(String, String)],
        map: Option<&ColumnMap>,
        quantity: Quantity,
    ) -> Result<Self, ReadError> {
        let mut row_map =
            Self::with(source, channels, map, quantity, |columns| select(columns, map, quantity))?;
        // A notice has no code, so this check depends on the words of `Selection::warn_of_unused`.
        // A card has more channels than a texture needs, so the warning would always appear.
        let is_unused = |warning: &Notice| warning.starts_with("Columns not used");
        let warnings = &mut row_map.selection.warnings;
        warnings.retain(|warning| !is_unused(warning));
        Ok(row_map)
    }

    /// Assigns only the roles of the finger's motion (position or speed), in the same way as for a
    /// file from a [`Tracker`](crate::Tracker).
    ///
    /// # Errors
    /// Returns the errors of [`Self::new`].
    pub fn of_motion(
        source: &str,
        channels: &[(String, String)],
        map: Option<&ColumnMap>,
    ) -> Result<Self, ReadError> {
        Self::with(source, channels, map, Quantity::LateralForce, |columns| {
            select_motion(columns, map)
        })
    }

    fn with(
        source: &str,
        channels: &[(String, String)],
        map: Option<&ColumnMap>,
        quantity: Quantity,
        select: impl FnOnce(&Columns) -> Result<Selection, ReadProblem>,
    ) -> Result<Self, ReadError> {
        let names = channels.iter().map(|(name, _)| name.clone());
        let columns = Columns::new(names, None);
        let selected = select(&columns).and_then(|selection| {
            let mut row_map = Self { selection, quantity };
            row_map.take_units(&columns, channels, map)?;
            Ok(row_map)
        });
        selected.map_err(|problem| problem.in_file(source))
    }

    /// Applies the given unit of each channel whose name states no unit and for which the map has
    /// no scale.
    fn take_units(
        &mut self,
        columns: &Columns,
        channels: &[(String, String)],
        map: Option<&ColumnMap>,
    ) -> Result<(), ReadProblem> {
        for chosen in &mut self.selection.chosen {
            let Values::Column(column) = chosen.values else {
                continue;
            };
            let mut entries = map.iter().flat_map(|map| map.entries());
            let has_scale = entries.any(|e| e.role == chosen.role && e.scale.is_some());
            let (name, unit) = &channels[column];
            let in_name = unit_in(name, chosen.role, self.quantity);
            if has_scale || unit.is_empty() || in_name != Unit::Unsaid {
                continue;
            }
            match unit_of(chosen.role, &unit.to_ascii_lowercase(), self.quantity) {
                Unit::Scale(scale) => chosen.scale = scale,
                unit => {
                    let problem = no_scale(name, chosen.role, &unit, self.quantity);
                    return Err(columns.refuse(problem));
                }
            }
            // `Selection::assume_unit` writes this sentence. The unit is known after all.
            let assumed =
                format!("Column {:?} ({}) has no unit", columns.name(column), chosen.role);
            let warnings = &mut self.selection.warnings;
            warnings.retain(|warning| !warning.text.starts_with(&assumed));
        }
        Ok(())
    }

    /// Returns the roles, in the order in which [`Self::values`] returns their values.
    #[must_use]
    pub fn roles(&self) -> Vec<Role> {
        self.selection.chosen.iter().map(|c| c.role).collect()
    }

    /// Returns the unit of a role's values.
    #[must_use]
    pub fn unit(&self, role: Role) -> &'static str {
        base_unit(role, self.quantity)
    }

    /// Returns, in ascending order, the indices of the channels that are used.
    #[must_use]
    pub fn channels(&self) -> Vec<usize> {
        let chosen = self.selection.chosen.iter();
        let mut used: Vec<usize> = chosen.flat_map(|c| c.columns()).collect();
        htex_dsp::order::sort(&mut used);
        used.dedup();
        used
    }

    /// Returns the assumptions that were made, such as assumed units. Each assumption is a full
    /// sentence.
    #[must_use]
    pub fn warnings(&self) -> &[Notice] {
        &self.selection.warnings
    }

    /// Returns the values of each role. `channels` has one vector of samples for each channel. All
    /// vectors must have the same length. A division by zero gives a value that is not finite.
    #[must_use]
    pub fn values(&self, channels: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let rows = channels.first().map_or(0, Vec::len);
        let of = |column: usize| &channels[column][..];
        let chosen = self.selection.chosen.iter();
        chosen
            .map(|chosen| match &chosen.values {
                Values::Column(column) => of(*column).iter().map(|v| v * chosen.scale).collect(),
                Values::Formula { formula, .. } => formula.values(rows, chosen.scale, of),
            })
            .collect()
    }
}
