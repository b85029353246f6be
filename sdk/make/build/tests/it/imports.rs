//! Recipes for files of other haptic formats.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use htex_author::settings::{FitSettings, Metadata};
use htex_build::{Build, BuildError, BuildOptions, FileKind, Report, Status, TextureReport, check};
use htex_exchange::{Export, Format, Import, Physical, export, import};
use htex_format::{Asset, Quantity};
use htex_host::Registry;

const PROGRAM: &str = "htex-build tests";

/// Half a second of a hum that grows stronger.
const HAPTIC: &str = include_str!("../../../exchange/tests/hum.haptic");

/// A model file of the Penn Haptic Texture Toolkit with four nodes. The first two are silent.
fn hatt(material: &str) -> String {
    include_str!("../../../exchange/tests/felt.xml").replace("Felt", material)
}

const SIGNAL: &str = r#"
[[textures]]
recordings = "hum.haptic"
full_scale = 0.2
at = { speed_mm_s = 80, force_n = 0.4 }
models = ["bands"]
license = "CC0-1.0"
"#;

const MODEL_FILE: &str = r#"
[[textures]]
recordings = "felt.xml"
license = "CC-BY-4.0"
"#;

struct Place(tempfile::TempDir);

impl Place {
    /// Creates a folder with a signal and a model file.
    fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        place.write("hum.haptic", HAPTIC);
        place.write("felt.xml", &hatt("Felt"));
        place
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.path().join(name), text).unwrap();
    }

    /// Opens the build of a recipe. `textures` is its text without the first table.
    fn open(&self, textures: &str) -> Result<Build, BuildError> {
        self.write("library.toml", &format!("library.name = 'others'\n{textures}"));
        let (recipe, output) = (self.0.path().join("library.toml"), self.0.path().join("out"));
        Build::open(&recipe, &output, BuildOptions::new(PROGRAM))
    }

    fn build(&self, textures: &str) -> Result<Report, BuildError> {
        let mut build = self.open(textures)?;
        build.check()?;
        build.run(&|_| ())?;
        build.finish()
    }

    fn refused(&self, textures: &str) -> String {
        self.build(textures).unwrap_err().to_string()
    }

    fn asset(&self, name: &str) -> Asset {
        let file = self.0.path().join(format!("out/textures/{name}.htex"));
        Asset::from_bytes(&fs::read(file).unwrap()).unwrap()
    }

    /// Returns the keys of the textures' jobs.
    fn keys(&self, textures: &str) -> BTreeMap<String, String> {
        let build = self.open(textures).unwrap();
        let jobs = build.pending();
        let keys = jobs.map(|(key, job)| (job.texture.clone(), key.to_owned()));
        keys.collect()
    }
}

fn texture<'a>(report: &'a Report, name: &str) -> &'a TextureReport {
    let mut textures = report.textures.iter();
    textures.find(|texture| texture.name == name).unwrap()
}

#[test]
fn files_of_other_formats_become_textures() {
    let place = Place::new();
    let report = place.build(&[SIGNAL, MODEL_FILE].concat()).unwrap();
    assert_eq!(report.library.textures, 2);

    // A model file is used unchanged: its conditions, its quantity, and a spectrum and a sound of
    // its strongest node.
    let felt = place.asset("felt");
    assert_eq!(
        (&felt.manifest.name[..], felt.manifest.license.as_deref()),
        ("felt", Some("CC-BY-4.0"))
    );
    let imported = htex_exchange::hatt::asset(
        &htex_exchange::hatt::read(hatt("Felt").as_bytes()).unwrap(),
        &htex_exchange::Naming::default(),
    )
    .unwrap();
    assert_eq!(felt.parameters, imported.parameters);
    assert_eq!(felt.manifest.conditions, imported.manifest.conditions);
    let stated = texture(&report, "felt").asset.as_ref().unwrap();
    assert_eq!((stated.conditions, stated.segments), (4, 0));
    assert!(stated.band_error_rms_db.is_empty() && stated.felt.is_empty());
    assert_eq!(stated.spectrum.0.iter().max(), Some(&63));
    let sound = fs::read(place.0.path().join("out/sounds/felt.wav")).unwrap();
    assert!(sound[44..].iter().any(|byte| *byte != 0));

    // The signal is fitted as `htex import` fits it.
    let hum = place.asset("hum");
    let how = Import {
        name: "hum",
        physical: Physical {
            full_scale: Some(0.2),
            speed_mm_s: Some(80.0),
            force_n: Some(0.4),
            ..Physical::default()
        },
        fit: FitSettings { models: Some(vec!["bands".to_owned()]), ..FitSettings::default() },
        metadata: Metadata { license: Some("CC0-1.0".to_owned()), ..Metadata::default() },
        tool: PROGRAM,
        ..Import::default()
    };
    let registry = Registry::builtin();
    let imported = import("hum.haptic", HAPTIC.as_bytes(), &how, &registry).unwrap();
    assert_eq!(hum.to_bytes().unwrap(), imported.asset.to_bytes().unwrap());
    let fitted = texture(&report, "hum").asset.as_ref().unwrap();
    assert_eq!(fitted.speed_mm_s, Some([80.0, 80.0]));
    assert!(fitted.felt.contains_key("org.htex.bands"));
}

/// Files of two more formats, made from a texture, become conditions of one texture.
#[test]
fn signals_of_one_name_are_conditions_of_a_texture() {
    let place = Place::new();
    place.build(SIGNAL).unwrap();
    let hum = htex_play::Texture::open(place.0.path().join("out/textures/hum.htex")).unwrap();
    for name in ["ahap", "hjif"] {
        let format = Format::find(name).unwrap();
        let exported = export(&hum, &Export::new(format)).unwrap();
        fs::write(place.0.path().join(format!("at.{name}")), exported.bytes).unwrap();
    }
    place.write("table.csv", "recording,speed_mm_s,force_n\nat.ahap,40,0.4\nat.hjif,120,0.4\n");
    let recipe = "[[textures]]\ntable = 'table.csv'\nfull_scale = 0.1\nquantity = 'acceleration'\nmodels = ['bands']\nlicense = 'MIT'";
    let report = place.build(recipe).unwrap();
    let at = texture(&report, "at");
    assert_eq!(at.status, Status::Built, "{:?}", at.missed);
    assert_eq!(at.asset.as_ref().unwrap().speed_mm_s, Some([40.0, 120.0]));
    let asset = place.asset("at");
    assert_eq!(asset.manifest.quantity, Quantity::Acceleration);
    let sources = &asset.manifest.provenance.recordings;
    let files: Vec<&str> = sources.iter().map(|source| &source.file[..]).collect();
    assert_eq!(files, ["at.ahap", "at.hjif"]);
    let bytes = fs::read(place.0.path().join("at.hjif")).unwrap();
    let hash = blake3::hash(&bytes).to_hex().to_string();
    assert_eq!(sources[1].blake3.as_deref(), Some(&hash[..]));
}

#[test]
fn a_key_depends_on_what_an_import_depends_on() {
    let place = Place::new();
    let both = [SIGNAL, MODEL_FILE].concat();
    let keys = place.keys(&both);
    assert_eq!(keys.len(), 2);
    let same = [
        ("license = \"CC0-1.0\"", "license = \"MIT\""),
        ("license = \"CC-BY-4.0\"", "author = 'me'\ngates.license = false"),
    ];
    for (before, after) in same {
        assert_eq!(place.keys(&both.replace(before, after)), keys, "{after}");
    }
    let other = [
        ("full_scale = 0.2", "full_scale = 0.3"),
        ("full_scale = 0.2", "full_scale = 0.2\nprofile = 'android'"),
        ("full_scale = 0.2", "full_scale = 0.2\nquantity = 'acceleration'"),
        ("full_scale = 0.2", "full_scale = 0.2\nlevel = 'fitted'"),
        ("speed_mm_s = 80", "speed_mm_s = 90"),
        ("force_n = 0.4", "force_n = 0.5"),
        ("\"bands\"", "\"sbeta\""),
    ];
    for (before, after) in other {
        let changed = place.keys(&both.replace(before, after));
        assert_ne!(changed["hum"], keys["hum"], "{after}");
        assert_eq!(changed["felt"], keys["felt"], "{after}");
    }
    let law = format!("{both}contact = 'finger'\n");
    assert_ne!(place.keys(&law)["felt"], keys["felt"]);
    place.write("felt.xml", &hatt("Wool felt"));
    let changed = place.keys(&both);
    assert_ne!(changed["felt"], keys["felt"]);
    assert_eq!(changed["hum"], keys["hum"]);
}

#[test]
fn settings_of_other_files_are_refused_and_missing_ones_asked_for() {
    let place = Place::new();
    place.write("sine.csv", "a\n1\n");
    let signal = |before: &str, after: &str| SIGNAL.replace(before, after);
    let model_file = |added: &str| format!("{MODEL_FILE}{added}\n");
    let recording = |added: &str| format!("[[textures]]\nrecordings = 'sine.csv'\n{added}");
    let cases = [
        (signal("full_scale = 0.2", ""), "does not say how strong 1 is; give `full_scale`"),
        (
            signal("at = { speed_mm_s = 80, force_n = 0.4 }", ""),
            "does not say at which speed it is felt, at which force; give `at.speed_mm_s`, `at.force_n`",
        ),
        (signal("0.2", "-0.2"), "`full_scale` is -0.2; it is more than 0, at most 1e6"),
        (
            signal("speed_mm_s = 80", "speed_mm_s = 0"),
            "`at.speed_mm_s` is 0; it is more than 0 mm/s",
        ),
        (signal("0.2", "0.2\nprofile = 'walkman'"), "there is no profile `walkman`"),
        (signal("0.2", "0.2\nscale = 2"), "takes no `scale`"),
        (signal("0.2", "0.2\ngrid = 'auto'"), "takes no `grid`"),
        (signal("0.2", "0.2\ntracker = 'a.csv'"), "takes no `tracker`"),
        (
            model_file("full_scale = 1"),
            "felt.xml: Penn Haptic Texture Toolkit, XML takes no `full_scale`",
        ),
        (model_file("models = ['bands']"), "takes no `models`"),
        (model_file("options.ar.order = 6"), "takes no `options`"),
        (model_file("at = { speed_mm_s = 80 }"), "takes no `at.speed_mm_s`"),
        (model_file("gates.min_segments = 4"), "takes no `gates.min_segments`"),
        (model_file("gates.strict = true"), "takes no `gates.strict`"),
        (
            recording("full_scale = 1"),
            "`full_scale` is of haptic signals (.haptic, .ahap and .hjif), and sine.csv is a recording",
        ),
        (
            "[[textures]]\nrecordings = ['felt.xml', 'sine.csv']\nname = 'one'".to_owned(),
            "one: felt.xml is a file that states a texture and sine.csv is a recording; give them other names",
        ),
    ];
    for (textures, expected) in cases {
        let error = place.open(&textures).unwrap_err().to_string();
        assert!(error.contains(expected), "{textures}\n{error}");
    }
    place.write("wool.xml", &hatt("Wool"));
    let error = place.refused("[[textures]]\nrecordings = '*.xml'\nname = 'one'");
    assert!(error.contains("one: felt.xml and wool.xml state a texture each"), "{error}");
    // Both errors are also found without a build.
    let recipe = place.0.path().join("library.toml");
    let error = check(&recipe, &BuildOptions::new(PROGRAM)).unwrap_err();
    assert!(error.to_string().contains("state a texture each"), "{error}");
}

#[test]
fn a_licence_is_asked_for() {
    let place = Place::new();
    let without = SIGNAL.replace("license = \"CC0-1.0\"\n", "");
    let recipe = [&without, MODEL_FILE].concat();
    let report = place.build(&recipe).unwrap();
    assert_eq!((report.library.textures, report.library.left_out), (1, 1));
    let hum = texture(&report, "hum");
    assert_eq!((hum.status, &hum.missed[0].gate[..]), (Status::LeftOut, "license"));
    assert!(hum.missed[0].reason.contains("set `license`"));
    let report = place.build(&format!("{recipe}\n[defaults.gates]\nlicense = false")).unwrap();
    assert_eq!(report.library.textures, 2);
}

#[test]
fn a_damaged_file_is_named_with_its_place() {
    let place = Place::new();
    place.write("felt.xml", &hatt("Felt").replace("<value>0.5</value>", "<value>half</value>"));
    let error = place.refused(MODEL_FILE);
    assert!(error.starts_with("felt: felt.xml: line "), "{error}");
}

#[test]
fn a_job_of_an_import_is_data() {
    let place = Place::new();
    let build = place.open(&[SIGNAL, MODEL_FILE].concat()).unwrap();
    for (key, job) in build.pending() {
        let text = serde_json::to_string(job).unwrap();
        let read: htex_build::Job = serde_json::from_str(&text).unwrap();
        assert_eq!(read.key(), key);
        let kind = match Path::new(&job.recordings[0].name).extension() {
            Some(extension) if extension == "xml" => FileKind::Asset,
            _ => FileKind::Signal,
        };
        assert_eq!(read.kind, kind);
    }
}

/// A friction map becomes a texture unchanged once full scale, speed and force are given, and also
/// the distance between pixels if the file does not state it.
#[test]
fn a_map_becomes_a_texture() {
    const MAP: &str = "[[textures]]\nrecordings = 'row.png'\nlicense = 'CC0-1.0'\nfull_scale = 0.3\nat = { speed_mm_s = 80, force_n = 0.4 }\n";
    let place = Place::new();
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fuzz/seeds/png/row");
    let mut image = fs::read(seed).unwrap();
    fs::write(place.0.path().join("row.png"), &image).unwrap();
    place.build(MAP).unwrap();
    let pitch = |asset: &Asset| asset.parameters[0][0][1];
    let stated = pitch(&place.asset("row"));
    place.build(&format!("{MAP}pitch_mm = 0.5\n")).unwrap();
    assert_eq!(pitch(&place.asset("row")), 0.5);
    assert_ne!(stated, 0.5);

    // Remove the chunk: its length, name, 9 bytes and checksum.
    let name = image.windows(4).position(|part| part == b"pHYs").unwrap();
    image.drain(name - 4..name + 17);
    fs::write(place.0.path().join("row.png"), &image).unwrap();
    let error = place.refused(MAP);
    assert!(error.starts_with("row: "), "{error}");
    assert!(error.ends_with("how far apart its pixels are; give `pitch_mm`"), "{error}");
    let error = place.refused(&MAP.replace("full_scale = 0.3\n", ""));
    assert!(error.contains("how strong 1 is; give `full_scale`"), "{error}");
}
