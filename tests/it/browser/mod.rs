//! A browser without a screen, driven as a person drives it: with mouse and keys. It is Chromium, or Firefox where BELTSPACE_BROWSER is
//! `firefox`.

mod chromium;
mod firefox;
mod wire;

use serde_json::Value;
use std::path::Path;
use std::process::Child;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How long anything may take before the test gives up.
const PATIENCE: Duration = Duration::from_secs(60);

/// What a browser of some kind can be told to do.
trait Driven {
    fn resize(&mut self, width: u32, height: u32);
    fn navigate(&mut self, address: &str);
    fn evaluate(&mut self, expression: &str) -> Result<Value, String>;
    /// `mouseMoved`, `mousePressed` or `mouseReleased`; is the button held?
    fn mouse(&mut self, kind: &str, x: f64, y: f64, held: bool);
    /// Presses a key, by the name that the page sees and the number that Windows has for it.
    fn key(&mut self, key: &str, code: u32, held: Held);
    fn choose_file(&mut self, selector: &str, file: &Path);
    /// A PNG of what is seen, in base64.
    fn picture(&mut self) -> Value;
    /// A PDF on paper of this size in inches, in base64.
    fn paper(&mut self, width: f64, height: f64) -> Value;
    /// What has happened since it was last asked.
    fn events(&mut self) -> Vec<Event>;
}

/// The key that is held while another one is pressed.
#[derive(Clone, Copy, PartialEq)]
enum Held {
    None,
    Control,
    Shift,
}

/// What a browser tells of a page.
enum Event {
    /// An error or a warning.
    Complaint(String),
    /// An address that was asked for.
    Request(String),
}

/// A page in a browser of its own.
pub struct Browser {
    process: Child,
    driven: Box<dyn Driven>,
    /// Errors and warnings of the page, and everything that it asked a network for.
    pub complaints: Vec<String>,
    /// The beginning of addresses that are its own, besides those of files.
    own: Option<String>,
    /// From starting the program to a page that can be used, of the first page.
    pub opened: Duration,
    _profile: TempDir,
}

/// Is it Firefox that is driven?
pub fn is_firefox() -> bool {
    match std::env::var("BELTSPACE_BROWSER").as_deref() {
        Ok("firefox") => true,
        Ok("chromium") | Err(std::env::VarError::NotPresent) => false,
        other => panic!("BELTSPACE_BROWSER is {other:?}; the tests drive `chromium` and `firefox`"),
    }
}

impl Browser {
    /// Starts a browser and opens a file by its `file://` address, `after` being put behind it, such as `#d=5`.
    pub fn open(file: &Path, after: &str) -> Self {
        let start = Instant::now();
        let mut browser = Self::start();
        browser.go_to(file, after);
        browser.opened = start.elapsed();
        browser
    }

    /// Starts a browser and opens an address of a server on this machine.
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
        let start = if is_firefox() { firefox::Firefox::start } else { chromium::Chromium::start };
        let (process, driven) = start(profile.path());
        let mut browser = Self { process, driven, complaints: Vec::new(), own: None, opened: Duration::ZERO, _profile: profile };
        browser.resize(1400, 1000);
        browser
    }

    /// Gives the page another size.
    pub fn resize(&mut self, width: u32, height: u32) {
        self.driven.resize(width, height);
    }

    /// Opens another file, or the same anew.
    pub fn go_to(&mut self, file: &Path, after: &str) {
        self.go_to_address(&format!("file://{}{after}", file.display()));
    }

    /// Opens an address.
    pub fn go_to_address(&mut self, address: &str) {
        // An address that differs in its fragment only would not load anything.
        self.driven.navigate("about:blank");
        self.driven.navigate(address);
        self.wait("document.readyState == 'complete' && window.beltspace !== undefined");
        let ready = self.evaluate("Promise.resolve(window.beltspace.ready).then(() => true)");
        assert_eq!(ready, true, "the page never became ready");
    }

    /// The value of an expression in the page.
    #[track_caller]
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let value = self.driven.evaluate(expression);
        self.note();
        value.unwrap_or_else(|error| panic!("{expression}: {error}"))
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
        self.driven.mouse(kind, x, y, kind == "mousePressed");
        self.note();
    }

    /// Drags from one point to another.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.mouse("mouseMoved", from[0], from[1]);
        self.mouse("mousePressed", from[0], from[1]);
        for step in 1..=5 {
            let part = f64::from(step) / 5.0;
            let [x, y] = [0, 1].map(|at| from[at] + part * (to[at] - from[at]));
            self.driven.mouse("mouseMoved", x, y, true);
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
        self.driven.key(key, code, Held::None);
        self.note();
    }

    /// Presses a button with the keyboard, or checks a box.
    pub fn press(&mut self, selector: &str) {
        let is_box = self
            .evaluate(&format!("(() => {{ const e = document.querySelector({selector:?}); e.focus(); return e.type === 'checkbox'; }})()"));
        if is_firefox() {
            // Without a screen its window is never the active one, and then no key presses a button.
            self.evaluate("document.activeElement.click()");
        } else if is_box == true {
            self.key(" ", 32);
        } else {
            self.key("Enter", 13);
        }
    }

    /// Goes back to what had the focus before.
    pub fn shift_tab(&mut self) {
        self.driven.key("Tab", 9, Held::Shift);
    }

    /// Presses a letter with the control key.
    pub fn control_key(&mut self, letter: char) {
        self.driven.key(&letter.to_string(), letter.to_ascii_uppercase().into(), Held::Control);
    }

    /// Chooses a file as a person does in the dialogue of the system.
    pub fn choose_file(&mut self, selector: &str, file: &Path) {
        self.driven.choose_file(selector, file);
    }

    /// The page as a PDF on A4.
    pub fn paper(&mut self) -> Vec<u8> {
        decoded(&self.driven.paper(8.27, 11.69))
    }

    /// The page as a picture, into the folder that BELTSPACE_PICTURES names, if it names one.
    pub fn picture(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("BELTSPACE_PICTURES") else { return };
        let bytes = decoded(&self.driven.picture());
        std::fs::create_dir_all(&folder).expect("the folder can be made");
        let browser = if is_firefox() { "firefox-" } else { "" };
        std::fs::write(Path::new(&folder).join(format!("{browser}{name}.png")), bytes).expect("a picture can be written");
    }

    fn note(&mut self) {
        for event in self.driven.events() {
            match event {
                Event::Complaint(text) => self.complaints.push(text),
                Event::Request(address) => {
                    let own = ["file://", "data:", "blob:", "about:"].into_iter().chain(self.own.as_deref());
                    if !own.into_iter().any(|scheme| address.starts_with(scheme)) {
                        self.complaints.push(format!("asked for {address}"));
                    }
                }
            }
        }
    }
}

fn decoded(base64: &Value) -> Vec<u8> {
    use base64::Engine;
    base64::engine::general_purpose::STANDARD.decode(base64.as_str().expect("it is text")).expect("it is base64")
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
