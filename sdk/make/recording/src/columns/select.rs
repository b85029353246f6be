//! Determines which columns of a file are used, and the roles and units of these columns.

use htex_base::finding::{Hint, Notice};
use htex_format::Quantity;

use crate::columns::expression::Formula;
use crate::columns::find::{find, no_scale, two_columns, whole_column};
use crate::columns::map::{ColumnMap, MapEntry, Role};
use crate::columns::names::{Unit, base_unit, recognise, unit_in};
use crate::error::ReadProblem;
use crate::sheet::Columns;

/// How a role's values are obtained.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chosen {
    pub(crate) role: Role,
    pub(crate) values: Values,
    /// Factor to the role's base unit.
    pub(crate) scale: f64,
}

/// A column, or an expression over columns. Indices start at 0.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Values {
    Column(usize),
    Formula { formula: Formula, text: String },
}

impl Chosen {
    fn new(role: Role, column: usize, scale: f64) -> Self {
        Self { role, values: Values::Column(column), scale }
    }

    /// Returns the columns in the order of use; a column may occur several times.
    pub(crate) fn columns(&self) -> Vec<usize> {
        match &self.values {
            Values::Column(column) => vec![*column],
            Values::Formula { formula, .. } => formula.columns().collect(),
        }
    }
}

/// Returns the roles of a quantity's axes: the role of a single axis, and the roles of several.
fn axis_roles(quantity: Quantity) -> (Role, &'static [Role]) {
    match quantity {
        Quantity::LateralForce => (Role::Lateral, &[Role::LateralX, Role::LateralY]),
        Quantity::NormalForce => (Role::Normal, &[]),
        Quantity::Acceleration | Quantity::Velocity | Quantity::Displacement => {
            (Role::Signal, &[Role::SignalX, Role::SignalY, Role::SignalZ])
        }
    }
}

/// Returns all axis roles of a quantity: the single one, then the others in the order of the axes.
pub(crate) fn all_axis_roles(quantity: Quantity) -> impl Iterator<Item = Role> {
    let (one, several) = axis_roles(quantity);
    [one].into_iter().chain(several.iter().copied())
}

/// Selects a tracker's motion: time, and position or speed.
pub(crate) fn select_motion(
    columns: &Columns,
    map: Option<&ColumnMap>,
) -> Result<Selection, ReadProblem> {
    let mut selection = Selection { is_motion: true, ..Selection::default() };
    for entry in map.map_or(&[][..], ColumnMap::entries) {
        selection.take_mapped(columns, entry)?;
    }
    let refused = selection.take_named(columns)?;
    let moves = [Role::Speed, Role::X, Role::Y].map(|role| selection.has(role));
    if moves.contains(&true) {
        return Ok(selection);
    }
    let problem = refused.into_iter().next().unwrap_or_else(|| {
        "no column of the tracker has a known name of a position or a speed; map them, as in time=COLUMN,x=COLUMN:SCALE".to_owned()
    });
    Err(columns.refuse(problem))
}

/// The selected columns, and the assumptions that were made.
#[derive(Debug, Default)]
pub(crate) struct Selection {
    quantity: Quantity,
    /// Whether only the finger's motion is selected.
    is_motion: bool,
    pub(crate) chosen: Vec<Chosen>,
    pub(crate) warnings: Vec<Notice>,
}

/// Assigns columns by the map, then by their names. At least one axis of the quantity is required.
pub(crate) fn select(
    columns: &Columns,
    map: Option<&ColumnMap>,
    quantity: Quantity,
) -> Result<Selection, ReadProblem> {
    let mut selection = Selection { quantity, ..Selection::default() };
    for entry in map.map_or(&[][..], ColumnMap::entries) {
        selection.take_mapped(columns, entry)?;
    }
    let refused = if columns.are_named {
        selection.take_named(columns)?
    } else {
        selection.take_single(columns);
        Vec::new()
    };
    selection.insist_on_axis(columns, &refused)?;
    let unused = |refused| Notice::new(format!("{refused}; it is not used."), Hint::new(&["map"]));
    selection.warnings.extend(refused.into_iter().map(unused));
    selection.warn_of_unused(columns);
    Ok(selection)
}

impl Selection {
    /// Returns the index of the column with a role, if there is one.
    pub(crate) fn position(&self, role: Role) -> Option<usize> {
        self.chosen.iter().position(|chosen| chosen.role == role)
    }

    fn has(&self, role: Role) -> bool {
        self.position(role).is_some()
    }

    fn claims(&self, column: usize) -> bool {
        let mut chosen = self.chosen.iter();
        chosen.any(|chosen| chosen.columns().contains(&column))
    }

    fn has_axis(&self) -> bool {
        all_axis_roles(self.quantity).any(|role| self.has(role))
    }

    /// Returns the role of a map entry; refuses axes of other quantities.
    fn mapped_role(&self, columns: &Columns, role: Role) -> Result<Role, ReadProblem> {
        if self.is_motion {
            return match role {
                Role::Time | Role::Speed | Role::X | Role::Y => Ok(role),
                _ => Err(columns.refuse(format!(
                    "the map's {role} is not a role of a tracker; its roles are time, x, y, speed"
                ))),
            };
        }
        let is_axis = ![Role::Normal, Role::Speed, Role::Time, Role::X, Role::Y].contains(&role);
        if !is_axis || all_axis_roles(self.quantity).any(|own| own == role) {
            return Ok(role);
        }
        let own: Vec<&str> = all_axis_roles(self.quantity).map(Role::name).collect();
        Err(columns.refuse(format!(
            "the map's {role} is not an axis of {}; its axes are {}; correct the map or choose the recorded quantity",
            self.quantity.words(),
            own.join(", ")
        )))
    }

    fn take_mapped(&mut self, columns: &Columns, entry: &MapEntry) -> Result<(), ReadProblem> {
        let role = self.mapped_role(columns, entry.role)?;
        let chosen = match whole_column(columns, &entry.values)? {
            Some(column) => self.mapped_column(columns, role, column, entry)?,
            None => self.mapped_formula(columns, role, entry)?,
        };
        self.chosen.push(chosen);
        Ok(())
    }

    fn mapped_column(
        &mut self,
        columns: &Columns,
        role: Role,
        column: usize,
        entry: &MapEntry,
    ) -> Result<Chosen, ReadProblem> {
        let is_same = |chosen: &Chosen| chosen.values == Values::Column(column);
        if self.chosen.iter().any(is_same) {
            let problem = format!("the map uses column {} twice", columns.name(column));
            return Err(columns.refuse(problem));
        }
        let unit = unit_in(columns.last_part(column), role, self.quantity);
        let scale = match (entry.scale, unit) {
            (Some(scale), _) | (None, Unit::Scale(scale)) => scale,
            (None, Unit::Unsaid) => self.assume_unit(columns, column, role),
            (None, unit) => {
                let problem = no_scale(&columns.name(column), role, &unit, self.quantity);
                return Err(columns.refuse(problem));
            }
        };
        Ok(Chosen::new(role, column, scale))
    }

    /// The columns' numbers are used as they are in the file. Units in the columns' names do not
    /// convert them, because the expression may contain a factor between units.
    fn mapped_formula(
        &mut self,
        columns: &Columns,
        role: Role,
        entry: &MapEntry,
    ) -> Result<Chosen, ReadProblem> {
        let formula = entry.values.resolve(|column| find(columns, column))?;
        if entry.scale.is_none() && !entry.values.has_number() {
            let target = base_unit(role, self.quantity);
            let is_other = |column: &usize| {
                let unit = unit_in(columns.last_part(*column), role, self.quantity);
                !matches!(unit, Unit::Unsaid | Unit::Scale(1.0))
            };
            if let Some(column) = formula.columns().find(is_other) {
                self.warnings.push(format!(
                    "The expression {} ({role}) is taken to be in {target}, but column {:?} has another unit; multiply by the \
                     factor.",
                    entry.values,
                    columns.name(column)
                ).into());
            }
        }
        Ok(Chosen {
            role,
            values: Values::Formula { formula, text: entry.values.to_string() },
            scale: entry.scale.unwrap_or(1.0),
        })
    }

    /// Assigns columns by their names. Returns reasons why some columns with a known name cannot be
    /// used.
    fn take_named(&mut self, columns: &Columns) -> Result<Vec<String>, ReadProblem> {
        let mut refused = Vec::new();
        for role in self.open_roles(columns) {
            let mut found = None;
            for column in self.candidates(columns, role) {
                let name = columns.name(column);
                match recognise(columns.last_part(column), self.quantity) {
                    // A column named x or y without a unit may just as well be a force or an
                    // acceleration.
                    Some((Role::X | Role::Y, Unit::Unsaid)) if !self.is_motion => {}
                    Some((_, unit @ (Unit::Volts | Unit::Unknown(_)))) => {
                        refused.push(no_scale(&name, role, &unit, self.quantity))
                    }
                    Some((_, unit)) => match found.replace((column, unit)) {
                        None => {}
                        Some((other, _)) => return Err(two_columns(columns, role, other, column)),
                    },
                    None => {}
                }
            }
            if let Some((column, unit)) = found {
                let scale = match unit {
                    Unit::Scale(scale) => scale,
                    _ => self.assume_unit(columns, column, role),
                };
                self.chosen.push(Chosen::new(role, column, scale));
            }
        }
        Ok(refused)
    }

    /// Returns the columns whose names fit a role. Once a column is selected, the candidates are in
    /// its group or in the nearest enclosing group.
    fn candidates(&self, columns: &Columns, role: Role) -> Vec<usize> {
        let is_candidate = |column: &usize| {
            !self.claims(*column)
                && recognise(columns.last_part(*column), self.quantity)
                    .is_some_and(|(named, _)| named == role)
        };
        let all = (0..columns.width()).filter(is_candidate);
        let mut selected = self.chosen.iter().flat_map(Chosen::columns);
        let Some(first) = selected.next() else {
            return all.collect();
        };
        // Another run in the same file has columns with the same names.
        let group = columns.group(first);
        let around: Vec<usize> =
            all.filter(|column| group.starts_with(columns.group(*column))).collect();
        let nearest = around.iter().map(|column| columns.group(*column).len()).max();
        let is_nearest = |column: &usize| Some(columns.group(*column).len()) == nearest;
        around.into_iter().filter(is_nearest).collect()
    }

    /// Returns the roles that may be filled by name: several axes before a single one, and position
    /// only if there is no speed.
    fn open_roles(&self, columns: &Columns) -> Vec<Role> {
        let named = |role| !self.candidates(columns, role).is_empty();
        let mut roles = Vec::new();
        if !self.is_motion && !self.has_axis() {
            let (one, several) = axis_roles(self.quantity);
            let count = several.iter().filter(|role| named(**role)).count();
            // `fx` alone is one axis of several, and a file with `lateral` and `fx` has its texture
            // in `lateral`.
            if count > 1 || !named(one) {
                roles.extend(several);
            } else {
                roles.push(one);
            }
        }
        for role in [Role::Normal, Role::Time] {
            let is_closed = self.has(role) || (self.is_motion && role == Role::Normal);
            if !is_closed && !roles.contains(&role) {
                roles.push(role);
            }
        }
        if !self.has(Role::Speed) && !self.has(Role::X) && !self.has(Role::Y) {
            let speed = named(Role::Speed);
            roles.extend(if speed { &[Role::Speed][..] } else { &[Role::X, Role::Y] });
        }
        roles
    }

    /// If the file has only one column and no role was found for it, takes it as the texture's
    /// signal.
    fn take_single(&mut self, columns: &Columns) {
        if columns.width() == 1 && self.chosen.is_empty() {
            let (role, _) = axis_roles(self.quantity);
            let scale = self.assume_unit(columns, 0, role);
            self.chosen.push(Chosen::new(role, 0, scale));
        }
    }

    fn assume_unit(&mut self, columns: &Columns, column: usize, role: Role) -> f64 {
        let (name, unit) = (columns.name(column), base_unit(role, self.quantity));
        self.warnings
            .push(format!("Column {name:?} ({role}) has no unit; {unit} is assumed.").into());
        1.0
    }

    fn insist_on_axis(&self, columns: &Columns, refused: &[String]) -> Result<(), ReadProblem> {
        if self.has_axis() {
            return Ok(());
        }
        let (role, _) = axis_roles(self.quantity);
        let problem = if let Some(refused) = refused.first() {
            refused.clone()
        } else if !columns.are_named {
            format!("there is no header row; map columns by number, as in {role}=#2")
        } else if let Some(other) = self.other_quantity(columns) {
            format!(
                "no column has a known name of the {}, but one is a {}; choose the quantity {other} if that is the texture",
                self.quantity.words(),
                other.words()
            )
        } else {
            format!(
                "no column has a known name of the {}; map a column, as in {role}=COLUMN (and :SCALE to {})",
                self.quantity.words(),
                self.quantity.unit()
            )
        };
        Err(columns.refuse(problem))
    }

    /// Returns another quantity to which a column's name would belong.
    fn other_quantity(&self, columns: &Columns) -> Option<Quantity> {
        let is_there = |quantity: &Quantity| {
            let is_axis = |role| all_axis_roles(*quantity).any(|axis| axis == role);
            (0..columns.width())
                .filter_map(|column| recognise(columns.last_part(column), *quantity))
                .any(|(role, _)| is_axis(role))
        };
        let mut others = Quantity::ALL.iter().copied();
        others.find(|other| *other != self.quantity && is_there(other))
    }

    fn warn_of_unused(&mut self, columns: &Columns) {
        let unused: Vec<usize> =
            (0..columns.width()).filter(|column| !self.claims(*column)).collect();
        if !unused.is_empty() {
            self.warnings.push(format!("Columns not used: {}.", columns.list_of(&unused)).into());
        }
    }
}
