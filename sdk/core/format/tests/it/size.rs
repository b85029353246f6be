//! Limits on the size of asset files.

use crate::common;

use common::{asset, bands, five, sbeta};

#[test]
fn two_numbers_take_a_kilobyte_and_six_models_four() {
    let two = asset(1, vec![sbeta(1)]);
    let all = asset(1, five(1).into_iter().chain([bands(1)]).collect());
    let bytes = [&two, &all].map(|a| a.to_bytes().expect("it is valid").len());
    println!("two numbers: {} bytes; six models: {} bytes", bytes[0], bytes[1]);
    assert!(bytes[0] <= 1024 && bytes[1] <= 4096);
    assert_eq!(two.payload_bytes(0), 8);
    assert_eq!(two.payload_bytes(1), 0);
    let payloads: Vec<usize> = (0..6).map(|i| all.payload_bytes(i)).collect();
    assert_eq!(payloads, [1 + 48 + 4, 1 + 40 + 2, 1 + 20 + 1 + 20 + 1, 8, 6, 1 + 7 + 2]);
}
