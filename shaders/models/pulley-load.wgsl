// Loads of a V-belt on one pulley: the twin of src/models/pulley_load.rs. Equation numbers are the paper's.

fn prepare(i: Inputs) -> Prepared {
    let belt_speed = mul(i.mean_radius, i.speed);
    let effective_tension = div(i.power, belt_speed);
    let centrifugal_tension = mul(i.belt_mass, square(belt_speed));
    // What presses the belt on the pulley at either end of the wrap.
    let slack_pressing = sub(i.slack_tension, centrifugal_tension);
    let tight_pressing = add(slack_pressing, effective_tension);
    // (13): log((T_t - T_c)/(T_s - T_c)), exact also for a small load.
    let effective_friction = div(ln_1p_(div(effective_tension, slack_pressing)), i.wrap_angle);

    let sine = sin_(half(i.groove_angle));
    let cosine = cos_(half(i.groove_angle));
    let along = cos_(i.friction_direction);
    let across = mul(sin_(i.friction_direction), cosine);
    let balance_margin = sub(along, mul(effective_friction, across));
    let friction_used = div(mul(effective_friction, sine), balance_margin);
    // The two strands pull at an angle of pi - theta_w to each other. The square cannot be negative but for rounding.
    let both = add(square(slack_pressing), square(tight_pressing));
    let towards = mul(twice(mul(slack_pressing, tight_pressing)), cos_(i.wrap_angle));

    var p: Prepared;
    p.belt_speed = belt_speed;
    p.effective_tension = effective_tension;
    p.centrifugal_tension = centrifugal_tension;
    p.effective_friction = effective_friction;
    p.friction_used = friction_used;
    p.torque = mul(effective_tension, i.mean_radius);
    p.resultant_force = sqrt_(max_(sub(both, towards), constant(0.0)));
    p.slack_end_line_force = div(slack_pressing, i.mean_radius);
    p.tight_end_line_force = div(tight_pressing, i.mean_radius);
    p.flank_per_line = div(constant(1.0), twice(add(sine, mul(friction_used, across)))); // (10), for one groove
    p.lift_margin = slack_pressing;
    p.balance_margin = balance_margin;
    return p;
}

fn conditions(p: Prepared, i: Inputs) -> array<Real, CONDITIONS> {
    var margins: array<Real, CONDITIONS>;
    for (var number = 0; number < i32(CONDITIONS); number++) {
        margins[number] = constant(1.0);
    }
    margins[0] = p.lift_margin;
    margins[1] = p.balance_margin;
    return margins;
}

fn finish(p: Prepared, i: Inputs) -> Outputs {
    let flank_per_line = div(p.flank_per_line, i.groove_count);
    var out: Outputs;
    out.belt_speed = p.belt_speed;
    out.tight_tension = add(i.slack_tension, p.effective_tension);
    out.effective_tension = p.effective_tension;
    out.centrifugal_tension = p.centrifugal_tension;
    out.effective_friction = p.effective_friction;
    out.friction_used = p.friction_used;
    out.friction_margin = sub(constant(1.0), div(p.friction_used, i.friction_limit));
    out.torque = p.torque;
    out.resultant_force = p.resultant_force;
    out.slack_end_line_force = p.slack_end_line_force;
    out.tight_end_line_force = p.tight_end_line_force;
    out.slack_end_flank_force = mul(p.slack_end_line_force, flank_per_line);
    out.tight_end_flank_force = mul(p.tight_end_line_force, flank_per_line);
    return out;
}
