//! `timing-belt` a second time, from the specification alone, in N, mm and kg. Tensions and tooth
//! loads are unknowns of one system, one row per balance of a tooth and one per stretch of a land,
//! solved by elimination with pivoting: no tridiagonal matrix, nothing eliminated by hand and no
//! influence of the two strands computed beforehand, so that an error in any of these shows.
//! The closed forms (9), (15) and (19) of the paper, with their misprints repaired, are a third way.

use super::{Values, value};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// One tooth in the complete mesh and in the incomplete one; both are the same if no tooth lifts.
#[derive(Clone, Copy, Debug)]
pub struct Tooth {
    /// Leaving the tooth towards the slack side: on the last tooth the slack strand's.
    pub complete_tension: f64,
    pub complete_load: f64,
    pub incomplete_tension: f64,
    pub incomplete_load: f64,
    /// Inward force of the complete mesh less the centrifugal force: negative where the tooth lifts.
    pub margin: f64,
}

/// Status, and outputs by name. Without `lift_angle_deg` the teeth lift by all of the tooth space.
pub fn timing_belt(inputs: &BTreeMap<String, f64>) -> (&'static str, Values) {
    let belt = Belt::new(inputs);
    let mut out = Values::from([
        ("centrifugal_force_N", belt.centrifugal_force()),
        ("effective_tension_N", belt.tight - belt.slack),
        ("torque_Nm", (belt.tight * belt.pitch_radius - belt.slack * belt.pitch_radius) / 1000.0),
        ("pitch_mass_used_g", 1000.0 * belt.mass),
    ]);
    let status = belt.status();
    if status == "no effective tension" || belt.pulley_teeth() < belt.teeth as f64 {
        return (status, out);
    }
    let complete = belt.solve(&belt.complete());
    let inward = belt.inward(&complete);
    let margins: Vec<f64> = inward.iter().map(|inward| inward - belt.centrifugal_force()).collect();
    let j = boundary(&margins);
    out.insert("boundary_tooth", j as f64);
    out.insert("incomplete_teeth", (belt.teeth + 1 - j) as f64);
    let crossing = if (2..=belt.teeth).contains(&j) {
        // Both margins of the two teeth on either side of the boundary; they differ in sign.
        let (stays, lifts) = (margins[j - 2], -margins[j - 1]);
        (j - 1) as f64 + stays / (stays + lifts)
    } else {
        j as f64
    };
    out.insert("boundary_position", crossing);
    let least = inward.iter().copied().fold(f64::INFINITY, f64::min).max(0.0);
    let angular = (least / (belt.mass * belt.radius / 1000.0)).sqrt();
    out.insert("lift_speed_rpm", angular * 60.0 / (2.0 * PI));

    out.insert("peak_tooth_load_complete_N", largest(&complete.loads));
    if status != "ok" {
        return (status, out);
    }
    let incomplete = belt.incomplete(j);
    out.insert("peak_tooth_load_N", largest(&incomplete.loads));
    out.insert("least_tooth_load_N", incomplete.loads.iter().copied().fold(f64::INFINITY, f64::min));
    if j <= belt.teeth {
        out.insert("boundary_tension_N", if j == 1 { belt.tight } else { incomplete.tensions[j - 2] });
    }
    ("ok", out)
}

/// The centrifugal force, and how far it is from lifting every tooth of the complete mesh.
pub fn margins(inputs: &BTreeMap<String, f64>) -> (f64, Vec<f64>) {
    let belt = Belt::new(inputs);
    let force = belt.centrifugal_force();
    (force, belt.inward(&belt.solve(&belt.complete())).iter().map(|inward| inward - force).collect())
}

/// Tooth by tooth from the tight side; empty where the status is not ok.
pub fn profile(inputs: &BTreeMap<String, f64>) -> Vec<Tooth> {
    let belt = Belt::new(inputs);
    if belt.status() != "ok" {
        return Vec::new();
    }
    let complete = belt.solve(&belt.complete());
    let margins: Vec<f64> = belt.inward(&complete).iter().map(|inward| inward - belt.centrifugal_force()).collect();
    let incomplete = belt.incomplete(boundary(&margins));
    (0..belt.teeth)
        .map(|i| Tooth {
            complete_tension: complete.tensions[i],
            complete_load: complete.loads[i],
            incomplete_tension: incomplete.tensions[i],
            incomplete_load: incomplete.loads[i],
            margin: margins[i],
        })
        .collect()
}

/// T(1) ... T(N+1) of the complete mesh by TIM (9).
pub fn closed_complete(inputs: &BTreeMap<String, f64>) -> Vec<f64> {
    let belt = Belt::new(inputs);
    let form = belt.equation_9(belt.teeth - 1, belt.psi.cos());
    let tension = |i| form.of_tight(i) * belt.tight + form.of_slack(i) * belt.slack;
    (1..belt.teeth).map(tension).chain([belt.slack]).collect()
}

/// T(j) ... T(N+1) of the lifted teeth by TIM (15) from the tension T* = T(j-1) at the boundary.
pub fn closed_lifted(inputs: &BTreeMap<String, f64>, j: usize, boundary: f64) -> Vec<f64> {
    let belt = Belt::new(inputs);
    let form = belt.equation_15(j);
    (j..=belt.teeth).map(|i| form.of_tight(i) * boundary + form.of_slack(i) * belt.slack).collect()
}

/// T* = T(j-1) by TIM (19) as repaired: tooth j-1 meshes completely, so that what leaves it does so
/// at phi, both in its own balance and where (9) ends at it. For 3 <= j <= N+1.
pub fn closed_boundary(inputs: &BTreeMap<String, f64>, j: usize) -> f64 {
    let belt = Belt::new(inputs);
    belt.equation_19(j, belt.phi.cos(), belt.phi.cos())
}

/// T* as printed, with cos(phi - theta) and cos(psi) there. Not what this project computes: 2.3 %
/// low on the default belt.
pub fn printed_boundary(inputs: &BTreeMap<String, f64>, j: usize) -> f64 {
    let belt = Belt::new(inputs);
    belt.equation_19(j, (belt.phi - belt.theta).cos(), belt.psi.cos())
}

/// T(1) ... T(N+1) of the incomplete mesh by (9) up to tooth j-1, (19) at it and (15) beyond it.
/// For 3 <= j <= N+1, without the friction of centrifugal force on the lands.
pub fn closed_incomplete(inputs: &BTreeMap<String, f64>, j: usize) -> Vec<f64> {
    let belt = Belt::new(inputs);
    let boundary = closed_boundary(inputs, j);
    let form = belt.equation_9(j - 2, belt.phi.cos());
    let tension = |i| form.of_tight(i) * belt.tight + form.of_slack(i) * boundary;
    (1..=j - 2).map(tension).chain([boundary]).chain(closed_lifted(inputs, j, boundary)).collect()
}

fn largest(loads: &[f64]) -> f64 {
    loads.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// The first tooth whose margin is negative; one past the last if none is. A tooth in balance stays.
fn boundary(margins: &[f64]) -> usize {
    1 + margins.iter().position(|&margin| margin < 0.0).unwrap_or(margins.len())
}

/// (20) volume by volume, in mm3 and kg: the tooth, the back's rubber and the cords.
fn mass_of_pitch(inputs: &BTreeMap<String, f64>) -> f64 {
    let get = |name: &str| value(inputs, name);
    let width = get("belt_width_mm");
    let volumes = [get("tooth_area_mm2") * width, get("land_area_mm2") * width, get("gross_cord_area_mm2") * get("pitch_mm")];
    let densities = ["rubber_density_kg_per_m3", "rubber_density_kg_per_m3", "cord_density_kg_per_m3"].map(get);
    volumes.iter().zip(densities).map(|(volume, density)| volume * 1e-9 * density).sum()
}

/// Forces in N, lengths in mm, masses in kg, angles in radians.
struct Belt {
    teeth: usize,
    tight: f64,
    slack: f64,
    friction: f64,
    compliance: f64,
    /// A E of the cord.
    stiffness: f64,
    radius: f64,
    pitch_radius: f64,
    beta: f64,
    phi: f64,
    theta: f64,
    tooth_length: f64,
    alpha: f64,
    omega: f64,
    psi: f64,
    mass: f64,
    angular: f64,
    /// Tension that the belt's inertia alone carries, if only what is above it presses on the lands.
    unpressing: Option<f64>,
}

/// The piece of belt on the land after a tooth: its stretch is `stretch T + fixed_stretch` and the
/// next tooth is pulled by `gain T + offset`.
#[derive(Clone, Copy)]
struct Land {
    stretch: f64,
    fixed_stretch: f64,
    gain: f64,
    offset: f64,
}

/// Directions of one tooth: cosines of the belt entering and leaving it, and the force along the
/// belt that a unit of tooth load carries.
#[derive(Clone, Copy)]
struct Seat {
    entering: f64,
    leaving: f64,
    carried: f64,
}

struct Mesh {
    seats: Vec<Seat>,
    lands: Vec<Land>,
}

struct State {
    /// Leaving each tooth; the last is the slack strand's.
    tensions: Vec<f64>,
    loads: Vec<f64>,
}

impl Belt {
    fn new(inputs: &BTreeMap<String, f64>) -> Belt {
        let get = |name: &str| value(inputs, name);
        let angle = |name: &str| get(name) * PI / 180.0;
        let radius = get("tip_radius_mm");
        let mass = inputs.get("pitch_mass_g").map_or_else(|| mass_of_pitch(inputs), |mass| mass / 1000.0);
        let angular = get("pulley_speed_rpm") * 2.0 * PI / 60.0;
        let centrifugal_tension = || mass / (get("pitch_mm") / 1000.0) * (radius / 1000.0 * angular).powi(2);
        let land_friction = inputs.get("centrifugal_land_friction").is_some_and(|&on| on != 0.0);
        Belt {
            teeth: get("teeth_in_mesh") as usize,
            tight: get("tight_tension_N"),
            slack: get("slack_tension_N"),
            friction: get("friction"),
            compliance: get("tooth_compliance_um_per_N") / 1000.0,
            stiffness: get("cord_modulus_GPa") * 1000.0 * get("cord_area_mm2"),
            radius,
            pitch_radius: radius + get("pitch_line_mm"),
            beta: angle("land_half_angle_deg"),
            phi: angle("space_half_angle_deg"),
            theta: angle(if inputs.contains_key("lift_angle_deg") { "lift_angle_deg" } else { "space_half_angle_deg" }),
            tooth_length: get("tooth_length_mm"),
            alpha: angle("pressure_angle_deg"),
            omega: angle("tight_span_angle_deg"),
            psi: angle("slack_span_angle_deg"),
            mass,
            angular,
            unpressing: land_friction.then(centrifugal_tension),
        }
    }

    fn status(&self) -> &'static str {
        if self.slack >= self.tight {
            "no effective tension"
        } else if self.theta > self.phi {
            "lift angle exceeds tooth space"
        } else if self.pulley_teeth() < self.teeth as f64 {
            "wrap exceeds 360 degrees"
        } else {
            "ok"
        }
    }

    /// How many lands with their spaces go around the pulley.
    fn pulley_teeth(&self) -> f64 {
        PI / (self.beta + self.phi)
    }

    fn centrifugal_force(&self) -> f64 {
        self.mass * self.angular * (self.angular * self.radius / 1000.0)
    }

    /// What friction on a land leaves of a unit of tension.
    fn passed(&self) -> f64 {
        (-2.0 * self.friction * self.beta).exp()
    }

    /// Length of the land, each piece weighted with the share of the tension that is left there.
    fn weighted_land(&self) -> f64 {
        let exponent = 2.0 * self.friction * self.beta;
        // (1 - e)/mu loses its figures long before mu gets to zero; the series does not.
        let mean = if exponent < 1e-3 {
            1.0 - exponent / 2.0 * (1.0 - exponent / 3.0 * (1.0 - exponent / 4.0 * (1.0 - exponent / 5.0)))
        } else {
            (1.0 - self.passed()) / exponent
        };
        2.0 * self.beta * self.radius * mean
    }

    fn rubbing(&self) -> Land {
        let stretch = (self.weighted_land() + self.tooth_length) / self.stiffness;
        Land { stretch, fixed_stretch: 0.0, gain: self.passed(), offset: 0.0 }
    }

    fn free(&self) -> Land {
        let length = 2.0 * self.beta * self.radius + self.tooth_length;
        Land { stretch: length / self.stiffness, fixed_stretch: 0.0, gain: 1.0, offset: 0.0 }
    }

    /// In contact, but only the tension beyond `unpressing` causes friction.
    fn rubbing_beyond(&self, unpressing: f64) -> Land {
        let unpressed = 2.0 * self.beta * self.radius - self.weighted_land();
        Land { fixed_stretch: unpressing * unpressed / self.stiffness, offset: unpressing * (1.0 - self.passed()), ..self.rubbing() }
    }

    fn complete(&self) -> Mesh {
        let phi = self.phi.cos();
        let mut seats = vec![Seat { entering: phi, leaving: phi, carried: self.alpha.cos() }; self.teeth];
        seats[0].entering = self.omega.cos();
        seats[self.teeth - 1].leaving = self.psi.cos();
        Mesh { seats, lands: vec![self.rubbing(); self.teeth - 1] }
    }

    fn lifted_carry(&self) -> f64 {
        let turned = self.alpha + self.theta;
        turned.cos() + self.friction * turned.sin()
    }

    /// Solved with teeth j ... N+1 rotated by theta; the complete mesh if there is none.
    fn incomplete(&self, j: usize) -> State {
        let mut mesh = self.complete();
        if j > self.teeth {
            return self.solve(&mesh);
        }
        // Psi goes with the last tooth, which is lifted here; Omega stays even if the first one is.
        let (opening, closing) = ((self.phi + self.theta).cos(), (self.phi - self.theta).cos());
        mesh.seats[j - 1..].fill(Seat { entering: opening, leaving: closing, carried: self.lifted_carry() });
        mesh.seats[0].entering = self.omega.cos();
        // Land i lies between teeth i and i+1: the last one to touch is that before tooth j-1.
        let mut touching: Vec<bool> = (1..self.teeth).map(|land| land + 2 <= j).collect();
        loop {
            for (land, &touches) in mesh.lands.iter_mut().zip(&touching) {
                *land = match (touches, self.unpressing) {
                    (false, _) => self.free(),
                    (true, None) => self.rubbing(),
                    (true, Some(tension)) => self.rubbing_beyond(tension),
                };
            }
            let state = self.solve(&mesh);
            let pressed = |tension: f64| self.unpressing.is_none_or(|unpressing| tension > unpressing);
            let still: Vec<bool> = touching.iter().zip(&state.tensions).map(|(&touches, &tension)| touches && pressed(tension)).collect();
            if still == touching {
                return state;
            }
            // All slack lands at once, for good: it ends, but a land dropped with its neighbours may then
            // carry more than it needs to press (the loads differ by up to 1e-3 from those with it back).
            touching = still;
        }
    }

    /// Unknowns Q(1), T(1), Q(2), ... Q(N+1). Row 2i is the balance of a tooth along the belt, row
    /// 2i+1 the stretch of the belt between two teeth, which the bending of the teeth makes room for;
    /// it is divided by the compliance, so that all coefficients are about one.
    fn solve(&self, mesh: &Mesh) -> State {
        let size = 2 * self.teeth - 1;
        let mut rows = vec![vec![0.0; size + 1]; size];
        for (i, seat) in mesh.seats.iter().enumerate() {
            let row = &mut rows[2 * i];
            row[2 * i] = seat.carried;
            match i {
                0 => row[size] += seat.entering * self.tight,
                _ => {
                    let before = mesh.lands[i - 1];
                    row[2 * i - 1] = -seat.entering * before.gain;
                    row[size] += seat.entering * before.offset;
                }
            }
            if i + 1 < self.teeth {
                row[2 * i + 1] = seat.leaving;
            } else {
                row[size] -= seat.leaving * self.slack;
            }
        }
        for (i, land) in mesh.lands.iter().enumerate() {
            let row = &mut rows[2 * i + 1];
            row[2 * i] = -mesh.seats[i].carried;
            row[2 * i + 1] = land.stretch / self.compliance;
            row[2 * i + 2] = mesh.seats[i + 1].carried;
            row[size] = -land.fixed_stretch / self.compliance;
        }
        let unknowns = solve_refined(&rows);
        State {
            tensions: unknowns.iter().skip(1).step_by(2).copied().chain([self.slack]).collect(),
            loads: unknowns.iter().step_by(2).copied().collect(),
        }
    }

    /// Inward force on the whole pitch of each tooth, its land not pressed.
    fn inward(&self, complete: &State) -> Vec<f64> {
        let outward_of_load = self.alpha.sin() - self.friction * self.alpha.cos();
        (0..self.teeth)
            .map(|i| {
                let entering = if i == 0 { self.tight } else { self.passed() * complete.tensions[i - 1] };
                (entering + complete.tensions[i]) * (self.phi + self.beta).sin() - outward_of_load * complete.loads[i]
            })
            .collect()
    }

    /// (9) on `lands` lands whose last tooth is left at the cosine `leaving`.
    fn equation_9(&self, lands: usize, leaving: f64) -> Recurrence {
        let (f, e) = (self.compliance, self.passed());
        let stretch = (self.weighted_land() + self.tooth_length) / self.stiffness;
        let (a, c) = (f * e * self.phi.cos(), f * self.phi.cos());
        Recurrence::new([a, f * self.phi.cos() * (1.0 + e) + stretch, c], [f * self.omega.cos(), f * leaving], 1, lands)
    }

    fn equation_15(&self, j: usize) -> Recurrence {
        let u = self.compliance * (self.phi + self.theta).cos();
        let v = self.compliance * (self.phi - self.theta).cos();
        Recurrence::new([u, self.free_stretch() + u + v, v], [u, v], j, self.teeth - 1)
    }

    /// (S + l)/(A E).
    fn free_stretch(&self) -> f64 {
        (2.0 * self.beta * self.radius + self.tooth_length) / self.stiffness
    }

    /// (19), with the two cosines at which the belt leaves tooth j-1: in the balance of that tooth and
    /// in the form (9) that ends at it.
    fn equation_19(&self, j: usize, leaving: f64, leaving_inside: f64) -> f64 {
        let (f, e) = (self.compliance, self.passed());
        let (before, after) = (self.equation_9(j - 2, leaving_inside), self.equation_15(j));
        let (opening, closing) = ((self.phi + self.theta).cos(), (self.phi - self.theta).cos());
        let entering = e * self.phi.cos();
        let known = f * (closing * after.of_slack(j) * self.slack + entering * before.of_tight(j - 2) * self.tight);
        known / (self.free_stretch() + f * (leaving - closing * after.of_tight(j) + opening - entering * before.of_slack(j - 2)))
    }
}

/// p T(i-1) - q T(i) + r T(i+1) = 0 for i = first ... last, where T(first - 1) and T(last + 1) are
/// given and enter with their own coefficients instead of p and r. The paper's C1 ... C4 (with first
/// = 1) and C5 ... C8, its X and Y times the coefficients lambda and nu, or u and v.
struct Recurrence {
    roots: [f64; 2],
    /// C1, C2 or C5, C6.
    head: [f64; 2],
    /// C3, C4 or C7, C8.
    tail: [f64; 2],
    ends: [f64; 2],
    first: i32,
}

impl Recurrence {
    fn new([p, q, r]: [f64; 3], ends: [f64; 2], first: usize, last: usize) -> Recurrence {
        let spread = (q * q - 4.0 * p * r).sqrt();
        let roots = [(q + spread) / (2.0 * r), (q - spread) / (2.0 * r)];
        let (first, last) = (first as i32, last as i32);
        // Powers are counted from `first`: the paper's common factor root^first, which cancels in a
        // pair of roots, would only cost range.
        let head = roots.map(|root| q - r * root);
        let tail = roots.map(|root| p * root.powi(last - first - 1) - q * root.powi(last - first));
        Recurrence { roots, head, tail, ends, first }
    }

    fn determinant(&self) -> f64 {
        self.head[1] * self.tail[0] - self.head[0] * self.tail[1]
    }

    fn power(&self, root: usize, i: usize) -> f64 {
        self.roots[root].powi(i as i32 - self.first)
    }

    fn of_tight(&self, i: usize) -> f64 {
        self.ends[0] * (self.tail[0] * self.power(1, i) - self.tail[1] * self.power(0, i)) / self.determinant()
    }

    fn of_slack(&self, i: usize) -> f64 {
        self.ends[1] * (self.head[0] * self.power(1, i) - self.head[1] * self.power(0, i)) / self.determinant()
    }
}

/// The solution of a square system with its right side as last column, refined with residuals of
/// twice the precision: without that the small tensions at the slack end keep fewer figures than
/// the large ones.
fn solve_refined(rows: &[Vec<f64>]) -> Vec<f64> {
    let size = rows.len();
    let mut solution = eliminate(rows.to_vec());
    for _ in 0..2 {
        let mut again = rows.to_vec();
        for row in &mut again {
            let (mut sum, mut rest) = (row[size], 0.0);
            for (&coefficient, &unknown) in row.iter().zip(&solution) {
                let product = -coefficient * unknown;
                let next = sum + product;
                let moved = next - sum;
                rest += (sum - (next - moved)) + (product - moved) + (-coefficient).mul_add(unknown, -product);
                sum = next;
            }
            row[size] = sum + rest;
        }
        for (value, correction) in solution.iter_mut().zip(eliminate(again)) {
            *value += correction;
        }
    }
    solution
}

/// Gaussian elimination with partial pivoting.
fn eliminate(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let size = rows.len();
    for column in 0..size {
        let pivot = (column..size).max_by(|&i, &k| rows[i][column].abs().total_cmp(&rows[k][column].abs())).unwrap();
        rows.swap(column, pivot);
        let (above, below) = rows.split_at_mut(column + 1);
        let row = &above[column];
        for other in below {
            let factor = other[column] / row[column];
            if factor != 0.0 {
                for (entry, &pivot_entry) in other[column..].iter_mut().zip(&row[column..]) {
                    *entry -= factor * pivot_entry;
                }
            }
        }
    }
    let mut solution = vec![0.0; size];
    for i in (0..size).rev() {
        let known: f64 = (i + 1..size).map(|k| rows[i][k] * solution[k]).sum();
        solution[i] = (rows[i][size] - known) / rows[i][i];
    }
    solution
}
