//! Cholesky factors and solutions, a panel of columns at a time.

#![allow(clippy::needless_range_loop, reason = "loops of one index over several slices are what the compiler makes vectors of")]

use super::Coupling;
use crate::pulley::wide::{WIDTH, Wide};
use std::array::from_fn;
use std::ops::Range;

/// Columns that are eliminated together: their effect on the rest is applied in one pass.
pub const PANEL: usize = 4;

/// Where the factors of each panel stand: its columns one after another, each from its diagonal down. All are as long as the first, so the
/// last numbers of the others are not used.
#[derive(Debug)]
pub struct Panels {
    /// Where each starts, and the end of the last.
    starts: Vec<usize>,
}

impl Panels {
    /// From the rows that the elimination of each panel affects, its own included.
    pub fn new(rows: impl Iterator<Item = usize>) -> Self {
        let mut starts = vec![0];
        starts.extend(rows.scan(0, |end, rows| {
            *end += PANEL * rows;
            Some(*end)
        }));
        Self { starts }
    }

    fn count(&self) -> usize {
        self.starts.len() - 1
    }

    /// Numbers of all panels.
    pub fn length(&self) -> usize {
        self.starts[self.count()]
    }

    fn range(&self, panel: usize) -> Range<usize> {
        self.starts[panel]..self.starts[panel + 1]
    }

    /// Numbers of one column, and rows that the elimination affects.
    fn rows(&self, panel: usize) -> usize {
        self.range(panel).len() / PANEL
    }
}

/// The matrices `K0 + k K1 + k^2 K2` of four harmonics.
#[derive(Clone, Copy, Debug)]
pub struct Harmonics<'m> {
    /// Per node, its coupling with itself and `half` nodes after it.
    pub couplings: &'m [Coupling],
    /// Nodes, each with three rows.
    pub nodes: usize,
    /// Nodes after each with which it may be coupled.
    pub half: usize,
    /// k.
    pub orders: Wide,
}

impl Harmonics<'_> {
    /// Writes a column from its diagonal down. Columns beyond the last, which fill the last panel, are those of the identity.
    #[inline(always)]
    fn write(&self, number: usize, column: &mut [Wide]) {
        match number % 3 {
            _ if number >= 3 * self.nodes => {
                column.fill(Wide::ZERO);
                column[0] = Wide::ONE;
            }
            0 => self.write_axis::<0>(number / 3, column),
            1 => self.write_axis::<1>(number / 3, column),
            _ => self.write_axis::<2>(number / 3, column),
        }
    }

    #[inline(always)]
    fn write_axis<const AXIS: usize>(&self, node: usize, column: &mut [Wide]) {
        let couplings = &self.couplings[node * (self.half + 1)..][..=self.half];
        let (own, below) = column.split_at_mut(3 - AXIS);
        own.copy_from_slice(&self.rows::<AXIS>(&couplings[0])[AXIS..]);
        let (nodes, rest) = below.as_chunks_mut::<3>();
        let (coupled, beyond) = nodes.split_at_mut(nodes.len().min(self.half));
        for (rows, coupling) in coupled.iter_mut().zip(&couplings[1..]) {
            *rows = self.rows::<AXIS>(coupling);
        }
        beyond.fill([Wide::ZERO; 3]);
        let last = couplings.get(1 + coupled.len()).filter(|_| beyond.is_empty()).map(|coupling| self.rows::<AXIS>(coupling));
        rest.copy_from_slice(&last.unwrap_or([Wide::ZERO; 3])[..rest.len()]);
    }

    /// What a coupling has in one column, row by row.
    #[inline(always)]
    fn rows<const AXIS: usize>(&self, [rr, rz, zr, zz, tt, rt, zt, tr, tz, rr2, zz2, tt2]: &Coupling) -> [Wide; 3] {
        let alone = |part: f64| Wide([part; WIDTH]);
        let first = |part: f64| {
            let mut wide = Wide::ZERO;
            for lane in 0..WIDTH {
                wide[lane] += self.orders[lane] * part;
            }
            wide
        };
        let second = |part: f64, square: f64| {
            let mut wide = alone(part);
            for lane in 0..WIDTH {
                wide[lane] += self.orders[lane] * (self.orders[lane] * square);
            }
            wide
        };
        match AXIS {
            0 => [second(*rr, *rr2), alone(*zr), first(*tr)],
            1 => [alone(*rz), second(*zz, *zz2), first(*tz)],
            _ => [first(*rt), first(*zt), second(*tt, *tt2)],
        }
    }
}

/// The inverse of the square root of a diagonal, in its place.
#[inline(always)]
fn invert(diagonal: &mut Wide) -> Wide {
    for lane in 0..WIDTH {
        diagonal[lane] = 1.0 / diagonal[lane].sqrt();
    }
    *diagonal
}

/// Eliminates the columns of a panel, given from their diagonals down, among themselves: they become factors, with the inverse on the
/// diagonal. So it does the right sides in the rows of the panel, which start with row `first`.
#[inline(always)]
fn eliminate([a, b, c, d]: [&mut [Wide]; PANEL], sides: &mut [&mut [Wide]], first: usize) {
    let ia = invert(&mut a[0]);
    let [mut ba, mut ca, mut da] = [a[1], a[2], a[3]];
    ba.multiply(&ia);
    ca.multiply(&ia);
    da.multiply(&ia);
    b[0].subtract(&ba, &ba);
    let ib = invert(&mut b[0]);
    let [mut cb, mut db] = [b[1], b[2]];
    cb.subtract(&ca, &ba);
    cb.multiply(&ib);
    db.subtract(&da, &ba);
    db.multiply(&ib);
    c[0].subtract(&ca, &ca);
    c[0].subtract(&cb, &cb);
    let ic = invert(&mut c[0]);
    let mut dc = c[1];
    dc.subtract(&da, &ca);
    dc.subtract(&db, &cb);
    dc.multiply(&ic);
    d[0].subtract(&da, &da);
    d[0].subtract(&db, &db);
    d[0].subtract(&dc, &dc);
    let id = invert(&mut d[0]);
    (a[1], a[2], a[3], b[1], b[2], c[1]) = (ba, ca, da, cb, db, dc);
    let block = DiagonalBlock { ia, ib, ic, id, ba, ca, cb, da, db, dc };
    for (((a, b), c), d) in a[4..].iter_mut().zip(&mut b[3..]).zip(&mut c[2..]).zip(&mut d[1..]) {
        block.eliminate(a, b, c, d);
    }
    for side in sides {
        let [a, b, c, d] = &mut side[first..].as_chunks_mut::<PANEL>().0[0];
        block.eliminate(a, b, c, d);
    }
}

/// What a panel's columns have in its own rows: row and column, and the inverse of each diagonal.
#[derive(Clone, Copy, Debug)]
struct DiagonalBlock {
    ia: Wide,
    ba: Wide,
    ib: Wide,
    ca: Wide,
    cb: Wide,
    ic: Wide,
    da: Wide,
    db: Wide,
    dc: Wide,
    id: Wide,
}

impl DiagonalBlock {
    /// Takes the earlier columns out of each later number of a row, or of a right side. In a closure, which the compiler does not inline into
    /// the code for wide vectors, sections take up to a third longer.
    #[inline(always)]
    fn eliminate(&self, a: &mut Wide, b: &mut Wide, c: &mut Wide, d: &mut Wide) {
        a.multiply(&self.ia);
        b.subtract(&self.ba, a);
        b.multiply(&self.ib);
        c.subtract(&self.ca, a);
        c.subtract(&self.cb, b);
        c.multiply(&self.ic);
        d.subtract(&self.da, a);
        d.subtract(&self.db, b);
        d.subtract(&self.dc, c);
        d.multiply(&self.id);
    }
}

/// Factors and solves in one pass down and one up: a panel is made just before the elimination reaches it and used for the right
/// sides while it is at hand, so that only the factors go to memory and back.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw+avx2+fma", "x86_64+avx2"))]
pub fn solve<const COUNT: usize>(matrices: &Harmonics<'_>, panels: &Panels, factors: &mut [Wide], mut sides: [&mut [Wide]; COUNT]) {
    let mut written = 0;
    // Right sides that are still zero need no work.
    let mut loaded = [false; COUNT];
    for panel in 0..panels.count() {
        let (first, rows) = (panel * PANEL, panels.rows(panel));
        while written * PANEL < first + rows {
            let columns = factors[panels.range(written)].chunks_exact_mut(panels.rows(written));
            for (number, column) in columns.enumerate() {
                matrices.write(written * PANEL + number, column);
            }
            written += 1;
        }
        let reach = rows - PANEL;
        let (a, rest) = factors[panels.starts[panel]..].split_at_mut(rows);
        let (b, rest) = rest.split_at_mut(rows);
        let (c, rest) = rest.split_at_mut(rows);
        let (d, later) = rest.split_at_mut(rows);
        eliminate([&mut *a, &mut b[..rows - 1], &mut c[..rows - 2], &mut d[..rows - 3]], &mut sides, first);
        let (a, b, c, d) = (&a[4..], &b[3..][..reach], &c[2..][..reach], &d[1..][..reach]);
        apply([a, b, c, d], later, |next| panels.rows(panel + 1 + next / PANEL));
        for (side, loaded) in sides.iter_mut().zip(&mut loaded) {
            let (known, below) = side[first..].split_at_mut(PANEL);
            let known = [known[0], known[1], known[2], known[3]];
            *loaded |= known.iter().any(|value| value.0 != [0.0; WIDTH]);
            if *loaded {
                let below = &mut below[..reach];
                for i in 0..reach {
                    below[i].subtract_four([&a[i], &b[i], &c[i], &d[i]], &known);
                }
            }
        }
    }
    for panel in (0..panels.count()).rev() {
        let rows = panels.rows(panel);
        let own = &factors[panels.range(panel)];
        // Two rows in one pass: the sums of one alone would wait for each other.
        for row in [2, 0] {
            let upper = &own[row * rows..][..rows - row];
            let lower = &own[(row + 1) * rows..][..rows - row - 1];
            let count = upper.len() - 2;
            let (from_upper, from_lower) = (&upper[2..][..count], &lower[1..][..count]);
            let first = panel * PANEL + row;
            let below: [&[Wide]; COUNT] = from_fn(|side| &sides[side][first + 2..][..count]);
            let mut own: [Wide; COUNT] = from_fn(|side| sides[side][first]);
            let mut next: [Wide; COUNT] = from_fn(|side| sides[side][first + 1]);
            for i in 0..count {
                for side in 0..COUNT {
                    own[side].subtract(&from_upper[i], &below[side][i]);
                    next[side].subtract(&from_lower[i], &below[side][i]);
                }
            }
            for side in 0..COUNT {
                next[side].multiply(&lower[0]);
                own[side].subtract(&upper[1], &next[side]);
                own[side].multiply(&upper[0]);
                (sides[side][first], sides[side][first + 1]) = (own[side], next[side]);
            }
        }
    }
}

/// Subtracts the products of an eliminated panel from the later columns that it reaches, `later`; `rows` says how long each of them is.
#[inline(always)]
fn apply([a, b, c, d]: [&[Wide]; PANEL], mut later: &mut [Wide], rows: impl Fn(usize) -> usize) {
    // Two columns in one pass share what is loaded of the panel.
    for next in (0..a.len()).step_by(2) {
        let length = a.len() - next;
        let (column, rest) = later.split_at_mut(rows(next));
        let (a, b, c, d) = (&a[next..], &b[next..][..length], &c[next..][..length], &d[next..][..length]);
        let own = [a[0], b[0], c[0], d[0]];
        column[0].subtract_four([&a[0], &b[0], &c[0], &d[0]], &own);
        if length == 1 {
            return;
        }
        let length = length - 1;
        let (a, b, c, d) = (&a[1..][..length], &b[1..][..length], &c[1..][..length], &d[1..][..length]);
        let following = [a[0], b[0], c[0], d[0]];
        let rows = column.len();
        let (column, after) = (&mut column[1..][..length], &mut rest[..length]);
        for i in 0..length {
            let known = [&a[i], &b[i], &c[i], &d[i]];
            column[i].subtract_four(known, &own);
            after[i].subtract_four(known, &following);
        }
        later = &mut rest[rows..];
    }
}
