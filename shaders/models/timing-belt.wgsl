// Generated from src/models/timing_belt.rs by shaders/write.

fn prepare(i: Inputs) -> Prepared {
    let lift = select_(i.lift_angle, i.lift_angle, i.space_half_angle);
    let around = max_(mul(twice(i.friction), i.land_half_angle), Real(1e-30, 3.171078e-39));
    let lost = neg(exp_m1_(neg(around)));
    let land = mul(twice(i.land_half_angle), i.tip_radius);
    let meshed = cos_(i.space_half_angle);
    let rigidity = mul(mul(mul(i.cord_modulus, i.cord_area), i.tooth_compliance), meshed);
    let n43 = cos_(i.pressure_angle);
    let n44 = add(i.pressure_angle, lift);
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
    let flank = div(n43, meshed);
    let lifted_flank = div(add(cos_(n44), mul(i.friction, sin_(n44))), meshed);
    let inwards = sin_(add(i.space_half_angle, i.land_half_angle));
    let load_inwards = sub(mul(i.friction, n43), sin_(i.pressure_angle));
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
        let n90 = add(stretch, mul(land_ratio, short_before));
        let n91 = add(constant(1.0), n90);
        let n92 = div(constant(1.0), n91);
        let n98 = mul(
            mul(select_(sub(constant(1.5), constant(f32(place_0))), tight_cosine, land_ratio), tight_before),
            n92,
        );
        let n99 = div(n90, n91);
        let n100 = add(own, constant(1.0));
        let n101 = mul(n100, n92);
        let n103 = add(mul(n100, n98), of_tight);
        after[place_0 + 1u] = n92;
        tight[place_0 + 1u] = n98;
        short[place_0 + 1u] = n99;
        meshed_own[place_0 + 1u] = n101;
        meshed_tight[place_0 + 1u] = n103;
        tight_before = n98;
        short_before = n99;
        own = n101;
        of_tight = n103;
    }
    let n167 = div(tight_cosine, lifted_in);
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
        let n124 = after[place_1 + 1u];
        let n125 = tight[place_1 + 1u];
        let n126 = select_(is_last, constant(0.0), tension_tight);
        let n127 = select_(is_last, constant(1.0), tension_slack);
        let n134 = select_(after_first, select_(is_last, n125, add(mul(n124, n126), n125)), constant(1.0));
        let n135 = select_(after_first, select_(is_last, mul(slack_cosine, n124), mul(n124, n127)), constant(0.0));
        let n136 = select_(after_first, land_ratio, constant(1.0));
        let force = select_(
            is_last,
            mul(select_(after_first, land_ratio, tight_cosine), n134),
            add(behind, mul(stretch, n126)),
        );
        let n143 = short[place_1 + 1u];
        let load_tight = div(force, flank);
        let load_slack = div(
            neg(
                mul(
                    mul(select_(is_last, slack_cosine, constant(1.0)), n127),
                    select_(after_first, add(mul(lost, n124), n143), constant(1.0)),
                ),
            ),
            flank,
        );
        let n165 = add(stretch_per_in, mul(out_per_in, short_behind));
        let n166 = add(constant(1.0), n165);
        let n169 = div(select_(after_first, constant(1.0), n167), n166);
        let n171 = div(mul(out_per_in, sigma), n166);
        let n177 = select_(is_last, constant(1.0), n171);
        let n179 = select_(is_last, constant(1.0), div(n165, n166));
        let n180 = select_(is_last, constant(1.0), mul(last_in_tight, n169));
        let n181 = select_(is_last, constant(0.0), add(last_in_slack, mul(last_in_tight, n171)));
        let n182 = select_(is_last, constant(0.0), mul(add(constant(1.0), sum_tight), n169));
        let n183 = tight[place_1];
        let n184 = short[place_1];
        let n185 = meshed_own[place_1];
        let n186 = meshed_tight[place_1];
        let n194 = sub(add(add(free_stretch, add(lost, mul(land_ratio, n184))), mul(lifted_out, n179)), lifted_apart);
        let n196 = mul(lifted_out, n177);
        let t_star_tight = select_(
            after_first,
            div(mul(select_(sub(constant(f32(place_1)), constant(1.5)), land_ratio, tight_cosine), n183), n194),
            constant(1.0),
        );
        let t_star_slack = select_(after_first, div(n196, n194), constant(0.0));
        let n201 = mul(lifted_in, n180);
        let n208 = add(n201, mul(free_stretch, n182));
        let n210 = mul(t_star_tight, n208);
        let n212 = add(mul(t_star_slack, n208), neg(n196));
        let n213 = div(n210, lifted_flank);
        let n214 = div(n212, lifted_flank);
        let n217 = add(n210, mul(t_star_tight, free_stretch));
        let n218 = add(n212, mul(t_star_slack, free_stretch));
        set_inward_tight(place_1, add(mul(add(mul(n134, n136), n126), inwards), mul(load_tight, load_inwards)));
        set_inward_slack(place_1, add(mul(add(mul(n135, n136), n127), inwards), mul(load_slack, load_inwards)));
        set_star_tight(place_1, t_star_tight);
        set_star_slack(place_1, t_star_slack);
        set_first_tight(
            place_1,
            select_(after_first, div(add(n217, mul(add(mul(t_star_tight, n185), n186), stretch)), flank), n213),
        );
        set_first_slack(
            place_1,
            select_(after_first, div(add(n218, mul(mul(t_star_slack, n185), stretch)), flank), n214),
        );
        set_own_tight(place_1, n213);
        set_own_slack(place_1, n214);
        set_before_tight(place_1, select_(after_first, div(n217, flank), n213));
        set_before_slack(place_1, select_(after_first, div(n218, flank), n214));
        set_last_tight(place_1, div(mul(t_star_tight, n201), lifted_flank));
        set_last_slack(
            place_1,
            div(add(mul(t_star_slack, n201), mul(lifted_in, sub(n181, out_per_in))), lifted_flank),
        );
        let next_1_5 = select_(is_last, load_tight, last_load_tight);
        let next_1_6 = select_(is_last, load_slack, last_load_slack);
        tension_tight = n134;
        tension_slack = n135;
        behind = force;
        first_load_tight_1 = load_tight;
        first_load_slack_1 = load_slack;
        last_load_tight = next_1_5;
        last_load_slack = next_1_6;
        sigma = n177;
        short_behind = n179;
        last_in_tight = n180;
        last_in_slack = n181;
        sum_tight = n182;
    }
    // A driver that ends long loops must not make a part of the iterations look like all of them.
    let whole_1 = left_1 <= 0u;
    let peak_complete_tight = if_known(whole_1, first_load_tight_1);
    let peak_complete_slack = if_known(whole_1, first_load_slack_1);
    let n250 = if_known(whole_1, last_load_tight);
    let n251 = if_known(whole_1, last_load_slack);
    set_star_tight(whole(i.teeth_in_mesh), constant(0.0));
    set_star_slack(whole(i.teeth_in_mesh), constant(0.0));
    set_first_tight(whole(i.teeth_in_mesh), peak_complete_tight);
    set_first_slack(whole(i.teeth_in_mesh), peak_complete_slack);
    set_own_tight(whole(i.teeth_in_mesh), peak_complete_tight);
    set_own_slack(whole(i.teeth_in_mesh), peak_complete_slack);
    set_before_tight(whole(i.teeth_in_mesh), n250);
    set_before_slack(whole(i.teeth_in_mesh), n251);
    set_last_tight(whole(i.teeth_in_mesh), n250);
    set_last_slack(whole(i.teeth_in_mesh), n251);
    var p: Prepared;
    p.teeth = i.teeth_in_mesh;
    p.mass_radius = mul(i.pitch_mass, i.tip_radius);
    p.peak_complete_tight = peak_complete_tight;
    p.peak_complete_slack = peak_complete_slack;
    p.lift_margin = select_(i.lift_angle, sub(i.space_half_angle, i.lift_angle), constant(1.0));
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
        let n17 = inward_tight(p, place_0);
        let n18 = inward_slack(p, place_0);
        least = min_(least, add(mul(i.tight_tension, n17), mul(i.slack_tension, n18)));
    }
    // A driver that ends long loops must not make a part of the iterations look like all of them.
    let whole_0 = place_0 >= end_0;
    let n23 = if_known(whole_0, least);
    var margins: array<Real, CONDITIONS>;
    margins[0] = sub(i.tight_tension, i.slack_tension);
    margins[1] = p.lift_margin;
    margins[2] = sub(mul(p.mass_radius, square(i.pulley_speed)), n23);
    return margins;
}

fn finish(p: Prepared, i: Inputs) -> Outputs {
    let centrifugal_force = mul(p.mass_radius, square(i.pulley_speed));
    let end_0 = min(whole(p.teeth), 60u);
    var least = select_(
        p.teeth,
        add(mul(i.tight_tension, inward_tight(p, 0u)), mul(i.slack_tension, inward_slack(p, 0u))),
        constant(0.0),
    );
    var place_0 = 1u;
    for (; place_0 < end_0; place_0++) {
        let n34 = inward_tight(p, place_0);
        let n35 = inward_slack(p, place_0);
        least = min_(least, add(mul(i.tight_tension, n34), mul(i.slack_tension, n35)));
    }
    // A driver that ends long loops must not make a part of the iterations look like all of them.
    let whole_0 = place_0 >= end_0;
    let n40 = if_known(whole_0, least);
    let n44 = plus_whole(p.teeth, constant(1.0));
    let end_1 = min(whole(p.teeth), 60u);
    var meshes = select_(p.teeth, constant(1.0), constant(0.0));
    var counted = constant(1.0);
    var before = constant(0.0);
    var at = constant(1.0);
    var place_1 = 0u;
    for (; place_1 < end_1; place_1++) {
        let n50 = sub(meshes, constant(0.5));
        let n51 = inward_tight(p, place_1);
        let n52 = inward_slack(p, place_1);
        let n56 = sub(add(mul(i.tight_tension, n51), mul(i.slack_tension, n52)), centrifugal_force);
        let n57 = select_(n56, meshes, constant(0.0));
        let next_1_1 = plus_whole(counted, n57);
        let next_1_2 = select_(n50, at, before);
        let next_1_3 = select_(n50, n56, at);
        meshes = n57;
        counted = next_1_1;
        before = next_1_2;
        at = next_1_3;
        if is_zero(meshes) { break; }
    }
    // A driver that ends long loops must not make a part of the iterations look like all of them.
    let whole_1 = (place_1 >= end_1) | is_zero(meshes);
    let n61 = if_known(whole_1, meshes);
    let n62 = if_known(whole_1, counted);
    let n63 = if_known(whole_1, before);
    let n64 = if_known(whole_1, at);
    let boundary_tooth = min_(n62, n44);
    let at_boundary = plus_whole(boundary_tooth, constant(-1.0));
    let n79 = if_known(at_boundary.bound == 0.0, star_tight(p, whole(at_boundary)));
    let n80 = if_known(at_boundary.bound == 0.0, star_slack(p, whole(at_boundary)));
    let n84 = if_known(at_boundary.bound == 0.0, first_tight(p, whole(at_boundary)));
    let n85 = if_known(at_boundary.bound == 0.0, first_slack(p, whole(at_boundary)));
    let n89 = if_known(at_boundary.bound == 0.0, own_tight(p, whole(at_boundary)));
    let n90 = if_known(at_boundary.bound == 0.0, own_slack(p, whole(at_boundary)));
    let n95 = if_known(at_boundary.bound == 0.0, before_tight(p, whole(at_boundary)));
    let n96 = if_known(at_boundary.bound == 0.0, before_slack(p, whole(at_boundary)));
    let n100 = if_known(at_boundary.bound == 0.0, last_tight(p, whole(at_boundary)));
    let n101 = if_known(at_boundary.bound == 0.0, last_slack(p, whole(at_boundary)));
    let n107 = sub(i.centrifugal_land_friction, constant(0.5));
    var out: Outputs;
    out.centrifugal_force = centrifugal_force; // m r omega^2
    out.boundary_tooth = boundary_tooth; // steps (3), (4)
    out.boundary_position = select_(
        sub(n61, constant(0.5)),
        boundary_tooth,
        select_(
            sub(boundary_tooth, constant(1.5)),
            add(sub(boundary_tooth, constant(1.0)), div(n63, sub(n63, n64))),
            constant(1.0),
        ),
    ); // steps (3), (4), interpolated
    out.incomplete_teeth = plus_whole(n44, neg(boundary_tooth)); // N + 2 - j
    out.lift_speed = sqrt_(div(max_(n40, constant(0.0)), p.mass_radius)); // inward force = m r omega^2
    out.boundary_tension = select_(
        n107,
        Real(0.0, infinity()),
        add(mul(i.tight_tension, n79), mul(i.slack_tension, n80)),
    ); // (19)
    out.peak_tooth_load = select_(
        n107,
        Real(0.0, infinity()),
        max_(
            add(mul(i.tight_tension, n84), mul(i.slack_tension, n85)),
            add(mul(i.tight_tension, n89), mul(i.slack_tension, n90)),
        ),
    ); // (8), (14)
    out.peak_tooth_load_complete = add(
        mul(i.tight_tension, p.peak_complete_tight),
        mul(i.slack_tension, p.peak_complete_slack),
    ); // (8)
    out.least_tooth_load = select_(
        n107,
        Real(0.0, infinity()),
        min_(
            add(mul(i.tight_tension, n95), mul(i.slack_tension, n96)),
            add(mul(i.tight_tension, n100), mul(i.slack_tension, n101)),
        ),
    ); // (8), (14)
    out.effective_tension = sub(i.tight_tension, i.slack_tension); // T_t - T_s
    return out;
}
