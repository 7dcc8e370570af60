//! HTTP/1.1 as far as a page on this machine needs it: one request after the other on a connection, each small and complete within a time
//! limit, and answers of known length or in chunks.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Most bytes of a request line and headers.
const MOST_HEAD: usize = 16 << 10;
/// Most headers.
const MOST_HEADERS: usize = 64;
/// Most bytes of a body.
pub const MOST_BODY: usize = 256 << 10;
/// How long a connection may be silent between two requests.
const SILENCE: Duration = Duration::from_secs(120);
/// How long a request may take to arrive once its first byte is there, and how long a client may take to read what is written.
pub const PATIENCE: Duration = Duration::from_secs(10);

/// A request.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HttpRequest {
    pub method: String,
    /// The path, without what follows a question mark.
    pub path: String,
    pub query: String,
    pub host: Option<String>,
    pub origin: Option<String>,
    pub cookie: String,
    pub content_type: String,
    /// Where the request comes from, by the browser's own word.
    pub site: Option<String>,
    pub body: Vec<u8>,
    /// Does the client end the connection after this?
    pub closes: bool,
}

/// Why there is no request: the status to answer with, if any.
#[derive(Debug, PartialEq, Eq)]
pub enum NoRequest {
    /// The client is gone, or silent.
    Gone,
    /// It is answered with this status and reason.
    Wrong(u16, &'static str),
}

impl From<io::Error> for NoRequest {
    fn from(_: io::Error) -> Self {
        Self::Gone
    }
}

/// A connection and what was read beyond the last request.
pub struct Connection {
    pub stream: TcpStream,
    read: Vec<u8>,
    patience: Duration,
    /// Nothing was asked on it yet.
    is_new: bool,
}

impl Connection {
    /// A connection whose requests must arrive within `patience`.
    ///
    /// # Errors
    /// Those of the socket.
    pub fn new(stream: TcpStream, patience: Duration) -> io::Result<Self> {
        stream.set_nodelay(true)?;
        stream.set_write_timeout(Some(patience))?;
        Ok(Self { stream, read: Vec::new(), patience, is_new: true })
    }

    /// The next request.
    ///
    /// # Errors
    /// [`NoRequest`].
    pub fn next(&mut self) -> Result<HttpRequest, NoRequest> {
        let mut deadline = (!self.read.is_empty()).then(|| Instant::now() + self.patience);
        loop {
            if let Some((mut asked, head, length)) = head_of(&self.read)? {
                while self.read.len() < head + length {
                    self.more(&mut deadline)?;
                }
                asked.body = self.read[head..head + length].to_vec();
                self.read.drain(..head + length);
                self.is_new = false;
                return Ok(asked);
            }
            if self.read.len() > MOST_HEAD {
                return Err(NoRequest::Wrong(431, "the headers are too long"));
            }
            self.more(&mut deadline)?;
        }
    }

    /// Reads what is there; the time for a request runs from its first byte.
    fn more(&mut self, deadline: &mut Option<Instant>) -> Result<(), NoRequest> {
        // Whoever connects and says nothing keeps others out.
        let silence = if self.is_new { self.patience } else { SILENCE };
        let left = deadline.map_or(silence, |it| it.saturating_duration_since(Instant::now()));
        if left.is_zero() {
            return Err(NoRequest::Wrong(408, "the request took too long"));
        }
        self.stream.set_read_timeout(Some(left))?;
        let mut bytes = [0; 8192];
        match self.stream.read(&mut bytes) {
            Ok(0) => Err(NoRequest::Gone),
            Ok(count) => {
                self.read.extend_from_slice(&bytes[..count]);
                deadline.get_or_insert_with(|| Instant::now() + self.patience);
                Ok(())
            }
            Err(error) if deadline.is_some() && is_timeout(&error) => Err(NoRequest::Wrong(408, "the request took too long")),
            Err(_) => Err(NoRequest::Gone),
        }
    }

    /// Is the other end still there? What it sends meanwhile waits.
    pub fn is_open(&self) -> bool {
        if self.stream.set_nonblocking(true).is_err() {
            return false;
        }
        let seen = self.stream.peek(&mut [0]);
        let open = match seen {
            Ok(count) => count > 0,
            Err(error) => error.kind() == io::ErrorKind::WouldBlock,
        };
        self.stream.set_nonblocking(false).is_ok() && open
    }
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}

/// The request whose head is complete, the length of the head and that of its body.
fn head_of(read: &[u8]) -> Result<Option<(HttpRequest, usize, usize)>, NoRequest> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    let head = match request.parse(read) {
        Ok(httparse::Status::Complete(head)) => head,
        Ok(httparse::Status::Partial) => return Ok(None),
        Err(httparse::Error::TooManyHeaders) => return Err(NoRequest::Wrong(431, "there are too many headers")),
        Err(_) => return Err(NoRequest::Wrong(400, "this is no HTTP request")),
    };
    if head > MOST_HEAD {
        return Err(NoRequest::Wrong(431, "the headers are too long"));
    }
    let mut asked = HttpRequest { method: request.method.unwrap_or_default().to_owned(), ..HttpRequest::default() };
    let target = request.path.unwrap_or_default();
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    (asked.path, asked.query) = (path.to_owned(), query.to_owned());
    asked.closes = request.version == Some(0);
    let mut length: Option<usize> = None;
    for header in request.headers.iter() {
        let Ok(value) = std::str::from_utf8(header.value) else {
            return Err(NoRequest::Wrong(400, "a header is no text"));
        };
        let value = value.trim();
        // A header that decides who asks, and is there twice, could be read in two ways.
        let once = |slot: &mut Option<String>| match slot.replace(value.to_owned()) {
            None => Ok(()),
            Some(_) => Err(NoRequest::Wrong(400, "a header is there twice")),
        };
        match header.name.to_ascii_lowercase().as_str() {
            "host" => once(&mut asked.host)?,
            "origin" => once(&mut asked.origin)?,
            "sec-fetch-site" => once(&mut asked.site)?,
            "cookie" => {
                asked.cookie.push_str(value);
                asked.cookie.push(';');
            }
            "content-type" => value.clone_into(&mut asked.content_type),
            "connection" => asked.closes |= value.eq_ignore_ascii_case("close"),
            "transfer-encoding" => return Err(NoRequest::Wrong(411, "say how long the body is")),
            "content-length" => {
                let own: usize = value.parse().map_err(|_| NoRequest::Wrong(400, "the length of the body is no number"))?;
                if length.replace(own).is_some_and(|other| other != own) {
                    return Err(NoRequest::Wrong(400, "the body has two lengths"));
                }
            }
            _ => {}
        }
    }
    let length = length.unwrap_or(0);
    if length > MOST_BODY {
        return Err(NoRequest::Wrong(413, "the request is too large"));
    }
    Ok(Some((asked, head, length)))
}

/// An answer as a whole.
pub struct Reply {
    pub status: u16,
    pub kind: &'static str,
    pub headers: Vec<(&'static str, String)>,
    pub body: Vec<u8>,
}

impl Reply {
    /// Text for people.
    pub fn text(status: u16, text: &str) -> Self {
        Self { status, kind: "text/plain; charset=utf-8", headers: Vec::new(), body: format!("{text}\n").into_bytes() }
    }

    /// A file of the page.
    pub fn file(kind: &'static str, body: Vec<u8>) -> Self {
        Self { status: 200, kind, headers: Vec::new(), body }
    }

    /// Writes it.
    ///
    /// # Errors
    /// Those of the socket.
    pub fn write(&self, out: &mut impl Write, closes: bool) -> io::Result<()> {
        let mut head = head(self.status, self.kind, closes);
        for (name, value) in &self.headers {
            head.push_str(&format!("{name}: {value}\r\n"));
        }
        head.push_str(&format!("Content-Length: {}\r\n\r\n", self.body.len()));
        let mut bytes = head.into_bytes();
        bytes.extend_from_slice(&self.body);
        out.write_all(&bytes)?;
        out.flush()
    }
}

/// Begins an answer in chunks.
///
/// # Errors
/// Those of the socket.
pub fn begin_chunks(out: &mut impl Write, kind: &str) -> io::Result<()> {
    let head = head(200, kind, false) + "Transfer-Encoding: chunked\r\n\r\n";
    out.write_all(head.as_bytes())
}

/// Writes one chunk; an empty one ends the answer.
///
/// # Errors
/// Those of the socket.
pub fn write_chunk(out: &mut impl Write, bytes: &[u8]) -> io::Result<()> {
    let mut chunk = format!("{:x}\r\n", bytes.len()).into_bytes();
    chunk.extend_from_slice(bytes);
    chunk.extend_from_slice(b"\r\n");
    out.write_all(&chunk)?;
    out.flush()
}

/// Status line and the headers that every answer has. Nothing is fetched from elsewhere, framed, guessed or kept.
fn head(status: u16, kind: &str, closes: bool) -> String {
    let reason = match status {
        200 => "OK",
        303 => "See Other",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        411 => "Length Required",
        413 => "Content Too Large",
        415 => "Unsupported Media Type",
        421 => "Misdirected Request",
        431 => "Request Header Fields Too Large",
        _ => "Service Unavailable",
    };
    format!(
        "HTTP/1.1 {status} {reason}\r\nContent-Type: {kind}\r\nConnection: {}\r\nCache-Control: no-store\r\n\
         Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data: blob:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\
         X-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\nCross-Origin-Opener-Policy: same-origin\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\n",
        if closes { "close" } else { "keep-alive" }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_request_is_read_once_it_is_complete_and_what_could_mean_two_things_is_refused() {
        let text = b"POST /answer?x=1 HTTP/1.1\r\nHost: 127.0.0.1:9\r\nContent-Length: 2\r\nCookie: a=b\r\n\r\n{}";
        let (asked, head, length) = head_of(text).expect("it is right").expect("it is complete");
        assert_eq!((asked.path.as_str(), asked.query.as_str(), head, length), ("/answer", "x=1", text.len() - 2, 2));
        assert_eq!(asked.host.as_deref(), Some("127.0.0.1:9"));
        for cut in 1..head {
            assert_eq!(head_of(&text[..cut]), Ok(None), "{cut}");
        }
        for (lines, status) in [
            ("Host: a\r\nHost: b\r\n", 400),
            ("Content-Length: 1\r\nContent-Length: 2\r\n", 400),
            ("Content-Length: -1\r\n", 400),
            ("Content-Length: 999999999\r\n", 413),
            ("Transfer-Encoding: chunked\r\n", 411),
            ("no header\r\n", 400),
        ] {
            let text = format!("GET / HTTP/1.1\r\n{lines}\r\n");
            let found = head_of(text.as_bytes());
            assert!(matches!(found, Err(NoRequest::Wrong(found, _)) if found == status), "{lines}: {found:?}");
        }
    }
}
