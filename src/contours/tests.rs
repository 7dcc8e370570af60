use super::*;

/// A plane of evenly spaced levels from `low` to `high` along both axes, all of them nodes.
struct Square {
    low: f64,
    high: f64,
    count: u64,
}

impl Square {
    fn level(&self) -> impl Fn(u64) -> f64 + Sync + use<> {
        let (low, high, count) = (self.low, self.high, self.count);
        move |level| low + (high - low) * level as f64 / (count - 1).max(1) as f64
    }

    /// The lines of a predicate, the same for any number of threads.
    fn lines(&self, ask: impl Fn(f64, f64) -> Option<bool> + Sync) -> Vec<Vec<Vertex>> {
        let level = self.level();
        let side = || GridAxis::new(self.count, 256, &level, true);
        lines(&side(), &side(), ask)
    }
}

fn lines(x: &GridAxis<'_>, y: &GridAxis<'_>, ask: impl Fn(f64, f64) -> Option<bool> + Sync) -> Vec<Vec<Vertex>> {
    let answers: Vec<_> = (0..x.nodes() * y.nodes()).map(|node| ask(x.at(node % x.nodes()), y.at(node / x.nodes()))).collect();
    let found = trace(x, y, &answers, &ask, 1);
    assert_eq!(found, trace(x, y, &answers, &ask, 5), "the lines depend on the threads");
    assert_eq!(badly_bracketed(found.iter().flatten(), ask), None);
    found
}

/// The first vertex whose bracket has the same answer at both ends, or none at one.
fn badly_bracketed<'v>(vertices: impl IntoIterator<Item = &'v Vertex>, ask: impl Fn(f64, f64) -> Option<bool>) -> Option<Vertex> {
    let bad = |vertex: &&Vertex| {
        let half = 0.5 * vertex.bracket;
        let answers = match vertex.along {
            Along::X => [ask(vertex.x - half, vertex.y), ask(vertex.x + half, vertex.y)],
            Along::Y => [ask(vertex.x, vertex.y - half), ask(vertex.x, vertex.y + half)],
        };
        answers.contains(&None) || answers[0] == answers[1]
    };
    vertices.into_iter().find(bad).copied()
}

/// Twice the area that a closed line goes around, positive if against the clock.
fn turned(line: &[Vertex]) -> f64 {
    line.windows(2).map(|pair| pair[0].x * pair[1].y - pair[1].x * pair[0].y).sum()
}

const UNIT_SQUARE: Square = Square { low: -2.0, high: 2.0, count: 21 };

#[test]
fn a_circle_is_one_closed_line_around_what_is_true() {
    let inside = |x: f64, y: f64| Some(x * x + y * y <= 1.5);
    let found = UNIT_SQUARE.lines(inside);
    assert_eq!(found.len(), 1);
    let line = &found[0];
    assert!(line.len() > 20 && line.first() == line.last());
    for vertex in line {
        assert!((vertex.x * vertex.x + vertex.y * vertex.y - 1.5).abs() < 1e-7, "{vertex:?}");
        assert!(vertex.bracket > 0.0 && vertex.bracket <= 4e-9, "{vertex:?}");
    }
    let area = 0.5 * turned(line);
    assert!((area - 1.5 * std::f64::consts::PI).abs() < 0.05, "{area}: the true side is on the left");
    let outside = UNIT_SQUARE.lines(|x, y| inside(x, y).map(|it| !it));
    assert!((0.5 * turned(&outside[0]) + area).abs() < 1e-7, "and so the other way round");
    let mut shifted = found.clone();
    shifted[0][7].x += 1e-6;
    shifted[0][7].y += 1e-6;
    assert_eq!(badly_bracketed(shifted.iter().flatten(), inside), Some(shifted[0][7]), "the check must object to a shifted vertex");
}

#[test]
fn two_circles_are_two_lines_and_a_tiny_one_is_overlooked() {
    let near = |x: f64, y: f64, (u, v): (f64, f64), r: f64| (x - u) * (x - u) + (y - v) * (y - v) < r * r;
    let ask = |x: f64, y: f64| Some(near(x, y, (-1.0, -1.0), 0.5) || near(x, y, (1.1, 0.9), 0.7) || near(x, y, (-0.9, 1.1), 0.1));
    let found = UNIT_SQUARE.lines(ask);
    assert_eq!(found.len(), 2, "what lies between the nodes is not seen");
    assert!(found[0].iter().all(|vertex| vertex.y < 0.0) && found[1].iter().all(|vertex| vertex.y > 0.0), "from the first row on");
}

#[test]
fn a_straight_line_goes_from_edge_to_edge_with_the_true_side_on_its_left() {
    let found = UNIT_SQUARE.lines(|x, y| Some(x + 0.5 * y >= 0.3));
    assert_eq!(found.len(), 1);
    let (first, last) = (found[0][0], found[0][found[0].len() - 1]);
    assert_eq!((first.y, last.y), (2.0, -2.0), "downwards, for the true side is the right one of the picture");
    assert!((first.x + 0.7).abs() < 1e-8 && (last.x - 1.3).abs() < 1e-8);
    for pair in found[0].windows(2) {
        assert!(pair[1].y <= pair[0].y && pair[1].x >= pair[0].x, "{pair:?}");
    }
    // Through nodes: a node is true or false like any other place.
    let through = UNIT_SQUARE.lines(|x, _| Some(x >= 0.0));
    assert_eq!((through.len(), through[0].len()), (1, 21));
    assert!(through[0].iter().all(|vertex| vertex.x.abs() < 4e-9 && vertex.along == Along::X));
}

#[test]
fn a_saddle_follows_the_middle_of_its_cell() {
    let square = Square { low: -1.0, high: 1.0, count: 2 };
    // True where x y >= level: the corners (1, 1) and (-1, -1), joined below 0 and apart above.
    let saddle = |level: f64| square.lines(move |x, y| Some(x * y >= level));
    let near = |line: &[Vertex], corner: f64| line.iter().all(|vertex| (vertex.x + vertex.y) * corner > 0.0);
    let apart = saddle(0.25);
    assert_eq!(apart.len(), 2);
    assert!(apart.iter().any(|line| near(line, 1.0)) && apart.iter().any(|line| near(line, -1.0)), "{apart:?}");
    let joined = saddle(-0.25);
    assert_eq!(joined.len(), 2);
    assert!(joined.iter().all(|line| line.len() == 2 && !near(line, 1.0) && !near(line, -1.0)), "{joined:?}");
    // Without an answer in the middle the pieces still come in pairs.
    let unknown = square.lines(|x, y| (x.abs() + y.abs() > 0.5).then_some(x * y >= 0.25));
    assert_eq!(unknown.iter().map(Vec::len).collect::<Vec<_>>(), [2, 2]);
}

#[test]
fn lines_end_where_there_is_no_answer() {
    // A ring of answers around a hole, crossed by one line.
    let ring = |x: f64, y: f64| (x * x + y * y > 0.8).then_some(y + 0.05 >= 0.1 * x);
    let found = UNIT_SQUARE.lines(ring);
    assert_eq!(found.len(), 2);
    let ends = |line: &[Vertex]| (line[0].x, line[line.len() - 1].x);
    assert!(found.iter().flatten().all(|vertex| vertex.x * vertex.x + vertex.y * vertex.y > 0.8));
    let mut ends = found.iter().map(|line| ends(line)).collect::<Vec<_>>();
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(ends[0].0 == -2.0 && (-1.1..-0.7).contains(&ends[0].1), "{ends:?}");
    assert!((0.7..1.1).contains(&ends[1].0) && ends[1].1 == 2.0, "{ends:?}");
    // A change across a gap is no place of a contour.
    assert_eq!(UNIT_SQUARE.lines(|x, _| (!(0.01..0.19).contains(&x)).then_some(x > 0.1)), Vec::<Vec<Vertex>>::new());
    assert_eq!(UNIT_SQUARE.lines(|_, _| None), Vec::<Vec<Vertex>>::new());
    assert_eq!(UNIT_SQUARE.lines(|_, _| Some(true)), Vec::<Vec<Vertex>>::new());
}

#[test]
fn on_an_axis_of_one_level_a_line_is_one_vertex() {
    let level = UNIT_SQUARE.level();
    let (wide, one) = (GridAxis::new(21, 256, &level, true), GridAxis::new(1, 256, &|_| 3.0, true));
    let found = lines(&wide, &one, |x, y| Some(x * x >= y - 2.5));
    assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [1, 1]);
    assert!((found[1][0].x - 0.5_f64.sqrt()).abs() < 4e-9 && found[1][0].y == 3.0 && found[1][0].along == Along::X);
    let found = lines(&one, &wide, |_, y| Some(y > 0.3));
    assert!(found.len() == 1 && found[0].len() == 1 && found[0][0].along == Along::Y, "{found:?}");
    assert_eq!(lines(&one, &one, |x, _| Some(x > 3.0)), Vec::<Vec<Vertex>>::new());
}

#[test]
fn whole_numbers_are_not_divided() {
    let count = |level: u64| 10.0 + 2.0 * level as f64;
    // All levels are nodes, then every fifth one or so: the bracket is the distance of two levels all the same.
    for most in [256, 24] {
        let whole = GridAxis::new(101, most, &count, false);
        let asked = std::sync::Mutex::new(Vec::new());
        let found = lines(&whole, &GridAxis::new(1, 2, &|_| 0.0, true), |x, _| {
            asked.lock().expect("nobody panics").push(x);
            Some(x >= 87.5)
        });
        let vertex = Vertex { x: 87.0, y: 0.0, bracket: 2.0, along: Along::X };
        assert_eq!(found, [[vertex]]);
        assert!(asked.into_inner().expect("nobody panics").iter().all(|x| x % 2.0 == 0.0), "only levels are asked for");
    }
}

#[test]
fn brackets_stay_brackets_at_the_limit_of_f64() {
    // An axis so narrow that its billionth part is less than the distance of two numbers; falling levels too.
    let narrow = |level: u64| 1e6 + 1e-7 * level as f64;
    for edge in [1e6 + 3e-8, 1e6 + 1.6e-7, 1e6 + 2.9999e-7] {
        let falling = |level: u64| narrow(3 - level);
        for level in [&narrow as &(dyn Fn(u64) -> f64 + Sync), &falling] {
            let found = lines(&GridAxis::new(4, 256, level, true), &GridAxis::new(1, 2, &|_| 0.0, true), |x, _| Some(x >= edge));
            assert_eq!(found.len(), 1, "{edge}");
            assert!(found[0][0].bracket <= 4e-10 && (found[0][0].x - edge).abs() <= 3e-10, "{:?}", found[0][0]);
        }
    }
    // Many places, so that middles round both ways.
    for place in 0..2000 {
        let edge = 0.1 + 0.0007 * f64::from(place);
        let found = lines(&GridAxis::new(3, 256, &|level| level as f64, true), &GridAxis::new(1, 2, &|_| 0.0, true), |x, _| Some(x > edge));
        assert_eq!(found.len(), 1, "{edge}");
    }
}

#[test]
fn nodes_are_levels_evenly_chosen_with_both_ends() {
    let level = |level: u64| level as f64;
    for (count, most, expected) in [(5, 256, 5), (256, 256, 256), (257, 256, 256), (1000, 24, 24), (1 << 40, 256, 256)] {
        let side = GridAxis::new(count, most, &level, true);
        assert_eq!(side.nodes(), expected);
        assert_eq!((side.at(0), side.at(expected - 1)), (0.0, (count - 1) as f64));
        let steps: Vec<f64> = (1..expected).map(|node| side.at(node) - side.at(node - 1)).collect();
        let (least, largest) = steps.iter().fold((f64::MAX, 0.0_f64), |(low, high), &step| (low.min(step), high.max(step)));
        assert!(least >= 1.0 && largest - least <= 1.0, "{count}, {most}: {least} to {largest}");
    }
}

#[test]
fn many_scenarios_make_the_grid_coarser_but_not_too_coarse() {
    assert_eq!(most_nodes([1000, 1000], 1), 256);
    assert_eq!(most_nodes([1000, 1000], 61), 256);
    assert_eq!(most_nodes([1000, 1000], 400), 100);
    assert_eq!(most_nodes([1000, 10], 400), 256, "only what there is counts");
    assert_eq!(most_nodes([1000, 1000], 1 << 32), 24);
    assert_eq!(most_nodes([2, 2], 1 << 63), 24);
}

#[test]
fn a_whole_number_has_a_threshold_wherever_it_rises() {
    let spec = |at| ContourSpec { of: Quantity::Output(0), at };
    let changes = |values: &[f64]| thresholds(&spec(Thresholds::Changes), values.iter().copied());
    assert_eq!(changes(&[3.0, 5.0, 3.0, 7.0]), [4.0, 5.0, 6.0, 7.0]);
    assert_eq!(changes(&[-1.0, 1.0]), [0.0, 1.0]);
    assert_eq!((changes(&[4.0, 4.0]), changes(&[])), (vec![], vec![]));
    assert_eq!(thresholds(&spec(Thresholds::At(vec![2.0, 0.5])), [1.0].into_iter()), [2.0, 0.5]);
    // Steps of a staircase: one line per threshold, each where its number begins.
    let steps = |x: f64, y: f64| (x + 2.0 + 0.1 * y).floor();
    for at in thresholds(&spec(Thresholds::Changes), [0.0, 3.0].into_iter()) {
        let found = UNIT_SQUARE.lines(|x, y| Some(steps(x, y) >= at));
        assert_eq!(found.len(), 1);
        assert!(found[0].iter().all(|vertex| (vertex.x + 2.0 + 0.1 * vertex.y - at).abs() < 1e-8));
    }
}

#[test]
fn the_lines_of_what_a_map_shows_are_about_the_end_that_it_shows() {
    let study = |maps: &str, objectives: &str| {
        let text = format!(
            "model = \"metal-cvt\"\n[design]\ntraction = [0.2, 0.3]\nbelt_length_mm = [613, 620]\n\
             [objectives]\n{objectives}\n[report]\nmaps = [{{ x = \"traction\", y = \"belt_length_mm\", {maps} }}]\n"
        );
        Study::parse_in(&text, "study.toml", ".".as_ref()).unwrap_or_else(|errors| panic!("{errors}"))
    };
    let ends = |maps: &str, objectives: &str| {
        let study = study(&format!("{maps}, contours = [0, {{ of = \"stress_margin\", at = [0] }}]"), objectives);
        let map = &study.report.maps[0];
        [0, 1].map(|number| end(&study, map, map.contours[number].of))
    };
    // In the model both margins are worse when low; a map of the least slip margin shows its largest value over the scenarios.
    let slip = |best: &str| format!("value = \"slip_margin\", best = \"{best}\"");
    assert_eq!(ends(&slip("max"), ""), [Worse::Lower, Worse::Lower]);
    assert_eq!(ends(&slip("min"), ""), [Worse::Higher, Worse::Lower]);
    assert_eq!(ends(&slip("min"), "stress_margin = \"min\""), [Worse::Higher, Worse::Higher], "an objective says what is worse");
}
