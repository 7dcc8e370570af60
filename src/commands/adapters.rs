//! `beltspace adapters`: the GPUs of this machine, and whether their drivers pass the self-test.

use crate::terminal::{self, TextGrid, bold, grouped};
use beltspace::error::Result;
use beltspace::gpu::{self, Adapter, self_test};
use serde_json::{Value, json};

pub fn run(json: bool) -> Result<()> {
    let adapters = gpu::adapters();
    if json {
        return terminal::print(&format!("{:#}\n", adapters.iter().map(describe).collect::<Value>()));
    }
    if adapters.is_empty() {
        return terminal::tell(
            "no GPU driver was found: every command runs on the CPU\n\
             A software driver, for trying things out: the Debian package mesa-vulkan-drivers (lavapipe).\n",
        );
    }
    let pages: Vec<_> = adapters.iter().map(page).collect();
    terminal::tell(&pages.join("\n"))
}

/// The self-test's report, or why there is none.
fn tested(adapter: &Adapter) -> std::result::Result<self_test::SelfTest, String> {
    adapter.open().and_then(|device| self_test::run(&device)).map_err(|error| error.to_string())
}

fn describe(adapter: &Adapter) -> Value {
    let limits: serde_json::Map<_, _> = adapter.limits().into_iter().map(|(name, value)| (name.replace(' ', "_"), value.into())).collect();
    let (self_test, trusted) = match tested(adapter) {
        Ok(report) => (report.to_json(), report.problems().is_empty()),
        Err(problem) => (json!({ "problems": [problem] }), false),
    };
    json!({
        "name": adapter.name, "kind": adapter.kind.name(), "driver": adapter.driver, "backend": adapter.backend,
        "limits": limits, "self_test": self_test, "trusted": trusted,
    })
}

fn page(adapter: &Adapter) -> String {
    let mut facts = TextGrid::default();
    let mut fact = |what: &str, value: String| facts.row([what.to_owned(), value]);
    fact("kind", adapter.kind.name().to_owned());
    fact("driver", format!("{}, {}", adapter.backend, adapter.driver));
    let megabytes = |bytes: u64| format!("{} MB", grouped(bytes >> 20));
    for (name, value) in adapter.limits() {
        fact(name, if value >= 1 << 20 { megabytes(value) } else { grouped(value) });
    }
    match tested(adapter) {
        Err(problem) => fact("self-test", format!("failed: {problem}")),
        Ok(report) => {
            let problems = report.problems();
            fact(
                "self-test",
                if problems.is_empty() { "passed: the driver can be used".to_owned() } else { format!("failed: {}", problems.join("; ")) },
            );
            let iterations = grouped(report.loop_turns.into());
            let loops = if report.limited_loops() {
                format!("the driver ends them after {iterations} iterations without an error: kernels are kept shorter")
            } else {
                "no limit seen".to_owned()
            };
            fact("  loops", loops);
            fact("  lost appends", report.lost_appends.to_string());
            let f64 = match (report.trusts_f64(), report.measures_64.is_empty()) {
                (true, _) => "accurate: what many designs share is computed in it".to_owned(),
                (false, true) => "none".to_owned(),
                (false, false) => format!("not accurate enough, and not used: {}", report.problems_64().join("; ")),
            };
            fact("  f64", f64);
            for measure in &report.measures {
                fact(&format!("  {}", measure.name), format!("at most {:.2} ULP off, {:.1} are allowed", measure.ulp, measure.allowed));
            }
        }
    }
    format!("{}\n{}", bold(&adapter.name), facts.indented(2))
}
