//! Counts the requests for a file, and remembers how the last request ended, for use in error
//! messages.
//!
//! This module is a layer between the crate `object_store` and the HTTP client. The crate retries
//! requests, and its errors do not say how the last request ended. Therefore this layer remembers
//! how the last request ended.

use std::error::Error;
use std::pin::Pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll, ready};

use async_trait::async_trait;
use bytes::Bytes;
use http_body::{Body, Frame};
use http_body_util::{BodyExt, Limited};
use object_store::ClientOptions;
use object_store::client::{
    HttpClient, HttpConnector, HttpError, HttpErrorKind, HttpRequest, HttpResponse,
    HttpResponseBody, HttpService,
};

use super::addresses::RedirectRefusal;
use super::redirects::RedirectClient;

/// Largest part of a refusal's body that is read to find its code, bytes.
const MOST_REFUSAL_BYTES: usize = 65_536;

/// Record of the requests and responses for a file.
#[derive(Debug, Default)]
pub(crate) struct Log {
    requests: AtomicU64,
    bytes: AtomicU64,
    last: Mutex<Last>,
}

/// The end of the last request.
#[derive(Debug, Default, Clone)]
pub(crate) enum Last {
    #[default]
    Nothing,
    Status {
        status: u16,
        /// The server's error code, such as `NoSuchKey`.
        code: Option<String>,
    },
    /// No response, or only a part of one.
    Cut(String),
    /// The client refused to follow a redirect, or to connect.
    RedirectRefusal(&'static str),
}

impl Log {
    pub(crate) fn requests(&self) -> u64 {
        self.requests.load(Ordering::Relaxed)
    }

    /// Returns the number of bytes received in response bodies.
    pub(crate) fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    pub(crate) fn last(&self) -> Last {
        self.last.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn ended(&self, last: Last) {
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = last;
    }

    fn failed(&self, error: &HttpError) {
        self.ended(cause(error));
    }
}

/// Returns the deepest cause, which contains neither a URL nor a header.
fn cause(error: &HttpError) -> Last {
    let mut cause: &(dyn Error + 'static) = error;
    while let Some(source) = cause.source() {
        cause = source;
    }
    if let Some(RedirectRefusal(reason)) = cause.downcast_ref() {
        return Last::RedirectRefusal(reason);
    }
    let text = cause.to_string();
    Last::Cut(if text.is_empty() || text.contains("://") {
        "the connection failed".to_owned()
    } else {
        text
    })
}

/// Largest response to a list request, bytes. A page with 1,000 keys of 1,024 bytes has at most 3
/// MB including its escapes.
const MOST_LIST_BYTES: usize = 16 << 20;

/// The client that sends requests.
#[derive(Debug, Clone)]
pub(crate) enum Client {
    /// Sends requests with credentials to a store that the environment variables configure. Does
    /// not follow redirects.
    Store(reqwest::Client),
    Web(RedirectClient),
}

impl Client {
    async fn call(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        match self {
            Self::Store(client) => HttpService::call(client, request).await,
            Self::Web(following) => following.call(request).await,
        }
        .map_err(|error| match cause(&error) {
            // A retry would not lead anywhere else.
            Last::RedirectRefusal(reason) => {
                HttpError::new(HttpErrorKind::Unknown, RedirectRefusal(reason))
            }
            _ => error,
        })
    }
}

/// Connects a store with a client whose requests are logged.
#[derive(Debug)]
pub(crate) struct Connector {
    pub(crate) client: Client,
    pub(crate) log: Arc<Log>,
}

impl HttpConnector for Connector {
    fn connect(&self, _: &ClientOptions) -> object_store::Result<HttpClient> {
        Ok(HttpClient::new(LoggingClient {
            client: self.client.clone(),
            log: Arc::clone(&self.log),
        }))
    }
}

#[derive(Debug)]
struct LoggingClient {
    client: Client,
    log: Arc<Log>,
}

impl LoggingClient {
    /// Returns whether a request lists a store, so that its response is read into memory. S3 and
    /// Google use `list-type`, Azure uses `comp`.
    fn is_list(&self, request: &HttpRequest) -> bool {
        let query = request.uri().query().unwrap_or_default();
        let is = |part: &str| part.starts_with("list-type=") || part == "comp=list";
        // The query in the URL of a web server comes from the user and may contain anything.
        matches!(self.client, Client::Store(_)) && query.split('&').any(is)
    }
}

/// Returns a body that ends with an error if it is larger than [`MOST_LIST_BYTES`].
fn bounded(body: HttpResponseBody) -> HttpResponseBody {
    let limited = Limited::new(body, MOST_LIST_BYTES);
    let too_long = |_| HttpError::new(HttpErrorKind::Decode, RedirectRefusal(LONG_LIST));
    HttpResponseBody::new(limited.map_err(too_long))
}

const LONG_LIST: &str = "a page of its list has more than 16 MiB, which none has";

#[async_trait]
impl HttpService for LoggingClient {
    async fn call(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        self.log.requests.fetch_add(1, Ordering::Relaxed);
        let is_list = self.is_list(&request);
        let response =
            self.client.call(request).await.inspect_err(|error| self.log.failed(error))?;
        let (parts, body) = response.into_parts();
        let status = parts.status.as_u16();
        if parts.status.is_success() {
            self.log.ended(Last::Status { status, code: None });
            let log = Arc::clone(&self.log);
            let body = if is_list { bounded(body) } else { body };
            let body = HttpResponseBody::new(LoggingBody { body, log });
            return Ok(HttpResponse::from_parts(parts, body));
        }
        // If the body of a refusal cannot be read to its end, the refusal has no code.
        let text = Limited::new(body, MOST_REFUSAL_BYTES).collect().await;
        let text = text.map(|text| text.to_bytes()).unwrap_or_default();
        let named = parts
            .headers
            .get("x-ms-error-code")
            .and_then(|code| Some(code.to_str().ok()?.to_owned()));
        let code = named.or_else(|| code_in(&text)).filter(|code| is_code(code));
        self.log.ended(Last::Status { status, code });
        // The body was consumed to find the code, and the library reads it again.
        Ok(HttpResponse::from_parts(parts, text.into()))
    }
}

/// Returns the `<Code>` in an error document of S3 and similar stores.
fn code_in(document: &[u8]) -> Option<String> {
    let text = std::str::from_utf8(document).ok()?;
    let (_, rest) = text.split_once("<Code>")?;
    Some(rest.split_once("</Code>")?.0.to_owned())
}

/// Returns whether a word may be shown. The rest of the document may not, because it may quote the
/// request including its signature.
fn is_code(word: &str) -> bool {
    (1..=48).contains(&word.len()) && word.chars().all(|c| c.is_ascii_alphabetic())
}

/// A body that logs its bytes and failures.
struct LoggingBody {
    body: HttpResponseBody,
    log: Arc<Log>,
}

impl Body for LoggingBody {
    type Data = Bytes;
    type Error = HttpError;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, HttpError>>> {
        let frame = ready!(Pin::new(&mut self.body).poll_frame(context));
        match &frame {
            Some(Ok(frame)) => {
                let bytes = frame.data_ref().map_or(0, Bytes::len);
                self.log.bytes.fetch_add(bytes as u64, Ordering::Relaxed);
            }
            Some(Err(error)) => self.log.failed(error),
            None => {}
        }
        Poll::Ready(frame)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> http_body::SizeHint {
        self.body.size_hint()
    }
}
