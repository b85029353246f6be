//! The server of a page. It listens only on 127.0.0.1.
//!
//! Any program on this machine may connect, but other programs cannot delay the tab that owns the
//! page. `hyper` runs in a separate runtime with one thread. It passes each request to the gate
//! before the request's body arrives. The gate decides from the head of the request whether to
//! refuse it. The server then reads the body, up to 4096 bytes. Head and body each have a deadline
//! of one second. At most 64 connections are open. If 64 connections are open, a new connection
//! replaces the oldest connection whose requests have not passed the gate. If all connections have
//! passed it, the new connection replaces the oldest one.
//!
//! `hyper` is already a dependency of the command, because remote stores use it. `tiny_http` would
//! read a request's body before the gate could refuse the request. It also has no deadlines, and
//! uses a thread for each connection.

use std::collections::VecDeque;
use std::convert::Infallible;
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use http_body_util::{BodyExt, Full, Limited};
use hyper::body::{Body, Bytes, Incoming};
use hyper::header::{CONNECTION, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use serde_json::Value;
use tokio::net::TcpStream;
use tokio::sync::oneshot;
use tokio::task::AbortHandle;
use tokio::time::{sleep, timeout};

use super::gate::{Gate, Owner, PageRequest, Refusal};
use crate::error::LabError;
use crate::page::Content;

/// Largest number of open connections.
const MOST_CONNECTIONS: usize = 64;
/// Longest wait for the head of a request, and also for its body. The limit also applies to the
/// next request on the same connection.
const PATIENCE: Duration = Duration::from_secs(1);
/// Longest body of a request, bytes.
const MOST_BYTES: usize = 4096;
/// Largest size of a head in bytes (`hyper` accepts no smaller limit), and largest number of lines
/// of a head.
const MOST_HEAD_BYTES: usize = 8192;
const MOST_HEADERS: usize = 64;
/// Wait after a failure to accept a connection, such as too many open files.
const PAUSE: Duration = Duration::from_millis(10);
/// Longest wait at the end of a session until the page shows that everything is done.
const FAREWELL: Duration = Duration::from_secs(2);

/// Requests that every page takes.
const STATE: &str = "state";
const LEAVE: &str = "leave";
const STOP: &str = "stop";

const TEXT: &str = "text/plain; charset=utf-8";
/// Headers of each reply. With `same-origin`, requests of the page state the page's origin.
const HEADERS: [(&str, &str); 4] = [
    ("Cache-Control", "no-store"),
    ("Referrer-Policy", "same-origin"),
    ("X-Frame-Options", "DENY"),
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'; img-src data:",
    ),
];

/// A page that is served as long as this value lives.
pub(crate) struct LocalPage {
    owner: Arc<Owner>,
    urls: Vec<String>,
    /// Stops when it is dropped.
    _server: Server,
}

/// A server that runs as long as this value lives.
pub(super) struct Server {
    /// Stops the server when it is dropped.
    end: Option<oneshot::Sender<Infallible>>,
    thread: Option<JoinHandle<()>>,
}

/// Answers requests.
pub(super) trait Answers: Send + Sync + 'static {
    /// Returns the reply to a request. `is_known` must be set once the request has passed the gate.
    fn answer(
        &self,
        request: Request<Incoming>,
        is_known: &AtomicBool,
    ) -> impl Future<Output = Result<Response<Full<Bytes>>, Refusal>> + Send;
}

/// State that all connections share.
struct Desk<C> {
    gate: Gate,
    owner: Arc<Owner>,
    content: Arc<C>,
    requests: Vec<&'static str>,
}

/// An open connection.
struct Guest {
    task: AbortHandle,
    /// Whether one of its requests has passed the gate.
    is_known: Arc<AtomicBool>,
}

impl LocalPage {
    /// Serves a page on this machine. Port 0 means any free port.
    ///
    /// # Errors
    /// Returns an error if the port is taken, or if the system provides no random numbers.
    pub(crate) fn open<C: Content>(port: u16, content: Arc<C>) -> Result<Self, LabError> {
        let (listener, own_port) = listen(port).map_err(|error| page_error(port, error))?;
        let mut random = [[0u8; 16]; 2];
        for bytes in &mut random {
            getrandom::fill(bytes).map_err(|error| page_error(port, error))?;
        }
        let [token, name] = random.map(|bytes| hexadecimal(&bytes));
        let owner = Arc::new(Owner::default());
        let desk = Desk {
            gate: Gate::new(&token, &name, own_port, port != 0),
            owner: Arc::clone(&owner),
            content,
            requests: [&[STATE, LEAVE, STOP], C::REQUESTS].concat(),
        };
        let urls = desk.gate.urls();
        let server = Server::start(listener, Arc::new(desk));
        Ok(Self { owner, urls, _server: server.map_err(|error| page_error(port, error))? })
    }

    /// Returns the text that tells the user which address to open.
    pub(crate) fn address(&self) -> String {
        match &self.urls[..] {
            [url, by_number] => format!(
                "{url} in a browser of this machine; one that does not find that name, such as Safari, opens {by_number}"
            ),
            urls => format!("{} in a browser of this machine", urls.join(" ")),
        }
    }

    /// Waits until the page has received its final state, if a tab owns the page.
    pub(crate) fn wait_for_end(&self, is_shown: impl Fn() -> bool) {
        let start = Instant::now();
        while start.elapsed() < FAREWELL && self.owner.is_there() && !is_shown() {
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// Returns the error for a page that cannot be served at the requested port.
pub(super) fn page_error(port: u16, error: impl ToString) -> LabError {
    LabError::Page { port, problem: error.to_string() }
}

pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Starts to listen, only for this machine. Also returns the port.
pub(super) fn listen(port: u16) -> std::io::Result<(TcpListener, u16)> {
    let listener = TcpListener::bind(("127.0.0.1", port))?;
    listener.set_nonblocking(true)?;
    let port = listener.local_addr()?.port();
    Ok((listener, port))
}

impl Server {
    /// Answers connections in its own thread.
    pub(super) fn start<A: Answers>(
        listener: TcpListener,
        answers: Arc<A>,
    ) -> std::io::Result<Self> {
        let runtime =
            tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
        let (end, ended) = oneshot::channel();
        let serving = move || {
            runtime.block_on(async {
                let server = tokio::spawn(serve(listener, answers));
                let _ = ended.await;
                server.abort();
            });
            // When the runtime is dropped, all connections end, even those that wait for something.
        };
        let thread = std::thread::Builder::new().name("htex-page".to_owned()).spawn(serving)?;
        Ok(Self { end: Some(end), thread: Some(thread) })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Accepts connections, at most [`MOST_CONNECTIONS`] at a time.
async fn serve<A: Answers>(listener: TcpListener, desk: Arc<A>) {
    let Ok(listener) = tokio::net::TcpListener::from_std(listener) else {
        return;
    };
    let mut guests: VecDeque<Guest> = VecDeque::new();
    loop {
        let Ok((socket, _)) = listener.accept().await else {
            sleep(PAUSE).await;
            continue;
        };
        guests.retain(|guest| !guest.task.is_finished());
        if guests.len() >= MOST_CONNECTIONS {
            // If all connections have passed the gate, the oldest one is closed.
            let is_stranger = |guest: &Guest| !guest.is_known.load(Ordering::Relaxed);
            let leaves = guests.iter().position(is_stranger).unwrap_or(0);
            if let Some(guest) = guests.remove(leaves) {
                guest.task.abort();
            }
        }
        let is_known = Arc::new(AtomicBool::new(false));
        let attending = attend(socket, Arc::clone(&desk), Arc::clone(&is_known));
        let task = tokio::spawn(attending).abort_handle();
        guests.push_back(Guest { task, is_known });
        // Gives the new connection time to be processed before another connection can replace it.
        tokio::task::yield_now().await;
    }
}

/// Answers the requests of a connection.
async fn attend<A: Answers>(socket: TcpStream, desk: Arc<A>, is_known: Arc<AtomicBool>) {
    // Otherwise the system may delay a reply by 40 ms.
    let _ = socket.set_nodelay(true);
    let service = service_fn(|request| async {
        let reply = desk.answer(request, &is_known).await;
        Ok::<_, Infallible>(reply.unwrap_or_else(refused))
    });
    // A tab that is gone needs no reply, so an error does not matter.
    let _ = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(PATIENCE)
        .max_headers(MOST_HEADERS)
        .max_buf_size(MOST_HEAD_BYTES)
        .serve_connection(TokioIo::new(socket), service)
        .await;
}

impl<C: Content> Answers for Desk<C> {
    async fn answer(
        &self,
        request: Request<Incoming>,
        is_known: &AtomicBool,
    ) -> Result<Response<Full<Bytes>>, Refusal> {
        let (head, body) = request.into_parts();
        let asked = self.gate.admit(&head, &self.requests)?;
        is_known.store(true, Ordering::Relaxed);
        let name = match asked {
            PageRequest::Page => {
                return Ok(reply(StatusCode::OK, "text/html; charset=utf-8", C::HTML));
            }
            PageRequest::Request(name) => name,
        };
        let body = read(body).await?;
        // Anyone who has the address may stop the session, whichever tab owns the page.
        if name == STOP {
            self.content.handle(STOP, &body);
        }
        let tab = body.get("tab").and_then(Value::as_str).unwrap_or_default();
        if !self.owner.admits(tab) {
            return Err((StatusCode::CONFLICT, "the session is open in another tab"));
        }
        match &name[..] {
            LEAVE => self.owner.leave(),
            STATE | STOP => {}
            name => self.content.handle(name, &body),
        }
        let state = self.content.state().to_string();
        Ok(reply(StatusCode::OK, "application/json", state))
    }
}

/// Reads the body of a request. It must be short and arrive within the deadline. A body that is not
/// JSON counts as null.
async fn read(body: Incoming) -> Result<Value, Refusal> {
    let too_long = (StatusCode::PAYLOAD_TOO_LARGE, "the request is too long");
    // The head states the length of the body, so a body that is too long is not read at all.
    if body.size_hint().lower() > MOST_BYTES as u64 {
        return Err(too_long);
    }
    let whole = timeout(PATIENCE, Limited::new(body, MOST_BYTES).collect()).await;
    let late = (StatusCode::REQUEST_TIMEOUT, "the request is incomplete");
    let body = whole.map_err(|_| late)?.map_err(|_| too_long)?;
    Ok(serde_json::from_slice(&body.to_bytes()).unwrap_or_default())
}

fn reply(code: StatusCode, kind: &'static str, body: impl Into<Bytes>) -> Response<Full<Bytes>> {
    let mut response = Response::new(Full::new(body.into()));
    *response.status_mut() = code;
    let headers = response.headers_mut();
    headers.insert("Content-Type", HeaderValue::from_static(kind));
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

/// Returns the reply to a refused request. The connection is closed afterwards, because the body
/// was not read.
fn refused((code, why): Refusal) -> Response<Full<Bytes>> {
    let mut response = reply(code, TEXT, why);
    let close = HeaderValue::from_static("close");
    response.headers_mut().insert(CONNECTION, close);
    response
}
