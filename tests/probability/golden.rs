use beltspace::probability::Distribution;

/// The rows of golden.csv of one kind, without the word for it.
pub fn rows(kind: &str) -> Vec<Vec<&'static str>> {
    let lines = include_str!("golden.csv").lines().filter(|line| !line.starts_with('#'));
    let cells = lines.map(|line| line.split(',').collect::<Vec<_>>()).filter(|cells| cells[0] == kind);
    let rows: Vec<_> = cells.map(|cells| cells[1..].to_vec()).collect();
    assert!(rows.len() > 10, "golden.csv has rows of {kind}");
    rows
}

/// A cell as a number.
pub fn number(cell: &str) -> f64 {
    cell.parse().unwrap_or_else(|_| panic!("{cell} is no number"))
}

/// A distribution by its name and parameters, with the ends of its truncation or empty cells.
pub fn distribution(words: &str, from: &str, to: &str) -> Distribution {
    let mut words = words.split(' ');
    let name = words.next().unwrap_or("");
    let numbers: Vec<_> = words.map(number).collect();
    let made = match (name, &numbers[..]) {
        ("uniform", &[from, to]) => Distribution::uniform(from, to),
        ("normal", &[mean, sd]) => Distribution::normal(mean, sd),
        ("lognormal", &[mean, sd]) => Distribution::lognormal(mean, sd),
        ("triangular", &[from, mode, to]) => Distribution::triangular(from, mode, to),
        ("beta", &[alpha, beta, from, to]) => Distribution::beta(alpha, beta, from, to),
        ("weibull", &[shape, scale, from]) => Distribution::weibull(shape, scale, from),
        ("gumbel", &[mode, scale]) => Distribution::gumbel(mode, scale),
        ("exponential", &[mean]) => Distribution::exponential(mean),
        _ => panic!("{name} {numbers:?}"),
    };
    let made = made.expect("it is right");
    if from.is_empty() { made } else { made.truncated(number(from), number(to)).expect("something is left") }
}
