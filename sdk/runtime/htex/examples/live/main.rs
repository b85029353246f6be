//! Plays textures through the sound card while the arrow keys move the finger.
//!
//! `cargo run --release -p htex --features audio --example live -- cloth.htex vinyl.htex`
//!
//! Right and left: faster and slower. Up and down: more and less force. Space: lift the finger, or
//! put it down. Tab: fade to the next texture. Q: quit. `--wav FILE` writes a stroke of four
//! seconds over all textures to a file. It needs neither a sound card nor the feature `audio`.

mod player;
#[cfg(feature = "audio")]
mod speaker;

use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match &arguments[..] {
        [flag, file, textures @ ..] if flag == "--wav" && !textures.is_empty() => {
            player::write_wav(file.as_ref(), textures)
        }
        textures @ [_, ..] => play(textures),
        [] => Err("give textures: live [--wav FILE.wav] TEXTURE.htex ...".into()),
    }
}

#[cfg(feature = "audio")]
fn play(textures: &[String]) -> Result<(), Box<dyn Error>> {
    speaker::play(textures)
}

#[cfg(not(feature = "audio"))]
fn play(_: &[String]) -> Result<(), Box<dyn Error>> {
    Err("built without sound: add `--features audio`, or give --wav FILE.wav".into())
}
