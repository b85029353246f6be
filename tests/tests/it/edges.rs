//! Runs the fuzz targets on all inputs that differ from their seeds in an extreme value, cell or
//! byte. The fuzzer covers modules and signatures, because running one takes too long. A test takes
//! a sample of the inputs, `cargo xtask prove edges` takes all.

use std::path::Path;

use htex_fuzzing::{edges, run};
use htex_tests::workspace;

/// Calls the function with each input made of a document.
type Edges = fn(&[u8], &mut dyn FnMut(&[u8]));

/// A sample takes every input with an index divisible by this number. No kind of input has a
/// multiple of it per place, so that the sample does not always hit the same kind.
const EACH: u64 = 11;

/// Runs the target on the inputs made of its seeds.
fn all_edges(target: &str, edges: Edges) {
    let (mut made, mut runs, mut taken) = (0u64, 0u64, 0u64);
    let each = if xtask::prove::whole() { 1 } else { EACH };
    let mut seeds: Vec<_> = std::fs::read_dir(workspace().join("fuzz/seeds").join(target))
        .unwrap()
        .map(|file| file.unwrap().path())
        .collect();
    seeds.sort();
    for seed in seeds {
        edges(&std::fs::read(&seed).unwrap(), &mut |input| {
            made += 1;
            if made % each != 0 {
                return;
            }
            runs += 1;
            match std::panic::catch_unwind(|| run(target, input)) {
                Ok(used) => taken += u64::from(used),
                Err(_) => panic!("see above; {}", kept(target, input)),
            }
        });
    }
    println!("{target}: {runs} of {made} inputs, {taken} taken");
    assert!(taken > 0 && taken < runs, "{target}: {taken} of {runs}");
}

/// Stores the input of a failure, and prints how to add it to the regressions.
fn kept(target: &str, input: &[u8]) -> String {
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("edge-of-{target}"));
    std::fs::write(&file, input).unwrap();
    format!(
        "cp {} tests/regressions/{target}/NAME, with a NAME that says what was wrong",
        file.display()
    )
}

/// A test for each target.
macro_rules! edges {
    ($($name:ident: $target:literal, $edges:path;)*) => {$(
        #[test]
        fn $name() {
            all_edges($target, $edges);
        }
    )*};
}

edges! {
    every_value_of_a_manifest: "manifest", edges::json;
    every_value_of_a_scene: "scene", edges::json;
    every_value_of_a_descriptor: "descriptor", edges::json;
    every_cell_of_a_recording: "csv", edges::table;
    every_cell_of_a_response: "response_csv", edges::table;
    every_byte_of_a_wav: "wav", edges::bytes;
    every_byte_of_an_npy: "npy", edges::bytes;
    every_byte_of_a_flac: "flac", edges::bytes;
    every_byte_of_a_mat: "mat", edges::bytes;
    every_byte_of_a_tdms: "tdms", edges::bytes;
    every_byte_of_a_parquet: "parquet", edges::bytes;
    every_byte_of_an_arrow: "arrow", edges::bytes;
    every_byte_of_an_hdf5: "hdf5", edges::bytes;
    every_byte_of_a_column_map: "column_map", edges::bytes;
    every_byte_of_a_parameter_block: "parameter_block", edges::bytes;
    every_byte_of_an_asset: "open_asset", edges::bytes;
    every_byte_of_a_library: "library", edges::bytes;
    every_byte_of_a_part_of_a_take: "take_part", edges::bytes;
    every_byte_of_a_model_file: "hatt", edges::bytes;
    every_value_of_envelopes_of_meta: "haptic", edges::json;
    every_value_of_a_pattern_of_apple: "ahap", edges::json;
    every_value_of_bands_of_mpeg: "hjif", edges::json;
    every_byte_of_a_mesh: "gltf", edges::bytes;
}
