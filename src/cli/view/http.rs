//! As much of HTTP as a page and one file need.

use std::borrow::Cow;
use std::io::Cursor;
use std::ops::Range;
use std::sync::Arc;
use tiny_http::{Header, Method, Response, StatusCode};

/// What matters of a request.
pub struct Request {
    pub is_get: bool,
    /// Without the query.
    pub path: String,
    pub host: Option<String>,
    pub range: Option<String>,
}

impl Request {
    pub fn of(request: &tiny_http::Request) -> Self {
        let header = |name: &'static str| {
            let found = request.headers().iter().find(|header| header.field.equiv(name));
            found.map(|header| header.value.as_str().to_owned())
        };
        let path = request.url().split(['?', '#']).next().unwrap_or_default();
        Self {
            is_get: matches!(request.method(), Method::Get | Method::Head),
            path: path.to_owned(),
            host: header("Host"),
            range: header("Range"),
        }
    }
}

/// A file to send, or a piece of one.
pub struct Answer {
    status: u16,
    body: Body,
    range: Range<usize>,
    headers: Vec<(&'static str, Cow<'static, str>)>,
}

enum Body {
    Static(&'static [u8]),
    Owned(Vec<u8>),
    Shared(Arc<Vec<u8>>),
}

impl AsRef<[u8]> for Body {
    fn as_ref(&self) -> &[u8] {
        match self {
            Self::Static(bytes) => bytes,
            Self::Owned(bytes) => bytes,
            Self::Shared(bytes) => bytes,
        }
    }
}

/// The page may load its own parts and nothing else.
const POLICY: &str = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; \
    style-src 'self' 'unsafe-inline'; img-src 'self' data:; frame-ancestors 'none'";

impl Answer {
    fn new(status: u16, kind: &'static str, body: Body) -> Self {
        let range = 0..body.as_ref().len();
        let headers = vec![
            ("Content-Type", kind.into()),
            ("Cache-Control", "no-cache".into()),
            ("Content-Security-Policy", POLICY.into()),
            ("X-Content-Type-Options", "nosniff".into()),
        ];
        Self { status, body, range, headers }
    }

    pub fn asset(kind: &'static str, bytes: &'static [u8]) -> Self {
        Self::new(200, kind, Body::Static(bytes))
    }

    pub fn bytes(kind: &'static str, bytes: Vec<u8>) -> Self {
        Self::new(200, kind, Body::Owned(bytes))
    }

    pub fn json(value: &serde_json::Value) -> Self {
        Self::bytes("application/json", value.to_string().into_bytes())
    }

    pub fn status(status: u16) -> Self {
        let text = StatusCode(status).default_reason_phrase();
        Self::new(status, "text/plain", Body::Static(text.as_bytes()))
    }

    /// The whole of a file, or the range that was asked for. What asks for more than one is answered
    /// with the whole, as RFC 9110, section 14.2 allows.
    pub fn ranged(kind: &'static str, bytes: Arc<Vec<u8>>, range: Option<&str>, tag: String) -> Self {
        let total = bytes.len();
        let mut answer = Self::new(200, kind, Body::Shared(bytes));
        answer.headers.extend([("Accept-Ranges", "bytes".into()), ("ETag", tag.into())]);
        match range.and_then(|range| parse(range, total)) {
            None => {}
            Some(Some(range)) => {
                answer.status = 206;
                let place = format!("bytes {}-{}/{total}", range.start, range.end - 1);
                answer.headers.push(("Content-Range", place.into()));
                answer.range = range;
            }
            Some(None) => {
                answer.status = 416;
                answer.headers.push(("Content-Range", format!("bytes */{total}").into()));
                answer.range = 0..0;
            }
        }
        answer
    }

    pub fn into_response(self) -> Response<impl std::io::Read> {
        let length = self.range.len();
        let mut body = Cursor::new(self.body);
        body.set_position(self.range.start as u64);
        let headers = self.headers.iter();
        let headers = headers.filter_map(|(name, value)| Header::from_bytes(*name, value.as_bytes()).ok());
        let body = std::io::Read::take(body, length as u64);
        Response::new(StatusCode(self.status), headers.collect(), body, Some(length), None)
    }
}

/// `None`: no single range; `Some(None)`: one that lies outside.
fn parse(range: &str, total: usize) -> Option<Option<Range<usize>>> {
    let (first, last) = range.trim().strip_prefix("bytes=")?.split_once('-')?;
    let (first, last) = (first.trim(), last.trim());
    let is_number = |text: &str| text.bytes().all(|c| c.is_ascii_digit());
    if !is_number(first) || !is_number(last) {
        return None;
    }
    // What does not fit is beyond any file.
    let number = |text: &str| text.parse().unwrap_or(usize::MAX);
    let range = match (first, last) {
        ("", "") => return None,
        ("", last) => total.saturating_sub(number(last))..total,
        (first, "") => number(first)..total,
        (first, last) if number(first) > number(last) => return None,
        (first, last) => number(first)..number(last).saturating_add(1).min(total),
    };
    Some((range.start < range.end).then_some(range))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_cut_to_the_file() {
        for (text, expected) in [
            ("bytes=0-", Some(Some(0..100))),
            ("bytes=40-", Some(Some(40..100))),
            ("bytes=40-49", Some(Some(40..50))),
            ("bytes=40-4000", Some(Some(40..100))),
            ("bytes=-10", Some(Some(90..100))),
            ("bytes=-1000", Some(Some(0..100))),
            ("bytes=99-99", Some(Some(99..100))),
            ("bytes=100-", Some(None)),
            ("bytes=99999999999999999999999-", Some(None)),
            ("bytes=-0", Some(None)),
            ("bytes=50-40", None),
            ("bytes=0-1,5-6", None),
            ("bytes=-", None),
            ("bytes=a-b", None),
            ("lines=0-1", None),
        ] {
            assert_eq!(parse(text, 100), expected, "{text}");
        }
        assert_eq!(parse("bytes=0-", 0), Some(None));
    }
}
