//! Firefox over WebDriver BiDi, which it speaks itself.

use super::wire::Wire;
use super::{Driven, Event, Held, wait_for};
use serde_json::{Map, Value, json};
use std::path::Path;
use std::process::{Child, Command, Stdio};

pub struct Firefox {
    wire: Wire,
    /// The tab.
    context: Value,
}

impl Firefox {
    /// Starts it with a profile of its own.
    pub fn start(profile: &Path) -> (Child, Box<dyn Driven>) {
        let process = Command::new("firefox-esr")
            .args(["--headless", "--no-remote", "--remote-debugging-port=0", "--profile"])
            .arg(profile)
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("firefox-esr starts (Debian package firefox-esr)");
        let address = wait_for("firefox to listen", || {
            let text = std::fs::read_to_string(profile.join("WebDriverBiDiServer.json")).ok()?;
            let told: Value = serde_json::from_str(&text).ok()?;
            Some(format!("ws://{}:{}/session", told["ws_host"].as_str()?, told["ws_port"]))
        });
        let mut wire = Wire::new(&address);
        wire.call("session.new", &json!({ "capabilities": {} }));
        // Firefox logs nothing of a request that the page's security policy blocks; so the page writes it to the console.
        let blocked =
            "() => document.addEventListener('securitypolicyviolation', (event) => console.error(`blocked: ${event.blockedURI}`))";
        wire.call("script.addPreloadScript", &json!({ "functionDeclaration": blocked }));
        wire.call("session.subscribe", &json!({ "events": ["log.entryAdded", "network.beforeRequestSent"] }));
        let context = wire.call("browsingContext.getTree", &json!({}))["contexts"][0]["context"].clone();
        let mut own = Self { wire, context };
        // While the page of the start is loading, one that it is told to open may never count as loaded.
        wait_for("firefox to show its first page", || own.evaluate("document.readyState").ok().filter(|it| it == "complete"));
        (process, Box::new(own))
    }

    fn act(&mut self, kind: &str, actions: &Value) {
        let source = match kind {
            "key" => json!({ "type": kind, "id": "keyboard", "actions": actions }),
            _ => json!({ "type": kind, "id": "mouse", "actions": actions }),
        };
        self.wire.call("input.performActions", &json!({ "context": self.context, "actions": [source] }));
    }

    fn remote(&mut self, expression: &str) -> Result<Value, String> {
        let request = json!({ "expression": expression, "target": { "context": self.context }, "awaitPromise": true });
        let answer = self.wire.call("script.evaluate", &request);
        if answer["type"] == "success" { Ok(answer["result"].clone()) } else { Err(answer["exceptionDetails"].to_string()) }
    }
}

/// A value as JSON has it.
fn plain(remote: &Value) -> Value {
    let value = &remote["value"];
    let items = || value.as_array().into_iter().flatten();
    match remote["type"].as_str().unwrap_or_default() {
        // NaN and infinities come as text; JSON has no number for them.
        "number" => value.as_f64().map_or(Value::Null, |_| value.clone()),
        "string" | "boolean" => value.clone(),
        "array" => items().map(plain).collect(),
        "object" => {
            Value::Object(items().map(|pair| (pair[0].as_str().unwrap_or_default().to_owned(), plain(&pair[1]))).collect::<Map<_, _>>())
        }
        _ => Value::Null,
    }
}

impl Driven for Firefox {
    fn resize(&mut self, width: u32, height: u32) {
        let size = json!({ "context": self.context, "viewport": { "width": width, "height": height }, "devicePixelRatio": 1 });
        self.wire.call("browsingContext.setViewport", &size);
    }

    fn navigate(&mut self, address: &str) {
        self.wire.call("browsingContext.navigate", &json!({ "context": self.context, "url": address, "wait": "complete" }));
    }

    fn evaluate(&mut self, expression: &str) -> Result<Value, String> {
        Ok(plain(&self.remote(expression)?))
    }

    fn mouse(&mut self, kind: &str, x: f64, y: f64, _held: bool) {
        let to = json!({ "type": "pointerMove", "x": x.round(), "y": y.round() });
        let actions = match kind {
            "mousePressed" => json!([to, { "type": "pointerDown", "button": 0 }]),
            "mouseReleased" => json!([to, { "type": "pointerUp", "button": 0 }]),
            _ => json!([to]),
        };
        self.act("pointer", &actions);
    }

    fn key(&mut self, key: &str, _code: u32, held: Held) {
        let value = match key {
            "Enter" => "\u{e006}",
            "Escape" => "\u{e00c}",
            "Tab" => "\u{e004}",
            "ArrowLeft" => "\u{e012}",
            "ArrowUp" => "\u{e013}",
            "ArrowRight" => "\u{e014}",
            "ArrowDown" => "\u{e015}",
            "Home" => "\u{e011}",
            "End" => "\u{e010}",
            other => other,
        };
        let down = |value: &str| json!({ "type": "keyDown", "value": value });
        let up = |value: &str| json!({ "type": "keyUp", "value": value });
        let actions = match held {
            Held::None => json!([down(value), up(value)]),
            Held::Control => json!([down("\u{e009}"), down(value), up(value), up("\u{e009}")]),
            Held::Shift => json!([down("\u{e008}"), down(value), up(value), up("\u{e008}")]),
        };
        self.act("key", &actions);
    }

    fn choose_file(&mut self, selector: &str, file: &Path) {
        let found = self.remote(&format!("document.querySelector({selector:?})")).expect("a selector");
        let files = json!({ "context": self.context, "element": { "sharedId": found["sharedId"] }, "files": [file] });
        self.wire.call("input.setFiles", &files);
    }

    fn picture(&mut self) -> Value {
        self.wire.call("browsingContext.captureScreenshot", &json!({ "context": self.context }))["data"].clone()
    }

    fn paper(&mut self, width: f64, height: f64) -> Value {
        let page = json!({ "width": 2.54 * width, "height": 2.54 * height });
        self.wire.call("browsingContext.print", &json!({ "context": self.context, "background": true, "page": page }))["data"].clone()
    }

    fn events(&mut self) -> Vec<Event> {
        let of = |event: Value| {
            let parameters = &event["params"];
            match event["method"].as_str().unwrap_or_default() {
                "log.entryAdded" if matches!(parameters["level"].as_str(), Some("warn" | "error")) => {
                    Some(Event::Complaint(parameters.to_string()))
                }
                "network.beforeRequestSent" => Some(Event::Request(parameters["request"]["url"].as_str().unwrap_or_default().to_owned())),
                _ => None,
            }
        };
        self.wire.events.drain(..).filter_map(of).collect()
    }
}
