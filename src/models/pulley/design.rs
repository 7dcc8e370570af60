//! From inputs to a section, its loads and its strength.

use super::table::{ANGLE_WORST, Inputs, POINT_NONE, TORQUE};
use crate::models::formula::INPUTS;
use crate::models::pulley_load::{self, WrapLoad};
use crate::pulley::loads::clamp_pressure;
use crate::pulley::section::{Dimensions, Fineness, Kind};
use crate::pulley::turn::{Case, Strength};
use crate::units::{MEGAPASCAL, MILLIMETRE, NEWTON_PER_MILLIMETRE};

/// A pulley: its section and how it is loaded and how strong it is, in mm, N, MPa and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// Type of the section.
    pub kind: Kind,
    /// Its dimensions.
    pub dimensions: Dimensions,
    /// Poisson's ratio.
    pub poisson: f64,
    /// How fine it is meshed.
    pub fineness: Fineness,
    /// Its loads.
    pub case: Case,
    /// Yield strength, MPa.
    pub yield_strength: f64,
    /// Strength against fatigue.
    pub strength: Strength,
    /// Density, kg/m^3.
    pub density: f64,
    /// Places (z, r) whose stress is asked for, mm.
    pub own_points: [Option<(f64, f64)>; 2],
}

impl Design {
    /// Reads inputs in SI units.
    pub(crate) fn new(si: &[f64; INPUTS]) -> Self {
        let (dimensions, load) = (dimensions(si), pulley_load::wrap_load(si));
        Self::under(si, dimensions, &load)
    }

    fn under(si: &[f64; INPUTS], dimensions: Dimensions, load: &WrapLoad) -> Self {
        let i = Inputs::read(si);
        let (sine, cosine) = (libm::sin(i.friction_direction), libm::cos(i.friction_direction));
        let tensile = MEGAPASCAL.from_si(i.tensile_strength);
        let endurance =
            if i.endurance_limit == super::table::FROM_TENSILE { 0.33 * tensile } else { MEGAPASCAL.from_si(i.endurance_limit) };
        let point = |r: f64, z: f64| (r != POINT_NONE).then(|| (MILLIMETRE.from_si(z), MILLIMETRE.from_si(r)));
        Self {
            kind: kind(si),
            poisson: i.poisson_ratio,
            fineness: if i.accuracy == super::table::FINE { Fineness::FINE } else { Fineness::USUAL },
            case: Case {
                // R(0) R_b / L: per length of the band and angle.
                normal: NEWTON_PER_MILLIMETRE.from_si(load.flank_force) * dimensions.mean_radius / dimensions.band_length(),
                along: load.friction_used * sine,
                around: load.friction_used * cosine,
                growth: load.effective_friction,
                wrap: i.wrap_angle,
                pressure: clamp_pressure(&dimensions, clamp_force(&i)),
                phase: (i.bolt_angle != ANGLE_WORST).then_some(i.bolt_angle),
                // kg/m^3 is 1e-12 t/mm^3.
                spin: i.density * 1e-12 * i.speed * i.speed,
                modulus: MEGAPASCAL.from_si(i.elastic_modulus),
            },
            yield_strength: MEGAPASCAL.from_si(i.yield_strength),
            strength: Strength { endurance, tensile },
            density: i.density,
            own_points: [point(i.point_1_r, i.point_1_z), point(i.point_2_r, i.point_2_z)],
            dimensions,
        }
    }
}

/// Type of the section.
pub(crate) fn kind(si: &[f64; INPUTS]) -> Kind {
    Kind::ALL[(Inputs::read(si).section as usize).clamp(1, Kind::ALL.len()) - 1]
}

/// Dimensions in mm and rad.
pub(crate) fn dimensions(si: &[f64; INPUTS]) -> Dimensions {
    let i = Inputs::read(si);
    let mm = |value| MILLIMETRE.from_si(value);
    let radius = |diameter: f64| 0.5 * MILLIMETRE.from_si(diameter);
    Dimensions {
        thickness: mm(i.thickness),
        bore_radius: radius(i.bore_diameter),
        mean_radius: mm(i.mean_radius),
        half_angle: 0.5 * i.groove_angle,
        groove_count: i.groove_count,
        groove_width: mm(i.groove_width),
        groove_height: mm(i.groove_height),
        floor_depth: mm(i.floor_depth),
        rim_height: mm(i.rim_height),
        contact_height: mm(i.contact_height),
        floor_bend_radius: mm(i.floor_bend_radius),
        hub_bend_radius: mm(i.hub_bend_radius),
        web_bend_radius: mm(i.web_bend_radius),
        fold_radius: mm(i.fold_radius),
        cup_radius: radius(i.cup_diameter),
        wall_radius: radius(i.wall_diameter),
        wall_offset: mm(i.wall_offset),
        ridge_width: mm(i.ridge_width),
        weld_radius: radius(i.weld_diameter),
        wall_thickness: mm(i.wall_thickness),
        rim_thickness: mm(i.rim_thickness),
        lip_thickness: mm(i.lip_thickness),
        fillet_radius: mm(i.fillet_radius),
        groove_offset: mm(i.groove_offset),
        bracket_radius: radius(i.bracket_diameter),
        bolt_count: i.bolt_count,
        bolt_circle_radius: radius(i.bolt_circle),
        bolt_head_radius: radius(i.bolt_head),
        bolt_hole_radius: radius(i.bolt_hole),
    }
}

/// Force of one bolt, N: as given, or what its tightening torque makes of it,
/// `M = F/2 (p/pi + mu d2/cos 30 deg + mu D_w)` with the mean diameter `D_w` of the head's annulus.
pub(crate) fn clamp_force(i: &Inputs<f64>) -> f64 {
    if i.clamp_force != TORQUE {
        return i.clamp_force;
    }
    let (outer, inner) = (i.bolt_head, i.bolt_hole);
    let under_head = 2.0 / 3.0 * (outer * outer * outer - inner * inner * inner) / (outer * outer - inner * inner);
    let thread = i.bolt_pitch_diameter / libm::cos(std::f64::consts::PI / 6.0);
    2.0 * i.tightening_torque / (i.bolt_pitch / std::f64::consts::PI + i.bolt_friction * (thread + under_head))
}
