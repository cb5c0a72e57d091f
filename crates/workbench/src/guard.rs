//! Access control: only the page of this run, from this machine, may send requests.
//!
//! The address contains a random token, so no other program on this machine and no page of another site knows
//! where to send requests. A page opened under another name of this machine (DNS rebinding) has another Host,
//! and a page of another site that posts has another Origin.

use axum::http::{HeaderMap, Method, header};

/// What a request is checked against.
#[derive(Debug, Clone)]
pub(crate) struct Guard {
    token: String,
    port: u16,
}

impl Guard {
    /// From a token of [`new_token`].
    pub(crate) fn new(port: u16, token: String) -> Self {
        Self { token, port }
    }

    /// The address to open.
    pub(crate) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Whether a host is this machine under one of the names allowed in the address.
    fn is_here(&self, host: &str) -> bool {
        ["127.0.0.1", "localhost"].iter().any(|name| host == format!("{name}:{}", self.port))
    }

    /// The requested path without the token; `None` if the request isn't from the page.
    pub(crate) fn admit<'a>(&self, method: &Method, path: &'a str, headers: &HeaderMap) -> Option<&'a str> {
        let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or_default());
        if !text(header::HOST).is_some_and(|host| self.is_here(host)) {
            return None;
        }
        let is_own = |origin: &str| origin.strip_prefix("http://").is_some_and(|host| self.is_here(host));
        let site = text(header::HeaderName::from_static("sec-fetch-site"));
        match text(header::ORIGIN) {
            Some(origin) if !is_own(origin) => return None,
            // For requests that change something browsers send their origin; other programs send none.
            None if *method != Method::GET && site.is_some_and(|site| site != "same-origin") => return None,
            _ => {}
        }
        let rest = path.strip_prefix('/')?;
        let (token, asked) = rest.split_once('/')?;
        is_equal(token.as_bytes(), self.token.as_bytes()).then_some(asked)
    }
}

/// A token that can't be guessed: 128 random bits.
pub(crate) fn new_token() -> Result<String, getrandom::Error> {
    let mut bytes = [0; size_of::<u128>()];
    getrandom::fill(&mut bytes)?;
    Ok(format!("{:032x}", u128::from_le_bytes(bytes)))
}

/// Compares in a time that doesn't depend on how many bytes are right.
fn is_equal(given: &[u8], right: &[u8]) -> bool {
    given.len() == right.len() && given.iter().zip(right).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.parse().unwrap(), value.parse().unwrap())).collect()
    }

    #[test]
    fn only_the_page_of_this_run_is_admitted() {
        let guard = Guard::new(4711, new_token().unwrap());
        let path = format!("/{}/api/session", guard.token);
        let asks = |method: &Method, path: &str, pairs: &[(&'static str, &str)]| {
            guard.admit(method, path, &headers(pairs)).map(str::to_owned)
        };
        let here = ("host", "127.0.0.1:4711");
        let found = Some("api/session".to_owned());
        assert_eq!(asks(&Method::GET, &path, &[here]), found);
        assert_eq!(
            asks(&Method::PUT, &path, &[("host", "localhost:4711"), ("origin", "http://localhost:4711")]),
            found
        );
        assert_eq!(asks(&Method::PUT, &path, &[here, ("sec-fetch-site", "same-origin")]), found);
        // Another site, another name of this machine, another port, no host, another token, none.
        assert_eq!(asks(&Method::POST, &path, &[here, ("origin", "http://evil.example")]), None);
        assert_eq!(asks(&Method::POST, &path, &[here, ("origin", "null")]), None);
        assert_eq!(asks(&Method::POST, &path, &[here, ("sec-fetch-site", "cross-site")]), None);
        assert_eq!(asks(&Method::GET, &path, &[("host", "evil.example:4711")]), None);
        assert_eq!(asks(&Method::GET, &path, &[("host", "127.0.0.1:4712")]), None);
        assert_eq!(asks(&Method::GET, &path, &[]), None);
        assert_eq!(asks(&Method::GET, &format!("/{}/api/session", "0".repeat(32)), &[here]), None);
        assert_eq!(asks(&Method::GET, "/api/session", &[here]), None);
        assert_ne!(guard.token, new_token().unwrap());
    }
}
