//! Crossed edges of a grid, linked to polylines by marching squares.

/// The axis that an edge runs along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// The horizontal one.
    X,
    /// The vertical one.
    Y,
}

/// The edge from a node of the grid to the next one along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Edge {
    /// Column of the node.
    pub column: usize,
    /// Row of the node.
    pub row: usize,
    /// Where the next one is.
    pub along: Along,
}

/// No vertex, or no successor.
const NONE: usize = usize::MAX;

/// The answers of all nodes, row by row.
pub(super) struct Grid<'a> {
    pub columns: usize,
    pub answers: &'a [Option<bool>],
}

impl Grid<'_> {
    fn rows(&self) -> usize {
        self.answers.len() / self.columns.max(1)
    }

    fn answer(&self, column: usize, row: usize) -> Option<bool> {
        self.answers[row * self.columns + column]
    }

    /// The edges whose ends answer differently, by node, first along x.
    pub fn crossed(&self) -> Vec<Edge> {
        let mut edges = Vec::new();
        for row in 0..self.rows() {
            for column in 0..self.columns {
                let Some(here) = self.answer(column, row) else { continue };
                let other = |answer: Option<bool>| answer.is_some_and(|answer| answer != here);
                if column + 1 < self.columns && other(self.answer(column + 1, row)) {
                    edges.push(Edge { column, row, along: Along::X });
                }
                if row + 1 < self.rows() && other(self.answer(column, row + 1)) {
                    edges.push(Edge { column, row, along: Along::Y });
                }
            }
        }
        edges
    }

    /// Links edges, each of which holds a vertex, to lines: positions among `edges`, with the true side on the left. First the lines
    /// with two ends, then the closed ones, each by the edge that it starts from; a closed one starts from its first edge and ends
    /// there too. `centre` is the answer in the middle of the cell above and right of a node.
    pub fn link(&self, edges: &[Edge], centre: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
        let place = |column: usize, row: usize, along: Along| 2 * (row * self.columns + column) + usize::from(along == Along::Y);
        let mut vertex = vec![NONE; 2 * self.answers.len()];
        for (at, edge) in edges.iter().enumerate() {
            vertex[place(edge.column, edge.row, edge.along)] = at;
        }
        let mut next = vec![NONE; edges.len()];
        let mut led_to = vec![false; edges.len()];
        for row in 1..self.rows() {
            let row = row - 1;
            for column in 1..self.columns {
                let column = column - 1;
                // Corners and edges in turn around the cell, edge k between the corners k and k + 1.
                let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| self.answer(column + right, row + up));
                let around = [
                    place(column, row, Along::X),
                    place(column + 1, row, Along::Y),
                    place(column, row + 1, Along::X),
                    place(column, row, Along::Y),
                ];
                for (from, to) in pieces(corners, || centre(column, row)).into_iter().flatten() {
                    let (from, to) = (vertex[around[from]], vertex[around[to]]);
                    if from != NONE && to != NONE {
                        next[from] = to;
                        led_to[to] = true;
                    }
                }
            }
        }
        let mut taken = vec![false; edges.len()];
        let mut lines = Vec::new();
        let starts = (0..edges.len()).filter(|&at| !led_to[at]);
        for start in starts.chain(0..edges.len()) {
            if taken[start] {
                continue;
            }
            let mut line = Vec::new();
            let mut at = start;
            while at != NONE && !taken[at] {
                taken[at] = true;
                line.push(at);
                at = next[at];
            }
            if at != NONE {
                line.push(at);
            }
            lines.push(line);
        }
        lines
    }
}

/// The pieces of line within a cell, from edge to edge. Around the cell, a piece comes in where false turns into true and goes out
/// where true turns into false, seen from the true side: that keeps it on the left.
///
/// A corner without an answer takes its two edges away; what the other two edges tell is still a piece.
fn pieces(corners: [Option<bool>; 4], centre: impl FnOnce() -> bool) -> [Option<(usize, usize)>; 2] {
    let turns = |edge: &usize, from: bool| corners[*edge] == Some(from) && corners[(edge + 1) % 4] == Some(!from);
    let mut from = (0..4).filter(|edge| turns(edge, true));
    let mut to = (0..4).filter(|edge| turns(edge, false));
    match (from.next(), from.next(), to.next()) {
        (Some(first), Some(second), _) => {
            // A saddle. A true middle joins the true corners: each piece goes around a false one, which comes next.
            let step = if centre() { 1 } else { 3 };
            [Some((first, (first + step) % 4)), Some((second, (second + step) % 4))]
        }
        (Some(from), None, Some(to)) => [Some((from, to)), None],
        _ => [None, None],
    }
}
