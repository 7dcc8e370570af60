//! Is a driver to be trusted? What has gone wrong on some driver without an error, tried on every one before it is used.

use super::source::common;
use super::{Device, Program, WORKGROUP, shared_constants};
use crate::error::Result;
use crate::real::FUNCTION_ULP;
use serde_json::{Value, json};

/// Iterations of the long loop.
const LOOPS: u32 = 100_000;
/// Iterations after which some drivers end an invocation.
pub const LOOP_LIMIT: u32 = 65_535;
/// Points of the arithmetic.
const POINTS: u32 = 1 << 14;
/// Invocations that append themselves.
const APPENDS: u32 = 1 << 16;

shared_constants! {
    /// What `shaders/self-test.wgsl` relies on.
    fn self_test_constants;

    /// Results per point.
    const RESULTS: u32 = 10;
}

/// A quantity of the self-test: what was measured, and the most that is allowed.
#[derive(Clone, Debug, PartialEq)]
pub struct Measure {
    /// What.
    pub name: &'static str,
    /// Largest error in ULP.
    pub ulp: f64,
    /// What the bounds of the kernels rely on.
    pub allowed: f64,
}

/// What a driver's self-test found.
#[derive(Clone, Debug, PartialEq)]
pub struct SelfTest {
    /// Iterations that a loop of 100 000 made.
    pub loop_turns: u32,
    /// Errors of arithmetic and own functions.
    pub measures: Vec<Measure>,
    /// Appends that were lost or doubled, of 65 536 at once.
    pub lost_appends: u32,
}

impl SelfTest {
    /// Does the driver end long loops? Kernels are then kept short.
    pub fn limited_loops(&self) -> bool {
        self.loop_turns != LOOPS
    }

    /// What is wrong with the driver; empty if it can be trusted.
    pub fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        if self.loop_turns < LOOP_LIMIT {
            problems.push(format!("a loop ends after {} iterations", self.loop_turns));
        }
        let wrong = self.measures.iter().filter(|it| it.ulp.is_nan() || it.ulp > it.allowed);
        problems.extend(wrong.map(|it| format!("{} is {:.1} ULP off, at most {} is allowed", it.name, it.ulp, it.allowed)));
        if self.lost_appends > 0 {
            problems.push(format!("{} of {APPENDS} simultaneous appends were lost", self.lost_appends));
        }
        problems
    }

    /// As it stands in `run.json`.
    pub fn to_json(&self) -> Value {
        let measures = self.measures.iter().map(|it| (it.name.to_owned(), json!(it.ulp)));
        json!({
            "loop_turns": self.loop_turns,
            "error_ulp": measures.collect::<serde_json::Map<_, _>>(),
            "lost_appends": self.lost_appends,
            "problems": self.problems(),
        })
    }
}

/// Runs the self-test.
///
/// # Errors
/// [`Error::Gpu`](crate::error::Error::Gpu) if the device fails altogether.
pub fn run(device: &Device) -> Result<SelfTest> {
    let source = [&common(), &self_test_constants(), include_str!("../../shaders/self-test.wgsl")].join("\n");
    let program = Program::new(device, &source, &["arithmetic", "loops", "append"])?;
    let points = points();
    let given = device.storage("given", &points);
    let found = device.buffer("found", u64::from(POINTS) * u64::from(RESULTS) * 4, wgpu::BufferUsages::STORAGE);
    let run = |entry: &str, count: u32, groups: u32, words: usize| {
        let test = device.uniform("test", &[count, LOOPS, 0, 0]);
        let counts = device.buffer("counts", u64::from(1 + APPENDS) * 4, wgpu::BufferUsages::STORAGE);
        let bound = program.bind(&[("test", &test), ("given", &given), ("found", &found), ("counts", &counts)]);
        device.submit(|encoder| program.dispatch(encoder, entry, &bound, [groups, 1]));
        device.fetch::<u32>(&counts, words)
    };
    let loop_turns = run("loops", 1, 1, 1)?[0];
    let appended = run("append", APPENDS, APPENDS / WORKGROUP, 1 + APPENDS as usize)?;
    let wrong = appended[1..].iter().filter(|&&times| times != 1).count() as u32;
    let places: Vec<f32> = device.fetch(&found, APPENDS as usize)?;
    let mut seen = vec![false; APPENDS as usize];
    places.iter().for_each(|&it| seen[(it as usize).min(APPENDS as usize - 1)] = true);
    let missing = seen.iter().filter(|it| !**it).count() as u32;
    run("arithmetic", POINTS, POINTS / WORKGROUP, 1)?;
    let results: Vec<f32> = device.fetch(&found, (POINTS * RESULTS) as usize)?;
    Ok(SelfTest { loop_turns, measures: measure(&points, &results), lost_appends: wrong.max(missing) })
}

/// Pairs of numbers: of all sizes, near 1, near each other, around multiples of pi/2.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "any numbers will do")]
fn points() -> Vec<[f32; 2]> {
    let unit = |i: u32, salt: u64| crate::sample::mix(u64::from(i) * 8 + salt) as f64 / u64::MAX as f64;
    (0..POINTS)
        .map(|i| {
            let sign = if i & 1 == 0 { 1.0 } else { -1.0 };
            let a = match i % 5 {
                0 => sign * 10f64.powf(-6.0 + 7.8 * unit(i, 1)),
                1 => 20.0 * (unit(i, 1) - 0.5),
                2 => sign * f64::from(1 + i % 8) * std::f64::consts::FRAC_PI_2 * (1.0 + 1e-4 * (unit(i, 1) - 0.5)),
                3 => 1.0 + 1e-3 * (unit(i, 1) - 0.5),
                _ => 2.0 * unit(i, 1) - 1.0,
            };
            let b = if i % 3 == 0 { a * (1.0 + 1e-3 * (unit(i, 2) - 0.5)) } else { sign * 10f64.powf(-3.0 + 6.0 * unit(i, 2)) };
            [a as f32, b as f32]
        })
        .collect()
}

/// Errors of the results in ULP of the exact value.
#[allow(clippy::cast_possible_truncation, reason = "the spacing of f32 is asked for")]
fn measure(points: &[[f32; 2]], results: &[f32]) -> Vec<Measure> {
    type Exact = fn(f64, f64) -> f64;
    let cases: [(&'static str, f64, Exact); RESULTS as usize] = [
        ("sum", 0.5, |a, b| a + b),
        ("difference", 0.5, |a, b| a - b),
        ("product", 0.5, |a, b| a * b),
        ("quotient", 2.5, |a, b| a / b),
        ("square root", 4.5, |a, _| a.abs().sqrt()),
        ("exp_m1", FUNCTION_ULP, |a, _| libm::expm1(a)),
        ("ln_1p", FUNCTION_ULP, |a, _| libm::log1p(a.abs())),
        ("sine", FUNCTION_ULP, |a, _| libm::sin(a)),
        ("cosine", FUNCTION_ULP, |a, _| libm::cos(a)),
        // The argument is a quotient of f32 numbers: its own rounding is allowed for.
        ("arc_sine", FUNCTION_ULP + 6.0, |a, _| libm::asin(a / (1.0 + a.abs()))),
    ];
    let worst = |number: usize, exact: Exact| {
        points.iter().enumerate().fold(0.0, |worst: f64, (at, &[a, b])| {
            let exact = exact(f64::from(a), f64::from(b));
            let near = (exact.abs() as f32).max(f32::MIN_POSITIVE);
            let ulp = f64::from(near.next_up()) - f64::from(near);
            let error = (f64::from(results[at * RESULTS as usize + number]) - exact).abs() / ulp;
            // A NaN must not hide behind a comparison.
            if error.is_nan() || worst.is_nan() { f64::NAN } else { worst.max(error) }
        })
    };
    // Halves of an ULP may be a little more at a power of two, where the spacing changes.
    cases
        .iter()
        .enumerate()
        .map(|(number, &(name, allowed, exact))| Measure { name, ulp: worst(number, exact), allowed: allowed + 0.01 })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> SelfTest {
        let measures = vec![Measure { name: "sum", ulp: 0.5, allowed: 0.51 }];
        SelfTest { loop_turns: LOOPS, measures, lost_appends: 0 }
    }

    #[test]
    fn every_fault_is_named() {
        assert!(good().problems().is_empty() && !good().limited_loops());
        let limited = SelfTest { loop_turns: LOOP_LIMIT, ..good() };
        assert!(limited.problems().is_empty() && limited.limited_loops(), "a known limit can be lived with");
        assert_eq!(SelfTest { loop_turns: 1000, ..good() }.problems(), ["a loop ends after 1000 iterations"]);
        assert_eq!(SelfTest { lost_appends: 3, ..good() }.problems(), ["3 of 65536 simultaneous appends were lost"]);
        for ulp in [1.0, f64::NAN] {
            let wrong = SelfTest { measures: vec![Measure { name: "sum", ulp, allowed: 0.51 }], ..good() };
            assert_eq!(wrong.problems().len(), 1, "{ulp}");
        }
    }

    #[test]
    fn a_result_one_bit_off_is_measured() {
        let points = points();
        let exact = |[a, b]: [f32; 2]| {
            let c = a / (1.0 + a.abs());
            let f = crate::real::functions::arc_sine;
            use crate::real::functions::{cosine, exp_m1, ln_1p, sine};
            [a + b, a - b, a * b, a / b, a.abs().sqrt(), exp_m1(a), ln_1p(a.abs()), sine(a), cosine(a), f(c)]
        };
        let mut results: Vec<f32> = points.iter().flat_map(|&point| exact(point)).collect();
        let clean = measure(&points, &results);
        assert!(clean.iter().all(|it| it.ulp <= it.allowed), "{clean:?}");
        for number in 0..5 {
            let kept = results[number];
            results[number] = f32::from_bits(kept.to_bits() + 6);
            assert!(measure(&points, &results)[number].ulp > clean[number].allowed, "{}", clean[number].name);
            results[number] = kept;
        }
    }
}
