//! The pulley as a three-dimensional model for CalculiX, and the comparison of its results with the harmonics.
//!
//! [`export`] writes the deck of a [`Job`]: the same section, swept around the axis, under the same loads. After `ccx` has solved it,
//! [`compare()`] reads the displacements and compares stresses, rim displacement, volume and reactions with those of the harmonics.
//!
//! Solver, elements and the way around the axis are CalculiX's own; section mesh, loads and supports come from the same description as the
//! harmonics', so the comparison says nothing about these.

mod compare;
mod deck;
mod forces;
mod job;
mod recovery;
mod results;
mod sweep;

pub use compare::{ComparedQuantity, compare};
pub use deck::write_deck;
pub use forces::{Forces, Wrench, closed_form};
pub use job::Job;
pub use recovery::{Surface, SurfaceStress};
pub use results::Results;
pub use sweep::Sweep;

use super::section::{self, Flaw};
use crate::error::Error;
use crate::files::{MOVE, refuse_foreign, replace_with};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Name of the deck, without `.inp`, and of the files that CalculiX writes.
pub const NAME: &str = "pulley";

/// Why there is no deck or no comparison.
#[derive(Debug, thiserror::Error)]
pub enum CalculixError {
    /// The section is impossible.
    #[error("{0}")]
    Flaw(Flaw),
    /// A file cannot be read or written.
    #[error("{}: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// A file is there that this program did not write.
    #[error("{what}")]
    Taken {
        /// Which, and what to do.
        what: String,
    },
    /// A file without the expected contents.
    #[error("{what}")]
    Unreadable {
        /// What is wrong.
        what: String,
    },
}

/// Writes `pulley.inp` and a `README.txt` into a directory, which is made if it does not exist.
///
/// # Errors
/// An impossible section, a file that cannot be written, or one that this program did not write.
pub fn export(job: &Job, directory: &Path) -> Result<(), CalculixError> {
    let mesh = section::mesh(job.kind, &job.dimensions, &job.fineness).map_err(CalculixError::Flaw)?;
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| CalculixError::File { path, source }
    };
    fs::create_dir_all(directory).map_err(failed(directory))?;
    let [deck, readme] = [format!("{NAME}.inp"), "README.txt".to_owned()].map(|name| directory.join(name));
    let first_line = HOW_TO.lines().next().unwrap_or_default();
    let own = refuse_foreign(&deck, MOVE, |head| head.contains("** written by beltspace "))
        .and_then(|()| refuse_foreign(&readme, MOVE, |head| head.starts_with(first_line)));
    own.map_err(|error| CalculixError::Taken { what: error.to_string() })?;
    let write = |path: &Path, text: &dyn Fn(&mut dyn io::Write) -> io::Result<()>| {
        replace_with(path, |out| text(out)).map_err(|error| match error {
            Error::Io { path, source } => CalculixError::File { path, source },
            other => CalculixError::Taken { what: other.to_string() },
        })
    };
    write(&deck, &|mut out| write_deck(&mut out, &mesh, job))?;
    write(&readme, &|out| out.write_all(HOW_TO.as_bytes()))
}

const HOW_TO: &str = "\
pulley.inp is a static analysis of a V-belt pulley for CalculiX (https://www.calculix.de), made by beltspace. Its first lines list
every input and the sums of the forces. Units: N, mm, MPa, s, t.

Run it in this directory, on two CPUs:

    OMP_NUM_THREADS=2 ccx -i pulley

This writes
    pulley.dat   displacements of the surface (planes between the sectors), reactions of the bracket face, volume
    pulley.frd   displacements of all nodes, for cgx or another viewer

The axis is z, the bracket face lies in z = 0 and is fixed, the belt's slack end lies on the x axis and its tight end at the wrap angle.
Stress is not printed: what CalculiX extrapolates to the nodes is up to a third too low in tight bends. beltspace recovers it from the
displacements of the surface.
";
