//! Follows the redirects of web servers, if they lead to allowed addresses.

use http::{HeaderMap, Method, Response, StatusCode, header};
use object_store::client::{HttpError, HttpErrorKind, HttpRequest, HttpResponse, HttpService};
use reqwest::Url;

use super::addresses::{INNER, RedirectRefusal, UrlSource, is_inner_number};

/// Largest number of redirects for one request.
const MOST_REDIRECTS: usize = 5;

/// The clients for requests to a web server.
#[derive(Debug, Clone)]
pub(super) struct RedirectClient {
    /// Client for the server that was named.
    pub(super) first: reqwest::Client,
    /// Client for the servers to which that server redirects.
    pub(super) world: reqwest::Client,
    /// The source of the server's address.
    pub(super) by: UrlSource,
}

impl RedirectClient {
    /// Sends a request and follows its redirects. Does not follow a redirect from HTTPS to HTTP, or
    /// to an address of this machine or network, except on the same server. A request has no
    /// `Referer` header, because the query of the first URL may be a signature.
    pub(super) async fn call(&self, request: HttpRequest) -> Result<HttpResponse, HttpError> {
        let (method, headers) = (request.method().clone(), request.headers().clone());
        let first = url(&request.uri().to_string())?;
        if self.by == UrlSource::Other {
            check_number(&first)?;
        }
        let mut at = first.clone();
        let mut response = self.first.call(request).await?;
        for _ in 0..MOST_REDIRECTS {
            let Some(to) = target(&method, &at, &response)? else {
                return Ok(response);
            };
            // Only the named server itself may be in the user's network. A redirect may also lead
            // back to it.
            let is_first = to.origin() == first.origin();
            if !is_first {
                check_number(&to)?;
            }
            let client = if is_first { &self.first } else { &self.world };
            response = client.call(again(&method, &to, &headers)?).await?;
            at = to;
        }
        match target(&method, &at, &response)? {
            None => Ok(response),
            Some(_) => Err(refused("it redirects more than five times")),
        }
    }
}

/// Returns the URL to which a response redirects.
fn target(
    method: &Method,
    at: &Url,
    response: &Response<impl Sized>,
) -> Result<Option<Url>, HttpError> {
    let is_read = *method == Method::GET || *method == Method::HEAD;
    let moved = matches!(
        response.status(),
        StatusCode::MOVED_PERMANENTLY
            | StatusCode::FOUND
            | StatusCode::SEE_OTHER
            | StatusCode::TEMPORARY_REDIRECT
            | StatusCode::PERMANENT_REDIRECT
    );
    let Some(to) = response.headers().get(header::LOCATION).filter(|_| moved && is_read) else {
        return Ok(None);
    };
    let to = to.to_str().ok().and_then(|to| at.join(to).ok());
    let to = to.ok_or_else(|| refused("it redirects to what is no URL"))?;
    match (at.scheme(), to.scheme()) {
        (_, "https") | ("http", "http") => Ok(Some(to)),
        ("https", "http") => {
            Err(refused("it redirects from HTTPS to HTTP; name the other URL if you mean it"))
        }
        _ => Err(refused("it redirects to another protocol")),
    }
}

/// Creates the request to the address of the redirect.
fn again(method: &Method, to: &Url, headers: &HeaderMap) -> Result<HttpRequest, HttpError> {
    let mut request = http::Request::builder().method(method).uri(to.as_str());
    for (name, value) in headers.iter().filter(|(name, _)| is_kept(name)) {
        request = request.header(name, value);
    }
    let body = object_store::client::HttpRequestBody::empty();
    request.body(body).map_err(|_| refused("it redirects to what is no URL"))
}

/// Returns whether a header is sent again after a redirect. Only headers about the file are sent
/// again, because all other headers are meant for one server.
fn is_kept(name: &header::HeaderName) -> bool {
    [
        header::RANGE,
        header::IF_MATCH,
        header::IF_NONE_MATCH,
        header::IF_MODIFIED_SINCE,
        header::IF_UNMODIFIED_SINCE,
        header::ACCEPT,
        header::USER_AGENT,
    ]
    .contains(name)
}

fn check_number(url: &Url) -> Result<(), HttpError> {
    if url.host_str().is_none_or(is_inner_number) { Err(refused(INNER)) } else { Ok(()) }
}

fn url(text: &str) -> Result<Url, HttpError> {
    text.parse().map_err(|_| refused("it is no URL"))
}

/// Creates the error for a refusal by this client. A retry would not help.
fn refused(reason: &'static str) -> HttpError {
    HttpError::new(HttpErrorKind::Unknown, RedirectRefusal(reason))
}
