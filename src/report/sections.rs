//! Sections of pulleys as closed lines, for the drawing of a design.

use crate::plan::Plan;
use crate::pulley::section::checked_outline;
use rustc_hash::FxHashMap;
use serde_json::{Map, Value, json};

/// Bytes that the outlines of a result's page may take.
const MOST_BYTES: usize = 250_000;

/// The section of a design: of each part its points, z and r in turn, in mm to a hundredth; `None` for a model without sections, or if there
/// is no such section.
pub fn of_design(plan: &Plan, design: u64) -> Option<Value> {
    let section = plan.study.model.pulley_of(&plan.space.inputs(design, 0))?;
    let outline = checked_outline(section.kind, &section.dimensions).ok()?;
    let rounded = |value: f64| (value * 100.0).round() / 100.0 + 0.0;
    let part = |points: &Vec<glam::DVec2>| points.iter().flat_map(|it| [rounded(it.x), rounded(it.y)]).collect::<Vec<f64>>();
    Some(json!(outline.parts.iter().map(part).collect::<Vec<_>>()))
}

/// The sections of some designs, each once, and which design has which; `null` for a model without sections. Where they would take
/// too much room the last designs have none.
pub fn of_designs(plan: &Plan, designs: &[u64]) -> Value {
    if plan.study.model.pulley_of(&plan.space.inputs(0, 0)).is_none() {
        return Value::Null;
    }
    let (mut known, mut outlines, mut of, mut bytes) = (FxHashMap::default(), Vec::new(), Map::new(), 0);
    for &design in designs {
        let Some(outline) = of_design(plan, design) else { continue };
        let text = outline.to_string();
        let place = match known.get(&text) {
            Some(&place) => place,
            None => {
                bytes += text.len();
                if bytes > MOST_BYTES {
                    break;
                }
                outlines.push(outline);
                known.insert(text, outlines.len() - 1);
                outlines.len() - 1
            }
        };
        of.insert(design.to_string(), place.into());
    }
    json!({ "of": of, "outlines": outlines })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::study_of;

    fn plan(model: &str, text: &str) -> Plan {
        Plan::new(study_of(&crate::models::find(model).expect("it is a model"), text).expect("the study is right"))
    }

    #[test]
    fn designs_of_one_section_share_its_outline() {
        let plan = plan("pulley", "[design]\nthickness_mm = [2, 2.2]\npower_kW = [2, 3]\n[objectives]\nmass_g = \"min\"\n");
        let told = of_designs(&plan, &[0, 1, 2, 3]);
        assert_eq!(told["outlines"].as_array().map(Vec::len), Some(2));
        let of = |design: u64| &told["of"][design.to_string()];
        let thickness = |design: u64| plan.space.inputs(design, 0)[plan.study.design[0].inputs()[0]];
        for design in 0..4 {
            assert_eq!(of(design), if thickness(design) == thickness(0) { of(0) } else { of(3) });
        }
        let part = &told["outlines"][0][0].as_array().expect("points");
        assert!(part.len() > 40 && part.len().is_multiple_of(2));
    }

    #[test]
    fn other_models_have_none() {
        let plan = plan("metal-cvt", "[design]\nband_count = [6, 9]\n[objectives]\naxial_force_N = \"min\"\n");
        assert_eq!(of_designs(&plan, &[0]), Value::Null);
    }
}
