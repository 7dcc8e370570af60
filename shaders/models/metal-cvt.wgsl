// Metal push-belt variator: the twin of src/models/metal_cvt.rs.

fn drive(i: Inputs) -> Drive {
    return Drive(
        i.friction,
        i.groove_angle,
        i.ratio,
        i.belt_length,
        i.centre_distance,
        i.band_width,
        i.band_thickness,
        twice(i.band_count),
        i.elastic_modulus,
        i.strength,
        i.traction,
        i.torque,
    );
}

fn prepare(inputs: Inputs) -> Prepared {
    return prepare_belt(drive(inputs));
}

fn conditions(prepared: Prepared, inputs: Inputs) -> array<Real, CONDITIONS> {
    return belt_conditions(prepared, drive(inputs));
}

fn finish(prepared: Prepared, inputs: Inputs) -> Outputs {
    return finish_belt(prepared, drive(inputs));
}
