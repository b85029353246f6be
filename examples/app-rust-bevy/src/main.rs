//! Strokes an entity with a haptic texture, without a window, and prints the level of the samples.
//!
//! `cargo run -- FOLDER ASSET TICKS`, such as `cargo run -- ../scenes vinyl.htex 200`.

mod haptics;
#[cfg(test)]
mod tests;

use std::time::Duration;

use bevy_app::prelude::*;
use bevy_app::{ScheduleRunnerPlugin, TaskPoolPlugin};
use bevy_asset::{AssetLoadFailedEvent, AssetPlugin, AssetServer};
use bevy_ecs::prelude::*;

use haptics::{
    BLOCK, Block, HapticTexture, HapticsPlugin, Playing, RATE_HZ, Render, Slide, Surface,
};

/// Number of ticks over which the program measures the level: 0.4 s.
const MEASURED: usize = 40;

/// What the arguments ask for.
#[derive(Resource)]
struct Arguments {
    asset: String,
    ticks: usize,
}

fn main() -> AppExit {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let [folder, asset, ticks] = &given[..] else { return usage() };
    let Ok(ticks) = ticks.parse() else { return usage() };
    app(folder)
        .insert_resource(Arguments { asset: asset.clone(), ticks })
        .add_systems(Startup, spawn)
        .add_systems(Update, (stroke.before(Render), measure.after(Render), stop_on_failure))
        .run()
}

fn usage() -> AppExit {
    eprintln!("usage: app-rust-bevy FOLDER ASSET TICKS");
    AppExit::error()
}

/// An app without a window. A game has these plugins already, except the last one.
fn app(folder: &str) -> App {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        ScheduleRunnerPlugin::run_loop(Duration::ZERO),
        AssetPlugin { file_path: absolute(folder), ..Default::default() },
        HapticsPlugin,
    ));
    app
}

/// Bevy takes a relative path as relative to the project.
fn absolute(folder: &str) -> String {
    let path = std::path::absolute(folder).unwrap_or_else(|_| folder.into());
    path.to_string_lossy().into_owned()
}

fn spawn(mut commands: Commands, assets: Res<AssetServer>, arguments: Res<Arguments>) {
    commands.spawn(Surface(assets.load(arguments.asset.clone())));
}

/// Moves the finger back and forth, once a second, while the texture plays.
fn stroke(mut tick: Local<u32>, mut fingers: Query<&mut Slide, With<Playing>>) {
    for mut slide in &mut fingers {
        let phase = f64::from(*tick % 100) / 100.0;
        *slide = Slide { speed_mm_s: 240.0 * phase.min(1.0 - phase), force_n: 0.4 };
        *tick += 1;
    }
}

/// Prints the RMS every 0.4 s, and exits after the last tick.
fn measure(
    block: Res<Block>,
    playing: Query<(), With<Playing>>,
    arguments: Res<Arguments>,
    mut samples: Local<Vec<f32>>,
    mut exit: MessageWriter<AppExit>,
) {
    if playing.is_empty() {
        return;
    }
    samples.extend(block.0);
    let ticks = samples.len() / BLOCK;
    if ticks.is_multiple_of(MEASURED) {
        let last = &samples[(ticks - MEASURED) * BLOCK..];
        let power: f64 = last.iter().map(|&x| f64::from(x) * f64::from(x)).sum();
        let seconds = samples.len() as f64 / f64::from(RATE_HZ);
        println!("{seconds:.1} s: RMS {:.3}", (power / last.len() as f64).sqrt());
    }
    if ticks >= arguments.ticks {
        exit.write(AppExit::Success);
    }
}

fn stop_on_failure(
    mut failures: MessageReader<AssetLoadFailedEvent<HapticTexture>>,
    mut exit: MessageWriter<AppExit>,
) {
    for failure in failures.read() {
        eprintln!("{}: {}", failure.path, failure.error);
        exit.write(AppExit::error());
    }
}
