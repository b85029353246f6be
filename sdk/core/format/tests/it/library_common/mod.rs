//! Textures and libraries for tests.

pub mod cases;
mod edges;
pub mod raw;

use htex_format::library::{
    CoarseSpectrum, Description, Library, LibraryMetadata, MemoryWriter, PackSummary, Writer,
};
use htex_format::{Asset, Manifest, Plugin};
use serde_json::json;

/// A small texture.
#[derive(Debug, Clone)]
pub struct Texture {
    pub name: String,
    pub tags: Vec<String>,
    /// Speeds of its conditions, mm/s; the force is 0.5 N.
    pub speeds_mm_s: Vec<f64>,
    pub modules: Vec<Vec<u8>>,
}

pub fn texture(name: &str) -> Texture {
    Texture {
        name: name.to_owned(),
        tags: vec!["textile".to_owned(), "rough".to_owned()],
        speeds_mm_s: vec![80.0],
        modules: Vec::new(),
    }
}

/// Bytes that start like a module and cannot be compressed.
pub fn module(seed: u64, length: usize) -> Vec<u8> {
    let mut bytes = b"\0asm\x01\0\0\0".to_vec();
    let mut state = seed | 1;
    bytes.extend((0..length).map(|_| {
        // xorshift64 (Marsaglia 2003).
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 32) as u8
    }));
    bytes
}

impl Texture {
    /// The bytes of its `.htex` file.
    pub fn bytes(&self) -> Vec<u8> {
        let conditions = self.speeds_mm_s.iter();
        let conditions: Vec<_> =
            conditions.map(|speed| json!({ "speed_mm_s": speed, "force_n": 0.5 })).collect();
        let at: Vec<_> =
            (0..conditions.len()).map(|i| json!({ "condition": i, "level_rms": 0.02 })).collect();
        let manifest: Manifest = serde_json::from_value(json!({
            "htex": "1.0",
            "name": self.name,
            "license": "CC0-1.0",
            "tags": self.tags,
            "quantity": "lateral_force",
            "unit": "N",
            "band": { "low_hz": 20, "high_hz": 1000 },
            "conditions": conditions,
            "representations": [{
                "model": "org.htex.sbeta",
                "model_version": "1.0.0",
                "fields": [{ "name": "alpha", "store": "f32" }, { "name": "beta", "store": "f32" }],
                "at": at,
                "parameters": "parameters/sbeta.bin",
            }],
        }))
        .unwrap();
        let shape = self.name.len() as f64 / 64.0;
        let mut asset = Asset {
            manifest,
            parameters: vec![vec![vec![1.5 + shape, 4.0]; self.speeds_mm_s.len()]],
            reference: None,
            plugins: self.modules.clone(),
            notes: Vec::new(),
        };
        let plugins = self.modules.iter().enumerate();
        asset.manifest.plugins = plugins
            .map(|(i, module)| Plugin::new(&format!("org.example.model{i}"), "1.0.0", module))
            .collect();
        asset.to_bytes().unwrap()
    }
}

/// Packs textures in the given order. Returns what was written, and the file.
pub fn pack(name: &str, textures: &[Texture]) -> (PackSummary, Vec<u8>) {
    let all = textures.iter().map(|texture| (texture.name.clone(), texture.bytes()));
    let all: Vec<_> = all.collect();
    pack_bytes(name, all.iter().map(|(name, bytes)| (name, bytes)))
}

/// A description that depends only on the texture's name.
pub fn described(asset: &Asset) -> Description {
    let hertz: Vec<f64> = (4..=200).map(|i| 5.0 * f64::from(i)).collect();
    let power = asset.manifest.name.len() as f64 / 8.0;
    let magnitude: Vec<f64> = hertz.iter().map(|f| 0.02 / (f / 20.0).powf(power)).collect();
    Description {
        // One texture has no spectrum.
        spectrum: CoarseSpectrum::new(&hertz, &magnitude).filter(|_| asset.manifest.name != "felt"),
        felt_error_rms_db: Some(power).filter(|_| !asset.manifest.tags.is_empty()),
        held_out_error_db: Some(2.0 * power).filter(|_| asset.manifest.name != "felt"),
    }
}

/// A library of four textures, with descriptions and metadata.
pub fn four_described() -> Vec<u8> {
    let mut writer = MemoryWriter::new("Described").unwrap();
    writer.describe_with(described);
    writer.set_metadata(LibraryMetadata {
        version: Some("1.2".to_owned()),
        description: Some("Four textures\nand what they are like".to_owned()),
        authors: vec!["Ann".to_owned(), "Bo".to_owned()],
        date: Some("2026-11-29".to_owned()),
        ..LibraryMetadata::default()
    });
    for texture in cases::four() {
        writer.add(&texture.name, &texture.bytes()).unwrap();
    }
    writer.finish().unwrap().1
}

/// Packs assets under their names.
pub fn pack_bytes<'a>(
    name: &str,
    textures: impl IntoIterator<Item = (&'a String, &'a Vec<u8>)>,
) -> (PackSummary, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("packed.htexlib");
    let mut writer = Writer::create(&path, name).unwrap();
    for (name, bytes) in textures {
        writer.add(name, bytes).unwrap();
    }
    let packed = writer.finish().unwrap();
    (packed, std::fs::read(path).unwrap())
}

/// Opens a library and reads all of it.
pub fn all(file: &[u8]) -> Vec<(String, Vec<u8>)> {
    let library = Library::open_source(file).unwrap();
    let entries = library.entries().map(|entry| {
        let entry = entry.unwrap();
        let bytes = library.read(&entry).unwrap();
        (entry.name, bytes)
    });
    entries.collect()
}
