//! Findings: problems of recordings, with stable codes.

mod band;
mod coefficient;
mod course;
mod differing;
mod lanes;
mod levels;
mod page;
mod plausible;
mod quantile;
mod segments;
mod spikes;
mod stuck;

use htex_base::finding::{Finding, Findings};
use htex_format::Quantity;

use crate::Recording;
use levels::Levels;

pub(crate) use differing::{differing, level_of};
pub use htex_recording::rules::RULES;
pub(crate) use htex_recording::rules::{
    GRID_NOT_BETTER, RECORDING_NOTED, RECORDING_OFF_TARGET, RECORDING_UNREADABLE,
    RECORDING_UNSTEADY, RECORDING_UNUSABLE,
};
pub use page::findings_page;
pub(crate) use quantile::quantile;
pub(crate) use segments::judge_segments;

/// Checks the signals of a recording. The checks find clipping, stuck sensors, spikes, ramps,
/// alternating values, a band without a texture, and forces or speeds that a finger cannot have.
/// The result also includes the findings about the time column, made when the file was read.
///
/// ```
/// use htex_author::{Recording, recording_findings};
///
/// let held = Recording::new("held.csv", 1000.0, vec![vec![0.3; 2000]])?;
/// assert_eq!(recording_findings(&held)[0].code, "RECORDING_STUCK");
/// # Ok::<(), htex_author::recording::RecordingError>(())
/// ```
pub fn recording_findings(recording: &Recording) -> Vec<Finding> {
    let mut findings = Findings::default();
    let mut is_texture = true;
    for axis in 0..recording.axes.len() {
        let levels = levels::judge(recording, axis, &mut findings);
        let has_course = course::judge_axis(recording, axis, &mut findings);
        // A ramp or a coarse signal also leaks into the band, but the finding for the ramp or the
        // coarse signal is more specific.
        is_texture &= !has_course && matches!(levels, Levels::ClippedAt(_));
        if let Levels::ClippedAt(clips) = levels {
            stuck::judge_axis(recording, axis, &clips, &mut findings);
            spikes::judge_axis(recording, axis, &mut findings);
        }
    }
    if is_texture {
        band::judge(recording, &mut findings);
    }
    // If the normal force is the texture, its axis has just been checked.
    if recording.quantity != Quantity::NormalForce {
        stuck::judge_normal(recording, &mut findings);
        spikes::judge_normal(recording, &mut findings);
    }
    if recording.quantity == Quantity::LateralForce {
        plausible::judge_friction(recording, &mut findings);
        coefficient::judge(recording, &mut findings);
    }
    plausible::judge_speed(recording, &mut findings);
    let found = findings.into_list();
    recording.clock_findings.iter().cloned().chain(found).collect()
}

/// Names an axis for use in a sentence: `lateral_x force`, `signal_z`.
fn axis_words(recording: &Recording, axis: usize) -> String {
    let name = recording.axis_name(axis);
    match recording.quantity {
        Quantity::LateralForce | Quantity::NormalForce => format!("{name} force"),
        _ => name.to_owned(),
    }
}

/// Returns a JSON pointer to a sample of a signal. Samples are counted from the start of the file.
fn pointer(recording: &Recording, signal: &str, sample: usize) -> String {
    format!("/{signal}/{}", recording.first_sample + sample)
}
