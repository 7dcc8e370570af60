//! The page itself: one template with its style, its scripts, the plotting library and the data inside.

use serde_json::Value;

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/style.css");
/// D3 (<https://d3js.org>, licence in `page/vendor`): scales, axes, brushes and colours.
const D3: &str = include_str!("page/vendor/d3.min.js");
/// In the order of their dependencies.
const SCRIPTS: &[&str] = &[
    include_str!("page/base.js"),
    include_str!("page/decode.js"),
    include_str!("page/selection.js"),
    include_str!("page/colour.js"),
    include_str!("page/raster.js"),
    include_str!("page/matrix.js"),
    include_str!("page/readout.js"),
    include_str!("page/strip.js"),
    include_str!("page/lines.js"),
    include_str!("page/parallel.js"),
    include_str!("page/address.js"),
    include_str!("page/theme.js"),
    include_str!("page/overview.js"),
    include_str!("page/bar.js"),
    include_str!("page/chooser.js"),
    include_str!("page/table.js"),
    include_str!("page/card.js"),
    include_str!("page/tally.js"),
    include_str!("page/histograms.js"),
    include_str!("page/maps.js"),
    include_str!("page/figures.js"),
    include_str!("page/comparison.js"),
    include_str!("page/lists.js"),
    include_str!("page/start.js"),
];

/// The page that shows some data: one file that needs no other file and no network.
pub fn page(title: &str, data: &Value) -> String {
    // The data must not contain the end tag of the element that holds it.
    let data = data.to_string().replace('<', "\\u003c");
    let parts = [
        ("TITLE", escaped(title)),
        ("/*STYLE*/", STYLE.to_owned()),
        ("/*DATA*/", data),
        ("/*D3*/", D3.to_owned()),
        ("/*SCRIPT*/", SCRIPTS.concat()),
    ];
    let mut page = String::with_capacity(TEMPLATE.len() + parts.iter().map(|(_, part)| part.len()).sum::<usize>());
    let mut rest = TEMPLATE;
    for (marker, part) in parts {
        let (before, after) = rest.split_once(marker).expect("the template has every marker, in this order");
        page.push_str(before);
        page.push_str(&part);
        rest = after;
    }
    page + rest
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::names::GENERATOR;

    #[test]
    fn nothing_inside_ends_its_element_and_nothing_is_fetched() {
        for script in SCRIPTS.iter().chain([&D3]) {
            assert!(!script.contains("</script") && !script.contains("<!--"));
        }
        let data = serde_json::json!({ "title": "</script><script>alert(1)</script>" });
        assert!(TEMPLATE[..1000].contains(GENERATOR));
        let page = page("a < b & \"c\"", &data);
        assert!(page.contains("<title>a &lt; b &amp; &quot;c&quot;"), "{}", &page[..500]);
        assert_eq!(page.matches("</script>").count(), TEMPLATE.matches("</script>").count());
        let own = [TEMPLATE, STYLE].into_iter().chain(SCRIPTS.iter().copied());
        for text in own {
            for fetch in ["src=\"", "href=\"http", "@import", "url(http", "fetch(", "XMLHttpRequest", "import("] {
                assert!(!text.contains(fetch), "{fetch}");
            }
        }
    }
}
