//! The column map, in which the user assigns roles to columns, such as
//! `lateral=lateral_V:0.4444,normal=-#3*0.31`.

use std::fmt;
use std::str::FromStr;

use crate::columns::expression::Expression;
use crate::columns::token::{Problem, Token, TokenKind, tokens};
use crate::error::{ReadError, ReadProblem};

/// Longest map that is accepted, bytes.
const MOST_BYTES: usize = 16 << 10;

/// The role of a column, i.e. the signal that the column contains.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Lateral force along a single axis, newtons.
    Lateral,
    /// First lateral axis, newtons.
    LateralX,
    /// Second lateral axis, newtons.
    LateralY,
    /// Single axis of an acceleration, velocity or displacement, in the quantity's unit.
    Signal,
    /// First axis of an acceleration, velocity or displacement, in the quantity's unit.
    SignalX,
    /// Second axis of an acceleration, velocity or displacement, in the quantity's unit.
    SignalY,
    /// Third axis of an acceleration, velocity or displacement, in the quantity's unit.
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
    /// All roles, in the order in which roles are assigned to columns.
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

/// One entry of a column map: `ROLE=EXPRESSION[:SCALE]`.
#[derive(Debug, Clone, PartialEq)]
pub struct MapEntry {
    /// The role for which the entry gives the values.
    pub role: Role,
    /// The column, or an expression over columns.
    pub values: Expression,
    /// Factor that converts the values to the role's unit (N, the quantity's unit, mm/s, s, mm). If
    /// an entry names a column and no factor, the unit in the column's name determines the
    /// conversion. If it has an expression and no factor, the values of the expression must already
    /// be in the role's unit.
    pub scale: Option<f64>,
}

impl MapEntry {
    /// Parses the values of a role, in the form `EXPRESSION[:SCALE]`.
    ///
    /// # Errors
    /// Returns [`ReadProblem::Map`] if the text is not an expression. The error gives the place in
    /// the text.
    ///
    /// ```
    /// # use htex_recording::{MapEntry, Role};
    /// let entry = MapEntry::parse(Role::Lateral, "hammer_V:22.5")?;
    /// assert_eq!(entry.scale, Some(22.5));
    /// # Ok::<(), htex_recording::ReadError>(())
    /// ```
    pub fn parse(role: Role, text: &str) -> Result<Self, ReadError> {
        check_length(text)?;
        let refuse = |problem: Problem| map_error(problem.in_text(text));
        let tokens = tokens(text).map_err(refuse)?;
        let among = |token: &&Token| matches!(token.kind, TokenKind::Comma | TokenKind::Equals);
        if let Some(token) = tokens.iter().find(among) {
            let what = "one column or expression is expected here; quote a name with ',' or '='";
            return Err(refuse(Problem::at_token(token, what)));
        }
        let (values, scale) = split_scale(&tokens).map_err(refuse)?;
        if values.is_empty() {
            return Err(refuse(Problem { at: None, what: "a column name is missing".into() }));
        }
        Ok(Self { role, values: Expression::parse(text, values).map_err(refuse)?, scale })
    }
}

/// Column map: the user's assignment of columns to roles.
///
/// A role takes its values from a column, or from an expression over columns. An expression
/// consists of sums, differences, products and quotients of numbers and columns, with parentheses.
/// A column is given by its name, its number (`#3`) or its path (`/run1/fx`). A name that contains
/// an operator must be in quotes, except if the whole expression consists of this name.
///
/// ```
/// # use htex_recording::ColumnMap;
/// let map: ColumnMap = "lateral=lateral_V:0.4444,normal=-#3*0.31".parse()?;
/// assert_eq!(map.entries().len(), 2);
/// let error = "lateral=(fx1+fx2".parse::<ColumnMap>().unwrap_err();
/// assert!(error.to_string().contains("character 9: '(' is not closed"));
/// # Ok::<(), htex_recording::ReadError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ColumnMap {
    entries: Vec<MapEntry>,
}

impl ColumnMap {
    /// Creates a map from its entries.
    ///
    /// # Errors
    /// Returns [`ReadProblem::Map`] if a role or a column is given twice, or if a single axis is
    /// given together with several axes.
    pub fn new(entries: impl IntoIterator<Item = MapEntry>) -> Result<Self, ReadError> {
        let mut map = Self::default();
        for entry in entries {
            map.add(entry).map_err(map_error)?;
        }
        map.check_axes().map_err(map_error)?;
        Ok(map)
    }

    /// Returns the entries in the order in which they were given.
    #[must_use]
    pub fn entries(&self) -> &[MapEntry] {
        &self.entries
    }

    fn add(&mut self, entry: MapEntry) -> Result<(), String> {
        for other in &self.entries {
            if other.role == entry.role {
                return Err(format!("role {} is given twice", entry.role));
            }
            if let (Some(column), true) =
                (entry.values.column(), other.values.column() == entry.values.column())
            {
                return Err(format!("column {column} is given twice"));
            }
        }
        self.entries.push(entry);
        Ok(())
    }

    fn check_axes(&self) -> Result<(), String> {
        let has = |role| self.entries.iter().any(|entry| entry.role == role);
        let lateral = (Role::Lateral, &[Role::LateralX, Role::LateralY][..]);
        let signal = (Role::Signal, &[Role::SignalX, Role::SignalY, Role::SignalZ][..]);
        for (one, several) in [lateral, signal] {
            if has(one) && several.iter().any(|role| has(*role)) {
                return Err(format!(
                    "{one} is a single axis, {one}_x and {one}_y are two axes; give one or the other"
                ));
            }
        }
        Ok(())
    }
}

impl FromStr for ColumnMap {
    type Err = ReadError;

    fn from_str(text: &str) -> Result<Self, ReadError> {
        check_length(text)?;
        let refuse = |problem: Problem| map_error(problem.in_text(text));
        let tokens = tokens(text).map_err(refuse)?;
        let entries = tokens
            .split(|token| token.kind == TokenKind::Comma)
            .map(|tokens| parse_entry(text, tokens).map_err(refuse));
        Self::new(entries.collect::<Result<Vec<_>, _>>()?)
    }
}

fn check_length(text: &str) -> Result<(), ReadError> {
    if text.len() > MOST_BYTES {
        let problem = format!("{} bytes, more than the limit of {MOST_BYTES}", text.len());
        return Err(map_error(problem));
    }
    Ok(())
}

fn map_error(problem: String) -> ReadError {
    ReadProblem::Map(problem).in_file("column map")
}

/// Parses the tokens of `ROLE=EXPRESSION[:SCALE]`.
fn parse_entry(text: &str, tokens: &[Token]) -> Result<MapEntry, Problem> {
    let nowhere = |what: String| Problem { at: None, what };
    let Some(equals) = tokens.iter().position(|token| token.kind == TokenKind::Equals) else {
        return Err(match tokens {
            [] => nowhere("an entry between commas is empty".into()),
            [first, ..] => Problem::at_token(first, "this entry has no '='"),
        });
    };
    let (before, values) = (&tokens[..equals], &tokens[equals + 1..]);
    let role = match before {
        [] => "",
        [first, ..] => text[first.start..tokens[equals].start].trim(),
    };
    let role = parse_role(role).map_err(|what| Problem::at_token(&tokens[0], what))?;
    let (values, scale) = split_scale(values)?;
    if values.is_empty() {
        let what = "a column name is missing after '='";
        return Err(Problem::at_token(&tokens[equals], what));
    }
    Ok(MapEntry { role, values: Expression::parse(text, values)?, scale })
}

fn parse_role(text: &str) -> Result<Role, String> {
    let found = Role::ALL.into_iter().find(|role| role.name() == text);
    found.ok_or_else(|| {
        let names: Vec<_> = Role::ALL.iter().map(|role| role.name()).collect();
        format!("unknown role {text:?}; the roles are {}", names.join(", "))
    })
}

/// Splits at the last colon. A name that contains a colon must be quoted or followed by a scale.
fn split_scale(tokens: &[Token]) -> Result<(&[Token], Option<f64>), Problem> {
    let is_colon = |token: &Token| token.kind == TokenKind::Colon;
    let Some(colon) = tokens.iter().rposition(is_colon) else {
        return Ok((tokens, None));
    };
    let (sign, number) = match &tokens[colon + 1..] {
        [Token { kind: TokenKind::Minus, .. }, number] => (-1.0, number),
        [Token { kind: TokenKind::Plus, .. }, number] | [number] => (1.0, number),
        _ => return Err(not_a_scale(&tokens[colon])),
    };
    match number.kind {
        TokenKind::Number(scale) if scale != 0.0 => Ok((&tokens[..colon], Some(sign * scale))),
        _ => Err(not_a_scale(&tokens[colon])),
    }
}

fn not_a_scale(colon: &Token) -> Problem {
    Problem::at_token(
        colon,
        "what follows is not a scale; write a finite number other than 0, or quote a name that contains ':'",
    )
}
