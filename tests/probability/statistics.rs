use crate::golden::{number, rows};
use beltspace::models::Worse;
use beltspace::probability::{
    ConfidenceInterval, Distribution, Draws, Sampling, clopper_pearson, mean, pearson, quantile, replicated, sd, simultaneous, spearman,
    worst,
};

#[test]
fn intervals_are_those_of_scipy() {
    for row in rows("interval") {
        let [holds, draws, confidence, low, missed] = row[..] else { panic!("{row:?}") };
        let interval = clopper_pearson(holds.parse().unwrap(), draws.parse().unwrap(), number(confidence)).unwrap();
        // To a millionth of the smaller of the share and what is missing: the interval is a thousand times as wide at least.
        for (end, golden) in [(interval.low, number(low)), (interval.high, 1.0 - number(missed))] {
            assert!((end - golden).abs() <= 1e-8 * golden.min(1.0 - golden) + 1e-15, "{holds} of {draws} at {confidence}: {end} {golden}");
        }
    }
    for (draws, confidence) in [(10, 0.95), (4096, 0.99)] {
        let tail = (1.0f64 - confidence) / 2.0;
        let all = clopper_pearson(draws, draws, confidence).unwrap();
        assert!((all.low - tail.powf(1.0 / draws as f64)).abs() < 1e-14 && all.high == 1.0);
        let none = clopper_pearson(0, draws, confidence).unwrap();
        assert!((none.high - 1.0 + tail.powf(1.0 / draws as f64)).abs() < 1e-14 && none.low == 0.0);
    }
}

/// How likely `k` of `n` are at a probability `p`, as long as neither is large.
fn binomial(n: u64, k: u64, p: f64) -> f64 {
    (1..=k).map(|i| (n - k + i) as f64 / i as f64).product::<f64>() * p.powi(k as i32) * (1.0 - p).powi((n - k) as i32)
}

#[test]
fn an_interval_holds_the_truth_as_often_as_it_says() {
    // Exactly, by adding up what is likely: this owes nothing to how the interval is computed.
    let covered = |n: u64, p: f64, confidence: f64| -> f64 {
        let holds = |k: u64| clopper_pearson(k, n, confidence).unwrap();
        (0..=n).filter(|&k| holds(k).low <= p && p <= holds(k).high).map(|k| binomial(n, k, p)).sum()
    };
    for n in [1, 5, 30, 60] {
        for confidence in [0.9, 0.95, 0.99] {
            let least = (1..200).map(|i| covered(n, f64::from(i) / 200.0, confidence)).fold(1.0, f64::min);
            assert!(least >= confidence, "{n}: {least}");
        }
    }
    // An interval a tenth narrower would be seen.
    let narrow = |k: u64| {
        let ConfidenceInterval { low, high } = clopper_pearson(k, 30, 0.95).unwrap();
        (low + 0.05 * (high - low), high - 0.05 * (high - low))
    };
    let covered = |p: f64| (0..=30).filter(|&k| narrow(k).0 <= p && p <= narrow(k).1).map(|k| binomial(30, k, p)).sum::<f64>();
    assert!((1..200).map(|i| covered(f64::from(i) / 200.0)).fold(1.0, f64::min) < 0.95);
}

/// Of `designs` designs with the same known yield the one that does best in the draws that choose is reported. How often, of 1000 times,
/// does the interval hold its yield: by fresh draws, and by the draws that have chosen it; and how often do all intervals hold together?
fn chosen_as_best(designs: u64) -> (u32, u32, u32) {
    const DRAWS: u64 = 400;
    let standard = Distribution::uniform(0.0, 1.0).unwrap();
    let names: Vec<_> = (0..designs).map(|i| format!("margin{i}")).collect();
    let inputs: Vec<_> = names.iter().map(|name| (name.as_str(), standard.clone())).collect();
    let truth = |design: usize| 0.95 + 0.0005 * design as f64;
    let holds = |columns: &[Vec<f64>]| -> Vec<u64> {
        columns.iter().enumerate().map(|(design, column)| column.iter().filter(|u| **u < truth(design)).count() as u64).collect()
    };
    let (mut fresh_ones, mut choosing_ones, mut together) = (0, 0, 0);
    for seed in 0..1000 {
        let draws = Draws::new(&inputs, DRAWS, Sampling::Random, seed).unwrap();
        let seen = holds(&draws.columns(0..DRAWS));
        let best = (0..seen.len()).max_by_key(|&design| seen[design]).unwrap();
        let confirmed = holds(&draws.confirming(DRAWS).unwrap().columns(0..DRAWS));
        let inside = |holds: u64, design: usize, confidence: f64, number: u64| {
            let interval = simultaneous(holds, DRAWS, confidence, number).unwrap();
            (interval.low..=interval.high).contains(&truth(design))
        };
        fresh_ones += u32::from(inside(confirmed[best], best, 0.95, 1));
        choosing_ones += u32::from(inside(seen[best], best, 0.95, 1));
        together += u32::from((0..confirmed.len()).all(|design| inside(confirmed[design], design, 0.99, designs)));
    }
    (fresh_ones, choosing_ones, together)
}

#[test]
fn fresh_draws_judge_the_chosen_design_honestly_and_those_that_chose_it_do_not() {
    let (fresh, choosing, together) = chosen_as_best(40);
    println!("of 1000: fresh draws {fresh}, the draws that chose {choosing}, all 40 together {together}");
    assert!(fresh >= 935, "{fresh}");
    assert!(choosing < 935, "without confirmation it would be {choosing}");
    assert!(together >= 980, "{together}");
}

#[test]
fn a_quantile_is_the_value_that_a_share_of_the_draws_reaches_or_betters() {
    let values: Vec<_> = (0..100).map(|i| f64::from(i * 37 % 100)).collect();
    for percent in 1..=100 {
        let q = f64::from(percent) / 100.0;
        let high = quantile(&values, q, Worse::Higher).unwrap().unwrap();
        assert_eq!(high, f64::from(percent - 1), "the {percent}th from below");
        let low = quantile(&values, q, Worse::Lower).unwrap().unwrap();
        assert_eq!(low, f64::from(100 - percent), "the {percent}th from above");
        assert!(values.iter().filter(|it| **it >= low).count() == percent as usize);
    }
    assert_eq!(quantile(&values, 0.001, Worse::Higher), Ok(Some(0.0)));
    assert_eq!(quantile(&values, 0.071, Worse::Higher), Ok(Some(7.0)), "between two ranks the worse");
    let gaps = [3.0, f64::NAN, 1.0, 2.0];
    assert_eq!([0.75, 0.76].map(|q| quantile(&gaps, q, Worse::Higher).unwrap()), [Some(3.0), None]);
    assert_eq!([0.75, 0.76].map(|q| quantile(&gaps, q, Worse::Lower).unwrap()), [Some(1.0), None]);
    let wrong = |q| quantile(&gaps, q, Worse::Lower).unwrap_err().to_string();
    assert_eq!(wrong(0.0), "quantile: share of the draws is 0, and must be above 0 and at most 1");
    assert_eq!(wrong(1.1), "quantile: share of the draws is 1.1, and must be above 0 and at most 1");
    assert_eq!(quantile(&[], 0.5, Worse::Lower).unwrap_err().to_string(), "quantile: there are no values; give at least one");
}

#[test]
fn mean_sd_and_worst_need_a_value_in_every_draw() {
    let values = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0];
    assert_eq!((mean(&values), sd(&values)), (Some(5.0), Some(2.0)));
    assert_eq!((worst(&values, Worse::Higher), worst(&values, Worse::Lower)), (Some(9.0), Some(2.0)));
    let gaps = [2.0, f64::NAN];
    assert_eq!((mean(&gaps), sd(&gaps), worst(&gaps, Worse::Higher), worst(&gaps, Worse::Lower)), (None, None, None, None));
    assert_eq!((mean(&[]), sd(&[]), worst(&[], Worse::Lower)), (None, None, None));
    assert_eq!((mean(&[0.1; 1]), sd(&[0.1; 1])), (Some(0.1), Some(0.0)));
    // The order of the sum is that of the draws.
    assert_eq!(mean(&[1e16, 1.0, -1e16, 1.0]), Some(0.25));
}

#[test]
fn replicates_tell_their_standard_error_unless_they_agree() {
    let estimates: Vec<_> = (0..16).map(f64::from).collect();
    let told = replicated(&estimates).unwrap();
    // The variance of 0 to 15, dividing by 15, is 68/3.
    assert!(told.mean == 7.5 && (told.standard_error.unwrap() - (68.0f64 / 3.0 / 16.0).sqrt()).abs() < 1e-15);
    let same = replicated(&[0.1; 20]).unwrap();
    assert_eq!((same.mean, same.standard_error), (0.1, None));
    let few = replicated(&estimates[..15]).unwrap_err().to_string();
    assert_eq!(few, "standard error: replicates is 15, and must be at least 16");
}

#[test]
fn correlations_of_columns_follow_their_definitions() {
    let (x, y) = ([1.0, 2.0, 3.0, 4.0, 5.0], [1.0, 8.0, 27.0, 64.0, 125.0]);
    // Deviations -2..2 and those of the cubes from their mean of 45: 304 / sqrt(10 x 10410).
    let deviations = [-44.0f64, -37.0, -18.0, 19.0, 80.0];
    let squares: f64 = deviations.iter().map(|it| it * it).sum();
    assert!((pearson(&x, &y).unwrap() - 304.0 / (10.0 * squares).sqrt()).abs() < 1e-15);
    assert!((spearman(&x, &y).unwrap() - 1.0).abs() < 1e-15);
    // Ranks 0, 1.5, 1.5, 3 against 3, 1, 2, 0: the products of their deviations add up to -4.5, the squares to 4.5 and 5.
    let ties = spearman(&[1.0, 2.0, 2.0, 9.0], &[40.0, 20.0, 30.0, 10.0]).unwrap();
    assert!((ties + 4.5 / (4.5f64 * 5.0).sqrt()).abs() < 1e-15, "{ties}");
    assert_eq!((pearson(&x, &[2.0; 5]), spearman(&x, &[1.0, 2.0, f64::NAN, 4.0, 5.0])), (None, None));
}

#[test]
fn wrong_statements_are_refused() {
    let said = |made: Result<ConfidenceInterval, beltspace::probability::ProbabilityProblem>| made.unwrap_err().to_string();
    assert_eq!(said(clopper_pearson(0, 0, 0.95)), "confidence: draws is 0, and must be between 1 and 1e9");
    assert_eq!(said(clopper_pearson(5, 4, 0.95)), "confidence: holds is 5, and must be at most the number of draws");
    assert_eq!(said(clopper_pearson(4, 4, 1.0)), "confidence: confidence is 1, and must be above 0 and below 1");
    assert_eq!(said(clopper_pearson(4, 4, f64::NAN)), "confidence: confidence is NaN, and must be above 0 and below 1");
    assert_eq!(said(simultaneous(4, 4, 0.99, 0)), "confidence: number is 0, and must be at least 1");
}
