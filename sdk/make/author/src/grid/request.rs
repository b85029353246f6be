//! Request for a grid of conditions. The user gives the grid's lines (speeds and forces), or the
//! fit chooses them from the recordings.

use std::str::FromStr;

use crate::AuthorError;

/// The lines of a grid: its speeds and forces. If the lines of an axis are not given, the fit
/// chooses them.
///
/// ```
/// use htex_author::Grid;
///
/// assert_eq!("auto".parse::<Grid>()?, Grid::default());
/// let grid = Grid::parse(["speed=40,80,160", "force=0.3,0.6"])?;
/// assert_eq!(grid.speed_mm_s, Some(vec![40.0, 80.0, 160.0]));
/// # Ok::<(), htex_author::AuthorError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Grid {
    /// Speeds, mm/s, ascending.
    pub speed_mm_s: Option<Vec<f64>>,
    /// Normal forces, newtons, ascending.
    pub force_n: Option<Vec<f64>>,
}

impl Grid {
    /// Parses one or more texts such as `auto`, `speed=40,80,160` (mm/s) or `force=0.3,0.6` (N).
    ///
    /// # Errors
    /// Returns an error if a text has none of these forms, or if an axis is given twice. Also
    /// returns an error if a speed or a force is not above 0, is not finite, or is too large, or if
    /// two values of an axis differ by less than 5 %.
    pub fn parse<'a>(texts: impl IntoIterator<Item = &'a str>) -> Result<Self, AuthorError> {
        let mut grid = Self::default();
        for text in texts {
            let wrong = |problem: &str| AuthorError::GridText {
                text: text.chars().take(80).collect(),
                problem: problem.to_owned(),
            };
            if text == "auto" {
                continue;
            }
            let (axis, lines, most) = match text.split_once('=') {
                Some(("speed", lines)) => (&mut grid.speed_mm_s, lines, 1e4),
                Some(("force", lines)) => (&mut grid.force_n, lines, 100.0),
                _ => return Err(wrong("it is neither auto, nor speed=…, nor force=…")),
            };
            if axis.is_some() {
                return Err(wrong("this axis is given twice; write its lines in one list"));
            }
            *axis = Some(parse_lines(lines, most).map_err(|problem| wrong(&problem))?);
        }
        Ok(grid)
    }
}

impl FromStr for Grid {
    type Err = AuthorError;

    fn from_str(text: &str) -> Result<Self, AuthorError> {
        Self::parse([text])
    }
}

fn parse_lines(text: &str, most: f64) -> Result<Vec<f64>, String> {
    let mut lines = Vec::new();
    for part in text.split(',') {
        let value: f64 =
            part.trim().parse().map_err(|_| format!("{:?} is not a number", part.trim()))?;
        if !(value > 0.0 && value <= most) {
            return Err(format!("{value} is not above 0 and at most {most}"));
        }
        lines.push(value);
    }
    htex_dsp::order::sort_by(&mut lines, f64::total_cmp);
    let near = |pair: &&[f64]| htex_format::Condition::is_same(pair[0], pair[1]);
    match lines.windows(2).find(near) {
        None => Ok(lines),
        Some(pair) => Err(format!(
            "{} and {} differ by less than 5 %, which a player treats as one",
            pair[0], pair[1]
        )),
    }
}
