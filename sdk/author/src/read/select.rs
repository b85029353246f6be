//! Selection of a table's columns, with their roles and units.

use htex_format::Quantity;

use super::ReadError;
use super::columns::{Unit, base_unit, recognise, unit_in};
use super::map::{ColumnMap, ColumnRef, MapEntry, Role};
use super::table::Table;

/// A selected column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chosen {
    pub(crate) role: Role,
    /// Index from 0.
    pub(crate) column: usize,
    /// Factor to the role's base unit.
    pub(crate) scale: f64,
}

/// Returns the roles of a quantity's axes: the role of a single one, and those of several.
fn axis_roles(quantity: Quantity) -> (Role, &'static [Role]) {
    match quantity {
        Quantity::LateralForce => (Role::Lateral, &[Role::LateralX, Role::LateralY]),
        Quantity::NormalForce => (Role::Normal, &[]),
        Quantity::Acceleration | Quantity::Velocity | Quantity::Displacement => {
            (Role::Signal, &[Role::SignalX, Role::SignalY, Role::SignalZ])
        }
    }
}

/// Returns every role of an axis, in the order of the axes.
pub(crate) fn all_axis_roles(quantity: Quantity) -> impl Iterator<Item = Role> {
    let (one, several) = axis_roles(quantity);
    [one].into_iter().chain(several.iter().copied())
}

/// The selected columns, and the assumptions made.
#[derive(Debug, Default)]
pub(crate) struct Selection {
    quantity: Quantity,
    pub(crate) chosen: Vec<Chosen>,
    pub(crate) warnings: Vec<String>,
}

/// Assigns columns by the map, then by their names, and requires an axis of the quantity.
pub(crate) fn select(
    table: &Table<'_>,
    map: Option<&ColumnMap>,
    quantity: Quantity,
) -> Result<Selection, ReadError> {
    let mut selection = Selection {
        quantity,
        ..Selection::default()
    };
    for entry in map.map_or(&[][..], ColumnMap::entries) {
        selection.take_mapped(table, entry)?;
    }
    let refused = if table.header.is_some() {
        selection.take_named(table)?
    } else {
        selection.take_single(table);
        Vec::new()
    };
    selection.insist_on_axis(table, &refused)?;
    selection.warnings.extend(
        refused
            .into_iter()
            .map(|refused| format!("{refused}; it is not used.")),
    );
    selection.warn_of_unused(table);
    Ok(selection)
}

impl Selection {
    /// Returns the position of the column with a role, if there is one.
    pub(crate) fn position(&self, role: Role) -> Option<usize> {
        self.chosen.iter().position(|chosen| chosen.role == role)
    }

    fn has(&self, role: Role) -> bool {
        self.position(role).is_some()
    }

    fn claims(&self, column: usize) -> bool {
        self.chosen.iter().any(|chosen| chosen.column == column)
    }

    fn has_axis(&self) -> bool {
        all_axis_roles(self.quantity).any(|role| self.has(role))
    }

    /// Returns the role of a map's entry; refuses axes of other quantities.
    fn mapped_role(&self, table: &Table<'_>, role: Role) -> Result<Role, ReadError> {
        let is_axis = ![Role::Normal, Role::Speed, Role::Time, Role::X, Role::Y].contains(&role);
        if !is_axis || all_axis_roles(self.quantity).any(|own| own == role) {
            return Ok(role);
        }
        let own: Vec<&str> = all_axis_roles(self.quantity).map(Role::name).collect();
        Err(columns_error(
            table,
            format!(
                "the map's {role} is not an axis of {}; its axes are {}; correct the map or choose the recorded quantity",
                self.quantity.words(),
                own.join(", ")
            ),
        ))
    }

    fn take_mapped(&mut self, table: &Table<'_>, entry: &MapEntry) -> Result<(), ReadError> {
        let column = find(table, &entry.column)?;
        if self.claims(column) {
            return Err(columns_error(
                table,
                format!("the map uses column {} twice", entry.column),
            ));
        }
        let role = self.mapped_role(table, entry.role)?;
        let scale = match (
            entry.scale,
            unit_in(&table.name(column), role, self.quantity),
        ) {
            (Some(scale), _) | (None, Unit::Scale(scale)) => scale,
            (None, Unit::Unsaid) => self.assume_unit(table, column, role),
            (None, unit) => {
                return Err(columns_error(
                    table,
                    no_scale(&table.name(column), role, &unit, self.quantity),
                ));
            }
        };
        self.chosen.push(Chosen {
            role,
            column,
            scale,
        });
        Ok(())
    }

    /// Assigns columns by their names; returns why some with a known name cannot be used.
    fn take_named(&mut self, table: &Table<'_>) -> Result<Vec<String>, ReadError> {
        let mut refused = Vec::new();
        for role in self.open_roles(table) {
            let mut found = None;
            for column in self.candidates(table, role) {
                let name = table.name(column);
                match recognise(&name, self.quantity) {
                    // A column x or y without unit may as well be a force or an acceleration.
                    Some((Role::X | Role::Y, Unit::Unsaid)) => {}
                    Some((_, unit @ (Unit::Volts | Unit::Unknown(_)))) => {
                        refused.push(no_scale(&name, role, &unit, self.quantity))
                    }
                    Some((_, unit)) => match found.replace((column, unit)) {
                        None => {}
                        Some((other, _)) => return Err(two_columns(table, role, other, column)),
                    },
                    None => {}
                }
            }
            if let Some((column, unit)) = found {
                let scale = match unit {
                    Unit::Scale(scale) => scale,
                    _ => self.assume_unit(table, column, role),
                };
                self.chosen.push(Chosen {
                    role,
                    column,
                    scale,
                });
            }
        }
        Ok(refused)
    }

    fn candidates(&self, table: &Table<'_>, role: Role) -> Vec<usize> {
        let is_candidate = |column: &usize| {
            !self.claims(*column)
                && recognise(&table.name(*column), self.quantity)
                    .is_some_and(|(named, _)| named == role)
        };
        (0..table.width).filter(is_candidate).collect()
    }

    /// Returns the roles that names may fill: several axes before a single one; position only without a speed.
    fn open_roles(&self, table: &Table<'_>) -> Vec<Role> {
        let named = |role| !self.candidates(table, role).is_empty();
        let mut roles = Vec::new();
        if !self.has_axis() {
            let (one, several) = axis_roles(self.quantity);
            let count = several.iter().filter(|role| named(**role)).count();
            if count > 1 || !named(one) {
                roles.extend(several);
            } else {
                roles.push(one);
            }
        }
        for role in [Role::Normal, Role::Time] {
            if !self.has(role) && !roles.contains(&role) {
                roles.push(role);
            }
        }
        if !self.has(Role::Speed) && !self.has(Role::X) && !self.has(Role::Y) {
            let speed = named(Role::Speed);
            roles.extend(if speed {
                &[Role::Speed][..]
            } else {
                &[Role::X, Role::Y]
            });
        }
        roles
    }

    /// Assigns a single column without a name to the texture's signal.
    fn take_single(&mut self, table: &Table<'_>) {
        if table.width == 1 && self.chosen.is_empty() {
            let (role, _) = axis_roles(self.quantity);
            let scale = self.assume_unit(table, 0, role);
            self.chosen.push(Chosen {
                role,
                column: 0,
                scale,
            });
        }
    }

    fn assume_unit(&mut self, table: &Table<'_>, column: usize, role: Role) -> f64 {
        let (name, unit) = (table.name(column), base_unit(role, self.quantity));
        self.warnings.push(format!(
            "Column {name:?} ({role}) has no unit; {unit} is assumed."
        ));
        1.0
    }

    fn insist_on_axis(&self, table: &Table<'_>, refused: &[String]) -> Result<(), ReadError> {
        if self.has_axis() {
            return Ok(());
        }
        let (role, _) = axis_roles(self.quantity);
        let problem = if let Some(refused) = refused.first() {
            refused.clone()
        } else if table.header.is_none() {
            format!("there is no header row; map columns by number, as in {role}=#2")
        } else if let Some(other) = self.other_quantity(table) {
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
        Err(columns_error(table, problem))
    }

    /// Returns another quantity whose names include a column's name.
    fn other_quantity(&self, table: &Table<'_>) -> Option<Quantity> {
        let is_there = |quantity: &Quantity| {
            let is_axis = |role| all_axis_roles(*quantity).any(|axis| axis == role);
            (0..table.width)
                .filter_map(|column| recognise(&table.name(column), *quantity))
                .any(|(role, _)| is_axis(role))
        };
        let mut others = Quantity::ALL.iter().copied();
        others.find(|other| *other != self.quantity && is_there(other))
    }

    fn warn_of_unused(&mut self, table: &Table<'_>) {
        let unused = |column: &usize| !self.claims(*column);
        let names: Vec<_> = (0..table.width)
            .filter(unused)
            .map(|column| table.name(column))
            .collect();
        if !names.is_empty() {
            self.warnings
                .push(format!("Columns not used: {}.", names.join(", ")));
        }
    }
}

fn find(table: &Table<'_>, column: &ColumnRef) -> Result<usize, ReadError> {
    let found: Vec<usize> = match column {
        ColumnRef::Number(number) => (0..table.width)
            .filter(|column| column + 1 == *number)
            .collect(),
        ColumnRef::Name(name) => by_name(table, name),
    };
    match found.as_slice() {
        [column] => Ok(*column),
        [] => Err(columns_error(
            table,
            format!("the map's column {column} does not exist"),
        )),
        _ => Err(columns_error(
            table,
            format!("several columns have the name {column}; give the number, as in #2"),
        )),
    }
}

/// Returns the columns with exactly this name, or else those that differ only in case.
fn by_name(table: &Table<'_>, name: &str) -> Vec<usize> {
    let names = table.header.as_deref().unwrap_or_default();
    let matching = |same: fn(&str, &str) -> bool| -> Vec<usize> {
        (0..names.len())
            .filter(|column| same(names[*column], name))
            .collect()
    };
    match matching(|a, b| a == b) {
        exact if !exact.is_empty() => exact,
        _ => matching(str::eq_ignore_ascii_case),
    }
}

fn no_scale(name: &str, role: Role, unit: &Unit, quantity: Quantity) -> String {
    let (unit, target) = match unit {
        Unit::Volts => ("volts", base_unit(role, quantity)),
        Unit::Unknown(unit) => (unit.as_str(), base_unit(role, quantity)),
        Unit::Scale(_) | Unit::Unsaid => ("no unit", base_unit(role, quantity)),
    };
    format!(
        "Column {name:?} is in {unit}, not {target}; map it with its scale to {target}: {role}={name}:SCALE"
    )
}

fn two_columns(table: &Table<'_>, role: Role, a: usize, b: usize) -> ReadError {
    let (a, b) = (table.name(a), table.name(b));
    columns_error(
        table,
        format!("{a:?} and {b:?} both match {role}; map one of them, as in {role}=COLUMN"),
    )
}

fn columns_error(table: &Table<'_>, problem: String) -> ReadError {
    ReadError::Columns {
        file: table.file.to_owned(),
        problem,
        columns: table.names(),
    }
}
