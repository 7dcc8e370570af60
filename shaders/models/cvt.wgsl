// The V-belt variator, shared by the rubber and the metal belt: the twin of src/models/cvt. Equation numbers are the paper's.
//
// `Prepared` and `Outputs` have the fields of the Rust records `Prepared` and `Result`; the kernel's prelude declares them.

struct Drive {
    friction: Real,
    groove_angle: Real,
    ratio: Real,
    belt_length: Real,
    centre_distance: Real,
    width: Real,
    thickness: Real,
    sections: Real,
    elastic_modulus: Real,
    strength: Real,
    traction: Real,
    torque: Real,
}

const NEWTON_STEPS: i32 = 40;

fn one() -> Real {
    return constant(1.0);
}

// Axial force of one pulley per unit of belt force and wrap angle, (1) and (6).
fn wedge_factor(friction: Real, sine: Real, cosine: Real) -> Real {
    return div(sub(cosine, mul(friction, sine)), add(mul(friction, cosine), sine));
}

// exp(mu_e wrap) - 1, the tension ratio at gross slip less one.
fn slip_pull(effective_friction: Real, wrap: Real) -> Real {
    return exp_m1_(mul(effective_friction, wrap));
}

// tanh(mu_e wrap / 2) from exp(mu_e wrap) - 1, (12).
fn limit_of_pull(pull: Real) -> Real {
    return div(pull, add(pull, constant(2.0)));
}

// Belt length at a driver radius less the belt's, and its slope.
fn excess_length(radius: Real, belt: Drive) -> array<Real, 2> {
    let step = sub(belt.ratio, one());
    let both = mul(near(PI), add(one(), belt.ratio));
    let sine = max_(min_(div(mul(step, radius), belt.centre_distance), one()), constant(-1.0));
    let lean = asin_(sine);
    let free = mul(twice(belt.centre_distance), sqrt_(mul(sub(one(), sine), add(one(), sine))));
    let turned_step = mul(twice(lean), step);
    let value = sub(add(add(free, mul(both, radius)), mul(turned_step, radius)), belt.belt_length);
    return array<Real, 2>(value, add(both, turned_step));
}

// Pitch radius of the driver of an open belt. The length is increasing and convex in the radius and the start is at or above
// the root, so Newton's steps never overshoot; they end when they no longer shrink.
fn driver_radius(belt: Drive) -> Real {
    let step = belt.ratio.value - 1.0;
    let centre = belt.centre_distance.value;
    let length = belt.belt_length.value;
    let both = PI * (1.0 + belt.ratio.value);
    let largest = centre / max(abs(step), 1e-9);
    var radius = clamp((length - 2.0 * centre) / both, 0.0, largest);
    var last_step = infinity();
    for (var i = 0; i < NEWTON_STEPS; i++) {
        let sine = clamp(step * radius / centre, -1.0, 1.0);
        let lean = arc_sine(sine);
        let free = 2.0 * centre * sqrt((1.0 - sine) * (1.0 + sine));
        let value = free + both * radius + 2.0 * lean * step * radius - length;
        let next = clamp(radius - value / (both + 2.0 * lean * step), 0.0, largest);
        let moved = abs(next - radius);
        radius = next;
        if moved >= last_step || moved == 0.0 {
            break;
        }
        last_step = moved;
    }
    let end = excess_length(constant(radius), belt);
    return root(radius, end[0], end[1]);
}

fn prepare_belt(belt: Drive) -> Prepared {
    let driver_radius = driver_radius(belt);
    let driven_radius = mul(belt.ratio, driver_radius);
    let sine_of_lean = max_(min_(div(sub(driven_radius, driver_radius), belt.centre_distance), one()), constant(-1.0));
    let lean = twice(asin_(sine_of_lean));
    let driver_wrap = sub(near(PI), lean);
    let driven_wrap = add(near(PI), lean);

    let sine = sin_(half(belt.groove_angle));
    let cosine = cos_(half(belt.groove_angle));
    let effective_friction = div(belt.friction, sine);
    let wedge = wedge_factor(belt.friction, sine, cosine);

    let driven_pull = slip_pull(effective_friction, driven_wrap);
    let traction_limit = limit_of_pull(driven_pull);
    let traction = select_(belt.traction, belt.traction, traction_limit);
    // (12): log((1 + lambda)/(1 - lambda)); at the limit the whole wrap is active.
    let arc = min_(div(ln_1p_(div(twice(traction), sub(one(), traction))), effective_friction), driven_wrap);
    let active_arc = select_(belt.traction, arc, driven_wrap);

    let smaller_radius = min_(driver_radius, driven_radius);
    let free_radius = div(belt.belt_length, near(2.0 * PI));
    let more = add(one(), traction);
    let less = sub(one(), traction);

    var p: Prepared;
    p.driver_radius = driver_radius;
    p.driven_radius = driven_radius;
    p.driver_wrap = driver_wrap;
    p.driven_wrap = driven_wrap;
    p.effective_friction = effective_friction;
    p.traction_limit = traction_limit;
    p.driver_traction_limit = limit_of_pull(slip_pull(effective_friction, driver_wrap));
    p.slip_margin = select_(belt.traction, sub(one(), div(traction, traction_limit)), constant(0.0));
    p.active_arc = active_arc;
    // (4), (15) and (5), (16)
    p.driver_axial_coefficient = mul(mul(half(half(more)), driver_wrap), wedge);
    p.driven_axial_coefficient = add(
        mul(mul(half(half(less)), sub(driven_wrap, active_arc)), wedge),
        mul(div(traction, twice(belt.friction)), cosine),
    );
    p.traction = traction;
    p.curvature = sub(div(one(), smaller_radius), div(one(), free_radius));
    p.smaller_radius = smaller_radius;
    p.free_ratio = div(free_radius, sub(free_radius, smaller_radius));
    // (28) with x = (1 + lambda)/(2 lambda)
    p.printed_pull = mul(div(less, more), driven_pull);
    p.entry_compression = div(
        mul(sub(traction, traction_limit), add(driven_pull, constant(2.0))),
        twice(select_(neg(traction), one(), traction)),
    );
    p.length_margin = sub(belt.belt_length, twice(belt.centre_distance));
    p.root_margin = sub(
        mul(mul(near(2.0 * PI), belt.centre_distance), max_(belt.ratio, one())),
        mul(belt.belt_length, abs_(sub(belt.ratio, one()))),
    );
    p.overlap_margin = sub(sub(belt.centre_distance, driver_radius), driven_radius);
    p.wedge_margin = sub(cosine, mul(belt.friction, sine));
    return p;
}

fn belt_conditions(p: Prepared, belt: Drive) -> array<Real, CONDITIONS> {
    var margins: array<Real, CONDITIONS>;
    margins[0] = p.length_margin;
    margins[1] = p.root_margin;
    margins[2] = p.overlap_margin;
    margins[3] = p.wedge_margin;
    margins[4] = select_(belt.traction, sub(p.traction_limit, p.traction), constant(0.0));
    // Without traction only a torque of zero can be carried.
    margins[5] = select_(neg(belt.torque), one(), p.traction);
    margins[6] = p.traction;
    margins[7] = one();
    return margins;
}

fn finish_belt(p: Prepared, belt: Drive) -> Outputs {
    var out: Outputs;
    out.driver_radius = p.driver_radius;
    out.driven_radius = p.driven_radius;
    out.driver_wrap = p.driver_wrap;
    out.driven_wrap = p.driven_wrap;
    out.effective_friction = p.effective_friction;
    out.traction_limit = p.traction_limit;
    out.driver_traction_limit = p.driver_traction_limit;
    out.slip_margin = p.slip_margin;
    out.active_arc = p.active_arc;
    out.driver_axial_coefficient = p.driver_axial_coefficient;
    out.driven_axial_coefficient = p.driven_axial_coefficient;
    out.entry_compression = p.entry_compression;

    let width = mul(belt.sections, belt.width);
    let area = mul(width, belt.thickness);
    let bending_stress = mul(half(mul(belt.elastic_modulus, belt.thickness)), p.curvature); // (18)
    out.bending_stress = bending_stress;

    let more = add(one(), p.traction);
    let belt_force = div(belt.torque, p.driver_radius); // (3), (14)
    let force_sum = div(belt_force, select_(neg(p.traction), one(), p.traction));
    let tight_force = half(mul(force_sum, more));
    out.belt_force = belt_force;
    out.tight_force = tight_force;
    out.slack_force = half(mul(force_sum, sub(one(), p.traction)));
    out.driver_axial_force = mul(p.driver_axial_coefficient, force_sum);
    out.driven_axial_force = mul(p.driven_axial_coefficient, force_sum);
    out.axial_force = max_(out.driver_axial_force, out.driven_axial_force);
    out.tensile_stress = div(tight_force, area); // (17), (22)
    out.max_stress = add(out.tensile_stress, bending_stress);
    out.stress_margin = sub(one(), div(out.max_stress, belt.strength));

    // A belt that bending alone overstrains carries nothing: capacity 0, not an error. Clamped last, so that the 0 is exact.
    let tight_capacity = mul(sub(belt.strength, bending_stress), area);
    let per_tight = div(constant(2.0), more);
    let torque = mul(tight_capacity, mul(mul(per_tight, p.traction), p.driver_radius));
    let axial = mul(tight_capacity, mul(per_tight, max_(p.driver_axial_coefficient, p.driven_axial_coefficient)));
    out.torque_capacity = max_(torque, constant(0.0));
    out.capacity_axial_force = max_(axial, constant(0.0));

    let stress = div(belt.strength, belt.elastic_modulus);
    let energy = mul(stress, belt.strength);
    out.optimum_thickness = mul(mul(stress, p.smaller_radius), p.free_ratio);
    out.torque_coefficient = mul(mul(mul(div(p.traction, more), energy), p.free_ratio), width);
    out.printed_torque_coefficient = half(mul(mul(mul(p.printed_pull, energy), p.free_ratio), width));
    return out;
}
