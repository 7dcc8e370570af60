// Generated from src/models/flat_belt.rs by shaders/write.

fn prepare(i: Inputs) -> Prepared {
    let n6 = half(i.driver_diameter);
    let n7 = half(i.driven_diameter);
    let sine_of_lean = max_(min_(div(sub(n7, n6), i.centre_distance), constant(1.0)), constant(-1.0));
    let lean = asin_(sine_of_lean);
    let n14 = twice(lean);
    let driver_wrap = sub(Real(3.1415927, 8.7422784e-8), n14);
    let driven_wrap = add(Real(3.1415927, 8.7422784e-8), n14);
    let least_wrap = min_(driver_wrap, driven_wrap);
    var p: Prepared;
    p.driver_wrap = driver_wrap;
    p.driven_wrap = driven_wrap;
    p.least_wrap = least_wrap;
    p.wrap_cosine = cos_(least_wrap);
    p.belt_length = add(
        add(
            mul(twice(i.centre_distance), sqrt_(mul(sub(constant(1.0), sine_of_lean), add(constant(1.0), sine_of_lean)))),
            mul(driver_wrap, n6),
        ),
        mul(driven_wrap, n7),
    );
    p.grip = neg(exp_m1_(neg(mul(i.friction, least_wrap))));
    p.overlap_margin = sub(sub(i.centre_distance, n6), n7);
    return p;
}

fn conditions(p: Prepared, i: Inputs) -> array<Real, CONDITIONS> {
    let belt_speed = mul(half(i.driver_diameter), i.driver_speed);
    let mass_per_length = mul(mul(i.belt_density, i.belt_width), i.belt_thickness);
    let centrifugal = mul(mass_per_length, square(belt_speed)); // (e)
    let effective = div(i.power, belt_speed); // (h)
    let tight = mul(i.tension_per_width, i.belt_width); // (17-12)
    let slack_pressing = sub(sub(tight, effective), centrifugal);
    var margins: array<Real, CONDITIONS>;
    margins[0] = p.overlap_margin;
    margins[1] = slack_pressing;
    return margins;
}

fn finish(p: Prepared, i: Inputs) -> Outputs {
    let belt_speed = mul(half(i.driver_diameter), i.driver_speed);
    let mass_per_length = mul(mul(i.belt_density, i.belt_width), i.belt_thickness);
    let centrifugal = mul(mass_per_length, square(belt_speed)); // (e)
    let effective = div(i.power, belt_speed); // (h)
    let tight = mul(i.tension_per_width, i.belt_width); // (17-12)
    let slack_tension = sub(tight, effective);
    let tight_pressing = sub(tight, centrifugal);
    let slack_pressing = sub(slack_tension, centrifugal);
    let capacity = mul(tight_pressing, p.grip); // F1 - F2 at slip, (17-7)
    var out: Outputs;
    out.driver_wrap = p.driver_wrap; // (17-1)
    out.driven_wrap = p.driven_wrap; // (17-1)
    out.belt_length = p.belt_length; // (17-2)
    out.belt_speed = belt_speed; // pi d n
    out.torque = div(i.power, i.driver_speed); // H / n
    out.effective_tension = effective; // (h)
    out.centrifugal_tension = centrifugal; // (e)
    out.tight_tension = tight; // (17-12)
    out.slack_tension = slack_tension; // F1 less the pull
    out.initial_tension = half(add(tight_pressing, slack_pressing)); // (17-8)
    out.friction_used = div(ln_1p_(div(effective, slack_pressing)), p.least_wrap); // (17-7)
    out.slip_margin = sub(constant(1.0), div(effective, capacity)); // (17-7)
    out.power_capacity = mul_or_zero(max_(capacity, constant(0.0)), belt_speed); // (17-7)
    out.shaft_load = sqrt_(
        max_(
            sub(
                add(square(tight_pressing), square(slack_pressing)),
                mul(mul(twice(tight_pressing), slack_pressing), p.wrap_cosine),
            ),
            constant(0.0),
        ),
    ); // resultant
    out.belt_stress = div(i.tension_per_width, i.belt_thickness); // F1 / (b t)
    return out;
}
