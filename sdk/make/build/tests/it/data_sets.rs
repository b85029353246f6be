//! Builds the recipes of `examples/data-sets` with generated data in the form of each data set.

use std::fs;
use std::path::{Path, PathBuf};

use htex_build::{Build, BuildError, BuildOptions, Report, Status};
use htex_format::{Asset, Contact, Quantity};

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/data-sets")
}

/// A folder with a data set and its recipe.
struct Set(tempfile::TempDir);

impl Set {
    fn new(name: &str) -> Self {
        let set = Self(tempfile::tempdir().unwrap());
        for file in fs::read_dir(examples().join(name)).unwrap() {
            let file = file.unwrap();
            fs::copy(file.path(), set.path(&file.file_name().to_string_lossy())).unwrap();
        }
        set
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    fn build(&self) -> Result<Report, BuildError> {
        let (recipe, output) = (self.path("library.toml"), self.path("dist"));
        let mut build = Build::open(&recipe, &output, BuildOptions::new("data sets"))?;
        build.check()?;
        build.run(&|_| ())?;
        build.finish()
    }

    /// Builds and checks that every texture is made.
    fn built(&self) -> Report {
        let report = self.build().unwrap();
        let missed: Vec<_> = report.textures.iter().map(|t| &t.missed).collect();
        assert_eq!(report.library.left_out, 0, "{missed:?}");
        report
    }

    /// Builds a recipe without a licence, which leaves everything out, and then with a licence.
    fn built_with_a_licence(&self) -> Report {
        let report = self.build().unwrap();
        assert_eq!(report.library.textures, 0);
        for texture in &report.textures {
            assert_eq!(texture.status, Status::LeftOut);
            let gates: Vec<&str> = texture.missed.iter().map(|m| &m.gate[..]).collect();
            assert_eq!(gates, ["license"], "{}", texture.name);
        }
        let recipe = fs::read_to_string(self.path("library.toml")).unwrap();
        let stated = recipe.replace("# license = \"…\"", "license = \"LicenseRef-mine\"");
        assert_ne!(recipe, stated);
        self.write("library.toml", stated);
        self.built()
    }

    fn asset(&self, name: &str) -> Asset {
        let file = self.path(&format!("dist/textures/{name}.htex"));
        Asset::from_bytes(&fs::read(file).unwrap()).unwrap()
    }
}

fn names(report: &Report) -> Vec<&str> {
    report.textures.iter().map(|t| &t.name[..]).collect()
}

/// Returns noise within ±1 with most of its power below a fifth of the sample rate.
fn noise(seed: u64, samples: usize) -> Vec<f64> {
    let (mut state, mut low) = (seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1, 0.0);
    let next = |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let white = (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
        low = 0.6 * low + 0.4 * white;
        low
    };
    (0..samples).map(next).collect()
}

#[test]
fn models_of_the_penn_toolkit() {
    let set = Set::new("hatt");
    let node = |number: usize, speed: f64, force: f64, variance: f64| {
        format!(
            "<model><modNum>{number}</modNum><ARcoeff><value>1</value><value>-0.9</value><value>0.5</value></ARcoeff>\
             <MAcoeff><value>1</value><value>0.3</value></MAcoeff><var>{variance}</var><gain>2.5</gain>\
             <speedMod>{speed}</speedMod><forceMod>{force}</forceMod></model>"
        )
    };
    for (material, variance) in [("ABS Plastic", 0.01), ("Leather 1 Back", 0.2)] {
        let nodes = [
            node(1, 0.0, 0.0, 0.0),
            node(2, 240.0, 0.0, 0.0),
            node(3, 0.0, 3.0, variance),
            node(4, 240.0, 3.0, variance),
        ];
        let text = format!(
            "<?xml version=\"1.0\"?>\n<modelSet texture=\"7\">\n<material>{material}</material>\n<AccelUnits>m/s^2</AccelUnits>\n\
             <SpeedUnits>mm/s</SpeedUnits>\n<ForceUnits>N</ForceUnits>\n<SampleRate>1000</SampleRate>\n<numMod>4</numMod>\n{}\n</modelSet>\n",
            nodes.concat()
        );
        set.write(&format!("XML/Models_{material}.xml"), text);
    }
    assert_eq!(names(&set.built()), ["ABS Plastic", "Leather 1 Back"]);
    let manifest = set.asset("Leather 1 Back").manifest;
    assert_eq!(manifest.license.as_deref(), Some("LicenseRef-HaTT"));
    assert_eq!(manifest.quantity, Quantity::Acceleration);
    assert_eq!(manifest.conditions.len(), 4);
    assert!(manifest.description.unwrap().starts_with("Leather 1 Back, of"));
}

/// Returns times whose steps differ by half, as in the data set, and accelerations in g with
/// gravity on Z.
fn cluster(seed: u64, gain: f64) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| noise(3 * seed + axis, 18_000));
    let mut text = "time,X,Y,Z\n".to_owned();
    for i in 0..x.len() {
        let uneven = [0.0, 4e-5, 1e-5][i % 3];
        let time = 0.001 + i as f64 / 6_000.0 + uneven;
        let (x, y, z) = (gain * x[i], gain * y[i], gain * z[i] - 0.96);
        text += &format!("{time},{x:.4},{y:.4},{z:.4}\n");
    }
    text
}

#[test]
fn accelerations_of_the_cluster_set() {
    let set = Set::new("cluster");
    let mut seed = 0;
    for (speed, gain) in [(20, 0.05), (60, 0.1)] {
        for force in [500, 1000] {
            for texture in [0, 117] {
                seed += 1;
                let name = format!("sensor_data/accel/{texture}_135_{speed}_{force}_0.csv");
                set.write(&name, cluster(seed, gain));
            }
        }
    }
    let report = set.built();
    assert_eq!(names(&report), ["0", "117"]);
    let asset = report.textures[0].asset.as_ref().unwrap();
    assert_eq!(asset.conditions, 4);
    assert_eq!((asset.speed_mm_s, asset.force_n), (Some([20.0, 60.0]), Some([0.5, 1.0])));
    let manifest = set.asset("117").manifest;
    assert_eq!((manifest.contact, manifest.quantity), (Contact::Finger, Quantity::Acceleration));
    assert_eq!(manifest.license.as_deref(), Some("CC-BY-4.0"));
    // 0.1 g of noise is about 1 m/s², of which a part lies in the band.
    let level = manifest.representations[0].at.iter().map(|at| at.level_rms).fold(0.0, f64::max);
    assert!((0.05..1.0).contains(&level), "{level}");
}

#[test]
fn movements_of_the_lmt_set() {
    let set = Set::new("lmt");
    for material in ["G1EpoxyRasterPlate", "G9PaperTile"] {
        for take in [1, 2] {
            let samples = noise(take + material.len() as u64, 49_999);
            let lines: Vec<String> = samples.iter().map(|x| format!("{x:.5}")).collect();
            for axis in ["X", "Y"] {
                let folder = "AccelScansComponents/Movement/Training";
                let name = format!("{folder}/{material}_Movement_{axis}_train{take}.txt");
                set.write(&name, lines.join("\n"));
            }
        }
    }
    let report = set.built_with_a_licence();
    assert_eq!(names(&report), ["EpoxyRasterPlate", "PaperTile"]);
    assert_eq!(report.textures[0].recordings.len(), 2);
    let manifest = set.asset("PaperTile").manifest;
    assert_eq!((manifest.contact, manifest.quantity), (Contact::Tool, Quantity::Acceleration));
    assert_eq!(manifest.conditions[0].speed_mm_s, None);
    assert!(manifest.description.unwrap().contains("group 9"));
}

#[test]
fn strokes_of_textsense() {
    let set = Set::new("textsense");
    let table = fs::read_to_string(set.path("textures.csv")).unwrap();
    let specification = hound::WavSpec {
        channels: 1,
        sample_rate: 10_000,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    for (row, line) in table.lines().skip(1).enumerate() {
        let file = set.path(line.split(',').next().unwrap());
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        let mut wav = hound::WavWriter::create(file, specification).unwrap();
        for x in noise(row as u64 + 1, 15_000) {
            wav.write_sample((x * 20_000.0) as i16).unwrap();
        }
        wav.finalize().unwrap();
    }
    let report = set.built_with_a_licence();
    assert_eq!(report.textures.len(), 20);
    for texture in &report.textures {
        let speed = texture.asset.as_ref().unwrap().speed_mm_s.unwrap()[0];
        let (name, stated) = texture.name.split_once('/').unwrap();
        assert!(name.starts_with("text") && stated == speed.to_string());
    }
    // With a force, each texture gets all of its speeds.
    let recipe = fs::read_to_string(set.path("library.toml")).unwrap();
    let at = "name = \"{texture}\"\nat = { force_n = 0.5 }";
    let recipe = recipe.replace("name = \"{texture}/{speed_mm_s}\"", at);
    set.write("library.toml", recipe);
    let report = set.built();
    assert_eq!(names(&report), ["text24", "text3", "text54", "text9"]);
    let asset = report.textures[0].asset.as_ref().unwrap();
    assert_eq!((asset.conditions, asset.speed_mm_s), (5, Some([20.0, 60.0])));
}

/// The template for SENS3 is completed with columns of forces and positions. An error for a missing
/// column names the existing ones.
#[test]
fn the_form_of_sens3() {
    let set = Set::new("sens3");
    let forces = noise(7, 20_000);
    let mut text = "time_s,force_x_n,force_y_n,force_z_n,position_x_mm,position_y_mm\n".to_owned();
    for (i, x) in forces.iter().enumerate() {
        let time = i as f64 / 5_000.0;
        let (fx, place) = (0.3 + 0.1 * x, 80.0 * time);
        text += &format!("{time},{fx:.5},0.01,0.8,{place:.4},0\n");
    }
    set.write("sliding/sandpaper.csv", &text);
    let report = set.built_with_a_licence();
    assert_eq!(names(&report), ["sandpaper"]);
    let asset = report.textures[0].asset.as_ref().unwrap();
    let near =
        |range: Option<[f64; 2]>, value: f64| (range.unwrap()[0] - value).abs() < 0.01 * value;
    assert!(near(asset.speed_mm_s, 80.0) && near(asset.force_n, 0.8), "{asset:?}");
    set.write("sliding/sandpaper.csv", text.replace("force_x_n", "Fx"));
    let error = set.build().unwrap_err().to_string();
    assert!(error.contains("force_x_n") && error.contains("Fx"), "{error}");
}

/// Every recipe of the folder can be read, has a section in the page, and names a licence or
/// requires one.
#[test]
fn each_recipe_is_described_and_asks_for_a_licence() {
    let page = fs::read_to_string(examples().join("README.md")).unwrap();
    let folders = fs::read_dir(examples()).unwrap().map(|entry| entry.unwrap().path());
    let folders: Vec<PathBuf> = folders.filter(|path| path.is_dir()).collect();
    assert_eq!(folders.len(), 5);
    for folder in folders {
        let recipe = htex_build::Recipe::open(&folder.join("library.toml")).unwrap();
        let name = folder.file_name().unwrap().to_string_lossy().into_owned();
        assert!(page.contains(&format!("({name}/library.toml)")), "{name}");
        for textures in recipe.textures {
            let settings = textures.settings;
            let is_asked = settings.gates.license == Some(true);
            assert_ne!(settings.metadata.license.is_some(), is_asked, "{name}");
            assert!(settings.metadata.source.is_some(), "{name}");
        }
    }
}
