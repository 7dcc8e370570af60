//! The paper on the design and analysis of V-belt pulleys.

mod figures;
mod rows;
mod tables;
mod thickness;

use super::{Inputs, Lost, Paper, Reproduction};
use crate::models::evaluate;

/// Everything of this paper.
pub(super) fn reproduce() -> Reproduction {
    let studied = thickness::study();
    let mut figures = vec![figures::loads(), thickness::figure(&studied)];
    figures.extend(TYPES.iter().map(figures::stresses));
    let tables = vec![tables::data(), thickness::table(&studied)];
    Reproduction { figures, tables, comparisons: rows::all(&studied), lost: LOST.to_vec() }
}

const LOST: &[Lost] = &[
    Lost {
        group: Paper::Pulley,
        what: "Figs 1, 2 and 5 to 7",
        why: "The scan has no pictures: the sections of the four types, the solid model and its loads are not known. Four sections of the same \
              kinds are computed in their place, with dimensions of our choice.",
    },
    Lost {
        group: Paper::Pulley,
        what: "Figs 3 and 4",
        why: "Free bodies of belt and pulley: there is nothing to compute in them but (1) to (16).",
    },
    Lost {
        group: Paper::Pulley,
        what: "Figs 8 to 12",
        why: "Flow of the program and its dialogs. What stood in them, three thicknesses, the points P1 and P2, stresses and volumes, is lost; the \
              text gives the chosen thickness alone.",
    },
    Lost {
        group: Paper::Pulley,
        what: "the stresses of Fig. 13",
        why: "The pictures are lost and no number is printed. The text says where stresses are high, which is compared.",
    },
];

/// A type of pulley.
struct Type {
    /// Name of the figure.
    id: &'static str,
    preset: &'static str,
    words: &'static str,
}

const TYPES: [Type; 4] = [
    Type { id: "pulley-fig-13-machined", preset: "machined", words: "type 1, machined" },
    Type { id: "pulley-fig-13-welded-discs", preset: "welded-discs", words: "type 2, two welded discs" },
    Type { id: "pulley-fig-13-double-groove", preset: "double-groove", words: "type 3, double groove" },
    Type { id: "pulley-fig-13-pressed-cup", preset: "pressed-cup", words: "type 4, pressed cup" },
];

impl Type {
    fn pulley(&self) -> Inputs {
        Inputs::preset("pulley", self.preset)
    }
}

/// The example of the paper: the pressed cup under the data of Table 1.
fn example() -> Inputs {
    Inputs::of("pulley")
}

/// The model's own sentence on where the largest stress stands.
fn place_of_largest(pulley: &Inputs) -> String {
    let evaluation = evaluate(pulley.model, &pulley.values);
    let notes = pulley.model.notes.map(|notes| notes(&pulley.values, &evaluation)).unwrap_or_default();
    let sentence = notes.into_iter().find(|note| note.starts_with(LARGEST)).expect("the model says where");
    sentence[LARGEST.len()..].to_owned()
}

const LARGEST: &str = "the largest stress stands ";
