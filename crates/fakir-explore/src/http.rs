//! Bodies of requests and answers.

use hyper::body::{Body as _, Bytes, Frame, Incoming, SizeHint};
use hyper::header::{self, HeaderValue};
use std::convert::Infallible;
use std::future::poll_fn;
use std::pin::Pin;
use std::task::{Context, Poll};

/// A request whose body has not been read.
pub(crate) type Request = hyper::Request<Incoming>;

/// An answer.
pub(crate) type Response = hyper::Response<Body>;

/// The body of an answer that comes in parts.
pub(crate) type Parts = dyn hyper::body::Body<Data = Bytes, Error = Infallible> + Send + Unpin;

/// The body of an answer.
pub(crate) enum Body {
    /// All of it; empty once it is sent.
    Whole(Bytes),
    /// Parts as they come.
    Parts(Box<Parts>),
}

impl hyper::body::Body for Body {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        match &mut *self {
            Self::Whole(bytes) if bytes.is_empty() => Poll::Ready(None),
            Self::Whole(bytes) => Poll::Ready(Some(Ok(Frame::data(std::mem::take(bytes))))),
            Self::Parts(parts) => Pin::new(parts).poll_frame(context),
        }
    }

    fn is_end_stream(&self) -> bool {
        match self {
            Self::Whole(bytes) => bytes.is_empty(),
            Self::Parts(parts) => parts.is_end_stream(),
        }
    }

    fn size_hint(&self) -> SizeHint {
        match self {
            Self::Whole(bytes) => SizeHint::with_exact(bytes.len() as u64),
            Self::Parts(parts) => parts.size_hint(),
        }
    }
}

/// An answer of this type of content.
pub(crate) fn response(kind: &'static str, body: Body) -> Response {
    let mut response = Response::new(body);
    let kind = HeaderValue::from_static(kind);
    response.headers_mut().insert(header::CONTENT_TYPE, kind);
    response
}

/// An answer of this type of content that is known as a whole.
pub(crate) fn whole(kind: &'static str, contents: impl Into<Bytes>) -> Response {
    response(kind, Body::Whole(contents.into()))
}

/// The whole body of a request; `None` if it breaks off or is longer than `limit` bytes.
pub(crate) async fn read(mut body: Incoming, limit: usize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    while let Some(frame) = poll_fn(|context| Pin::new(&mut body).poll_frame(context)).await {
        // Trailers are left out.
        if let Ok(data) = frame.ok()?.into_data() {
            if bytes.len() + data.len() > limit {
                return None;
            }
            bytes.extend_from_slice(&data);
        }
    }
    Some(bytes)
}
