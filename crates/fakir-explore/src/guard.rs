//! Request authentication by token, host and origin.
//!
//! Any page in the browser can send requests to a port of this machine. Therefore every request
//! must
//! * name this server as its `Host`, which excludes foreign pages whose host name resolves to this
//!   machine (DNS rebinding);
//! * have no `Origin` other than that of the page;
//! * contain the token: in the path for the page, in a header for the API. Browsers do not allow
//!   foreign pages to send this header.

use crate::refusal::Refusal;
use hyper::StatusCode;
use hyper::header::{self, HeaderMap, HeaderName, HeaderValue};
use rand::TryRng;
use rand::rngs::{SysError, SysRng};
use std::fmt;

/// Header of the API that contains the token.
pub(crate) const TOKEN: &str = "x-fakir-token";

/// Random part of the address.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Token(String);

impl Token {
    /// 128 bits from the operating system, in hexadecimal.
    pub(crate) fn random() -> Result<Self, SysError> {
        let mut bytes = [0; 16];
        SysRng.try_fill_bytes(&mut bytes)?;
        Ok(Self(bytes.iter().map(|b| format!("{b:02x}")).collect()))
    }

    pub(crate) fn text(&self) -> &str {
        &self.0
    }

    /// Compares with the token in constant time.
    fn is(&self, other: &[u8]) -> bool {
        let own = self.0.as_bytes();
        let differences = own.iter().zip(other).fold(0, |all, (a, b)| all | (a ^ b));
        own.len() == other.len() && differences == 0
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token")
    }
}

/// Checks of every request.
#[derive(Debug, Clone)]
pub(crate) struct Guard {
    token: Token,
    /// `127.0.0.1:PORT` and its other names.
    hosts: [String; 2],
}

impl Guard {
    pub(crate) fn new(token: Token, port: u16) -> Self {
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{port}"));
        Self { token, hosts }
    }

    /// Refuses a request that is not from the page of this server.
    pub(crate) fn check(&self, path: &str, headers: &HeaderMap) -> Result<(), Refusal> {
        let forbidden = |message: &str| Err(Refusal::new(StatusCode::FORBIDDEN.as_u16(), message));
        let is_host = |host: &str| self.hosts.iter().any(|own| own == host);
        if !single_value(headers, &header::HOST).is_some_and(is_host) {
            return forbidden("the Host is not this server");
        }
        if headers.contains_key(header::ORIGIN) {
            let own = single_value(headers, &header::ORIGIN)
                .and_then(|origin| origin.strip_prefix("http://"))
                .is_some_and(is_host);
            if !own {
                return forbidden("requests of other origins are not answered");
            }
        }
        let given = if path.starts_with("/api/") {
            single_value(headers, &HeaderName::from_static(TOKEN)).unwrap_or_default()
        } else {
            path.split('/').nth(1).unwrap_or_default()
        };
        if !self.token.is(given.as_bytes()) {
            return forbidden(
                "this is not the address that fakir printed: it changes whenever fakir starts. To open a link, append its part \
                 from # on to the new address",
            );
        }
        Ok(())
    }
}

/// Value of a header that occurs exactly once.
fn single_value<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<&'h str> {
    let mut values = headers.get_all(name).iter();
    let first = values.next()?;
    match values.next() {
        None => first.to_str().ok(),
        Some(_) => None,
    }
}

/// Headers of every response: they forbid loading from other hosts, framing, caching, and guessing
/// of content types.
pub(crate) const HEADERS: [(HeaderName, HeaderValue); 6] = [
    (
        header::CONTENT_SECURITY_POLICY,
        HeaderValue::from_static(
            "default-src 'none'; script-src 'self'; style-src 'self'; font-src 'self' data:; \
             img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; \
             frame-ancestors 'none'",
        ),
    ),
    (
        header::X_CONTENT_TYPE_OPTIONS,
        HeaderValue::from_static("nosniff"),
    ),
    (
        header::REFERRER_POLICY,
        HeaderValue::from_static("no-referrer"),
    ),
    (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        HeaderValue::from_static("same-origin"),
    ),
    (
        HeaderName::from_static("cross-origin-opener-policy"),
        HeaderValue::from_static("same-origin"),
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_differ_and_are_compared_whole() {
        let (one, other) = (Token::random().unwrap(), Token::random().unwrap());
        assert_eq!(one.text().len(), 32);
        assert!(one.is(one.text().as_bytes()));
        for wrong in [
            other.text(),
            "",
            &one.text()[1..],
            &format!("{}0", one.text()),
        ] {
            assert!(!one.is(wrong.as_bytes()), "{wrong}");
        }
    }
}
