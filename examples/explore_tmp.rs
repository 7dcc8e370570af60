#![allow(missing_docs)]
use beltspace::live::search::*;
use beltspace::plan::Plan;
use beltspace::screen::Control;
use beltspace::Study;
use std::time::Instant;
fn main() {
    let path = std::env::args().nth(1).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let mut set = None;
    for round in 0..8 {
        let t = Instant::now();
        let study = Study::parse_in(&text, "s", std::path::Path::new(&path).parent().unwrap()).unwrap();
        let parse = t.elapsed();
        let t = Instant::now();
        let plan = Plan::new(study);
        let control = Control::default();
        let plantime = t.elapsed();
        let t = Instant::now();
        let mut search = FrontSearch::new(&plan, 2, &control);
        let s = match set.take() { Some(s) => search.adopted(s).unwrap(), None => search.first_set().unwrap() };
        let start = t.elapsed();
        let n0 = s.count(plan.scenarios());
        let t = Instant::now();
        let c = search.coarse(&s, 20000).unwrap();
        let coarse = t.elapsed();
        let t = Instant::now();
        let (rows, s) = search.exact(s).unwrap();
        eprintln!("{round}: parse {parse:?} plan {plantime:?} set {start:?} {n0}; coarse {} {coarse:?}; exact {} {:?} with {}; slow {} fast {}", c.len(), rows.len(), t.elapsed(), s.count(plan.scenarios()), plan.slow.count(), plan.fast.count());
        set = Some(s);
    }
}
