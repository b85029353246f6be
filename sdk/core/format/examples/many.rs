//! Packs many small textures. Measures what opening one texture needs: time, memory, number of
//! reads, and number of bytes.
//!
//! `cargo run --release -p htex-format --example many` packs 1,000, 100,000 and 1,000,000 textures.
//! Other numbers may be given as arguments. Each number of textures is measured in its own process,
//! so that the peak memory is measured separately.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::error::Error;
use std::io;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use htex_format::library::{Library, LibrarySource, LocalFile, Writer};
use htex_format::{Asset, Manifest};

const COUNTS: [u64; 3] = [1_000, 100_000, 1_000_000];
/// Number of textures to open, spread over the library. The measurement opens the library anew for
/// each texture.
const OPENED: u64 = 200;
/// Argument that tells a process to pack textures and to print the result.
const PACKS: &str = "--packs";

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.first().is_some_and(|first| first == PACKS) {
        return measure(arguments[1].parse()?);
    }
    let given = arguments.iter().map(|a| a.parse()).collect::<Result<Vec<u64>, _>>()?;
    println!(
        "textures   pack/s  peak/MiB  file/MB  index/MB  pages  reads  index bytes read  one texture/us  in an open library/us"
    );
    for count in if given.is_empty() { COUNTS.to_vec() } else { given } {
        let program = std::env::current_exe()?;
        let status = Command::new(program).args([PACKS, &count.to_string()]).status()?;
        if !status.success() {
            return Err("the packing failed".into());
        }
    }
    Ok(())
}

/// Packs `count` textures, opens some of them, and prints a line.
fn measure(count: u64) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("many.htexlib");
    let start = Instant::now();
    let mut writer = Writer::create(&path, "Many")?;
    let mut texture = template()?;
    let mut making = 0.0;
    for i in 0..count {
        let begun = Instant::now();
        let (name, bytes) = make(&mut texture, i)?;
        making += begun.elapsed().as_secs_f64();
        writer.add(&name, &bytes)?;
    }
    let packed = writer.finish()?;
    let seconds = start.elapsed().as_secs_f64() - making;
    let peak_mib = peak_mib();
    let opened = open_some(&path, count, &mut texture)?;
    println!(
        "{count:8} {seconds:8.2} {:>9} {:8.1} {:9.2} {:6} {:6} {:17} {:15.0} {:22.0}",
        peak_mib.map_or("?".to_owned(), |mib| mib.to_string()),
        packed.bytes as f64 / 1e6,
        packed.index_bytes as f64 / 1e6,
        opened.pages,
        opened.reads,
        opened.index_bytes,
        opened.alone_us,
        opened.next_us,
    );
    Ok(())
}

/// Cost of opening a texture.
struct Opened {
    pages: usize,
    /// Largest number of reads for one texture.
    reads: u64,
    /// Largest number of bytes read besides the texture itself.
    index_bytes: u64,
    /// Median time to open the library and one texture.
    alone_us: f64,
    /// Median time to open a texture when the library is already open.
    next_us: f64,
}

fn open_some(path: &Path, count: u64, texture: &mut Asset) -> Result<Opened, Box<dyn Error>> {
    let library = Library::open(path)?;
    let mut opened = Opened {
        pages: library.index().leaves(),
        reads: 0,
        index_bytes: 0,
        alone_us: 0.0,
        next_us: 0.0,
    };
    let (mut alone_us, mut next_us) = (Vec::new(), Vec::new());
    for k in 0..OPENED {
        let (name, bytes) = make(texture, k.wrapping_mul(0x9E37_79B9_7F4A_7C15) % count)?;
        let begun = Instant::now();
        let source = Counted::open(path)?;
        let read = Library::open_source(&source)?.get(&name)?;
        alone_us.push(begun.elapsed().as_secs_f64() * 1e6);
        assert_eq!(read, bytes, "{name}");
        let begun = Instant::now();
        library.get(&name)?;
        next_us.push(begun.elapsed().as_secs_f64() * 1e6);
        opened.reads = opened.reads.max(source.reads.load(Ordering::Relaxed));
        let others = source.bytes.load(Ordering::Relaxed) - bytes.len() as u64;
        opened.index_bytes = opened.index_bytes.max(others);
    }
    (opened.alone_us, opened.next_us) = (median(alone_us), median(next_us));
    Ok(opened)
}

fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

/// A file that counts reads and bytes.
struct Counted {
    file: LocalFile,
    reads: AtomicU64,
    bytes: AtomicU64,
}

impl Counted {
    fn open(path: &Path) -> Result<Self, Box<dyn Error>> {
        Ok(Self {
            file: LocalFile::open(path)?,
            reads: AtomicU64::new(0),
            bytes: AtomicU64::new(0),
        })
    }
}

impl LibrarySource for Counted {
    fn len(&self) -> io::Result<u64> {
        self.file.len()
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read_at(offset, buffer)?;
        self.reads.fetch_add(1, Ordering::Relaxed);
        self.bytes.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

fn template() -> Result<Asset, Box<dyn Error>> {
    let manifest: Manifest = serde_json::from_str(
        r#"{
            "htex": "1.0", "name": "x", "license": "CC0-1.0", "author": "example many",
            "quantity": "lateral_force", "unit": "N", "band": { "low_hz": 20, "high_hz": 1000 },
            "conditions": [{ "speed_mm_s": 80, "force_n": 0.4 }],
            "representations": [{
                "model": "org.htex.sbeta", "model_version": "1.0.0",
                "fields": [{ "name": "alpha", "store": "f32" }, { "name": "beta", "store": "f32" }],
                "at": [{ "condition": 0, "level_rms": 0.02 }],
                "parameters": "parameters/sbeta.bin"
            }]
        }"#,
    )?;
    Ok(Asset {
        manifest,
        parameters: vec![vec![vec![1.5, 4.0]]],
        reference: None,
        plugins: Vec::new(),
        notes: Vec::new(),
    })
}

/// Creates texture `i`: its name and the bytes of its file. Tags, conditions and parameters vary.
fn make(texture: &mut Asset, i: u64) -> Result<(String, Vec<u8>), Box<dyn Error>> {
    const KINDS: [&str; 8] =
        ["wood", "felt", "cotton", "paper", "leather", "vinyl", "stone", "steel"];
    const FEELS: [&str; 5] = ["rough", "smooth", "ribbed", "soft", "sticky"];
    let mixed = i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 20;
    let (kind, feel) = (KINDS[mixed as usize % 8], FEELS[(mixed >> 3) as usize % 5]);
    let manifest = &mut texture.manifest;
    manifest.name = format!("{feel} {kind} {i}");
    manifest.tags = vec![kind.to_owned(), feel.to_owned()];
    manifest.conditions[0].speed_mm_s = Some(20.0 + (mixed % 181) as f64);
    manifest.conditions[0].force_n = Some(0.1 + (mixed % 19) as f64 * 0.1);
    texture.parameters[0][0] =
        vec![1.0 + (mixed % 1000) as f64 / 500.0, 2.0 + (i % 977) as f64 / 300.0];
    Ok((format!("{kind}/{feel}/{mixed:011x}-{i}"), texture.to_bytes()?))
}

/// Returns the peak memory (RSS) of this process, MiB, or `None` if the system does not report it.
fn peak_mib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib >> 10)
}
