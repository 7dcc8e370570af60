//! Bounds against looking at every design.

use super::*;
use crate::study::Study;

#[test]
fn debug() {
    let text = std::fs::read_to_string("/tmp/b7/g98.toml").unwrap();
    let plan = Plan::new(Study::parse(&text, "x.toml", ".".as_ref()).unwrap());
    let layout = Layout::new(&plan).unwrap();
    eprintln!("ops {} merits {:?}", layout.tape.operations.len(), layout.tape.merits);
    let product = layout.product(&plan).unwrap();
    eprintln!("axes {:b} needed {}", product.asked.axis_set(), layout.tape.needed_by(&[layout.tape.merits[0].1]).len());
    let mut b = Bounder::new(&layout.tape, &layout.axes);
    let mut s = layout.axes.whole();
    for _ in 0..8 {
        let it = b.bounds(&product.asked, &s);
        eprintln!("{:?} most {} least {} spread {:?} mono {:b}", &s.0[..5], it.most*product.unit, it.least*product.unit, &it.spread[..5], it.monotone);
        for t in layout.targets(&plan, Sought::Front) { let it = b.bounds(&t.asked, &s); eprintln!("    {} {} mono {:b} strict {:b} spread {:?}", it.least, it.most, it.monotone, it.strict, &it.spread[..5]); }
        for a in 0..5 { if !s[a].is_single() {s[a] = s[a].halves()[1]; }} s[3]=axes::Span{low:10,high:20};
    }
    let start = std::time::Instant::now();
    for i in 0..10000u32 { let mut s = layout.axes.whole(); for a in 0..4 { s[a] = axes::Span{low: (i>>a)%50, high: (i>>a)%50+7}; } s[4] = axes::Span::at(3); b.bounds(&product.asked, &s); }
    eprintln!("product {:?} per box", start.elapsed()/10000);
    let t = layout.targets(&plan, Sought::Front);
    let start = std::time::Instant::now();
    for i in 0..10000u32 { let mut s = layout.axes.whole(); for a in 0..4 { s[a] = axes::Span{low: (i>>a)%50, high: (i>>a)%50+7}; } s[4] = axes::Span::at(3); b.bounds(&t[0].asked, &s); }
    eprintln!("target {:?} per box", start.elapsed()/10000);
    let start = std::time::Instant::now();
    for i in 0..10000u32 { let mut s = layout.axes.whole(); for a in 0..4 { s[a] = axes::Span{low: (i>>a)%50, high: (i>>a)%50+7}; } s[4] = axes::Span::at(3); b.range(&t[0].asked, &s); }
    eprintln!("range {:?} per box", start.elapsed()/10000);
    let start = std::time::Instant::now();
    let open = all_open(&layout.requirements, &layout.axes);
    for i in 0..10000u32 { let mut s = layout.axes.whole(); for a in 0..4 { s[a] = axes::Span{low: (i>>a)%50, high: (i>>a)%50+7}; } s[4] = axes::Span::at(3); open::decide(&layout.requirements, &mut b, &layout.axes, &s, &open); }
    eprintln!("decide {:?} per box", start.elapsed()/10000);
    eprintln!("effort {:?}", plan.effort());
}
