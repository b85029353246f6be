//! Plays a texture while the finger slows down in steps, and prints the RMS of each tenth of a
//! second.
//!
//! `cargo run --release -p htex --example play -- cloth.htex`

use htex::{Motion, Texture, VoiceOptions};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("give a texture: play FILE.htex")?;
    let texture = Texture::open(&path)?;
    let unit = texture.quantity().unit();
    let mut voice = texture.voice(&VoiceOptions::default())?;
    // A program that follows a real finger sets the motion more often: every 1 to 10 ms.
    let mut block = vec![0.0f32; (voice.rate_hz() / 10.0) as usize];
    for tenth in 0..20 {
        let (speed_mm_s, force_n) = (160.0 - 5.0 * f64::from(tenth), 0.4);
        voice.set_motion(Motion::new(speed_mm_s, force_n))?;
        voice.render(&mut block)?;
        let power: f32 = block.iter().map(|x| x * x).sum::<f32>() / block.len() as f32;
        println!("{speed_mm_s:5.0} mm/s  {:9.6} {unit} RMS", power.sqrt());
    }
    Ok(())
}
