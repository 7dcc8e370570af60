//! What is printed reads back as the same formula.

use super::random::RandomTree;
use super::*;

#[test]
fn parentheses_stand_where_they_are_needed() {
    let cases = [
        ("a+b*c", "a + b * c"),
        ("(a+b)*c", "(a + b) * c"),
        ("a-(b-c)", "a - (b - c)"),
        ("(a-b)-c", "a - b - c"),
        ("a/(b*c)", "a / (b * c)"),
        ("-(a^2)", "-a^2"),
        ("(-a)^2", "(-a)^2"),
        ("(a^b)^c", "(a^b)^c"),
        ("a^(b^c)", "a^b^c"),
        ("a^(-b)", "a^-b"),
        ("a^(b*c)", "a^(b * c)"),
        ("-(a+b)", "-(a + b)"),
        ("a*(-b)", "a * -b"),
        ("7850[kg/m^3]*x", "7850[kg/m^3] * x"),
        ("if(a<b,1,'w')", "if(a < b, 1, 'w')"),
        ("root( r,0,1 , r-a)", "root(r, 0, 1, r - a)"),
        ("min(a,b,  c)+f()", "min(a, b, c) + f()"),
        ("1e300*1e-300*0.00002", "1e300 * 1e-300 * 0.00002"),
    ];
    for (text, wanted) in cases {
        assert_eq!(Expression::parse(text).expect("a formula").to_string(), wanted);
    }
}

#[test]
fn names_may_be_replaced_by_symbols() {
    let formula = Expression::parse("-2 * a_mm^2 + if(b < a_mm, min(c, 1[mm]), root(r, 0, 1, r - b))").expect("a formula");
    let symbol = |name: &str| [("a_mm", "d"), ("b", "F_a")].iter().find(|(own, _)| *own == name).map(|(_, symbol)| (*symbol).to_owned());
    assert_eq!(formula.renamed(&symbol).to_string(), "-2 * d^2 + if(F_a < d, min(c, 1[mm]), root(r, 0, 1, r - F_a))");
}

#[test]
fn a_printed_formula_reads_back_as_itself() {
    let mut random = RandomTree::new(11);
    for _ in 0..20_000 {
        let expression = random.tree(5);
        let text = expression.to_string();
        let again = Expression::parse(&text).unwrap_or_else(|problem| panic!("{text}: {problem}"));
        assert_eq!(again, expression, "{text}");
        assert_eq!(again.to_string(), text);
    }
}

#[test]
fn the_deepest_formula_reads_back_too() {
    for (before, behind) in [("1-(", ")"), ("-(1+", ")"), ("f(", ")"), ("(-", ")^2"), ("2^(1+", ")")] {
        let levels = |count: usize| format!("{}x{}", before.repeat(count), behind.repeat(count));
        let deepest = (1..=MOST_DEPTH).rev().find_map(|count| Expression::parse(&levels(count)).ok()).expect("some");
        assert_eq!(Expression::parse(&deepest.to_string()).expect("what is printed can be read"), deepest);
    }
}
