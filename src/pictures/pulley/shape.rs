//! Shapes of a meshed section: its boundary, and smooth colours inside its elements.

use super::super::colours::{STEPS, step_colour, step_of};
use super::drawing::DrawingScale;
use crate::pulley::element::value_at;
use crate::pulley::mesh::{Element, Mesh};
use glam::DVec2;
use plotters::style::RGBColor;
use std::collections::HashMap;
use std::fmt::Write;

/// Sides of elements that belong to one element only: start, middle and end, in loops where they meet.
pub(super) fn boundary(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut count: HashMap<(u32, u32), u32> = HashMap::new();
    let sides = || mesh.elements.iter().flat_map(sides);
    for [a, _, b] in sides() {
        *count.entry((a.min(b), a.max(b))).or_default() += 1;
    }
    let single: Vec<[u32; 3]> = sides().filter(|[a, _, b]| count[&(*a.min(b), *a.max(b))] == 1).collect();
    // One after the other, so that a loop becomes one path.
    let mut left: Vec<Option<[u32; 3]>> = single.iter().copied().map(Some).collect();
    let mut order = Vec::with_capacity(single.len());
    let starts: HashMap<u32, usize> = single.iter().enumerate().map(|(number, side)| (side[0], number)).collect();
    for first in 0..single.len() {
        let mut next = Some(first);
        while let Some(side) = next.and_then(|number| left[number].take()) {
            order.push(side);
            next = starts.get(&side[2]).copied();
        }
    }
    order
}

fn sides(element: &Element) -> impl Iterator<Item = [u32; 3]> + '_ {
    let (nodes, corners) = (element.nodes(), element.corners());
    (0..corners).map(move |side| [nodes[side], nodes[corners + side], nodes[(side + 1) % corners]])
}

/// Elements as small polygons in the colours of a value at the nodes, as SVG elements: one path per colour.
pub(super) fn coloured(mesh: &Mesh, places: &[DVec2], values: &[f64], (low, high): (f64, f64), scale: &DrawingScale) -> String {
    let mut paths = vec![String::new(); STEPS];
    for element in &mesh.elements {
        let nodes = element.nodes();
        let steps = nodes.iter().map(|&node| step_of(values[node as usize], low, high));
        let (least, most) = (steps.clone().min().unwrap_or(0), steps.max().unwrap_or(0));
        let parts = (1 + (most - least) / 4).clamp(2, 6);
        for polygon in polygons(element.corners(), parts) {
            let middle = polygon.iter().copied().sum::<DVec2>() / polygon.len() as f64;
            let value: f64 = value_at(element, middle, |node| values[node]);
            let path = &mut paths[step_of(value, low, high)];
            let mut last = (0, 0);
            for (number, at) in polygon.iter().enumerate() {
                let place = DVec2::new(value_at(element, *at, |node| places[node].x), value_at(element, *at, |node| places[node].y));
                let (x, y) = scale.place(place);
                let command = if number == 0 { 'M' } else { 'l' };
                write!(path, "{command}{} {}", x - last.0, y - last.1).expect("writing into a string does not fail");
                last = (x, y);
            }
            path.push('Z');
        }
    }
    let mut text = String::new();
    for (step, path) in paths.iter().enumerate().filter(|(_, path)| !path.is_empty()) {
        let RGBColor(r, g, b) = step_colour(step);
        let colour = format!("#{r:02X}{g:02X}{b:02X}");
        // The thin line hides the seams between neighbours.
        writeln!(text, "<path d=\"{path}\" fill=\"{colour}\" stroke=\"{colour}\" stroke-width=\"4\"/>").expect("writing does not fail");
    }
    text
}

/// Parts of an element in its own coordinates.
fn polygons(corners: usize, parts: usize) -> Vec<Vec<DVec2>> {
    let share = |step: usize| step as f64 / parts as f64;
    let mut polygons = Vec::new();
    for i in 0..parts {
        for j in 0..parts {
            let ([left, right], [low, high]) = ([share(i), share(i + 1)], [share(j), share(j + 1)]);
            if corners == 4 {
                let at = |x: f64, y: f64| DVec2::new(2.0 * x - 1.0, 2.0 * y - 1.0);
                polygons.push(vec![at(left, low), at(right, low), at(right, high), at(left, high)]);
            } else if i + j < parts {
                polygons.push(vec![DVec2::new(left, low), DVec2::new(right, low), DVec2::new(left, high)]);
                if i + j + 1 < parts {
                    polygons.push(vec![DVec2::new(right, low), DVec2::new(right, high), DVec2::new(left, high)]);
                }
            }
        }
    }
    polygons
}

/// Places on a line of sides, near enough to each other to stand for it.
pub(super) fn dense(sides: impl IntoIterator<Item = [DVec2; 3]>) -> Vec<DVec2> {
    let on = |[a, b, c]: [DVec2; 3], t: f64| a * ((1.0 - t) * (1.0 - 2.0 * t)) + b * (4.0 * t * (1.0 - t)) + c * (t * (2.0 * t - 1.0));
    sides.into_iter().flat_map(|side| (0..4).map(move |part| on(side, f64::from(part) / 4.0))).collect()
}
