//! A page of spectra: it contains the spectra of all entries on one leaf page, in the order of the
//! entries.

use crate::library::coarse_spectrum::{CoarseSpectrum, POINTS};
use crate::library::wire::{Cursor, WireError};

/// Decodes the unpacked page.
pub(crate) fn read_spectra(page: &[u8]) -> Result<Vec<Option<CoarseSpectrum>>, WireError> {
    let mut cursor = Cursor::new(page);
    let count = cursor.count(1)?;
    let known = cursor.read_bytes(count)?;
    let spectra = known.iter().map(|known| match known {
        0 => Ok(None),
        1 => spectrum(&mut cursor).map(Some),
        _ => Err(cursor.malformed("a spectrum is neither there nor absent")),
    });
    let spectra = spectra.collect::<Result<Vec<_>, _>>()?;
    if cursor.rest() > 0 {
        return Err(cursor.malformed("bytes follow the last value"));
    }
    Ok(spectra)
}

fn spectrum(cursor: &mut Cursor<'_>) -> Result<CoarseSpectrum, WireError> {
    let largest_db = f32::from_le_bytes(cursor.array()?);
    let levels: [u8; POINTS] = cursor.array()?;
    if !largest_db.is_finite() || !levels.contains(&u8::MAX) {
        return Err(cursor.malformed("a spectrum has no largest level"));
    }
    Ok(CoarseSpectrum { largest_db, levels })
}
