//! The page itself: one template with its style, its scripts, the plotting library and the data inside.

use serde_json::Value;

const TEMPLATE: &str = include_str!("page/page.html");
const STYLE: &str = concat!(include_str!("page/style.css"), include_str!("page/choose/choose.css"));
/// D3 (<https://d3js.org>, licence in `page/vendor`): scales, axes, brushes and colours.
const D3: &str = include_str!("page/vendor/d3.min.js");
/// In the order of their dependencies.
const SCRIPTS: &[&str] = &[
    include_str!("page/base.js"),
    include_str!("page/decode.js"),
    include_str!("page/selection.js"),
    include_str!("page/colour.js"),
    include_str!("page/raster.js"),
    include_str!("page/crowd.js"),
    include_str!("page/axes.js"),
    include_str!("page/save.js"),
    include_str!("page/rows.js"),
    include_str!("page/pins.js"),
    include_str!("page/letters.js"),
    include_str!("page/known.js"),
    include_str!("page/choose/ranking.js"),
    include_str!("page/choose/stability.js"),
    include_str!("page/choose/weigh.js"),
    include_str!("page/choose/tradeoff.js"),
    include_str!("page/choose/importance.js"),
    include_str!("page/choose/explained.js"),
    include_str!("page/choose/dominance.js"),
    include_str!("page/choose/other_read.js"),
    include_str!("page/choose/others.js"),
    include_str!("page/matrix.js"),
    include_str!("page/yields.js"),
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
    include_str!("page/drive/values.js"),
    include_str!("page/drive/geometry.js"),
    include_str!("page/drive/sheet.js"),
    include_str!("page/drive/two_pulleys.js"),
    include_str!("page/drive/variator.js"),
    include_str!("page/drive/flat.js"),
    include_str!("page/drive/timing.js"),
    include_str!("page/drive/groove.js"),
    include_str!("page/drive/card.js"),
    include_str!("page/card.js"),
    include_str!("page/slices.js"),
    include_str!("page/tally.js"),
    include_str!("page/histograms.js"),
    include_str!("page/maps.js"),
    include_str!("page/figures.js"),
    include_str!("page/comparison.js"),
    include_str!("page/lists.js"),
    include_str!("page/start.js"),
];

/// Scripts that the page of a study in work has besides, before the last one.
#[cfg(feature = "cli")]
const LIVE_SCRIPTS: &[&str] = &[
    include_str!("page/live/stream.js"),
    include_str!("page/live/changes.js"),
    include_str!("page/live/fields.js"),
    include_str!("page/live/rows.js"),
    include_str!("page/live/controls.js"),
    include_str!("page/live/around.js"),
    include_str!("page/live/answer.js"),
    include_str!("page/live/start.js"),
];

/// What the page of a study in work is made of: address, type, and texts that follow one another.
#[cfg(feature = "cli")]
pub const LIVE_FILES: &[(&str, &str, &[&[&str]])] = &[
    ("/page.css", "text/css; charset=utf-8", &[&[STYLE, include_str!("page/live/live.css")]]),
    ("/d3.js", "text/javascript; charset=utf-8", &[&[D3]]),
    ("/page.js", "text/javascript; charset=utf-8", &[SCRIPTS, LIVE_SCRIPTS]),
];

/// The page of a study in work: the same, with its parts at addresses of their own.
#[cfg(feature = "cli")]
pub fn live_page() -> String {
    let mut page = String::with_capacity(TEMPLATE.len());
    let mut rest = TEMPLATE;
    // A policy that the server sends stands in place of the page's own, which allows what stands inside it.
    for (from, to, with) in [
        ("<meta http-equiv=", ">\n", ""),
        ("TITLE", "</title>", "beltspace explore</title>"),
        ("<style>", "</style>", "<link rel=\"stylesheet\" href=\"/page.css\">"),
        ("/*DATA*/", "</script>", "{\"kind\": \"live\"}</script>"),
        ("<script>/*D3*/", "</script>", "<script src=\"/d3.js\"></script>"),
        ("<script>/*SCRIPT*/", "</script>", "<script src=\"/page.js\"></script>"),
    ] {
        let (before, after) = rest.split_once(from).expect("the template has every marker, in this order");
        page.push_str(before);
        page.push_str(with);
        rest = after.split_once(to).expect("each part has an end").1;
    }
    page + rest
}

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
