//! The seeds of all targets, made by htex's own writers.

use std::f64::consts::PI;
use std::io::Cursor;

use htex_host::{LoadedModel, Registry};
use htex_model::Kind;

use crate::block;
use crate::container::container;
use crate::library::{self, Around};
use crate::module::model;
use crate::studies::{STUDY, answered};

/// A target, a file name, and the file's content.
pub type Seed = (&'static str, String, Vec<u8>);

/// All seeds.
///
/// # Panics
/// When a writer fails.
pub fn seeds() -> Vec<Seed> {
    let registry = Registry::builtin();
    let mut seeds = Vec::new();
    for (i, model) in registry.models().iter().enumerate() {
        let mut add = |target, bytes| seeds.push((target, model.short_name().to_owned(), bytes));
        let asset = asset(model);
        add("open_asset", asset.to_bytes().expect("a sound asset"));
        let block = block_of(&asset);
        add("parameter_block", [&[i as u8, 1], &block[..]].concat());
        let coded = asset.clone().coded();
        let of_coded = block_of(&coded);
        add("parameter_block", [&[i as u8, 1 | block::CODED], &of_coded[..]].concat());
        if let Some(of_coded) = seeds.last_mut() {
            of_coded.1 += "-coded";
        }
        let mut add = |target, bytes| seeds.push((target, model.short_name().to_owned(), bytes));
        let json = serde_json::to_vec(&asset.manifest).expect("a manifest is JSON");
        add("open_asset", container(&json, [("parameters.bin", &block[..])]));
        if let Some(stored) = seeds.last_mut() {
            stored.1 += "-stored";
        }
        let json = serde_json::to_vec(model.descriptor()).expect("a descriptor is JSON");
        seeds.push(("descriptor", model.short_name().to_owned(), json));
    }
    seeds.extend(manifests());
    seeds.extend(texts());
    seeds.extend(samples());
    seeds.extend(lab_files());
    seeds.extend(modules());
    seeds.extend(words());
    seeds.extend(calls());
    seeds.extend(blocks());
    seeds.extend(libraries());
    seeds.extend(studies());
    seeds.extend(parts());
    seeds.extend(models_of_others());
    seeds.extend(signals_of_others());
    seeds.extend(meshes(&registry));
    seeds.extend(images(&registry));
    seeds
}

/// Model files of the Penn Haptic Texture Toolkit: one with four nodes and triangles, one of whose
/// nodes is silent, and one with a single node without zeros.
fn models_of_others() -> Vec<Seed> {
    let list = |name: &str, values: &[f64]| {
        let values: String = values.iter().map(|x| format!("<value>{x}</value>")).collect();
        format!("<{name}>{values}</{name}>")
    };
    let node = |i: usize, (speed, force): (f64, f64), variance: f64| {
        format!(
            "<model><modNum>{i}</modNum>{}{}{}<var>{variance}</var><gain>2.5</gain><speedMod>{speed}</speedMod><forceMod>{force}</forceMod></model>\n",
            list("ARcoeff", &[1.0, -0.9, 0.5]),
            list("ARlsf", &[0.644_033_9, 1.266_103_7]),
            list("MAcoeff", &[1.0, 0.3, -0.4, 0.2 * i as f64]),
        )
    };
    let corners = [(0.0, 0.0), (240.0, 0.0), (0.0, 3.5), (240.0, 3.5)];
    let nodes: String = corners
        .iter()
        .enumerate()
        .map(|(i, motion)| node(i + 1, *motion, 0.01 * i as f64))
        .collect();
    let whole = format!(
        "<?xml version=\"1.0\"?>\n<modelSet texture=\"25\"><material>Felt &amp; Co</material><AccelUnits>m/s^2</AccelUnits><SampleRate>1000</SampleRate>\
         <mu>0.22</mu><numMod>4</numMod><numTri>2</numTri><maxSpeed>240</maxSpeed><maxForce>3.5</maxForce>\n{}{}<numARCoeff>2</numARCoeff>\n{nodes}</modelSet>",
        list("tri", &[1.0, 2.0, 3.0]),
        list("tri", &[2.0, 4.0, 3.0]),
    );
    let one = "<modelSet><SampleRate>1000</SampleRate><model><ARcoeff><value>1</value><value>-0.5</value></ARcoeff><var>1</var>\
               <speedMod>80</speedMod><forceMod>1</forceMod></model></modelSet>";
    let seed = |name: &str, text: &str| ("hatt", name.to_owned(), text.as_bytes().to_vec());
    vec![seed("four-nodes", &whole), seed("one-node", one)]
}

/// Files from Meta, Apple and MPEG: envelopes and transients in the form htex writes, and forms
/// that it only reads.
fn signals_of_others() -> Vec<Seed> {
    let profile = &htex_exchange::PROFILES[0];
    let point = |time_s, value| htex_exchange::Point { time_s, value };
    let pattern = htex_exchange::Pattern {
        from_s: 0.0,
        to_s: 0.2,
        level: vec![point(0.0, 0.2), point(0.1, 1.0), point(0.2, 0.5)],
        exponent: 1,
        frequency_hz: vec![point(0.0, 80.0), point(0.2, 120.0)],
        transients: vec![htex_exchange::Transient {
            time_s: 0.1,
            amplitude: 1.0,
            frequency_hz: 150.0,
        }],
    };
    let haptic =
        htex_exchange::Haptic::from_pattern(&pattern, profile, Default::default()).to_bytes();
    let ahap = htex_exchange::Ahap::from_pattern(&pattern, profile).to_bytes();
    let controls = br#"{"Version": 1.0, "Metadata": {"Project": "seed"}, "Pattern": [
        {"Event": {"Time": 0.0, "EventType": "HapticContinuous", "EventDuration": 0.3, "EventParameters": [
            {"ParameterID": "HapticIntensity", "ParameterValue": 0.8}, {"ParameterID": "AttackTime", "ParameterValue": 0.1}]}},
        {"Event": {"Time": 0.1, "EventType": "AudioCustom", "EventParameters": []}},
        {"Parameter": {"ParameterID": "HapticSharpnessControl", "ParameterValue": -0.5, "Time": 0.1}}]}"#;
    let way = br#"{"version": "2023", "profile": "Main", "level": 1, "date": "1970-01-01", "description": "seed", "timescale": 10000,
        "avatars": [], "syncs": [], "perceptions": [{"id": 0, "avatar_id": 0, "description": "", "unit_exponent": -3,
        "perception_modality": "Vibrotactile Texture", "reference_devices": [{"id": 1, "name": "coil", "minimum_frequency": 20,
        "resonance_frequency": 60, "maximum_frequency": 300}], "effect_library": [], "channels": [{"id": 0, "description": "",
        "reference_device_id": 1, "gain": 1, "mixing_coefficient": 1, "body_part_mask": 0, "bands": [{"band_type": "WaveletWave",
        "block_length": 8, "lower_frequency_limit": 0, "upper_frequency_limit": 2500, "effects": [{"effect_type": "Basis", "position": 0,
        "phase": 0, "base_signal": "Sine", "keyframes": [{"relative_position": 0, "amplitude_modulation": 1},
        {"amplitude_modulation": -0.5}, {"amplitude_modulation": 0.2}, {"amplitude_modulation": 0}, {"amplitude_modulation": 0.1},
        {"amplitude_modulation": 0}, {"amplitude_modulation": 0}, {"amplitude_modulation": -0.3}, {"amplitude_modulation": 0.8}]}]}]}]}]}"#;
    let bands = br#"{"perceptions": [{"id": 0, "perception_modality": "Vibrotactile", "effect_library": [
        {"effect_type": "Basis", "id": 3, "position": 0, "keyframes": [{"relative_position": 0, "amplitude_modulation": 0.5,
            "frequency_modulation": 90}, {"relative_position": 50, "amplitude_modulation": 0}]}], "tracks": [{"id": 0, "bands": [
        {"band_type": "VectorialWave", "lower_frequency_limit": 0, "upper_frequency_limit": 300, "effects": [
            {"effect_type": "Reference", "id": 3, "position": 10}, {"effect_type": "Reference", "id": 3, "position": 80}]},
        {"band_type": "Curve", "curve_type": "Akima", "lower_frequency_limit": 0, "upper_frequency_limit": 60, "effects": [
            {"position": 0, "keyframes": [{"relative_position": 0, "amplitude_modulation": 0.1},
            {"relative_position": 90, "amplitude_modulation": -0.1}]}]},
        {"band_type": "Transient", "lower_frequency_limit": 0, "upper_frequency_limit": 300, "effects": [
            {"position": 40, "base_signal": "Square", "keyframes": [{"relative_position": 5, "amplitude_modulation": 1}]}]}]}]}]}"#;
    let seed = |target, name: &str, bytes: Vec<u8>| (target, name.to_owned(), bytes);
    vec![
        seed("haptic", "emphasis", haptic),
        seed("ahap", "curves", ahap),
        seed("ahap", "controls", controls.to_vec()),
        seed("hjif", "way", way.to_vec()),
        seed("hjif", "bands", bands.to_vec()),
    ]
}

/// Meshes whose material carries an asset of the first model: as a container, and as text with its
/// buffer.
fn meshes(registry: &Registry) -> Vec<Seed> {
    let model = registry.models().first().expect("a built-in model");
    let bytes = asset(model).to_bytes().expect("a sound asset");
    let opened = htex::Texture::from_bytes(&bytes).expect("what was written opens");
    let format = htex_exchange::Format::find("gltf").expect("it is in the table");
    let mesh = |extension| {
        let mut how = htex_exchange::Export::new(format);
        how.extension = Some(extension);
        how.file = Some(&bytes);
        let made = htex_exchange::export(&opened, &how).expect("an asset is exported");
        ("gltf", extension.to_owned(), made.bytes)
    };
    ["glb", "gltf"].map(mesh).to_vec()
}

/// An image of one row of a texture.
fn images(registry: &Registry) -> Vec<Seed> {
    let model = registry.find("sslope").expect("a built-in model");
    let bytes = asset(model).to_bytes().expect("a sound asset");
    let opened = htex::Texture::from_bytes(&bytes).expect("what was written opens");
    let format = htex_exchange::Format::find("png").expect("it is in the table");
    let mut how = htex_exchange::Export::new(format);
    how.path = htex_exchange::Path::Condition(Some(htex::Motion::new(80.0, 0.4)));
    let made = htex_exchange::export(&opened, &how).expect("a texture is exported");
    vec![("png", "row".to_owned(), made.bytes)]
}

/// Part files of takes, as files and in the form from which the target builds them: a second of a
/// finger with rows from a tracker.
fn parts() -> Vec<Seed> {
    let header = |format: &str| {
        format!(
            r#"{{"htex_take":1,"name":"seed","number":1,"tool":"htex","source":"file:a","map":null,"calibrations":[],"quantity":"lateral_force","rate_hz":200.0,"seconds":0.5,"signals":[["lateral","N"],["normal","N"]],"tare":[],"tracker":[["x","mm"]],"target_speed_mm_s":80.0,"target_force_n":0.4,"tolerance":0.1,"required":{{"on_target":0.5,"sweeps":1}},"format":"{format}"}}"#
        )
    };
    let row = |i: i32| [0.1 + 0.05 * (0.3 * f64::from(i)).sin(), 0.4];
    let frames: Vec<f64> = (0..120).flat_map(row).collect();
    let rows: Vec<f64> = (0..30).flat_map(|i| [0.02 * f64::from(i), 1.6 * f64::from(i)]).collect();
    let chunks = [(b'F', &frames), (b'T', &rows)];
    let pieces = chunks.map(|(kind, values)| {
        let values = values.iter().flat_map(|value| value.to_le_bytes());
        [&[kind, values.clone().count() as u8 / 8][..], &values.collect::<Vec<u8>>()].concat()
    });
    let built = |format: &str| [b"B", header(format).as_bytes(), b"\n", &pieces.concat()].concat();
    let mut seeds: Vec<Seed> = ["csv", "npy", "wav"]
        .map(|format| ("take_part", format!("built-{format}"), built(format)))
        .to_vec();
    let whole = crate::take::built(&built("csv")[1..]);
    seeds.push(("take_part", "whole".to_owned(), whole));
    seeds
}

/// A study, answers of its first participant, a recipe, and choices of a grammar.
fn studies() -> Vec<Seed> {
    let recipe = "[library]\nname = 'vinyls'\n[[textures]]\nrecordings = 'rec/*.csv'\nmodels = ['bands', 'sbeta']\n";
    let tabulated = recipe.replace("recordings = 'rec/*.csv'", "table = 'table.csv'");
    [
        ("study", "two", STUDY.to_owned()),
        ("answers", "begun", answered()),
        ("recipe", "vinyls", recipe.to_owned()),
        // Choices of the grammar: the beginnings of valid texts, and a bracket that is opened
        // repeatedly.
        ("toml_text", "recipe", "\0\0\x04".to_owned()),
        ("toml_text", "study", "\x01".to_owned()),
        ("toml_text", "calibration", "\x02".to_owned()),
        ("toml_text", "unclosed", "\x03\x05\x13\x06\x0d".to_owned()),
        ("recipe_folder", "vinyls", recipe.to_owned()),
        (
            "recipe_folder",
            "table",
            format!("{tabulated}\0recording,name\nrec/a.csv,one\nrec/../rec/a.csv,two\n"),
        ),
        ("recipe_folder", "server", recipe.replace("rec/*.csv", "http://localhost:PORT/a.csv")),
    ]
    .map(|(target, name, text)| (target, name.to_owned(), text.into_bytes()))
    .to_vec()
}

/// A library as a file and in parts: a leaf page with two textures that share an object, and a root
/// page.
fn libraries() -> Vec<Seed> {
    let vinyl = include_bytes!("../../../examples/scenes/vinyl.htex");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("seed.htexlib");
    let mut writer =
        htex_format::library::Writer::create(&path, "Seed").expect("it can be written");
    for name in ["vinyl", "vinyl/again"] {
        writer.add(name, vinyl).expect("an example");
    }
    writer.finish().expect("it can be written");
    let file = std::fs::read(path).expect("it was written");
    let root = |minor| {
        let pages = library::leaves(minor).map(|leaf| leaf.len() as u8);
        [&b"\x04Seed\x02\x00\x00\x00\x01b"[..], &pages].concat()
    };
    let spectra = library::spectra();
    let described = [
        &root(1)[..],
        &[27],
        br#"{"date":"2026-11-29","x":1}"#,
        &spectra.each_ref().map(|page| page.len() as u8),
        blake3::hash(&spectra.concat()).as_bytes(),
    ]
    .concat();
    [
        ("file", Around::File.input(&file, 0)),
        ("header", Around::Header.input(&file, 0)),
        ("leaf", Around::Leaf.input(&leaf(vinyl), 0)),
        ("root", Around::Root.input(&root(0), 0)),
        ("described", Around::Root.input(&described, 1)),
    ]
    .map(|(name, input)| ("library", name.to_owned(), input))
    .to_vec()
}

/// Contents of a leaf page, shared objects and payload: an asset, and the same asset with a part of
/// it shared.
fn leaf(asset: &[u8]) -> Vec<u8> {
    let read = htex_format::Asset::from_bytes(asset).expect("an example");
    let models = read.manifest.representations.iter().map(|r| r.model.as_str());
    let models: Vec<&str> = models.collect();
    let mut words: Vec<&str> =
        read.manifest.tags.iter().map(String::as_str).chain(models.clone()).collect();
    words.sort_unstable();
    words.dedup();
    let index = |word: &str| words.iter().position(|w| *w == word).unwrap_or(0) as u8;
    let list = |chosen: &mut dyn Iterator<Item = &str>| {
        let chosen: Vec<u8> = chosen.map(index).collect();
        [&[chosen.len() as u8], &chosen[..]].concat()
    };
    let varint = |x: usize| vec![x as u8 | 0x80, (x >> 7) as u8];
    let texts = words.iter().flat_map(|w| [&[w.len() as u8], w.as_bytes()].concat());
    let tags = list(&mut read.manifest.tags.iter().map(String::as_str));
    let models = list(&mut models.into_iter());
    let condition = read.manifest.conditions[0];
    let known = [condition.speed_mm_s, condition.force_n].map(|x| x.unwrap_or(0.0).to_le_bytes());
    let condition = [&[15], &known.concat()[..]].concat();
    let (shared, own) = (asset[100..200].to_vec(), [&asset[..100], &asset[200..]].concat());
    let leaf = [
        vec![2, words.len() as u8],
        texts.collect(),
        b"\x00\x01a\x00\x01b".to_vec(),
        tags.repeat(2),
        models.repeat(2),
        condition.repeat(2),
        vec![0],
        varint(asset.len()),
        varint(own.len()),
        // No object, then one object of 100 bytes starting at 0, after 100 own bytes.
        vec![0, 1, 100, 0, 100],
        blake3::hash(asset).as_bytes().repeat(2),
    ]
    .concat();
    let lengths = [leaf.len(), shared.len()].map(|length| (length as u16).to_le_bytes());
    [lengths.concat(), leaf, shared, asset.to_vec(), own].concat()
}

/// Baked blocks of noise and of sinusoids, each after two motions of the grid.
fn blocks() -> Vec<Seed> {
    let vinyl = include_bytes!("../../../examples/scenes/vinyl.htex");
    let asset = htex::Texture::from_bytes(vinyl).expect("an example");
    let grid = htex_play::bake::Grid::new(vec![60.0, 80.0], vec![0.4]).expect("a sound grid");
    let seed = |model: &str| {
        let representation = asset.representation(model).expect("an example");
        let baked = htex_play::bake::bake(representation, &grid, 8_000.0, 1.0);
        let block = baked.expect("a texture that can be baked").bytes;
        let motions = [70.0f32, 0.4, 0.0, 0.0].map(f32::to_le_bytes).concat();
        let all = [&[1], &motions[..], &block].concat();
        ("baked_block", model.to_owned(), all)
    };
    ["sslope", "speak"].map(seed).to_vec()
}

/// Calls of libhtex: two voices render and are freed, the second one twice.
fn calls() -> Vec<Seed> {
    let unknown = [231, 0, 0, 0, 0, 0, 0, 0xf8, 0x7f];
    let motion = [&[80, 200, 40], &unknown[..], &unknown, &unknown].concat();
    let new: &[&[u8]] = &[&[0, 0], &motion, &[0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0]];
    let set: &[&[u8]] = &[&[1, 0], &motion];
    let render: &[&[u8]] = &[&[2, 64, 0, 1]];
    let free: &[&[u8]] = &[&[7, 0], &[7, 0], &[4, 0], &motion, &[100]];
    let all = [new, render, new, set, render, free].concat().concat();
    vec![("c_calls", "two-voices".to_owned(), all)]
}

/// Texts that control a terminal, and names of files and formats.
fn words() -> Vec<Seed> {
    let texts = [
        ("escape", "\u{1}x\u{1b}[2J\u{7}\r\nhtex: all is well"),
        ("marks", "\u{2}a\u{202e}b\u{200b}c\u{2028}d\u{feff}e\u{ad}f\u{e0041}"),
        ("harmless", "\u{3}Raue Oberfläche, 砂纸 'P 80' \\ \"x\""),
    ];
    let names = [
        ("usual", "\0swatches.scene.json\ncsv"),
        ("rehearsed", "\u{1}two.swatches.scene.json\nnpy"),
        ("hidden", "\0.../..scene.json\n../../x"),
        ("folder", "\u{1}a\\..\\b/..\nauto"),
    ];
    let seed = |target| {
        move |(name, text): &(&str, &str)| (target, (*name).to_owned(), text.as_bytes().to_vec())
    };
    let texts = texts.iter().map(seed("printed_text"));
    texts.chain(names.iter().map(seed("output_name"))).collect()
}

/// An asset with one model at two conditions. Each number lies in the middle of its range.
fn asset(model: &LoadedModel) -> htex_format::Asset {
    let mut flat = Vec::new();
    for field in &model.descriptor().fields {
        let middle = 0.5 * (field.min + field.max);
        match field.kind {
            Kind::Scalar => flat.push(middle),
            Kind::List { max_len } => {
                let length = max_len.min(3);
                flat.push(f64::from(length));
                flat.extend(
                    (0..length)
                        .map(|i| field.min + (field.max - field.min) * 0.1 * f64::from(i + 1)),
                );
            }
        }
    }
    let manifest = block::manifest(model, 2);
    let fields = &manifest.representations[0].fields;
    let rounded = htex_format::round_parameters(fields, &flat).expect("numbers in their ranges");
    htex_format::Asset {
        parameters: vec![vec![rounded; 2]],
        reference: None,
        plugins: Vec::new(),
        notes: Vec::new(),
        manifest,
    }
}

/// The block of a written asset. The stored entry is found by its size.
fn block_of(asset: &htex_format::Asset) -> Vec<u8> {
    let bytes = asset.to_bytes().expect("a sound asset");
    let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).expect("an archive");
    let mut file = zip.by_name("parameters.bin").expect("the block");
    let mut block = Vec::new();
    std::io::Read::read_to_end(&mut file, &mut block).expect("the block");
    block
}

/// Manifests of the example assets, of an asset with a reference, and of one with a plugin.
fn manifests() -> Vec<Seed> {
    const EXAMPLES: [(&str, &[u8]); 2] = [
        ("coarse-fabric", include_bytes!("../../../examples/scenes/coarse-fabric.htex")),
        ("vinyl", include_bytes!("../../../examples/scenes/vinyl.htex")),
    ];
    let mut seeds = Vec::new();
    for (name, bytes) in EXAMPLES {
        let asset = htex_format::Asset::from_bytes(bytes).expect("an example");
        let json = serde_json::to_vec(&asset.manifest).expect("a manifest is JSON");
        seeds.push(("manifest", name.to_owned(), json));
        seeds.push(("open_asset", name.to_owned(), bytes.to_vec()));
    }
    let registry = Registry::builtin();
    let mut all = block::manifest(&registry.models()[0], 4);
    all.reference = Some(htex_format::Reference { file: "reference.bin".to_owned() });
    all.extensions.insert("com.example.note/1".to_owned(), true.into());
    all.other.insert("later".to_owned(), 1.into());
    all.doi = Some("10.5281/zenodo.1234567".to_owned());
    for word in [&mut all.description, &mut all.source, &mut all.sensor, &mut all.finger] {
        *word = Some("words".to_owned());
    }
    seeds.push(("manifest", "all-keys".to_owned(), serde_json::to_vec(&all).expect("JSON")));
    all.plugins = vec![
        htex_format::Plugin::new(&all.representations[0].model, "1.0.0", b"\0asm\x01\0\0\0")
            .signed(&htex_format::signing::SecretKey::from_bytes(&[1; 32])),
    ];
    seeds.push(("manifest", "plugin".to_owned(), serde_json::to_vec(&all).expect("JSON")));
    seeds
}

/// CSVs and scenes.
fn texts() -> Vec<Seed> {
    let rows =
        |row: &dyn Fn(f64) -> String| -> String { (0..40).map(|i| row(f64::from(i))).collect() };
    let wave = |i: f64| 0.1 + 0.05 * (2.0 * PI * 0.3 * i).sin();
    let timed = "t_s,fx_n,fy_n,fz_n,speed_mm_s\n".to_owned()
        + &rows(&|i| format!("{},{:.4},{:.4},-0.4,80\n", i * 0.01, wave(i), wave(i + 5.0)));
    let placed = "t_s,fx_n,x_mm,y_mm\n".to_owned()
        + &rows(&|i| format!("{},{:.4},{},5\n", i * 0.01, wave(i), i * 0.8));
    let bare = "# simulated\nlateral;x_mm\r\n".to_owned()
        + &rows(&|i| format!("{:.4};{}\r\n", wave(i), i * 0.8));
    let trace = "t_s,x_mm,y_mm,force_n\n".to_owned()
        + &rows(&|i| format!("{},{},5,0.4\n", i * 0.01, i * 0.8));
    let response = "frequency_hz,magnitude,phase_rad\n20,1,0\n30,0.5,3\n40,2,-3\n1000,0,0.1\n";
    let two_columns = "frequency_hz,magnitude\n0,1e-3\n5e2,1\n";
    let mut seeds: Vec<Seed> = Vec::new();
    let mut add = |target, name: &str, text: &str| {
        seeds.push((target, name.to_owned(), text.as_bytes().to_vec()));
    };
    add("csv", "timed.csv", &timed);
    add("csv", "placed.csv", &placed);
    add("csv", "bare.csv", &bare);
    add("csv", "trace.csv", &trace);
    add("response_csv", "phase.csv", response);
    add("response_csv", "magnitude.csv", two_columns);
    add("scene", "constant", include_str!("../../../examples/scenes/constant.scene.json"));
    add("scene", "two-swatches", include_str!("../../../examples/scenes/two-swatches.scene.json"));
    add("scene", "live", include_str!("../../../examples/scenes/live.scene.json"));
    add("scene", "all-keys", SCENE);
    seeds
}

const SCENE: &str = r#"{"htex_scene":"1.0","surfaces":[{"asset":"vinyl.htex","region":{"x_mm":[0,50],
"y_mm":[0,50]},"layer":1,"gain":2,"representation":"ar"},{"asset":"coarse-fabric.htex"}],"motion":{
"constant":{"speed_mm_s":80,"force_n":0.4,"from_mm":[1,1],"direction_deg":45}},"device":{"adapter":
"file","settings":{"path":"o.wav"},"rate_hz":8000,"gain_db":-6,"response":"display.csv",
"response_depth_db":20},"duration_s":1,"seed":2,"budget":{"ns_per_sample":1e6,"max_error_db":90},
"effects":{"crossfade":"on","dither":"auto","limiter":"off"}}"#;

/// WAV files with each sample format, and NPY files.
fn samples() -> Vec<Seed> {
    let mut seeds = Vec::new();
    let wave = |i: u32| (f64::from(i) * 0.3).sin() * 0.2;
    for (bits, channels) in [(8, 1), (16, 2), (24, 3), (32, 1)] {
        let float = bits == 32;
        let spec = hound::WavSpec {
            channels,
            sample_rate: 200,
            bits_per_sample: bits,
            sample_format: if float {
                hound::SampleFormat::Float
            } else {
                hound::SampleFormat::Int
            },
        };
        let mut bytes = Cursor::new(Vec::new());
        let mut writer = hound::WavWriter::new(&mut bytes, spec).expect("a WAV");
        for i in 0..50 * u32::from(channels) {
            let full = 2f64.powi(i32::from(bits) - 1);
            if float {
                writer.write_sample(wave(i) as f32)
            } else {
                writer.write_sample((wave(i) * full) as i32)
            }
            .expect("memory takes all");
        }
        writer.finalize().expect("memory takes all");
        seeds.push(("wav", format!("{bits}-bit-{channels}.wav"), bytes.into_inner()));
    }
    let numbers: Vec<f64> = (0..600).map(wave).collect();
    let long: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let short = numbers.iter().map(|x| (x * 32_768.0) as i16);
    let short: Vec<u8> = short.flat_map(i16::to_le_bytes).collect();
    for (name, shape) in [("one.npy", "(600, )"), ("three.npy", "(200, 3, )")] {
        seeds.push(("npy", format!("f8-{name}"), npy("f8", shape, &long)));
        seeds.push(("npy", format!("i2-{name}"), npy("i2", shape, &short)));
    }
    seeds
}

/// Files written by SciPy, h5py, npTDMS, pyarrow and soundfile, and maps.
fn lab_files() -> Vec<Seed> {
    macro_rules! files {
        ($($target:literal: $name:literal;)*) => {
            vec![$((
                $target,
                $name.to_owned(),
                include_bytes!(concat!("../../../sdk/make/recording/tests/lab/", $name)).to_vec(),
            )),*]
        };
    }
    let mut seeds = files! {
        "flac": "pcm16.flac";
        "flac": "pcm24.flac";
        "mat": "plain.mat";
        "mat": "compressed.mat";
        "tdms": "segments.tdms";
        "tdms": "interleaved.tdms";
        "parquet": "snappy.parquet";
        "parquet": "gzip.parquet";
        "parquet": "lz4.parquet";
        "arrow": "lz4.feather";
        "arrow": "stream.arrows";
        "hdf5": "earliest.h5";
        "hdf5": "latest.h5";
        "hdf5": "version73.mat";
    };
    let rows = "\na,b,x-y\n1,2,3\n4,5,6\n";
    let maps = [
        ("sum", "lateral_x=a+b,lateral_y=-(a-b)/2*9.81e-3"),
        ("quoted", "lateral=\"x-y\":0.5,normal=#2,speed=80"),
    ];
    seeds.extend(
        maps.map(|(name, map)| {
            ("column_map", name.to_owned(), format!("{map}{rows}").into_bytes())
        }),
    );
    seeds
}

fn npy(kind: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
    let text = format!("{{'descr': '<{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    let start = b"\x93NUMPY\x01\x00\x76\x00";
    [start, format!("{text:<117}\n").as_bytes(), numbers].concat()
}

/// Modules, and the inputs from which `wasm_module` and `signed_plugin` generate their modules.
fn modules() -> Vec<Seed> {
    let sound = wat::parse_str(model::text("1.0.0", &[], "")).expect("a sound module");
    let varied: Vec<u8> = (0..=255u8).map(|i| i.wrapping_mul(37) ^ (i >> 3)).collect();
    let mut seeds: Vec<Seed> = vec![
        ("wasm_module", "sound.wasm".to_owned(), sound.clone()),
        ("wasm_module", "sound-bodies".to_owned(), vec![0]),
        // Nested conditions, and consecutive loops.
        ("compile_limits", "nested".to_owned(), vec![60, 30, 10, 0, 0, 1, 2, 0]),
        ("compile_limits", "loops".to_owned(), vec![80, 5, 60, 1, 1, 2, 1, 0, 0, 2, 4]),
        ("wasm_module", "made-bodies".to_owned(), varied),
        ("signed_plugin", "sound".to_owned(), vec![0, 0, 0, 7]),
        ("signed_plugin", "unsigned".to_owned(), vec![2, 0, 0, 7]),
        ("signed_plugin", "module".to_owned(), [&[0, 0, 0, 9], &sound[..]].concat()),
    ];
    // Changes of each part, and of the module with and without its hash.
    for part in 0..8u8 {
        let how = 1 | part.min(6) << 2 | (part / 7) << 7;
        seeds.push(("signed_plugin", format!("changed-{part}"), vec![how, 3, b'0' + part, 7]));
    }
    seeds
}
