//! Chromium without a screen, driven as a person drives it: with mouse and keys, over its debugging protocol.

use serde_json::{Value, json};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// How long anything may take before the test gives up.
const PATIENCE: Duration = Duration::from_secs(60);

/// A page in a browser of its own.
pub struct Browser {
    process: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    session: String,
    next: u64,
    /// Errors and warnings of the page, and everything that it asked a network for.
    pub complaints: Vec<String>,
    /// The beginning of addresses that are its own, besides those of files.
    own: Option<String>,
    /// From starting the program to a page that can be used, of the first page.
    pub opened: Duration,
    _profile: TempDir,
}

impl Browser {
    /// Starts `chromium` and opens a file by its `file://` address, `after` being put behind it, such as `#d=5`.
    pub fn open(file: &Path, after: &str) -> Self {
        let start = Instant::now();
        let mut browser = Self::start();
        browser.go_to(file, after);
        browser.opened = start.elapsed();
        browser
    }

    /// Starts `chromium` and opens an address of a server on this machine.
    pub fn open_at(address: &str) -> Self {
        let start = Instant::now();
        let mut browser = Self::start();
        browser.own = address.find("/?").map(|end| address[..=end].to_owned());
        browser.go_to_address(address);
        browser.opened = start.elapsed();
        browser
    }

    fn start() -> Self {
        let profile = tempfile::tempdir().expect("there is room for a profile");
        let process = Command::new("chromium")
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars", "--remote-debugging-port=0"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync", "--window-size=1400,1000"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("chromium starts (Debian package chromium)");
        let address = wait_for("chromium to listen", || {
            let text = std::fs::read_to_string(profile.path().join("DevToolsActivePort")).ok()?;
            let (port, path) = text.split_once('\n')?;
            Some(format!("ws://127.0.0.1:{}{}", port.trim(), path.trim()))
        });
        let (socket, _) = tungstenite::connect(&address).expect("chromium answers");
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(PATIENCE)).expect("a socket takes a limit");
        }
        let mut browser = Self {
            process,
            socket,
            session: String::new(),
            next: 0,
            complaints: Vec::new(),
            own: None,
            opened: Duration::ZERO,
            _profile: profile,
        };
        let target = browser.call("Target.createTarget", &json!({ "url": "about:blank" }))["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", &json!({ "targetId": target, "flatten": true }));
        browser.session = attached["sessionId"].as_str().expect("a session has a name").to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), &json!({}));
        }
        browser.resize(1400, 1000);
        browser
    }

    /// Gives the page another size.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", &size);
    }

    /// Opens another file, or the same anew.
    pub fn go_to(&mut self, file: &Path, after: &str) {
        self.go_to_address(&format!("file://{}{after}", file.display()));
    }

    /// Opens an address.
    pub fn go_to_address(&mut self, address: &str) {
        // An address that differs in its fragment only would not load anything.
        self.call("Page.navigate", &json!({ "url": "about:blank" }));
        self.call("Page.navigate", &json!({ "url": address }));
        self.wait("document.readyState == 'complete' && window.beltspace !== undefined");
        let ready = self.evaluate("Promise.resolve(window.beltspace.ready).then(() => true)");
        assert_eq!(ready, true, "the page never became ready");
    }

    /// The value of an expression in the page.
    #[track_caller]
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let request = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", &request);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }

    /// A number in the page.
    #[track_caller]
    pub fn number(&mut self, expression: &str) -> f64 {
        let value = self.evaluate(expression);
        value.as_f64().unwrap_or_else(|| panic!("{expression} is {value}"))
    }

    /// A text in the page.
    #[track_caller]
    pub fn text(&mut self, expression: &str) -> String {
        let value = self.evaluate(expression);
        value.as_str().unwrap_or_else(|| panic!("{expression} is {value}")).to_owned()
    }

    /// Waits until something is true.
    #[track_caller]
    pub fn wait(&mut self, condition: &str) {
        let start = Instant::now();
        while self.evaluate(&format!("Boolean({condition})")) != true {
            assert!(start.elapsed() < PATIENCE, "never came true: {condition}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The rectangle of the first element that a selector finds, brought into view: left, top, width, height. The page may still be at
    /// work, and what it shows next may push the element aside: so its place counts once it has stayed the same over three frames.
    #[track_caller]
    pub fn rectangle(&mut self, selector: &str) -> [f64; 4] {
        let script = format!(
            "(async () => {{ let [last, same] = ['', 0]; \
             for (let frame = 0; frame < 600; frame++) {{ \
             const e = document.querySelector({selector:?}); if (!e) return null; \
             e.scrollIntoView({{block: 'center', behavior: 'instant'}}); \
             const r = e.getBoundingClientRect(); const place = [r.left, r.top, r.width, r.height]; \
             same = place.join() === last ? same + 1 : 0; last = place.join(); if (same === 3) return place; \
             await new Promise((done) => requestAnimationFrame(done)); }} return 'it never comes to rest'; }})()"
        );
        let found = self.evaluate(&script);
        let numbers: Vec<f64> =
            found.as_array().unwrap_or_else(|| panic!("{selector}: {found}")).iter().filter_map(Value::as_f64).collect();
        numbers.try_into().expect("a rectangle has four numbers")
    }

    /// Moves, presses or releases the mouse.
    pub fn mouse(&mut self, kind: &str, x: f64, y: f64) {
        let buttons = i32::from(kind != "mouseReleased");
        let (button, count) = if kind == "mouseMoved" { ("none", 0) } else { ("left", 1) };
        self.call(
            "Input.dispatchMouseEvent",
            &json!({ "type": kind, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": count }),
        );
    }

    /// Drags from one point to another.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mouseMoved", from[0], from[1]);
        self.mouse("mousePressed", from[0], from[1]);
        for step in 1..=5 {
            let part = f64::from(step) / 5.0;
            let [x, y] = [0, 1].map(|at| from[at] + part * (to[at] - from[at]));
            let held = json!({ "type": "mouseMoved", "x": x, "y": y, "button": "left", "buttons": 1 });
            self.call("Input.dispatchMouseEvent", &held);
        }
        self.mouse("mouseReleased", to[0], to[1]);
    }

    /// Clicks a point.
    pub fn click(&mut self, x: f64, y: f64) {
        self.mouse("mouseMoved", x, y);
        self.mouse("mousePressed", x, y);
        self.mouse("mouseReleased", x, y);
    }

    /// Clicks the middle of an element.
    #[track_caller]
    pub fn click_on(&mut self, selector: &str) {
        let [left, top, width, height] = self.rectangle(selector);
        self.click(left + width / 2.0, top + height / 2.0);
    }

    /// Presses a key, by the name that the page sees.
    pub fn key(&mut self, key: &str, code: u32) {
        let text = if key == "Enter" { "\r" } else { "" };
        for kind in ["keyDown", "keyUp"] {
            self.call(
                "Input.dispatchKeyEvent",
                &json!({ "type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code, "text": text }),
            );
        }
    }

    /// The page as a picture, into the folder that BELTSPACE_PICTURES names, if it names one.
    pub fn picture(&mut self, name: &str) {
        use base64::Engine;
        let Some(folder) = std::env::var_os("BELTSPACE_PICTURES") else { return };
        let picture = self.call("Page.captureScreenshot", &json!({ "format": "png" }));
        let bytes = base64::engine::general_purpose::STANDARD.decode(picture["data"].as_str().expect("it is text")).expect("it is base64");
        std::fs::create_dir_all(&folder).expect("the folder can be made");
        std::fs::write(Path::new(&folder).join(format!("{name}.png")), bytes).expect("a picture can be written");
    }

    /// Sends a command and waits for its answer; events that come in between are noted.
    #[track_caller]
    pub fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.next += 1;
        let mut message = json!({ "id": self.next, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = self.session.as_str().into();
        }
        self.socket.send(Message::text(message.to_string())).expect("chromium listens");
        loop {
            let text = self.socket.read().unwrap_or_else(|error| panic!("{method}: chromium does not answer: {error}"));
            let Message::Text(text) = text else { continue };
            let answer: Value = serde_json::from_str(&text).expect("chromium speaks JSON");
            if answer["id"] == self.next {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.note(&answer);
        }
    }

    fn note(&mut self, event: &Value) {
        let parameters = &event["params"];
        match event["method"].as_str().unwrap_or_default() {
            "Runtime.exceptionThrown" => self.complaints.push(parameters["exceptionDetails"].to_string()),
            "Log.entryAdded" => self.complaints.push(parameters["entry"].to_string()),
            "Runtime.consoleAPICalled" if parameters["type"] != "log" => self.complaints.push(parameters.to_string()),
            "Network.requestWillBeSent" => {
                let address = parameters["request"]["url"].as_str().unwrap_or_default();
                let own = ["file://", "data:", "blob:", "about:"].into_iter().chain(self.own.as_deref());
                let own = own.into_iter().any(|scheme| address.starts_with(scheme));
                if !own {
                    self.complaints.push(format!("asked for {address}"));
                }
            }
            _ => {}
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn wait_for<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < PATIENCE, "waited in vain for {what}");
        std::thread::sleep(Duration::from_millis(20));
    }
}
