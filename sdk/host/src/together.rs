//! Several voices, rendered in as few calls as their models allow.

use htex_model::voices_1::{MAX_VOICES, VoicesTable};

use crate::{HostError, ModelVoice};

/// The extension of models that render several voices in one call.
pub const VOICES_EXTENSION: &str = VoicesTable::ID;

/// Fills `out` with the next `frames` samples of each voice, one voice behind the other: what
/// [`ModelVoice::render`] gives of each, to the bit. Neighbours of one model are rendered in one call
/// where the model has the extension `htex.voices/1`, as the built-in ones have. In blocks of
/// 256 frames AR takes some six tenths of the time then (`cargo xtask bench`); below 64 frames, and of
/// other models, voices are rendered one after the other. Voices for which `out` has no room stay as they
/// are, and room without a voice is silent. Does not allocate, lock or block for well-made models.
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
/// The first, when a model fails; what it should have rendered is silent, and other voices play on.
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
        if !run.takes(voice) {
            result = result.and(run.render(frames, &mut rest));
        }
        run.push(voice);
    }
    result = result.and(run.render(frames, &mut rest));
    rest.fill(0.0);
    result
}

/// Voices for one call.
#[derive(Default)]
struct Run<'a> {
    voices: [Option<&'a mut ModelVoice>; MAX_VOICES],
    count: usize,
}

impl<'a> Run<'a> {
    /// Whether one more voice can be in this call.
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

    /// Renders its voices into the front of `rest`, and is empty again.
    fn render(&mut self, frames: usize, rest: &mut &mut [f32]) -> Result<(), HostError> {
        let Self { mut voices, count } = std::mem::take(self);
        let (out, behind) = std::mem::take(rest).split_at_mut(count * frames);
        *rest = behind;
        match &mut voices[..count] {
            [] => Ok(()),
            [one] => one.as_mut().map_or(Ok(()), |voice| voice.render(out)),
            several => call(several, frames, out),
        }
    }
}

/// One call for several voices of one model.
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
    // SAFETY: live slices, as many rows of `out` as handles. Each handle is held by its voice alone, of
    // which there are exclusive references here, so no other thread uses it.
    let answer = unsafe { render(handles.as_ptr(), count, out.as_mut_ptr(), frames) };
    first
        .check("htex_voices_1_render", answer)
        .inspect_err(|_| out.fill(0.0))?;
    let mut result = Ok(());
    for (voice, row) in voices.iter().flatten().zip(out.chunks_exact_mut(frames)) {
        let finite = voice.check_finite(row);
        result = result.and(finite.inspect_err(|_| row.fill(0.0)));
    }
    result
}
