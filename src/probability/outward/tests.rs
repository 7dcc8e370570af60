//! Intervals of distribution functions and quantiles against numbers of many digits, made with mpmath 1.3.0 at 40 to 60 digits.

use super::*;

fn contains(it: Interval, value: f64) -> bool {
    // The number of many digits is itself rounded to f64.
    it.low <= value.next_up() && value.next_down() <= it.high
}

#[test]
fn the_normal_distribution_function_keeps_its_error_bound() {
    // z and erfc(-z/sqrt(2))/2: as f64, and what is left beyond it.
    for (z, share, rest) in [
        (-30.5, 1.3029379131780763e-204, 6.449919906556064e-221),
        (-20.25, 1.77619986494957e-91, 7.449831991979182e-108),
        (-12.3, 4.5287069561587846e-35, 4.532617817589753e-52),
        (-8.0, 6.220960574271784e-16, 2.491586890683703e-32),
        (-6.5, 4.016000583859118e-11, 1.6791104218420475e-28),
        (-5.0, 2.866515718791939e-07, -1.8004269120872359e-25),
        (-4.2, 1.3345749015906327e-05, 5.081849075902108e-22),
        (-3.09, 0.0010007824766140108, 5.904979532059536e-20),
        (-2.0, 0.02275013194817921, -1.3849763108389696e-18),
        (-1.0, 0.15865525393145705, 4.9468552901786335e-18),
        (-0.5, 0.3085375387259869, 1.4568778275699303e-17),
        (-0.1, 0.460172162722971, 4.236746516162269e-18),
        (-1e-8, 0.4999999960105772, -1.189765651643976e-17),
        (0.0, 0.5, 0.0),
        (0.001, 0.500398942213911, 4.933809375390089e-17),
        (0.7, 0.758036347776927, 4.937435700328491e-18),
        (1.3, 0.9031995154143897, -2.3095758429171963e-17),
        (2.5, 0.9937903346742238, 2.39834723349092e-17),
        (4.0, 0.9999683287581669, 5.72832992261269e-20),
        (6.0, 0.9999999990134123, 5.538678126725596e-17),
        (8.2, 0.9999999999999999, -9.171212964842928e-18),
    ] {
        let off = ((normal_below(z) - share) - rest).abs() / share;
        assert!(off <= normal_error(z), "at {z} it is off by {off}, more than {}", normal_error(z));
        let it = normal_share(z);
        assert!(it.low < share && share < it.high.next_up() && it.width() <= 4.0 * normal_error(z) * share, "{it:?} at {z}");
    }
}

#[test]
fn normal_scores_lie_between_their_ends() {
    // A probability and the number with it above: as f64, and what is left beyond it.
    for (share, score, rest) in [
        (1e-100, 21.273453560965326, -1.398498135078709e-15),
        (1e-20, 9.262340089798407, 6.293776186647849e-16),
        (1e-09, 5.9978070150076865, 3.2400121268622395e-16),
        (1e-06, 4.753424308822899, 2.766790453623031e-16),
        (0.0001, 3.7190164854556804, 1.314745682432117e-16),
        (0.001, 3.0902323061678136, -1.0086380376146429e-16),
        (0.01, 2.326347874040841, -1.0847324997032725e-16),
        (0.1, 1.2815515655446004, 6.689417488119474e-17),
        (0.25, 0.6744897501960817, 3.7755511355050287e-17),
        (0.4, 0.2533471031357997, 1.858512582478071e-17),
        (0.49, 0.025068908258711057, 1.1248834687598588e-18),
        (0.5, 0.0, 0.0),
    ] {
        let upper = normal_score(Tail { share, is_upper: true });
        // Beyond f64 the rest decides.
        assert!(upper.low - score <= rest && upper.high - score >= rest, "{upper:?} at {share}");
        assert!(upper.width() <= 1e-13 * (1.0 + score), "{upper:?} at {share}");
        assert_eq!(normal_score(Tail { share, is_upper: false }), -upper);
    }
    assert_eq!(normal_score(Tail { share: 0.0, is_upper: true }), EVERYTHING);
}

#[test]
fn the_incomplete_beta_function_keeps_its_error_bound() {
    // Parameters, x, and betainc(a, b, 0, x, regularized=True), for the large ones the integral of the density.
    for (a, b, x, share) in [
        (0.5, 0.5, 0.01, 0.06376856085851985),
        (0.01, 2.0, 1e-05, 0.9001633583899892),
        (2.0, 3.0, 0.2, 0.18080000000000002),
        (0.8, 2.5, 0.3, 0.6700806296206157),
        (5.0, 1.5, 0.6, 0.1483511919517529),
        (30.0, 70.0, 0.2, 0.009692085749007045),
        (30.0, 70.0, 0.3, 0.5116251045586091),
        (1000.0, 10.0, 0.98, 0.004207729512718629),
        (500.0, 700.0, 0.4, 0.12051628908943207),
        (0.3, 100.0, 0.001, 0.5454579393499722),
        (12.5, 0.7, 0.9, 0.16786224883279172),
        (1e4, 2e4, 0.33, 0.11020551912741972),
        (1e6, 1e6, 0.4995, 0.07864957758090163),
        (2000.0, 3.0, 0.996, 0.013540358149946577),
    ] {
        let beta = Beta::new(a, b);
        let off = (beta.below(x) - share).abs() / share;
        assert!(off <= 0.25 * beta_error(&beta), "beta({a}, {b}) at {x} is off by {off}, more than a quarter of {}", beta_error(&beta));
    }
}

fn laws() -> [Distribution; 8] {
    [
        Distribution::uniform(0.25, 4.0),
        Distribution::normal(1.5, 0.25),
        Distribution::lognormal(2.0, 0.5),
        Distribution::triangular(0.0, 0.25, 1.0),
        Distribution::beta(2.0, 5.0, 0.0, 1.0),
        Distribution::weibull(1.5, 2.0, 0.5),
        Distribution::gumbel(3.0, 0.5),
        Distribution::normal(1.0, 0.5).and_then(|it| it.truncated(0.5, 2.0)),
    ]
    .map(|law| law.expect("its parameters are right"))
}

/// A probability and the quantiles of all laws, from their inverse functions, or for the beta distribution by bisection.
const QUANTILES: [[f64; 9]; 5] = [
    [
        9.313225746154785e-10,
        0.25000000349245965,
        -0.002338391382685973,
        0.4418467245853463,
        1.52587890625e-05,
        7.879687575316648e-06,
        0.5000019073486334,
        1.4826577694597545,
        0.5000000015753469,
    ],
    [
        0.0009765625,
        0.253662109375,
        0.7256827304503038,
        0.905039382324827,
        0.015625,
        0.008157101287786607,
        0.5196926783475001,
        2.0319639137938093,
        0.5016491512173505,
    ],
    [
        0.375,
        1.65625,
        1.4203401590089062,
        1.7938771261136575,
        0.31534680311854235,
        0.21236313160670137,
        1.709012534076288,
        3.009678444290241,
        0.956867945184091,
    ],
    [
        0.9375,
        3.765625,
        1.8835301360881367,
        2.8308218299924226,
        0.7834936490538903,
        0.5602673252902708,
        4.447180293491914,
        4.370246503255178,
        1.7236291551953358,
    ],
    [
        0.9999990463256836,
        3.9999964237213135,
        2.6907502585669536,
        6.268795363738619,
        0.9991542720666168,
        0.9559957351304859,
        12.041625194094623,
        9.931471567180779,
        1.9999927704445604,
    ],
];

#[test]
fn quantiles_of_every_law_lie_between_their_ends() {
    for [share, quantiles @ ..] in QUANTILES {
        let tail = if share <= 0.5 { Tail { share, is_upper: false } } else { Tail { share: 1.0 - share, is_upper: true } };
        for (law, value) in laws().iter().zip(quantiles) {
            let outward = Outward::new(law);
            let it = Interval { low: outward.end(tail, true), high: outward.end(tail, false), error: 0.0 };
            assert!(contains(it, value) && it.width() <= 1e-10 * value.abs(), "{it:?} and {value} of {law:?} at {share}");
            let (below, above) = outward.tails(value);
            assert!(below.low <= share * (1.0 + 1e-9) && share * (1.0 - 1e-9) <= below.high, "{below:?} and {share} of {law:?}");
            assert!((below + above).contains(1.0), "{below:?} {above:?}");
        }
    }
}

#[test]
fn densities_are_how_much_the_distribution_function_changes() {
    for law in laws() {
        let outward = Outward::new(&law);
        for share in [0.02, 0.3, 0.5, 0.8, 0.97] {
            let x = law.quantile(share).expect("a probability");
            let step = 1e-5 * law.sd();
            let (before, after) = (outward.tails(x - step).0, outward.tails(x + step).0);
            let change = (0.5 * (after.low + after.high) - 0.5 * (before.low + before.high)) / (2.0 * step);
            let density = outward.density(Interval::point(x));
            assert!(
                (density.low - change).abs() <= 1e-4 * change && density.width() <= 1e-9 * change,
                "{density:?} and {change} of {law:?}"
            );
            let wide = outward.density(Interval::new(x - 10.0 * step, x + 20.0 * step));
            assert!(wide.low <= density.low && wide.high >= density.high, "{wide:?} and {density:?}");
        }
    }
}

#[test]
fn values_of_a_discrete_distribution_change_at_their_steps() {
    let outward = Outward::new(&Distribution::discrete(&[3.0, 1.0, 2.0], &[1.0, 2.0, 1.0]).expect("weights"));
    let ends = |share: f64| {
        let tail = if share <= 0.5 { Tail { share, is_upper: false } } else { Tail { share: 1.0 - share, is_upper: true } };
        (outward.end(tail, true), outward.end(tail, false))
    };
    assert_eq!((ends(0.0), ends(0.3), ends(0.6), ends(0.9), ends(1.0)), ((1.0, 1.0), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0), (3.0, 3.0)));
    // At a step rounding may put the probability on either side.
    assert_eq!(ends(0.5), (1.0, 2.0));
}
