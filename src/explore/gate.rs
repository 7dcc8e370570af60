//! Who may ask: a browser that came with the token, from the page of this server.
//!
//! The server listens on this machine only, where other programs and every web page in the same browser can reach it. A page elsewhere
//! cannot read the answers, but it could ask, or have its name resolved to this machine. So the name that a request is for must be one of
//! this machine, a request must come from this very page, and it must bring the cookie that only the token buys.

use super::http::{HttpRequest, Reply};
use std::sync::atomic::{AtomicBool, Ordering};

/// Names of this machine. The port is not looked at: with a forwarded port it is another one for the browser.
const NAMES: [&str; 3] = ["127.0.0.1", "localhost", "[::1]"];

/// The secrets of a server.
pub struct Gate {
    /// In the address that is printed; may be used again.
    pub token: String,
    /// In the address that the browser is started with, where other users of this machine may see it: it works once.
    pub once: String,
    used: AtomicBool,
    cookie: String,
    name: String,
}

impl Gate {
    /// New secrets for the server on a port.
    ///
    /// # Errors
    /// If the system has no random numbers.
    pub fn new(port: u16) -> std::io::Result<Self> {
        let [token, once, cookie] = [secret()?, secret()?, secret()?];
        Ok(Self { token, once, used: AtomicBool::new(false), cookie, name: format!("beltspace_{port}") })
    }

    /// Lets a request in: `Ok(None)` for one with the cookie, an answer for one that brings a token or must stay outside.
    pub fn look_at(&self, asked: &HttpRequest) -> Option<Reply> {
        let Some(host) = asked.host.as_deref().filter(|host| is_of_this_machine(host)) else {
            return Some(Reply::text(421, "this server answers to the names 127.0.0.1 and localhost only"));
        };
        let foreign_origin = asked.origin.as_deref().is_some_and(|origin| origin != format!("http://{host}"));
        let foreign_site = asked.site.as_deref().is_some_and(|site| !["same-origin", "none"].contains(&site));
        // Following a link from elsewhere is no harm: the page then asks for the cookie all the same.
        if foreign_origin || (foreign_site && asked.path != "/") || (asked.method == "POST" && asked.origin.is_none()) {
            return Some(Reply::text(403, "this request comes from another page"));
        }
        if asked.path == "/"
            && let Some(token) = asked.query.strip_prefix("token=")
        {
            return Some(self.exchange(token));
        }
        let cookies = asked.cookie.split(';').filter_map(|it| it.trim().split_once('='));
        let mut own = cookies.filter(|(name, _)| *name == self.name);
        if own.any(|(_, value)| same(value, &self.cookie)) {
            return None;
        }
        Some(Reply::text(403, "open the whole address that beltspace explore has printed, with its token"))
    }

    /// The cookie for a token; the address without it is the next.
    fn exchange(&self, token: &str) -> Reply {
        let lasting = same(token, &self.token);
        let once = same(token, &self.once);
        if !lasting && (!once || self.used.swap(true, Ordering::Relaxed)) {
            return Reply::text(
                403,
                if once {
                    "this address was used before; open the one that beltspace explore has printed"
                } else {
                    "this token is not the one of this server; open the address that beltspace explore has printed"
                },
            );
        }
        let cookie = format!("{}={}; HttpOnly; SameSite=Strict; Path=/", self.name, self.cookie);
        Reply { headers: vec![("Location", "/".to_owned()), ("Set-Cookie", cookie)], ..Reply::text(303, "see /") }
    }
}

/// 128 random bits in hexadecimal digits.
fn secret() -> std::io::Result<String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(std::io::Error::other)?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Compares all of both, however early they differ: the time does not tell how much was right.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

fn is_of_this_machine(host: &str) -> bool {
    NAMES.iter().any(|name| {
        host.strip_prefix(name).is_some_and(|rest| {
            rest.is_empty() || rest.strip_prefix(':').is_some_and(|port| !port.is_empty() && port.bytes().all(|it| it.is_ascii_digit()))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(gate: &Gate) -> HttpRequest {
        HttpRequest {
            method: "GET".to_owned(),
            path: "/".to_owned(),
            host: Some("127.0.0.1:1234".to_owned()),
            cookie: format!("other=1; {}={};", gate.name, gate.cookie),
            ..HttpRequest::default()
        }
    }

    #[test]
    fn only_the_page_with_the_cookie_is_let_in() {
        let gate = Gate::new(1234).expect("there are random numbers");
        assert!(gate.look_at(&asked(&gate)).is_none());
        let status = |change: &dyn Fn(&mut HttpRequest)| {
            let mut asked = asked(&gate);
            change(&mut asked);
            gate.look_at(&asked).map_or(200, |reply| reply.status)
        };
        for name in ["localhost", "localhost:8080", "127.0.0.1", "[::1]:9"] {
            assert_eq!(status(&|it| it.host = Some(name.to_owned())), 200, "{name}");
        }
        for name in ["evil.example", "127.0.0.1.evil.example", "localhost:80:80", "localhost:", "0.0.0.0:1234", "127.0.0.1:1234@evil", ""] {
            assert_eq!(status(&|it| it.host = Some(name.to_owned())), 421, "{name}");
        }
        assert_eq!(status(&|it| it.host = None), 421);
        let origin = |text: &'static str| move |it: &mut HttpRequest| it.origin = Some(text.to_owned());
        assert_eq!(status(&origin("http://127.0.0.1:1234")), 200);
        for text in ["http://evil.example", "null", "http://127.0.0.1:1235", "https://127.0.0.1:1234", "http://localhost:1234"] {
            assert_eq!(status(&|it| it.origin = Some(text.to_owned())), 403, "{text}");
        }
        assert_eq!(status(&|it| it.method = "POST".to_owned()), 403, "a post without an origin");
        assert_eq!(status(&|it| (it.path, it.site) = ("/page.js".to_owned(), Some("cross-site".to_owned()))), 403);
        assert_eq!(status(&|it| it.cookie = String::new()), 403);
        assert_eq!(status(&|it| it.cookie = it.cookie.replace(&gate.cookie, &gate.cookie[1..])), 403);
        assert_eq!(status(&|it| it.cookie = format!("{}={}0", gate.name, gate.cookie)), 403);
    }

    #[test]
    fn a_token_buys_the_cookie_and_that_of_the_browser_does_so_once() {
        let gate = Gate::new(1).expect("there are random numbers");
        let with = |token: &str| {
            let asked = HttpRequest { query: format!("token={token}"), cookie: String::new(), ..asked(&gate) };
            gate.look_at(&asked).expect("it is answered")
        };
        for (token, status) in [
            ("", 403),
            ("0123", 403),
            (gate.once.as_str(), 303),
            (gate.once.as_str(), 403),
            (gate.token.as_str(), 303),
            (gate.token.as_str(), 303),
        ] {
            assert_eq!(with(token).status, status);
        }
        let headers = with(&gate.token).headers;
        assert!(headers.iter().any(|(name, value)| *name == "Set-Cookie" && value.contains("HttpOnly; SameSite=Strict")), "{headers:?}");
        assert!(headers.contains(&("Location", "/".to_owned())), "{headers:?}");
    }
}
