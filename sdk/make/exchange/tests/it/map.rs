//! Friction maps as PNG: round trips, what is refused, and what is felt.

use std::f64::consts::TAU;

use htex_exchange::map::{Image, read};
use htex_exchange::{
    Export, ExportedFile, Format, Import, ImportedAsset, Path, Physical, export, import, missing,
};
use htex_play::{Motion, Registry, Texture, VoiceOptions};
use png::{BitDepth, ColorType, Encoder, PixelDimensions, Unit};
use proptest::collection::vec;
use proptest::prelude::*;

const SPEED_MM_S: f64 = 80.0;
const FORCE_N: f64 = 0.5;
const FULL_SCALE: f64 = 0.3;

/// A PNG of 8-bit pixels, with `in_metre` pixels in a metre.
fn png(width: usize, pixels: &[u8], color: ColorType, in_metre: Option<[u32; 2]>) -> Vec<u8> {
    let rows = pixels.len() / width / color.samples();
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width as u32, rows as u32);
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_pixel_dims(in_metre.map(|[xppu, yppu]| PixelDimensions {
        xppu,
        yppu,
        unit: Unit::Meter,
    }));
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(pixels).unwrap();
    writer.finish().unwrap();
    bytes
}

fn how(pitch_mm: Option<f64>) -> Import<'static> {
    Import {
        name: "map",
        physical: Physical {
            full_scale: Some(FULL_SCALE),
            speed_mm_s: Some(SPEED_MM_S),
            force_n: Some(FORCE_N),
            pitch_mm,
            ..Physical::default()
        },
        ..Import::default()
    }
}

fn imported(bytes: &[u8], pitch_mm: Option<f64>) -> ImportedAsset {
    import("map.png", bytes, &how(pitch_mm), &Registry::builtin()).unwrap()
}

fn refusal(bytes: &[u8], pitch_mm: Option<f64>) -> String {
    let refused = import("map.png", bytes, &how(pitch_mm), &Registry::builtin());
    refused.unwrap_err().to_string()
}

/// Opens the asset as an app does.
fn opened(imported: &ImportedAsset) -> Texture {
    Texture::from_bytes(&imported.to_bytes().unwrap()).unwrap()
}

fn exported(asset: &Texture) -> ExportedFile {
    export(asset, &Export::new(Format::find("png").unwrap())).unwrap()
}

/// Ridges along y, `wave` pixels apart.
fn ridges(width: usize, rows: usize, wave: f64) -> Vec<u8> {
    let grey = |x: usize| (127.5 + 100.0 * (TAU * x as f64 / wave).sin()).round() as u8;
    (0..rows).flat_map(|_| (0..width).map(grey)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Every pixel comes back. The distance comes back up to its rounding to whole pixels in a
    /// metre.
    #[test]
    fn there_and_back(
        (width, pixels) in (1usize..=255, 1usize..=20).prop_flat_map(|(width, rows)| (Just(width), vec(any::<u8>(), width * rows))),
        pitch_mm in 0.02f64..2.0,
    ) {
        let there = png(width, &pixels, ColorType::Grayscale, None);
        let Ok(made) = import("map.png", &there, &how(Some(pitch_mm)), &Registry::builtin()) else {
            // None of the image lies in the band.
            return Ok(());
        };
        let back = exported(&opened(&made));
        let again = read(&back.bytes).unwrap();
        prop_assert_eq!((again.width, &again.grey), (width, &pixels));
        let error = (again.pitch_mm.unwrap() / pitch_mm - 1.0).abs();
        prop_assert!(error <= 1e-3 * pitch_mm, "{}", error);
        prop_assert!(back.lost.is_none() && back.played.is_none());
    }
}

#[test]
fn the_same_pixels_are_read_of_each_kind_of_grey() {
    let grey = ridges(8, 4, 4.0);
    let of = |color| png(8, &expanded(&grey, color), color, Some([10_000; 2]));
    let whole = Image { width: 8, grey: grey.clone(), pitch_mm: Some(0.1) };
    for color in [ColorType::Grayscale, ColorType::GrayscaleAlpha, ColorType::Rgb, ColorType::Rgba]
    {
        assert_eq!(read(&of(color)).unwrap(), whole, "{color:?}");
    }
}

fn expanded(grey: &[u8], color: ColorType) -> Vec<u8> {
    let pixel = |grey: &u8| match color {
        ColorType::GrayscaleAlpha => vec![*grey, 255],
        ColorType::Rgb => vec![*grey; 3],
        ColorType::Rgba => vec![*grey, *grey, *grey, 255],
        _ => vec![*grey],
    };
    grey.iter().flat_map(pixel).collect()
}

#[test]
fn what_is_no_map_is_refused_with_its_place() {
    let grey = ridges(16, 4, 8.0);
    let mut colour = expanded(&grey, ColorType::Rgb);
    colour[3 * (16 + 2)] ^= 1;
    let mut clear = expanded(&grey, ColorType::GrayscaleAlpha);
    clear[2 * 5 + 1] = 254;
    let mut sixteen = Vec::new();
    let mut encoder = Encoder::new(&mut sixteen, 1, 1);
    encoder.set_depth(BitDepth::Sixteen);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0, 0]).unwrap();
    writer.finish().unwrap();
    let one = |width, in_metre| png(width, &ridges(width, 2, 8.0), ColorType::Grayscale, in_metre);
    let flat = png(16, &[7; 64], ColorType::Grayscale, None);
    for (bytes, words) in [
        (
            png(16, &colour, ColorType::Rgb, None),
            "map.png: row 2, column 3: the pixel has a colour",
        ),
        (
            png(16, &clear, ColorType::GrayscaleAlpha, None),
            "map.png: row 1, column 6: the pixel is transparent",
        ),
        (sixteen, "map.png: IHDR: it has 16 bits a channel"),
        (one(256, None), "map.png: IHDR: it has 256 x 2 pixels, and a map has at most 255 x 255"),
        (one(16, Some([1_000, 1_001])), "map.png: pHYs: its pixels are no squares"),
        (one(16, Some([1; 2])), "map.png: pHYs: 1 pixels in a metre are out of the range"),
        (one(16, Some([0; 2])), "map.png: pHYs: 0 pixels in a metre are out of the range"),
        (flat, "map.png: along its rows at 80 mm/s the map has nothing between 20 and 1000 Hz"),
        (b"GIF89a".to_vec(), "map.png: it is no PNG that can be read"),
        (vec![0; 1 << 21], "map.png: it has 2097152 bytes"),
    ] {
        let error = refusal(&bytes, Some(0.1));
        assert!(error.contains(words), "{error}");
    }
    let error = refusal(&one(16, None), None);
    assert!(error.contains("how far apart its pixels are; give `pitch`"), "{error}");
    let error = refusal(&one(16, None), Some(65.0));
    assert!(error.contains("at most 64 mm"), "{error}");
    let whole = one(16, Some([10_000; 2]));
    for end in 0..whole.len() - 12 {
        let error = refusal(&whole[..end], None);
        assert!(error.contains("map.png: "), "{end}: {error}");
    }
}

/// Ridges 1 mm apart are felt at as many hertz as the finger moves mm/s across them, and are not
/// felt along them.
#[test]
fn what_is_felt_follows_the_place() {
    let file = png(100, &ridges(100, 3, 10.0), ColorType::Grayscale, Some([10_000; 2]));
    let asset = opened(&imported(&file, None));
    let amplitude = |velocity: [f64; 2], force_n: f64, hz: f64| {
        let samples = stroke(&asset, velocity, force_n);
        let late = &samples[4_000..];
        let turn = |n: usize| TAU * hz * n as f64 / 8_000.0;
        let part = |f: fn(f64) -> f64| -> f64 {
            late.iter().enumerate().map(|(n, x)| f64::from(*x) * f(turn(n))).sum()
        };
        2.0 * part(f64::cos).hypot(part(f64::sin)) / late.len() as f64
    };
    let there = FULL_SCALE * 100.0 / 255.0;
    for (velocity, hz) in [([80.0, 0.0], 80.0), ([160.0, 0.0], 160.0), ([48.0, 36.0], 48.0)] {
        let felt = amplitude(velocity, FORCE_N, hz);
        assert!((felt / there - 1.0).abs() < 0.05, "{velocity:?}: {felt} N");
    }
    let pressed = amplitude([80.0, 0.0], 2.0 * FORCE_N, 80.0);
    assert!((pressed / there / 2.0 - 1.0).abs() < 0.05, "{pressed} N");
    let along = stroke(&asset, [0.0, 80.0], FORCE_N);
    let most = along[4_000..].iter().fold(0.0f32, |most, x| most.max(x.abs()));
    assert!(f64::from(most) < 1e-3 * there, "{most} N");
}

/// Two seconds of a straight stroke at 8 kHz.
fn stroke(asset: &Texture, [dx, dy]: [f64; 2], force_n: f64) -> Vec<f32> {
    let mut voice = asset.voice(&VoiceOptions::default().with_rate_hz(8_000.0)).unwrap();
    let mut samples = vec![0.0; 16_000];
    for (block, samples) in samples.chunks_mut(40).enumerate() {
        let time_s = block as f64 * 0.005;
        let motion = Motion::new(dx.hypot(dy), force_n).with_place_mm([dx * time_s, dy * time_s]);
        voice.set_motion(motion).unwrap();
        voice.render(samples).unwrap();
    }
    samples
}

/// A texture that is not a map is exported as a row of pixels, which plays the texture's level and
/// third octaves at the speed, as far as 255 pixels can hold them.
#[test]
fn a_texture_without_places_goes_out_as_a_row() {
    let file = br#"{"version": {"major": 1}, "signals": {"continuous": {"envelopes": {
        "amplitude": [{"time": 0, "amplitude": 0.5}, {"time": 1, "amplitude": 0.5}]}}}}"#;
    let mut hum = how(None);
    hum.fit.models = Some(vec!["sslope".to_owned()]);
    let hum = import("hum.haptic", file, &hum, &Registry::builtin()).unwrap();
    let hum = opened(&hum);
    let mut to = Export::new(Format::find("png").unwrap());
    let motion = Motion::new(120.0, FORCE_N);
    to.path = Path::Condition(Some(motion));
    let row = export(&hum, &to).unwrap();
    let lost = row.lost.unwrap();
    assert!(lost.level_db.abs() < 0.2, "{} dB", lost.level_db);
    assert_eq!(read(&row.bytes).unwrap().grey.len(), 255);
    let white: f64 = row.notes[0].split_whitespace().nth(2).unwrap().parse().unwrap();
    let mut back = how(None);
    back.physical.full_scale = Some(white);
    back.physical.speed_mm_s = Some(120.0);
    let back = import("row.png", &row.bytes, &back, &Registry::builtin()).unwrap();
    let level = opened(&back).level_rms(None).unwrap();
    let there = hum.level_rms(Some(motion)).unwrap();
    let level_db = 20.0 * (level / there).log10();
    assert!((level_db - lost.level_db).abs() < 0.05, "{level_db} dB");

    let map = opened(&back);
    let error = export(&map, &to).unwrap_err().to_string();
    assert!(error.contains("leave out speed and force"), "{error}");
}

#[test]
fn the_distance_of_pixels_is_missing_where_the_file_does_not_state_it() {
    let settings = |in_metre| {
        let bytes = png(2, &[0, 255, 255, 0], ColorType::Grayscale, in_metre);
        let all = missing("map.png", &bytes).unwrap();
        all.iter().map(|one| one.setting).collect::<Vec<_>>()
    };
    let always = ["full_scale", "speed", "force"];
    assert_eq!(settings(Some([10_000; 2])), always);
    assert_eq!(settings(None), [&always[..], &["pitch"]].concat());
    let refused = missing("map.png", b"PNG").unwrap_err().to_string();
    assert!(refused.contains("it is no PNG"), "{refused}");
}
