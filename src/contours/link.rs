//! Links the crossed edges of a grid to polylines, by marching squares.

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

/// The answers at all nodes, row by row.
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

    /// The edges whose ends have different answers, by node, first along x.
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

    /// Links edges, each of which has a vertex, to lines: positions among `edges`, with the true side on the left. First come the lines
    /// with two ends, then the closed ones, in the order of the edges that they start from; a closed line starts from its first edge and
    /// ends there. `centre` is the answer in the middle of the cell above and to the right of a node.
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
                // Corners and edges in order around the cell, edge k between the corners k and k + 1.
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

/// The pieces of line within a cell, from edge to edge. Going around the cell, a piece enters where false changes to true and leaves where
/// true changes to false, so that the true side is on its left.
///
/// A corner without an answer removes its two edges; the other two edges may still give a piece.
fn pieces(corners: [Option<bool>; 4], centre: impl FnOnce() -> bool) -> [Option<(usize, usize)>; 2] {
    let changes = |edge: &usize, from: bool| corners[*edge] == Some(from) && corners[(edge + 1) % 4] == Some(!from);
    let mut from = (0..4).filter(|edge| changes(edge, true));
    let mut to = (0..4).filter(|edge| changes(edge, false));
    match (from.next(), from.next(), to.next()) {
        (Some(first), Some(second), _) => {
            // A saddle. If the middle is true, it joins the true corners, and each piece goes around a false corner, which comes next.
            let step = if centre() { 1 } else { 3 };
            [Some((first, (first + step) % 4)), Some((second, (second + step) % 4))]
        }
        (Some(from), None, Some(to)) => [Some((from, to)), None],
        _ => [None, None],
    }
}
