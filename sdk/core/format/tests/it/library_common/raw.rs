//! An encoder of libraries that shares no code with the crate. It writes whatever it is given, with
//! valid checksums.

use super::Texture;

/// A change of bytes.
pub type Change = fn(&mut Vec<u8>);

/// The parts of a library. Parts that are `None` are computed.
#[derive(Clone, Default)]
pub struct Raw {
    pub name: Vec<u8>,
    pub version: (u16, u16),
    pub leaves: Vec<Vec<Row>>,
    pub separators: Option<Vec<Vec<u8>>>,
    pub shared: Vec<u8>,
    pub payload: Vec<u8>,
    pub entries: Option<u64>,
    pub index_blake3: Option<[u8; 32]>,
    /// Metadata as JSON.
    pub metadata: Vec<u8>,
    /// Spectra of the leaves' entries. Leaves beyond the last one
    /// have no spectra.
    pub spectra: Vec<Vec<Option<RawSpectrum>>>,
    pub spectra_blake3: Option<[u8; 32]>,
    /// Changes to unpacked pages: 0 is the root, 1 the first leaf, 101 the spectra of the first leaf.
    pub pages: Vec<(usize, Change)>,
    /// Unpacked pages that replace others, with the same numbering.
    pub replaced: Vec<(usize, Vec<u8>)>,
    /// Changes to deflate streams, with the same numbering.
    pub streams: Vec<(usize, Change)>,
    /// Whether pages are deflated, and not only stored in a stream.
    pub is_deflated: bool,
    /// A change to the header before its checksum is computed.
    pub header: Option<Change>,
}

/// A spectrum: the largest level, and the others.
pub type RawSpectrum = (f32, [u8; 48]);

/// An entry of a leaf.
#[derive(Clone)]
pub struct Row {
    pub name: Vec<u8>,
    pub tags: Vec<String>,
    pub models: Vec<String>,
    pub speeds: Option<(f64, f64)>,
    pub forces: Option<(f64, f64)>,
    /// Numbers of the contact and of the exponents' sources, and the exponents.
    pub law: (u8, [f64; 3]),
    pub at: u64,
    pub own: u64,
    /// Own bytes before the last one, start, length.
    pub cuts: Vec<(u64, u64, u64)>,
    pub hash: [u8; 32],
    pub license: Option<String>,
    pub author: Option<String>,
    pub quantity: u8,
    /// Felt difference, hundredths of a decibel, plus 1; 0 if it is unknown.
    pub felt: u64,
    pub held_out: u64,
}

impl Raw {
    /// Creates a library of these textures with `in_leaf` entries in each leaf. Nothing is shared.
    pub fn of(textures: &[Texture], in_leaf: usize) -> Self {
        let mut raw = Self {
            name: b"Raw".to_vec(),
            version: (1, 1),
            metadata: b"{}".to_vec(),
            ..Self::default()
        };
        let mut rows: Vec<Row> = Vec::new();
        for texture in textures {
            let bytes = texture.bytes();
            let speeds = texture.speeds_mm_s.iter().copied();
            rows.push(Row {
                name: texture.name.clone().into_bytes(),
                tags: texture.tags.clone(),
                models: vec!["org.htex.sbeta".to_owned()],
                speeds: Some((speeds.clone().fold(f64::MAX, f64::min), speeds.fold(0.0, f64::max))),
                forces: Some((0.5, 0.5)),
                // Contact unknown, all exponents assumed.
                law: (0b10_10_10_10, [0.0, 0.75, 0.5]),
                at: raw.payload.len() as u64,
                own: bytes.len() as u64,
                cuts: Vec::new(),
                hash: *blake3::hash(&bytes).as_bytes(),
                license: Some("CC0-1.0".to_owned()),
                author: None,
                quantity: 0,
                felt: 0,
                held_out: 0,
            });
            raw.payload.extend(bytes);
        }
        raw.leaves = rows.chunks(in_leaf).map(<[Row]>::to_vec).collect();
        raw
    }

    pub fn with(mut self, change: impl FnOnce(&mut Self)) -> Self {
        change(&mut self);
        self
    }

    pub fn bytes(&self) -> Vec<u8> {
        let leaves: Vec<Vec<u8>> = (1..=self.leaves.len())
            .map(|number| self.frame(number, self.leaf(number - 1)))
            .collect();
        let root = self.frame(0, self.root(&leaves));
        let index = [root.clone(), leaves.concat()].concat();
        let entries = self.leaves.iter().map(|leaf| leaf.len() as u64).sum();
        let mut header = b"\x89HTL\r\n\x1a\n".to_vec();
        header.extend(self.version.0.to_le_bytes());
        header.extend(self.version.1.to_le_bytes());
        header.extend([0; 4]);
        let mut at = 128u64;
        let shared = [self.shared.clone(), self.spectrum_pages().concat()].concat();
        let lengths = [root.len(), leaves.concat().len(), shared.len(), self.payload.len()];
        for length in lengths {
            header.extend(at.to_le_bytes());
            header.extend((length as u64).to_le_bytes());
            at += length as u64;
        }
        header.extend(self.entries.unwrap_or(entries).to_le_bytes());
        header.extend((self.leaves.len() as u32).to_le_bytes());
        let hash = *blake3::hash(&index).as_bytes();
        header.extend(self.index_blake3.unwrap_or(hash));
        if let Some(change) = self.header {
            change(&mut header);
        }
        header.extend(crc32(&header).to_le_bytes());
        [header, index, shared, self.payload.clone()].concat()
    }

    /// An unpacked page: 0 is the root.
    pub fn page(&self, number: usize) -> Vec<u8> {
        let leaf = |i| self.leaf(i);
        let leaves = || (0..self.leaves.len()).map(|i| self.frame(i + 1, leaf(i)));
        match number.checked_sub(1) {
            None => self.root(&leaves().collect::<Vec<_>>()),
            Some(i) => leaf(i),
        }
    }

    fn root(&self, leaves: &[Vec<u8>]) -> Vec<u8> {
        let mut page = Vec::new();
        text(&mut page, &self.name);
        varint(&mut page, leaves.len() as u64);
        let whole = |(i, leaf): (usize, &Vec<Row>)| {
            if i == 0 { Vec::new() } else { leaf[0].name.clone() }
        };
        let separators = self.leaves.iter().enumerate().map(whole).collect();
        let mut before = Vec::new();
        for separator in self.separators.as_ref().unwrap_or(&separators) {
            following(&mut page, &before, separator);
            before = separator.clone();
        }
        leaves.iter().for_each(|leaf| varint(&mut page, leaf.len() as u64));
        if self.version.1 > 0 {
            text(&mut page, &self.metadata);
            let pages = self.spectrum_pages();
            pages.iter().for_each(|spectra| varint(&mut page, spectra.len() as u64));
            let hash = *blake3::hash(&pages.concat()).as_bytes();
            page.extend(self.spectra_blake3.unwrap_or(hash));
        }
        page
    }

    /// The packed pages of spectra, one for each leaf; empty without spectra.
    fn spectrum_pages(&self) -> Vec<Vec<u8>> {
        let pages = (0..self.leaves.len()).map(|leaf| {
            let Some(spectra) = self.spectra.get(leaf) else { return Vec::new() };
            let mut page = Vec::new();
            varint(&mut page, spectra.len() as u64);
            page.extend(spectra.iter().map(|spectrum| u8::from(spectrum.is_some())));
            for (largest, levels) in spectra.iter().flatten() {
                page.extend(largest.to_le_bytes());
                page.extend(levels);
            }
            self.frame(101 + leaf, page)
        });
        pages.collect()
    }

    fn leaf(&self, leaf: usize) -> Vec<u8> {
        let rows = &self.leaves[leaf];
        let words = rows.iter().flat_map(|row| row.tags.iter().chain(&row.models));
        let mut words: Vec<String> = words.cloned().collect();
        words.sort();
        words.dedup();
        let mut page = Vec::new();
        varint(&mut page, rows.len() as u64);
        varint(&mut page, words.len() as u64);
        words.iter().for_each(|word| text(&mut page, word.as_bytes()));
        let mut before = Vec::new();
        for row in rows {
            following(&mut page, &before, &row.name);
            before = row.name.clone();
        }
        for chosen in [|row: &Row| row.tags.clone(), |row: &Row| row.models.clone()] {
            for row in rows {
                varint(&mut page, chosen(row).len() as u64);
                for word in chosen(row) {
                    varint(&mut page, words.iter().position(|w| *w == word).unwrap() as u64);
                }
            }
        }
        rows.iter().for_each(|row| conditions(&mut page, row));
        for (bits, exponents) in rows.iter().map(|row| row.law) {
            page.push(bits);
            page.extend(exponents.iter().flat_map(|x| x.to_le_bytes()));
        }
        varint(&mut page, rows.first().map_or(0, |row| row.at));
        rows.iter().for_each(|row| varint(&mut page, row.own));
        for row in rows {
            varint(&mut page, row.cuts.len() as u64);
            for (before, start, length) in &row.cuts {
                for value in [before, start, length] {
                    varint(&mut page, *value);
                }
            }
        }
        rows.iter().for_each(|row| page.extend(row.hash));
        if self.version.1 == 0 {
            return page;
        }
        let rights = rows.iter().flat_map(|row| row.license.iter().chain(&row.author));
        let mut rights: Vec<String> = rights.cloned().collect();
        rights.sort();
        rights.dedup();
        varint(&mut page, rights.len() as u64);
        rights.iter().for_each(|right| text(&mut page, right.as_bytes()));
        for chosen in [|row: &Row| row.license.clone(), |row: &Row| row.author.clone()] {
            for right in rows.iter().map(chosen) {
                let place = right.and_then(|right| rights.iter().position(|r| *r == right));
                varint(&mut page, place.map_or(0, |place| place as u64 + 1));
            }
        }
        page.extend(rows.iter().map(|row| row.quantity));
        rows.iter().for_each(|row| varint(&mut page, row.felt));
        rows.iter().for_each(|row| varint(&mut page, row.held_out));
        page
    }

    fn frame(&self, number: usize, mut page: Vec<u8>) -> Vec<u8> {
        if let Some((_, other)) = self.replaced.iter().find(|(i, _)| *i == number) {
            page.clone_from(other);
        }
        for (_, change) in self.pages.iter().filter(|(i, _)| *i == number) {
            change(&mut page);
        }
        let mut stream = if self.is_deflated { deflated(&page) } else { stored(&page) };
        for (_, change) in self.streams.iter().filter(|(i, _)| *i == number) {
            change(&mut stream);
        }
        let rest = [(page.len() as u32).to_le_bytes().to_vec(), stream].concat();
        [crc32(&rest).to_le_bytes().to_vec(), rest].concat()
    }
}

fn conditions(page: &mut Vec<u8>, row: &Row) {
    let bits = |range: Option<(f64, f64)>| match range {
        None => 0,
        Some((min, max)) => 1 | u8::from(min == max) << 2,
    };
    page.push(bits(row.speeds) | bits(row.forces) << 1);
    for (min, max) in row.speeds.into_iter().chain(row.forces) {
        page.extend(min.to_le_bytes());
        if min != max {
            page.extend(max.to_le_bytes());
        }
    }
}

fn varint(page: &mut Vec<u8>, value: u64) {
    if value >= 128 {
        page.push((value % 128) as u8 + 128);
        varint(page, value / 128);
    } else {
        page.push(value as u8);
    }
}

fn text(page: &mut Vec<u8>, text: &[u8]) {
    varint(page, text.len() as u64);
    page.extend(text);
}

fn following(page: &mut Vec<u8>, before: &[u8], now: &[u8]) {
    let mut shared = 0;
    while shared < before.len().min(now.len()) && before[shared] == now[shared] {
        shared += 1;
    }
    varint(page, shared as u64);
    text(page, &now[shared..]);
}

fn deflated(data: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut stream = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    stream.write_all(data).unwrap();
    stream.finish().unwrap()
}

/// A deflate stream of stored blocks (RFC 1951, section 3.2.4).
pub fn stored(data: &[u8]) -> Vec<u8> {
    let mut stream = Vec::new();
    let mut chunks = data.chunks(65_535).peekable();
    if chunks.peek().is_none() {
        return vec![1, 0, 0, 0xff, 0xff];
    }
    while let Some(chunk) = chunks.next() {
        stream.push(u8::from(chunks.peek().is_none()));
        stream.extend((chunk.len() as u16).to_le_bytes());
        stream.extend((!(chunk.len() as u16)).to_le_bytes());
        stream.extend(chunk);
    }
    stream
}

/// CRC-32 as in ZIP and PNG, computed bit by bit.
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 * (crc & 1)))
    })
}
