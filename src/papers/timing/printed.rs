//! The boundary tension by the paper's closed form.

use super::Inputs;

/// Angle at which the belt leaves tooth j - 1, the last that meshes.
#[derive(Clone, Copy)]
pub(super) enum BoundaryAngle {
    /// phi - theta, as a lifted tooth: printed in (17).
    Lifted,
    /// phi, as every tooth that meshes.
    Meshed,
    /// psi, as the last tooth of all: printed in nu of (9), which (19) takes over.
    SlackSpan,
}

/// T* of (19), N, with the angle of tooth j - 1 in (17), and in the nu that (19) takes from (9). With phi in both places it is the
/// direct solution of the system. For a first lifted tooth j from 3 to N + 1.
pub(super) fn boundary_tension(pulley: &Inputs, j: usize, last: BoundaryAngle, in_nu: BoundaryAngle) -> f64 {
    let angle = |name: &str| pulley.input(name).to_radians();
    let (beta, phi) = (angle("land_half_angle_deg"), angle("space_half_angle_deg"));
    // The default lifts by the whole tooth space.
    let theta = phi;
    let friction = pulley.input("friction");
    let land_ratio = libm::exp(-2.0 * friction * beta);
    // N, mm: f in mm/N, A E in N.
    let compliance = pulley.input("tooth_compliance_um_per_N") / 1000.0;
    let stiffness = 1000.0 * pulley.input("cord_modulus_GPa") * pulley.input("cord_area_mm2");
    let (radius, tooth_length) = (pulley.input("tip_radius_mm"), pulley.input("tooth_length_mm"));
    let stretch = (radius * (1.0 - land_ratio) / friction + tooth_length) / stiffness;
    let free_stretch = (2.0 * beta * radius + tooth_length) / stiffness;
    let (opening, closing, meshed) = (libm::cos(phi + theta), libm::cos(phi - theta), libm::cos(phi));

    // (9) with N + 1 replaced by j - 1.
    let (a, c) = (compliance * land_ratio * meshed, compliance * meshed);
    let before = Powers::new(a, a + c + stretch, c);
    // (15): its N is the whole mesh's.
    let (u, v) = (compliance * opening, compliance * closing);
    let behind = Powers::new(u, free_stretch + u + v, v);
    let gaps = pulley.input("teeth_in_mesh") as i32 - 1;
    let j = j as i32;
    let (of_tight, of_star) = before.pair(1, j - 2, j - 2);
    let (of_boundary, of_slack) = behind.pair(j, gaps, j);
    let tight = compliance * libm::cos(angle("tight_span_angle_deg")) * pulley.input("tight_tension_N");
    let cosine = |at: BoundaryAngle| match at {
        BoundaryAngle::Lifted => closing,
        BoundaryAngle::Meshed => meshed,
        BoundaryAngle::SlackSpan => libm::cos(angle("slack_span_angle_deg")),
    };
    let nu = compliance * cosine(in_nu);
    let numerator = compliance * (closing * v * of_slack * pulley.input("slack_tension_N") + land_ratio * meshed * of_tight * tight);
    numerator / (free_stretch + compliance * (cosine(last) - closing * u * of_boundary + opening - land_ratio * meshed * nu * of_star))
}

/// Solutions of `first T(i-1) - middle T(i) + last T(i+1) = 0` as powers of two roots.
struct Powers {
    first: f64,
    middle: f64,
    last: f64,
    roots: [f64; 2],
}

impl Powers {
    fn new(first: f64, middle: f64, last: f64) -> Self {
        let spread = (middle * middle - 4.0 * first * last).sqrt();
        Self { first, middle, last, roots: [1.0, -1.0].map(|sign| (middle + sign * spread) / (2.0 * last)) }
    }

    /// X and Y at `at`, of rows `from` to `to`: what a unit in the first and in the last row makes there.
    fn pair(&self, from: i32, to: i32, at: i32) -> (f64, f64) {
        // The standard library's power may round otherwise on another machine.
        let power = |root: f64, exponent: i32| (0..exponent).fold(1.0, |product, _| product * root);
        let start = self.roots.map(|root| self.middle * power(root, from) - self.last * power(root, from + 1));
        let end = self.roots.map(|root| self.first * power(root, to - 1) - self.middle * power(root, to));
        let [one, two] = self.roots.map(|root| power(root, at));
        let both = start[1] * end[0] - start[0] * end[1];
        ((end[0] * two - end[1] * one) / both, (start[0] * two - start[1] * one) / both)
    }
}
