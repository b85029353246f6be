//! Renders several voices in as few calls as their models allow.
//!
//! Adjacent voices of the same model form a group, which one call renders. If a model has no
//! function that renders several voices, a separate call renders each of its voices.

use htex_model::voices_1::{MAX_VOICES, VoicesTable};

use crate::{HostError, ModelVoice};

/// Id of the extension of models that can render several voices in one call.
pub const VOICES_EXTENSION: &str = VoicesTable::ID;

/// Fills `out` with the next `frames` samples of each voice, one voice after another. The samples
/// are bit-identical to those of separate calls of [`ModelVoice::render`]. Adjacent voices of the
/// same model are rendered in one call if the model has the extension `htex.voices/1`, as the
/// built-in models do. The voices of a model without the extension are rendered in separate calls.
/// If `out` is too short, the remaining voices do not advance; if `out` is too long, its rest is
/// filled with zeros. Does not allocate, lock or block if the models follow the ABI.
///
/// For the model AR in blocks of 256 frames, rendering in one call reduces the time to about six
/// tenths (`cargo xtask bench`). For fewer than 64 frames, AR saves no time.
///
/// ```
/// use htex_host::{Band, Registry, render_together};
/// let registry = Registry::builtin();
/// let ar = registry.find("ar")?;
/// let voice = |seed| ar.voice(&[2.0, 1.2, -0.8, 2_000.0], Band::TACTILE, 2_000.0, seed);
/// let mut voices = [voice(1)?, voice(2)?, voice(3)?, voice(4)?];
/// let mut out = [0.0; 4 * 128];
/// render_together(&mut voices, 128, &mut out)?;
/// # Ok::<(), htex_host::HostError>(())
/// ```
///
/// # Errors
/// Returns the first error that a model returns. The samples of the failed voice are zero, and the
/// other voices continue.
pub fn render_together<'a>(
    voices: impl IntoIterator<Item = &'a mut ModelVoice>,
    frames: usize,
    out: &mut [f32],
) -> Result<(), HostError> {
    let mut result = Ok(());
    let mut run = Run::default();
    let mut rows = out.len().checked_div(frames).unwrap_or_default();
    let mut rest = out;
    for voice in voices {
        if rows == 0 {
            break;
        }
        rows -= 1;
        // If this voice belongs to another model, or the call is full, the collected voices are
        // rendered first.
        if !run.takes(voice) {
            result = result.and(run.render(frames, &mut rest));
        }
        run.push(voice);
    }
    result = result.and(run.render(frames, &mut rest));
    rest.fill(0.0);
    result
}

/// Voices collected for one call.
#[derive(Default)]
struct Run<'a> {
    voices: [Option<&'a mut ModelVoice>; MAX_VOICES],
    count: usize,
}

impl<'a> Run<'a> {
    /// Returns whether the same call can also render this voice.
    fn takes(&self, voice: &ModelVoice) -> bool {
        let (Some(first), Some(new)) = (self.first(), voice.together()) else {
            return self.count == 0;
        };
        self.count < MAX_VOICES && std::ptr::eq(first.table, new.table)
    }

    fn first(&self) -> Option<crate::raw::Together> {
        self.voices[0].as_ref()?.together()
    }

    fn push(&mut self, voice: &'a mut ModelVoice) {
        if let Some(place) = self.voices.get_mut(self.count) {
            *place = Some(voice);
            self.count += 1;
        }
    }

    /// Renders the voices to the front of `rest`, and removes that part from `rest`.
    fn render(&mut self, frames: usize, rest: &mut &mut [f32]) -> Result<(), HostError> {
        let Self { mut voices, count } = std::mem::take(self);
        let (out, after) = std::mem::take(rest).split_at_mut(count * frames);
        *rest = after;
        match &mut voices[..count] {
            [] => Ok(()),
            [one] => one.as_mut().map_or(Ok(()), |voice| voice.render(out)),
            several => call(several, frames, out),
        }
    }
}

/// Renders several voices of one model in one call.
fn call(
    voices: &[Option<&mut ModelVoice>],
    frames: usize,
    out: &mut [f32],
) -> Result<(), HostError> {
    let mut handles = [0; MAX_VOICES];
    let (mut count, mut render) = (0, None);
    for voice in voices.iter().flatten() {
        if let Some(together) = voice.together() {
            (handles[count], render) = (together.handle, Some(together.render));
            count += 1;
        }
    }
    let (Some(render), Some(Some(first))) = (render, voices.first()) else {
        return Ok(());
    };
    // SAFETY: the slices are live, with one row of `out` per handle. Only the voice itself has its
    // handle, and the references to the voices are exclusive. Therefore, no other thread uses a
    // handle.
    let status = unsafe { render(handles.as_ptr(), count, out.as_mut_ptr(), frames) };
    first.done("htex_voices_1_render", status).inspect_err(|_| out.fill(0.0))?;
    let mut result = Ok(());
    for (voice, row) in voices.iter().flatten().zip(out.chunks_exact_mut(frames)) {
        let finite = voice.check_finite(row);
        result = result.and(finite.inspect_err(|_| row.fill(0.0)));
    }
    result
}
