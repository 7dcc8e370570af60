//! The same study on the CPU and, where there is one, on a GPU: the results are equal. Run with `cargo run --example engine`.

use beltspace::gpu::adapters;
use beltspace::{Engine, Judging, Options, Study};

const STUDY: &str = include_str!("../studies/rubber-cvt.toml");

/// Prints it.
pub fn main() -> beltspace::Result<()> {
    let study = Study::parse(STUDY)?;
    let options = Options::default().judging(Judging::Exhaustive);
    let on_cpu = study.sweep(options.clone().engine(Engine::Cpu))?;
    println!("CPU: {} designs on the front, in {:.2} s", on_cpu.counts.front, on_cpu.course.time.as_secs_f64());
    let Some(adapter) = adapters().into_iter().next() else {
        println!("there is no GPU driver on this machine");
        return Ok(());
    };
    let on_gpu = study.sweep(options.engine(Engine::Gpu).adapter(&adapter.name))?;
    println!("{}: {} designs on the front, in {:.2} s", adapter.in_words(), on_gpu.counts.front, on_gpu.course.time.as_secs_f64());
    assert_eq!((on_cpu.front, on_cpu.counts), (on_gpu.front, on_gpu.counts));
    Ok(())
}
