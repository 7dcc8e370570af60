//! `beltspace explore`: one page on this machine that answers while its sliders move.
//!
//! A small server without further threads than its connections have. Each connection is read by a thread of its own; what it asks is
//! answered by the library, in steps, and ends as soon as the browser has lost interest. Only the page that came with the token may ask
//! (`gate`), and there are a few fixed addresses: nothing that a client says becomes a path.

mod controls;
mod gate;
mod http;
mod routes;
#[cfg(test)]
mod tests;

use crate::error::{Error, Result};
use crate::live::Live;
use crate::screen::Control;
use crate::study::Study;
use gate::Gate;
use http::{Connection, NoRequest, PATIENCE, Reply};
use std::collections::BTreeMap;
use std::net::{Ipv4Addr, TcpListener};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Most connections at a time.
const MOST_CONNECTIONS: usize = 32;

/// The command line of what a page shows: a command with the study and what is set.
pub type CommandWords = Box<dyn Fn(&str, &[String]) -> String + Send + Sync>;

/// A server for one study.
pub struct Explorer {
    live: Live,
    /// The text of the file, and what the command sets in it: the study that a page begins with.
    file_text: String,
    begin: Vec<String>,
    words: CommandWords,
    listener: TcpListener,
    gate: Gate,
    port: u16,
    patience: Duration,
    /// Has the study maps, as its file has it?
    has_maps: bool,
    connections: AtomicUsize,
    /// By the number that a tab has given itself: what it waits for.
    tabs: Mutex<BTreeMap<u64, Arc<Control>>>,
}

impl Explorer {
    /// Listens on a port of this machine; 0: any that is free. A page begins with the study as these changes leave it.
    ///
    /// # Errors
    /// [`Error::Request`] if the study is wrong or the port is taken.
    pub fn bind(live: Live, port: u16, begin: &[String], words: CommandWords) -> Result<Self> {
        let wrong = |error: std::io::Error| {
            Error::Request(format!("cannot listen on port {port} of this machine: {error}; name another with --port"))
        };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(wrong)?;
        let port = listener.local_addr().map_err(wrong)?.port();
        let gate = Gate::new(port).map_err(Error::io(Path::new("random numbers")))?;
        let (file_text, text) = (live.text().to_owned(), live.study(begin)?.1);
        let of_file = Study::parse_in(&file_text, live.file(), live.folder());
        let has_maps = of_file.is_ok_and(|study| !study.report.maps.is_empty());
        Ok(Self {
            live: live.with_text(text),
            file_text,
            begin: begin.to_vec(),
            words,
            listener,
            gate,
            port,
            patience: PATIENCE,
            has_maps,
            connections: AtomicUsize::new(0),
            tabs: Mutex::default(),
        })
    }

    /// The address for people, which may be opened again and again.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.gate.token)
    }

    /// The address for starting a browser, which works once.
    pub fn address_once(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.gate.once)
    }

    /// Answers until the program ends.
    pub fn serve(&self) {
        std::thread::scope(|scope| {
            for stream in self.listener.incoming() {
                let Ok(stream) = stream else { continue };
                let Ok(mut connection) = Connection::new(stream, self.patience) else { continue };
                if self.connections.fetch_add(1, Ordering::Relaxed) >= MOST_CONNECTIONS {
                    self.connections.fetch_sub(1, Ordering::Relaxed);
                    let _ = Reply::text(503, "there are too many connections").write(&mut connection.stream, true);
                    continue;
                }
                let serve = move || {
                    self.converse(&mut connection);
                    self.connections.fetch_sub(1, Ordering::Relaxed);
                };
                if std::thread::Builder::new().spawn_scoped(scope, serve).is_err() {
                    self.connections.fetch_sub(1, Ordering::Relaxed);
                }
            }
        });
    }

    /// One request after the other, until one end has had enough.
    fn converse(&self, connection: &mut Connection) {
        loop {
            let asked = match connection.next() {
                Ok(asked) => asked,
                Err(NoRequest::Gone) => return,
                Err(NoRequest::Wrong(status, why)) => {
                    let _ = Reply::text(status, why).write(&mut connection.stream, true);
                    return;
                }
            };
            let closes = asked.closes;
            let done = match self.gate.look_at(&asked) {
                Some(reply) => reply.write(&mut connection.stream, closes),
                None => self.route(&asked, connection),
            };
            if done.is_err() || closes {
                return;
            }
        }
    }
}
