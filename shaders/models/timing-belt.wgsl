// Generated from src/models/timing_belt.rs by shaders/write.

fn prepare(i: Inputs) -> Prepared {
    let lift = select_(i.lift_angle, i.lift_angle, i.space_half_angle);
    let around = max_(mul(twice(i.friction), i.land_half_angle), Real(1e-30, 3.171078e-39));
    let lost = neg(exp_m1_(neg(around)));
    let land = mul(twice(i.land_half_angle), i.tip_radius);
    let meshed = cos_(i.space_half_angle);
    let rigidity = mul(mul(mul(i.cord_modulus, i.cord_area), i.tooth_compliance), meshed);
    let n51 = cos_(i.pressure_angle);
    let n52 = add(i.pressure_angle, lift);
    let free_stretch = div(add(land, i.tooth_length), rigidity); // (13)
    let lifted_in = div(cos_(add(i.space_half_angle, lift)), meshed);
    let lifted_apart = div(mul(twice(sin_(i.space_half_angle)), sin_(lift)), meshed);
    let land_ratio = sub(constant(1.0), lost);
    let stretch = div(add(mul(land, div(lost, around)), i.tooth_length), rigidity); // (5), (7)
    let tight_cosine = div(cos_(i.tight_span_angle), meshed);
    let slack_cosine = div(cos_(i.slack_span_angle), meshed);
    let lifted_out = div(cos_(sub(i.space_half_angle, lift)), meshed);
    let stretch_per_in = div(free_stretch, lifted_in);
    let out_per_in = add(constant(1.0), div(lifted_apart, lifted_in));
    let flank = div(n51, meshed);
    let lifted_flank = div(add(cos_(n52), mul(i.friction, sin_(n52))), meshed);
    let inwards = sin_(add(i.space_half_angle, i.land_half_angle));
    let load_inwards = sub(mul(i.friction, n51), sin_(i.pressure_angle));
    var after: array<Real, 61>;
    var meshed_own: array<Real, 61>;
    var meshed_tight: array<Real, 61>;
    var tight: array<Real, 61>;
    for (var at = 0; at < 61; at++) { tight[at] = constant(1.0); }
    var short: array<Real, 61>;
    for (var at = 0; at < 61; at++) { short[at] = constant(1.0); }
    let end_0 = min(whole(i.teeth_in_mesh), 60u);
    var tight_before = constant(1.0);
    var short_before = constant(1.0);
    var own = constant(0.0);
    var of_tight = constant(0.0);
    var place_0 = 1u;
    for (; place_0 < end_0; place_0++) {
        let n98 = add(stretch, mul(land_ratio, short_before));
        let n99 = add(constant(1.0), n98);
        let n100 = div(constant(1.0), n99);
        let n106 = mul(
            mul(select_(sub(constant(1.5), constant(f32(place_0))), tight_cosine, land_ratio), tight_before),
            n100,
        );
        let n107 = div(n98, n99);
        let n108 = add(own, constant(1.0));
        let n109 = mul(n108, n100);
        let n111 = add(mul(n108, n106), of_tight);
        after[place_0 + 1u] = n100;
        tight[place_0 + 1u] = n106;
        short[place_0 + 1u] = n107;
        meshed_own[place_0 + 1u] = n109;
        meshed_tight[place_0 + 1u] = n111;
        tight_before = n106;
        short_before = n107;
        own = n109;
        of_tight = n111;
    }
    let n175 = div(tight_cosine, lifted_in);
    let end_1 = min(whole(i.teeth_in_mesh), 60u);
    var tension_tight = constant(0.0);
    var tension_slack = constant(1.0);
    var behind = constant(0.0);
    var first_load_tight_1 = constant(0.0);
    var first_load_slack_1 = constant(0.0);
    var last_load_tight = constant(0.0);
    var last_load_slack = constant(0.0);
    var sigma = constant(1.0);
    var short_behind = constant(1.0);
    var last_in_tight = constant(1.0);
    var last_in_slack = constant(0.0);
    var sum_tight = constant(0.0);
    var left_1 = end_1;
    for (; left_1 > 0u; left_1--) {
        let place_1 = left_1 - 1u;
        let is_last = sub(plus_whole(constant(f32(place_1)), constant(1.5)), i.teeth_in_mesh);
        let after_first = sub(constant(f32(place_1)), constant(0.5));
        let n132 = after[place_1 + 1u];
        let n133 = tight[place_1 + 1u];
        let n134 = select_(is_last, constant(0.0), tension_tight);
        let n135 = select_(is_last, constant(1.0), tension_slack);
        let n142 = select_(after_first, select_(is_last, n133, add(mul(n132, n134), n133)), constant(1.0));
        let n143 = select_(after_first, select_(is_last, mul(slack_cosine, n132), mul(n132, n135)), constant(0.0));
        let n144 = select_(after_first, land_ratio, constant(1.0));
        let force = select_(
            is_last,
            mul(select_(after_first, land_ratio, tight_cosine), n142),
            add(behind, mul(stretch, n134)),
        );
        let n151 = short[place_1 + 1u];
        let load_tight = div(force, flank);
        let load_slack = div(
            neg(
                mul(
                    mul(select_(is_last, slack_cosine, constant(1.0)), n135),
                    select_(after_first, add(mul(lost, n132), n151), constant(1.0)),
                ),
            ),
            flank,
        );
        let n173 = add(stretch_per_in, mul(out_per_in, short_behind));
        let n174 = add(constant(1.0), n173);
        let n177 = div(select_(after_first, constant(1.0), n175), n174);
        let n179 = div(mul(out_per_in, sigma), n174);
        let n185 = select_(is_last, constant(1.0), n179);
        let n187 = select_(is_last, constant(1.0), div(n173, n174));
        let n188 = select_(is_last, constant(1.0), mul(last_in_tight, n177));
        let n189 = select_(is_last, constant(0.0), add(last_in_slack, mul(last_in_tight, n179)));
        let n190 = select_(is_last, constant(0.0), mul(add(constant(1.0), sum_tight), n177));
        let n191 = tight[place_1];
        let n192 = short[place_1];
        let n193 = meshed_own[place_1];
        let n194 = meshed_tight[place_1];
        let n202 = sub(add(add(free_stretch, add(lost, mul(land_ratio, n192))), mul(lifted_out, n187)), lifted_apart);
        let n204 = mul(lifted_out, n185);
        let t_star_tight = select_(
            after_first,
            div(mul(select_(sub(constant(f32(place_1)), constant(1.5)), land_ratio, tight_cosine), n191), n202),
            constant(1.0),
        );
        let t_star_slack = select_(after_first, div(n204, n202), constant(0.0));
        let n209 = mul(lifted_in, n188);
        let n216 = add(n209, mul(free_stretch, n190));
        let n218 = mul(t_star_tight, n216);
        let n220 = add(mul(t_star_slack, n216), neg(n204));
        let n221 = div(n218, lifted_flank);
        let n222 = div(n220, lifted_flank);
        let n225 = add(n218, mul(t_star_tight, free_stretch));
        let n226 = add(n220, mul(t_star_slack, free_stretch));
        set_inward_tight(place_1, add(mul(add(mul(n142, n144), n134), inwards), mul(load_tight, load_inwards)));
        set_inward_slack(place_1, add(mul(add(mul(n143, n144), n135), inwards), mul(load_slack, load_inwards)));
        set_star_tight(place_1, t_star_tight);
        set_star_slack(place_1, t_star_slack);
        set_first_tight(
            place_1,
            select_(after_first, div(add(n225, mul(add(mul(t_star_tight, n193), n194), stretch)), flank), n221),
        );
        set_first_slack(
            place_1,
            select_(after_first, div(add(n226, mul(mul(t_star_slack, n193), stretch)), flank), n222),
        );
        set_own_tight(place_1, n221);
        set_own_slack(place_1, n222);
        set_before_tight(place_1, select_(after_first, div(n225, flank), n221));
        set_before_slack(place_1, select_(after_first, div(n226, flank), n222));
        set_last_tight(place_1, div(mul(t_star_tight, n209), lifted_flank));
        set_last_slack(
            place_1,
            div(add(mul(t_star_slack, n209), mul(lifted_in, sub(n189, out_per_in))), lifted_flank),
        );
        let next_1_5 = select_(is_last, load_tight, last_load_tight);
        let next_1_6 = select_(is_last, load_slack, last_load_slack);
        tension_tight = n142;
        tension_slack = n143;
        behind = force;
        first_load_tight_1 = load_tight;
        first_load_slack_1 = load_slack;
        last_load_tight = next_1_5;
        last_load_slack = next_1_6;
        sigma = n185;
        short_behind = n187;
        last_in_tight = n188;
        last_in_slack = n189;
        sum_tight = n190;
    }
    // A driver that ends long loops must not make a part of the iterations look like all of them.
    let whole_1 = left_1 <= 0u;
    let peak_complete_tight = if_known(whole_1, first_load_tight_1);
    let peak_complete_slack = if_known(whole_1, first_load_slack_1);
    let n258 = if_known(whole_1, last_load_tight);
    let n259 = if_known(whole_1, last_load_slack);
    set_star_tight(min(whole(i.teeth_in_mesh), 60u), constant(0.0));
    set_star_slack(min(whole(i.teeth_in_mesh), 60u), constant(0.0));
    set_first_tight(min(whole(i.teeth_in_mesh), 60u), peak_complete_tight);
    set_first_slack(min(whole(i.teeth_in_mesh), 60u), peak_complete_slack);
    set_own_tight(min(whole(i.teeth_in_mesh), 60u), peak_complete_tight);
    set_own_slack(min(whole(i.teeth_in_mesh), 60u), peak_complete_slack);
    set_before_tight(min(whole(i.teeth_in_mesh), 60u), n258);
    set_before_slack(min(whole(i.teeth_in_mesh), 60u), n259);
    set_last_tight(min(whole(i.teeth_in_mesh), 60u), n258);
    set_last_slack(min(whole(i.teeth_in_mesh), 60u), n259);
    let mass = select_(
        i.pitch_mass,
        i.pitch_mass,
        add(
            mul(i.rubber_density, mul(add(i.tooth_area, i.land_area), i.belt_width)),
            mul(i.cord_density, mul(i.gross_cord_area, i.pitch)),
        ),
    ); // (20)
    var p: Prepared;
    p.teeth = i.teeth_in_mesh;
    p.mass_radius = mul(mass, i.tip_radius);
    p.peak_complete_tight = peak_complete_tight;
    p.peak_complete_slack = peak_complete_slack;
    p.lift_margin = select_(i.lift_angle, sub(i.space_half_angle, i.lift_angle), constant(1.0));
    p.wrap_margin = sub(
        Real(3.1415927, 8.7422784e-8),
        mul(i.teeth_in_mesh, add(i.land_half_angle, i.space_half_angle)),
    );
    p.pitch_radius = add(i.tip_radius, i.pitch_line);
    p.pitch_mass = mass;
    return p;
}

fn conditions(p: Prepared, i: Inputs) -> array<Real, CONDITIONS> {
    let end_0 = min(whole(p.teeth), 60u);
    var least = select_(
        p.teeth,
        add(mul(i.tight_tension, inward_tight(p, 0u)), mul(i.slack_tension, inward_slack(p, 0u))),
        constant(0.0),
    );
    var place_0 = 1u;
    for (; place_0 < end_0; place_0++) {
        let n18 = inward_tight(p, place_0);
        let n19 = inward_slack(p, place_0);
        least = min_(least, add(mul(i.tight_tension, n18), mul(i.slack_tension, n19)));
    }
    // A driver that ends long loops must not make a part of the iterations look like all of them.
    let whole_0 = place_0 >= end_0;
    let n24 = if_known(whole_0, least);
    var margins: array<Real, CONDITIONS>;
    margins[0] = sub(i.tight_tension, i.slack_tension);
    margins[1] = p.lift_margin;
    margins[2] = p.wrap_margin;
    margins[3] = sub(mul(p.mass_radius, square(i.pulley_speed)), n24);
    return margins;
}

fn finish(p: Prepared, i: Inputs) -> Outputs {
    let centrifugal_force = mul(p.mass_radius, square(i.pulley_speed));
    let effective_tension = sub(i.tight_tension, i.slack_tension);
    let end_0 = min(whole(p.teeth), 60u);
    var least = select_(
        p.teeth,
        add(mul(i.tight_tension, inward_tight(p, 0u)), mul(i.slack_tension, inward_slack(p, 0u))),
        constant(0.0),
    );
    var place_0 = 1u;
    for (; place_0 < end_0; place_0++) {
        let n37 = inward_tight(p, place_0);
        let n38 = inward_slack(p, place_0);
        least = min_(least, add(mul(i.tight_tension, n37), mul(i.slack_tension, n38)));
    }
    // A driver that ends long loops must not make a part of the iterations look like all of them.
    let whole_0 = place_0 >= end_0;
    let n43 = if_known(whole_0, least);
    let n47 = plus_whole(p.teeth, constant(1.0));
    let end_1 = min(whole(p.teeth), 60u);
    var meshes = select_(p.teeth, constant(1.0), constant(0.0));
    var counted = constant(1.0);
    var before = constant(0.0);
    var at = constant(1.0);
    var place_1 = 0u;
    for (; place_1 < end_1; place_1++) {
        let n53 = sub(meshes, constant(0.5));
        let n54 = inward_tight(p, place_1);
        let n55 = inward_slack(p, place_1);
        let n59 = sub(add(mul(i.tight_tension, n54), mul(i.slack_tension, n55)), centrifugal_force);
        let n60 = select_(n59, meshes, constant(0.0));
        let next_1_1 = plus_whole(counted, n60);
        let next_1_2 = select_(n53, at, before);
        let next_1_3 = select_(n53, n59, at);
        meshes = n60;
        counted = next_1_1;
        before = next_1_2;
        at = next_1_3;
        if is_zero(meshes) { break; }
    }
    // A driver that ends long loops must not make a part of the iterations look like all of them.
    let whole_1 = (place_1 >= end_1) | is_zero(meshes);
    let n64 = if_known(whole_1, meshes);
    let n65 = if_known(whole_1, counted);
    let n66 = if_known(whole_1, before);
    let n67 = if_known(whole_1, at);
    let boundary_tooth = min_(n65, n47);
    let at_boundary = plus_whole(boundary_tooth, constant(-1.0));
    let n82 = if_known(at_boundary.bound == 0.0, star_tight(p, whole(at_boundary)));
    let n83 = if_known(at_boundary.bound == 0.0, star_slack(p, whole(at_boundary)));
    let n87 = if_known(at_boundary.bound == 0.0, first_tight(p, whole(at_boundary)));
    let n88 = if_known(at_boundary.bound == 0.0, first_slack(p, whole(at_boundary)));
    let n92 = if_known(at_boundary.bound == 0.0, own_tight(p, whole(at_boundary)));
    let n93 = if_known(at_boundary.bound == 0.0, own_slack(p, whole(at_boundary)));
    let n98 = if_known(at_boundary.bound == 0.0, before_tight(p, whole(at_boundary)));
    let n99 = if_known(at_boundary.bound == 0.0, before_slack(p, whole(at_boundary)));
    let n103 = if_known(at_boundary.bound == 0.0, last_tight(p, whole(at_boundary)));
    let n104 = if_known(at_boundary.bound == 0.0, last_slack(p, whole(at_boundary)));
    let n110 = sub(i.centrifugal_land_friction, constant(0.5));
    var out: Outputs;
    out.centrifugal_force = centrifugal_force; // m r omega^2
    out.boundary_tooth = boundary_tooth; // steps (3), (4)
    out.boundary_position = select_(
        sub(n64, constant(0.5)),
        boundary_tooth,
        select_(
            sub(boundary_tooth, constant(1.5)),
            add(sub(boundary_tooth, constant(1.0)), div(n66, sub(n66, n67))),
            constant(1.0),
        ),
    ); // steps (3), (4), interpolated
    out.incomplete_teeth = plus_whole(n47, neg(boundary_tooth)); // N + 2 - j
    out.lift_speed = sqrt_(div(max_(n43, constant(0.0)), p.mass_radius)); // inward force = m r omega^2
    out.boundary_tension = select_(
        n110,
        Real(0.0, infinity()),
        add(mul(i.tight_tension, n82), mul(i.slack_tension, n83)),
    ); // (19)
    out.peak_tooth_load = select_(
        n110,
        Real(0.0, infinity()),
        max_(
            add(mul(i.tight_tension, n87), mul(i.slack_tension, n88)),
            add(mul(i.tight_tension, n92), mul(i.slack_tension, n93)),
        ),
    ); // (8), (14)
    out.peak_tooth_load_complete = add(
        mul(i.tight_tension, p.peak_complete_tight),
        mul(i.slack_tension, p.peak_complete_slack),
    ); // (8)
    out.least_tooth_load = select_(
        n110,
        Real(0.0, infinity()),
        min_(
            add(mul(i.tight_tension, n98), mul(i.slack_tension, n99)),
            add(mul(i.tight_tension, n103), mul(i.slack_tension, n104)),
        ),
    ); // (8), (14)
    out.effective_tension = effective_tension; // T_t - T_s
    out.torque = mul(effective_tension, p.pitch_radius); // P (r + a)
    out.pitch_mass_used = p.pitch_mass; // (20)
    return out;
}
