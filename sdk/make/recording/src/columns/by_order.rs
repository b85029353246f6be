//! Assigns roles to channels without names, by the order of the channels.

use htex_base::finding::{Hint, Notice};
use htex_format::Quantity;

use crate::error::{Fault, ReadProblem};
use crate::options::ReadOptions;
use crate::recording::Recording;
use crate::sheet::Sheet;

/// Assigns roles to channels and scales them to the quantity's unit. For a force, one channel is
/// lateral, two are lateral x and y, and three are x, y and normal. For other quantities, the
/// channels are the axes.
pub(crate) fn by_order(
    file: &str,
    sheet: &mut dyn Sheet,
    are_integers: bool,
    options: &ReadOptions,
) -> Result<Recording, Fault> {
    let width = sheet.columns().width();
    if !(1..=3).contains(&width) {
        let problem = format!(
            "{width} channels; without a column map they are 1 (lateral), 2 (lateral x, y), 3 (x, y, normal), or up to 3 axes \
             of a motion; map the channels of the recording, as in lateral=#1:SCALE"
        );
        return Err(sheet.columns().refuse(problem).into());
    }
    let all: Vec<usize> = (0..width).collect();
    let rate_hz = sheet.rate_hz(&all)?.or(options.rate_hz).ok_or(ReadProblem::NoRate)?;
    let mut channels = sheet.numbers(&all)?.columns;
    let scale = options.scale.unwrap_or(1.0);
    if scale != 1.0 {
        let values = channels.iter_mut().flatten();
        values.for_each(|value| *value *= scale);
    }
    let normal = match (options.quantity, &channels[..]) {
        (Quantity::LateralForce, [_, _, _]) => channels.pop(),
        (Quantity::NormalForce, [axis]) => Some(axis.clone()),
        _ => None,
    };
    let mut recording = Recording::from_axes(options.quantity, file, rate_hz, channels)?;
    if let Some(normal) = normal {
        recording = recording.with_normal(normal)?;
    }
    if options.scale.is_none() {
        let told = assumption(are_integers, options.quantity);
        let warning = Notice::new(told, Hint::new(&["scale"]));
        recording.warnings.push(warning);
    }
    Ok(recording)
}

/// Returns the warning for a file of samples for which no scale was given.
fn assumption(are_integers: bool, quantity: Quantity) -> String {
    let unit = quantity.unit();
    if are_integers {
        format!("Integer full scale is assumed to be 1 {unit}; give the scale if it is not.")
    } else {
        format!("Samples are assumed to be in {unit}; give the scale if they are not.")
    }
}
