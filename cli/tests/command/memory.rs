//! A long scene takes no more memory than a short one.

use crate::common::Place;
use crate::common::measured::run;
use serde_json::json;

const RATE_HZ: u64 = 8_000;
const MOST_MORE_KIB: i64 = 64 << 10;

#[test]
fn an_hour_takes_no_more_memory_than_a_second() {
    let place = Place::new();
    let asset = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes/vinyl.htex");
    place.write("vinyl.htex", std::fs::read(asset).unwrap());
    let surfaces = json!([{ "asset": "vinyl.htex", "representation": "speak" }]);
    let device = json!({ "adapter": "file", "rate_hz": RATE_HZ });
    place.scene("s.scene.json", "", &json!({ "surfaces": surfaces, "device": device }));
    let memory_kib = |seconds: u64| {
        let length = seconds.to_string();
        let mut render = place.command(&["render", "s.scene.json", "-o", "s.raw"]);
        let end = run(render.args(["--seconds", &length]), &place.path("errors"));
        assert_eq!(end.code, 0, "{}", end.error);
        let bytes = std::fs::metadata(place.path("s.raw")).unwrap().len();
        assert_eq!(bytes, 4 * RATE_HZ * seconds);
        end.memory_kib
    };
    let (second, hour) = (memory_kib(1), memory_kib(3_600));
    println!("1 s: {second} KiB, 1 h: {hour} KiB");
    assert!(hour <= second + MOST_MORE_KIB, "1 s: {second} KiB, 1 h: {hour} KiB");
}
