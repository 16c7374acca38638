//! As much of HTTP as a page and one file need.

use std::borrow::Cow;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::ops::Range;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Longest head of a request; browsers send about one kilobyte.
const MAX_HEAD: u64 = 1 << 14;
/// How long a request may take to arrive.
const PATIENCE: Duration = Duration::from_secs(10);
/// How long a reader of an answer may rest. Altogether it may take as long as it likes.
const REST: Duration = Duration::from_secs(60);
/// Connections at one time; browsers have about six.
const MAX_CONNECTIONS: usize = 64;
/// How long to wait where the system has no connection or no thread to give.
const PAUSE: Duration = Duration::from_millis(100);

/// What matters of a request.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Request {
    pub method: String,
    /// Without the query.
    pub path: String,
    pub host: Option<String>,
    pub range: Option<String>,
}

impl Request {
    /// Reads the head; `None` if it is none.
    fn read(from: impl Read) -> io::Result<Option<Self>> {
        let mut lines = BufReader::new(from.take(MAX_HEAD)).lines();
        let Some(first) = lines.next().transpose()? else { return Ok(None) };
        let mut words = first.split(' ');
        let (Some(method), Some(target), Some(version)) = (words.next(), words.next(), words.next()) else {
            return Ok(None);
        };
        if !version.starts_with("HTTP/1.") || !target.starts_with('/') {
            return Ok(None);
        }
        let path = target.split(['?', '#']).next().unwrap_or_default();
        let mut request = Self { method: method.into(), path: path.into(), ..Self::default() };
        for line in lines {
            let line = line?;
            if line.is_empty() {
                return Ok(Some(request));
            }
            let Some((name, value)) = line.split_once(':') else { return Ok(None) };
            match name.to_ascii_lowercase().as_str() {
                "host" => request.host = Some(value.trim().into()),
                "range" => request.range = Some(value.trim().into()),
                _ => {}
            }
        }
        // The end of the bytes came before the end of the head.
        Ok(None)
    }
}

/// Answers one request on each connection, each in a thread of its own, for ever: where files or threads are short
/// it waits until there are some again.
pub fn serve<F>(listener: &TcpListener, answer: F) -> !
where
    F: Fn(&Request) -> Answer + Send + Sync + 'static,
{
    let answer = Arc::new(answer);
    let places = Arc::new(Places::default());
    loop {
        // Who comes when all are taken waits in the queue of the system.
        let place = Places::take(&places);
        let Ok((stream, _)) = listener.accept() else {
            thread::sleep(PAUSE);
            continue;
        };
        let answer = Arc::clone(&answer);
        let talk = move || {
            let _place = place;
            // A reader who goes away has lost interest.
            converse(&stream, &*answer).ok()
        };
        if thread::Builder::new().spawn(talk).is_err() {
            thread::sleep(PAUSE);
        }
    }
}

/// How many connections there are.
#[derive(Default)]
struct Places {
    taken: Mutex<usize>,
    freed: Condvar,
}

impl Places {
    /// Waits until fewer than [`MAX_CONNECTIONS`] are taken.
    fn take(places: &Arc<Self>) -> Place {
        let taken = places.taken.lock().unwrap_or_else(PoisonError::into_inner);
        let free = places.freed.wait_while(taken, |taken| *taken >= MAX_CONNECTIONS);
        *free.unwrap_or_else(PoisonError::into_inner) += 1;
        Place(Arc::clone(places))
    }
}

/// Taken until this is dropped.
struct Place(Arc<Places>);

impl Drop for Place {
    fn drop(&mut self) {
        *self.0.taken.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
        self.0.freed.notify_one();
    }
}

/// Reads from a connection until a moment, however often something comes before it.
struct Until<'a> {
    stream: &'a TcpStream,
    end: Instant,
}

impl Read for Until<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(buffer)
    }
}

fn converse(mut stream: &TcpStream, answer: &dyn Fn(&Request) -> Answer) -> io::Result<()> {
    stream.set_write_timeout(Some(REST))?;
    let request = Request::read(Until { stream, end: Instant::now() + PATIENCE })?;
    let found = request.as_ref().map_or_else(|| Answer::status(400), answer);
    let with_body = request.is_none_or(|request| request.method != "HEAD");
    found.write(&mut stream, with_body)
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
        Self::new(status, "text/plain", Body::Static(reason(status).as_bytes()))
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

    fn write(&self, out: &mut impl Write, with_body: bool) -> io::Result<()> {
        let mut head = format!("HTTP/1.1 {} {}\r\n", self.status, reason(self.status));
        for (name, value) in &self.headers {
            head += &format!("{name}: {value}\r\n");
        }
        head += &format!("Content-Length: {}\r\nConnection: close\r\n\r\n", self.range.len());
        out.write_all(head.as_bytes())?;
        if with_body {
            out.write_all(&self.body.as_ref()[self.range.clone()])?;
        }
        out.flush()
    }
}

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        206 => "Partial Content",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        _ => "Range Not Satisfiable",
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
    fn requests_are_read_or_refused() {
        let read = |text: &str| Request::read(text.as_bytes()).unwrap();
        let request =
            read("GET /a?b=c HTTP/1.1\r\nHOST: x:1\r\nrange: bytes=0-\r\nAccept: */*\r\n\r\n").unwrap();
        assert_eq!((request.method.as_str(), request.path.as_str()), ("GET", "/a"));
        assert_eq!((request.host.as_deref(), request.range.as_deref()), (Some("x:1"), Some("bytes=0-")));
        for bad in [
            "",
            "GET /\r\n\r\n",
            "GET / HTTP/2\r\n\r\n",
            "GET http://x/ HTTP/1.1\r\n\r\n",
            "GET / HTTP/1.1\r\nHost x\r\n\r\n",
            "GET / HTTP/1.1\r\nHost: x\r\n",
        ] {
            assert_eq!(read(bad), None, "{bad:?}");
        }
        let endless = format!("GET / HTTP/1.1\r\n{}", "a: b\r\n".repeat(10_000));
        assert_eq!(read(&endless), None);
    }

    /// A line that never ends, byte by byte, each in good time.
    #[test]
    fn a_head_has_one_deadline() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let mut slow = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (stream, _) = listener.accept().unwrap();
        let drip = thread::spawn(move || {
            while slow.write_all(b"a").is_ok() {
                thread::sleep(Duration::from_millis(5));
            }
        });
        let end = Instant::now() + Duration::from_millis(200);
        let kind = Request::read(Until { stream: &stream, end }).unwrap_err().kind();
        assert!(matches!(kind, io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock), "{kind:?}");
        assert!(Until { stream: &stream, end }.read(&mut [0]).is_err(), "the end stays the end");
        drop(stream);
        drip.join().unwrap();
    }

    #[test]
    fn places_are_limited_and_come_free() {
        let places = Arc::new(Places::default());
        let mut taken: Vec<Place> = (0..MAX_CONNECTIONS).map(|_| Places::take(&places)).collect();
        let (tell, told) = std::sync::mpsc::channel();
        let waiting = thread::spawn({
            let places = Arc::clone(&places);
            move || {
                let place = Places::take(&places);
                tell.send(()).unwrap();
                drop(place);
            }
        });
        assert!(told.recv_timeout(Duration::from_millis(50)).is_err(), "one more than there are");
        taken.pop();
        told.recv().unwrap();
        waiting.join().unwrap();
        drop(taken);
        assert_eq!(*places.taken.lock().unwrap(), 0);
    }

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
