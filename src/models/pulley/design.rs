//! From inputs to a section, its loads and its strength.
//!
//! All of it is arithmetic over any number type, in groups by who is told of it: the first stage is told of the [`Body`] only, what
//! computes the stresses of the [`Pressing`] besides. So what depends on what need not be listed: it is read off the groups.

use super::fields::{ANGLE_WORST, FINE, Inputs, POINT_NONE};
use crate::models::pulley_load;
use crate::pulley::Design;
use crate::pulley::loads::clamp_pressure;
use crate::pulley::section::{Dimensions, Fineness, SectionKind};
use crate::pulley::turn::{Case, Strength};
use crate::real::Real;
use crate::units::{MEGAPASCAL, MILLIMETRE, NEWTON_PER_MILLIMETRE, Unit};

/// All that the first stage is told: the section and how fine it is solved. Dimensions that the type does not read are zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body<R> {
    section: R,
    accuracy: R,
    /// Dimensions in mm and rad.
    pub dimensions: Dimensions<R>,
    /// Poisson's ratio.
    pub poisson: R,
}

impl<R: Real> Body<R> {
    /// Of inputs in SI units whose section is of this type.
    pub fn new(si: &[R], kind: SectionKind) -> Self {
        let i = Inputs::read(si);
        let dimensions = dimensions(si).of_kind(kind, R::constant(0.0));
        Self { section: i.section, accuracy: i.accuracy, dimensions, poisson: i.poisson_ratio }
    }

    /// All its numbers.
    pub fn numbers(&self) -> impl Iterator<Item = R> {
        let Self { section, accuracy, dimensions, poisson } = *self;
        dimensions.entries().into_iter().map(|(_, value)| value).chain([section, accuracy, poisson])
    }
}

impl Body<f64> {
    /// Type of the section.
    pub fn kind(&self) -> SectionKind {
        kind_of(self.section)
    }

    /// How fine it is solved.
    pub fn fineness(&self) -> Fineness {
        if self.accuracy == FINE { Fineness::FINE } else { Fineness::USUAL }
    }
}

/// All that what computes the stresses is told beside the section's answers, in mm, N, MPa and rad.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pressing<R> {
    normal: R,
    along: R,
    around: R,
    growth: R,
    wrap: R,
    /// Pressure under the bolt heads.
    pub pressure: R,
    bolt_angle: R,
    spin: R,
}

impl<R: Real> Pressing<R> {
    /// All its numbers.
    pub fn numbers(&self) -> [R; 8] {
        let Self { normal, along, around, growth, wrap, pressure, bolt_angle, spin } = *self;
        [normal, along, around, growth, wrap, pressure, bolt_angle, spin]
    }
}

impl Pressing<f64> {
    /// The load case on a material of this elastic modulus.
    pub fn case(&self, modulus: f64) -> Case {
        let Self { normal, along, around, growth, wrap, pressure, bolt_angle, spin } = *self;
        Case { normal, along, around, growth, wrap, pressure, phase: (bolt_angle != ANGLE_WORST).then_some(bolt_angle), spin, modulus }
    }
}

/// All that the second stage is told.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loading<R> {
    /// Margins of the belt's conditions.
    pub margins: [R; pulley_load::CONDITIONS],
    /// Torque on the pulley, N m.
    pub torque: R,
    /// What the stresses come from.
    pub pressing: Pressing<R>,
    /// Elastic modulus, MPa.
    pub modulus: R,
    /// Yield strength, MPa.
    pub yield_strength: R,
    /// Preload stress of a bolt over its proof strength.
    pub bolt_utilisation: R,
    /// Torque that friction under the bolts holds, N m.
    pub held_torque: R,
    /// Endured amplitude and tensile strength, MPa.
    pub strength: [R; 2],
    /// Density, kg/m^3.
    pub density: R,
    /// Places (r, z) whose stress is asked for, mm; r is that of [`POINT_NONE`] if there is none.
    pub own_points: [[R; 2]; 2],
    /// Radius inside which stress does not count, mm.
    pub excluded_radius: R,
}

impl<R: Real<Shared = R>> Loading<R> {
    /// Of inputs in SI units whose section is of this type.
    pub fn new(si: &[R], kind: SectionKind) -> Self {
        let (i, load, dimensions) = (Inputs::read(si), pulley_load::wrap_load(si), dimensions(si));
        let (sine, cosine) = (i.friction_direction.sin(), i.friction_direction.cos());
        let tensile = from_si(MEGAPASCAL, i.tensile_strength);
        let force = clamp_force(&i);
        // The word is a number below zero.
        let endurance = R::select(i.endurance_limit, from_si(MEGAPASCAL, i.endurance_limit), R::constant(0.33) * tensile);
        let pressing = Pressing {
            // R(0) R_b / L: per length of the band and angle.
            normal: from_si(NEWTON_PER_MILLIMETRE, load.flank_force) * dimensions.mean_radius / dimensions.band_length(),
            along: load.friction_used * sine,
            around: load.friction_used * cosine,
            growth: load.effective_friction,
            wrap: i.wrap_angle,
            pressure: clamp_pressure(&dimensions, force),
            bolt_angle: i.bolt_angle,
            // kg/m^3 is 1e-12 t/mm^3.
            spin: i.density * R::constant(1e-12) * i.speed * i.speed,
        };
        Self {
            margins: load.margins,
            pressing,
            modulus: from_si(MEGAPASCAL, i.elastic_modulus),
            yield_strength: from_si(MEGAPASCAL, i.yield_strength),
            torque: load.torque,
            bolt_utilisation: force / stress_area(&i) / i.bolt_proof_strength,
            held_torque: i.bolt_count * force * i.joint_friction * i.bolt_circle * R::constant(0.5),
            strength: [endurance, tensile],
            density: i.density,
            own_points: [[i.point_1_r, i.point_1_z], [i.point_2_r, i.point_2_z]].map(|point| {
                let [r, z] = point.map(|value| from_si(MILLIMETRE, value));
                [R::select(point[0], r, R::constant(POINT_NONE)), z]
            }),
            excluded_radius: dimensions.excluded_radius(kind),
        }
    }
}

impl Loading<f64> {
    /// Strength against fatigue.
    pub fn strength(&self) -> Strength {
        let [endurance, tensile] = self.strength;
        Strength { endurance, tensile }
    }

    /// Places (z, r) whose stress is asked for, mm.
    pub fn own_points(&self) -> [Option<(f64, f64)>; 2] {
        self.own_points.map(|[r, z]| (r != POINT_NONE).then_some((z, r)))
    }
}

impl Design {
    /// Reads inputs in SI units.
    pub(crate) fn new(si: &[f64]) -> Self {
        let kind = kind(si);
        let (body, loading) = (Body::new(si, kind), Loading::new(si, kind));
        Self {
            kind,
            dimensions: dimensions(si),
            poisson: body.poisson,
            fineness: body.fineness(),
            case: loading.pressing.case(loading.modulus),
            yield_strength: loading.yield_strength,
            strength: loading.strength(),
            density: loading.density,
            own_points: loading.own_points(),
        }
    }
}

/// A value in a unit, of one in SI units.
fn from_si<R: Real>(unit: Unit, value: R) -> R {
    let (multiply, divide) = unit.factors();
    value * R::constant(divide) / R::constant(multiply)
}

/// A value in SI units, of one in a unit.
pub(super) fn to_si<R: Real>(unit: Unit, value: R) -> R {
    let (multiply, divide) = unit.factors();
    value * R::constant(multiply) / R::constant(divide)
}

/// Type of the section of this number.
pub(super) fn kind_of(section: f64) -> SectionKind {
    SectionKind::ALL[(section as usize).clamp(1, SectionKind::ALL.len()) - 1]
}

/// Type of the section.
pub(crate) fn kind(si: &[f64]) -> SectionKind {
    kind_of(Inputs::read(si).section)
}

/// Dimensions in mm and rad.
pub(crate) fn dimensions<R: Real>(si: &[R]) -> Dimensions<R> {
    let i = Inputs::read(si);
    let mm = |value| from_si(MILLIMETRE, value);
    let radius = |diameter| R::constant(0.5) * mm(diameter);
    Dimensions {
        thickness: mm(i.thickness),
        bore_radius: radius(i.bore_diameter),
        mean_radius: mm(i.mean_radius),
        half_angle: R::constant(0.5) * i.groove_angle,
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

/// Stress area of a bolt's thread (ISO 898-1), from the mean of pitch and root diameter: `d_3 = d_2 - p/sqrt(3)`.
fn stress_area<R: Real>(i: &Inputs<R>) -> R {
    let diameter = i.bolt_pitch_diameter - i.bolt_pitch * R::constant(0.5 / 3f64.sqrt());
    R::constant(std::f64::consts::FRAC_PI_4) * diameter * diameter
}

/// Force of one bolt, N: as given, or what its tightening torque makes of it,
/// `M = F/2 (p/pi + mu d2/cos 30 deg + mu D_w)` with the mean diameter `D_w` of the head's annulus.
pub(crate) fn clamp_force<R: Real>(i: &Inputs<R>) -> R {
    let (outer, inner) = (i.bolt_head, i.bolt_hole);
    let under_head = R::constant(2.0 / 3.0) * (outer * outer * outer - inner * inner * inner) / (outer * outer - inner * inner);
    let thread = i.bolt_pitch_diameter / R::constant(std::f64::consts::PI / 6.0).cos();
    let arm = i.bolt_pitch / R::constant(std::f64::consts::PI) + i.bolt_friction * (thread + under_head);
    // The word is a number below zero.
    R::select(i.clamp_force, i.clamp_force, R::constant(2.0) * i.tightening_torque / arm)
}
