// Timing belt on one pulley: the twin of src/models/timing_belt. Equation numbers are the paper's.
//
// The number of teeth is whole and exact, so loops end at it and nothing has to be masked. Tables that `prepare` makes are in the
// private arrays `made_...`; the second stage reads them through functions of their names.

// Most teeth, and one more for the places before the first and after the last.
const PLACES: u32 = 61u;
// How far a margin must be from zero, in units of its bound, for the tooth to be surely pressed in or lifted.
const TOOTH_PROMISE: f32 = 4.0;

// A number that is linear in the two tensions.
struct Linear {
    tight: Real,
    slack: Real,
}

// Coefficients of the rows, divided by f cos phi.
struct Rows {
    teeth: u32,
    land_ratio: Real,
    lost: Real,
    stretch: Real,
    free_stretch: Real,
    tight: Real,
    slack: Real,
    lifted_in: Real,
    lifted_out: Real,
    lifted_apart: Real,
    flank: Real,
    lifted_flank: Real,
    inwards: Real,
    load_inwards: Real,
}

// Elimination from the tight side: T(i) = after[i] T(i+1) + tight[i] T_t, short = 1 - after.
var<private> after: array<Real, PLACES>;
var<private> tight: array<Real, PLACES>;
var<private> short: array<Real, PLACES>;
// Tensions of the complete mesh, T_t at 0.
var<private> tension: array<Linear, PLACES>;
// Elimination from the slack side, of T(i-1) and of T_s, at i - 1: T(i) = rho T(i-1) + sigma T_s with slack_short = 1 - rho; the last
// gap's tension; the sum of the tensions from T(i) on.
var<private> rho: array<Real, PLACES>;
var<private> sigma: array<Real, PLACES>;
var<private> slack_short: array<Real, PLACES>;
var<private> last_tension: array<Linear, PLACES>;
var<private> sum_behind: array<Linear, PLACES>;

fn scaled(a: Linear, by: Real) -> Linear {
    return Linear(mul(a.tight, by), mul(a.slack, by));
}

fn over(a: Linear, by: Real) -> Linear {
    return Linear(div(a.tight, by), div(a.slack, by));
}

fn plus(a: Linear, b: Linear) -> Linear {
    return Linear(add(a.tight, b.tight), add(a.slack, b.slack));
}

fn tight_itself() -> Linear {
    return Linear(constant(1.0), constant(0.0));
}

fn slack_itself() -> Linear {
    return Linear(constant(0.0), constant(1.0));
}

fn rows_of(i: Inputs) -> Rows {
    let lift = select_(i.lift_angle, i.lift_angle, i.space_half_angle);
    let around = max_(twice(mul(i.friction, i.land_half_angle)), near(1e-30));
    let lost = neg(exp_m1_(neg(around)));
    let land = twice(mul(i.land_half_angle, i.tip_radius));
    let meshed = cos_(i.space_half_angle);
    let rigidity = mul(mul(mul(i.cord_modulus, i.cord_area), i.tooth_compliance), meshed);
    let sine = sin_(i.pressure_angle);
    let cosine = cos_(i.pressure_angle);
    let rotated = add(i.pressure_angle, lift);
    var rows: Rows;
    rows.teeth = u32(i.teeth_in_mesh.value);
    rows.land_ratio = sub(constant(1.0), lost);
    rows.lost = lost;
    rows.stretch = div(add(mul(land, div(lost, around)), i.tooth_length), rigidity);
    rows.free_stretch = div(add(land, i.tooth_length), rigidity);
    rows.tight = div(cos_(i.tight_span_angle), meshed);
    rows.slack = div(cos_(i.slack_span_angle), meshed);
    rows.lifted_in = div(cos_(add(i.space_half_angle, lift)), meshed);
    rows.lifted_out = div(cos_(sub(i.space_half_angle, lift)), meshed);
    rows.lifted_apart = div(twice(mul(sin_(i.space_half_angle), sin_(lift))), meshed);
    rows.flank = div(cosine, meshed);
    rows.lifted_flank = div(add(cos_(rotated), mul(i.friction, sin_(rotated))), meshed);
    rows.inwards = sin_(add(i.space_half_angle, i.land_half_angle));
    rows.load_inwards = sub(mul(i.friction, cosine), sine);
    return rows;
}

// What tooth number `tooth` takes in of the tension before it, if it meshes.
fn taken_in(rows: Rows, tooth: u32) -> Real {
    if tooth == 1u {
        return rows.tight;
    }
    return rows.land_ratio;
}

fn eliminate(rows: Rows) {
    after[0] = constant(0.0);
    tight[0] = constant(1.0);
    short[0] = constant(1.0);
    for (var gap = 1u; gap < rows.teeth; gap++) {
        let beyond = add(rows.stretch, mul(rows.land_ratio, short[gap - 1u]));
        let pivot = add(constant(1.0), beyond);
        after[gap] = div(constant(1.0), pivot);
        short[gap] = div(beyond, pivot);
        tight[gap] = mul(mul(taken_in(rows, gap), tight[gap - 1u]), after[gap]);
        if gap == rows.teeth - 1u {
            // The last tooth of the complete mesh leaves into the slack span.
            tension[gap] = Linear(tight[gap], mul(rows.slack, after[gap]));
        }
    }
    tension[0] = tight_itself();
    tension[rows.teeth] = slack_itself();
    for (var gap = rows.teeth - 2u; gap > 0u; gap--) {
        let behind = tension[gap + 1u];
        tension[gap] = Linear(add(mul(after[gap], behind.tight), tight[gap]), mul(after[gap], behind.slack));
    }
}

// Load of a tooth of the complete mesh, (8), from what the tight side makes of H.
fn complete_load(rows: Rows, tooth: u32, by_tight: Real) -> Linear {
    var by_slack = tension[tooth].slack;
    if tooth == rows.teeth {
        by_slack = mul(rows.slack, by_slack);
    }
    if tooth > 1u {
        by_slack = mul(by_slack, add(mul(rows.lost, after[tooth - 1u]), short[tooth - 1u]));
    }
    return over(Linear(by_tight, neg(by_slack)), rows.flank);
}

fn prepare(i: Inputs) -> Prepared {
    let rows = rows_of(i);
    eliminate(rows);
    var load: Linear;
    var last: Linear;
    var behind: Real;
    for (var tooth = rows.teeth; tooth > 0u; tooth--) {
        if tooth == rows.teeth {
            behind = mul(rows.land_ratio, tension[tooth - 1u].tight);
        } else {
            behind = add(behind, mul(rows.stretch, tension[tooth].tight));
        }
        load = complete_load(rows, tooth, behind);
        if tooth == rows.teeth {
            last = load;
        }
        var entering = tension[tooth - 1u];
        if tooth > 1u {
            entering = scaled(entering, rows.land_ratio);
        }
        let pressed = scaled(plus(entering, tension[tooth]), rows.inwards);
        let inward = plus(pressed, scaled(load, rows.load_inwards));
        made_inward_tight[tooth - 1u] = inward.tight;
        made_inward_slack[tooth - 1u] = inward.slack;
    }
    if WANTS_boundary_tension || WANTS_peak_tooth_load || WANTS_least_tooth_load {
        make_boundaries(rows, load, last);
    }
    var p: Prepared;
    p.teeth = i.teeth_in_mesh;
    p.mass_radius = mul(i.pitch_mass, i.tip_radius);
    p.peak_complete_tight = load.tight;
    p.peak_complete_slack = load.slack;
    p.lift_margin = select_(i.lift_angle, sub(i.space_half_angle, i.lift_angle), constant(1.0));
    return p;
}

// T* and the loads beside every boundary; the last entries are those of the complete mesh.
fn make_boundaries(rows: Rows, first_complete: Linear, last_complete: Linear) {
    let gaps = rows.teeth - 1u;
    let nothing = Linear(constant(0.0), constant(0.0));
    rho[gaps] = constant(0.0);
    sigma[gaps] = constant(1.0);
    slack_short[gaps] = constant(1.0);
    last_tension[gaps] = tight_itself();
    sum_behind[gaps] = nothing;
    // In units of what a lifted tooth takes in; what it gives is hardly more.
    let free_stretch = div(rows.free_stretch, rows.lifted_in);
    let lifted_out = add(constant(1.0), div(rows.lifted_apart, rows.lifted_in));
    for (var gap = gaps; gap > 0u; gap--) {
        let short_of = add(free_stretch, mul(lifted_out, slack_short[gap]));
        let pivot = add(constant(1.0), short_of);
        var entering = constant(1.0);
        if gap == 1u {
            entering = div(rows.tight, rows.lifted_in);
        }
        let at = gap - 1u;
        rho[at] = div(entering, pivot);
        slack_short[at] = div(short_of, pivot);
        sigma[at] = div(mul(lifted_out, sigma[gap]), pivot);
        last_tension[at] = chained(last_tension[gap], at);
        sum_behind[at] = chained(Linear(add(constant(1.0), sum_behind[gap].tight), sum_behind[gap].slack), at);
    }
    var meshed_own = constant(0.0);
    var meshed_tight = constant(0.0);
    for (var j = 1u; j <= rows.teeth; j++) {
        let at = j - 1u;
        var star = tight_itself();
        if j > 1u {
            let meshed = add(rows.lost, mul(rows.land_ratio, short[j - 2u]));
            let sum = add(add(rows.free_stretch, meshed), mul(rows.lifted_out, slack_short[at]));
            let pivot = sub(sum, rows.lifted_apart);
            star = over(Linear(mul(taken_in(rows, j - 1u), tight[j - 2u]), mul(rows.lifted_out, sigma[at])), pivot);
        }
        let last_in = mul(rows.lifted_in, last_tension[at].tight);
        let force_last = of_star(star, last_in, mul(rows.lifted_in, sub(last_tension[at].slack, lifted_out)));
        let force_own =
            of_star(star, add(last_in, mul(rows.free_stretch, sum_behind[at].tight)), neg(mul(rows.lifted_out, sigma[at])));
        let own = over(force_own, rows.lifted_flank);
        var first = own;
        var before = own;
        if j > 1u {
            if j > 2u {
                let with_last = add(meshed_own, constant(1.0));
                meshed_tight = add(mul(with_last, tight[j - 2u]), meshed_tight);
                meshed_own = mul(with_last, after[j - 2u]);
            }
            let force_before = plus(force_own, scaled(star, rows.free_stretch));
            let meshed = plus(scaled(star, meshed_own), Linear(meshed_tight, constant(0.0)));
            before = over(force_before, rows.flank);
            first = over(plus(force_before, scaled(meshed, rows.stretch)), rows.flank);
        }
        make_boundary(at, star, first, own, before, over(force_last, rows.lifted_flank));
    }
    make_boundary(rows.teeth, nothing, first_complete, first_complete, last_complete, last_complete);
}

// What the next gap's T(i) = rho T(i-1) + sigma T_s makes of a number that is linear in T(i) and T_s.
fn chained(number: Linear, at: u32) -> Linear {
    return Linear(mul(number.tight, rho[at]), add(number.slack, mul(number.tight, sigma[at])));
}

fn of_star(star: Linear, own: Real, slack: Real) -> Linear {
    return Linear(mul(star.tight, own), add(mul(star.slack, own), slack));
}

fn make_boundary(at: u32, star: Linear, first: Linear, own: Linear, before: Linear, last: Linear) {
    made_star_tight[at] = star.tight;
    made_star_slack[at] = star.slack;
    made_first_tight[at] = first.tight;
    made_first_slack[at] = first.slack;
    made_own_tight[at] = own.tight;
    made_own_slack[at] = own.slack;
    made_before_tight[at] = before.tight;
    made_before_slack[at] = before.slack;
    made_last_tight[at] = last.tight;
    made_last_slack[at] = last.slack;
}

// What presses a tooth (from 0) inwards with the complete mesh.
fn inward_force(p: Prepared, i: Inputs, tooth: u32) -> Real {
    return add(mul(i.tight_tension, inward_tight(p, tooth)), mul(i.slack_tension, inward_slack(p, tooth)));
}

fn least_inward(p: Prepared, i: Inputs) -> Real {
    var least = inward_force(p, i, 0u);
    for (var tooth = 1u; tooth < u32(p.teeth.value); tooth++) {
        least = min_(least, inward_force(p, i, tooth));
    }
    return least;
}

fn conditions(p: Prepared, i: Inputs) -> array<Real, CONDITIONS> {
    var margins: array<Real, CONDITIONS>;
    for (var number = 0; number < i32(CONDITIONS); number++) {
        margins[number] = constant(1.0);
    }
    margins[0] = sub(i.tight_tension, i.slack_tension);
    margins[1] = p.lift_margin;
    if ASKS_CONDITION_2 {
        margins[2] = sub(mul(p.mass_radius, square(i.pulley_speed)), least_inward(p, i));
    }
    return margins;
}

fn finish(p: Prepared, i: Inputs) -> Outputs {
    let force = mul(p.mass_radius, square(i.pulley_speed)); // m r omega^2
    var out: Outputs;
    out.centrifugal_force = force;
    out.peak_tooth_load_complete = add(mul(i.tight_tension, p.peak_complete_tight), mul(i.slack_tension, p.peak_complete_slack));
    if WANTS_lift_speed {
        out.lift_speed = sqrt_(div(max_(least_inward(p, i), constant(0.0)), p.mass_radius));
    }
    let incomplete = WANTS_boundary_tension || WANTS_peak_tooth_load || WANTS_least_tooth_load;
    if !(incomplete || WANTS_boundary_tooth || WANTS_boundary_position || WANTS_incomplete_teeth) {
        return out;
    }
    // Teeth that mesh, going from the tight side, and whether that is sure of every one of them.
    var meshing = 0u;
    var sure = true;
    var before = constant(0.0);
    var at = constant(1.0);
    let teeth = u32(p.teeth.value);
    for (var tooth = 0u; tooth < teeth; tooth++) {
        let margin = sub(inward_force(p, i, tooth), force);
        sure = sure && abs(margin.value) > TOOTH_PROMISE * margin.bound;
        before = at;
        at = margin;
        if margin.value < 0.0 {
            break;
        }
        meshing += 1u;
    }
    // Where the walk may have ended elsewhere, tooth and position may be any; loads are left to f64.
    let loose = select(f32(teeth + 1u), 0.0, sure);
    out.boundary_tooth = Real(f32(meshing + 1u), loose);
    out.incomplete_teeth = Real(f32(teeth - meshing), loose);
    if WANTS_boundary_position {
        out.boundary_position = out.boundary_tooth;
        if meshing > 0u && meshing < teeth {
            let inside = add(constant(f32(meshing)), div(before, sub(before, at)));
            out.boundary_position = Real(inside.value, select(loose, inside.bound, sure));
        }
    }
    if incomplete {
        // With friction on the lands relieved by the centrifugal force no table serves.
        let known = sure && i.centrifugal_land_friction.value == 0.0;
        let tension = of_both(i, star_tight(p, meshing), star_slack(p, meshing));
        let first = of_both(i, first_tight(p, meshing), first_slack(p, meshing));
        let own = of_both(i, own_tight(p, meshing), own_slack(p, meshing));
        let previous = of_both(i, before_tight(p, meshing), before_slack(p, meshing));
        let last = of_both(i, last_tight(p, meshing), last_slack(p, meshing));
        out.boundary_tension = if_known(known, tension);
        out.peak_tooth_load = if_known(known, max_(first, own));
        out.least_tooth_load = if_known(known, min_(previous, last));
    }
    return out;
}

fn of_both(i: Inputs, by_tight: Real, by_slack: Real) -> Real {
    return add(mul(i.tight_tension, by_tight), mul(i.slack_tension, by_slack));
}

fn if_known(known: bool, number: Real) -> Real {
    return Real(number.value, select(infinity(), number.bound, known));
}
