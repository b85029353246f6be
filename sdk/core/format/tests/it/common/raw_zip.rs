//! Writer of deliberately invalid archives.

/// The fields of an entry's header.
#[derive(Clone, Default)]
pub struct Header {
    pub name: Vec<u8>,
    pub flags: u16,
    /// Minutes of the time, of midnight.
    pub minutes: u16,
    /// Number of the disk, which only the directory has.
    pub disk: u16,
    pub method: u16,
    pub crc: u32,
    pub packed: u32,
    pub size: u32,
    pub extra: Vec<u8>,
    pub comment: Vec<u8>,
}

/// An entry: its two headers and its bytes.
#[derive(Clone)]
pub struct Entry {
    pub local: Header,
    pub central: Header,
    pub data: Vec<u8>,
}

impl Entry {
    /// Creates a valid, stored entry.
    pub fn stored(name: &str, data: &[u8]) -> Self {
        let header = Header {
            name: name.into(),
            crc: crc32(data),
            packed: data.len() as u32,
            size: data.len() as u32,
            ..Header::default()
        };
        Self { local: header.clone(), central: header, data: data.to_vec() }
    }

    /// Applies the same change to both headers.
    pub fn with(mut self, change: impl Fn(&mut Header)) -> Self {
        change(&mut self.local);
        change(&mut self.central);
        self
    }
}

/// Writes an archive of entries.
pub fn archive(entries: &[Entry]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for entry in entries {
        let at = bytes.len() as u32;
        put(&mut bytes, 0x0403_4b50, 4);
        put(&mut bytes, 10, 2);
        header(&mut bytes, &entry.local);
        bytes.extend(&entry.local.name);
        bytes.extend(&entry.local.extra);
        bytes.extend(&entry.data);
        central(&mut directory, &entry.central, at);
    }
    let directory_at = bytes.len() as u32;
    bytes.extend(&directory);
    put(&mut bytes, 0x0605_4b50, 4);
    put(&mut bytes, 0, 4);
    put(&mut bytes, entries.len() as u32, 2);
    put(&mut bytes, entries.len() as u32, 2);
    put(&mut bytes, directory.len() as u32, 4);
    put(&mut bytes, directory_at, 4);
    put(&mut bytes, 0, 2);
    bytes
}

fn central(directory: &mut Vec<u8>, entry: &Header, local_at: u32) {
    put(directory, 0x0201_4b50, 4);
    put(directory, 10, 2);
    put(directory, 10, 2);
    header(directory, entry);
    put(directory, entry.comment.len() as u32, 2);
    put(directory, entry.disk.into(), 2);
    put(directory, 0, 2);
    put(directory, 0, 4);
    put(directory, local_at, 4);
    for part in [&entry.name, &entry.extra, &entry.comment] {
        directory.extend(part);
    }
}

fn header(out: &mut Vec<u8>, entry: &Header) {
    put(out, entry.flags.into(), 2);
    put(out, entry.method.into(), 2);
    // 1980-01-01.
    put(out, 0x0021_0000 | u32::from(entry.minutes) << 5, 4);
    put(out, entry.crc, 4);
    put(out, entry.packed, 4);
    put(out, entry.size, 4);
    put(out, entry.name.len() as u32, 2);
    put(out, entry.extra.len() as u32, 2);
}

fn put(out: &mut Vec<u8>, value: u32, bytes: usize) {
    out.extend(&value.to_le_bytes()[..bytes]);
}

fn crc32(bytes: &[u8]) -> u32 {
    let shift = |crc: u32| (crc >> 1) ^ (0xEDB8_8320 * (crc & 1));
    !bytes.iter().fold(!0u32, |crc, &b| (0..8).fold(crc ^ u32::from(b), |c, _| shift(c)))
}
