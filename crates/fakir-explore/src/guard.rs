//! Who is answered: whoever knows the token, from this machine, from the page itself.
//!
//! Any page in the browser can send requests to a port of this machine. So every request must
//! * name this server as its `Host`, which a page elsewhere that points its own name here
//!   (DNS rebinding) does not;
//! * have no `Origin` but that of the page;
//! * know the token: for the page in the path, for the API in a header, which a page elsewhere
//!   may not even ask to send.

use crate::refusal::Refusal;
use hyper::StatusCode;
use hyper::header::{self, HeaderMap, HeaderName, HeaderValue};
use rand::TryRng;
use rand::rngs::{SysError, SysRng};
use std::fmt;

/// The header of the API that holds the token.
pub(crate) const TOKEN: &str = "x-fakir-token";

/// The random part of the address.
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

    /// Whether `other` is the token; the time this takes does not tell how much of it is right.
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

/// What every request must show.
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
        let forbidden = |message: &str| Err(Refusal::new(StatusCode::FORBIDDEN, message));
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
                "this is not the address that fakir printed: it changes whenever fakir starts",
            );
        }
        Ok(())
    }
}

/// The value of a header that is there once.
fn single_value<'h>(headers: &'h HeaderMap, name: &HeaderName) -> Option<&'h str> {
    let mut values = headers.get_all(name).iter();
    let first = values.next()?;
    match values.next() {
        None => first.to_str().ok(),
        Some(_) => None,
    }
}

/// Headers of every answer: nothing is loaded from elsewhere, nothing is framed, stored or guessed.
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
