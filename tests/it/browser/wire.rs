//! Commands and events of a browser over its WebSocket.

use super::PATIENCE;
use serde_json::{Value, json};
use std::net::TcpStream;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// A connection to a browser.
pub struct Wire {
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    next: u64,
    /// The page that commands are for, where the protocol wants that named outside of them.
    pub session: Option<String>,
    /// What came while an answer was awaited.
    pub events: Vec<Value>,
}

impl Wire {
    pub fn new(address: &str) -> Self {
        let (socket, _) = tungstenite::connect(address).expect("the browser answers");
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).expect("a socket takes a limit");
        }
        Self { socket, next: 0, session: None, events: Vec::new() }
    }

    /// Sends a command and waits for its answer.
    #[track_caller]
    pub fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.next += 1;
        let mut message = json!({ "id": self.next, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = session.as_str().into();
        }
        self.socket.send(Message::text(message.to_string())).expect("the browser listens");
        loop {
            let text = self.socket.read().unwrap_or_else(|error| panic!("{method}: the browser does not answer: {error}"));
            let Message::Text(text) = text else { continue };
            let answer: Value = serde_json::from_str(&text).expect("browsers speak JSON");
            if answer["id"] == self.next {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].clone();
            }
            self.events.push(answer);
        }
    }
}
