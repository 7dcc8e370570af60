//! Chromium over its debugging protocol.

use super::wire::Wire;
use super::{Driven, Event, Held, wait_for};
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Child, Command, Stdio};

pub struct Chromium(Wire);

impl Chromium {
    /// Starts it with a profile of its own.
    pub fn start(profile: &Path) -> (Child, Box<dyn Driven>) {
        let process = Command::new("chromium")
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars", "--remote-debugging-port=0"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync", "--window-size=1400,1000"])
            .arg(format!("--user-data-dir={}", profile.display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromium starts (Debian package chromium)");
        let address = wait_for("chromium to listen", || {
            let text = std::fs::read_to_string(profile.join("DevToolsActivePort")).ok()?;
            let (port, path) = text.split_once('\n')?;
            Some(format!("ws://127.0.0.1:{}{}", port.trim(), path.trim()))
        });
        let mut wire = Wire::new(&address);
        let target = wire.call("Target.createTarget", &json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = wire.call("Target.attachToTarget", &json!({ "targetId": target, "flatten": true }));
        wire.session = Some(attached["sessionId"].as_str().expect("a session has a name").to_owned());
        for domain in ["Page", "Runtime", "Log", "Network"] {
            wire.call(&format!("{domain}.enable"), &json!({}));
        }
        (process, Box::new(Self(wire)))
    }
}

impl Driven for Chromium {
    fn resize(&mut self, width: u32, height: u32) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.0.call("Emulation.setDeviceMetricsOverride", &size);
    }

    fn navigate(&mut self, address: &str) {
        self.0.call("Page.navigate", &json!({ "url": address }));
    }

    fn evaluate(&mut self, expression: &str) -> Result<Value, String> {
        let request = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.0.call("Runtime.evaluate", &request);
        let error = &answer["exceptionDetails"];
        if error.is_null() { Ok(answer["result"]["value"].clone()) } else { Err(error.to_string()) }
    }

    fn mouse(&mut self, kind: &str, x: f64, y: f64, held: bool) {
        let (button, count) = if kind == "mouseMoved" && !held { ("none", 0) } else { ("left", i32::from(kind != "mouseMoved")) };
        self.0.call(
            "Input.dispatchMouseEvent",
            &json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": i32::from(held), "clickCount": count }),
        );
    }

    fn key(&mut self, key: &str, code: u32, held: Held) {
        let text = if key == "Enter" { "\r" } else { "" };
        let modifiers = [0, 2, 8][held as usize];
        let named = if held == Held::Control { format!("Key{}", key.to_uppercase()) } else { key.to_owned() };
        for kind in ["keyDown", "keyUp"] {
            self.0.call(
                "Input.dispatchKeyEvent",
                &json!({ "type": kind, "key": key, "code": named, "windowsVirtualKeyCode": code, "text": text, "modifiers": modifiers }),
            );
        }
    }

    fn choose_file(&mut self, selector: &str, file: &Path) {
        let document = self.0.call("DOM.getDocument", &json!({}))["root"]["nodeId"].clone();
        let found = self.0.call("DOM.querySelector", &json!({ "nodeId": document, "selector": selector }))["nodeId"].clone();
        self.0.call("DOM.setFileInputFiles", &json!({ "nodeId": found, "files": [file] }));
    }

    fn picture(&mut self) -> Value {
        self.0.call("Page.captureScreenshot", &json!({ "format": "png" }))["data"].clone()
    }

    fn paper(&mut self, width: f64, height: f64) -> Value {
        let size = json!({ "printBackground": true, "paperWidth": width, "paperHeight": height });
        self.0.call("Page.printToPDF", &size)["data"].clone()
    }

    fn events(&mut self) -> Vec<Event> {
        let of = |event: Value| {
            let parameters = &event["params"];
            match event["method"].as_str().unwrap_or_default() {
                "Runtime.exceptionThrown" => Some(Event::Complaint(parameters["exceptionDetails"].to_string())),
                "Log.entryAdded" => Some(Event::Complaint(parameters["entry"].to_string())),
                "Runtime.consoleAPICalled" if parameters["type"] != "log" => Some(Event::Complaint(parameters.to_string())),
                "Network.requestWillBeSent" => Some(Event::Request(parameters["request"]["url"].as_str().unwrap_or_default().to_owned())),
                _ => None,
            }
        };
        self.0.events.drain(..).filter_map(of).collect()
    }
}
