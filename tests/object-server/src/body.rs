//! HTTP bodies that break off.

use std::error::Error;
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use bytes::Bytes;
use http_body::{Body, Frame, SizeHint};
use http_body_util::BodyExt;
use http_body_util::combinators::UnsyncBoxBody;

use crate::Cut;

pub(crate) type AnyBody = UnsyncBoxBody<Bytes, Box<dyn Error + Send + Sync>>;

/// A body of any kind.
pub(crate) fn of<B>(body: B) -> AnyBody
where
    B: Body<Data = Bytes> + Send + 'static,
    B::Error: Into<Box<dyn Error + Send + Sync>>,
{
    body.map_err(Into::into).boxed_unsync()
}

/// A body that ends early. Its stated length stays.
pub(crate) struct Faulty {
    body: AnyBody,
    rest: u64,
    is_stalled: bool,
}

impl Faulty {
    /// Fails with an error after this many bytes, which ends the connection.
    pub(crate) fn cut(body: AnyBody, bytes: u64) -> AnyBody {
        Self::boxed(body, bytes, false)
    }

    /// Sends nothing more after this many bytes.
    pub(crate) fn stall(body: AnyBody, bytes: u64) -> AnyBody {
        Self::boxed(body, bytes, true)
    }

    fn boxed(body: AnyBody, rest: u64, is_stalled: bool) -> AnyBody {
        let faulty = Self { body, rest, is_stalled };
        faulty.boxed_unsync()
    }
}

impl Body for Faulty {
    type Data = Bytes;
    type Error = Box<dyn Error + Send + Sync>;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Self::Error>>> {
        if self.rest == 0 {
            // It is never woken, so the connection stays open until the client ends it.
            return if self.is_stalled {
                Poll::Pending
            } else {
                Poll::Ready(Some(Err(Cut.into())))
            };
        }
        let frame = ready!(Pin::new(&mut self.body).poll_frame(context));
        let Some(Ok(frame)) = frame else {
            return Poll::Ready(frame);
        };
        let Ok(mut data) = frame.into_data() else {
            return Poll::Ready(None);
        };
        data.truncate(usize::try_from(self.rest).unwrap_or(usize::MAX));
        self.rest -= data.len() as u64;
        Poll::Ready(Some(Ok(Frame::data(data))))
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
