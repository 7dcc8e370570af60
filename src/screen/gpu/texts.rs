//! Small parts of a kernel's text.

use crate::models::Worse;
use crate::tape::nearest_f32;

/// A number of the kernel's text that reads back as the same f32.
pub fn literal(value: f32) -> String {
    if value.is_finite() {
        format!("f32({value:?})")
    } else if value > 0.0 {
        "infinity()".to_owned()
    } else {
        "(-infinity())".to_owned()
    }
}

/// The value that every other one is worse than; its bound is the least.
pub fn least_bad(worse: Worse) -> String {
    if worse == Worse::Higher { "Real(-infinity(), 0.0)".to_owned() } else { "Real(infinity(), 0.0)".to_owned() }
}

/// The lines of a function that asks whether `number` keeps to these ends, of each of which is told whether it is itself excluded. On the
/// device stands what `on_device` makes of them, with what f32 loses of it; `plain` if that is the end itself.
pub fn keep_between(ends: [Option<(f64, bool)>; 2], plain: bool, on_device: impl Fn(f64) -> f64) -> Vec<String> {
    let mut lines = vec!["var answer = YES;".to_owned()];
    for (bound, towards) in ends.into_iter().zip([1.0, -1.0]) {
        let Some((bound, strict)) = bound else { continue };
        let (value, lost) = nearest_f32(on_device(bound));
        // Zero stays zero in any unit.
        let lost = if value == 0.0 || plain { lost } else { lost + value.abs() * 1e-12 };
        let question = if strict { "above_zero" } else { "at_least_zero" };
        let difference =
            if towards > 0.0 { format!("number.value - {}", literal(value)) } else { format!("{} - number.value", literal(value)) };
        lines.push(format!("{{ let margin = {difference};"));
        lines
            .push(format!("answer = min(answer, {question}(Real(margin, number.bound + {} + abs(margin) * ROUNDING))); }}", literal(lost)));
    }
    lines.push("return answer;".to_owned());
    lines
}
