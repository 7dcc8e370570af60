//! The server as a client meets it, over sockets of this machine.

use super::{Explorer, MOST_CONNECTIONS};
use crate::live::Live;
use serde_json::Value;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

const SMALL: &str = "model = \"metal-cvt\"\n[design]\nband_count = { from = 6, to = 12 }\nband_thickness_mm = { from = 0.1, to = 0.3, count = 9 }\n\
    [operation]\nratio = { from = 0.5, to = 2, count = 5, spacing = \"log\" }\n[fixed]\nfriction = 0.08\n\
    [constraints]\ncapacity_axial_force_N = { max = 60000 }\n[objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n";
/// A sweep of it takes minutes.
const LONG: &str = "model = \"metal-cvt\"\n[design]\nband_count = { from = 1, to = 60 }\nband_thickness_mm = { from = 0.1, to = 0.3, count = 4000 }\n\
    groove_angle_deg = { from = 18, to = 30, count = 4000 }\n[operation]\nratio = { from = 0.5, to = 2, count = 200 }\n\
    [objectives]\ntorque_capacity_Nm = \"max\"\ncapacity_axial_force_N = \"min\"\n[report]\nhistograms = [{ of = \"torque_capacity_Nm\", bins = 9 }]\n";

fn started(text: &str, patience: Duration) -> &'static Explorer {
    let live = Live::new(text.to_owned(), "study.toml".to_owned(), PathBuf::from("."), 2);
    let words = Box::new(|command: &str, set: &[String]| format!("beltspace {command} study.toml {}", set.join(" ")));
    let mut explorer = Explorer::bind(live, 0, &[], words).expect("there is a free port");
    explorer.patience = patience;
    // The server ends with the tests.
    let explorer: &'static Explorer = Box::leak(Box::new(explorer));
    std::thread::spawn(|| explorer.serve());
    explorer
}

fn server() -> &'static Explorer {
    started(SMALL, Duration::from_secs(10))
}

struct Client {
    stream: TcpStream,
    host: String,
    cookie: String,
}

impl Client {
    /// A client that has come with the token.
    fn new(explorer: &Explorer) -> Self {
        let mut client = Self::stranger(explorer);
        let said = client.ask(&format!("GET /?token={} HTTP/1.1\r\nHost: {}\r\n\r\n", explorer.gate.token, client.host));
        assert!(said.starts_with("HTTP/1.1 303"), "{said}");
        let cookie = said.lines().find_map(|line| line.strip_prefix("Set-Cookie: ")).expect("there is a cookie");
        client.cookie = cookie.split(';').next().expect("it has a value").to_owned();
        client
    }

    fn stranger(explorer: &Explorer) -> Self {
        let host = format!("127.0.0.1:{}", explorer.port);
        let stream = TcpStream::connect(&host).expect("it listens");
        stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a socket takes a limit");
        Self { stream, host, cookie: String::new() }
    }

    /// Sends text and reads an answer of known length, with its head.
    fn ask(&mut self, text: &str) -> String {
        self.stream.write_all(text.as_bytes()).expect("it reads");
        self.answer()
    }

    fn answer(&mut self) -> String {
        let (mut read, mut bytes) = (Vec::new(), [0; 4096]);
        loop {
            let count = self.stream.read(&mut bytes).expect("it answers");
            read.extend_from_slice(&bytes[..count]);
            let text = String::from_utf8_lossy(&read).into_owned();
            let length = text.lines().find_map(|line| line.strip_prefix("Content-Length: ")?.parse::<usize>().ok());
            let head = text.find("\r\n\r\n").map(|at| at + 4);
            match (head, length) {
                (Some(head), Some(length)) if read.len() >= head + length => return text,
                (Some(_), None) if text.contains("chunked") => return text,
                _ if count == 0 => return text,
                _ => {}
            }
        }
    }

    fn get(&mut self, path: &str) -> String {
        let (host, cookie) = (self.host.clone(), self.cookie.clone());
        self.ask(&format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nCookie: {cookie}\r\n\r\n"))
    }

    fn send(&mut self, path: &str, body: &str, more: &str) {
        let (host, cookie) = (&self.host, &self.cookie);
        let more = if more.is_empty() { format!("Origin: http://{host}\r\nContent-Type: application/json\r\n") } else { more.to_owned() };
        let text =
            format!("POST {path} HTTP/1.1\r\nHost: {host}\r\nCookie: {cookie}\r\n{more}Content-Length: {}\r\n\r\n{body}", body.len());
        self.stream.write_all(text.as_bytes()).expect("it reads");
    }

    /// The parts of an answer until one is of this kind.
    fn until(&mut self, kind: &str) -> Vec<Value> {
        let (mut read, mut bytes, mut parts) = (Vec::new(), [0; 65536], Vec::new());
        loop {
            let count = self.stream.read(&mut bytes).expect("it answers");
            assert!(count > 0, "it ended before {kind}: {}", String::from_utf8_lossy(&read));
            read.extend_from_slice(&bytes[..count]);
            if let Some(head) = read.windows(4).position(|it| it == b"\r\n\r\n")
                && read.starts_with(b"HTTP/1.1 200")
            {
                read.drain(..head + 4);
            }
            while let Some((part, end)) = chunk(&read) {
                let length = u32::from_le_bytes(part[..4].try_into().expect("four bytes")) as usize;
                let told: Value = serde_json::from_slice(&part[8..8 + length]).expect("it is JSON");
                read.drain(..end);
                let found = told["kind"] == kind;
                parts.push(told);
                if found {
                    return parts;
                }
            }
        }
    }
}

/// The first chunk, if it is there as a whole, and where it ends.
fn chunk(read: &[u8]) -> Option<(Vec<u8>, usize)> {
    let line = read.windows(2).position(|it| it == b"\r\n")?;
    let length = usize::from_str_radix(std::str::from_utf8(&read[..line]).ok()?, 16).ok().filter(|it| *it > 0)?;
    let end = line + 2 + length + 2;
    (read.len() >= end).then(|| (read[line + 2..line + 2 + length].to_vec(), end))
}

fn status(text: &str) -> &str {
    text.get(9..12).unwrap_or(text)
}

#[test]
fn the_page_comes_with_the_token_and_nothing_else_does() {
    let explorer = server();
    let mut client = Client::new(explorer);
    let page = client.get("/");
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("/page.js") && page.contains("frame-ancestors 'none'"), "{page}");
    assert!(!page.contains("unsafe-inline") && !page.contains(&explorer.gate.token), "{page}");
    for path in ["/page.js", "/page.css", "/d3.js"] {
        assert_eq!(status(&client.get(path)), "200", "{path}");
    }
    for path in [
        "/../Cargo.toml",
        "/..%2fCargo.toml",
        "//etc/passwd",
        "/page.js/../../Cargo.toml",
        "/%2e%2e/",
        "/page.js%00",
        "/PAGE.JS",
        "/.",
        "/study.toml",
        "/answer",
        "http://127.0.0.1/page.js",
        "*",
    ] {
        assert_eq!(status(&client.get(path)), "404", "{path}");
    }
    let host = client.host.clone();
    let mut stranger = Client::stranger(explorer);
    for (text, wanted) in [
        (format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n"), "403"),
        (format!("GET /page.js HTTP/1.1\r\nHost: {host}\r\n\r\n"), "403"),
        (format!("GET /?token=0 HTTP/1.1\r\nHost: {host}\r\n\r\n"), "403"),
        (format!("GET / HTTP/1.1\r\nHost: evil.example\r\nCookie: {}\r\n\r\n", client.cookie), "421"),
        (format!("GET / HTTP/1.1\r\nHost: {host}\r\nOrigin: http://evil.example\r\nCookie: {}\r\n\r\n", client.cookie), "403"),
        (format!("DELETE / HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nCookie: {}\r\n\r\n", client.cookie), "405"),
    ] {
        let said = stranger.ask(&text);
        assert_eq!(status(&said), wanted, "{text}{said}");
    }
}

#[test]
fn a_change_is_answered_and_what_cannot_be_is_told() {
    let mut client = Client::new(server());
    client.send("/answer", r#"{"set": ["friction=0.09", "constraints.capacity_axial_force_N.max=50000"], "tab": 1}"#, "");
    let parts = client.until("counted");
    let exact = parts.iter().find(|it| it["kind"] == "exact").expect("there is an exact answer");
    assert!(exact["front"]["rows"].as_u64().is_some_and(|it| it > 3), "{exact}");
    let study = parts[0]["study"]["study"]["text"].as_str().expect("the first part has the study").to_owned();
    assert!(study.contains("friction = 0.09") && study.contains("max = 50000"), "{study}");
    assert!(parts.iter().any(|it| it["kind"] == "certified"));
    let counted = parts.last().expect("it is the last");
    let sample = &counted["sample"];
    assert_eq!(sample["rows"].as_u64(), counted["feasible"].as_u64().map(|it| it.min(2000)), "{sample}");
    assert!(
        sample["columns"].as_array().is_some_and(|it| it.len() >= 2) && sample["axes"].as_array().is_some_and(|it| it.len() == 2),
        "{sample}"
    );
    for (set, told) in [
        ("friction=-1", "out of range"),
        ("nothing.at.all=1", "begin with one of design"),
        ("design.band_count={csv=\\\"/etc/passwd\\\"}", "band_count"),
        ("design.cases.csv=/etc/passwd", "cannot be set"),
        ("model=\\\"/etc/passwd\\\"", "no input"),
        ("objectives.torque_capacity_Nm=up", "unknown goal"),
    ] {
        let mut client = Client::new(server());
        client.send("/answer", &format!("{{\"set\": [\"{set}\"]}}"), "");
        let said = client.until("error").pop().expect("it is told")["message"].to_string();
        assert!(said.contains(told) && !said.contains("root:"), "{set}: {said}");
    }
    let mut client = Client::new(server());
    for (body, more, wanted) in [
        ("{}", "Content-Type: application/json\r\n", "403"),
        ("{}", "Origin: http://evil.example\r\nContent-Type: application/json\r\n", "403"),
        ("set=friction", "", "400"),
        ("{\"path\": \"/etc\"}", "", "400"),
    ] {
        client.send("/answer", body, more);
        let said = client.answer();
        assert_eq!(status(&said), wanted, "{body} {more}: {said}");
    }
    let host = client.host.clone();
    client.send("/answer", "set=1", &format!("Origin: http://{host}\r\nContent-Type: application/x-www-form-urlencoded\r\n"));
    assert_eq!(status(&client.answer()), "415");
}

#[test]
fn a_design_and_what_is_around_it() {
    let mut client = Client::new(server());
    client.send("/design", r#"{"set": [], "design": "5"}"#, "");
    let design = client.until("design").pop().expect("it is told");
    assert!(design["outputs"].as_array().is_some_and(|it| it.len() > 10) && design["inputs"]["band_count"] == 6, "{design}");
    let mut client = Client::new(server());
    client.send("/around", r#"{"design": "5"}"#, "");
    let around = client.until("around").pop().expect("it is told");
    let inputs: Vec<_> = around["slices"].as_array().expect("a list").iter().map(|it| it["input"].clone()).collect();
    assert_eq!(inputs[..5], ["band_count", "band_thickness_mm", "ratio, the least", "ratio, the largest", "friction"], "{around}");
    // What the study leaves at its default comes last.
    let count = |name: &str| around[name].as_u64().expect("a number");
    assert!(count("defaults") > 5 && count("given") == count("defaults") + 3 && inputs.len() as u64 == count("given") + 2, "{inputs:?}");
    assert!(inputs[5..].iter().any(|it| it == "elastic_modulus_MPa"), "{inputs:?}");
    let mut client = Client::new(server());
    client.send("/around", r#"{"design": "63"}"#, "");
    assert!(client.until("error")[0]["message"].as_str().is_some_and(|it| it.contains("0 to 62")));
}

/// How many questions are being worked on.
fn at_work(explorer: &Explorer) -> usize {
    explorer.tabs.lock().expect("nobody panics").len()
}

fn wait_until(what: &str, is: impl Fn() -> bool) {
    let start = Instant::now();
    while !is() {
        assert!(start.elapsed() < Duration::from_secs(10), "never: {what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_tab_that_closes_ends_its_work_and_a_new_question_ends_the_old_one_of_its_tab_only() {
    let explorer = started(LONG, Duration::from_secs(10));
    let mut first = Client::new(explorer);
    first.send("/answer", r#"{"tab": 1}"#, "");
    let mut second = Client::new(explorer);
    second.send("/answer", r#"{"tab": 2}"#, "");
    wait_until("both are at work", || at_work(explorer) == 2);
    let of_first = explorer.tabs.lock().expect("nobody panics")[&1].clone();
    let of_second = explorer.tabs.lock().expect("nobody panics")[&2].clone();
    // The first tab asks for something else on another connection.
    let mut again = Client::new(explorer);
    again.send("/answer", r#"{"tab": 1, "set": ["design.band_count.to=50"]}"#, "");
    wait_until("the old question has ended", || of_first.stop.load(Ordering::Relaxed));
    assert!(!of_second.stop.load(Ordering::Relaxed), "the other tab was disturbed");
    drop(second);
    wait_until("the closed tab's work has ended", || of_second.stop.load(Ordering::Relaxed));
    drop((first, again));
    wait_until("nothing is at work", || at_work(explorer) == 0);
}

#[test]
fn the_study_is_told_as_it_is_changed_whatever_was_answered() {
    let maps = "[report]\nmaps = [{ x = \"band_count\", y = \"band_thickness_mm\", value = \"torque_capacity_Nm\" }]\n";
    let explorer = started(&format!("{SMALL}{maps}"), Duration::from_secs(10));
    let told = |set: &str| {
        let mut client = Client::new(explorer);
        client.send("/study", &format!(r#"{{"set": [{set}]}}"#), "");
        client.until("live").remove(0)
    };
    let text = |told: &Value, path: &str| told.pointer(path).and_then(Value::as_str).expect("a text").to_owned();
    let changed = told(r#""constraints.capacity_axial_force_N.max=50000""#);
    assert!(text(&changed, "/study/saved").contains("capacity_axial_force_N = { max = 50000 }"));
    assert!(text(&changed, "/command").ends_with("constraints.capacity_axial_force_N.max=50000"));
    assert_eq!(changed["notes"], serde_json::json!([]));
    // No option says that the study has no map any more, and the page says that it has none.
    let without = told(r#""objectives.torque_capacity_Nm=off""#);
    assert!(text(&without, "/command").starts_with("# no options say"), "{without}");
    assert!(text(&without, "/notes/0").contains("are without maps"), "{without}");
}

#[test]
fn the_goal_of_a_yield_is_changed_as_it_is_written() {
    let text = "model = \"metal-cvt\"\n[design]\nband_count = [6, 9]\n[operation]\ntorque_Nm = [50, 100]\n\
        [uncertainty]\nfriction = { normal = { mean = 0.09, sd = 0.005 } }\n[probability]\ndraws = 64\n[constraints]\nslip_margin = { min = 0 }\n\
        [objectives]\nyield = \"max\"\naxial_force_N = { goal = \"min\", over_draws = \"mean\" }\n";
    let mut client = Client::new(started(text, Duration::from_secs(10)));
    client.send("/start", "{}", "");
    let told = client.until("live").remove(0);
    let plain = |at: usize| told["controls"]["objectives"][at]["plain"].clone();
    assert_eq!((plain(0), plain(1)), (true.into(), false.into()), "{}", told["controls"]["objectives"]);
}

#[test]
fn large_slow_and_many_requests_are_turned_away() {
    let explorer = started(SMALL, Duration::from_millis(200));
    let mut client = Client::new(explorer);
    let host = client.host.clone();
    let said = client.ask(&format!("POST /answer HTTP/1.1\r\nHost: {host}\r\nContent-Length: 999999999\r\n\r\n"));
    assert_eq!(status(&said), "413", "{said}");
    let mut client = Client::stranger(explorer);
    let said = client.ask(&format!("GET / HTTP/1.1\r\nHost: {host}\r\nX: {}", "x".repeat(20_000)));
    assert_eq!(status(&said), "431", "{said}");
    // A client that sends a letter at a time is given up after a while, however busy it seems.
    let mut client = Client::stranger(explorer);
    let start = Instant::now();
    let mut ended = false;
    while start.elapsed() < Duration::from_secs(5) && !ended {
        std::thread::sleep(Duration::from_millis(20));
        ended = client.stream.write_all(b"G").is_err() || explorer.connections.load(Ordering::Relaxed) == 0;
    }
    assert!(ended && start.elapsed() < Duration::from_secs(2), "{:?}", start.elapsed());
    let held: Vec<_> = (0..MOST_CONNECTIONS).map(|_| Client::stranger(explorer)).collect();
    wait_until("all are held", || explorer.connections.load(Ordering::Relaxed) >= MOST_CONNECTIONS);
    let said = Client::stranger(explorer).answer();
    assert_eq!(status(&said), "503", "{said}");
    drop(held);
    wait_until("there is room again", || explorer.connections.load(Ordering::Relaxed) == 0);
    assert_eq!(status(&Client::new(explorer).get("/page.css")), "200");
}
