//! A GPU in hardware: the tests of the other files, run on hardware. Without such a GPU these tests fail; a software device never takes its
//! place.

use super::{Prepared, SMALL, assert_same, opened, shipped};
use beltspace::gpu::{Adapter, PointKernel, adapters};
use beltspace::models;
use beltspace::study::Study;
use beltspace::sweep::OnDevice;
use beltspace::verify::{compare, points_of_model};

fn hardware() -> OnDevice {
    let adapters = adapters();
    let there: Vec<_> = adapters.iter().map(Adapter::in_words).collect();
    let adapter = adapters.iter().find(|it| it.is_hardware());
    let adapter = adapter.unwrap_or_else(|| panic!("there is no GPU in hardware, only: [{}]", there.join(", ")));
    println!("on {}", adapter.in_words());
    opened(adapter)
}

#[test]
#[ignore = "needs a GPU in hardware: cargo test --test it -- --ignored gpu::hardware"]
fn hardware_gives_the_answers_of_f64() {
    let device = hardware();
    let small = SMALL.iter().map(|text| Prepared::parse(text));
    let shipped = shipped().into_iter().map(|path| Prepared::new(Study::read(&path).expect("the study is right").0));
    // Sums over a spectrum are for the CPU: the test on lavapipe has the refusal.
    for study in small.chain(shipped).filter(|it| !it.plan.study.decides_by_spectrum()) {
        let (state, record) = study.on(&device).expect("the device works");
        assert_same(&state, &study.on_cpu(), &study.plan.study.title);
        assert_eq!(record.designs, study.plan.designs());
    }
}

#[test]
#[ignore = "needs a GPU in hardware: cargo test --test it -- --ignored gpu::hardware"]
fn hardware_keeps_the_error_bounds_of_every_model() {
    let device = hardware();
    for model in models::all().iter().filter(|model| model.on_gpu) {
        let kernel = PointKernel::new(&device.device, model, &[]).expect("the kernel compiles");
        let report = compare(&kernel, model, &[], &points_of_model(model, 150_000, 1)).expect("the device works");
        report.require().unwrap_or_else(|error| panic!("{}: {error}", model.name));
    }
}
