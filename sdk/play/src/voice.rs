//! A playing texture.

use htex_dsp::glide::Glide;
use htex_host::{StillSound, Stream};

use crate::exploration::{Coverage, Reach};
use crate::follow::Follow;
use crate::travel::Travel;
use crate::{Effects, Error, Motion, SampleSource, VoiceOptions};

// A voice may be made in one thread and rendered in another.
const _: () = {
    const fn assert_send<T: Send>() {}
    assert_send::<Voice>();
    assert_send::<SampleSource>();
};

/// Length of a change of level, seconds.
const RAMP_S: f64 = 0.010;

/// An endless stream of samples in the asset's unit ([`Asset::quantity`](crate::Asset::quantity)) that follows the
/// finger's motion with the same [`Effects`](crate::Effects) as a scene.
///
/// ```no_run
/// use htex::{Asset, Motion, VoiceOptions};
/// // Recorded at 80 mm/s and 0.4 N.
/// let mut voice = Asset::open("sandpaper.htex")?.voice(&VoiceOptions::default())?;
/// voice.set_motion(Motion::new(160.0, 0.8))?; // an octave higher, twice as strong
/// voice.set_motion(Motion::new(0.0, 0.8))?; // silent
/// println!("{}", voice.coverage(Motion::new(160.0, 0.8)));
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug)]
pub struct Voice {
    stream: Stream<SampleSource>,
    /// Pre-rendered audio; the stream's source then supplies only the level.
    still: Option<StillSound>,
    level_rms: Glide,
    follow: Follow,
    /// The finger's position, for a model that follows the motion.
    travel: Option<Travel>,
    /// Frames rendered so far.
    frames: u64,
    rate_hz: f64,
    /// Highest level, as a multiple of the strongest recorded one.
    ceiling: f64,
    /// The last motion.
    asked: Option<Motion>,
}

impl Voice {
    /// Makes a voice of a source and the resampler it needs, or of a pre-rendered sound. The resampler reads the source
    /// `base` times as fast as recorded.
    pub(crate) fn new(
        source: SampleSource,
        still: Option<StillSound>,
        options: &VoiceOptions<'_>,
        base: f64,
    ) -> Result<Self, Error> {
        let rate_hz = options.rate_hz;
        let ramp = (RAMP_S * rate_hz).ceil().max(1.0) as u32;
        // A still sound has the voice's rate and the recorded speed.
        let base = if still.is_some() { 1.0 } else { base };
        // With a still sound, the model does not follow the motion.
        let travel = (source.follows_motion() && still.is_none())
            .then(|| Travel::new(source.motion().speed_mm_s, rate_hz));
        let effects = match travel {
            None => options.effects,
            Some(_) => Effects::NONE.with_contact(options.effects.contact),
        };
        let highest = 0.5 * rate_hz / source.top_hz();
        let explored = source.motions().explored();
        let mut follow = Follow::new(explored, effects, base, highest, rate_hz);
        if let Some(motion) = options.motion {
            let scaling = source.motions().scaling(motion, options.ceiling);
            follow.start(motion, scaling);
        }
        let level_rms = source.level_rms() * follow.gain();
        let (source_rate_hz, top_hz) = (source.rate_hz() * base, source.top_hz() * base);
        let mut voice = Self {
            level_rms: Glide::new(level_rms as f32, ramp),
            stream: Stream::of(source, source_rate_hz, rate_hz, top_hz)?,
            still,
            follow,
            travel,
            frames: 0,
            rate_hz,
            ceiling: options.ceiling,
            asked: options.motion,
        };
        if let Some(motion) = options.motion {
            voice.send_motion(motion)?;
        }
        Ok(voice)
    }

    /// Sets the motion. Spectrum and level change gradually to those interpolated between the recorded conditions; if the
    /// voice is not streamed ([`Synthesis`](crate::Synthesis)), only the level changes. Outside the recorded conditions
    /// frequencies and level follow the law of the asset ([`Law`](crate::Law)) from the nearest recorded motion: frequencies
    /// 1/16 to 8 times the recorded ones and up to half the rate, the level up to
    /// [`ceiling`](VoiceOptions::ceiling) times the strongest recorded one. A finger that does not slide (below
    /// 0.5 mm/s or at 0 N) makes the voice silent. Each of these can be switched off ([`Effects`](crate::Effects));
    /// [`Self::coverage`] reports them for a motion.
    ///
    /// A motion above 1 m/s or 20 N, or out of range, is a failed reading: the last good motion is held for at most 100 ms, and the voice
    /// is silent after that until the next good one.
    ///
    /// An unchanged motion takes no time; a new one interpolates parameters in the voice's own memory. Does not allocate,
    /// lock or do I/O if the model keeps to the ABI, as the models of this project do.
    ///
    /// # Errors
    /// When a value is out of range (see [`Motion`]), or the model cannot interpolate; the voice then continues as said, or
    /// unchanged.
    pub fn set_motion(&mut self, motion: Motion) -> Result<(), Error> {
        let checked = motion.checked();
        if checked.is_err() || !motion.is_plausible() {
            self.follow.hold(self.frames);
            return checked.map(|_| ());
        }
        self.send_motion(motion)?;
        let felt = self.follow.is_felt(motion);
        self.follow.set_contact(felt);
        let is_new = !self
            .asked
            .is_some_and(|asked| asked.has_conditions_of(&motion));
        if felt && is_new {
            let source = self.stream.source_mut();
            let located = source.motions().locate(motion);
            let scaling = source.motions().bounded(&located, self.ceiling);
            let level_rms = source.retune(motion, &located)?;
            self.follow.scale(motion, scaling);
            self.level_rms.set((level_rms * self.follow.gain()) as f32);
        }
        self.asked = Some(motion);
        Ok(())
    }

    /// Returns whether the model follows the motion itself (the extension `htex.motion/1`): it then determines frequencies
    /// and level, and neither is scaled. False for a voice that is not streamed.
    pub fn follows_motion(&self) -> bool {
        self.travel.is_some()
    }

    /// Passes the motion to a model that follows it.
    fn send_motion(&mut self, motion: Motion) -> Result<(), Error> {
        let Some(travel) = &mut self.travel else {
            return Ok(());
        };
        let Some(finger) = travel.set(motion) else {
            return Ok(());
        };
        self.stream
            .source_mut()
            .set_finger(finger, self.frames as f64 / self.rate_hz)
    }

    /// Returns how this voice plays a motion, and whether the motion lies within the recorded conditions. Does not
    /// allocate.
    pub fn coverage(&self, motion: Motion) -> Coverage {
        let effects = self.follow.effects();
        let mut coverage = self.stream.source().motions().coverage(motion, effects);
        if self.follows_motion() {
            for reach in [&mut coverage.speed, &mut coverage.force] {
                let beyond = matches!(reach, Reach::Outside { .. } | Reach::Unknown);
                *reach = if beyond { Reach::Followed } else { *reach };
            }
        }
        let frequency = &mut coverage.scaling.frequency;
        *frequency = frequency.min(self.follow.fastest());
        coverage
    }

    /// Fills `out` with the next samples, in the asset's unit. Does not allocate, lock or do I/O.
    ///
    /// # Errors
    /// When the model fails; the samples that it did not render are zero.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        let result = self.render_shape(out);
        self.level_rms.apply(out);
        self.follow.apply_contact(out, self.frames);
        self.frames += out.len() as u64;
        if let Some(travel) = &mut self.travel {
            travel.advance(out.len());
        }
        result
    }

    /// Renders samples of unit RMS at the voice's rate.
    fn render_shape(&mut self, out: &mut [f32]) -> Result<(), Error> {
        let (stream, still, mut result) = (&mut self.stream, &mut self.still, Ok(()));
        self.follow.read(out, &mut |block| match &mut *still {
            Some(still) => still.render(block),
            None => {
                if let Err(error) = stream.render_by(block, SampleSource::render) {
                    result = Err(error);
                }
            }
        });
        result
    }
}
