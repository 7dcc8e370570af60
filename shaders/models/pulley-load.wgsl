// Generated from src/models/pulley_load.rs by shaders/write.

fn prepare(i: Inputs) -> Prepared {
    let belt_speed = mul(i.mean_radius, i.speed);
    let effective_tension = div(i.power, belt_speed);
    let centrifugal_tension = mul(i.belt_mass, square(belt_speed));
    let half_ = half(effective_tension);
    let n19 = sub(i.tensioning, constant(1.5));
    let slack_tension = select_(n19, sub(i.installed_tension, half_), i.slack_tension);
    let tight_tension = select_(n19, add(i.installed_tension, half_), add(i.slack_tension, effective_tension));
    let slack_pressing = sub(slack_tension, centrifugal_tension);
    let tight_pressing = sub(tight_tension, centrifugal_tension);
    let effective_friction = div(ln_1p_(div(effective_tension, slack_pressing)), i.wrap_angle);
    let n29 = half(i.groove_angle);
    let groove_sine = sin_(n29);
    let along = cos_(i.friction_direction);
    let across = mul(sin_(i.friction_direction), cos_(n29));
    let balance_margin = sub(along, mul(effective_friction, across));
    let friction_used = div(mul(effective_friction, groove_sine), balance_margin);
    var p: Prepared;
    p.belt_speed = belt_speed;
    p.slack_tension = slack_tension;
    p.tight_tension = tight_tension;
    p.effective_tension = effective_tension;
    p.centrifugal_tension = centrifugal_tension;
    p.effective_friction = effective_friction;
    p.friction_used = friction_used;
    p.torque = mul(effective_tension, i.mean_radius);
    p.resultant_force = sqrt_(
        max_(
            sub(
                add(square(slack_pressing), square(tight_pressing)),
                mul(mul(twice(slack_pressing), tight_pressing), cos_(i.wrap_angle)),
            ),
            constant(0.0),
        ),
    );
    p.slack_end_line_force = div(slack_pressing, i.mean_radius);
    p.tight_end_line_force = div(tight_pressing, i.mean_radius);
    p.flank_per_line = div(constant(1.0), twice(add(groove_sine, mul(friction_used, across))));
    p.lift_margin = select_(n19, constant(1.0), slack_pressing);
    p.slackness_margin = select_(n19, slack_pressing, constant(1.0));
    p.balance_margin = balance_margin;
    return p;
}

fn conditions(p: Prepared, i: Inputs) -> array<Real, CONDITIONS> {
    var margins: array<Real, CONDITIONS>;
    margins[0] = p.lift_margin;
    margins[1] = p.slackness_margin;
    margins[2] = p.balance_margin;
    margins[3] = sub(constant(1.0), div(p.friction_used, i.friction_limit));
    return margins;
}

fn finish(p: Prepared, i: Inputs) -> Outputs {
    let n17 = div(p.flank_per_line, i.groove_count);
    var out: Outputs;
    out.belt_speed = p.belt_speed; // (2)
    out.slack_tension = p.slack_tension; // given, or T_0 - P/(2 v)
    out.tight_tension = p.tight_tension; // (2), (15)
    out.effective_tension = p.effective_tension; // T_t - T_s
    out.centrifugal_tension = p.centrifugal_tension; // w v^2
    out.effective_friction = p.effective_friction; // (13)
    out.friction_used = p.friction_used; // (12)
    out.friction_margin = sub(constant(1.0), div(p.friction_used, i.friction_limit)); // 1 - friction_used/friction_limit
    out.torque = p.torque; // (T_t - T_s) R_b
    out.resultant_force = p.resultant_force; // vectors T_t - T_c, T_s - T_c
    out.slack_end_line_force = p.slack_end_line_force; // (9)
    out.tight_end_line_force = p.tight_end_line_force; // (9)
    out.slack_end_flank_force = mul(p.slack_end_line_force, n17); // (10)
    out.tight_end_flank_force = mul(p.tight_end_line_force, n17); // (10)
    return out;
}
