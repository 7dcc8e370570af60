//! Numbers the nodes of a mesh so that the equations have a narrow band: reverse Cuthill-McKee.

use super::mesh::{Element, Mesh, MeshEdge};
use glam::DVec2;
use std::collections::VecDeque;

/// The same mesh with its nodes in another order; nodes that no element has are left out.
pub fn renumbered(mesh: Mesh) -> Mesh {
    let count = mesh.nodes.len();
    let mut neighbours: Vec<Vec<u32>> = vec![Vec::new(); count];
    for element in &mesh.elements {
        for &node in element.nodes() {
            neighbours[node as usize].extend(element.nodes().iter().filter(|&&other| other != node));
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    // Ends of the section are good places to start; which is best depends on its branches.
    let ends: [fn(DVec2) -> f64; 4] = [|at| at.y, |at| -at.y, |at| at.x - 2.0 * at.y, |at| -at.x - 2.0 * at.y];
    let used = || (0..count as u32).filter(|&node| !neighbours[node as usize].is_empty());
    let start = |far: fn(DVec2) -> f64| used().min_by(|&a, &b| far(mesh.nodes[a as usize]).total_cmp(&far(mesh.nodes[b as usize])));
    let walks = ends.into_iter().filter_map(start).map(|start| walk(&neighbours, start));
    let order = walks.min_by_key(|order| effort(&neighbours, order)).unwrap_or_default();
    let mut new = vec![u32::MAX; count];
    for (number, &node) in order.iter().rev().enumerate() {
        new[node as usize] = number as u32;
    }
    let of = |node: u32| new[node as usize];
    let element = |element: &Element| {
        let nodes = element.nodes();
        match *nodes {
            [a, b, c, ab, bc, ca] => Element::triangle([a, b, c, ab, bc, ca].map(of)),
            _ => Element::quadrilateral(std::array::from_fn(|place| of(nodes[place]))),
        }
    };
    Mesh {
        nodes: order.iter().rev().map(|&node| mesh.nodes[node as usize]).collect(),
        elements: mesh.elements.iter().map(element).collect(),
        surface: mesh.surface.iter().map(|edge| MeshEdge { nodes: edge.nodes.map(of), ..*edge }).collect(),
        points: mesh.points.iter().map(|point| super::mesh::CheckPoint { node: of(point.node), ..*point }).collect(),
        rim: of(mesh.rim),
        singular: mesh.singular.clone(),
    }
}

/// What elimination costs in this order, reversed: the sum of squares of how many nodes each row reaches.
fn effort(neighbours: &[Vec<u32>], order: &[u32]) -> u64 {
    let mut place = vec![0; neighbours.len()];
    for (number, &node) in order.iter().rev().enumerate() {
        place[node as usize] = number as u64;
    }
    let mut last = 0;
    let mut reach = |node: u32| {
        let own = neighbours[node as usize].iter().map(|&it| place[it as usize]).max().unwrap_or(0);
        last = own.max(last);
        (last - place[node as usize].min(last)).pow(2)
    };
    order.iter().rev().map(|&node| reach(node)).sum()
}

/// Nodes in the order of their distance from the first, those with few neighbours first among equals.
fn walk(neighbours: &[Vec<u32>], start: u32) -> Vec<u32> {
    let mut seen = vec![false; neighbours.len()];
    let mut queue = VecDeque::from([start]);
    let mut order = Vec::with_capacity(neighbours.len());
    seen[start as usize] = true;
    while let Some(node) = queue.pop_front() {
        order.push(node);
        let mut next: Vec<u32> = neighbours[node as usize].iter().copied().filter(|&it| !seen[it as usize]).collect();
        next.sort_by_key(|&it| (neighbours[it as usize].len(), it));
        for it in next {
            seen[it as usize] = true;
            queue.push_back(it);
        }
    }
    order
}
