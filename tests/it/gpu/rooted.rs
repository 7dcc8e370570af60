//! Square roots and arc sines with error bounds of any size: a device's bound must hold what the exact function can be, with no factor
//! on it. Where a bound is steep or stops being so, half an ULP of the argument decides.

use super::device;
use beltspace::gpu::PointKernel;
use beltspace::models::{Condition, Fields, Formula, Input, Model, Output, Range, Set, Worse};
use beltspace::real::Real;
use beltspace::record;
use beltspace::units::NONE;
use std::sync::Arc;

record!(Inputs { at, bound });
record!(Prepared { arc });
record!(Outputs { arc, root });

struct Rooted;

impl Formula for Rooted {
    const FIELDS: Fields = Fields::new(Inputs::NAMES, Prepared::NAMES, Outputs::NAMES, 1);

    fn prepare<R: Real>(inputs: &[R], _wanted: Set, prepared: &mut [R]) {
        Prepared { arc: Inputs::read(inputs).at.asin() }.write(prepared);
    }

    fn conditions<R: Real>(_prepared: &[R::Shared], inputs: &[R], _wanted: Set, margins: &mut [R]) {
        margins[0] = Inputs::read(inputs).bound;
    }

    fn finish<R: Real>(prepared: &[R::Shared], inputs: &[R], _wanted: Set, outputs: &mut [R]) {
        Outputs { arc: Prepared::<R>::shared(prepared).arc, root: Inputs::read(inputs).at.sqrt() }.write(outputs);
    }
}

fn rooted() -> Arc<Model> {
    let input = |name: &str| Input::new(name, name, NONE, 0.5, (0.0, 1.0), "An argument.", "chosen").valid(Range::between(-1e6, 1e6));
    let output = |name: &str| Output::new(name, name, NONE, Worse::Higher, name, "A function.");
    Arc::new(
        Model::new("rooted", Rooted)
            .inputs([input("at"), input("bound")])
            .outputs([output("arc"), output("root")])
            .conditions([Condition::new("none", false, &[], "There is a bound.")]),
    )
}

/// Arguments with the bound of each: all near one, those of every size, and bounds of every size about each.
fn points() -> Vec<Vec<f64>> {
    let steps = (0..300u32).map(|it| f64::from(f32::from_bits(1f32.to_bits() - it)));
    let sizes = (-60..20).flat_map(|power| [1.0, 1.2, 1.5, 1.9].map(|it| f64::from(it * 2f32.powi(power))));
    let spread = (0..=400).map(|it| f64::from(it as f32 / 400.0));
    let places: Vec<f64> = steps.chain(sizes.filter(|it| *it <= 2.0)).chain(spread).flat_map(|it| [it, -it]).collect();
    let bounds = (-120..8).flat_map(|sixth| [0.0, 0.03].map(|more| f64::from((f64::from(sixth) / 4.0 + more).exp2() as f32)));
    let bounds: Vec<f64> = bounds.chain([0.0, 1.0, 2.0]).collect();
    places.iter().flat_map(|&at| bounds.iter().map(move |&bound| vec![at, bound])).collect()
}

/// The largest fraction of its bound that an arc sine and a square root can be off by, where the text of the kernel is this.
fn most_used(source: &str) -> [f64; 2] {
    let kernel = PointKernel::from_source(&device().device, &rooted(), source).expect("the kernel compiles");
    let points = points();
    let found = kernel.evaluate(&points).expect("the device works");
    let mut most = [0f64; 2];
    for (point, (outputs, _)) in points.iter().zip(&found) {
        let ends = [point[0] - point[1], point[0] + point[1]];
        let exact: [fn(f64) -> f64; 2] = [|x| x.clamp(-1.0, 1.0).asin(), |x| x.max(0.0).sqrt()];
        for (most, (output, exact)) in most.iter_mut().zip(outputs.iter().zip(exact)) {
            let off = ends.map(|end| (f64::from(output.value) - exact(end)).abs());
            *most = most.max(off[0].max(off[1]) / output.bound);
        }
    }
    most
}

#[test]
fn roots_and_arc_sines_stay_within_their_own_bounds() {
    let plain = PointKernel::source(&rooted(), &[]).expect("it has a kernel");
    let reading = "    inputs.at = given[at + 0u];";
    assert!(plain.contains(reading), "{plain}");
    // The second input is the bound of the first.
    let source = plain.replace(reading, "    inputs.at = Real(given[at].value, given[at + 1u].value);");
    let used = most_used(&source);
    assert!(used.iter().all(|it| (0.9..=1.0).contains(it)), "{used:?}");
    // Two mistakes that there were: an end that is rounded towards zero, and two arguments that are more than 1 apart.
    for (right, wrong) in [(" * 1.00000024", ""), ("select(f32(2.2215), 1.5708, a.bound <= 1.0)", "1.5708")] {
        assert!(source.contains(right), "{right}");
        assert!(most_used(&source.replace(right, wrong))[0] > 1.1, "nobody notices {right}");
    }
}
