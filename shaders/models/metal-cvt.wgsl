// Generated from src/models/metal_cvt.rs by shaders/write.

fn prepare_driver_radius_near(
    largest_radius: f32,
    first_radius: f32,
    sine_per_radius: f32,
    n24: f32,
    both_half_turns: f32,
    belt_length: f32,
) -> f32 {
    var search = begin_search(0.0, largest_radius, first_radius);
    for (var i = 0; i < NEWTON_STEPS && !search.done; i++) {
        let x = search.x;
        let sine_of_lean = (sine_per_radius * x);
        let lean = arc_sine(sine_of_lean);
        let chord = sqrt(max(((1.0 - sine_of_lean) * (1.0 + sine_of_lean)), 0.0)); // cos g
        let straight = (n24 * (chord + (lean * sine_of_lean))); // 2 A (cos g + g sin g)
        search = smooth_newton_step(
            search,
            ((straight + (both_half_turns * x)) - belt_length),
            (both_half_turns + (n24 * (lean * sine_per_radius))),
        );
    }
    return search.x;
}

fn prepare_driver_radius_root(
    largest_radius: Real,
    first_radius: Real,
    sine_per_radius: Real,
    n24: Real,
    both_half_turns: Real,
    belt_length: Real,
) -> Real {
    let x = constant(
        prepare_driver_radius_near(
            largest_radius.value,
            first_radius.value,
            sine_per_radius.value,
            n24.value,
            both_half_turns.value,
            belt_length.value,
        ),
    );
    let sine_of_lean = mul(sine_per_radius, x);
    let lean = asin_(sine_of_lean);
    let chord = sqrt_(mul(sub(constant(1.0), sine_of_lean), add(constant(1.0), sine_of_lean))); // cos g
    let straight = mul(n24, add(chord, mul(lean, sine_of_lean))); // 2 A (cos g + g sin g)
    return root(
        x.value,
        sub(add(straight, mul(both_half_turns, x)), belt_length),
        add(both_half_turns, mul(n24, mul(lean, sine_per_radius))),
    );
}

fn prepare_slack_near(
    given_0: f32,
    given_1: f32,
    first_slack: f32,
    n96: f32,
    per_friction: f32,
    driven_wrap: f32,
    idle_force: f32,
) -> f32 {
    var search = begin_search(given_0, given_1, first_slack);
    for (var i = 0; i < NEWTON_STEPS && !search.done; i++) {
        let x = search.x;
        let gain = (n96 / x); // F1/F2 - 1
        let idle = (driven_wrap - (ln_1p(gain) * per_friction)); // theta_driven - theta_a
        search = smooth_newton_step(
            search,
            ((x * idle) - idle_force),
            (idle + ((gain / (1.0 + gain)) * per_friction)),
        );
    }
    return search.x;
}

fn prepare_slack_root(
    given_0: Real,
    given_1: Real,
    first_slack: Real,
    n96: Real,
    per_friction: Real,
    driven_wrap: Real,
    idle_force: Real,
) -> Real {
    let x = constant(
        prepare_slack_near(
            given_0.value,
            given_1.value,
            first_slack.value,
            n96.value,
            per_friction.value,
            driven_wrap.value,
            idle_force.value,
        ),
    );
    let gain = div(n96, x); // F1/F2 - 1
    let idle = sub(driven_wrap, mul(ln_1p_(gain), per_friction)); // theta_driven - theta_a
    return root(
        x.value,
        sub(mul(x, idle), idle_force),
        add(idle, mul(div(gain, add(constant(1.0), gain)), per_friction)),
    );
}

fn prepare(i: Inputs) -> Prepared {
    let ratio_less_one = sub(i.ratio, constant(1.0));
    let sine_per_radius = div(ratio_less_one, i.centre_distance); // (R - 1)/A
    let both_half_turns = mul(Real(3.1415927, 8.7422784e-8), add(constant(1.0), i.ratio));
    let n20 = abs_(ratio_less_one);
    let largest_radius = div(
        mul(Real(1.0, 5.6843426e-14), i.centre_distance),
        max_(n20, Real(1e-9, 2.8281934e-17)),
    );
    let n24 = twice(i.centre_distance);
    let length_margin = sub(i.belt_length, n24);
    let first_radius = div(
        twice(length_margin),
        add(
            both_half_turns,
            sqrt_(
                max_(
                    add(square(both_half_turns), mul(mul(scaled_(ratio_less_one, 4.0), sine_per_radius), length_margin)),
                    constant(0.0),
                ),
            ),
        ),
    );
    let driver_radius = prepare_driver_radius_root(
        largest_radius,
        first_radius,
        sine_per_radius,
        n24,
        both_half_turns,
        i.belt_length,
    );
    let driven_radius = mul(i.ratio, driver_radius);
    let lean_ = asin_(
        max_(min_(div(sub(driven_radius, driver_radius), i.centre_distance), constant(1.0)), constant(-1.0)),
    );
    let n60 = twice(lean_);
    let driver_wrap = sub(Real(3.1415927, 8.7422784e-8), n60);
    let driven_wrap = add(Real(3.1415927, 8.7422784e-8), n60);
    let n63 = half(i.groove_angle);
    let groove_sine = sin_(n63);
    let groove_cosine = cos_(n63);
    let effective_friction = div(i.friction, groove_sine);
    let wedge_margin = sub(groove_cosine, mul(i.friction, groove_sine));
    let wedge = div(wedge_margin, add(mul(i.friction, groove_cosine), groove_sine)); // (1), (6)
    let driven_pull = exp_m1_(min_(mul(effective_friction, driven_wrap), constant(700.0))); // e - 1
    let n76 = add(driven_pull, constant(2.0));
    let driven_traction_limit = div(driven_pull, n76);
    let pull = exp_m1_(min_(mul(effective_friction, driver_wrap), constant(700.0))); // e - 1
    let driver_traction_limit = div(pull, add(pull, constant(2.0)));
    let traction_limit = min_(driven_traction_limit, driver_traction_limit);
    let n84 = select_(i.clamping_force, constant(1.0), i.traction);
    let n85 = select_(i.traction, i.traction, traction_limit);
    let belt_force = div(i.torque, driver_radius); // (3), (14)
    let n88 = twice(i.friction);
    let slip_force = div(mul(belt_force, groove_cosine), n88); // P cos(a/2)/(2 mu)
    let to_hold = sub(i.clamping_force, slip_force);
    let held = div(to_hold, i.clamping_force);
    let idle_force = max_(div(scaled_(to_hold, 4.0), max_(wedge, Real(1e-9, 2.8281934e-17))), constant(0.0)); // 2 F2 (theta_driven - theta_a)
    let n96 = twice(belt_force);
    let least_slack = max_(div(n96, driven_pull), Real(2e-30, 6.342155e-39));
    let per_friction = div(constant(1.0), effective_friction); // 1/mu_e
    let per_wrap = div(constant(1.0), driven_wrap); // 1/theta_driven
    let n102 = mul(n96, per_friction);
    let asymptote = mul(add(idle_force, n102), per_wrap);
    let highest_slack = max_(asymptote, least_slack);
    let n107 = mul(Real(0.6666667, 1.9868217e-8), n96);
    let half_ = half(sub(asymptote, n107));
    let first_slack = max_(
        add(half_, sqrt_(add(square(half_), mul(n107, mul(add(idle_force, scaled_(n102, 0.25)), per_wrap))))),
        least_slack,
    );
    let slack = prepare_slack_root(
        half(least_slack),
        twice(highest_slack),
        first_slack,
        n96,
        per_friction,
        driven_wrap,
        idle_force,
    ); // 2 F2
    let clamped_sum = select_(i.clamping_force, add(slack, belt_force), constant(1.0));
    let traction = select_(i.clamping_force, div(belt_force, clamped_sum), n85);
    let slack_share = select_(i.clamping_force, div(slack, clamped_sum), sub(constant(1.0), n85));
    let arc = min_(div(ln_1p_(div(twice(traction), slack_share)), effective_friction), driven_wrap); // (12)
    let active_arc = select_(n84, arc, min_(driven_wrap, driver_wrap));
    let smaller_radius = min_(driver_radius, driven_radius);
    let free_radius = div(i.belt_length, Real(6.2831855, 1.7484557e-7)); // r0
    let idle_share = select_(
        i.clamping_force,
        div(idle_force, clamped_sum),
        mul(slack_share, sub(driven_wrap, active_arc)),
    );
    let active_part = mul(div(traction, n88), groove_cosine);
    let n156 = add(constant(1.0), traction);
    let n158 = mul(scaled_(n156, 0.25), driver_wrap);
    let driver_axial_coefficient = mul(n158, wedge);
    let n160 = scaled_(idle_share, 0.25);
    let driven_axial_coefficient = add(mul(n160, wedge), active_part);
    let unsupported = div(groove_cosine, groove_sine); // 1/tan(a/2)
    let belt_speed = mul(driver_radius, i.driver_speed);
    var p: Prepared;
    p.driver_radius = driver_radius;
    p.driven_radius = driven_radius;
    p.driver_wrap = driver_wrap;
    p.driven_wrap = driven_wrap;
    p.effective_friction = effective_friction;
    p.traction_limit = traction_limit;
    p.driven_traction_limit = driven_traction_limit;
    p.driver_traction_limit = driver_traction_limit;
    p.slip_margin = select_(n84, sub(constant(1.0), div(traction, traction_limit)), constant(0.0));
    p.active_arc = active_arc;
    p.driver_axial_coefficient = driver_axial_coefficient;
    p.driven_axial_coefficient = driven_axial_coefficient;
    p.driver_upper_coefficient = mul(n158, unsupported);
    p.driven_upper_coefficient = add(mul(n160, unsupported), active_part);
    p.thrust_ratio = div(driver_axial_coefficient, driven_axial_coefficient);
    p.utilisation = select_(
        i.clamping_force,
        div(slip_force, i.clamping_force),
        div(active_part, driven_axial_coefficient),
    );
    p.unsupported = unsupported;
    p.traction = traction;
    p.slack_share = slack_share;
    p.clamped_sum = clamped_sum;
    p.curvature = sub(div(constant(1.0), smaller_radius), div(constant(1.0), free_radius));
    p.smaller_radius = smaller_radius;
    p.free_ratio = div(free_radius, sub(free_radius, smaller_radius));
    p.printed_pull = mul(div(slack_share, n156), driven_pull);
    p.entry_compression = div(
        mul(sub(traction, driven_traction_limit), n76),
        twice(select_(neg(traction), constant(1.0), traction)),
    );
    p.belt_speed = belt_speed;
    p.centrifugal_force = mul(i.belt_mass, square(belt_speed));
    p.length_margin = length_margin;
    p.root_margin = sub(
        mul(mul(Real(6.2831855, 1.7484557e-7), i.centre_distance), max_(i.ratio, constant(1.0))),
        mul(i.belt_length, n20),
    );
    p.overlap_margin = sub(sub(i.centre_distance, driver_radius), driven_radius);
    p.wedge_margin = wedge_margin;
    p.driven_slip_margin = select_(
        i.clamping_force,
        sub(held, Real(1e-37, 3e-45)),
        select_(i.traction, sub(driven_traction_limit, i.traction), constant(0.0)),
    );
    p.driver_slip_margin = select_(
        i.clamping_force,
        sub(driver_traction_limit, traction),
        select_(i.traction, sub(driver_traction_limit, i.traction), constant(0.0)),
    );
    p.clamp_margin = select_(i.clamping_force, min_(held, wedge_margin), constant(1.0));
    return p;
}

fn conditions(p: Prepared, i: Inputs) -> array<Real, CONDITIONS> {
    var margins: array<Real, CONDITIONS>;
    margins[0] = p.length_margin;
    margins[1] = p.root_margin;
    margins[2] = p.overlap_margin;
    margins[3] = p.wedge_margin;
    margins[4] = p.driven_slip_margin;
    margins[5] = p.driver_slip_margin;
    margins[6] = select_(neg(i.torque), constant(1.0), p.traction);
    margins[7] = p.clamp_margin;
    margins[8] = select_(i.clamping_force, constant(0.0), min_(p.driven_slip_margin, p.driver_slip_margin));
    margins[9] = i.torque;
    margins[10] = p.traction;
    return margins;
}

fn finish(p: Prepared, i: Inputs) -> Outputs {
    let width = mul(twice(i.band_count), i.band_width);
    let area = mul(width, i.band_thickness);
    let bending_stress = mul(half(mul(i.elastic_modulus, i.band_thickness)), p.curvature);
    let belt_force = div(i.torque, p.driver_radius);
    let force_sum = select_(
        i.clamping_force,
        p.clamped_sum,
        div(belt_force, select_(neg(p.traction), constant(1.0), p.traction)),
    ); // F1 + F2
    let n49 = add(constant(1.0), p.traction);
    let tight_force = half(mul(force_sum, n49));
    let driver_axial_force = mul(p.driver_axial_coefficient, force_sum);
    let driven_axial_force = mul(p.driven_axial_coefficient, force_sum);
    let tensile_stress = div(add(tight_force, p.centrifugal_force), area);
    let max_stress = add(tensile_stress, bending_stress);
    let driver_axial_force_upper = mul(p.driver_upper_coefficient, force_sum);
    let driven_axial_force_upper = mul(p.driven_upper_coefficient, force_sum);
    let tight_capacity = max_(
        sub(mul(sub(i.strength, bending_stress), area), p.centrifugal_force),
        constant(0.0),
    );
    let per_tight = div(constant(2.0), n49);
    let n83 = square(i.strength);
    var out: Outputs;
    out.driver_radius = p.driver_radius; // open belt
    out.driven_radius = p.driven_radius; // open belt
    out.driver_wrap = p.driver_wrap; // open belt
    out.driven_wrap = p.driven_wrap; // open belt
    out.effective_friction = p.effective_friction; // mu/sin(a/2)
    out.traction_limit = p.traction_limit; // lesser of the two
    out.driven_traction_limit = p.driven_traction_limit; // (12), (13)
    out.driver_traction_limit = p.driver_traction_limit; // (12), (13)
    out.traction_used = p.traction; // (F1 - F2)/(F1 + F2)
    out.slip_margin = p.slip_margin; // 1 - lambda/lambda_max
    out.active_arc = p.active_arc; // (12)
    out.driver_axial_coefficient = p.driver_axial_coefficient; // (4), (15)
    out.driven_axial_coefficient = p.driven_axial_coefficient; // (5), (16)
    out.belt_force = belt_force; // (3), (14)
    out.tight_force = tight_force; // P(1+lambda)/(2 lambda)
    out.slack_force = half(mul(force_sum, p.slack_share)); // P(1-lambda)/(2 lambda)
    out.driver_axial_force = driver_axial_force; // (1), (6)
    out.driven_axial_force = driven_axial_force; // (2), (11)
    out.axial_force = max_(driver_axial_force, driven_axial_force); // larger of S_driver, S_driven
    out.driver_axial_force_upper = driver_axial_force_upper; // F1/2 theta_driver/tan(a/2)
    out.driven_axial_force_upper = driven_axial_force_upper; // F2/2 (theta_driven - theta_a)/tan(a/2) + P cos(a/2)/(2 mu)
    out.axial_force_upper = max_(driver_axial_force_upper, driven_axial_force_upper); // larger of the two
    out.clamping_safety = div(constant(1.0), p.utilisation); // S_driven 2 mu/(P cos(a/2))
    out.clamping_utilisation = select_(neg(i.torque), constant(0.0), p.utilisation); // 1/safety
    out.thrust_ratio = p.thrust_ratio; // S_driver/S_driven
    out.belt_speed = p.belt_speed; // r_driver omega
    out.centrifugal_force = p.centrifugal_force; // m v^2
    out.power = mul(i.torque, i.driver_speed); // T_L omega
    out.tensile_stress = tensile_stress; // (17), (22): (F1 + m v^2)/A
    out.bending_stress = bending_stress; // (18)
    out.max_stress = max_stress; // sigma_t + sigma_b
    out.stress_margin = sub(constant(1.0), div(max_stress, i.strength)); // 1 - sigma_max/sigma_y
    out.optimum_thickness = mul(mul(div(i.strength, i.elastic_modulus), p.smaller_radius), p.free_ratio); // (19), (26)
    out.torque_coefficient = mul(
        mul(div(mul(div(p.traction, n49), n83), i.elastic_modulus), p.free_ratio),
        width,
    ); // (20), (21), (27)
    out.torque_capacity = mul_or_zero(tight_capacity, mul(mul(per_tight, p.traction), p.driver_radius)); // r_driver ((sigma_y - sigma_b) A - m v^2) 2 lambda/(1+lambda)
    out.capacity_axial_force = mul_or_zero(
        tight_capacity,
        mul(per_tight, max_(p.driver_axial_coefficient, p.driven_axial_coefficient)),
    ); // (4), (5), (15), (16)
    out.printed_torque_coefficient = half(
        mul(mul(div(mul(p.printed_pull, n83), i.elastic_modulus), p.free_ratio), width),
    ); // (28)
    out.entry_compression = p.entry_compression; // 1 - (x-1)(e-1)
    return out;
}
