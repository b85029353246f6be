//! Remote files in object stores and on web servers.

mod addresses;
mod client;
mod explain;
mod log;
mod read;
mod redirects;
mod stores;
mod write;

use std::sync::{Arc, OnceLock, mpsc};
use std::time::{Duration, Instant};

use futures_util::StreamExt;
use object_store::ObjectStore;
use object_store::path::Path;
use tokio::runtime::{Builder, Runtime};

pub(crate) use client::Clients;
pub(crate) use read::Version;

use crate::storage::listing::{self, Entry, MOST_ENTRIES, MOST_LISTED};
use crate::storage::location::Uri;
use crate::storage::{Location, Settings, Stat, StorageError, StorageProblem, Variables};
use addresses::UrlSource;
use explain::Fail;
use log::{Client, Connector, Log};
use redirects::RedirectClient;
use stores::StoreRequest;

/// Number of threads that wait for the network, for all files of the process.
const THREADS: usize = 2;

/// A file in its store.
#[derive(Clone)]
pub(crate) struct Store {
    store: Arc<dyn ObjectStore>,
    key: Path,
    location: Location,
    is_signed: bool,
    settings: Settings,
    log: Arc<Log>,
}

impl Store {
    /// Prepares the store for a location. No request is sent yet.
    pub(crate) fn open(
        location: &Location,
        uri: &Uri,
        (settings, variables, clients): (&Settings, &Variables, &Clients),
        is_of_person: bool,
    ) -> Result<Self, StorageError> {
        let problem = |problem| StorageProblem::Settings { problem }.at_place(location);
        let of = |by| clients.client_for(by, settings).map_err(problem);
        let by = if is_of_person { UrlSource::Person } else { UrlSource::Other };
        // An environment variable names the server of a store, so the user has chosen this server.
        let client = if uri.scheme.is_read_only() {
            Client::Web(RedirectClient { first: of(by)?, world: of(UrlSource::Other)?, by })
        } else {
            Client::Store(of(UrlSource::Person)?)
        };
        let log = Arc::new(Log::default());
        let connector = Connector { client, log: Arc::clone(&log) };
        let parts = StoreRequest { uri, settings, variables, connector };
        let opened = parts.open().map_err(problem)?;
        Ok(Self {
            store: opened.store,
            key: opened.key,
            location: location.clone(),
            is_signed: opened.is_signed,
            settings: settings.clone(),
            log,
        })
    }

    /// Returns the number of requests sent and the number of bytes received in bodies.
    pub(crate) fn usage(&self) -> (u64, u64) {
        (self.log.requests(), self.log.bytes())
    }

    /// Returns the size and version of the file, or `None` if there is no such file.
    pub(crate) fn stat(&self) -> Result<Option<Stat>, StorageError> {
        use object_store::ObjectStoreExt;
        let here = self.clone();
        let found = self.run(async move { Ok(here.store.head(&here.key).await?) });
        match found {
            Ok(meta) => {
                Ok(Some(Stat { bytes: meta.size, modified: modified(&meta), etag: meta.e_tag }))
            }
            Err(error) if matches!(error.problem, StorageProblem::Missing) => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// Removes the file, if there is one.
    pub(crate) fn remove(&self) -> Result<(), StorageError> {
        use object_store::ObjectStoreExt;
        let here = self.clone();
        let removed = self.run(async move { Ok(here.store.delete(&here.key).await?) });
        match removed {
            Err(error) if matches!(error.problem, StorageProblem::Missing) => Ok(()),
            other => other,
        }
    }

    /// Returns the files below a key whose relative names match a pattern.
    pub(crate) fn list(&self, pattern: glob::Pattern) -> Result<Vec<Entry>, StorageError> {
        let here = self.clone();
        self.run(async move {
            let mut found = Vec::new();
            let mut all = here.store.list(Some(&here.key));
            let mut listed = 0;
            while let Some(meta) = all.next().await {
                let meta = meta?;
                listed += 1;
                // Files that do not match cost requests too, so they are limited separately.
                if listed > MOST_LISTED {
                    return Err(Fail::Own(listing::too_many(&here.location)));
                }
                let name = meta.location.as_ref();
                let prefix = here.key.as_ref();
                let relative = name.strip_prefix(prefix).unwrap_or(name).trim_start_matches('/');
                if !listing::matches(&pattern, relative) {
                    continue;
                }
                if found.len() == MOST_ENTRIES {
                    return Err(Fail::Own(listing::too_many(&here.location)));
                }
                found.push(Entry {
                    location: here.location.with_key(name),
                    bytes: meta.size,
                    modified: modified(&meta),
                    etag: meta.e_tag,
                });
            }
            Ok(found)
        })
    }

    /// Runs requests on the runtime and waits for them, at most for [`Settings::total`].
    fn run<T: Send + 'static>(
        &self,
        work: impl Future<Output = Result<T, Fail>> + Send + 'static,
    ) -> Result<T, StorageError> {
        self.run_within(self.settings.total, work)
    }

    fn run_within<T: Send + 'static>(
        &self,
        limit: Duration,
        work: impl Future<Output = Result<T, Fail>> + Send + 'static,
    ) -> Result<T, StorageError> {
        let begun = Instant::now();
        let (send, receive) = mpsc::sync_channel(1);
        // The caller may itself be a task, where blocking on the runtime would panic. So the thread
        // waits for a channel.
        runtime(&self.location)?.spawn(async move {
            let done = tokio::time::timeout(limit, work).await;
            let _ = send.send(done.unwrap_or(Err(Fail::Slow)));
        });
        let done = receive.recv().unwrap_or(Err(Fail::Ended));
        done.map_err(|fail| self.explain(fail, begun))
    }
}

/// Returns the runtime that all files of the process share.
fn runtime(location: &Location) -> Result<&'static Runtime, StorageError> {
    static RUNTIME: OnceLock<Result<Runtime, String>> = OnceLock::new();
    let runtime = RUNTIME.get_or_init(|| {
        let mut builder = Builder::new_multi_thread();
        builder.worker_threads(THREADS).thread_name("htex-base");
        builder.enable_all().build().map_err(|error| error.to_string())
    });
    runtime.as_ref().map_err(|error| {
        let problem = format!("no threads for the network: {error}");
        StorageProblem::Settings { problem }.at_place(location)
    })
}

/// Returns the time when a file last changed, or `None` if the store does not state it. The library
/// then gives 1970.
fn modified(meta: &object_store::ObjectMeta) -> Option<std::time::SystemTime> {
    let milliseconds = u64::try_from(meta.last_modified.timestamp_millis()).ok();
    let since = Duration::from_millis(milliseconds.filter(|ms| *ms > 0)?);
    std::time::UNIX_EPOCH.checked_add(since)
}
