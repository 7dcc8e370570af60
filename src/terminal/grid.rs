//! Text in columns.

use super::fill::{cell_lines, least_width};
use super::width;

/// Text in columns, each as wide as its widest cell; the last one is not padded. On a terminal that is too narrow for that, cells are broken
/// to several lines: between words, and if that is not enough behind the underscores of names.
#[derive(Debug, Default)]
pub struct TextGrid {
    rows: Vec<Vec<String>>,
}

impl TextGrid {
    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// The rows as indented lines. Numbers are aligned to the right.
    pub fn indented(&self, indent: usize) -> String {
        self.indented_rows(indent).concat()
    }

    /// The same row by row; one that is broken has several lines.
    pub fn indented_rows(&self, indent: usize) -> Vec<String> {
        self.fitted(indent, width())
    }

    fn fitted(&self, indent: usize, most: Option<usize>) -> Vec<String> {
        let is_number = |cell: &str| cell.replace(' ', "").parse::<f64>().is_ok();
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let widest = |column: usize, width: &dyn Fn(&str) -> usize| {
            self.rows.iter().filter_map(|row| row.get(column)).map(|cell| width(cell)).max().unwrap_or(0)
        };
        let mut widths: Vec<_> = (0..columns).map(|column| widest(column, &console::measure_text_width)).collect();
        let room = most.map_or(usize::MAX, |most| most.saturating_sub(indent + 2 * columns.saturating_sub(1)));
        let is_broken = widths.iter().sum::<usize>() > room;
        let mut in_names = false;
        if is_broken {
            for names in [false, true] {
                in_names = names;
                let least: Vec<_> = (0..columns).map(|column| widest(column, &|cell| least_width(cell, names))).collect();
                narrow(&mut widths, &least, room);
                if widths.iter().sum::<usize>() <= room {
                    break;
                }
            }
        }
        let of_numbers = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column)).filter(|cell| !cell.is_empty());
            2 * cells.clone().filter(|cell| is_number(cell)).count() > cells.count()
        };
        let of_numbers: Vec<_> = (0..columns).map(of_numbers).collect();
        let line_of = |row: &[&str]| {
            let mut line = " ".repeat(indent);
            for (at, (&cell, &width)) in row.iter().zip(&widths).enumerate() {
                let padding = " ".repeat(width.saturating_sub(console::measure_text_width(cell)));
                let number = of_numbers[at] && is_number(cell);
                let cell = if number { format!("{padding}{cell}") } else { format!("{cell}{padding}") };
                line.push_str(&cell);
                if at + 1 < row.len() {
                    line.push_str("  ");
                }
            }
            format!("{}\n", line.trim_end())
        };
        let lines_of = |row: &Vec<String>| {
            if !is_broken {
                return line_of(&row.iter().map(String::as_str).collect::<Vec<_>>());
            }
            let cells: Vec<Vec<String>> = row.iter().zip(&widths).map(|(cell, &width)| cell_lines(cell, width, in_names)).collect();
            let high = cells.iter().map(Vec::len).max().unwrap_or(0).max(1);
            let line = |at: usize| line_of(&cells.iter().map(|cell| cell.get(at).map_or("", String::as_str)).collect::<Vec<_>>());
            (0..high).map(line).collect()
        };
        self.rows.iter().map(lines_of).collect()
    }
}

/// Takes from the widest columns what they can give until all fit.
fn narrow(widths: &mut [usize], least: &[usize], room: usize) {
    while widths.iter().sum::<usize>() > room {
        let able = (0..widths.len()).filter(|&it| widths[it] > least[it]);
        let Some(widest) = able.max_by_key(|&it| widths[it]) else { return };
        widths[widest] -= 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_lines_up() {
        let mut grid = TextGrid::default();
        grid.row(["a", "10", "x"].map(str::to_owned));
        grid.row(["bbb", "5", "y"].map(str::to_owned));
        assert_eq!(grid.indented(1), " a    10  x\n bbb   5  y\n");
        let mut mixed = TextGrid::default();
        mixed.row(["what", "12 345"].map(str::to_owned));
        mixed.row(["time", "about 3 s"].map(str::to_owned));
        assert_eq!(mixed.indented(0), "what  12 345\ntime  about 3 s\n");
    }

    #[test]
    fn a_grid_that_is_too_wide_is_broken() {
        let mut grid = TextGrid::default();
        grid.row(["", "error median", "used"].map(str::to_owned));
        grid.row(["driver_axial_force_N", "5.1e-8", "3.0 %"].map(str::to_owned));
        assert_eq!(grid.fitted(2, Some(44)), grid.fitted(2, None));
        assert_eq!(
            grid.fitted(2, None).concat(),
            "                        error median  used\n  driver_axial_force_N  5.1e-8        3.0 %\n"
        );
        assert_eq!(
            grid.fitted(2, Some(40)).concat(),
            "                        error      used\n                        median\n  driver_axial_force_N  5.1e-8     3.0 %\n"
        );
        assert_eq!(
            grid.fitted(2, Some(32)).concat(),
            "                   error   used\n                   median\n  driver_axial_    5.1e-8  3.0 %\n  force_N\n"
        );
        // One that cannot be made to fit is as narrow as it can be.
        assert!(grid.fitted(2, Some(5)).concat().lines().all(|line| line.len() < 30));
        let mut text = TextGrid::default();
        text.row(["friction", "0.08", "Coefficient of friction between blocks and pulley."].map(str::to_owned));
        assert_eq!(
            text.fitted(2, Some(48)).concat(),
            "  friction  0.08  Coefficient of friction\n                  between blocks and pulley.\n"
        );
    }
}
