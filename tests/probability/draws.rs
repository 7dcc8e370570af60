use beltspace::probability::{Distribution, Draws, Effect, ProbabilityProblem, Sampling, pearson, spearman};
use std::f64::consts::PI;

const SPREADS: [Sampling; 3] = [Sampling::Random, Sampling::LatinHypercube { replicates: 16 }, Sampling::Sobol { replicates: 16 }];
const COUNT: u64 = 1 << 16;

fn unit() -> Distribution {
    Distribution::uniform(0.0, 1.0).unwrap()
}

fn standard() -> Distribution {
    Distribution::normal(0.0, 1.0).unwrap()
}

/// The largest distance between the distribution of a sample and what it should be.
fn kolmogorov(values: &[f64], law: &Distribution) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let distance = |(place, value): (usize, &f64)| (law.cdf(*value) - place as f64 / n).max((place + 1) as f64 / n - law.cdf(*value));
    sorted.iter().enumerate().map(distance).fold(0.0, f64::max)
}

/// More than this a sample of independent numbers misses its distribution by once in a million times.
fn once_in_a_million(count: u64) -> f64 {
    ((2e6f64).ln() / 2.0 / count as f64).sqrt()
}

fn laws() -> [(&'static str, Distribution); 6] {
    [
        ("friction", Distribution::normal(0.08, 0.006).unwrap().truncated(0.07, 0.11).unwrap()),
        ("load_N", Distribution::gumbel(570.0, 40.0).unwrap()),
        ("length_mm", Distribution::triangular(-0.5, 0.1, 0.4).unwrap()),
        ("wear", Distribution::beta(0.8, 2.5, 0.0, 1.0).unwrap()),
        ("life_h", Distribution::weibull(1.7, 3000.0, 100.0).unwrap()),
        ("stiffness", Distribution::lognormal(570.0, 80.0).unwrap()),
    ]
}

#[test]
fn draws_have_their_distribution() {
    for sampling in SPREADS {
        let columns = Draws::new(&laws(), COUNT, sampling, 7).unwrap().columns(0..COUNT);
        for ((name, law), values) in laws().iter().zip(&columns) {
            let distance = kolmogorov(values, law);
            assert!(distance < once_in_a_million(COUNT), "{name} by {sampling:?}: {distance}");
            let mean = values.iter().sum::<f64>() / COUNT as f64;
            assert!((mean - law.mean()).abs() < 5.0 * law.sd() / (COUNT as f64).sqrt(), "{name} by {sampling:?}: mean {mean}");
        }
        for (a, x) in columns.iter().enumerate() {
            for y in &columns[a + 1..] {
                assert!(spearman(x, y).unwrap().abs() < 5.0 / (COUNT as f64).sqrt(), "{sampling:?}");
            }
        }
    }
    // The bound notices a distribution that is a little off.
    let values = &Draws::new(&[("x", standard())], COUNT, Sampling::Random, 7).unwrap().columns(0..COUNT)[0];
    assert!(kolmogorov(values, &Distribution::normal(0.0, 1.05).unwrap()) > once_in_a_million(COUNT));
    assert!(kolmogorov(values, &Distribution::normal(0.03, 1.0).unwrap()) > once_in_a_million(COUNT));
}

#[test]
fn a_draw_depends_on_seed_name_and_number_alone() {
    const FEW: u64 = 1 << 13;
    let forward = laws();
    let mut backward = laws();
    backward.reverse();
    let pairs = [("friction", "load_N", -0.3), ("wear", "friction", 0.5)];
    let turned = [("friction", "wear", 0.5), ("load_N", "friction", -0.3)];
    for sampling in SPREADS {
        let draws = Draws::new(&forward, FEW, sampling, 7).unwrap();
        let all = draws.columns(0..FEW);
        let mut others = Draws::new(&backward, FEW, sampling, 7).unwrap().columns(0..FEW);
        others.reverse();
        assert_eq!(all, others, "the order of inputs");
        let mut others = Draws::new(&backward, FEW, sampling, 7).unwrap().correlated(&turned).unwrap().columns(0..FEW);
        others.reverse();
        let tied = draws.clone().correlated(&pairs).unwrap().columns(0..FEW);
        assert_eq!(tied, others, "the order of correlated inputs");
        assert_eq!((&tied[2], &tied[4], &tied[5]), (&all[2], &all[4], &all[5]), "whoever is not correlated is drawn as before");
        // A part, which begins in one replicate and ends in another.
        let part = draws.columns(4000..4200);
        assert!(all.iter().zip(&part).all(|(all, part)| all[4000..4200] == part[..]));
        assert_ne!(Draws::new(&forward, FEW, sampling, 8).unwrap().columns(0..FEW), all, "the seed");
    }
    let few = Draws::new(&forward[..1], 10, Sampling::Random, 7).unwrap().columns(0..10);
    assert_eq!(few[0], Draws::new(&forward, FEW, Sampling::Random, 7).unwrap().columns(0..10)[0], "number of draws and other inputs");
    let same = [("a", unit()), ("b", unit())];
    let columns = Draws::new(&same, 10, Sampling::Random, 7).unwrap().columns(0..10);
    assert_ne!(columns[0], columns[1], "the name");
}

#[test]
fn the_numbers_that_are_drawn_stay_what_they_are() {
    // Made with Python: SHA-256 of word, seed and name as the key of ChaCha with eight rounds, 52 bits of every eight bytes.
    let columns = Draws::new(&[("friction", unit())], 3, Sampling::Random, 1).unwrap().columns(0..3);
    assert_eq!(columns[0], [0.25486481894323754, 0.3938524565424969, 0.23349691279022655]);
    let fresh = Draws::new(&[("friction", unit())], 3, Sampling::Random, 1).unwrap().confirming(3).unwrap().columns(0..3);
    assert_eq!(fresh[0], [0.12289084821989993, 0.547738752423523, 0.04219504275337693]);
}

#[test]
fn confirming_draws_are_fresh_and_independent() {
    let pairs = [("friction", "load_N", -0.3)];
    let chosen = Draws::new(&laws(), COUNT, Sampling::Sobol { replicates: 16 }, 7).unwrap().correlated(&pairs).unwrap();
    let fresh = chosen.confirming(100_000).unwrap();
    assert_eq!(fresh.count(), 100_000);
    let (old, new) = (chosen.columns(0..COUNT), fresh.columns(0..COUNT));
    for (old, new) in old.iter().zip(&new) {
        assert!(spearman(old, new).unwrap().abs() < 5.0 / (COUNT as f64).sqrt());
    }
    let kept = spearman(&new[0], &new[1]).unwrap();
    assert!((kept - 6.0 / PI * (-0.15f64).asin()).abs() < 0.02, "the correlation is kept: {kept}");
}

#[test]
fn every_replicate_of_a_hypercube_has_one_draw_in_every_range() {
    let draws = Draws::new(&[("a", unit()), ("b", unit())], 16_000, Sampling::LatinHypercube { replicates: 16 }, 3).unwrap();
    let columns = draws.columns(0..16_000);
    let mut first = Vec::new();
    for column in &columns {
        for replicate in column.chunks(1000) {
            let order: Vec<_> = replicate.iter().map(|value| (value * 1000.0) as usize).collect();
            let mut strata = order.clone();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..1000));
            assert!(!first.contains(&order), "each replicate has an order of its own");
            first.push(order);
        }
    }
}

#[test]
fn every_replicate_of_sobol_has_one_draw_in_every_box_and_a_scrambling_of_its_own() {
    let draws = Draws::new(&[("a", unit()), ("b", unit())], 16 << 10, Sampling::Sobol { replicates: 16 }, 3).unwrap();
    let columns = draws.columns(0..16 << 10);
    let replicates: Vec<_> = columns[0].chunks(1 << 10).zip(columns[1].chunks(1 << 10)).collect();
    for (x, y) in &replicates {
        // Whatever the shape of 1024 equal boxes, each has one point: a (0, 10, 2)-net, which Owen's scrambling keeps.
        for halvings in 0..=10 {
            let (wide, high) = (f64::from(1 << halvings), f64::from(1 << (10 - halvings)));
            let mut boxes: Vec<_> =
                x.iter().zip(*y).map(|(x, y)| (x * wide) as usize * (1 << (10 - halvings)) + (y * high) as usize).collect();
            boxes.sort_unstable();
            assert!(boxes.into_iter().eq(0..1024), "{halvings}");
        }
    }
    // Scrambled points lie anywhere in their ranges, and a digital shift would keep the distance of the first two points in binary digits.
    let gap = |x: &[f64]| ((x[0] * f64::from(1 << 20)) as u64) ^ ((x[1] * f64::from(1 << 20)) as u64);
    let mut gaps: Vec<_> = replicates.iter().map(|(x, _)| gap(x)).collect();
    gaps.sort_unstable();
    gaps.dedup();
    assert_eq!(gaps.len(), 16, "sixteen scramblings");
}

#[test]
fn sobol_points_integrate_better_than_random_ones() {
    let names: Vec<_> = (0..6).map(|i| format!("x{i}")).collect();
    let inputs: Vec<_> = names.iter().map(|name| (name.as_str(), unit())).collect();
    let error = |sampling| {
        let columns = Draws::new(&inputs, COUNT, sampling, 5).unwrap().columns(0..COUNT);
        let product = |draw: usize| columns.iter().map(|column| 1.0 + 0.5 * (column[draw] - 0.5)).product::<f64>();
        let parts: Vec<_> = (0..16).map(|part| (part << 12..(part + 1) << 12).map(product).sum::<f64>() / 4096.0 - 1.0).collect();
        (parts.iter().map(|part| part * part).sum::<f64>() / 16.0).sqrt()
    };
    let (random, latin, sobol) = (error(SPREADS[0]), error(SPREADS[1]), error(SPREADS[2]));
    assert!(sobol < latin / 5.0 && latin < random / 3.0, "{random} {latin} {sobol}");
}

#[test]
fn correlations_are_those_of_the_normal_scores() {
    let inputs = [("c", standard()), ("a", standard()), ("b", standard()), ("d", standard())];
    let wanted = [("a", "b", 0.8), ("b", "c", -0.5), ("c", "a", -0.2)];
    for sampling in SPREADS {
        let columns = Draws::new(&inputs, COUNT, sampling, 11).unwrap().correlated(&wanted).unwrap().columns(0..COUNT);
        let column = |name: &str| &columns[inputs.iter().position(|input| input.0 == name).unwrap()];
        for (a, b, r) in wanted {
            let measured = pearson(column(a), column(b)).unwrap();
            assert!((measured - r).abs() < 5.0 * (1.0 - r * r) / (COUNT as f64).sqrt(), "{sampling:?} {a} {b}: {measured}");
        }
        assert!(pearson(column("a"), column("d")).unwrap().abs() < 5.0 / (COUNT as f64).sqrt());
        for values in &columns {
            assert!(kolmogorov(values, &standard()) < once_in_a_million(COUNT), "a correlated input keeps its distribution");
        }
    }
    // Ranks do not depend on the distributions: the correlation of Spearman is 6/pi asin(r/2) for all.
    let columns =
        Draws::new(&laws(), COUNT, Sampling::Random, 11).unwrap().correlated(&[("load_N", "wear", 0.7)]).unwrap().columns(0..COUNT);
    let ranked = spearman(&columns[1], &columns[3]).unwrap();
    assert!((ranked - 6.0 / PI * 0.35f64.asin()).abs() < 0.01, "{ranked}");
}

#[test]
fn discrete_values_rise_with_their_score() {
    let plies = Distribution::discrete(&[3.0, 1.0, 2.0], &[0.2, 0.5, 0.3]).unwrap();
    let inputs = [("plies", plies), ("x", standard())];
    let columns = Draws::new(&inputs, COUNT, Sampling::Random, 2).unwrap().correlated(&[("plies", "x", 0.95)]).unwrap().columns(0..COUNT);
    let of = |plies: f64| columns[0].iter().zip(&columns[1]).filter(|it| *it.0 == plies).map(|it| *it.1).collect::<Vec<_>>();
    for (plies, share) in [(1.0, 0.5), (2.0, 0.3), (3.0, 0.2)] {
        assert!((of(plies).len() as f64 / COUNT as f64 - share).abs() < 0.01);
    }
    let mean = |plies| of(plies).iter().sum::<f64>() / of(plies).len() as f64;
    assert!(mean(1.0) < mean(2.0) - 0.5 && mean(2.0) < mean(3.0) - 0.5);
}

#[test]
fn a_tolerance_is_about_what_the_design_says() {
    assert_eq!([Effect::Is, Effect::Times, Effect::Plus].map(|effect| effect.of(600.0, 1.5)), [1.5, 900.0, 601.5]);
}

#[test]
fn wrong_draws_are_named_with_the_limit_and_the_remedy() {
    let three = || [("friction", unit()), ("load_N", unit()), ("wear", unit())];
    let draws = |count, sampling| Draws::new(&three(), count, sampling, 1);
    let tied = |pairs: &[(&str, &str, f64)]| draws(16, Sampling::Random).unwrap().correlated(pairs);
    let many: Vec<_> = (0..101).map(|i| format!("x{i}")).collect();
    let many: Vec<_> = many.iter().map(|name| (name.as_str(), unit())).collect();
    let cases: [(Result<Draws, ProbabilityProblem>, &str); 16] = [
        (draws(0, Sampling::Random), "probability: draws is 0, and must be between 1 and 1e9"),
        (draws(16, Sampling::Random).unwrap().confirming(0), "probability: confirm is 0, and must be between 1 and 1e9"),
        (draws(100, Sampling::LatinHypercube { replicates: 4 }), "latin-hypercube: replicates is 4, and must be between 16 and 1e9"),
        (
            draws(1000, Sampling::LatinHypercube { replicates: 16 }),
            "latin-hypercube: 1000 draws cannot be divided into 16 replicates; take 1008 draws",
        ),
        (
            draws(1008, Sampling::Sobol { replicates: 16 }),
            "sobol: 1008 draws cannot be divided into 16 replicates of a power of two each; take 1024 draws",
        ),
        (
            Draws::new(&many, 16, Sampling::Sobol { replicates: 16 }, 1),
            "sobol: 101 inputs are uncertain, and there are points for at most 100; use random or latin-hypercube",
        ),
        (Draws::new(&[("wear", unit()), ("wear", unit())], 1, Sampling::Random, 1), "wear has two distributions; give it one"),
        (tied(&[("fricton", "wear", 0.1)]), "correlation: fricton has no distribution; did you mean \"friction\"?"),
        (tied(&[("speed", "wear", 0.1)]), "correlation: speed has no distribution; these have: friction, load_N, wear"),
        (tied(&[("wear", "wear", 0.1)]), "correlation: wear and wear are the same input; name two"),
        (
            tied(&[("wear", "load_N", 0.1), ("load_N", "wear", 0.1)]),
            "correlation: load_N and wear stand there twice; give them one correlation",
        ),
        (tied(&[("wear", "load_N", 1.2)]), "correlation: wear and load_N have 1.2, and it must be between -1 and 1"),
        (tied(&[("wear", "load_N", -1.0)]), "correlation: wear and load_N have -1, and it must be between -1 and 1"),
        (tied(&[("wear", "load_N", f64::NAN)]), "correlation: wear and load_N have NaN, and it must be between -1 and 1"),
        // The first may be 0.54 +- sqrt(0.19 x 0.64): 0.0113 is less to change than the 0.02 by which the last is below 0.81 - 0.19.
        (
            tied(&[("friction", "load_N", 0.9), ("load_N", "wear", 0.9), ("friction", "wear", 0.6)]),
            "correlation: friction and load_N have 0.9, and it must be between 0.191288 and 0.888712, given the others",
        ),
        // The last may be -0.4 +- sqrt(0.36 x 0.75), and is the nearest to what it may be.
        (
            tied(&[("friction", "load_N", -0.8), ("load_N", "wear", 0.5), ("friction", "wear", 0.9)]),
            "correlation: friction and wear have 0.9, and it must be between -0.919615 and 0.119615, given the others",
        ),
    ];
    for (made, message) in cases {
        assert_eq!(made.map(|_| ()).expect_err(message).to_string(), message);
    }
    assert!(tied(&[("friction", "load_N", 0.9), ("load_N", "wear", 0.9), ("friction", "wear", 0.63)]).is_ok());
}
