//! Checks the pictures of a result before a page takes them in: only elements and attributes that this program uses are allowed. Nothing
//! that a browser would run, fetch or link to is among them.

/// The elements, and the attributes that any of them may have.
const ELEMENTS: [&str; 9] = ["svg", "rect", "circle", "line", "polyline", "polygon", "path", "image", "text"];
const ATTRIBUTES: [&str; 41] = [
    "xmlns",
    "viewBox",
    "width",
    "height",
    "x",
    "y",
    "x1",
    "x2",
    "y1",
    "y2",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "d",
    "dx",
    "dy",
    "points",
    "transform",
    "fill",
    "fill-opacity",
    "fill-rule",
    "opacity",
    "stroke",
    "stroke-width",
    "stroke-opacity",
    "stroke-dasharray",
    "stroke-linecap",
    "stroke-linejoin",
    "font-family",
    "font-size",
    "font-weight",
    "font-style",
    "text-anchor",
    "dominant-baseline",
    "preserveAspectRatio",
    "href",
    "style",
    "class",
    "role",
];
const NAMESPACE: &str = "http://www.w3.org/2000/svg";
const RASTER: &str = "data:image/png;base64,";
const STYLE: &str = "image-rendering:pixelated";
/// Entities for characters.
const ENTITIES: [&str; 5] = ["amp;", "lt;", "gt;", "quot;", "apos;"];

/// Is this a picture that this program may have drawn?
///
/// # Errors
/// The first thing that none of its pictures contains.
pub fn check(svg: &str) -> Result<(), String> {
    let mut open: Vec<&str> = Vec::new();
    let mut rest = svg.trim();
    if !rest.starts_with("<svg ") {
        return Err("it does not begin with <svg>".to_owned());
    }
    while let Some(at) = rest.find('<') {
        let (text, tag) = rest.split_at(at);
        check_text(text, open.last() == Some(&"text"))?;
        let end = tag.find('>').ok_or("an element has no end")?;
        let (inside, after) = (&tag[1..end], &tag[end + 1..]);
        rest = after;
        if let Some(name) = inside.strip_prefix('/') {
            if open.pop() != Some(name.trim_end()) {
                return Err(format!("</{}> closes nothing", shortened(name)));
            }
        } else {
            let (inside, closed) = inside.strip_suffix('/').map_or((inside, false), |it| (it, true));
            let name = check_element(inside)?;
            if (name == "svg") != open.is_empty() {
                return Err("an <svg> is inside of another element".to_owned());
            }
            if !closed {
                open.push(name);
            }
        }
        if open.is_empty() {
            return if rest.is_empty() { Ok(()) } else { Err("there is something after </svg>".to_owned()) };
        }
    }
    Err(format!("<{}> is not closed", open.last().unwrap_or(&"svg")))
}

/// The name of an element from its tag without brackets; checks its attributes.
fn check_element(inside: &str) -> Result<&str, String> {
    let (name, mut rest) = inside.split_at(inside.find(char::is_whitespace).unwrap_or(inside.len()));
    if !ELEMENTS.contains(&name) {
        return Err(format!("it has an element <{}>", shortened(name)));
    }
    let mut seen = Vec::new();
    loop {
        rest = rest.trim_start();
        if rest.is_empty() {
            return Ok(name);
        }
        let broken = || format!("<{name}> has an attribute that is not written as name=\"value\"");
        let (attribute, after) = rest.split_once('=').ok_or_else(broken)?;
        let (value, after) = after.strip_prefix('"').and_then(|it| it.split_once('"')).ok_or_else(broken)?;
        if !ATTRIBUTES.contains(&attribute) || seen.contains(&attribute) {
            return Err(format!("<{name}> has an attribute {}", shortened(attribute)));
        }
        check_value(attribute, value).map_err(|()| format!("{attribute} of <{name}> is \"{}\"", shortened(value)))?;
        seen.push(attribute);
        rest = after;
    }
}

fn check_value(attribute: &str, value: &str) -> Result<(), ()> {
    let base64 = |it: &str| it.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"+/=".contains(&byte));
    let good = match attribute {
        "xmlns" => value == NAMESPACE,
        "style" => value == STYLE,
        "href" => value.strip_prefix(RASTER).is_some_and(base64),
        // No addresses, and no references to anything.
        _ => !value.contains([':', '\\', '#', '&']) && !value.contains("url") || is_colour(value),
    };
    if good { Ok(()) } else { Err(()) }
}

fn is_colour(value: &str) -> bool {
    value.strip_prefix('#').is_some_and(|it| !it.is_empty() && it.len() <= 8 && it.bytes().all(|byte| byte.is_ascii_hexdigit()))
}

/// Text may stand in text elements only; characters with a meaning in XML must be written as entities.
fn check_text(text: &str, within_text: bool) -> Result<(), String> {
    let known = |entity: &str| ENTITIES.iter().any(|it| entity.starts_with(it)) || entity.starts_with('#');
    if !within_text && !text.trim().is_empty() {
        return Err(format!("text stands where none belongs: \"{}\"", shortened(text.trim())));
    }
    match text.split('&').skip(1).find(|entity| !known(entity)) {
        Some(entity) => Err(format!("it has an entity &{}", shortened(entity))),
        None => Ok(()),
    }
}

fn shortened(text: &str) -> String {
    text.chars().take(40).flat_map(char::escape_default).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn pictures(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
        for entry in std::fs::read_dir(folder).expect("it can be listed") {
            let path = entry.expect("it can be listed").path();
            if path.is_dir() {
                pictures(&path, found);
            } else if path.extension().is_some_and(|it| it == "svg") {
                found.push(path);
            }
        }
    }

    #[test]
    fn every_picture_of_the_committed_results_passes() {
        let mut found = Vec::new();
        pictures(&Path::new(env!("CARGO_MANIFEST_DIR")).join("results"), &mut found);
        assert!(found.len() > 30, "{}", found.len());
        for path in found {
            let svg = std::fs::read_to_string(&path).expect("it is text");
            check(&svg).unwrap_or_else(|problem| panic!("{}: {problem}", path.display()));
        }
    }

    #[test]
    fn what_a_browser_would_run_fetch_or_link_to_does_not_pass() {
        let within = |inside: &str| format!("<svg xmlns=\"{NAMESPACE}\" width=\"9\" height=\"9\">\n{inside}\n</svg>\n");
        let good = "<text x=\"1\" fill=\"#222222\">a &lt; b &amp; c</text><image href=\"data:image/png;base64,iVBO+/=\" style=\"image-rendering:pixelated\"/>";
        assert_eq!(check(&within(good)), Ok(()));
        for bad in [
            "<script>alert(1)</script>",
            "<image href=\"x\" onerror=\"alert(1)\"/>",
            "<rect onclick=\"alert(1)\"/>",
            "<rect ONCLICK=\"alert(1)\"/>",
            "<foreignObject/>",
            "<a href=\"#\"/>",
            "<use href=\"#a\"/>",
            "<style>*{}</style>",
            "<animate attributeName=\"href\"/>",
            "<image href=\"https://example.org/x.png\"/>",
            "<image href=\"data:image/svg+xml;base64,AAAA\"/>",
            "<image href=\"data:image/png;base64,AA A\"/>",
            "<image xlink:href=\"data:image/png;base64,AAAA\"/>",
            "<rect fill=\"url(https://example.org)\"/>",
            "<rect fill=\"&#117;rl(x)\"/>",
            "<rect style=\"fill:red\"/>",
            "<rect x='1'/>",
            "<rect x=\"1\" x=\"2\"/>",
            "<!-- comment -->",
            "<![CDATA[ x ]]>",
            "<?xml-stylesheet href=\"x\"?>",
            "<text>&unknown;</text>",
            "words",
            "<svg width=\"1\"></svg>",
            "<text>",
            "</text>",
            "<rect",
        ] {
            assert!(check(&within(bad)).is_err(), "{bad}");
        }
        for bad in ["", "<!DOCTYPE svg><svg ></svg>", "<svg x=\"1\"></svg><script/>", "<svg x=\"1\"/>tail", "<svg x=\"1\">"] {
            assert!(check(bad).is_err(), "{bad}");
        }
    }
}
