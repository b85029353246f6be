//! Plays a voice in the audio thread, and fades to another voice. Another thread sends the
//! commands.

use std::error::Error;
use std::path::Path;

use htex::{Motion, Texture, Voice, VoiceOptions};
use rtrb::{Consumer, Producer, RingBuffer};

/// RMS at which each texture plays its default condition, relative to full scale.
const LEVEL: f64 = 0.1;
/// Duration of a fade, seconds.
const FADE_S: f32 = 0.02;
/// Maximum number of voices that sound at the same time: the current voice and the voices fading
/// out.
const MOST_TRACKS: usize = 4;
const BLOCK: usize = 64;

/// A command from the other thread.
pub(crate) enum Command {
    Move(Motion),
    Fade(Box<Voice>),
}

/// The other thread's ends of the two ring buffers.
pub(crate) struct Remote {
    pub(crate) commands: Producer<Command>,
    /// Voices that have faded out. They are dropped here, since freeing memory takes time.
    pub(crate) finished: Consumer<Box<Voice>>,
}

struct Track {
    voice: Box<Voice>,
    /// Progress of the fade, 0 to 1, and its step per sample.
    progress: f32,
    step: f32,
}

/// Renders in the audio thread: does not allocate, lock or wait.
pub(crate) struct Player {
    commands: Consumer<Command>,
    finished: Producer<Box<Voice>>,
    tracks: Vec<Track>,
    motion: Motion,
    step: f32,
}

impl Player {
    pub(crate) fn new(rate_hz: f64) -> (Self, Remote) {
        let (sender, commands) = RingBuffer::new(64);
        let (finished, receiver) = RingBuffer::new(64);
        let player = Self {
            commands,
            finished,
            tracks: Vec::with_capacity(MOST_TRACKS + 1),
            motion: Motion::AWAY,
            step: 1.0 / (FADE_S * rate_hz as f32),
        };
        (player, Remote { commands: sender, finished: receiver })
    }

    /// Fills `out` with the next samples, relative to full scale.
    pub(crate) fn render(&mut self, out: &mut [f32]) {
        while let Ok(command) = self.commands.pop() {
            match command {
                Command::Move(motion) => self.motion = motion,
                Command::Fade(voice) => self.fade(voice),
            }
        }
        out.fill(0.0);
        let mut samples = [0.0; BLOCK];
        for block in out.chunks_mut(BLOCK) {
            for Track { voice, progress, step } in &mut self.tracks {
                let samples = &mut samples[..block.len()];
                // After an error the voice plays on as before, or is silent.
                let _ = voice.set_motion(self.motion);
                let _ = voice.render(samples);
                for (sum, sample) in block.iter_mut().zip(samples) {
                    *progress = (*progress + *step).clamp(0.0, 1.0);
                    // Equal power: a fade between two textures of the same level keeps this level.
                    *sum += *sample * (std::f32::consts::FRAC_PI_2 * *progress).sin();
                }
            }
        }
        self.drop_silent();
    }

    fn fade(&mut self, voice: Box<Voice>) {
        for track in &mut self.tracks {
            track.step = -self.step;
        }
        if self.tracks.len() == MOST_TRACKS {
            let quietest = |a: &usize, b: &usize| {
                self.tracks[*a].progress.total_cmp(&self.tracks[*b].progress)
            };
            if let Some(index) = (0..MOST_TRACKS).min_by(quietest) {
                self.tracks[index].progress = 0.0;
                self.drop_silent();
            }
        }
        self.tracks.push(Track { voice, progress: 0.0, step: self.step });
    }

    /// Sends to the other thread all voices that have faded out.
    fn drop_silent(&mut self) {
        for index in (0..self.tracks.len()).rev() {
            let Track { progress, step, .. } = self.tracks[index];
            if progress == 0.0 && step < 0.0 {
                let _ = self.finished.push(self.tracks.swap_remove(index).voice);
            }
        }
    }
}

/// Opens a texture and makes a voice of it. The gain gives all textures the same level.
pub(crate) fn open(texture: &str, rate_hz: f64) -> Result<Box<Voice>, htex::Error> {
    let texture = Texture::open(texture)?;
    let options = VoiceOptions::default()
        .with_rate_hz(rate_hz)
        .with_gain(LEVEL / texture.level_rms(None)?)
        .with_limit(0.9);
    Ok(Box::new(texture.voice(&options)?))
}

/// Writes a WAV file with four seconds of a stroke over the textures, one texture after the other.
pub(crate) fn write_wav(file: &Path, textures: &[String]) -> Result<(), Box<dyn Error>> {
    const RATE_HZ: u32 = 48_000;
    let (mut player, mut remote) = Player::new(RATE_HZ.into());
    let mut wav = hound::WavWriter::create(
        file,
        hound::WavSpec {
            channels: 1,
            sample_rate: RATE_HZ,
            bits_per_sample: 32,
            sample_format: hound::SampleFormat::Float,
        },
    )?;
    let blocks = 400 / textures.len();
    for texture in textures {
        remote.commands.push(Command::Fade(open(texture, RATE_HZ.into())?))?;
        for block in 0..blocks {
            let phase = std::f64::consts::PI * block as f64 / blocks as f64;
            let motion = Motion::new(40.0 + 120.0 * phase.sin(), 0.4);
            remote.commands.push(Command::Move(motion))?;
            let mut samples = [0.0; RATE_HZ as usize / 100];
            player.render(&mut samples);
            samples.into_iter().try_for_each(|x| wav.write_sample(x))?;
            while remote.finished.pop().is_ok() {}
        }
    }
    Ok(wav.finalize()?)
}
