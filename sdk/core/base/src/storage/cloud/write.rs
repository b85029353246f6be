//! Writes a file completely or not at all: in one request, or in parts that the service joins into
//! a file only at the last request.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::time::{Duration, Instant};

use object_store::{
    Attribute, Attributes, MultipartUpload, PutMultipartOptions, PutOptions, PutPayload,
};
use tokio::task::JoinSet;

use super::Store;
use super::explain::Fail;
use crate::storage::{StorageError, StorageProblem};

/// Files up to this size are sent with one request.
const MOST_SINGLE_BYTES: u64 = 16 << 20;
/// Size of a part, bytes. The last part may be smaller. S3 accepts up to 10,000 parts of at least 5
/// MiB.
const PART_BYTES: u64 = 8 << 20;
/// Largest size of a file, bytes: the largest number of parts.
const MOST_BYTES: u64 = 10_000 * PART_BYTES;
/// Number of parts that are sent at the same time.
const MOST_AT_ONCE: usize = 4;
/// Longest time for removing the parts after a failure.
const ABORT: Duration = Duration::from_secs(10);

impl Store {
    /// Writes a file in one request.
    pub(crate) fn write(&self, bytes: Vec<u8>) -> Result<(), StorageError> {
        let here = self.clone();
        self.run(async move {
            let payload = PutPayload::from(bytes);
            let options = PutOptions::from(here.attributes());
            here.store.put_opts(&here.key, payload, options).await?;
            Ok(())
        })
    }

    /// Uploads a local file.
    pub(crate) fn upload(&self, path: &Path) -> Result<(), StorageError> {
        let mut file = File::open(path).map_err(StorageError::io_at(path.display()))?;
        let len = file.metadata().map_err(StorageError::io_at(path.display()))?.len();
        if len > MOST_BYTES {
            let most_bytes = MOST_BYTES;
            return Err(StorageProblem::TooLarge { most_bytes }.at_place(path.display()));
        }
        if len <= MOST_SINGLE_BYTES {
            let mut bytes = Vec::new();
            file.read_to_end(&mut bytes).map_err(StorageError::io_at(path.display()))?;
            return self.write(bytes);
        }
        // The upload itself may take the total time. After a failure, the program waits for the
        // parts that are still being sent, and then removes the other parts. Each of these two
        // steps may take [`ABORT`].
        let limit = self.settings.total + 2 * ABORT;
        self.run_within(limit, self.clone().in_parts(file))
    }

    /// Returns the headers that the store sends with the file: its media type, and the instruction
    /// that a cached copy must be checked before each use, because the file can be replaced.
    fn attributes(&self) -> Attributes {
        let name = self.location.file_name().unwrap_or_default();
        let media_type = media_type(&name);
        [(Attribute::ContentType, media_type), (Attribute::CacheControl, "no-cache")]
            .into_iter()
            .collect()
    }

    /// Sends the parts and then completes the file. After a failure, removes the parts.
    async fn in_parts(self, file: File) -> Result<(), Fail> {
        let begun = Instant::now();
        let options = PutMultipartOptions::from(self.attributes());
        let mut upload = self.store.put_multipart_opts(&self.key, options).await?;
        let work = async {
            send(file, &mut *upload).await?;
            upload.complete().await?;
            Ok(())
        };
        let done = tokio::time::timeout(self.settings.total, work).await;
        let fail = match done.unwrap_or(Err(Fail::Slow)) {
            Ok(()) => return Ok(()),
            // The failure is explained now, because the request that removes the parts would then
            // become the last request.
            Err(fail) => Fail::Own(self.explain(fail, begun)),
        };
        let _ = tokio::time::timeout(ABORT, upload.abort()).await;
        Err(fail)
    }
}

/// Returns the media type of a file by the end of its name: the types in the formats'
/// specifications, and types that browsers open.
fn media_type(name: &str) -> &'static str {
    let end = name.rsplit_once('.').map_or("", |(_, end)| end);
    match &*end.to_ascii_lowercase() {
        "htex" => "application/vnd.htex+zip",
        "htexlib" => "application/vnd.htexlib",
        "html" => "text/html; charset=utf-8",
        "json" => "application/json",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "wasm" => "application/wasm",
        "wav" => "audio/wav",
        "svg" => "image/svg+xml",
        "csv" => "text/csv; charset=utf-8",
        _ => "application/octet-stream",
    }
}

/// Sends a file in parts.
async fn send(file: File, upload: &mut dyn MultipartUpload) -> Result<(), Fail> {
    let mut parts = JoinSet::new();
    let sent = send_parts(file, upload, &mut parts).await;
    if sent.is_err() {
        // A part that arrives after the others were removed would stay, so wait for the parts that
        // are still being sent.
        let rest = async { while parts.join_next().await.is_some() {} };
        let _ = tokio::time::timeout(ABORT, rest).await;
    }
    sent
}

/// Sends the parts. Their order is the order of the calls of `put_part`.
async fn send_parts(
    mut file: File,
    upload: &mut dyn MultipartUpload,
    parts: &mut JoinSet<object_store::Result<()>>,
) -> Result<(), Fail> {
    loop {
        let mut part = Vec::new();
        let taken = (&mut file).take(PART_BYTES).read_to_end(&mut part);
        if taken? == 0 {
            break;
        }
        if parts.len() == MOST_AT_ONCE {
            wait(parts).await?;
        }
        parts.spawn(upload.put_part(part.into()));
    }
    while !parts.is_empty() {
        wait(parts).await?;
    }
    Ok(())
}

async fn wait(parts: &mut JoinSet<object_store::Result<()>>) -> Result<(), Fail> {
    match parts.join_next().await {
        None | Some(Ok(Ok(()))) => Ok(()),
        Some(Ok(Err(error))) => Err(error.into()),
        Some(Err(_)) => Err(Fail::Ended),
    }
}
