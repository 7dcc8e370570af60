//! Units in brackets and in names.

use super::*;

/// The value in SI units of one of this unit, and what it measures.
fn one(text: &str) -> (f64, String) {
    let units = Units::new(&["EUR".to_owned(), "piece".to_owned()]).expect("units");
    let measure = units.read(text).unwrap_or_else(|wrong| panic!("[{text}]: {}", wrong.message));
    (measure.to_si(1.0), units.in_words(measure.dimension))
}

#[test]
fn units_have_their_values_in_si() {
    // From the SI brochure, 9th edition, and NIST SP 811, appendix B.
    let cases = [
        ("mm", 0.001, "a length"),
        ("um", 1e-6, "a length"),
        ("km", 1000.0, "a length"),
        ("in", 0.0254, "a length"),
        ("ft", 0.3048, "a length"),
        ("g", 0.001, "a mass"),
        ("t", 1000.0, "a mass"),
        ("lb", 0.453_592_37, "a mass"),
        ("min", 60.0, "a time"),
        ("h", 3600.0, "a time"),
        ("1/s", 1.0, "a frequency"),
        ("1/min", 1.0 / 60.0, "a frequency"),
        ("Hz", 1.0, "a frequency"),
        ("rpm", 0.104_719_755_119_659_77, "a rotational speed"),
        ("rev/min", 0.104_719_755_119_659_77, "a rotational speed"),
        ("rad/s", 1.0, "a rotational speed"),
        ("deg", 0.017_453_292_519_943_295, "an angle"),
        ("rev", std::f64::consts::TAU, "an angle"),
        ("km/h", 1.0 / 3.6, "a speed"),
        ("m/s^2", 1.0, "an acceleration"),
        ("N", 1.0, "a force"),
        ("kg m/s^2", 1.0, "a force"),
        ("lbf", 4.448_221_615_260_5, "a force"),
        ("MPa", 1e6, "a stress"),
        ("N/mm^2", 1e6, "a stress"),
        ("N/mm²", 1e6, "a stress"),
        ("bar", 1e5, "a stress"),
        ("psi", 6_894.757_293_168_361, "a stress"),
        ("J", 1.0, "a torque or an energy"),
        ("kWh", 3.6e6, "a torque or an energy"),
        ("kW h", 3.6e6, "a torque or an energy"),
        ("N m", 1.0, "a torque or an energy"),
        ("N*m", 1.0, "a torque or an energy"),
        ("N·mm", 0.001, "a torque or an energy"),
        ("kNm", 1000.0, "a torque or an energy"),
        ("W", 1.0, "a power"),
        ("hp", 745.699_871_582_270_2, "a power"),
        ("PS", 735.498_75, "a power"),
        ("kg/m^3", 1.0, "a density"),
        ("g/cm3", 1000.0, "a density"),
        ("N/mm", 1000.0, "a force per length"),
        ("kg/m", 1.0, "a mass per length"),
        ("um/N", 1e-6, "a deflection per force"),
        ("mm^2", 1e-6, "an area"),
        ("mm3", 1e-9, "a volume"),
        ("mm^-1", 1000.0, "a quantity in 1/m"),
        ("%", 0.01, "a plain number"),
        ("EUR", 1.0, "a quantity in EUR"),
        ("EUR/kg", 1.0, "a quantity in EUR/kg"),
        ("EUR/(kWh)", 1.0 / 3.6e6, "a quantity in s^2 EUR/(kg m^2)"),
        ("W/(m s)", 1.0, "a quantity in kg m/s^4"),
        ("kgm2", 1.0, "a quantity in kg m^2"),
        (" piece / h ", 1.0 / 3600.0, "a quantity in piece/s"),
    ];
    for (text, wanted, words) in cases {
        let (value, measures) = one(text);
        assert!((value - wanted).abs() <= 4e-16 * wanted, "[{text}] is {value}");
        assert_eq!(measures, words, "[{text}]");
    }
}

#[test]
fn the_models_units_are_the_same_here() {
    let units = Units::default();
    let mut compared = 0;
    for (unit, names) in units::all() {
        for name in names {
            // A frequency in a formula, and a plain number.
            if ["1/min", "1/s", "", "1"].contains(name) {
                continue;
            }
            let read = units.read(name).unwrap_or_else(|wrong| panic!("[{name}]: {}", wrong.message));
            let own = QuantityUnit::from(unit);
            assert_eq!(read.dimension, own.dimension, "{name}");
            assert!((read.to_si(3.7) - own.to_si(3.7)).abs() <= 1e-15 * own.to_si(3.7), "{name}");
            compared += 1;
        }
        let suffix = unit.suffix();
        if !suffix.is_empty() && !["%", "lbf ft", "lbf in"].contains(&suffix.as_str()) {
            let by_name = units.of_name(&format!("it_{suffix}")).expect("a unit");
            assert_eq!(by_name.dimension, QuantityUnit::from(unit).dimension, "{suffix}");
            assert!((by_name.to_si(3.7) - unit.to_si(3.7)).abs() <= 1e-15 * unit.to_si(3.7), "{suffix}");
        }
    }
    assert!(compared > 60, "{compared}");
}

#[test]
fn every_models_names_say_their_units() {
    let units = Units::default();
    for model in crate::models::all().iter() {
        let inputs = model.inputs.iter().map(|input| (&input.name, input.unit));
        for (name, unit) in inputs.chain(model.outputs.iter().map(|output| (&output.name, output.unit))) {
            let by_name = units.of_name(name).expect("a unit");
            assert_eq!(by_name.dimension, QuantityUnit::from(unit).dimension, "{name} of {}", model.name);
            assert!((by_name.to_si(1.0) - unit.to_si(1.0)).abs() <= 1e-15 * unit.to_si(1.0), "{name} of {}", model.name);
        }
    }
}

#[test]
fn names_end_in_their_units() {
    let units = Units::new(&["EUR".to_owned()]).expect("a unit");
    let cases = [
        ("cost_EUR", 1.0, "a quantity in EUR"),
        ("price_EUR_per_kg", 1.0, "a quantity in EUR/kg"),
        ("cost_EUR_per_kWh", 1.0 / 3.6e6, "a quantity in s^2 EUR/(kg m^2)"),
        ("belt_mass_kg", 1.0, "a mass"),
        ("speed_m_per_s", 1.0, "a speed"),
        ("stiffness_N_per_mm", 1000.0, "a force per length"),
        ("acceleration_mm_per_s2", 0.001, "an acceleration"),
        ("area_mm2", 1e-6, "an area"),
        ("life_h", 3600.0, "a time"),
        ("bending_per_s", 1.0, "a frequency"),
        ("inertia_kgm2", 1.0, "a quantity in kg m^2"),
        ("slip_percent", 0.01, "a plain number"),
        ("radius_min", 1.0, "a plain number"),
        ("friction", 1.0, "a plain number"),
        ("m", 1.0, "a plain number"),
        ("EUR", 1.0, "a plain number"),
        ("share_of_kg_x", 1.0, "a plain number"),
        ("_kg", 1.0, "a mass"),
        ("_", 1.0, "a plain number"),
    ];
    for (name, wanted, words) in cases {
        let measure = units.of_name(name).expect("a unit");
        assert_eq!(units.in_words(measure.dimension), words, "{name}");
        assert!((measure.to_si(1.0) - wanted).abs() <= 1e-15 * wanted, "{name}");
    }
    for (name, symbol) in
        [("cost_EUR", "EUR"), ("price_EUR_per_kg", "EUR/kg"), ("flexes_per_s", "1/s"), ("friction", ""), ("area_mm2", "mm2")]
    {
        assert_eq!(units.symbol_of_name(name).as_deref(), Ok(symbol));
    }
    assert!(units.of_name("speed_m_per_min").unwrap_err().contains("_min says minimum"));
}

#[test]
fn own_units_must_be_new_words() {
    let problems = |own: &[&str]| {
        let own: Vec<String> = own.iter().map(|unit| (*unit).to_owned()).collect();
        Units::new(&own).err().unwrap_or_default().into_iter().map(|(at, message)| format!("{at}: {message}")).collect::<Vec<_>>()
    };
    assert_eq!(problems(&["EUR", "K", "cycle"]), Vec::<String>::new());
    assert_eq!(problems(&["EUR", "kg"]), ["1: \"kg\" is known already; choose another name"]);
    assert_eq!(problems(&["EUR", "EUR"]), ["1: \"EUR\" is given twice; keep one of the two"]);
    assert_eq!(problems(&["€"]), ["0: \"€\" cannot be a unit; use up to 16 letters from A to Z, such as \"EUR\""]);
    assert_eq!(problems(&["a", "b", "c", "d", "e", "f", "i", "j", "k"]), ["8: there may be at most 8 own units"]);
}
