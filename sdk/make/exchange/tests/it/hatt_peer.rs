//! For model files like the toolkit's, SciPy computes the same magnitudes at the nodes.

use crate::common;

use std::path::Path;
use std::process::Command;

use common::{draw, file};
use htex_exchange::Naming;
use htex_exchange::hatt::{asset, read};
use htex_play::{Motion, Texture};

/// Magnitudes at each node from 20 to 490 Hz, as stated by the asset that is imported from a file.
fn stated(text: &str) -> Vec<Vec<f64>> {
    let grid: Vec<f64> = (4..=98).map(|bin| 5.0 * f64::from(bin)).collect();
    let texture = read(text.as_bytes()).unwrap();
    let made = asset(&texture, &Naming::default()).unwrap();
    let asset = Texture::from_bytes(&made.to_bytes().unwrap()).unwrap();
    let motions = texture.nodes.iter().map(|node| Motion::new(node.speed_mm_s, node.force_n));
    let arma = asset.representation("arma").unwrap();
    let of = |motion| arma.recorded_magnitude(Some(motion), &grid).unwrap();
    motions.map(of).collect()
}

#[test]
fn scipy_has_the_same_magnitudes_at_each_node() {
    let python = xtask::bench::python();
    if !xtask::needs::PEERS.met(python.is_some()) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let [xml, told] = ["texture.xml", "magnitudes.json"].map(|name| folder.path().join(name));
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../tests/peers/hatt.py");
    for (seed, poles, zeros) in [(1, 19, 17), (2, 20, 18), (3, 17, 15), (4, 8, 0), (5, 3, 5)] {
        let text = file(&draw(seed, poles, zeros));
        std::fs::write(&xml, &text).unwrap();
        std::fs::write(&told, serde_json::to_vec(&stated(&text)).unwrap()).unwrap();
        let mut compare = Command::new(python.as_ref().unwrap());
        let output = compare.arg(&script).arg("--told").args([&xml, &told]).output().unwrap();
        let said = [&output.stdout[..], &output.stderr].map(String::from_utf8_lossy).concat();
        println!("{poles} poles, {zeros} zeros: {said}");
        assert!(output.status.success(), "{poles} poles, {zeros} zeros: {said}");
    }
}
