//! The deck of CalculiX.

use super::forces::{Forces, closed_form};
use super::job::Job;
use super::sweep::Sweep;
use crate::pulley::mesh::Mesh;
use glam::DVec3;
use std::fmt::Write as _;
use std::io::{self, Write};

/// Numbers per line of a set.
const PER_LINE: usize = 16;

/// Writes a static analysis of a meshed section under the loads of a job.
///
/// # Errors
/// Those of `out`.
pub fn write_deck(out: &mut impl Write, mesh: &Mesh, job: &Job) -> io::Result<()> {
    let sweep = Sweep::new(mesh, job.sectors);
    let positions = sweep.positions(mesh);
    let forces = Forces::new(mesh, &sweep, &job.dimensions, &job.case);
    comments(out, job, &forces, &positions)?;
    writeln!(out, "*NODE, NSET=NALL")?;
    for (number, at) in positions.iter().enumerate() {
        writeln!(out, "{},{:.12},{:.12},{:.12}", number + 1, at.x, at.y, at.z)?;
    }
    elements(out, mesh, &sweep)?;
    sets(out, mesh, &sweep)?;
    writeln!(out, "*MATERIAL, NAME=SHEET\n*ELASTIC\n{},{}\n*DENSITY\n{:e}", job.case.modulus, job.poisson, job.density)?;
    writeln!(out, "*SOLID SECTION, ELSET=EALL, MATERIAL=SHEET")?;
    writeln!(out, "*BOUNDARY\nNFIXED,1,3\n*STEP\n*STATIC")?;
    if job.speed_squared() > 0.0 {
        writeln!(out, "** Spin: square of the angular speed in 1/s^2, then a point and the direction of the axis")?;
        writeln!(out, "*DLOAD\nEALL,CENTRIF,{},0.,0.,0.,0.,0.,1.", job.speed_squared())?;
    }
    writeln!(out, "** Belt and bolt heads as consistent forces on the nodes, N\n*CLOAD")?;
    for (number, force) in forces.nodes.iter().enumerate() {
        for (axis, value) in force.to_array().into_iter().enumerate().filter(|(_, value)| *value != 0.0) {
            writeln!(out, "{},{},{value:.11e}", number + 1, axis + 1)?;
        }
    }
    writeln!(out, "*NODE PRINT, NSET=NSURFACE\nU\n*NODE PRINT, NSET=NFIXED\nRF\n*EL PRINT, ELSET=EALL, TOTALS=ONLY\nEVOL")?;
    writeln!(out, "*NODE FILE\nU\n*END STEP")
}

/// The first lines: what the deck is, all inputs, the sum of the forces.
fn comments(out: &mut impl Write, job: &Job, forces: &Forces, positions: &[DVec3]) -> io::Result<()> {
    writeln!(out, "** V-belt pulley, section type {}, swept around its axis: static analysis by CalculiX", job.kind.name())?;
    writeln!(out, "** written by beltspace {}", env!("CARGO_PKG_VERSION"))?;
    writeln!(out, "** Units: N, mm, MPa, s, t; angles in rad. The axis is z, the bracket face z = 0; the belt's slack end lies on x.")?;
    writeln!(out, "** Fixed: the bracket face, in all directions. Inputs, which beltspace reads back to compare:")?;
    for (name, value) in job.entries() {
        writeln!(out, "** {name} = {value}")?;
    }
    let total = forces.total(positions);
    let exact = closed_form(&job.dimensions, &job.case);
    let list = |v: DVec3| format!("({:.6}, {:.6}, {:.6})", v.x, v.y, v.z);
    writeln!(out, "** Forces on the nodes add up to {} N, moments about the origin to {} N mm", list(total.force), list(total.moment))?;
    writeln!(out, "** In closed form: force {} N, moment about the axis {:.6} N mm", list(exact.force), exact.moment.z)?;
    writeln!(out, "** Stresses that CalculiX extrapolates to the nodes are up to a third too low in tight bends: read them from the")?;
    writeln!(out, "** displacements of the surface instead, as beltspace does.")
}

fn elements(out: &mut impl Write, mesh: &Mesh, sweep: &Sweep) -> io::Result<()> {
    let mut number = 0;
    for (corners, name) in [(4, "C3D20R"), (3, "C3D15")] {
        let mut headed = false;
        for sector in 0..sweep.sectors() {
            for element in mesh.elements.iter().filter(|element| element.corners() == corners) {
                if !headed {
                    writeln!(out, "*ELEMENT, TYPE={name}, ELSET=EALL")?;
                    headed = true;
                }
                number += 1;
                let mut line = number.to_string();
                for (place, node) in sweep.element(sector, element).into_iter().enumerate() {
                    // CalculiX reads at most sixteen numbers from a line.
                    line.push_str(if place == PER_LINE - 1 { ",\n" } else { "," });
                    let _ = write!(line, "{}", node + 1);
                }
                writeln!(out, "{line}")?;
            }
        }
    }
    Ok(())
}

fn sets(out: &mut impl Write, mesh: &Mesh, sweep: &Sweep) -> io::Result<()> {
    let fixed = mesh.fixed();
    let all = 0..mesh.nodes.len() as u32;
    let fixed: Vec<usize> = all.filter(|&node| fixed[node as usize]).flat_map(|node| sweep.ring(node)).collect();
    let mut surface: Vec<u32> = mesh.surface.iter().flat_map(|edge| edge.nodes).chain([mesh.rim]).collect();
    surface.sort_unstable();
    surface.dedup();
    let planes = 0..sweep.sectors();
    let surface: Vec<usize> = planes.flat_map(|sector| surface.iter().map(move |&node| sweep.on_plane(sector, node))).collect();
    for (name, nodes) in [("NFIXED", fixed), ("NSURFACE", surface)] {
        writeln!(out, "*NSET, NSET={name}")?;
        for line in nodes.chunks(PER_LINE) {
            let numbers: Vec<String> = line.iter().map(|node| (node + 1).to_string()).collect();
            writeln!(out, "{}", numbers.join(","))?;
        }
    }
    Ok(())
}
