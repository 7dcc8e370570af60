//! Cholesky factors and solutions, a panel of columns at a time.

use super::Coupling;
use crate::pulley::wide::{Vectors, WIDTH, Wide};
use pulp::{Simd, WithSimd};
use std::array::from_fn;
use std::ops::Range;

/// Columns that are eliminated together: their effect on the rest is applied in one pass.
pub const PANEL: usize = 4;
/// Panels that take up the effect of earlier ones together. Where the band is wide, the earlier panels do not fit the cache of a core: so
/// each is loaded once for a whole block.
const BLOCK: usize = 4;

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

    /// One more than the last row that the elimination of a panel affects.
    fn end(&self, panel: usize) -> usize {
        panel * PANEL + self.rows(panel)
    }

    /// Numbers of one column, and rows that the elimination affects.
    fn rows(&self, panel: usize) -> usize {
        self.range(panel).len() / PANEL
    }
}

/// The columns of a panel, each from its diagonal down.
#[inline(always)]
fn columns<T>(panel: &mut [T]) -> [&mut [T]; PANEL] {
    let rows = panel.len() / PANEL;
    let (a, rest) = panel.split_at_mut(rows);
    let (b, rest) = rest.split_at_mut(rows);
    let (c, d) = rest.split_at_mut(rows);
    [a, b, c, d]
}

/// The matrices `K0 + k K1 + k^2 K2` of several harmonics.
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

/// Writes columns of the matrices.
#[derive(Clone, Copy)]
struct ColumnWriter<'m, S: Simd, const N: usize> {
    matrices: Harmonics<'m>,
    vectors: Vectors<S, N>,
    orders: [S::f64s; N],
}

impl<S: Simd, const N: usize> ColumnWriter<'_, S, N> {
    /// Writes a column from its diagonal down. Columns beyond the last, which fill the last panel, are those of the identity.
    #[inline(always)]
    fn write(&self, number: usize, column: &mut [[S::f64s; N]]) {
        match number % 3 {
            _ if number >= 3 * self.matrices.nodes => {
                column.fill(self.vectors.all(0.0));
                column[0] = self.vectors.all(1.0);
            }
            0 => self.write_axis::<0>(number / 3, column),
            1 => self.write_axis::<1>(number / 3, column),
            _ => self.write_axis::<2>(number / 3, column),
        }
    }

    #[inline(always)]
    fn write_axis<const AXIS: usize>(&self, node: usize, column: &mut [[S::f64s; N]]) {
        let half = self.matrices.half;
        let couplings = &self.matrices.couplings[node * (half + 1)..][..=half];
        let zero = [self.vectors.all(0.0); 3];
        let (own, below) = column.split_at_mut(3 - AXIS);
        own.copy_from_slice(&self.rows::<AXIS>(&couplings[0])[AXIS..]);
        let (nodes, rest) = below.as_chunks_mut::<3>();
        let (coupled, beyond) = nodes.split_at_mut(nodes.len().min(half));
        for (rows, coupling) in coupled.iter_mut().zip(&couplings[1..]) {
            *rows = self.rows::<AXIS>(coupling);
        }
        beyond.fill(zero);
        let last = match couplings.get(1 + coupled.len()) {
            Some(coupling) if beyond.is_empty() => self.rows::<AXIS>(coupling),
            _ => zero,
        };
        for (row, value) in rest.iter_mut().zip(last) {
            *row = value;
        }
    }

    /// What a coupling has in one column, row by row.
    #[inline(always)]
    fn rows<const AXIS: usize>(&self, [rr, rz, zr, zz, tt, rt, zt, tr, tz, rr2, zz2, tt2]: &Coupling) -> [[S::f64s; N]; 3] {
        match AXIS {
            0 => [self.second(*rr, *rr2), self.vectors.all(*zr), self.first(*tr)],
            1 => [self.vectors.all(*rz), self.second(*zz, *zz2), self.first(*tz)],
            _ => [self.first(*rt), self.first(*zt), self.second(*tt, *tt2)],
        }
    }

    /// k times a part; the zero that it is added to makes zeros positive.
    #[inline(always)]
    fn first(&self, part: f64) -> [S::f64s; N] {
        let vectors = self.vectors;
        vectors.add(vectors.all(0.0), vectors.multiply(self.orders, vectors.all(part)))
    }

    /// A part and k^2 times another.
    #[inline(always)]
    fn second(&self, part: f64, square: f64) -> [S::f64s; N] {
        let vectors = self.vectors;
        let square = vectors.multiply(self.orders, vectors.multiply(self.orders, vectors.all(square)));
        vectors.add(vectors.all(part), square)
    }
}

/// What a panel's columns have in its own rows: row and column, and the inverse of each diagonal.
#[derive(Clone, Copy)]
struct DiagonalBlock<V> {
    ia: V,
    ba: V,
    ib: V,
    ca: V,
    cb: V,
    ic: V,
    da: V,
    db: V,
    dc: V,
    id: V,
}

/// Factors and solves in one pass down and one up: the panels of a block are made just before the elimination reaches them, and each is
/// used for the right sides while it is at hand, so that only the factors go to memory and back.
pub struct Solve<'m, const COUNT: usize> {
    /// The matrices.
    pub matrices: Harmonics<'m>,
    /// The panels of their factors.
    pub panels: &'m Panels,
    /// Memory for them.
    pub factors: &'m mut [Wide],
    /// Right sides, which become the solutions.
    pub sides: [&'m mut [Wide]; COUNT],
}

impl<const COUNT: usize> WithSimd for Solve<'_, COUNT> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match WIDTH / S::F64_LANES {
            1 => BandElimination::<S, 1>::solve(simd, self),
            2 => BandElimination::<S, 2>::solve(simd, self),
            4 => BandElimination::<S, 4>::solve(simd, self),
            8 => BandElimination::<S, 8>::solve(simd, self),
            _ => unreachable!("vectors hold one, two, four or eight numbers"),
        }
    }
}

/// The steps of [`Solve`] with the vectors of a processor, of which `N` hold all harmonics.
struct BandElimination<S: Simd, const N: usize> {
    vectors: Vectors<S, N>,
}

impl<S: Simd, const N: usize> BandElimination<S, N> {
    #[inline(always)]
    fn solve<const COUNT: usize>(simd: S, Solve { matrices, panels, factors, sides }: Solve<'_, COUNT>) {
        let vectors = Vectors::<S, N>::new(simd);
        let this = Self { vectors };
        let writer = ColumnWriter { matrices, vectors, orders: vectors.of(&[matrices.orders])[0] };
        let factors = vectors.of_mut(factors);
        let mut sides = sides.map(|side| vectors.of_mut(side));
        this.down(&writer, panels, factors, &mut sides);
        this.up(panels, factors, &mut sides);
    }

    #[inline(always)]
    fn down<const COUNT: usize>(
        &self,
        writer: &ColumnWriter<'_, S, N>,
        panels: &Panels,
        factors: &mut [[S::f64s; N]],
        sides: &mut [&mut [[S::f64s; N]]; COUNT],
    ) {
        // Right sides that are still zero need no work.
        let mut loaded = [false; COUNT];
        // The first panel whose elimination still affects later columns.
        let mut oldest = 0;
        for start in (0..panels.count()).step_by(BLOCK) {
            let end = panels.count().min(start + BLOCK);
            let (earlier, block) = factors.split_at_mut(panels.starts[start]);
            let block = &mut block[..panels.starts[end] - panels.starts[start]];
            let place = |panel: usize| panels.starts[panel] - panels.starts[start];
            for panel in start..end {
                for (number, column) in columns(&mut block[place(panel)..place(panel + 1)]).into_iter().enumerate() {
                    writer.write(panel * PANEL + number, column);
                }
            }
            while oldest < start && panels.end(oldest) <= start * PANEL {
                oldest += 1;
            }
            // What is far away in memory is loaded once for all panels of the block.
            for from in oldest..start {
                for panel in (start..end).take_while(|panel| panel * PANEL < panels.end(from)) {
                    self.apply(&earlier[panels.range(from)], panel - from, &mut block[place(panel)..place(panel + 1)]);
                }
            }
            for panel in start..end {
                let (before, own) = block.split_at_mut(place(panel));
                let own = &mut own[..panels.range(panel).len()];
                for from in start..panel {
                    if panel * PANEL < panels.end(from) {
                        self.apply(&before[place(from)..place(from + 1)], panel - from, own);
                    }
                }
                self.finish(panel * PANEL, own, sides, &mut loaded);
            }
        }
    }

    /// Eliminates the columns of a panel among themselves, and takes them out of the right sides. Its first row is `first`.
    #[inline(always)]
    fn finish<const COUNT: usize>(
        &self,
        first: usize,
        panel: &mut [[S::f64s; N]],
        sides: &mut [&mut [[S::f64s; N]]; COUNT],
        loaded: &mut [bool; COUNT],
    ) {
        let [a, b, c, d] = columns(panel);
        let block = self.diagonal([&mut *a, &mut *b, &mut *c, &mut *d]);
        let reach = a.len() - PANEL;
        let (a, b, c, d) = (&mut a[4..], &mut b[3..][..reach], &mut c[2..][..reach], &mut d[1..][..reach]);
        for (((a, b), c), d) in a.iter_mut().zip(&mut *b).zip(&mut *c).zip(&mut *d) {
            [*a, *b, *c, *d] = self.eliminate(&block, [*a, *b, *c, *d]);
        }
        for side in 0..COUNT {
            let (own, below) = sides[side][first..].split_at_mut(PANEL);
            let known = self.eliminate(&block, [own[0], own[1], own[2], own[3]]);
            own.copy_from_slice(&known);
            loaded[side] = loaded[side] || !self.vectors.are_zero(&known);
            if loaded[side] {
                for ((((below, a), b), c), d) in below[..reach].iter_mut().zip(&*a).zip(&*b).zip(&*c).zip(&*d) {
                    *below = self.vectors.subtract_four(*below, [*a, *b, *c, *d], &known);
                }
            }
        }
    }

    /// Eliminates the columns of a panel, given from their diagonals down, among themselves in the panel's own rows: they become factors,
    /// with the inverse on the diagonal.
    #[inline(always)]
    fn diagonal(&self, [a, b, c, d]: [&mut [[S::f64s; N]]; PANEL]) -> DiagonalBlock<[S::f64s; N]> {
        let v = self.vectors;
        let ia = v.inverse_root(a[0]);
        let (ba, ca, da) = (v.multiply(a[1], ia), v.multiply(a[2], ia), v.multiply(a[3], ia));
        let ib = v.inverse_root(v.subtract(b[0], ba, ba));
        let cb = v.multiply(v.subtract(b[1], ca, ba), ib);
        let db = v.multiply(v.subtract(b[2], da, ba), ib);
        let ic = v.inverse_root(v.subtract(v.subtract(c[0], ca, ca), cb, cb));
        let dc = v.multiply(v.subtract(v.subtract(c[1], da, ca), db, cb), ic);
        let id = v.inverse_root(v.subtract(v.subtract(v.subtract(d[0], da, da), db, db), dc, dc));
        (a[0], a[1], a[2], a[3]) = (ia, ba, ca, da);
        (b[0], b[1], b[2]) = (ib, cb, db);
        (c[0], c[1], d[0]) = (ic, dc, id);
        DiagonalBlock { ia, ba, ib, ca, cb, ic, da, db, dc, id }
    }

    /// Takes the earlier columns out of each later number of a row, or of a right side.
    #[inline(always)]
    fn eliminate(&self, block: &DiagonalBlock<[S::f64s; N]>, [a, b, c, d]: [[S::f64s; N]; PANEL]) -> [[S::f64s; N]; PANEL] {
        let v = self.vectors;
        let a = v.multiply(a, block.ia);
        let b = v.multiply(v.subtract(b, block.ba, a), block.ib);
        let c = v.multiply(v.subtract(v.subtract(c, block.ca, a), block.cb, b), block.ic);
        let d = v.multiply(v.subtract(v.subtract(v.subtract(d, block.da, a), block.db, b), block.dc, c), block.id);
        [a, b, c, d]
    }

    /// Subtracts what a panel that is eliminated, `from`, contributes to the columns of the panel that comes `after` panels later.
    #[inline(always)]
    fn apply(&self, from: &[[S::f64s; N]], after: usize, panel: &mut [[S::f64s; N]]) {
        let v = self.vectors;
        let (rows, after) = (from.len() / PANEL, after * PANEL);
        let reach = rows - after;
        let known: [&[[S::f64s; N]]; PANEL] = from_fn(|number| &from[number * rows + after - number..][..reach]);
        let columns = columns(panel);
        let at = |row: usize| [known[0][row], known[1][row], known[2][row], known[3][row]];
        let common = reach.min(PANEL);
        for row in 0..common {
            for column in 0..=row {
                let place = &mut columns[column][row - column];
                *place = v.subtract_four(*place, at(row), &at(column));
            }
        }
        if reach <= PANEL {
            return;
        }
        let own = [at(0), at(1), at(2), at(3)];
        let [a, b, c, d] = columns;
        let below = reach - PANEL;
        let targets = a[4..][..below].iter_mut().zip(&mut b[3..][..below]).zip(&mut c[2..][..below]).zip(&mut d[1..][..below]);
        let [ka, kb, kc, kd] = known;
        for (((((((a, b), c), d), ka), kb), kc), kd) in targets.zip(&ka[4..]).zip(&kb[4..]).zip(&kc[4..]).zip(&kd[4..]) {
            let known = [*ka, *kb, *kc, *kd];
            *a = v.subtract_four(*a, known, &own[0]);
            *b = v.subtract_four(*b, known, &own[1]);
            *c = v.subtract_four(*c, known, &own[2]);
            *d = v.subtract_four(*d, known, &own[3]);
        }
    }

    #[inline(always)]
    fn up<const COUNT: usize>(&self, panels: &Panels, factors: &[[S::f64s; N]], sides: &mut [&mut [[S::f64s; N]]; COUNT]) {
        let v = self.vectors;
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
                let below: [&[[S::f64s; N]]; COUNT] = from_fn(|side| &sides[side][first + 2..][..count]);
                let mut own: [[S::f64s; N]; COUNT] = from_fn(|side| sides[side][first]);
                let mut next: [[S::f64s; N]; COUNT] = from_fn(|side| sides[side][first + 1]);
                for i in 0..count {
                    for side in 0..COUNT {
                        own[side] = v.subtract(own[side], from_upper[i], below[side][i]);
                        next[side] = v.subtract(next[side], from_lower[i], below[side][i]);
                    }
                }
                for side in 0..COUNT {
                    next[side] = v.multiply(next[side], lower[0]);
                    own[side] = v.multiply(v.subtract(own[side], upper[1], next[side]), upper[0]);
                    (sides[side][first], sides[side][first + 1]) = (own[side], next[side]);
                }
            }
        }
    }
}
