//! glTF files that carry an asset: round trips are bit for bit, and errors name their place.

use crate::textures;

use std::sync::LazyLock;

use htex_author::simulate::Surface;
use htex_base::schema::Schema;
use htex_exchange::gltf::{Material, material_schema, read};
use htex_exchange::{Export, Format, Import, MOST_BYTES, export, import};
use htex_play::{Registry, Texture};
use proptest::prelude::*;
use serde_json::{Value, json};
use textures::texture;

static ASSET: LazyLock<Texture> = LazyLock::new(|| texture(Surface::Vinyl));
/// The asset's file.
static FILE: LazyLock<Vec<u8>> = LazyLock::new(|| ASSET.data().to_bytes().unwrap());

fn written(extension: &str, file: &[u8]) -> Vec<u8> {
    let mut how = Export::new(Format::find("gltf").unwrap());
    how.extension = Some(extension);
    how.file = Some(file);
    export(&ASSET, &how).unwrap().bytes
}

/// A container written by the specification of glTF.
fn glb(chunks: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut made = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    for (kind, bytes) in chunks {
        made.extend((bytes.len() as u32).to_le_bytes());
        made.extend(*kind);
        made.extend(bytes);
    }
    let length = made.len() as u32;
    made[8..12].copy_from_slice(&length.to_le_bytes());
    made
}

/// The JSON and the bytes of a container, taken apart as its header says.
fn parts(file: &[u8]) -> (Value, Vec<u8>) {
    let number = |at: usize| u32::from_le_bytes(*file[at..].first_chunk().unwrap()) as usize;
    assert_eq!((&file[..4], number(4), number(8)), (&b"glTF"[..], 2, file.len()));
    let end = 20 + number(12);
    assert_eq!((&file[16..20], &file[end + 4..end + 8]), (&b"JSON"[..], &b"BIN\0"[..]));
    assert_eq!((end % 4, number(end) % 4, end + 8 + number(end)), (0, 0, file.len()));
    (serde_json::from_slice(&file[20..end]).unwrap(), file[end + 8..].to_vec())
}

fn with(json: &Value, bytes: Vec<u8>) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    glb(&[(b"JSON", text), (b"BIN\0", bytes)])
}

fn said(file: &[u8]) -> String {
    let read = import("a.glb", file, &Import::default(), &Registry::builtin());
    read.map_or_else(|error| error.to_string(), |_| "it is read".to_owned())
}

/// The message for a file with another value at a place in its JSON.
fn changed(pointer: &str, value: Value) -> String {
    let (mut json, bytes) = parts(&written("glb", &FILE));
    let (object, key) = pointer.rsplit_once('/').unwrap();
    match json.pointer_mut(object).unwrap() {
        Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
        object => object[key] = value,
    }
    said(&with(&json, bytes))
}

#[test]
fn the_asset_comes_back_bit_for_bit() {
    for (extension, file) in [("glb", &*FILE), ("gltf", &*FILE)] {
        let bytes = written(extension, file);
        let name = format!("a.{extension}");
        let imported = import(&name, &bytes, &Import::default(), &Registry::builtin()).unwrap();
        assert_eq!(imported.to_bytes().unwrap(), *file);
        let opened = htex_format::Asset::from_bytes(file).unwrap();
        assert_eq!(imported.asset, opened);
        assert!(imported.felt.is_empty() && imported.warnings.is_empty());
    }
}

/// The round trip also keeps a file that htex would write differently: its entries are not
/// compressed.
#[test]
fn a_file_that_would_be_written_differently_comes_back_too() {
    let seed = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fuzz/seeds/open_asset/bands-stored");
    let file = std::fs::read(seed).unwrap();
    let asset = Texture::from_bytes(&file).unwrap();
    assert_ne!(asset.data().to_bytes().unwrap(), file);
    for extension in ["glb", "gltf"] {
        let mut how = Export::new(Format::find("gltf").unwrap());
        how.extension = Some(extension);
        how.file = Some(&file);
        let bytes = export(&asset, &how).unwrap().bytes;
        let imported = import("a.glb", &bytes, &Import::default(), &Registry::builtin()).unwrap();
        assert_eq!(imported.to_bytes().unwrap(), file);
    }
}

/// Given metadata changes the file, unless the file already has the same values.
#[test]
fn metadata_is_applied() {
    let bytes = written("glb", &FILE);
    let of = |name: &str| {
        let mut how = Import::default();
        how.metadata.name = Some(name.to_owned());
        import("a.glb", &bytes, &how, &Registry::builtin()).unwrap()
    };
    let same = of(&ASSET.manifest().name);
    assert_eq!(same.to_bytes().unwrap(), *FILE);
    let named = of("other").to_bytes().unwrap();
    assert_eq!(Texture::from_bytes(&named).unwrap().manifest().name, "other");
}

#[test]
fn an_export_says_that_nothing_is_lost_and_takes_no_setting() {
    let mut how = Export::new(Format::find("gltf").unwrap());
    let exported = export(&ASSET, &how).unwrap();
    assert!(exported.played.is_none() && exported.notes.is_empty());
    assert_eq!(&exported.bytes[..4], b"glTF");
    assert_eq!(exported.bytes, written("glb", &FILE));
    how.seed = 1;
    let error = export(&ASSET, &how).unwrap_err().to_string();
    assert!(error.contains("its export takes no `seed`"), "{error}");
    // Bytes that are not an asset are not written as one.
    how.seed = 0;
    let long = vec![0; MOST_BYTES as usize + 1];
    how.file = Some(&long);
    let error = export(&ASSET, &how).unwrap_err().to_string();
    assert!(error.contains("at most 16777216 are read"), "{error}");
    let short = vec![0; MOST_BYTES as usize * 4 / 5];
    how.file = Some(&short);
    how.extension = Some("gltf");
    let error = export(&ASSET, &how).unwrap_err().to_string();
    assert!(error.contains("at most 16777216 are read"), "{error}");
}

/// The mesh: a rectangle of the size that the material states, wound counterclockwise, with texture
/// coordinates that go right and down.
#[test]
fn the_rectangle_has_the_size_that_is_stated() {
    let (json, bytes) = parts(&written("glb", &FILE));
    let material: Material =
        serde_json::from_value(json["materials"][0]["extensions"]["HTEX_texture"].clone()).unwrap();
    let floats = |accessor: usize| -> Vec<f32> {
        let accessor = &json["accessors"][accessor];
        let view = &json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let from = view["byteOffset"].as_u64().unwrap() as usize;
        let length = view["byteLength"].as_u64().unwrap() as usize;
        let of = |bytes: &[u8]| f32::from_le_bytes(*bytes.first_chunk().unwrap());
        bytes[from..from + length].chunks(4).map(of).collect()
    };
    let [width_mm, height_mm] = material.tex_coord_size_mm.unwrap();
    let corners = floats(0);
    let coordinates = floats(2);
    let mut count = 0;
    for (corner, coordinate) in corners.chunks(3).zip(coordinates.chunks(2)) {
        let x_mm = f64::from(coordinate[0]) * width_mm;
        let y_mm = f64::from(coordinate[1]) * height_mm;
        assert!((f64::from(corner[0]) * 1e3 + width_mm / 2.0 - x_mm).abs() < 1e-4);
        assert!((height_mm / 2.0 - f64::from(corner[1]) * 1e3 - y_mm).abs() < 1e-4);
        assert_eq!(corner[2], 0.0);
        count += 1;
    }
    assert_eq!(count, 4);
    assert_eq!(read(&written("glb", &FILE)).unwrap().material, material);
}

#[test]
fn what_is_written_and_what_is_read_is_what_the_schema_says() {
    let schema = Schema::new(&material_schema()).unwrap();
    let (json, bytes) = parts(&written("glb", &FILE));
    let texture = &json["materials"][0]["extensions"]["HTEX_texture"];
    assert_eq!(schema.violations(texture), []);
    for (key, value, is_valid) in [
        ("texCoord", json!(3), true),
        ("extras", json!({"a": 1}), true),
        ("another", json!([1]), true),
        ("texCoordSizeMm", json!([0.5, 2000]), true),
        ("texCoordSizeMm", json!([0, 1]), false),
        ("texCoordSizeMm", json!([1, -1]), false),
        ("texCoordSizeMm", json!([1]), false),
        ("texCoordSizeMm", json!([1, 1, 1]), false),
        ("texCoord", json!(-1), false),
        ("texCoord", json!(0.5), false),
        ("bufferView", json!("4"), false),
        ("bufferView", json!(-1), false),
        ("mimeType", json!("application/zip"), false),
    ] {
        let mut texture = texture.clone();
        texture[key] = value.clone();
        assert_eq!(schema.violations(&texture).is_empty(), is_valid, "{texture}");
        let mut json = json.clone();
        json["materials"][0]["extensions"]["HTEX_texture"] = texture;
        let said = said(&with(&json, bytes.clone()));
        assert_eq!(said == "it is read", is_valid, "{key} {value}: {said}");
        let place = format!("a.glb: /materials/0/extensions/HTEX_texture/{key}");
        assert!(is_valid || said.starts_with(&place), "{said}");
    }
    for key in ["bufferView", "mimeType"] {
        let mut texture = texture.clone();
        texture.as_object_mut().unwrap().remove(key);
        assert!(!schema.violations(&texture).is_empty(), "{key}");
        let said = changed("/materials/0/extensions/HTEX_texture", texture);
        assert!(said.contains(&format!("missing field `{key}`")), "{said}");
    }
}

#[test]
fn what_is_wrong_in_the_json_is_named_with_its_pointer() {
    let other = json!({"extensions": {"HTEX_texture": {"bufferView": 3, "mimeType": "application/vnd.htex+zip"}}});
    let (json, _) = parts(&written("glb", &FILE));
    let first = json["materials"][0].clone();
    for (pointer, value, expected) in [
        ("/asset/version", json!("1.0"), "/asset/version: this is glTF 1.0, and 2.0 is read"),
        ("/asset/minVersion", json!("2.1"), "/asset/minVersion: this is glTF 2.1"),
        ("/asset/version", json!(2), "/asset/version: "),
        ("/materials", json!([]), "/materials: no material has the extension HTEX_texture"),
        ("/materials", json!([{"name": "plain"}]), "/materials: no material has the extension"),
        (
            "/materials",
            json!([first, {}, other]),
            "/materials/2/extensions/HTEX_texture: material 0 carries another texture; keep one",
        ),
        ("/materials", json!([{}, first, first]), "it is read"),
        (
            "/extensionsUsed",
            json!([]),
            "/extensionsUsed: a material has the extension HTEX_texture; list it",
        ),
        (
            "/materials/0/extensions/HTEX_texture/bufferView",
            json!(9),
            "/materials/0/extensions/HTEX_texture/bufferView: there is no buffer view 9; the file has 5",
        ),
        (
            "/bufferViews/4/buffer",
            json!(1),
            "/bufferViews/4/buffer: there is no buffer 1; the file has 1",
        ),
        (
            "/bufferViews/4/byteLength",
            json!(10_000_000),
            "/bufferViews/4/byteLength: 10000000 bytes from 140 on reach over the end of buffer 0",
        ),
        ("/bufferViews/4/byteOffset", json!(u64::MAX), "/bufferViews/4/byteLength: "),
        ("/bufferViews/4/byteLength", json!(-1), "/bufferViews/4/byteLength: "),
        (
            "/bufferViews/4/byteStride",
            json!(4),
            "/bufferViews/4/byteStride: only vertices have a stride",
        ),
        ("/bufferViews/4/byteLength", json!(10), "/bufferViews/4: not a valid asset: "),
        ("/bufferViews/4/byteOffset", json!(0), "/bufferViews/4: not a valid asset: "),
        (
            "/buffers/0/byteLength",
            json!(10_000_000),
            "/buffers/0/byteLength: 10000000 bytes are stated, and ",
        ),
        (
            "/buffers/0/byteLength",
            json!(50),
            "/buffers/0/byteLength: 50 bytes are stated, and the chunk of the .glb has ",
        ),
        (
            "/buffers/0/uri",
            json!("texture.bin"),
            "/buffers/0/uri: the buffer is another file, which is not read",
        ),
        (
            "/buffers/0/uri",
            json!("http://example.com/a.bin"),
            "/buffers/0/uri: the buffer is another file",
        ),
        (
            "/buffers/0/uri",
            json!("data:,a"),
            "/buffers/0/uri: a buffer in a data URI begins with data:application/octet-stream;base64,",
        ),
        (
            "/buffers/0/uri",
            json!("data:image/png;base64,AAAA"),
            "/buffers/0/uri: a buffer in a data URI begins with",
        ),
        (
            "/buffers/0/uri",
            json!("data:application/octet-stream;base64,A%3D"),
            "/buffers/0/uri: this is not base64: ",
        ),
        (
            "/buffers/0/uri",
            json!("data:application/octet-stream;base64,AAAA"),
            "/buffers/0/byteLength: ",
        ),
    ] {
        let said = changed(pointer, value.clone());
        let expected = match expected {
            "it is read" => expected.to_owned(),
            expected => format!("a.glb: {expected}"),
        };
        assert!(said.starts_with(&expected), "{pointer} {value}: {said}");
    }
}

#[test]
fn a_text_has_no_second_chunk_and_may_hold_its_buffer() {
    let text = written("gltf", &FILE);
    let json: Value = serde_json::from_slice(&text).unwrap();
    let uri = json["buffers"][0]["uri"].as_str().unwrap();
    let octets = uri.replace("application/gltf-buffer", "application/octet-stream");
    let of = |uri: Value| {
        let mut json = json.clone();
        json["buffers"][0]["uri"] = uri;
        said(json.to_string().as_bytes())
    };
    assert_eq!(of(json!(octets)), "it is read");
    let said_of_none = of(Value::Null);
    assert!(said_of_none.starts_with("a.glb: /buffers/0: it has no `uri`"), "{said_of_none}");
    let twice =
        String::from_utf8(text).unwrap().replacen('{', "{\"asset\": {\"version\": \"2.0\"},", 1);
    assert!(
        said(twice.as_bytes()).contains("/asset: the key appears twice"),
        "{}",
        said(twice.as_bytes())
    );
}

#[test]
fn what_is_wrong_in_the_container_is_named_with_its_byte() {
    let whole = written("glb", &FILE);
    let (json, bytes) = parts(&whole);
    let mut other = whole.clone();
    other[4] = 1;
    assert!(said(&other).starts_with("a.glb: byte 4: the container has version 1"));
    let end = said(&whole[..whole.len() - 4]);
    assert!(end.starts_with("a.glb: byte 8: the header states "), "{end}");
    let text = json.to_string().into_bytes();
    for (chunks, expected) in [
        (vec![(b"BIN\0", bytes.clone())], "byte 16: the first chunk is not JSON"),
        (
            vec![(b"JSON", b"{}".to_vec())],
            "byte 12: the chunk has 2 bytes; it must be a multiple of 4",
        ),
        (vec![(b"JSON", b"{] ,".to_vec())], "line 1 column 2: it is not JSON"),
        (
            vec![
                (b"JSON", [text.clone(), b"    "[..(4 - text.len() % 4) % 4].to_vec()].concat()),
                (b"what", bytes),
            ],
            "/buffers/0: it has no `uri`, and only the first buffer of a .glb is in its second chunk",
        ),
    ] {
        let said = said(&glb(&chunks));
        assert!(said.starts_with(&format!("a.glb: {expected}")), "{said}");
    }
    let mut long = whole.clone();
    long[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(said(&long).starts_with("a.glb: byte 12: the chunk has 4294967295 bytes, and "));
    assert!(said(&vec![b' '; MOST_BYTES as usize + 1]).contains("at most 16777216 are read"));
}

/// A file cut off at any byte is refused with a message, and is never half read.
#[test]
fn a_file_that_ends_anywhere_is_refused() {
    let whole = written("glb", &FILE);
    for end in (0..whole.len()).step_by(7) {
        let short = &whole[..end];
        assert_ne!(said(short), "it is read", "{end}");
        // With a correct header.
        if end >= 12 {
            let mut short = short.to_vec();
            short[8..12].copy_from_slice(&(end as u32).to_le_bytes());
            assert_ne!(said(&short), "it is read", "{end}");
        }
    }
}

proptest! {
    /// Any change of bytes gives a message or the asset.
    #[test]
    fn no_byte_panics(at in 0usize..2000, byte: u8, bytes in prop::collection::vec(any::<u8>(), 0..64)) {
        let mut file = written("glb", &FILE);
        let len = file.len();
        file[at % len] = byte;
        let _ = read(&file);
        let _ = read(&bytes);
        let _ = read(&[&b"glTF\x02\0\0\0"[..], &bytes].concat());
    }
}
