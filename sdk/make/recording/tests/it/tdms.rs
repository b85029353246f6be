//! TDMS files that LabVIEW writes and npTDMS does not: channels without values in a segment, and
//! attributes of types that no recording needs.

use std::path::Path;

use htex_recording::{ReadOptions, recording_from_bytes};

/// Bits of a segment's table of contents.
const METADATA: u32 = 1 << 1;
const NEW_OBJECTS: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;

/// The index of an object without values in its segment.
const NONE: u32 = u32::MAX;

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

/// The index of a channel of doubles.
fn doubles(count: u64) -> Vec<u8> {
    let head = [20_u32, 10, 1].map(u32::to_le_bytes).concat();
    [&head[..], &count.to_le_bytes()].concat()
}

fn object(path: &str, index: &[u8], attributes: &[Vec<u8>]) -> Vec<u8> {
    let count = (attributes.len() as u32).to_le_bytes();
    [&text(path)[..], index, &count, &attributes.concat()].concat()
}

fn attribute(name: &str, kind: u32, value: &[u8]) -> Vec<u8> {
    [&text(name)[..], &kind.to_le_bytes(), value].concat()
}

fn segment(contents: u32, objects: &[Vec<u8>], values: &[f64]) -> Vec<u8> {
    let metadata = [&(objects.len() as u32).to_le_bytes()[..], &objects.concat()].concat();
    let values: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
    let head = [contents | METADATA | RAW_DATA, 4713].map(u32::to_le_bytes).concat();
    let lengths = [metadata.len() + values.len(), metadata.len()];
    let lengths = lengths.map(|length| (length as u64).to_le_bytes()).concat();
    [&b"TDSm"[..], &head, &lengths, &metadata, &values].concat()
}

/// The values of the channel `fx_n`, sampled at 1 kHz.
fn lateral(segments: &[Vec<u8>]) -> Vec<f64> {
    let options = ReadOptions::default().with_map("lateral=fx_n".parse().ok());
    let read = recording_from_bytes(Path::new("a.tdms"), &segments.concat(), &options);
    let recording = read.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(recording.rate_hz, 1000.0);
    recording.axes[0].clone()
}

fn force(count: u64) -> Vec<u8> {
    let attributes = [
        attribute("phasor", 0x0010_000d, &[7; 16]),
        attribute("phasor32", 0x0008_000c, &[7; 8]),
        attribute("nothing", 0, &[]),
        attribute("wf_increment", 10, &0.001_f64.to_le_bytes()),
    ];
    object("/'Run'/'fx_n'", &doubles(count), &attributes)
}

#[test]
fn a_channel_without_values_in_a_later_segment_takes_none() {
    let both = [force(2), object("/'Run'/'spare'", &doubles(2), &[])];
    let first = segment(NEW_OBJECTS, &both, &[1.0, 2.0, -1.0, -2.0]);
    let without = [object("/'Run'/'spare'", &NONE.to_le_bytes(), &[])];
    let second = segment(0, &without, &[3.0, 4.0, 5.0, 6.0]);
    assert_eq!(lateral(&[first, second]), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn an_empty_channel_takes_no_part_in_interleaved_rows() {
    let objects = [
        force(3),
        object("/'Run'/'fz_n'", &doubles(3), &[]),
        object("/'Run'/'t'", &doubles(0), &[]),
    ];
    let values = [1.0, -1.0, 2.0, -2.0, 3.0, -3.0];
    let one = segment(NEW_OBJECTS | INTERLEAVED, &objects, &values);
    assert_eq!(lateral(&[one]), [1.0, 2.0, 3.0]);
}
