//! Formulas that are wrong, with what is said of each.

use super::sets::problems;
use super::*;

/// Name, text, column, message.
const BROKEN: &[(&str, &str, usize, &str)] = &[
    ("it", "", 1, "the formula is empty"),
    ("it", "   ", 1, "the formula is empty"),
    ("it", "1 +", 4, "the formula ends where a value should stand"),
    ("it", "* 2", 1, "a value should stand in front of \"*\""),
    ("it", "1 + * 2", 5, "a value should stand in front of \"*\""),
    ("it", "+1", 1, "a value should stand in front of \"+\""),
    ("it", "()", 2, "a value should stand in front of \")\""),
    ("it", "(1 + 2", 7, "the formula ends here, but something is not closed; add \")\""),
    ("it", "sin(30[deg]", 12, "the formula ends here, but something is not closed; add \")\""),
    ("it", "1)", 2, "a parenthesis is closed that was never opened"),
    ("it", "1 2", 3, "an operator is missing in front of 2"),
    ("it", "2 friction", 3, "an operator is missing in front of \"friction\""),
    ("it", "2(3)", 2, "an operator is missing in front of \"(\"; write a product with \"*\""),
    ("it", "2friction", 2, "a letter follows the number 2; write a unit as 2[mm], and a product with \"*\""),
    ("it", "2 'word'", 3, "an operator is missing in front of 'word'"),
    ("it", "1,5", 2, "a comma separates arguments of a function only; write decimals with a point"),
    ("it", "(1,5)", 3, "a comma separates arguments of a function only; write decimals with a point"),
    ("it", "1_000", 2, "a number has digits only; leave out \"_\""),
    ("it", "1.2.3", 4, "a number has one point only"),
    ("it", ".", 1, "\".\" is not a number"),
    ("it", "1e999", 1, "1e999 is too large; numbers go up to 1.8e308"),
    ("it", "1 $ 2", 3, "\"$\" has no meaning in a formula"),
    ("it", "µ", 1, "\"µ\" has no meaning in a formula"),
    ("it", "2 ** 3", 3, "a power is written with \"^\""),
    ("it", "2 × 3", 3, "a product is written with \"*\""),
    ("it", "2 ÷ 3", 3, "a quotient is written with \"/\""),
    ("it", "50 %", 4, "there is no \"%\" here; write 5[%], or divide by 100"),
    ("it", "min(1; 2)", 6, "arguments are separated by commas"),
    ("it", "if(1 = 2, 3, 4)", 6, "\"=\" compares nothing; write \"==\""),
    ("it", "if(1 != 2, 3, 4)", 6, "there is no \"!=\"; write if(a == b, y, x)"),
    ("it", "if(1 < 2 && 2 < 3, 3, 4)", 10, "there is no \"&&\"; put one if(...) into another"),
    ("it", "if(1 < 2 || 2 < 3, 3, 4)", 10, "there is no \"||\"; put one if(...) into another"),
    ("it", "if(1, 2, 3)", 5, "the first argument of if(...) compares; write if(a < b, x, y)"),
    ("it", "if(1 < 2, 3)", 12, "an argument is missing; write if(a < b, x, y)"),
    ("it", "if(1 < 2, 3, 4, 5)", 15, "this argument is one too many; write if(a < b, x, y)"),
    ("it", "if(1 < 2 < 3, 4, 5)", 10, "\"<\" compares, which only the first argument of if(...) does; write if(a < b, x, y)"),
    ("it", "1 < 2", 3, "\"<\" compares, which only the first argument of if(...) does; write if(a < b, x, y)"),
    ("it", "(1 == 2) * 3", 4, "\"==\" compares, which only the first argument of if(...) does; write if(a == b, x, y)"),
    ("it", "if(friction == 1, 2, 3)", 4, "\"==\" compares whole numbers and words only; write \"<=\" or \">=\", or round(...) both sides"),
    ("it", "if(section == 'machind', 1, 2)", 15, "section is never 'machind'; did you mean \"machined\"?"),
    ("it", "if(section == 'x', 1, 2)", 15, "section is never 'x'; its words are machined, pressed-cup"),
    ("it", "if(friction == 'x', 1, 2)", 16, "friction takes numbers only, no words"),
    ("it", "if(section < 'machined', 1, 2)", 14, "a word is compared with \"==\" only, not with \"<\""),
    ("it", "if('a' == 'b', 1, 2)", 4, "two words are compared; one side must be the name of an input"),
    ("it", "if(2 == 'machined', 1, 2)", 4, "'machined' can be compared with the name of an input only"),
    ("it", "if(secton == 'machined', 1, 2)", 4, "unknown name \"secton\"; did you mean \"section\"?"),
    ("it", "if(section == 1, 1, 2)", 4, "section is a word, and no number can be computed from it; write if(section == 'machined', x, y)"),
    ("it", "2 * traction", 5, "traction may be a word, and no number can be computed from it; write if(traction == 'limit', x, y)"),
    ("it", "'limit'", 1, "the word 'limit' can be compared only: if(NAME == 'limit', x, y)"),
    ("it", "if(section == 'machined, 1, 2)", 15, "a word is not closed; add '"),
    ("it", "1 + frction", 5, "unknown name \"frction\"; did you mean \"friction\"?"),
    ("it_mm", "radius", 1, "unknown name \"radius\"; did you mean \"radius_mm\"?"),
    ("it", "nothing_like_it", 1, "unknown name \"nothing_like_it\"; it is no input, output, variable, formula or curve"),
    ("it", "sqr(2)", 1, "unknown function \"sqr\"; did you mean \"sqrt\"?"),
    ("it", "friction(2)", 1, "friction is no function; write a product with \"*\""),
    ("it", "sqrt", 1, "sqrt is a function; write sqrt(x)"),
    ("it", "if", 1, "if is a function; write if(a < b, x, y)"),
    ("it", "slip", 1, "slip is a curve; write slip(x)"),
    ("it", "sqrt()", 1, "sqrt takes one argument, here it has 0; write sqrt(x)"),
    ("it", "sqrt(1, 2)", 1, "sqrt takes one argument, here it has 2; write sqrt(x)"),
    ("it", "min(1)", 1, "min takes two or more arguments, here it has 1; write min(a, b)"),
    ("it", "clamp(1, 2)", 1, "clamp takes three arguments, here it has 2; write clamp(x, low, high)"),
    ("it", "default(1)", 1, "default takes two arguments, here it has 1; write default(x, y)"),
    ("it", "slip()", 1, "the curve slip takes one argument, here it has 0"),
    ("it", "slip(3)", 1, "the curve slip takes a speed, not a plain number"),
    ("it", "nominal(friction)", 1, "friction has no tolerance that nominal could leave out; write friction itself"),
    ("it", "nominal(frction)", 9, "unknown name \"frction\"; did you mean \"friction\"?"),
    ("it", "nominal(2 * friction)", 1, "nominal takes the name of an input with a tolerance; write nominal(NAME)"),
    ("it", "nominal(friction, radius_mm)", 1, "nominal takes the name of an input with a tolerance; write nominal(NAME)"),
    ("it", "sin(30)", 5, "sin takes an angle, not a plain number; write 30[deg]"),
    ("it", "sin(pi / 2)", 5, "sin takes an angle, not a plain number; multiply it by 1[rad] if it is one"),
    ("it", "cos(radius_mm)", 5, "cos takes an angle, not a length; divide it by what makes it one"),
    (
        "share",
        "wrap_deg / 180",
        1,
        "the formula gives an angle, but share is a plain number; end the name in the unit, as belt_mass_kg does, or divide by one",
    ),
    ("it", "exp(wrap_deg)", 5, "exp takes a plain number, not an angle; divide it by 1[rad] or the like"),
    ("it", "round(radius_mm)", 7, "round takes a plain number, not a length; divide it by 1[m] or the like"),
    ("it_mm", "radius_mm + 3", 1, "a length and a plain number cannot be added; write the number with its unit, such as 3[m]"),
    ("it_mm", "radius_mm - torque_Nm", 1, "a torque or an energy cannot be subtracted from a length"),
    ("it", "max(1[mm], 2[s])", 12, "the arguments of max must measure the same; these are a length and a time"),
    ("it", "if(radius_mm < torque_Nm, 1, 2)", 4, "a length and a torque or an energy cannot be compared"),
    (
        "it",
        "if(1 < 2, radius_mm, torque_Nm)",
        1,
        "both values of if(...) must measure the same; these are a length and a torque or an energy",
    ),
    ("cost_EUR", "14[EUR/kg] * torque_Nm", 1, "the formula gives a quantity in m^2 EUR/s^2, but cost_EUR is a quantity in EUR"),
    ("it_kg", "radius_mm", 1, "the formula gives a length, but it_kg is a mass"),
    ("power_kW", "torque_Nm * speed_rpm", 1, "the formula gives a quantity in kg m^2 rad/s^3, but power_kW is a power"),
    ("rate_rpm", "1500[1/min]", 1, "the formula gives a frequency, but rate_rpm is a rotational speed"),
    ("it", "sqrt(sqrt(sqrt(radius_mm)))", 6, "the square root of a quantity in m^(1/4) is no quantity"),
    ("it", "radius_mm^friction", 11, "a power of a length needs a constant exponent"),
    ("it", "radius_mm^0.37", 11, "a length to the power of 0.37 is no quantity: powers of units are multiples of 1/12, up to 24"),
    ("it", "2^radius_mm", 3, "an exponent is a plain number, not a length"),
    (
        "it",
        "radius_mm^8 * radius_mm^8 * radius_mm^8 * radius_mm",
        1,
        "the units of a quantity in m^24 with a length come to powers beyond 24",
    ),
    ("it", "1 / 0", 5, "this is always zero, and nothing can be divided by it"),
    ("it", "friction / (2 - 2)", 13, "this is always zero, and nothing can be divided by it"),
    ("it", "sqrt(-1)", 1, "this has no value: root of a negative number"),
    ("it", "ln(0)", 1, "this has no value: logarithm of a number that is not positive"),
    ("it", "asin(2) / 1[rad]", 1, "this has no value: arc sine of a number beyond -1 to 1"),
    ("it", "1e200 * 1e200", 1, "this comes to a number beyond 1.8e308"),
    ("it", "1e308[km] / 1[m]", 1, "this comes to a number beyond 1.8e308"),
    ("it", "3[furlong]", 3, "unknown unit \"furlong\"; if it is one of your own, write units = [\"furlong\"] at the top of the study"),
    ("it", "3[kgg]", 3, "unknown unit \"kgg\"; did you mean \"kgf\"?"),
    (
        "it",
        "20[degC]",
        4,
        "\"degC\" counts from a zero of its own, which no factor converts; take differences of temperature in a unit of your own, units = [\"K\"]",
    ),
    ("it", "3[]", 3, "the brackets are empty; write a unit such as [mm], or leave them out"),
    ("it", "3[W/m/s]", 6, "a unit has one \"/\" only; put what it is divided by in parentheses: [W/(m K)]"),
    ("it", "3[W/m s]", 7, "put what the unit is divided by in parentheses: [W/(m K)]"),
    ("it", "3[W/(m s]", 9, "a parenthesis of the unit is not closed; add \")\""),
    ("it", "3[m/]", 5, "the unit ends here; write for example [N m], [kg/m^3] or [1/s]"),
    ("it", "3[2 m]", 3, "\"2\" has no place in a unit; write for example [N m], [kg/m^3] or [1/s]"),
    ("it", "3[1 m]", 5, "behind the 1 of a unit stands \"/\"; write [1/s]"),
    ("it", "3[m+s]", 4, "\"+\" has no place in a unit; write for example [N m], [kg/m^3] or [1/s]"),
    ("it", "3[m^0]", 4, "the power of a unit is a whole number from -12 to 12 other than 0, as in [m^3] or [s^-1]"),
    ("it", "3[m^99]", 4, "the power of a unit is a whole number from -12 to 12 other than 0, as in [m^3] or [s^-1]"),
    ("it", "3[m^12 m^12 m]", 13, "the powers of this unit are too large"),
    ("it", "3[mm", 2, "a unit is not closed; add \"]\""),
    ("it", "friction[mm]", 9, "[mm] stands behind no number; write 1[mm] * (...)"),
    ("it", "[mm]", 1, "[mm] stands behind no number; write 1[mm]"),
    ("it", "root(2, 0, 1, friction)", 6, "the first argument of root is a name for the unknown; write root(r, from, to, expression)"),
    ("it", "root(r, 0, 1)", 13, "an argument is missing; write root(r, from, to, expression)"),
    ("it", "root(r, 0, 1, friction)", 15, "the expression of this root does not depend on r"),
    ("it", "root(friction, 0, 1, friction)", 1, "friction is known already; choose another name for the unknown of the root"),
    (
        "it",
        "root(r, 0, 1[mm], r - 1)",
        19,
        "a plain number cannot be subtracted from a length; write the number with its unit, such as 1[m]",
    ),
    (
        "it",
        "root(r, 0, 1, r + root(s, 0, 1, s - r))",
        19,
        "a root cannot lie within another root's expression; give it a formula of its own",
    ),
    ("it", "root(r, 0, 9, floor(r) - 3)", 15, "floor jumps, so the root around it may not exist; keep the unknown out of it"),
    ("it", "root(r, 0, 1[mm], r - 1[mm]) + r", 32, "unknown name \"r\"; it is no input, output, variable, formula or curve"),
    (
        "speed_m_per_min",
        "1",
        1,
        "speed_m_per_min ends in _per_min, but no name is in minutes, since _min says minimum; use _per_s, or _rpm",
    ),
];

#[test]
fn every_broken_formula_is_told_what_is_wrong_and_where() {
    assert!(BROKEN.len() >= 100);
    let mut wrong = Vec::new();
    for &(name, text, column, message) in BROKEN {
        let told = problems(&[(name, text)]);
        let wanted = format!("{name}, line 1, column {column}: {message}");
        if told != [wanted.as_str()] {
            wrong.push(format!("{text:?}\n  wanted {wanted:?}\n  got    {told:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn all_problems_are_told_at_once_each_in_its_line() {
    let told = problems(&[("a_kg", "frction +\n  radius_mm * 3[kgg] +\n  sin(2)"), ("b", "1 +"), ("c", "a_kg")]);
    assert_eq!(
        told,
        [
            "a_kg, line 1, column 1: unknown name \"frction\"; did you mean \"friction\"?",
            "a_kg, line 2, column 17: unknown unit \"kgg\"; did you mean \"kgf\"?",
            "a_kg, line 3, column 7: sin takes an angle, not a plain number; write 2[deg]",
            "b, line 1, column 4: the formula ends where a value should stand",
            "c, line 1, column 1: the formula gives a mass, but c is a plain number; end the name in the unit, as belt_mass_kg does, or divide by one",
        ]
    );
    let many = vec!["x1"; 60].join("+");
    assert_eq!(problems(&[("a", &many)]).len(), 20, "of many problems the first are told");
}

#[test]
fn size_is_bounded() {
    let deep = |count: usize| format!("{}1{}", "(".repeat(count), ")".repeat(count));
    assert_eq!(problems(&[("a", &deep(299))]), Vec::<String>::new());
    let message = "more than 100 operations lie inside one another or in a row; give a part a formula of its own";
    assert_eq!(problems(&[("a", &deep(300))]), [format!("a, line 1, column 301: {message}")]);
    let sum = |terms: usize| vec!["1"; terms].join("+");
    assert_eq!(problems(&[("a", &sum(100))]), Vec::<String>::new());
    assert_eq!(problems(&[("a", &sum(101))]), [format!("a, line 1, column 202: {message}")]);
    assert_eq!(problems(&[("a", &"-".repeat(3000))])[0], format!("a, line 1, column 301: {message}"));
    let long = format!("{}1", " ".repeat(MOST_BYTES));
    assert_eq!(problems(&[("a", &long)]), ["a, line 1, column 4001: a formula may have 4000 bytes, this one has 4001; make several of it"]);
    let arguments = vec!["1"; 51].join(",");
    assert!(problems(&[("a", &format!("min({arguments})"))])[0].ends_with("a function has at most 50 arguments"));
}
