//! Tests that loop over every model.

use super::*;
use crate::screen::Control;
use crate::tape::Known;
use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock};
use std::thread::ThreadId;
use std::time::Duration;

/// The formula of `pulley-load` as a slow model without a GPU implementation would compute it, watched.
pub(crate) struct Watched {
    inner: Arc<dyn Kernel>,
    /// How long the first stage sleeps.
    pause: Duration,
    /// Numbers that it passes on and nobody reads.
    idle: usize,
    /// First stages, and blocks of the second, so far.
    pub prepared: AtomicU64,
    pub blocks: AtomicU64,
    /// Threads that were here.
    pub threads: Mutex<HashSet<ThreadId>>,
    /// Stops the work when so many stages have been computed.
    pub stop: OnceLock<(u64, &'static Control)>,
}

impl Watched {
    fn count(&self, counter: &AtomicU64) {
        counter.fetch_add(1, Ordering::Relaxed);
        self.threads.lock().expect("nobody panics with it").insert(std::thread::current().id());
        if let Some((after, control)) = self.stop.get()
            && self.prepared.load(Ordering::Relaxed) + self.blocks.load(Ordering::Relaxed) >= *after
        {
            control.stop.store(true, Ordering::Relaxed);
        }
    }
}

impl Kernel for Watched {
    fn sizes(&self) -> Sizes {
        let sizes = self.inner.sizes();
        Sizes { prepared: sizes.prepared + self.idle, ..sizes }
    }

    fn prepare(&self, inputs: &[f64], wanted: Set, prepared: &mut [f64]) {
        std::thread::sleep(self.pause);
        self.inner.prepare(inputs, wanted, prepared);
        self.count(&self.prepared);
    }

    fn conditions(&self, prepared: &[f64], inputs: &[f64], margins: &mut [f64]) {
        self.inner.conditions(prepared, inputs, margins);
    }

    fn finish(&self, prepared: &[f64], inputs: &[f64], wanted: Set, outputs: &mut [f64]) {
        self.inner.finish(prepared, inputs, wanted, outputs);
    }

    fn finish_columns(&self, prepared: &[f64], inputs: &[f64], columns: &Columns<'_>, scratch: &mut Scratch, results: &mut [Vec<f64>]) {
        self.inner.finish_columns(prepared, inputs, columns, scratch, results);
        self.count(&self.blocks);
    }

    fn dependencies(&self, inputs: &[Known]) -> Dependencies {
        self.inner.dependencies(inputs)
    }
}

/// A model that is watched: it goes by the name of the one that it computes like.
pub(crate) fn watched(pause: Duration, idle: usize) -> (Arc<Model>, Arc<Watched>) {
    let model = find("pulley-load").expect("it is a model");
    let [prepared, blocks] = [const { AtomicU64::new(0) }; 2];
    let kernel = Watched { inner: model.kernel.clone(), pause, idle, prepared, blocks, threads: Mutex::default(), stop: OnceLock::new() };
    let kernel = Arc::new(kernel);
    let effort = Effort { prepare: pause.as_secs_f64(), finish: 1e-8 };
    (Arc::new(Model { kernel: kernel.clone(), effort, sample: 50, on_gpu: false, ..Model::clone(&model) }), kernel)
}

/// Words of an enumeration, for tests where no model needs them.
const SECTIONS: &[(&str, f64)] = &[("machined", 1.0), ("welded-discs", 2.0), ("double-groove", 3.0), ("pressed-cup", 4.0)];

/// A model with an enumeration and an input that is read for one of its words only; its formula reads neither.
pub(crate) fn with_a_section() -> Arc<Model> {
    let model = find("pulley-load").expect("it is a model");
    let doc = "How the pulley is made.";
    let section = Input::enumeration("section", "", SECTIONS, 4.0, doc, "chosen");
    let mass = Input::new("disc_mass_g", "", crate::units::GRAM, 10.0, (1.0, 100.0), "Mass of a disc.", "chosen");
    let mass = mass.read_only_for("section", &["welded-discs"]);
    let inputs: Vec<Input> = model.inputs.iter().cloned().chain([section, mass]).collect();
    let presets = vec![Preset::new("welded", &[("section", 2.0), ("power_kW", 5.0)])];
    Arc::new(Model { name: "sections".into(), inputs, presets, ..Model::clone(&model) })
}

#[test]
fn an_enumeration_takes_its_words_and_nothing_else() {
    let model = with_a_section();
    let section = &model.inputs[model.input("section").expect("it has one")];
    assert!(section.is_enumeration() && section.accepts(3.0) && !section.accepts(5.0) && !section.accepts(2.5));
    assert_eq!((section.word_for(2.0), section.value_of("machined"), section.value_of("2")), (Some("welded-discs"), Some(1.0), None));
    assert_eq!(section.valid_in_words(), r#""machined", "welded-discs", "double-groove" or "pressed-cup""#);
    let traction =
        find("metal-cvt").and_then(|model| model.inputs.iter().find(|it| it.name == "traction").cloned()).expect("it is an input");
    assert!(!traction.is_enumeration() && traction.accepts(0.5) && traction.accepts(-1.0) && !traction.accepts(-2.0));
    assert_eq!(traction.valid_in_words(), r#"at least 0 and less than 1, or "limit""#);
    assert_eq!(evaluate(&model, &model.defaults()).status, Status::Ok);
}

#[test]
fn a_preset_changes_the_defaults_and_an_unknown_one_lists_what_there_is() {
    let model = with_a_section();
    let inputs = model.preset("welded").expect("it is a preset");
    let changed: Vec<_> = (0..inputs.len()).filter(|&input| inputs[input] != model.inputs[input].default).collect();
    assert_eq!(changed, [0, model.input("section").expect("it has one")]);
    assert_eq!(model.preset("cast").unwrap_err(), "sections has no preset \"cast\"; presets are: welded");
    let none = find("metal-cvt").expect("it is a model").preset("x").unwrap_err();
    assert_eq!(none, "metal-cvt has no preset \"x\"; it has none");
}

#[test]
fn words_are_unique_and_presets_and_conditions_of_inputs_name_what_exists() {
    for model in all().iter().cloned().chain([with_a_section()]) {
        for input in &model.inputs {
            let words: HashSet<_> = input.words.iter().map(|(word, _)| word).collect();
            let numbers: HashSet<_> = input.words.iter().map(|(_, number)| number.to_bits()).collect();
            assert!(words.len() == input.words.len() && numbers.len() == words.len(), "{}: {}", model.name, input.name);
            assert!(input.words.iter().all(|(_, number)| !input.valid.contains(*number)), "{}: {}", model.name, input.name);
            if let Some(OnlyFor { input: of, words }) = &input.only_for {
                let of = &model.inputs[model.input(of).unwrap_or_else(|| panic!("{}: {} depends on {of}", model.name, input.name))];
                assert!(words.iter().all(|word| of.value_of(word).is_some()), "{}: {}", model.name, input.name);
            }
        }
        for Preset { name, changes, .. } in &model.presets {
            for (input, value) in changes {
                let input = &model.inputs[model.input(input).unwrap_or_else(|| panic!("{}: {name} sets {input}", model.name))];
                assert!(input.accepts(*value), "{}: {name} sets {} to {value}", model.name, input.name);
            }
        }
    }
}

#[test]
fn an_input_is_read_for_the_words_that_it_names_and_no_other() {
    let mut seen = 0;
    for model in all() {
        for (number, input) in model.inputs.iter().enumerate() {
            let Some(OnlyFor { input: of, words }) = &input.only_for else { continue };
            let of = model.input(of).expect("it is an input");
            for (word, code) in &model.inputs[of].words {
                let known = |at: usize| if at == of { Known::Fixed(*code) } else { Known::Within(-1.0, 1e9) };
                let found = model.kernel.dependencies(&(0..model.inputs.len()).map(known).collect::<Vec<_>>());
                let sets = [&[found.prepared][..], &found.outputs, &found.conditions].concat();
                let is_read = sets.iter().any(|set| set.contains(number));
                assert_eq!(is_read, words.contains(word), "{}: {} for {word}", model.name, input.name);
                seen += 1;
            }
        }
    }
    assert!(seen > 40, "{seen}");
}

#[test]
fn an_input_that_is_set_and_not_read_is_told() {
    let model = find("pulley-load").expect("it is a model");
    let told = |changes: &[(&str, f64)]| {
        let mut inputs = model.defaults();
        changes.iter().for_each(|(name, value)| inputs[model.input(name).expect("it is an input")] = *value);
        model.notes_on(&inputs, &evaluate(&model, &inputs))
    };
    assert_eq!(
        told(&[("installed_tension_N", 600.0)]),
        ["installed_tension_N is set, but it is read for tensioning = \"fixed-centres\" only"]
    );
    assert_eq!(
        told(&[("tensioning", 2.0), ("slack_tension_N", 600.0)]),
        ["slack_tension_N is set, but it is read for tensioning = \"slack\" only"]
    );
    assert!(told(&[("tensioning", 2.0), ("installed_tension_N", 600.0)]).is_empty() && told(&[("slack_tension_N", 600.0)]).is_empty());
}

#[test]
fn names_are_unique_and_carry_their_unit() {
    for model in all() {
        let mut seen = HashSet::new();
        let quantities = model.inputs.iter().map(|i| (&i.name, i.unit)).chain(model.outputs.iter().map(|o| (&o.name, o.unit)));
        for (name, unit) in quantities {
            assert!(seen.insert(name), "{}: {name} stands twice", model.name);
            let suffix = unit.suffix();
            assert!(suffix.is_empty() || name.ends_with(&format!("_{suffix}")), "{}: {name} in {suffix}", model.name);
        }
    }
}

#[test]
fn defaults_are_usual_and_evaluate_to_every_output() {
    for model in all() {
        for input in &model.inputs {
            let default = input.default;
            assert!(input.accepts(default), "{}: {}", model.name, input.name);
            assert!(input.word_for(default).is_some() || (input.usual.0..=input.usual.1).contains(&default), "{}", input.name);
        }
        let evaluation = evaluate(model, &model.defaults());
        assert_eq!(evaluation.status, Status::Ok, "{}", model.name);
        // What a quiet condition may leave out is there only if it is asked for.
        let optional = |name: &String| model.conditions.iter().any(|condition| condition.quiet && condition.invalidates.contains(name));
        let missing = model.outputs.iter().zip(&evaluation.outputs).filter(|(_, value)| value.is_none()).map(|(output, _)| &output.name);
        assert!(missing.clone().all(optional), "{}: {:?}", model.name, missing.collect::<Vec<_>>());
    }
}

#[test]
fn conditions_invalidate_outputs_that_exist() {
    // The two belts share one table; the rubber belt lacks the metal belt's last two outputs.
    let known: HashSet<_> = all().iter().flat_map(|model| &model.outputs).map(|output| &output.name).collect();
    for model in all() {
        for condition in &model.conditions {
            for name in &condition.invalidates {
                assert!(known.contains(&name), "{}: \"{}\" invalidates {name}", model.name, condition.reason);
            }
        }
    }
}
