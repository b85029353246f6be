//! A node of a model file. It has a speed, a force, and the filter at this speed and force.

use htex_dsp::all_zero::MAX_ORDER;
use htex_dsp::line_spectrum::line_spectral_frequencies;
use htex_dsp::linear_prediction::is_stable;

use super::element::Element;
use super::work::Work;
use super::zeros::{NotFound, inside};
use crate::error::Fault;

/// Largest difference that causes no warning, radians. The difference is between a line spectral
/// frequency in the file and the same frequency computed from the coefficients.
const LINE_ERROR: f64 = 1e-3;

/// The problem that is reported for a file whose filters take too much work.
const TOO_MUCH: &str = "the filters up to here take too much work, by their number, their orders and their zeros outside the unit circle; split the file";

/// A filter at one speed and force. The acceleration is noise of variance `variance`, filtered by
/// `gain (1 + Σ ma_i z⁻ⁱ) / (1 + Σ ar_i z⁻ⁱ)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    pub speed_mm_s: f64,
    pub force_n: f64,
    /// Coefficients of the denominator. The first coefficient is always 1 and is not in this list.
    pub ar: Vec<f64>,
    /// Coefficients of the numerator. The first coefficient is always 1 and is not in this list.
    /// All zeros of the numerator are inside the unit circle.
    pub ma: Vec<f64>,
    /// Variance of the noise, (m/s²)²; 0 at a silent node.
    pub variance: f64,
    pub gain: f64,
    /// Where the node is in the file: its line number, and a text with this line and the name of
    /// the element.
    pub(super) line: usize,
    pub(super) place: String,
}

impl Node {
    pub(super) fn read(
        element: &Element,
        notes: &mut Vec<String>,
        work: &mut Work,
    ) -> Result<Self, Fault> {
        let ar = coefficients(element, "ARcoeff", true)?;
        let ma = coefficients(element, "MAcoeff", false)?;
        let of = |name: &str, most: f64| element.required(name)?.number_in(0.0, most);
        let given = element.required("ARcoeff")?;
        let negated: Vec<f64> = ar.iter().map(|a| -a).collect();
        if !is_stable(&negated) {
            return Err(
                given.fault("the filter is not stable: a pole lies on or outside the unit circle")
            );
        }
        let lines = work.add_lines(ar.len()).and(work.add_lines(ma.len()));
        lines.ok_or_else(|| element.fault(TOO_MUCH))?;
        let at = element.one("MAcoeff")?.unwrap_or(element);
        let (ma, mirrored) = inside(&ma, work).map_err(|error| {
            at.fault(match error {
                NotFound::Here => "the zeros of these coefficients cannot be found",
                NotFound::TooMuch => TOO_MUCH,
            })
        })?;
        compare_lines(element, "ARlsf", &ar, notes)?;
        if mirrored == 1.0 {
            compare_lines(element, "MAlsf", &ma, notes)?;
        }
        let gain = match element.one("gain")? {
            Some(gain) => gain.number_in(-1e6, 1e6)?.abs(),
            None => 1.0,
        };
        Ok(Self {
            speed_mm_s: of("speedMod", 1e5)?,
            force_n: of("forceMod", 1e4)?,
            variance: of("var", 1e12)?,
            gain: gain * mirrored,
            line: element.line,
            place: element.place(),
            ar,
            ma,
        })
    }

    /// Returns the product of the gain and the noise's standard deviation, m/s²; 0 at a silent
    /// node.
    pub fn deviation(&self) -> f64 {
        self.gain * self.variance.sqrt()
    }
}

/// Returns the coefficients of a polynomial without the first one, which must be 1.
fn coefficients(node: &Element, name: &str, is_required: bool) -> Result<Vec<f64>, Fault> {
    let list = if is_required { Some(node.required(name)?) } else { node.one(name)? };
    let Some(list) = list else {
        return Ok(Vec::new());
    };
    let values = list.values()?;
    let Some((first, rest)) = values.split_first() else {
        return Err(list.fault("it has no value; the first coefficient is 1"));
    };
    if (first - 1.0).abs() > 1e-9 {
        return Err(list.fault(format!("the first coefficient is {first}; it is 1")));
    }
    if rest.len() > MAX_ORDER {
        let words = format!("{} coefficients are more than {MAX_ORDER}, the most", rest.len());
        return Err(list.fault(words));
    }
    Ok(rest.to_vec())
}

/// Compares the line spectral frequencies in the file, if there are any, with those that are
/// computed from the coefficients.
fn compare_lines(
    node: &Element,
    name: &str,
    coefficients: &[f64],
    notes: &mut Vec<String>,
) -> Result<(), Fault> {
    let Some(list) = node.one(name)? else {
        return Ok(());
    };
    let given = list.values()?;
    if given.len() != coefficients.len() {
        let words = format!(
            "{} lines beside {} coefficients; each coefficient but the first has one",
            given.len(),
            coefficients.len()
        );
        return Err(list.fault(words));
    }
    let negated: Vec<f64> = coefficients.iter().map(|b| -b).collect();
    let own = line_spectral_frequencies(&negated).unwrap_or_default();
    let pairs = own.iter().zip(&given);
    let error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    if error > LINE_ERROR {
        notes.push(format!(
            "{}: the lines differ by {error:.4} rad from the lines of the coefficients; the coefficients are used",
            list.place()
        ));
    }
    Ok(())
}
