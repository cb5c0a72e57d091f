//! Requests to a running workbench, as a page or anything else on the machine may send them.

use bulge_workbench::{Choices, DataFile, MuscleFile, Start, serve};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::sync::{Mutex, OnceLock, PoisonError, mpsc};
use std::time::Duration;

const MUSCLE: &str = include_str!("../../crates/cli/data/braid.toml");
const DATA: &str = include_str!("../../crates/cli/data/braid-loops.csv");

/// What a request begins with. The first byte of each selects one; the rest of it is the body, or, where the call ends in `?`, the query.
/// Diagnoses and reports, which take seconds, are not among them.
const CALLS: [(&str, &str); 22] = [
    ("PUT", "api/session"),
    ("PUT", "api/session"),
    ("GET", "api/session"),
    ("POST", "api/undo"),
    ("POST", "api/redo"),
    ("POST", "api/data?"),
    ("POST", "api/data?name=a.csv"),
    ("POST", "api/data?name=b.csv&add=1"),
    ("GET", "api/comparison?held_out=0"),
    ("POST", "api/prepare"),
    ("GET", "api/rows.csv"),
    ("GET", "api/effects"),
    ("POST", "api/effects/check"),
    ("GET", "api/muscles"),
    ("GET", "api/shape?"),
    ("GET", "api/shape.vtp?"),
    ("GET", "api/learnt.toml"),
    ("GET", "api/protocol"),
    ("POST", "api/plan"),
    ("GET", "api/diagnosis.json"),
    ("GET", ""),
    ("DELETE", "api/session"),
];

/// Between two requests of one input.
const NEXT: u8 = 0xff;
/// Most requests of one input.
const MOST: usize = 12;
/// Longest wait for an answer: anything is answered within it, or the server hangs.
const PATIENCE: Duration = Duration::from_secs(20);

struct Page {
    host: String,
    token: String,
    /// One connection for all requests, as browsers keep it.
    stream: Mutex<Option<BufReader<TcpStream>>>,
}

impl Page {
    fn open() -> Option<Self> {
        let folder = tempfile::tempdir().ok()?.keep();
        let path = folder.join("loops.csv");
        std::fs::write(&path, DATA).ok()?;
        let choices = Choices {
            data: vec![DataFile { name: "loops.csv".to_owned(), path }],
            columns: None,
            muscle: MuscleFile { toml: MUSCLE.to_owned(), origin: Some("braid.toml".to_owned()) },
            effects: Vec::new(),
            own_effects: None,
            excluded: Vec::new(),
        };
        let (told, address) = mpsc::channel();
        std::thread::spawn(move || {
            let start = Start { choices, is_stated: false, port: 0, session: Some(folder.join("session")) };
            serve(start, |address| drop(told.send(address.to_owned())))
        });
        let address = address.recv().ok()?;
        let (host, token) = address.strip_prefix("http://")?.trim_end_matches('/').split_once('/')?;
        Some(Self { host: host.to_owned(), token: token.to_owned(), stream: Mutex::default() })
    }

    /// Sends one request and reads the whole answer; its status.
    fn ask(&self, method: &str, call: &str, body: &[u8]) -> std::io::Result<u16> {
        let mut kept = self.stream.lock().unwrap_or_else(PoisonError::into_inner);
        let stream = match kept.take() {
            Some(stream) => stream,
            None => BufReader::new(TcpStream::connect(&self.host)?),
        };
        stream.get_ref().set_read_timeout(Some(PATIENCE))?;
        let (mut stream, host, token, length) = (stream, &self.host, &self.token, body.len());
        let head =
            format!("{method} /{token}/{call} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\n\r\n");
        stream.get_mut().write_all(&[head.as_bytes(), body].concat())?;
        let mut line = String::new();
        stream.read_line(&mut line)?;
        let status = line.split(' ').nth(1).and_then(|status| status.parse().ok());
        let (mut size, mut is_chunked, mut closes) = (0, false, false);
        loop {
            line.clear();
            if stream.read_line(&mut line)? == 0 || line == "\r\n" {
                break;
            }
            let lower = line.to_ascii_lowercase();
            if let Some(stated) = lower.strip_prefix("content-length:") {
                size = stated.trim().parse().unwrap_or(0);
            }
            is_chunked |= lower.starts_with("transfer-encoding: chunked");
            closes |= lower.starts_with("connection: close");
        }
        if is_chunked || closes {
            // The end of such an answer is that of the connection, or nothing that needs waiting for.
            drop(stream);
        } else {
            std::io::copy(&mut stream.by_ref().take(size), &mut std::io::sink())?;
            *kept = Some(stream);
        }
        status.ok_or_else(|| std::io::Error::other(format!("no answer to {method} {call}")))
    }
}

/// Whatever is asked, the workbench answers, and then still answers who asks for its session.
pub(crate) fn requests(bytes: &[u8]) {
    static PAGE: OnceLock<Option<Page>> = OnceLock::new();
    let Some(page) = PAGE.get_or_init(Page::open) else { return };
    for request in bytes.split(|byte| *byte == NEXT).take(MOST) {
        let Some((choice, body)) = request.split_first() else { continue };
        let (method, call) = CALLS[usize::from(*choice) % CALLS.len()];
        // A query can't have what ends a line, nor can a page send it.
        let query: String = if call.ends_with('?') {
            String::from_utf8_lossy(body).chars().filter(char::is_ascii_graphic).collect()
        } else {
            String::new()
        };
        let body = if method == "GET" || call.ends_with('?') { &[][..] } else { body };
        match page.ask(method, &format!("{call}{query}"), body) {
            Ok(status) => {
                let is_known = matches!(status, 200 | 400 | 403 | 404 | 413 | 422);
                assert!(is_known, "{method} {call}: {status}");
            }
            Err(error) => assert!(error.to_string().is_empty(), "{method} {call}{query}: {error}"),
        }
    }
    let status = page.ask("GET", "api/session", b"");
    assert!(matches!(status, Ok(200)), "the session: {status:?}");
}
