//! Formulas that read each other, and inputs.

use super::*;

fn checked(formulas: &[(&str, &str)]) -> Formulas {
    Formulas::new(&scope(), &sources(formulas)).unwrap_or_else(|problems| panic!("{}", problems[0]))
}

/// Every problem as a line.
pub(super) fn problems(formulas: &[(&str, &str)]) -> Vec<String> {
    Formulas::new(&scope(), &sources(formulas)).err().unwrap_or_default().iter().map(ToString::to_string).collect()
}

#[test]
fn formulas_come_in_order_of_dependence_and_then_of_the_file() {
    let formulas = checked(&[
        ("c", "a + b"),
        ("b", "a * 2"),
        ("d", "1"),
        ("a", "friction"),
        ("late", "slip_margin + d"),
        ("radius_mm", "pitch_mm * pulley_teeth / (2 * pi)"),
    ]);
    let names: Vec<&str> = formulas.order().iter().map(|&it| formulas.all()[it].name.as_str()).collect();
    assert_eq!(names, ["d", "a", "b", "c", "late", "radius_mm"]);
    let late: Vec<&str> = formulas.after_model().map(|it| formulas.all()[it].name.as_str()).collect();
    assert_eq!((late, formulas.before_model().count()), (vec!["late"], 5));
    let scope = scope();
    let it = |name: &str| &formulas.all()[formulas.find(name).expect("a formula")];
    assert_eq!(it("c").depends_on, [scope.slot("friction").unwrap()]);
    assert_eq!(it("c").reads, [it("a").slot, it("b").slot]);
    assert_eq!(it("radius_mm").slot, scope.slot("radius_mm").unwrap(), "it writes to the input");
    assert!(it("radius_mm").gives_input && !it("c").gives_input && it("late").reads_outputs && !it("c").reads_outputs);
    assert!(formulas.is_read(scope.slot("pitch_mm").unwrap()) && !formulas.is_read(scope.slot("speed_rpm").unwrap()));
    assert_eq!(formulas.slots(), scope.names.len() + 5);
}

#[test]
fn a_formula_of_an_input_is_what_others_read() {
    let formulas = checked(&[("twice", "2 * friction"), ("friction", "0.3 * 1")]);
    let scope = scope();
    let mut slots = vec![9.0; formulas.slots()];
    formulas.evaluate_all(&mut slots, &mut vec![None; formulas.slots()], &mut []);
    assert_eq!((slots[scope.slot("friction").unwrap()], slots[formulas.all()[0].slot]), (0.3, 0.6));
}

#[test]
fn circles_are_told_with_their_path() {
    assert_eq!(problems(&[("a", "1 + a")]), ["a, line 1, column 5: a reads itself"]);
    assert_eq!(
        problems(&[("a", "b"), ("b", "friction * c"), ("c", "a"), ("d", "a")]),
        ["a, line 1, column 1: these formulas read each other in a circle: a -> b -> c -> a"]
    );
    let two = problems(&[("a", "b"), ("b", "a"), ("c", "d + a"), ("d", "c")]);
    assert_eq!(two.len(), 2);
    assert!(two[0].ends_with("a -> b -> a") && two[1].ends_with("c -> d -> c"), "{two:?}");
}

#[test]
fn an_input_depends_on_no_output() {
    assert_eq!(
        problems(&[("friction", "0.1 * slip_margin")]),
        [
            "friction, line 1, column 7: friction is an input of the model, so it cannot depend on slip_margin, which is an output: the model is evaluated once"
        ]
    );
    assert_eq!(
        problems(&[("friction", "0.1 * a"), ("a", "b"), ("b", "2 * slip_margin")]),
        [
            "friction, line 1, column 7: friction is an input of the model, so it cannot depend on slip_margin, which is an output (friction -> a -> b -> slip_margin): the model is evaluated once"
        ]
    );
}

#[test]
fn whole_inputs_take_whole_formulas() {
    for good in ["ceil(friction)", "2 * round(friction) + pulley_teeth", "max(pulley_teeth, 3)^2", "if(friction > 1, 2, 3)", "0"] {
        checked(&[("band_count", good)]);
    }
    checked(&[("band_count", "n"), ("n", "floor(friction) - 1")]);
    for bad in ["friction", "pulley_teeth / 2", "ceil(friction) * 0.5", "pulley_teeth^-1", "abs(friction)"] {
        let told = problems(&[("band_count", bad)]);
        assert_eq!(
            told,
            ["band_count, line 1, column 1: band_count takes whole numbers; end the formula in round(...), floor(...) or ceil(...)"]
        );
    }
    assert!(problems(&[("band_count", "n"), ("n", "friction")])[0].contains("whole numbers"));
}

#[test]
fn names_of_formulas_are_new() {
    let cases = [
        (("slip_margin", "1"), "slip_margin is an output of the model already; choose another name"),
        (("pulley_teeth", "1"), "pulley_teeth is given as a variable already; drop it there, or here"),
        (("section", "1"), "section takes words only, and a formula gives numbers"),
        (("slip", "1"), "slip is a curve already; choose another name"),
        (("sqrt", "1"), "sqrt means something in every formula; choose another name"),
        (("pi", "1"), "pi means something in every formula; choose another name"),
        (("2nd", "1"), "\"2nd\" is no name; use up to 80 letters, digits and \"_\", a letter first"),
        (("drüse", "1"), "\"drüse\" is no name; use up to 80 letters, digits and \"_\", a letter first"),
        (("", "1"), "\"\" is no name; use up to 80 letters, digits and \"_\", a letter first"),
    ];
    for ((name, text), message) in cases {
        assert_eq!(problems(&[(name, text)]), [format!("{name}, line 1, column 1: {message}")]);
    }
    assert_eq!(problems(&[("a", "1"), ("a", "2")]), ["a, line 1, column 1: there are two formulas of the name a; keep one of the two"]);
    let many: Vec<(String, String)> = (0..=MOST_FORMULAS).map(|number| (format!("f{number}"), "1".to_owned())).collect();
    assert_eq!(Formulas::new(&scope(), &many).unwrap_err()[0].message, "there may be at most 200 formulas, here are 201");
    assert!(Formulas::new(&scope(), &many[1..]).is_ok());
}

#[test]
fn roots_are_few_and_read_few_names() {
    let root = "root(r, 0, 10, r - friction)";
    let many: Vec<(String, String)> = (0..MOST_ROOTS).map(|number| (format!("f{number}"), root.to_owned())).collect();
    assert!(Formulas::new(&scope(), &many).is_ok());
    let more: Vec<_> = many.iter().cloned().chain([("last".to_owned(), root.to_owned())]).collect();
    assert_eq!(Formulas::new(&scope(), &more).unwrap_err()[0].message, "there may be at most 16 roots in all formulas together");
    let names = |count: usize| {
        let terms: Vec<String> = (0..count).map(|number| format!("a{number}")).collect();
        let mut formulas: Vec<(String, String)> = terms.iter().map(|name| (name.clone(), "1".to_owned())).collect();
        formulas.push(("it".to_owned(), format!("root(r, 0, 100, r - ({}))", terms.join(" + "))));
        Formulas::new(&scope(), &formulas)
    };
    let good = names(16).expect("sixteen are fine");
    let mut slots = vec![0.0; good.slots()];
    good.evaluate_all(&mut slots, &mut vec![None; good.slots()], &mut vec![0.0; good.requirements().len()]);
    assert_eq!(slots[good.all()[16].slot], 16.0);
    assert!(names(17).unwrap_err()[0].message.starts_with("the expression of a root reads at most 16 names"));
}

#[test]
fn curves_increase_and_have_names_of_their_own() {
    let curve = |points: &[(f64, f64)]| MeasuredCurve::new("c", QuantityUnit::NONE, QuantityUnit::NONE, points).map(|_| ()).unwrap_err();
    assert_eq!(curve(&[(0.0, 1.0)]), (None, "a curve has 2 to 1000 points, this one has 1".to_owned()));
    assert_eq!(curve(&[(0.0, 1.0), (0.0, 2.0)]), (Some(1), "x must increase from point to point, but 0 follows 0".to_owned()));
    assert_eq!(
        curve(&[(0.0, 1.0), (1.0, 2.0), (0.5, 2.0)]),
        (Some(2), "x must increase from point to point, but 0.5 follows 1".to_owned())
    );
    assert_eq!(curve(&[(0.0, 1.0), (f64::NAN, 2.0)]), (Some(1), "(NaN, 2) is no point of a curve; both numbers must be finite".to_owned()));
    assert_eq!(curve(&[(0.0, -1e308), (1.0, 1e308)]), (Some(1), "the curve is too steep between x = 0 and x = 1".to_owned()));
    let long: Vec<(f64, f64)> = (0..=MOST_POINTS).map(|at| (at as f64, 0.0)).collect();
    assert_eq!(curve(&long).1, "a curve has 2 to 1000 points, this one has 1001");
    let named = |name: &str| {
        let mut scope = scope();
        scope.curves.push(MeasuredCurve::new(name, QuantityUnit::NONE, QuantityUnit::NONE, &[(0.0, 1.0), (1.0, 2.0)]).expect("a curve"));
        Formulas::new(&scope, &[]).err().map(|problems| problems[0].message.clone())
    };
    assert_eq!(named("other"), None);
    assert_eq!(named("slip").as_deref(), Some("there are two curves of the name slip; keep one of the two"));
    assert_eq!(named("friction").as_deref(), Some("friction is an input, output or variable already; choose another name for the curve"));
    assert_eq!(named("sin").as_deref(), Some("sin means something in every formula; choose another name"));
}

#[test]
fn a_name_that_nothing_reads_is_a_slip_of_one_that_something_does() {
    let texts = sources(&[("a", "2 * puley_teeth"), ("b", "friction")]);
    assert_eq!(meant("pulley_teeth", texts.iter().map(|it| &*it.1)).as_deref(), Some("puley_teeth"));
    assert_eq!(meant("mass", texts.iter().map(|it| &*it.1)), None);
}
