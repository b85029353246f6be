//! The column map, in which the user assigns roles: `lateral=lateral_V:0.4444,normal=#3`.

use std::fmt;
use std::str::FromStr;

use super::ReadError;

/// The role of a column: the signal that it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Lateral force along a single axis, newtons.
    Lateral,
    /// First lateral axis, newtons.
    LateralX,
    /// Second lateral axis, newtons.
    LateralY,
    /// Single axis of an acceleration, velocity or displacement, in its unit.
    Signal,
    /// First axis of the quantity.
    SignalX,
    /// Second axis of the quantity.
    SignalY,
    /// Third axis of the quantity.
    SignalZ,
    /// Normal force, newtons.
    Normal,
    /// Sliding speed, mm/s.
    Speed,
    /// Time, seconds.
    Time,
    /// Finger position along the first axis, mm.
    X,
    /// Finger position along the second axis, mm.
    Y,
}

impl Role {
    /// Every role, in the order in which columns are assigned.
    pub const ALL: [Self; 12] = [
        Self::Lateral,
        Self::LateralX,
        Self::LateralY,
        Self::Signal,
        Self::SignalX,
        Self::SignalY,
        Self::SignalZ,
        Self::Normal,
        Self::Speed,
        Self::Time,
        Self::X,
        Self::Y,
    ];

    /// Returns the role's name in a column map.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Lateral => "lateral",
            Self::LateralX => "lateral_x",
            Self::LateralY => "lateral_y",
            Self::Signal => "signal",
            Self::SignalX => "signal_x",
            Self::SignalY => "signal_y",
            Self::SignalZ => "signal_z",
            Self::Normal => "normal",
            Self::Speed => "speed",
            Self::Time => "time",
            Self::X => "x",
            Self::Y => "y",
        }
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A column, by name or by number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ColumnRef {
    /// The name in the header, compared without case.
    Name(String),
    /// The number counted from 1, written `#3`.
    Number(usize),
}

impl fmt::Display for ColumnRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => write!(f, "{name:?}"),
            Self::Number(number) => write!(f, "#{number}"),
        }
    }
}

/// An entry `ROLE=COLUMN[:SCALE]` of a column map.
#[derive(Debug, Clone, PartialEq)]
pub struct MapEntry {
    /// The role of the column.
    pub role: Role,
    /// The column.
    pub column: ColumnRef,
    /// Factor from the column's unit to the role's (N, the quantity's, mm/s, s, mm); `None` uses the unit in the column's name.
    pub scale: Option<f64>,
}

/// The user's assignment of columns to roles.
///
/// ```
/// # use htex_author::read::ColumnMap;
/// let map: ColumnMap = "lateral=lateral_V:0.4444,normal=#3".parse()?;
/// assert_eq!(map.entries().len(), 2);
/// # Ok::<(), htex_author::read::ReadError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnMap {
    entries: Vec<MapEntry>,
}

impl ColumnMap {
    /// Returns the entries in the given order.
    #[must_use]
    pub fn entries(&self) -> &[MapEntry] {
        &self.entries
    }

    fn add(&mut self, entry: MapEntry) -> Result<(), ReadError> {
        for other in &self.entries {
            if other.role == entry.role {
                return Err(problem(format!("role {} is given twice", entry.role)));
            }
            if other.column == entry.column {
                return Err(problem(format!("column {} is given twice", entry.column)));
            }
        }
        self.entries.push(entry);
        Ok(())
    }
}

impl FromStr for ColumnMap {
    type Err = ReadError;

    fn from_str(text: &str) -> Result<Self, ReadError> {
        let mut map = Self::default();
        for part in text.split(',') {
            map.add(parse_entry(part.trim())?)?;
        }
        let has = |role| map.entries.iter().any(|entry| entry.role == role);
        let lateral = (Role::Lateral, &[Role::LateralX, Role::LateralY][..]);
        let signal = (
            Role::Signal,
            &[Role::SignalX, Role::SignalY, Role::SignalZ][..],
        );
        for (one, several) in [lateral, signal] {
            if has(one) && several.iter().any(|role| has(*role)) {
                return Err(problem(format!(
                    "{one} is a single axis, {one}_x and {one}_y are two axes; give one or the other"
                )));
            }
        }
        Ok(map)
    }
}

fn parse_entry(text: &str) -> Result<MapEntry, ReadError> {
    let Some((role, column)) = text.split_once('=') else {
        return Err(problem(format!("{text:?} has no '='")));
    };
    let (column, scale) = split_scale(column.trim())?;
    Ok(MapEntry {
        role: parse_role(role.trim())?,
        column: parse_column(column)?,
        scale,
    })
}

fn parse_role(text: &str) -> Result<Role, ReadError> {
    Role::ALL
        .into_iter()
        .find(|role| role.name() == text)
        .ok_or_else(|| {
            let names: Vec<_> = Role::ALL.iter().map(|role| role.name()).collect();
            problem(format!(
                "unknown role {text:?}; the roles are {}",
                names.join(", ")
            ))
        })
}

fn parse_column(text: &str) -> Result<ColumnRef, ReadError> {
    match text.strip_prefix('#') {
        None if text.is_empty() => Err(problem("a column name is missing after '='".into())),
        None => Ok(ColumnRef::Name(text.to_owned())),
        Some(number) => match number.parse() {
            Ok(number) if number > 0 => Ok(ColumnRef::Number(number)),
            _ => Err(problem(format!(
                "{text:?} is not a column number; the first column is #1"
            ))),
        },
    }
}

/// Splits at the last colon; a colon in a column's name requires a scale after it.
fn split_scale(text: &str) -> Result<(&str, Option<f64>), ReadError> {
    let Some((column, scale)) = text.rsplit_once(':') else {
        return Ok((text, None));
    };
    match scale.trim().parse::<f64>() {
        Ok(scale) if scale.is_finite() && scale != 0.0 => Ok((column.trim_end(), Some(scale))),
        _ => Err(problem(format!(
            "{scale:?} is not a scale; write a finite number other than 0"
        ))),
    }
}

fn problem(problem: String) -> ReadError {
    ReadError::Map { problem }
}
