//! A web server on loopback for tests, in the process of the test: an S3-compatible store (the
//! crates `s3s` and `s3s-fs`) with signatures. The files in the bucket `web` can also be read
//! without them. It records its requests, and fails them as a test specifies.
//!
//! ```
//! use htex_object_server::{Fault, Server};
//!
//! let server = Server::start();
//! server.put("surfaces/cloth.htex", b"...");
//! server.fail(|n, _| if n < 2 { Fault::Status(503, "SlowDown") } else { Fault::None });
//! assert!(server.requests().is_empty());
//! ```
#![forbid(unsafe_code)]
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

mod body;

use std::collections::BTreeSet;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use bytes::Bytes;
use http::{Request, Response};
use http_body_util::{BodyExt, Full};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::TokioIo;
use s3s::auth::SimpleAuth;
use s3s::service::{S3Service, S3ServiceBuilder};
use s3s_fs::FileSystem;
use tempfile::TempDir;
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::Runtime;

use body::{AnyBody, Faulty};

/// The key that the server knows.
pub const ACCESS_KEY: &str = "AKIDHTEXTEST";
/// Its secret. Tests search messages for it.
pub const SECRET_KEY: &str = "sEcReT-of-the-htex-test";

/// What happens to a request.
#[derive(Debug, Clone, PartialEq)]
pub enum Fault {
    /// The request is answered normally.
    None,
    /// It is refused with this status and an error code. As in S3, the error document quotes the
    /// request.
    Status(u16, &'static str),
    /// It is answered later.
    Delay(Duration),
    /// The connection ends after this many bytes of the response's body.
    Cut(u64),
    /// Nothing more comes after this many bytes of the response's body.
    Stall(u64),
    /// The connection ends after this many bytes of the request's body.
    CutRequest(u64),
    /// It arrives without its signature.
    Unsigned,
    /// It is redirected to this URL.
    Redirect(String),
    /// It is answered without the header `ETag`.
    WithoutTag,
    /// As `WithoutTag`, and the connection ends after this many bytes of the response's
    /// body.
    CutWithoutTag(u64),
    /// It arrives without the header `Range`, as on a server that does not support ranges.
    Whole,
}

/// A request as it arrived.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// `GET`, `PUT`, …
    pub method: String,
    /// Path and query.
    pub path: String,
    /// The header `Range`.
    pub range: Option<String>,
    /// Whether it was signed.
    pub is_signed: bool,
    /// The headers `Content-Type` and `Cache-Control` of written files.
    pub content_type: Option<String>,
    pub cache_control: Option<String>,
    /// The header `Referer`.
    pub referer: Option<String>,
}

type Rule = Box<dyn Fn(usize, &Seen) -> Fault + Send + Sync>;

/// A server. It ends when it is dropped.
pub struct Server {
    address: SocketAddr,
    folder: TempDir,
    shared: Arc<Shared>,
    runtime: Option<Runtime>,
}

struct Shared {
    signed: S3Service,
    open: S3Service,
    seen: Mutex<Vec<Seen>>,
    /// Path and status of each answer.
    answered: Mutex<Vec<(String, u16)>>,
    /// The rule, and the number of requests since it was set.
    rule: Mutex<(Rule, usize)>,
}

impl Server {
    /// Starts on a free port, with the empty buckets `surfaces` and `web`.
    pub fn start() -> Self {
        Self::start_after(Duration::ZERO)
    }

    /// Starts on a free port. It refuses connections for this time, like a server that restarts.
    pub fn start_after(time: Duration) -> Self {
        let folder = TempDir::new().unwrap();
        for bucket in ["surfaces", "web"] {
            std::fs::create_dir(folder.path().join(bucket)).unwrap();
        }
        let shared = Arc::new(Shared {
            signed: service(folder.path(), true),
            open: service(folder.path(), false),
            seen: Mutex::default(),
            answered: Mutex::default(),
            rule: Mutex::new((Box::new(|_, _| Fault::None), 0)),
        });
        let runtime = Runtime::new().unwrap();
        let listener = runtime.block_on(TcpListener::bind("127.0.0.1:0")).unwrap();
        let address = listener.local_addr().unwrap();
        let accepting = Arc::clone(&shared);
        runtime.spawn(async move {
            let listener = if time.is_zero() {
                listener
            } else {
                drop(listener);
                tokio::time::sleep(time).await;
                TcpListener::bind(address).await.unwrap()
            };
            accept(listener, accepting).await;
        });
        Self { address, folder, shared, runtime: Some(runtime) }
    }

    /// The endpoint, `http://127.0.0.1:PORT`.
    pub fn url(&self) -> String {
        format!("http://{}", self.address)
    }

    /// The environment variables for this server.
    pub fn variables(&self) -> Vec<(&'static str, String)> {
        vec![
            ("AWS_ACCESS_KEY_ID", ACCESS_KEY.to_owned()),
            ("AWS_SECRET_ACCESS_KEY", SECRET_KEY.to_owned()),
            ("AWS_ENDPOINT_URL", self.url()),
            ("AWS_ALLOW_HTTP", "true".to_owned()),
            ("AWS_REGION", "us-east-1".to_owned()),
        ]
    }

    /// Stores a file, `BUCKET/KEY`, without a request.
    pub fn put(&self, name: &str, bytes: impl AsRef<[u8]>) {
        let path = self.path(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }

    /// The bytes of `BUCKET/KEY`, if the file exists.
    pub fn get(&self, name: &str) -> Option<Vec<u8>> {
        std::fs::read(self.path(name)).ok()
    }

    /// Every file that the server stores, including parts of unfinished ones.
    pub fn files(&self) -> BTreeSet<String> {
        let mut found = BTreeSet::new();
        let mut open = vec![self.folder.path().to_owned()];
        while let Some(folder) = open.pop() {
            for entry in std::fs::read_dir(folder).unwrap().map(Result::unwrap) {
                if entry.file_type().unwrap().is_dir() {
                    open.push(entry.path())
                } else {
                    let path = entry.path();
                    let name = path.strip_prefix(self.folder.path()).unwrap();
                    found.insert(name.to_str().unwrap().to_owned());
                }
            }
        }
        found
    }

    /// Applies these faults to all following requests. The function receives the number of requests
    /// since this call.
    pub fn fail(&self, rule: impl Fn(usize, &Seen) -> Fault + Send + Sync + 'static) {
        *self.shared.rule.lock().unwrap() = (Box::new(rule), 0);
        self.shared.seen.lock().unwrap().clear();
        self.shared.answered.lock().unwrap().clear();
    }

    /// Paths and statuses of the answers since the last call of [`Self::fail`].
    pub fn answers(&self) -> Vec<(String, u16)> {
        self.shared.answered.lock().unwrap().clone()
    }

    /// The requests since the last call of [`Self::fail`].
    pub fn requests(&self) -> Vec<Seen> {
        self.shared.seen.lock().unwrap().clone()
    }

    /// Where `BUCKET/KEY` is stored.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(runtime) = self.runtime.take() {
            runtime.shutdown_background();
        }
    }
}

fn service(folder: &Path, is_signed: bool) -> S3Service {
    let mut builder = S3ServiceBuilder::new(FileSystem::new(folder).unwrap());
    if is_signed {
        builder.set_auth(SimpleAuth::from_single(ACCESS_KEY, SECRET_KEY));
    }
    builder.build()
}

async fn accept(listener: TcpListener, shared: Arc<Shared>) {
    while let Ok((socket, _)) = listener.accept().await {
        tokio::spawn(serve(socket, Arc::clone(&shared)));
    }
}

async fn serve(socket: TcpStream, shared: Arc<Shared>) {
    let answer = service_fn(move |request| {
        let shared = Arc::clone(&shared);
        async move { shared.answer(request).await }
    });
    // A connection that a fault cuts ends with an error here.
    let _ = http1::Builder::new().serve_connection(TokioIo::new(socket), answer).await;
}

/// The error that ends a connection.
#[derive(Debug)]
struct Cut;

impl std::fmt::Display for Cut {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("cut by the test")
    }
}

impl std::error::Error for Cut {}

impl Shared {
    async fn answer(&self, mut request: Request<Incoming>) -> Result<Response<AnyBody>, Cut> {
        match self.fault_of(&request) {
            Fault::None => self.store(request).await,
            Fault::Status(status, code) => Ok(refusal(status, code, &request)),
            Fault::Delay(time) => {
                tokio::time::sleep(time).await;
                self.store(request).await
            }
            Fault::Cut(bytes) => Ok(self.store(request).await?.map(|b| Faulty::cut(b, bytes))),
            Fault::Stall(bytes) => Ok(self.store(request).await?.map(|b| Faulty::stall(b, bytes))),
            Fault::CutRequest(bytes) => {
                let mut taken = 0;
                while let (true, Some(Ok(frame))) = (taken < bytes, request.frame().await) {
                    taken += frame.data_ref().map_or(0, |data| data.len() as u64);
                }
                Err(Cut)
            }
            Fault::Unsigned => {
                request.headers_mut().remove("authorization");
                self.store(request).await
            }
            Fault::Redirect(to) => {
                let redirect = Response::builder().status(302).header("location", to);
                Ok(redirect.body(body::of(Full::new(Bytes::new()))).unwrap())
            }
            Fault::WithoutTag => Ok(without_tag(self.store(request).await?)),
            Fault::CutWithoutTag(bytes) => {
                let response = without_tag(self.store(request).await?);
                Ok(response.map(|b| Faulty::cut(b, bytes)))
            }
            Fault::Whole => {
                request.headers_mut().remove("range");
                self.store(request).await
            }
        }
    }

    /// Records the request and applies the rule.
    fn fault_of(&self, request: &Request<Incoming>) -> Fault {
        let range = request.headers().get("range");
        let header = |name: &str| {
            let value = request.headers().get(name);
            value.map(|value| value.to_str().unwrap().to_owned())
        };
        let seen = Seen {
            method: request.method().to_string(),
            path: request.uri().to_string(),
            range: range.map(|range| range.to_str().unwrap().to_owned()),
            is_signed: request.headers().contains_key("authorization"),
            content_type: header("content-type"),
            cache_control: header("cache-control"),
            referer: header("referer"),
        };
        let (rule, count) = &mut *self.rule.lock().unwrap();
        let fault = rule(*count, &seen);
        *count += 1;
        self.seen.lock().unwrap().push(seen);
        fault
    }

    async fn store(&self, request: Request<Incoming>) -> Result<Response<AnyBody>, Cut> {
        let path = request.uri().path().to_owned();
        let is_signed = request.headers().contains_key("authorization");
        let service =
            if path.starts_with("/web/") && !is_signed { &self.open } else { &self.signed };
        let response = Service::call(service, request).await.map_err(|_| Cut)?;
        let status = response.status().as_u16();
        self.answered.lock().unwrap().push((path, status));
        Ok(response.map(body::of))
    }
}

fn without_tag(mut response: Response<AnyBody>) -> Response<AnyBody> {
    response.headers_mut().remove("etag");
    response
}

/// An error document that quotes the request's signature, as S3 does.
fn refusal(status: u16, code: &str, request: &Request<Incoming>) -> Response<AnyBody> {
    let signature = request.headers().get("authorization");
    let signature = signature.map_or("", |signature| signature.to_str().unwrap());
    let text = format!(
        "<?xml version=\"1.0\"?><Error><Code>{code}</Code><Message>by the test</Message>\
         <AWSAccessKeyId>{ACCESS_KEY}</AWSAccessKeyId><SignatureProvided>{signature}</SignatureProvided></Error>"
    );
    let response = Response::builder().status(status).header("content-type", "application/xml");
    response.body(body::of(Full::new(Bytes::from(text)))).unwrap()
}
