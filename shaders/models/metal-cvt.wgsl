// Generated from src/models/metal_cvt.rs by shaders/write.

fn prepare_driver_radius_near(
    largest_radius: f32,
    first_radius: f32,
    ratio_less_one: f32,
    centre_distance: f32,
    n17: f32,
    both_half_turns: f32,
    belt_length: f32,
) -> f32 {
    var search = begin_search(0.0, largest_radius, first_radius);
    for (var i = 0; i < NEWTON_STEPS && !search.done; i++) {
        let x = search.x;
        let sine_of_lean = max(min(((ratio_less_one * x) / centre_distance), 1.0), (-1.0));
        let lean = arc_sine(sine_of_lean);
        let free = (n17 * sqrt(max(((1.0 - sine_of_lean) * (1.0 + sine_of_lean)), 0.0)));
        let n35 = ((2.0 * lean) * ratio_less_one);
        search = newton_step(
            search,
            (((free + (both_half_turns * x)) + (n35 * x)) - belt_length),
            (both_half_turns + n35),
        );
    }
    return search.x;
}

fn prepare_driver_radius_root(
    largest_radius: Real,
    first_radius: Real,
    ratio_less_one: Real,
    centre_distance: Real,
    n17: Real,
    both_half_turns: Real,
    belt_length: Real,
) -> Real {
    let x = constant(
        prepare_driver_radius_near(
            largest_radius.value,
            first_radius.value,
            ratio_less_one.value,
            centre_distance.value,
            n17.value,
            both_half_turns.value,
            belt_length.value,
        ),
    );
    let sine_of_lean = max_(min_(div(mul(ratio_less_one, x), centre_distance), constant(1.0)), constant(-1.0));
    let lean = asin_(sine_of_lean);
    let free = mul(n17, sqrt_(mul(sub(constant(1.0), sine_of_lean), add(constant(1.0), sine_of_lean))));
    let n35 = mul(twice(lean), ratio_less_one);
    return root(
        x.value,
        sub(add(add(free, mul(both_half_turns, x)), mul(n35, x)), belt_length),
        add(both_half_turns, n35),
    );
}

fn prepare(i: Inputs) -> Prepared {
    let ratio_less_one = sub(i.ratio, constant(1.0));
    let both_half_turns = mul(Real(3.1415927, 8.7422784e-8), add(constant(1.0), i.ratio));
    let n13 = abs_(ratio_less_one);
    let largest_radius = div(i.centre_distance, max_(n13, Real(1e-9, 2.8281934e-17)));
    let n17 = twice(i.centre_distance);
    let length_margin = sub(i.belt_length, n17);
    let first_radius = div(length_margin, both_half_turns);
    let driver_radius = prepare_driver_radius_root(
        largest_radius,
        first_radius,
        ratio_less_one,
        i.centre_distance,
        n17,
        both_half_turns,
        i.belt_length,
    );
    let driven_radius = mul(i.ratio, driver_radius);
    let lean_ = asin_(
        max_(min_(div(sub(driven_radius, driver_radius), i.centre_distance), constant(1.0)), constant(-1.0)),
    );
    let n47 = twice(lean_);
    let driver_wrap = sub(Real(3.1415927, 8.7422784e-8), n47);
    let driven_wrap = add(Real(3.1415927, 8.7422784e-8), n47);
    let n50 = half(i.groove_angle);
    let groove_sine = sin_(n50);
    let groove_cosine = cos_(n50);
    let effective_friction = div(i.friction, groove_sine);
    let wedge_margin = sub(groove_cosine, mul(i.friction, groove_sine));
    let wedge = div(wedge_margin, add(mul(i.friction, groove_cosine), groove_sine)); // (1), (6)
    let driven_pull = exp_m1_(min_(mul(effective_friction, driven_wrap), constant(700.0))); // e - 1
    let n63 = add(driven_pull, constant(2.0));
    let traction_limit = div(driven_pull, n63);
    let traction = select_(i.traction, i.traction, traction_limit);
    let n67 = sub(constant(1.0), traction);
    let arc = min_(div(ln_1p_(div(twice(traction), n67)), effective_friction), driven_wrap); // (12)
    let active_arc = select_(i.traction, arc, driven_wrap);
    let smaller_radius = min_(driver_radius, driven_radius);
    let free_radius = div(i.belt_length, Real(6.2831855, 1.7484557e-7)); // r0
    let n76 = add(constant(1.0), traction);
    let slack_share = div(n67, n76);
    let pull = exp_m1_(min_(mul(effective_friction, driver_wrap), constant(700.0))); // e - 1
    var p: Prepared;
    p.driver_radius = driver_radius;
    p.driven_radius = driven_radius;
    p.driver_wrap = driver_wrap;
    p.driven_wrap = driven_wrap;
    p.effective_friction = effective_friction;
    p.traction_limit = traction_limit;
    p.driver_traction_limit = div(pull, add(pull, constant(2.0)));
    p.slip_margin = select_(i.traction, sub(constant(1.0), div(traction, traction_limit)), constant(0.0));
    p.active_arc = active_arc;
    p.driver_axial_coefficient = mul(mul(scaled_(n76, 0.25), driver_wrap), wedge);
    p.driven_axial_coefficient = add(
        mul(mul(scaled_(n67, 0.25), sub(driven_wrap, active_arc)), wedge),
        mul(div(traction, twice(i.friction)), groove_cosine),
    );
    p.traction = traction;
    p.curvature = sub(div(constant(1.0), smaller_radius), div(constant(1.0), free_radius));
    p.smaller_radius = smaller_radius;
    p.free_ratio = div(free_radius, sub(free_radius, smaller_radius));
    p.printed_pull = mul(slack_share, driven_pull);
    p.entry_compression = div(
        mul(sub(traction, traction_limit), n63),
        twice(select_(neg(traction), constant(1.0), traction)),
    );
    p.length_margin = length_margin;
    p.root_margin = sub(
        mul(mul(Real(6.2831855, 1.7484557e-7), i.centre_distance), max_(i.ratio, constant(1.0))),
        mul(i.belt_length, n13),
    );
    p.overlap_margin = sub(sub(i.centre_distance, driver_radius), driven_radius);
    p.wedge_margin = wedge_margin;
    return p;
}

fn conditions(p: Prepared, i: Inputs) -> array<Real, CONDITIONS> {
    var margins: array<Real, CONDITIONS>;
    margins[0] = p.length_margin;
    margins[1] = p.root_margin;
    margins[2] = p.overlap_margin;
    margins[3] = p.wedge_margin;
    margins[4] = select_(i.traction, sub(p.traction_limit, p.traction), constant(0.0));
    margins[5] = select_(neg(i.torque), constant(1.0), p.traction);
    margins[6] = p.traction;
    return margins;
}

fn finish(p: Prepared, i: Inputs) -> Outputs {
    let width = mul(twice(i.band_count), i.band_width);
    let area = mul(width, i.band_thickness);
    let bending_stress = mul(half(mul(i.elastic_modulus, i.band_thickness)), p.curvature);
    let belt_force = div(i.torque, p.driver_radius);
    let force_sum = div(belt_force, select_(neg(p.traction), constant(1.0), p.traction)); // F1 + F2
    let n36 = add(constant(1.0), p.traction);
    let tight_force = half(mul(force_sum, n36));
    let driver_axial_force = mul(p.driver_axial_coefficient, force_sum);
    let driven_axial_force = mul(p.driven_axial_coefficient, force_sum);
    let tensile_stress = div(tight_force, area);
    let max_stress = add(tensile_stress, bending_stress);
    let tight_capacity = mul_or_zero(max_(sub(i.strength, bending_stress), constant(0.0)), area);
    let per_tight = div(constant(2.0), n36);
    let n63 = square(i.strength);
    var out: Outputs;
    out.driver_radius = p.driver_radius; // open belt
    out.driven_radius = p.driven_radius; // open belt
    out.driver_wrap = p.driver_wrap; // open belt
    out.driven_wrap = p.driven_wrap; // open belt
    out.effective_friction = p.effective_friction; // mu/sin(a/2)
    out.traction_limit = p.traction_limit; // (12), (13)
    out.driver_traction_limit = p.driver_traction_limit; // (12), (13)
    out.slip_margin = p.slip_margin; // 1 - lambda/lambda_max
    out.active_arc = p.active_arc; // (12)
    out.driver_axial_coefficient = p.driver_axial_coefficient; // (4), (15)
    out.driven_axial_coefficient = p.driven_axial_coefficient; // (5), (16)
    out.belt_force = belt_force; // (3), (14)
    out.tight_force = tight_force; // P(1+lambda)/(2 lambda)
    out.slack_force = half(mul(force_sum, sub(constant(1.0), p.traction))); // P(1-lambda)/(2 lambda)
    out.driver_axial_force = driver_axial_force; // (1), (6)
    out.driven_axial_force = driven_axial_force; // (2), (11)
    out.axial_force = max_(driver_axial_force, driven_axial_force); // larger of S_driver, S_driven
    out.tensile_stress = tensile_stress; // (17), (22)
    out.bending_stress = bending_stress; // (18)
    out.max_stress = max_stress; // sigma_t + sigma_b
    out.stress_margin = sub(constant(1.0), div(max_stress, i.strength)); // 1 - sigma_max/sigma_y
    out.optimum_thickness = mul(mul(div(i.strength, i.elastic_modulus), p.smaller_radius), p.free_ratio); // (19), (26)
    out.torque_coefficient = mul(
        mul(div(mul(div(p.traction, n36), n63), i.elastic_modulus), p.free_ratio),
        width,
    ); // (20), (21), (27)
    out.torque_capacity = mul_or_zero(tight_capacity, mul(mul(per_tight, p.traction), p.driver_radius)); // r_driver (sigma_y - sigma_b) A 2 lambda/(1+lambda)
    out.capacity_axial_force = mul_or_zero(
        tight_capacity,
        mul(per_tight, max_(p.driver_axial_coefficient, p.driven_axial_coefficient)),
    ); // (4), (5), (15), (16)
    out.printed_torque_coefficient = half(
        mul(mul(div(mul(p.printed_pull, n63), i.elastic_modulus), p.free_ratio), width),
    ); // (28)
    out.entry_compression = p.entry_compression; // 1 - (x-1)(e-1)
    return out;
}
