//! A voice: a texture that plays.

use htex_dsp::envelope::Analyser;
use htex_dsp::glide::Glide;
use htex_dsp::random_envelope::RandomEnvelope;
use htex_format::Fluctuation;
use htex_host::{StillSound, Stream};

use crate::envelope::{self, Envelope};
use crate::exploration::{Coverage, Reach};
use crate::follow::Follow;
use crate::output::Output;
use crate::travel::Travel;
use crate::{Effects, Error, Motion, SampleSource, VoiceOptions};

// A voice may be made in one thread and rendered in another.
const _: () = {
    const fn assert_send<T: Send>() {}
    assert_send::<Voice>();
    assert_send::<SampleSource>();
};

/// Number of samples that `render_add` renders at a time.
const ADDED: usize = 256;
/// Duration of a change of level, seconds.
const RAMP_S: f64 = 0.010;

/// A voice: an endless stream of samples in the asset's unit
/// ([`Texture::quantity`](crate::Texture::quantity)). A voice follows the finger's motion with the
/// same [`Effects`](crate::Effects) as a scene. A voice is [`Send`]: one thread can make it, and an
/// audio thread can render it.
///
/// ```no_run
/// use htex::{Motion, Texture, VoiceOptions};
/// // Recorded at 80 mm/s and 0.4 N.
/// let mut voice = Texture::open("sandpaper.htex")?.voice(&VoiceOptions::default())?;
/// voice.set_motion(Motion::new(160.0, 0.8))?; // an octave higher, twice as strong
/// voice.set_motion(Motion::new(0.0, 0.8))?; // silent
/// println!("{}", voice.coverage(Motion::new(160.0, 0.8)));
/// # Ok::<(), htex::Error>(())
/// ```
#[derive(Debug)]
pub struct Voice {
    stream: Stream<SampleSource>,
    /// Pre-rendered audio. If present, the stream's source supplies only the level.
    still: Option<StillSound>,
    level_rms: Glide,
    fluctuation: Option<RandomEnvelope>,
    follow: Follow,
    /// The finger's position, for a model that follows the motion.
    travel: Option<Travel>,
    output: Output,
    analyser: Option<Analyser>,
    /// Frames rendered so far.
    frames: u64,
    /// Frames for which the source was rendered. The source pauses while the voice is silent, so
    /// this may be less than `frames`.
    played: u64,
    rate_hz: f64,
    /// Ceiling of the level, as a multiple of the strongest recorded level.
    ceiling: f64,
    /// The last motion.
    asked: Option<Motion>,
    /// The motion at the start.
    started: Motion,
}

impl Voice {
    /// Makes a voice from a source, or from a pre-rendered sound `still`. The voice reads the
    /// source `base` times as fast as recorded. The texture has a `fluctuation` only if the options
    /// ask for it.
    pub(crate) fn new(
        source: SampleSource,
        still: Option<StillSound>,
        options: &VoiceOptions,
        base: f64,
        fluctuation: Option<Fluctuation>,
    ) -> Result<Self, Error> {
        let rate_hz = options.rate_hz;
        let ramp = (RAMP_S * rate_hz).ceil().max(1.0) as u32;
        // A pre-rendered sound has the voice's rate and the recorded speed.
        let base = if still.is_some() { 1.0 } else { base };
        // A pre-rendered sound cannot follow the motion.
        let travel = (source.follows_motion() && still.is_none())
            .then(|| Travel::new(source.motion().speed_mm_s, rate_hz));
        let effects = match travel {
            None => options.effects,
            Some(_) => Effects::NONE.with_contact(options.effects.contact),
        };
        let highest = 0.5 * rate_hz / source.top_hz();
        let range = source.conditions().range();
        let mut follow = Follow::new(range, effects, base, highest, rate_hz);
        if let Some(motion) = options.motion {
            let scaling = source.conditions().scaling(motion, options.ceiling);
            follow.start(motion, scaling);
        }
        let level_rms = source.level_rms() * follow.gain();
        let analyser = envelope::analyser(options.envelope_bands, source.band(), rate_hz)?;
        let (source_rate_hz, top_hz) = (source.rate_hz() * base, source.top_hz() * base);
        let own_rate = source.has_own_rate();
        let mut voice = Self {
            started: source.motion(),
            level_rms: Glide::new(level_rms as f32, ramp),
            fluctuation: fluctuation
                .filter(|fluctuation| !fluctuation.is_zero())
                .map(|f| RandomEnvelope::new(f.decibels(), rate_hz, options.seed)),
            stream: Stream::from_source(source, source_rate_hz, rate_hz, top_hz, own_rate)?,
            still,
            follow,
            travel,
            output: Output::new(options.gain, options.limit, ramp, rate_hz)?,
            analyser,
            frames: 0,
            played: 0,
            rate_hz,
            ceiling: options.ceiling,
            asked: options.motion,
        };
        if let Some(motion) = options.motion {
            voice.send_motion(motion)?;
        }
        Ok(voice)
    }

    /// Sets the motion of the finger. Spectrum and level change gradually to values interpolated
    /// between the recorded conditions. If the voice is not streamed
    /// ([`Synthesis`](crate::Synthesis)), only the level changes.
    ///
    /// Outside the recorded conditions, the voice takes frequencies and level from the nearest
    /// motion within the recorded range, and scales them by the asset's scaling law
    /// ([`Law`](htex_format::Law)). Frequencies are at least 1/16 and at most 8 times the recorded
    /// frequencies, and never exceed half the sample rate. The level is at most
    /// [`ceiling`](VoiceOptions::with_ceiling) times the strongest recorded level. The voice is
    /// silent while the finger does not slide (below 0.5 mm/s or at 0 N). Each of these effects can
    /// be switched off ([`Effects`](crate::Effects)). [`Self::coverage`] reports how these effects
    /// apply to a motion.
    ///
    /// A motion above 1 m/s or 20 N, or with a value out of range, counts as a failed reading. The
    /// voice then holds the last valid motion for at most 100 ms. After that, the voice is silent
    /// until the next valid motion.
    ///
    /// Setting the same motion again costs no time. For a new motion, the voice interpolates
    /// parameters in memory that it already owns. Does not allocate, lock or do I/O if the model
    /// keeps to the ABI, as this project's models do.
    ///
    /// # Errors
    /// Returns an error if a value is out of range (see [`Motion`]); the voice then continues as
    /// after a failed reading. Also returns an error if the model cannot interpolate; the voice
    /// then continues unchanged.
    pub fn set_motion(&mut self, motion: Motion) -> Result<(), Error> {
        let checked = motion.checked();
        if checked.is_err() || !motion.is_plausible() {
            self.follow.hold(self.frames);
            return checked.map(|_| ());
        }
        self.send_motion(motion)?;
        let felt = self.follow.is_felt(motion);
        self.follow.set_contact(felt);
        let is_new = !self.asked.is_some_and(|asked| asked.has_conditions_of(&motion));
        if felt && is_new {
            let source = self.stream.source_mut();
            let placement = source.conditions().locate(motion);
            let scaling = source.conditions().bounded(&placement, self.ceiling);
            let level_rms = source.retune(motion, &placement)?;
            self.follow.scale(motion, scaling);
            self.level_rms.set((level_rms * self.follow.gain()) as f32);
        }
        self.asked = Some(motion);
        Ok(())
    }

    /// Returns whether the model follows the motion itself (the extension `htex.motion/1`). The
    /// model then determines frequencies and level, and the voice scales neither. Returns false for
    /// a voice that is not streamed ([`Synthesis`](crate::Synthesis)).
    pub fn follows_motion(&self) -> bool {
        self.travel.is_some()
    }

    /// Passes the motion to a model that follows it.
    fn send_motion(&mut self, motion: Motion) -> Result<(), Error> {
        let Some(travel) = &mut self.travel else {
            return Ok(());
        };
        let Some(motion) = travel.set(motion) else {
            return Ok(());
        };
        self.stream.source_mut().follow(motion, self.played as f64 / self.rate_hz)
    }

    /// Returns how this voice plays a motion, and whether the motion is within the range of the
    /// recorded conditions. Does not allocate.
    pub fn coverage(&self, motion: Motion) -> Coverage {
        let effects = self.follow.effects();
        let mut coverage = self.stream.source().conditions().coverage(motion, effects);
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

    /// Returns the motion that was set last, or the motion at the start if none was set.
    pub fn motion(&self) -> Motion {
        self.asked.unwrap_or(self.started)
    }

    /// Returns the magnitudes that a long recording of this voice would show at the current motion.
    /// Frequencies are in hertz, magnitudes in the asset's unit. The magnitudes include the
    /// effects, the [`ceiling`](VoiceOptions::with_ceiling) and the gain, but not the limiter. If
    /// the voice is still adapting to the current motion, the function returns the magnitudes that
    /// the voice will have afterwards. If the voice is silent, all magnitudes are 0.
    ///
    /// # Errors
    /// Returns an error if the model refuses the parameters.
    pub fn magnitude(&self, frequency_hz: &[f64]) -> Result<Vec<f64>, Error> {
        if self.asked.is_some_and(|motion| !self.follow.is_felt(motion)) {
            return Ok(vec![0.0; frequency_hz.len()]);
        }
        let source = self.stream.source();
        // A pre-rendered sound keeps the spectrum of its start.
        let motion = match self.still {
            Some(_) => self.started,
            None => source.motion(),
        };
        let level_rms = source.level_rms() * self.follow.gain() * self.output.gain();
        source.magnitude(motion, frequency_hz, self.follow.ratio(), level_rms)
    }

    /// Sets the gain, which changes gradually (10 ms). Does not allocate.
    ///
    /// # Errors
    /// Returns an error if the gain is negative or not finite. The gain then keeps its old value.
    pub fn set_gain(&mut self, gain: f64) -> Result<(), Error> {
        self.output.set_gain(gain, self.follow.rests())
    }

    /// Returns whether the voice is silent: its samples are 0 until the finger slides again. A
    /// voice without the effect `contact` is never silent in this sense.
    pub fn is_silent(&self) -> bool {
        self.follow.rests()
    }

    /// Fills `out` with the next samples, in the asset's unit. Does not allocate, lock or do I/O.
    /// While the voice is silent ([`Self::is_silent`]), this function takes hardly any time and
    /// does not advance the noise. When the finger slides again, the noise continues where it
    /// stopped.
    ///
    /// # Errors
    /// Returns an error if the model fails. The samples that the model did not render are then
    /// zero.
    pub fn render(&mut self, out: &mut [f32]) -> Result<(), Error> {
        let sounding = self.follow.sounding(out.len(), self.frames);
        let (sounding, resting) = out.split_at_mut(sounding);
        let mut result = Ok(());
        if !sounding.is_empty() {
            result = self.render_shape(sounding);
            self.level_rms.apply(sounding);
            if let Some(fluctuation) = &mut self.fluctuation {
                fluctuation.apply(sounding);
            }
            self.follow.apply_contact(sounding, self.frames);
            self.output.apply(sounding);
            self.played += sounding.len() as u64;
            if let Some(analyser) = &mut self.analyser {
                analyser.push(sounding);
            }
        }
        if !resting.is_empty() {
            resting.fill(0.0);
            self.output.rest();
            if let Some(analyser) = &mut self.analyser {
                analyser.push_zeros(resting.len());
            }
        }
        self.frames += out.len() as u64;
        if let Some(travel) = &mut self.travel {
            travel.advance(out.len());
        }
        result
    }

    /// Returns the sample rate, hertz.
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Returns an endless iterator over the next samples, in the asset's unit. The iterator renders
    /// only the samples that are requested, so the voice later continues after the last sample that
    /// was taken. [`Self::render`] is faster. Does not allocate, lock or do I/O. If the model
    /// fails, the iterator returns the error and then ends.
    ///
    /// ```no_run
    /// use htex::{Texture, VoiceOptions};
    /// let mut voice = Texture::open("sandpaper.htex")?.voice(&VoiceOptions::default())?;
    /// let second = voice.rate_hz() as usize;
    /// let samples = voice.samples().take(second).collect::<Result<Vec<f32>, _>>()?;
    /// # Ok::<(), htex::Error>(())
    /// ```
    pub fn samples(&mut self) -> impl Iterator<Item = Result<f32, Error>> {
        let mut failed = false;
        std::iter::from_fn(move || {
            if failed {
                return None;
            }
            let mut sample = [0.0];
            let result = self.render(&mut sample).map(|()| sample[0]);
            failed = result.is_err();
            Some(result)
        })
    }

    /// Multiplies the next samples by `gain` and adds them to `out`, to mix several voices. Does
    /// not allocate, lock or do I/O.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::render`]. Also returns an error if `gain` is not finite;
    /// `out` is then unchanged.
    pub fn render_add(&mut self, out: &mut [f32], gain: f32) -> Result<(), Error> {
        if !gain.is_finite() {
            return Err(Error::OutOfRange {
                name: "gain",
                value: gain.into(),
                range: "it must be finite",
            });
        }
        let mut result = Ok(());
        let mut samples = [0.0; ADDED];
        for block in out.chunks_mut(ADDED) {
            let samples = &mut samples[..block.len()];
            // The other blocks are rendered even after an error, so that the voice's time goes on.
            result = result.and(self.render(samples));
            for (sum, sample) in block.iter_mut().zip(samples) {
                *sum += gain * *sample;
            }
        }
        result
    }

    /// Returns the level and the mean frequency of the samples rendered since the last call, or
    /// since the start if this is the first call. All effects, the gain and the limiter are
    /// included in the level and the frequency. Does not allocate, lock or do I/O.
    ///
    /// Also writes the mean square in each band ([`VoiceOptions::with_envelope_bands`]) to `bands`,
    /// in the square of the asset's unit. `bands` may be empty.
    ///
    /// The level is exact. The mean frequency and the bands have a delay of about 20 ms, because
    /// they are computed from windows of 40 to 80 ms ([`crate::envelope`]).
    ///
    /// ```no_run
    /// use htex::{Texture, VoiceOptions};
    /// let options = VoiceOptions::default().with_envelope_bands(4);
    /// let mut voice = Texture::open("sandpaper.htex")?.voice(&options)?;
    /// let (mut block, mut bands) = ([0.0; 200], [0.0; 4]);
    /// voice.render(&mut block)?; // 10 ms
    /// let envelope = voice.envelope(&mut bands)?;
    /// println!("{} N at {} Hz", envelope.level_rms, envelope.centroid_hz);
    /// # Ok::<(), htex::Error>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if the voice has no bands, or `bands` has another length.
    pub fn envelope(&mut self, bands: &mut [f64]) -> Result<Envelope, Error> {
        envelope::read(self.analyser.as_mut(), bands)
    }

    /// Returns the edges of the bands of [`Self::envelope`], hertz. The list has one edge more than
    /// the number of bands, and is empty if the voice has no bands. The ratio between neighbouring
    /// edges is constant, from the lowest to the highest frequency of the asset. In addition, the
    /// first band includes all frequencies down to 0 Hz, and the last band all frequencies up to
    /// half the sample rate.
    pub fn envelope_edges_hz(&self) -> &[f64] {
        self.analyser.as_ref().map_or(&[], Analyser::edges_hz)
    }

    /// Renders unit-RMS samples at the voice's rate.
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
