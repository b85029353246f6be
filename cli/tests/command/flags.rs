//! Extreme numbers for every numeric flag.

use crate::common::{Place, words};

const EDGES: &[&str] =
    &["0", "-1", "5e-324", "1e19", "1e300", "18446744073709551616", "nan", "-inf", "", "\u{1b}[2J"];

/// Commands with their numeric arguments: `@` stands for the number.
const FLAGS: &[(&str, &str)] = &[
    (
        "simulate --surface vinyl -o simulated.csv",
        "--seconds=@ --rate=@ --speed=@ --force=@ --seed=@",
    ),
    (
        "process rec.csv",
        "--rate=@ --speed=@ --force=@ --at=speed=@ --map=lateral=fx_n:@ --from=@ --to=@",
    ),
    (
        "fit rec.csv --license CC0-1.0 -o fitted.htex",
        "--rate=@ --speed=@ --force=@ \
         --option=ar.order=@ --option=ar.rate_hz=@ --option=mfcc.coefficients=@ \
         --option=mfcc.bands=@ --option=speak.count=@ --option=speak.jnd=@ --option=sbeta.points=@ \
         --option=sbeta.lower_bound=@ --option=sslope.rounding_db_per_decade=@ \
         --option=bands.bands=@ --option=bands.step_db=@",
    ),
    (
        "synth cloth.htex --seconds 0.1 -o cloth.wav",
        "--speed=@ --force=@ --rate=@ --seed=@ --quality=loop:@ --quality=filter:@",
    ),
    ("synth cloth.htex -o cloth.wav", "--seconds=@"),
    #[cfg(feature = "lab")]
    (
        "response rec.csv --input fx_n --output fy_n --continuous",
        "--rate=@ --from=@ --to=@ --window=@ --low=@ --high=@ --input-limit=@ --output-limit=@ --map=time=t_s:@",
    ),
    ("lib find cloth.htexlib", "--speed=@ --force=@"),
    (
        "bake cloth.htex -o cloth.bin",
        "--rate=@ --within=@ --at=speed=@,force=0.4 --grid=speed=@:80:2,force=0.4 --grid=speed=80,force=0.2:@:3 \
         --grid=speed=40:80:@,force=0.4",
    ),
    ("spectrum cloth.htex", "--speed=@ --force=@ --wasm-limit=memory-mib=@ --wasm-limit=fuel=@"),
    ("render scene.json -o scene.wav", "--seconds=@ --set=encoding=@"),
    ("import hum.haptic --model bands -o hum.htex", "--full-scale=@ --speed=@ --force=@"),
    (
        "import hum.haptic --model bands --speed 80 --force 0.4 -o hum.htex",
        "--full-scale=@ --option=bands.bands=@",
    ),
    (
        "export cloth.htex --to wav -o cloth.wav",
        "--speed=@ --force=@ --seconds=@ --rate=@ --seed=@",
    ),
    ("play cloth.htex --device file --set path=played.wav", "--seconds=@"),
];

#[test]
fn flags_at_edges_end_well_or_in_a_sentence() {
    let place = Place::new();
    let made = "simulate --surface vinyl --seconds 2 -o rec.csv";
    assert_eq!(place.run(&words(made)).code(), 0);
    let made = "fit rec.csv --license CC0-1.0 -o cloth.htex";
    assert_eq!(place.run(&words(made)).code(), 0);
    let made = "lib pack cloth.htexlib cloth.htex";
    assert_eq!(place.run(&words(made)).code(), 0);
    place.scene("scene.json", "cloth.htex", &serde_json::json!({ "duration_s": 0.1 }));
    let hum = r#"{"version": {"major": 1}, "signals": {"continuous": {"envelopes": {
        "amplitude": [{"time": 0, "amplitude": 0.5}, {"time": 1, "amplitude": 0.5}]}}}}"#;
    place.write("hum.haptic", hum);
    let (mut runs, mut refused) = (0, 0);
    for (command, flags) in FLAGS {
        for flag in flags.split_whitespace() {
            for edge in EDGES {
                let given = flag.replace('@', edge);
                let run = place.run(&[words(command), vec![&given]].concat());
                let (code, error) = (run.code(), run.error());
                assert!((0..=2).contains(&code), "{command} {given:?}: {code}: {error}");
                let steers = error.contains(|c: char| c.is_control() && c != '\n');
                assert!(!steers, "{command} {given:?}: {error:?}");
                assert!(code == 0 || error.contains("htex: ") || error.contains("error: "));
                runs += 1;
                refused += u32::from(code != 0);
            }
        }
    }
    println!("{runs} runs, {refused} refused");
    assert!(refused > runs / 2 && refused < runs);
}
