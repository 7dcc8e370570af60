// Timing belt on one pulley, written by hand after src/models/timing_belt: as a list its loops would be thousands of operations.
// Equation numbers are the paper's.
//
// The number of teeth is whole and exact, so loops end at it and nothing has to be masked. The tables go where they belong number by
// number, through functions `set_...`, and few are kept on the way: long private arrays are slow, to run and to compile.

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
// T(1) + .. + T(i-1) = meshed_own[i] T(i) + meshed_tight[i] T_t.
var<private> meshed_own: array<Real, PLACES>;
var<private> meshed_tight: array<Real, PLACES>;

// Elimination from the slack side, of T(i-1) and of T_s: T(i) = rho T(i-1) + sigma T_s with short = 1 - rho; the last gap's tension;
// the sum of the tensions from T(i) on.
struct Behind {
    rho: Real,
    sigma: Real,
    short: Real,
    last: Linear,
    sum: Linear,
}

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
    var own = constant(0.0);
    var of_tight = constant(0.0);
    for (var gap = 1u; gap < rows.teeth; gap++) {
        if gap > 1u {
            let with_last = add(own, constant(1.0));
            of_tight = add(mul(with_last, tight[gap - 1u]), of_tight);
            own = mul(with_last, after[gap - 1u]);
        }
        meshed_own[gap] = own;
        meshed_tight[gap] = of_tight;
        let beyond = add(rows.stretch, mul(rows.land_ratio, short[gap - 1u]));
        let pivot = add(constant(1.0), beyond);
        let ratio = div(constant(1.0), pivot);
        after[gap] = ratio;
        short[gap] = div(beyond, pivot);
        tight[gap] = mul(mul(taken_in(rows, gap), tight[gap - 1u]), ratio);
    }
}

// From the tight to the slack side everything is eliminated; this walks back, tooth by tooth.
fn prepare(i: Inputs) -> Prepared {
    let rows = rows_of(i);
    eliminate(rows);
    // In units of what a lifted tooth takes in; what it gives is hardly more.
    let free_stretch = div(rows.free_stretch, rows.lifted_in);
    let lifted_out = add(constant(1.0), div(rows.lifted_apart, rows.lifted_in));
    let nothing = Linear(constant(0.0), constant(0.0));
    var behind = Behind(constant(0.0), constant(1.0), constant(1.0), tight_itself(), nothing);
    // Of the complete mesh: the tension that leaves a tooth, what the tight side makes of H, loads of this and of the last tooth.
    var leaving = slack_itself();
    var force: Real;
    var load: Linear;
    var last: Linear;
    for (var tooth = rows.teeth; tooth > 0u; tooth--) {
        let gap = tooth - 1u;
        let after_gap = after[gap];
        let short_gap = short[gap];
        let tight_gap = tight[gap];
        let is_last = tooth == rows.teeth;
        var before = tight_itself();
        var entering = before;
        // Of the slack tension: H(i) = -T(i) (1 - e lambda(i-1)).
        var by_slack = leaving.slack;
        if tooth > 1u {
            before = Linear(add(mul(after_gap, leaving.tight), tight_gap), mul(after_gap, leaving.slack));
            if is_last {
                before = Linear(tight_gap, mul(rows.slack, after_gap));
            }
            entering = scaled(before, rows.land_ratio);
            by_slack = mul(by_slack, add(mul(rows.lost, after_gap), short_gap));
        }
        if is_last {
            by_slack = mul(by_slack, rows.slack);
            force = mul(rows.land_ratio, before.tight);
        } else {
            force = add(force, mul(rows.stretch, leaving.tight));
        }
        load = over(Linear(force, neg(by_slack)), rows.flank);
        if is_last {
            last = load;
        }
        let inward = plus(scaled(plus(entering, leaving), rows.inwards), scaled(load, rows.load_inwards));
        set_inward_tight(gap, inward.tight);
        set_inward_slack(gap, inward.slack);
        leaving = before;

        if WANTS_boundary_tension || WANTS_peak_tooth_load || WANTS_least_tooth_load {
            if !is_last {
                let short_of = add(free_stretch, mul(lifted_out, behind.short));
                let pivot = add(constant(1.0), short_of);
                var takes = constant(1.0);
                if tooth == 1u {
                    takes = div(rows.tight, rows.lifted_in);
                }
                behind.rho = div(takes, pivot);
                behind.short = div(short_of, pivot);
                behind.sigma = div(mul(lifted_out, behind.sigma), pivot);
                behind.last = chained(behind.last, behind);
                behind.sum = chained(Linear(add(constant(1.0), behind.sum.tight), behind.sum.slack), behind);
            }
            make_boundary(rows, tooth, behind, lifted_out);
        }
    }
    if WANTS_boundary_tension || WANTS_peak_tooth_load || WANTS_least_tooth_load {
        // Without a boundary: the complete mesh; T* has no meaning there.
        set_boundary(rows.teeth, nothing, load, load, last, last);
    }
    var p: Prepared;
    p.teeth = i.teeth_in_mesh;
    p.mass_radius = mul(i.pitch_mass, i.tip_radius);
    p.peak_complete_tight = load.tight;
    p.peak_complete_slack = load.slack;
    p.lift_margin = select_(i.lift_angle, sub(i.space_half_angle, i.lift_angle), constant(1.0));
    return p;
}

// What the next gap's T(i) = rho T(i-1) + sigma T_s makes of a number that is linear in T(i) and T_s.
fn chained(number: Linear, behind: Behind) -> Linear {
    return Linear(mul(number.tight, behind.rho), add(number.slack, mul(number.tight, behind.sigma)));
}

fn of_star(star: Linear, own: Real, slack: Real) -> Linear {
    return Linear(mul(star.tight, own), add(mul(star.slack, own), slack));
}

// T* and the loads beside boundary `j`.
fn make_boundary(rows: Rows, j: u32, behind: Behind, lifted_out: Real) {
    var star = tight_itself();
    if j > 1u {
        let meshed = add(rows.lost, mul(rows.land_ratio, short[j - 2u]));
        let pivot = sub(add(add(rows.free_stretch, meshed), mul(rows.lifted_out, behind.short)), rows.lifted_apart);
        star = over(Linear(mul(taken_in(rows, j - 1u), tight[j - 2u]), mul(rows.lifted_out, behind.sigma)), pivot);
    }
    let last_in = mul(rows.lifted_in, behind.last.tight);
    let force_last = of_star(star, last_in, mul(rows.lifted_in, sub(behind.last.slack, lifted_out)));
    let own_in = add(last_in, mul(rows.free_stretch, behind.sum.tight));
    let force_own = of_star(star, own_in, neg(mul(rows.lifted_out, behind.sigma)));
    let own = over(force_own, rows.lifted_flank);
    var first = own;
    var before = own;
    if j > 1u {
        let force_before = plus(force_own, scaled(star, rows.free_stretch));
        let meshed = plus(scaled(star, meshed_own[j - 1u]), Linear(meshed_tight[j - 1u], constant(0.0)));
        before = over(force_before, rows.flank);
        first = over(plus(force_before, scaled(meshed, rows.stretch)), rows.flank);
    }
    set_boundary(j - 1u, star, first, own, before, over(force_last, rows.lifted_flank));
}

fn set_boundary(at: u32, star: Linear, first: Linear, own: Linear, before: Linear, last: Linear) {
    set_star_tight(at, star.tight);
    set_star_slack(at, star.slack);
    set_first_tight(at, first.tight);
    set_first_slack(at, first.slack);
    set_own_tight(at, own.tight);
    set_own_slack(at, own.slack);
    set_before_tight(at, before.tight);
    set_before_slack(at, before.slack);
    set_last_tight(at, last.tight);
    set_last_slack(at, last.slack);
}

// What presses a tooth (from 0) inwards with the complete mesh.
fn inward_force(p: Prepared, i: Inputs, tooth: u32) -> Real {
    return add(mul(i.tight_tension, inward_tight(p, tooth)), mul(i.slack_tension, inward_slack(p, tooth)));
}

fn least_inward(p: Prepared, i: Inputs) -> Real {
    var least = inward_force(p, i, 0u);
    let teeth = u32(p.teeth.value);
    var tooth = 1u;
    for (; tooth < teeth; tooth++) {
        least = min_(least, inward_force(p, i, tooth));
    }
    // A driver that ends long loops must not make a part of the teeth look like all of them.
    return if_known(tooth >= teeth, least);
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
    out.effective_tension = sub(i.tight_tension, i.slack_tension);
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
    // A driver that ends long loops must not make a part of the walk look like all of it.
    sure = sure && (meshing == teeth || at.value < 0.0);
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
