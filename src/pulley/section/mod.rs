//! The four types of section: dimensions, the ways in which they can be impossible, and their meshes.
//!
//! Source: K.-S. Lee et al., whose figures of the types are lost; the profiles are parametric replacements with the dimensions that
//! `beltspace models pulley` lists. Lengths are in mm, angles in rad, points are (z, r) with z = 0 at the bracket face.

mod double_groove;
mod machined;
mod outline;
mod pressed_cup;
mod sheet;
mod strip;
mod welded_discs;

pub use outline::Outline;
pub use sheet::SURFACE_POINTS;

use super::mesh::Mesh;
use crate::real::Real;

/// The types of section, numbered as in the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SectionKind {
    /// Type 1: machined or cast, single groove.
    Machined,
    /// Type 2: two pressed discs, welded together at the hub.
    WeldedDiscs,
    /// Type 3: two grooves rolled from one sheet.
    DoubleGroove,
    /// Type 4: one-piece pressed cup with a rolled rim.
    PressedCup,
}

impl SectionKind {
    /// All types, in the source's order.
    pub const ALL: [Self; 4] = [Self::Machined, Self::WeldedDiscs, Self::DoubleGroove, Self::PressedCup];

    /// Its name in study files.
    pub fn name(self) -> &'static str {
        ["machined", "welded-discs", "double-groove", "pressed-cup"][self as usize]
    }

    /// How many grooves such a pulley has.
    pub fn grooves(self) -> u32 {
        if self == Self::DoubleGroove { 2 } else { 1 }
    }
}

macro_rules! dimensions {
    ($($(#[$doc:meta])* $field:ident),* $(,)?) => {
        /// Dimensions of a section: numbers, or placeholders for them. Each type reads those that [`Dimensions::of_kind`] keeps.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Dimensions<T = f64> {
            $($(#[$doc])* pub $field: T),*
        }

        impl<T: Copy> Dimensions<T> {
            /// All dimensions by name, mm and rad.
            pub fn entries(&self) -> Vec<(&'static str, T)> {
                vec![$((stringify!($field), self.$field)),*]
            }
        }

        impl Dimensions {

            /// Dimensions from the values that `value` gives for each name.
            ///
            /// # Errors
            /// The first that `value` returns.
            pub fn from_entries<E>(mut value: impl FnMut(&'static str) -> Result<f64, E>) -> Result<Self, E> {
                Ok(Self { $($field: value(stringify!($field))?),* })
            }
        }
    };
}

dimensions! {
    /// Thickness of the sheet; of the hub plate and the web of the machined type, mm.
    thickness,
    /// Radius of the bore, mm.
    bore_radius,
    /// Radius at which the belt pulls, mm.
    mean_radius,
    /// Half the groove angle, rad.
    half_angle,
    /// Number of grooves.
    groove_count,
    /// Width of a groove at its top, mm.
    groove_width,
    /// From the mean radius out to the groove's top, mm.
    groove_height,
    /// From the mean radius in to the groove's floor, mm.
    floor_depth,
    /// From the groove's top out to the rim's edge, mm.
    rim_height,
    /// Height of the band of the flank that the belt touches, centred on the mean radius, mm.
    contact_height,
    /// Bend radius at the groove's floor (E, F), on the groove's side, mm.
    floor_bend_radius,
    /// Bend radius between hub and wall (B), on the back, mm.
    hub_bend_radius,
    /// Bend radius between cup and radial wall (C), on the outside, mm.
    web_bend_radius,
    /// Radius of the fold or ridge (D), on the outside, mm.
    fold_radius,
    /// Where the hub's back would meet the cup, mm from the axis.
    cup_radius,
    /// Where the cup would meet the radial wall, mm from the axis.
    wall_radius,
    /// Of the radial wall's back from the bracket face, mm.
    wall_offset,
    /// Width of a ridge between corners before rounding, mm.
    ridge_width,
    /// Radius out to which the discs are welded, mm.
    weld_radius,
    /// Thickness of the cup's wall, mm.
    wall_thickness,
    /// From the groove's floor in to the rim's underside, mm.
    rim_thickness,
    /// Thickness of the groove's sides at the rim's edge, mm.
    lip_thickness,
    /// Radius of the fillets of inner corners, mm.
    fillet_radius,
    /// Of the groove's mid-plane from the bracket face, mm.
    groove_offset,
    /// Radius of the bracket, inside which the back is fixed, mm.
    bracket_radius,
    /// Number of bolts.
    bolt_count,
    /// Radius of the bolt circle, mm.
    bolt_circle_radius,
    /// Radius of the bolt heads (or washers), mm.
    bolt_head_radius,
    /// Radius of the bolt holes, mm.
    bolt_hole_radius,
}

impl<T: Copy> Dimensions<T> {
    /// The dimensions that a type reads, with `none` in place of the others. The code that makes and solves a section gets no others, so
    /// this is the only place that defines on what a type depends.
    #[must_use]
    pub fn of_kind(self, kind: SectionKind, none: T) -> Self {
        let of_sheet =
            Self { wall_thickness: none, rim_thickness: none, lip_thickness: none, fillet_radius: none, groove_offset: none, ..self };
        match kind {
            SectionKind::Machined => Self {
                hub_bend_radius: none,
                web_bend_radius: none,
                fold_radius: none,
                wall_radius: none,
                wall_offset: none,
                ridge_width: none,
                weld_radius: none,
                ..self
            },
            SectionKind::WeldedDiscs => Self {
                cup_radius: none,
                wall_radius: none,
                wall_offset: none,
                web_bend_radius: none,
                fold_radius: none,
                ridge_width: none,
                floor_bend_radius: none,
                floor_depth: none,
                ..of_sheet
            },
            SectionKind::DoubleGroove => Self { weld_radius: none, ..of_sheet },
            SectionKind::PressedCup => Self { ridge_width: none, weld_radius: none, ..of_sheet },
        }
    }
}

impl<R: Real> Dimensions<R> {
    /// Length of the contact band along a flank, mm.
    pub fn band_length(&self) -> R {
        self.contact_height / self.half_angle.cos()
    }

    /// Outer edge of the bracket or of the bolt heads, whichever is larger, mm from the axis.
    pub fn held_radius(&self) -> R {
        self.bracket_radius.max(self.head_edge())
    }

    /// Outer edge of the bolt heads, mm from the axis.
    pub fn head_edge(&self) -> R {
        self.bolt_circle_radius + self.bolt_head_radius
    }

    /// Radius inside which stress is not reported as the largest: the edges of bracket and bolt heads are singular, and the values
    /// beside them grow without limit as the mesh gets finer.
    pub fn excluded_radius(&self, kind: SectionKind) -> R {
        let beside = if kind == SectionKind::Machined { self.thickness.min(self.fillet_radius) } else { self.thickness };
        self.held_radius() + beside
    }
}

impl Dimensions {
    /// Ends of the contact band, mm from the axis.
    pub fn band(&self) -> (f64, f64) {
        (self.mean_radius - 0.5 * self.contact_height, self.mean_radius + 0.5 * self.contact_height)
    }

    /// Radius of the groove's top, mm.
    pub fn top_radius(&self) -> f64 {
        self.mean_radius + self.groove_height
    }

    /// Radius of the rim's edge, mm.
    pub fn rim_radius(&self) -> f64 {
        self.top_radius() + self.rim_height
    }

    /// Radius of the groove's floor, mm.
    pub fn floor_radius(&self) -> f64 {
        self.mean_radius - self.floor_depth
    }

    /// Half the groove's width at a radius, mm.
    pub fn half_width(&self, radius: f64) -> f64 {
        0.5 * self.groove_width + (radius - self.top_radius()) * libm::tan(self.half_angle)
    }

    /// Radius from which elements of the hub are short, mm.
    fn beside_bracket(&self) -> f64 {
        self.bracket_radius - self.thickness
    }

    /// What is wrong with bracket and bolts, given the outer end of the hub's flat faces.
    fn bolts_on_flat(&self, flat: f64) -> Result<(), Flaw> {
        let inner = self.bolt_circle_radius - self.bolt_head_radius;
        let hole = self.bolt_circle_radius + self.bolt_hole_radius;
        if inner < self.bore_radius {
            return Err(Flaw::HeadOverBore { over: self.bore_radius - inner });
        }
        if self.bolt_hole_radius >= self.bolt_head_radius {
            return Err(Flaw::HeadInHole { over: self.bolt_hole_radius - self.bolt_head_radius });
        }
        if hole > self.bracket_radius {
            return Err(Flaw::BoltCircle { over: hole - self.bracket_radius });
        }
        let pitch = 2.0 * self.bolt_circle_radius * libm::sin(std::f64::consts::PI / self.bolt_count);
        if self.bolt_count > 1.0 && pitch < 2.0 * self.bolt_head_radius {
            return Err(Flaw::HeadsMeet { over: 2.0 * self.bolt_head_radius - pitch });
        }
        if self.held_radius() > flat {
            return Err(Flaw::Flat { held: self.held_radius(), flat });
        }
        Ok(())
    }

    /// What is wrong with the contact band, given the ends of the straight flank (mm from the axis).
    fn band_on_flank(&self, inner: f64, outer: f64) -> Result<(), Flaw> {
        let (low, high) = self.band();
        let over = (inner - low).max(high - outer);
        if over > 1e-9 { Err(Flaw::Band { over, flank: (inner, outer), band: (low, high) }) } else { Ok(()) }
    }
}

/// Why there is no such section.
#[derive(Clone, Debug, PartialEq)]
pub enum Flaw {
    /// A bend whose inside radius is not positive.
    Bend {
        /// Letter of the bend.
        name: &'static str,
        /// Its inside radius, mm.
        inside: f64,
    },
    /// Two bends that leave no straight piece between them.
    Room {
        /// The one before, or the start.
        before: &'static str,
        /// The one after, or the end.
        after: &'static str,
        /// What is left between them, mm.
        room: f64,
    },
    /// A dimension that must be larger than another.
    Order {
        /// What must be larger.
        larger: &'static str,
        /// Than what.
        smaller: &'static str,
        /// By how much it is, mm.
        by: f64,
    },
    /// The outline crosses itself.
    Crossing {
        /// Where, (z, r) in mm.
        at: (f64, f64),
    },
    /// The mesh folds over, or the section has more surface than one table holds.
    Mesh {
        /// What is wrong.
        reason: &'static str,
    },
    /// The belt touches more than the straight flank.
    Band {
        /// By how much, mm.
        over: f64,
        /// Ends of the flank, mm from the axis.
        flank: (f64, f64),
        /// Ends of the band, mm from the axis.
        band: (f64, f64),
    },
    /// Bolt holes outside the bracket.
    BoltCircle {
        /// By how much, mm.
        over: f64,
    },
    /// Bolt heads that reach over the bore.
    HeadOverBore {
        /// By how much, mm.
        over: f64,
    },
    /// Bolt heads that fall through their holes.
    HeadInHole {
        /// By how much, mm.
        over: f64,
    },
    /// Bolt heads that overlap.
    HeadsMeet {
        /// By how much, mm.
        over: f64,
    },
    /// Bracket or bolt heads that do not lie on the flat hub.
    Flat {
        /// Their outer edge, mm from the axis.
        held: f64,
        /// Where the flat ends, mm from the axis.
        flat: f64,
    },
    /// Another number of grooves than the type has.
    Grooves {
        /// What was asked for.
        asked: f64,
        /// What the type has.
        has: u32,
    },
}

impl Flaw {
    /// How far the section is from being possible: a negative number, mm; the larger in magnitude, the worse.
    pub fn margin(&self) -> f64 {
        let margin = match self {
            Self::Bend { inside, .. } => *inside,
            Self::Room { room, .. } => *room,
            Self::Order { by, .. } => *by,
            Self::Crossing { .. } | Self::Mesh { .. } => -1.0,
            Self::Band { over, .. }
            | Self::BoltCircle { over }
            | Self::HeadOverBore { over }
            | Self::HeadInHole { over }
            | Self::HeadsMeet { over } => -over,
            Self::Flat { held, flat } => flat - held,
            Self::Grooves { asked, has } => -(asked - f64::from(*has)).abs(),
        };
        // A bend of radius zero is as impossible as a negative one.
        if margin < 0.0 { margin } else { -f64::MIN_POSITIVE }
    }
}

impl std::fmt::Display for Flaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mm = |value: f64| (value * 1000.0).round() / 1000.0 + 0.0;
        match self {
            Self::Bend { name, inside } => write!(
                f,
                "the inside radius of bend {name} would be {} mm and must be greater than 0: give a larger radius or a thinner sheet",
                mm(*inside)
            ),
            Self::Room { before, after, room } => write!(
                f,
                "{before} and {after} overlap: {} mm would be left between them; give smaller radii or move the corners apart",
                mm(*room)
            ),
            Self::Order { larger, smaller, by } => {
                write!(f, "{larger} must be greater than {smaller}; the difference is {} mm", mm(*by))
            }
            Self::Crossing { at } => write!(f, "the outline crosses itself near z = {} mm, r = {} mm", mm(at.0), mm(at.1)),
            Self::Mesh { reason } => write!(f, "no mesh: {reason}"),
            Self::Band { over, flank, band } => write!(
                f,
                "the belt touches the flank from r = {} to {} mm, but the straight flank is from {} to {} mm: {} mm too much; give a smaller \
                 contact_height_mm, a deeper floor or a higher groove",
                mm(band.0),
                mm(band.1),
                mm(flank.0),
                mm(flank.1),
                mm(*over)
            ),
            Self::BoltCircle { over } => write!(
                f,
                "the bolt holes reach {} mm beyond the bracket: give a larger bracket_diameter_mm or a smaller bolt_circle_mm",
                mm(*over)
            ),
            Self::HeadOverBore { over } => {
                write!(f, "the bolt heads reach {} mm over the bore: give a smaller bore_diameter_mm or a larger bolt_circle_mm", mm(*over))
            }
            Self::HeadInHole { over } => {
                write!(f, "bolt_hole_mm is {} mm larger in radius than bolt_head_mm: the head would fall through", mm(*over))
            }
            Self::HeadsMeet { over } => {
                write!(f, "the bolt heads overlap by {} mm: give fewer bolts or a larger bolt_circle_mm", mm(*over))
            }
            Self::Flat { held, flat } => write!(
                f,
                "bracket and bolt heads need a flat hub out to r = {} mm, but it ends at {} mm: give a larger cup_diameter_mm or smaller bends",
                mm(*held),
                mm(*flat)
            ),
            Self::Grooves { asked, has } => {
                write!(f, "a pulley of this section has {has} groove(s), not {asked}: set groove_count = {has}")
            }
        }
    }
}

/// How finely a section is meshed, and how many harmonics are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fineness {
    /// Elements through a sheet.
    pub through: usize,
    /// Length of elements on straight pieces, mm (more on large pulleys).
    pub straight: f64,
    /// Length of elements on the outside of bends, mm.
    pub bend: f64,
    /// Length of elements beside the bracket's edge, mm.
    pub held: f64,
    /// Length of elements of solid sections, mm.
    pub solid: f64,
    /// Highest harmonic.
    pub harmonics: usize,
    /// Are all harmonics solved, rather than interpolated between some?
    pub every: bool,
}

impl Fineness {
    /// Two per cent at the check points C to G and of the largest stress.
    pub const USUAL: Self = Self { through: 2, straight: 2.0, bend: 0.6, held: 0.7, solid: 2.4, harmonics: 24, every: false };
    /// Half a per cent.
    pub const FINE: Self = Self { through: 3, straight: 1.0, bend: 0.4, held: 0.35, solid: 1.2, harmonics: 32, every: true };
}

/// The mesh of a section, or why there is none.
///
/// # Errors
/// A [`Flaw`]: the first that is found.
pub fn mesh(kind: SectionKind, dimensions: &Dimensions, fineness: &Fineness) -> Result<Mesh, Flaw> {
    checked_outline(kind, dimensions)?;
    match kind {
        SectionKind::Machined => machined::mesh(dimensions, fineness),
        SectionKind::WeldedDiscs => welded_discs::mesh(dimensions, fineness),
        SectionKind::DoubleGroove => double_groove::mesh(dimensions, fineness),
        SectionKind::PressedCup => pressed_cup::mesh(dimensions, fineness),
    }
}

/// The outline of a section, or why there is none: every flaw of a section is found here.
///
/// # Errors
/// A [`Flaw`]: the first that is found.
pub fn checked_outline(kind: SectionKind, dimensions: &Dimensions) -> Result<Outline, Flaw> {
    if dimensions.groove_count != f64::from(kind.grooves()) {
        return Err(Flaw::Grooves { asked: dimensions.groove_count, has: kind.grooves() });
    }
    let outline = match kind {
        SectionKind::Machined => machined::outline(dimensions),
        SectionKind::WeldedDiscs => welded_discs::outline(dimensions),
        SectionKind::DoubleGroove => double_groove::outline(dimensions),
        SectionKind::PressedCup => pressed_cup::outline(dimensions),
    }?;
    match outline.crossing() {
        Some(at) => Err(Flaw::Crossing { at }),
        None => Ok(outline),
    }
}
