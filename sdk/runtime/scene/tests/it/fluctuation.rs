//! The fluctuation of textures in scenes.

use crate::common;

use common::{constant, file, fluctuating, planned, rendered, scene, single};
use htex_play::Texture;
use htex_scene::file::{Effect, Switch};
use htex_scene::{Renderer, Scene};

const SECONDS: f64 = 60.0;

fn asked(asset: &Texture) -> Scene {
    let mut scene = scene(asset, constant(80.0, 0.4), SECONDS);
    scene.file.effects = [(Effect::Fluctuation, Switch::On)].into();
    scene
}

fn samples(scene: &Scene) -> Vec<f32> {
    rendered(&mut Renderer::new(scene, &planned(scene, &file())).unwrap())
}

fn mean_square(samples: &[f32]) -> f64 {
    samples.iter().map(|x| f64::from(*x) * f64::from(*x)).sum::<f64>() / samples.len() as f64
}

/// Over a minute, the mean square of the envelope has a standard deviation of about 6 %.
#[test]
fn the_mean_square_does_not_change_and_the_level_moves() {
    let (steady, fluctuates) = (samples(&asked(single())), samples(&asked(&fluctuating())));
    let change = mean_square(&fluctuates) / mean_square(&steady);
    assert!((change - 1.0).abs() < 0.2, "{change}");
    // The level of blocks of 20 ms.
    let spread = |samples: &[f32]| {
        let levels: Vec<f64> = samples.chunks(400).map(|b| 0.5 * mean_square(b).ln()).collect();
        let mean = levels.iter().sum::<f64>() / levels.len() as f64;
        (levels.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / levels.len() as f64).sqrt()
    };
    let [steady, fluctuates] = [spread(&steady), spread(&fluctuates)];
    // 4 and 3 dB are 0.58 together; blocks of 20 ms lose some of the fast part.
    let added = (fluctuates.powi(2) - steady.powi(2)).sqrt();
    assert!((0.45..0.65).contains(&added), "{steady} {fluctuates}");
}

#[test]
fn a_scene_that_does_not_ask_plays_the_stationary_texture() {
    let quiet = |asset: &Texture| scene(asset, constant(80.0, 0.4), 0.5);
    assert_eq!(samples(&quiet(single())), samples(&quiet(&fluctuating())));
    let plan = planned(&quiet(&fluctuating()), &file());
    let out = plan.left_out.iter().find(|out| out.name == "fluctuation").unwrap();
    assert_eq!(out.reason, "the scene does not switch it on");
}
