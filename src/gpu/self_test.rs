//! Is a driver to be trusted? What has gone wrong on some driver without an error, tried on every one before it is used.

use super::constants::ULP_64;
use super::source::{common, common_64, in_f64};
use super::{Device, Program, WORKGROUP, shared_constants};
use crate::error::Result;
use crate::real::FUNCTION_ULP;
use serde_json::{Value, json};

/// The arithmetic that is tried, in f32.
const ARITHMETIC: &str = include_str!("../../shaders/self-test-arithmetic.wgsl");
/// Iterations of the long loop.
const LOOPS: u32 = 100_000;
/// Iterations after which some drivers end an invocation.
pub const LOOP_LIMIT: u32 = 65_535;
/// Points of the arithmetic.
const POINTS: u32 = 1 << 14;
/// Of the results per point, the leading ones that are rounded correctly.
const ROUNDED: usize = 3;
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

impl Measure {
    fn is_kept(&self) -> bool {
        self.ulp <= self.allowed
    }
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
    /// The same errors in f64; empty on a device that has none.
    pub measures_64: Vec<Measure>,
}

/// The measures that are beyond what is allowed, in words.
fn beyond(measures: &[Measure]) -> Vec<String> {
    let wrong = measures.iter().filter(|it| !it.is_kept());
    wrong.map(|it| format!("{} is {:.1} ULP off, at most {} is allowed", it.name, it.ulp, it.allowed)).collect()
}

impl SelfTest {
    /// Does the driver end long loops? Kernels are then kept short.
    pub fn limited_loops(&self) -> bool {
        self.loop_turns != LOOPS
    }

    /// What of f64 is too inaccurate, in words; empty also where there is none.
    pub fn problems_64(&self) -> Vec<String> {
        beyond(&self.measures_64)
    }

    /// May the first stage of a kernel compute in f64? A device whose f64 is missing or inaccurate computes it in f32.
    pub fn trusts_f64(&self) -> bool {
        !self.measures_64.is_empty() && self.problems_64().is_empty()
    }

    /// What is wrong with the driver; empty if it can be trusted.
    pub fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        if self.loop_turns < LOOP_LIMIT {
            problems.push(format!("a loop ends after {} iterations", self.loop_turns));
        }
        problems.extend(beyond(&self.measures));
        if self.lost_appends > 0 {
            problems.push(format!("{} of {APPENDS} simultaneous appends were lost", self.lost_appends));
        }
        problems
    }

    /// As it stands in `run.json`.
    pub fn to_json(&self) -> Value {
        let told = |measures: &[Measure]| measures.iter().map(|it| (it.name.to_owned(), json!(it.ulp))).collect::<serde_json::Map<_, _>>();
        json!({
            "loop_turns": self.loop_turns,
            "error_ulp": told(&self.measures),
            "error_ulp_f64": told(&self.measures_64),
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
    let source = [&common(), &self_test_constants(), ARITHMETIC, include_str!("../../shaders/self-test.wgsl")].join("\n");
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
    let exact: Vec<[f64; 2]> = points.iter().map(|point| point.map(f64::from)).collect();
    let results: Vec<f64> = results.into_iter().map(f64::from).collect();
    let measures = measure(&exact, &results, &SINGLE);
    let found = SelfTest { loop_turns, measures, lost_appends: wrong.max(missing), measures_64: run_in_f64(device, &points)? };
    if !found.trusts_f64() {
        device.forgo_f64();
    }
    if found.problems().is_empty() {
        device.trust();
    }
    Ok(found)
}

/// The arithmetic in f64, on a device that has it.
fn run_in_f64(device: &Device, points: &[[f32; 2]]) -> Result<Vec<Measure>> {
    if !device.has_f64() {
        return Ok(Vec::new());
    }
    let entry = include_str!("../../shaders/self-test-64.wgsl");
    let source = [&common(), &common_64(), &self_test_constants(), &in_f64(ARITHMETIC), entry].join("\n");
    let program = Program::new(device, &source, &["arithmetic_64"])?;
    let given = device.storage("given", points);
    let found = device.buffer("found", u64::from(POINTS) * u64::from(RESULTS) * 8, wgpu::BufferUsages::STORAGE);
    let bound = program.bind(&[("given", &given), ("found", &found)]);
    device.submit(|encoder| program.dispatch(encoder, "arithmetic_64", &bound, [POINTS / WORKGROUP, 1]));
    let results: Vec<f64> = device.fetch(&found, (POINTS * RESULTS) as usize)?;
    let number = |leading: f32, behind: f32| f64::from(leading) + f64::from(behind) / f64::from(1u32 << 30);
    let points: Vec<[f64; 2]> = points.iter().map(|&[a, b]| [number(a, b), number(b, a)]).collect();
    Ok(measure(&points, &results, &DOUBLE))
}

/// How the results of a precision are measured.
struct UlpScale {
    /// The distance from a number to the next.
    ulp: fn(f64) -> f64,
    /// How far sums and products may be off, in ULP.
    rounding: f64,
    /// How far all others may be off, if not what WGSL and our own functions say of f32.
    others: Option<f64>,
}

#[allow(clippy::cast_possible_truncation, reason = "the spacing of f32 is asked for")]
const SINGLE: UlpScale = UlpScale {
    ulp: |exact| {
        let near = (exact.abs() as f32).max(f32::MIN_POSITIVE);
        f64::from(near.next_up()) - f64::from(near)
    },
    rounding: 0.5,
    others: None,
};

/// In f64 the exact values are rounded themselves: a sum is the very same.
const DOUBLE: UlpScale = UlpScale {
    ulp: |exact| {
        let near = exact.abs().max(f64::MIN_POSITIVE);
        near.next_up() - near
    },
    rounding: 0.0,
    others: Some(ULP_64 / 4.0),
};

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
fn measure(points: &[[f64; 2]], results: &[f64], scale: &UlpScale) -> Vec<Measure> {
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
        // The argument is a quotient: its own rounding is allowed for.
        ("arc_sine", FUNCTION_ULP + 6.0, |a, _| libm::asin(a / (1.0 + a.abs()))),
    ];
    let worst = |number: usize, exact: Exact| {
        points.iter().enumerate().fold(0.0, |worst: f64, (at, &[a, b])| {
            let exact = exact(a, b);
            let error = (results[at * RESULTS as usize + number] - exact).abs() / (scale.ulp)(exact);
            // A NaN must not hide behind a comparison.
            if error.is_nan() || worst.is_nan() { f64::NAN } else { worst.max(error) }
        })
    };
    // Halves of an ULP may be a little more at a power of two, where the spacing changes.
    cases
        .iter()
        .enumerate()
        .map(|(number, &(name, allowed, exact))| {
            let allowed = if number < ROUNDED { scale.rounding } else { scale.others.unwrap_or(allowed) };
            Measure { name, ulp: worst(number, exact), allowed: allowed + 0.01 }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn good() -> SelfTest {
        let measures = vec![Measure { name: "sum", ulp: 0.5, allowed: 0.51 }];
        SelfTest { loop_turns: LOOPS, measures, lost_appends: 0, measures_64: Vec::new() }
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
        let mut results: Vec<f64> = points.iter().flat_map(|&point| exact(point)).map(f64::from).collect();
        let points: Vec<[f64; 2]> = points.iter().map(|point| point.map(f64::from)).collect();
        let clean = measure(&points, &results, &SINGLE);
        assert!(clean.iter().all(Measure::is_kept), "{clean:?}");
        for number in 0..5 {
            let kept = results[number];
            results[number] = f64::from(f32::from_bits((kept as f32).to_bits() + 6));
            assert!(measure(&points, &results, &SINGLE)[number].ulp > clean[number].allowed, "{}", clean[number].name);
            results[number] = kept;
        }
    }

    #[test]
    fn f64_is_trusted_only_where_it_is_as_accurate_as_kernels_rely_on() {
        let points: Vec<[f64; 2]> = points().iter().map(|&[a, b]| [f64::from(a) + 1e-9, f64::from(b) + 1e-9]).collect();
        let exact = |&[a, b]: &[f64; 2]| {
            let of = a / (1.0 + a.abs());
            use libm::{asin, cos, expm1, log1p, sin, sqrt};
            [a + b, a - b, a * b, a / b, sqrt(a.abs()), expm1(a), log1p(a.abs()), sin(a), cos(a), asin(of)]
        };
        let mut results: Vec<f64> = points.iter().flat_map(exact).collect();
        let found = |results: &[f64]| SelfTest { measures_64: measure(&points, results, &DOUBLE), ..good() };
        assert!(found(&results).trusts_f64() && !good().trusts_f64());
        for number in 0..RESULTS as usize {
            // Where f32 does not happen to hold the result.
            let places = || (number..results.len()).step_by(RESULTS as usize);
            let lost = |at: &usize| (f64::from(results[*at] as f32) - results[*at]).abs() > 1e-9 * results[*at].abs();
            let at = places().find(lost).expect("f32 loses digits of most numbers");
            let kept = results[at];
            let off = if number < ROUNDED { 1 } else { ULP_64 as u64 };
            // What a device gives that computes in f32, and what is farther off than the bounds of a kernel say.
            for wrong in [f64::from(kept as f32), f64::from_bits(kept.to_bits() + off), f64::NAN] {
                results[at] = wrong;
                assert!(!found(&results).trusts_f64() && found(&results).problems().is_empty(), "{number}: {wrong} for {kept}");
            }
            results[at] = kept;
        }
    }
}
