//! The sound card and the keyboard.

use std::error::Error;

use console::{Key, Term};
use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use htex::Motion;

use crate::player::{Command, Player, open};

/// Factor by which a key changes speed or force.
const STEP: f64 = 1.1;

pub(crate) fn play(textures: &[String]) -> Result<(), Box<dyn Error>> {
    let device = cpal::default_host().default_output_device().ok_or("there is no sound card")?;
    let config = device.default_output_config()?.config();
    let (rate_hz, channels) = (f64::from(config.sample_rate), usize::from(config.channels));
    let (mut player, mut remote) = Player::new(rate_hz);
    let mut mono = vec![0.0; 4096];
    let fill = move |out: &mut [f32], _: &cpal::OutputCallbackInfo| {
        for out in out.chunks_mut(mono.len() * channels) {
            let mono = &mut mono[..out.len() / channels];
            player.render(mono);
            for (frame, sample) in out.chunks_mut(channels).zip(mono) {
                frame.fill(*sample);
            }
        }
    };
    let stream =
        device.build_output_stream(config, fill, |error| eprintln!("sound card: {error}"), None)?;
    stream.play()?;

    let term = Term::stdout();
    println!("arrow keys: speed and force; space: lift; tab: next texture; q: quit");
    let (mut speed_mm_s, mut force_n, mut lifted, mut current) = (80.0, 0.4, false, 0);
    remote.commands.push(Command::Fade(open(&textures[current], rate_hz)?))?;
    loop {
        let motion = if lifted { Motion::AWAY } else { Motion::new(speed_mm_s, force_n) };
        remote.commands.push(Command::Move(motion))?;
        while remote.finished.pop().is_ok() {}
        print!("\r{}: {speed_mm_s:.0} mm/s, {force_n:.2} N  ", textures[current]);
        term.flush()?;
        match term.read_key()? {
            Key::ArrowRight => speed_mm_s = (speed_mm_s * STEP).min(1_000.0),
            Key::ArrowLeft => speed_mm_s /= STEP,
            Key::ArrowUp => force_n = (force_n * STEP).min(20.0),
            Key::ArrowDown => force_n /= STEP,
            Key::Char(' ') => lifted = !lifted,
            Key::Tab => {
                current = (current + 1) % textures.len();
                remote.commands.push(Command::Fade(open(&textures[current], rate_hz)?))?;
            }
            Key::Char('q') | Key::Escape => return Ok(()),
            _ => {}
        }
    }
}
