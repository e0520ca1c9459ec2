//! Bodies of requests and responses.

use crate::refusal::Refusal;
use hyper::StatusCode;
use hyper::body::{Body as _, Bytes, Frame, Incoming, SizeHint};
use hyper::header::{self, HeaderValue};
use std::convert::Infallible;
use std::future::poll_fn;
use std::pin::Pin;
use std::task::{Context, Poll};

/// A request whose body has not been read.
pub(crate) type Request = hyper::Request<Incoming>;

/// A response.
pub(crate) type Response = hyper::Response<Body>;

/// Body of a response in parts.
pub(crate) type Parts = dyn hyper::body::Body<Data = Bytes, Error = Infallible> + Send + Unpin;

/// Body of a response.
pub(crate) enum Body {
    /// Complete body; empty after it is sent.
    Whole(Bytes),
    /// Parts as they are produced.
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

/// A response with the given content type.
pub(crate) fn response(kind: &'static str, body: Body) -> Response {
    let mut response = Response::new(body);
    let kind = HeaderValue::from_static(kind);
    response.headers_mut().insert(header::CONTENT_TYPE, kind);
    response
}

/// A complete response with the given content type.
pub(crate) fn whole(kind: &'static str, contents: impl Into<Bytes>) -> Response {
    response(kind, Body::Whole(contents.into()))
}

/// A refusal as JSON.
pub(crate) fn refused(refusal: &Refusal) -> Response {
    let text = serde_json::to_vec(refusal).unwrap_or_default();
    let mut response = whole("application/json", text);
    *response.status_mut() = status(refusal);
    response
}

/// Status of the response to a refused request.
pub(crate) fn status(refusal: &Refusal) -> StatusCode {
    StatusCode::from_u16(refusal.status).unwrap_or(StatusCode::BAD_REQUEST)
}

/// Reads the whole body of a request; `None` if it is incomplete or longer than `limit` bytes.
pub(crate) async fn read(mut body: Incoming, limit: usize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    while let Some(frame) = poll_fn(|context| Pin::new(&mut body).poll_frame(context)).await {
        // Trailers are ignored.
        if let Ok(data) = frame.ok()?.into_data() {
            if bytes.len() + data.len() > limit {
                return None;
            }
            bytes.extend_from_slice(&data);
        }
    }
    Some(bytes)
}
