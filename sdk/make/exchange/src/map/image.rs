//! Reads and writes images: PNG files with one grey value for each pixel. A file can also state the
//! distance between pixels.

use std::io::Cursor;

use htex_format::Rights;
use htex_map::MOST_SIDE;
use png::{BitDepth, ColorType, Decoder, Encoder, Limits, PixelDimensions, Transformations, Unit};

use crate::error::Fault;

/// Largest file that is read, bytes. It is far more than 255 by 255 pixels take.
const MOST_BYTES: usize = 1 << 20;
/// Largest amount of memory that the decoder may use, bytes.
const MOST_DECODED: usize = 4 << 20;
/// Longest text that is unpacked, bytes.
const MOST_TEXT: usize = 64 << 10;
/// Allowed distances between pixels, mm. They come from the model `org.htex.map`.
pub(crate) const PITCH_MM: std::ops::RangeInclusive<f64> =
    htex_map::PITCH_MM.0..=htex_map::PITCH_MM.1;

/// An image: grey values over a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Number of pixels in a row, 1 to 255.
    pub width: usize,
    /// Grey values of the pixels, row by row from the top; 0 is black, 255 is white. There are 1 to
    /// 255 rows.
    pub grey: Vec<u8>,
    /// Distance between neighbouring pixels in mm, if the file states it.
    pub pitch_mm: Option<f64>,
}

/// Reads a PNG file with grey values. A colour image is accepted if all of its colours are grey.
///
/// # Errors
/// Returns an error if the file is not a PNG, or if it has colours, transparent pixels, several
/// frames, more than 8 bits per channel, or more than 255 pixels in a row or a column. The fault
/// names the place.
pub fn read(bytes: &[u8]) -> Result<Image, Fault> {
    if bytes.len() > MOST_BYTES {
        let size = bytes.len();
        return Err(Fault::whole(format!(
            "it has {size} bytes, and at most {MOST_BYTES} are read"
        )));
    }
    let failed =
        |error: png::DecodingError| Fault::whole(format!("it is no PNG that can be read: {error}"));
    let limits = Limits { bytes: MOST_DECODED };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(failed)?;
    let (width, height, depth) = (header.width as usize, header.height as usize, header.bit_depth);
    // Checked before the pixels are unpacked, because a small file may state any size.
    if width > MOST_SIDE || height > MOST_SIDE {
        return Err(Fault::new(
            "IHDR",
            format!(
                "it has {width} x {height} pixels, and a map has at most {MOST_SIDE} x {MOST_SIDE}; make it smaller"
            ),
        ));
    }
    // A map stores one byte for each pixel. Nobody would notice if half of the bits were dropped.
    if depth == BitDepth::Sixteen {
        return Err(Fault::new("IHDR", "it has 16 bits a channel; save it with 8"));
    }
    let mut reader = decoder.read_info().map_err(failed)?;
    let mut pixels = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let frame = reader.next_frame(&mut pixels).map_err(failed)?;
    let info = reader.info();
    // Only the first frame would be decoded, and it may not be the one that the user wants.
    if info.animation_control.is_some() {
        return Err(Fault::new("acTL", "it has several frames; save one of them"));
    }
    pixels.truncate(frame.buffer_size());
    Ok(Image {
        width,
        grey: grey(&pixels, frame.color_type, width)?,
        pitch_mm: info.pixel_dims.map(pitch_mm).transpose()?.flatten(),
    })
}

/// Returns the licence and author in the text chunks before the pixels. Both are empty if the file
/// has none or cannot be read.
pub(crate) fn rights(bytes: &[u8]) -> Rights {
    let limits = Limits { bytes: MOST_DECODED };
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
    let Ok(info) = decoder.read_header_info().map(|_| ()).and_then(|()| decoder.read_info()) else {
        return Rights::default();
    };
    let info = info.info();
    let plain = info.uncompressed_latin1_text.iter().map(|chunk| Rights::from_text(&chunk.text));
    let wide = info.utf8_text.iter().filter_map(|chunk| {
        let mut chunk = chunk.clone();
        // Without this limit, `get_text` would unpack a megabyte to a gigabyte.
        chunk.decompress_text_with_limit(MOST_TEXT).ok()?;
        Some(Rights::from_text(&chunk.get_text().ok()?))
    });
    plain.chain(wide).fold(Rights::default(), Rights::or)
}

/// Returns the grey values of decoded pixels.
fn grey(pixels: &[u8], color: ColorType, width: usize) -> Result<Vec<u8>, Fault> {
    let place = |index: usize| format!("row {}, column {}", index / width + 1, index % width + 1);
    let one = |(index, pixel): (usize, &[u8])| {
        let (colours, alpha) = match pixel {
            [grey] => ([*grey; 3], 255),
            [grey, alpha] => ([*grey; 3], *alpha),
            [red, green, blue] => ([*red, *green, *blue], 255),
            [red, green, blue, alpha, ..] => ([*red, *green, *blue], *alpha),
            [] => ([0; 3], 255),
        };
        let [red, green, blue] = colours;
        if red != green || green != blue {
            return Err(Fault::new(place(index), "the pixel has a colour; save the image in grey"));
        }
        match alpha {
            255 => Ok(red),
            _ => Err(Fault::new(
                place(index),
                "the pixel is transparent; save the image without an alpha channel",
            )),
        }
    };
    pixels.chunks_exact(color.samples()).enumerate().map(one).collect()
}

/// Returns the distance between pixels, mm, or `None` if the file states only the shape of a pixel.
fn pitch_mm(stated: PixelDimensions) -> Result<Option<f64>, Fault> {
    if stated.unit == Unit::Unspecified {
        return Ok(None);
    }
    if stated.xppu != stated.yppu {
        return Err(Fault::new("pHYs", "its pixels are no squares; scale the image"));
    }
    let pitch_mm = 1e3 / f64::from(stated.xppu);
    if PITCH_MM.contains(&pitch_mm) {
        Ok(Some(pitch_mm))
    } else {
        Err(Fault::new(
            "pHYs",
            format!(
                "{} pixels in a metre are out of the range of a map: {} to {} mm for a pixel",
                stated.xppu,
                PITCH_MM.start(),
                PITCH_MM.end()
            ),
        ))
    }
}

/// Writes an image as an 8-bit grey PNG. The file states a whole number of pixels per metre.
pub(super) fn to_bytes(image: &Image, rights: &Rights) -> Result<Vec<u8>, Fault> {
    let failed = |error: png::EncodingError| Fault::whole(error.to_string());
    let rows = image.grey.len() / image.width.max(1);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, image.width as u32, rows as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_pixel_dims(image.pitch_mm.map(|pitch_mm| {
        // The chunk stores a whole number of pixels per metre, so the distance is rounded.
        let in_metre = libm::round(1e3 / pitch_mm) as u32;
        PixelDimensions { xppu: in_metre, yppu: in_metre, unit: Unit::Meter }
    }));
    if !rights.is_empty() {
        let text = encoder.add_itxt_chunk("Copyright".to_owned(), rights.described(""));
        text.map_err(failed)?;
    }
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(&image.grey).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use png::text_metadata::ITXtChunk;

    use super::*;

    /// An image of one pixel with a packed text.
    fn with_text(text: String) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, 1, 1);
        encoder.set_color(ColorType::Grayscale);
        let mut writer = encoder.write_header().unwrap();
        let mut chunk = ITXtChunk::new("Copyright", text);
        chunk.compressed = true;
        writer.write_text_chunk(&chunk).unwrap();
        writer.write_image_data(&[0]).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn a_packed_text_is_read_up_to_a_length() {
        let text =
            |blanks: usize| format!("SPDX-License-Identifier: CC0-1.0\n{}", " ".repeat(blanks));
        assert_eq!(rights(&with_text(text(1_000))).license.as_deref(), Some("CC0-1.0"));
        assert!(rights(&with_text(text(MOST_TEXT))).is_empty());
    }
}
