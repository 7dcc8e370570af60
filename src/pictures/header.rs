//! The head of a picture: its title and, below it, the legend, which so cannot cover data.

use super::colours::{ABSENT, GREY, HATCH, INK};
use super::sheet::{Area, Dash, Drawn, Sheet, UNIT, WIDTH};
use super::words::{clean, line_height, shortened, text, text_width, wrap};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

const MARGIN: i32 = 20 * UNIT;
const TITLE_TEXT: i32 = 17;
const LEGEND_TEXT: i32 = 13;
const LEGEND_ROW: i32 = 21 * UNIT;
const MARK_WIDTH: i32 = 30 * UNIT;

/// The mark at every point of a [`Line`](super::Line).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Nothing.
    None,
    /// A ring.
    Open,
    /// A dot.
    Filled,
}

/// The mark in front of a legend entry.
#[derive(Debug, Clone, Copy)]
pub(super) enum Mark {
    Dot(RGBColor),
    Line(RGBColor, Dash),
    /// A line with a mark on it.
    Styled(RGBColor, Option<Dash>, Marker),
    /// A dot, filled or not, that is distinct from a line of its colour.
    Ring(RGBColor, bool),
    Diamond(RGBColor),
    Plus(RGBColor),
    Box(RGBColor),
    Hatched,
    /// Nothing: the entry is a remark.
    None,
}

/// Title and legend, broken into rows.
pub(super) struct Header {
    title: Vec<String>,
    rows: Vec<Vec<(Mark, String)>>,
}

impl Header {
    pub fn new(title: &str, legend: Vec<(Mark, String)>) -> Self {
        let room = WIDTH - 2 * MARGIN;
        let mut rows: Vec<Vec<(Mark, String)>> = Vec::new();
        let mut used = room;
        for (mark, label) in legend {
            let longest = room - entry_width(mark, "");
            let label = shortened(&clean(&label), LEGEND_TEXT, longest);
            let width = entry_width(mark, &label);
            if used + width > room {
                rows.push(Vec::new());
                used = 0;
            }
            used += width;
            rows.last_mut().expect("pushed above").push((mark, label));
        }
        let title = wrap(&clean(title), TITLE_TEXT, room);
        Self { title, rows }
    }

    /// Height, the space to what follows included, in units of paper.
    pub fn height(&self) -> i32 {
        self.rows_top() + self.rows.len() as i32 * LEGEND_ROW + 12 * UNIT
    }

    fn rows_top(&self) -> i32 {
        14 * UNIT + self.title.len() as i32 * line_height(TITLE_TEXT) + 2 * UNIT
    }

    pub fn draw(&self, area: &Area<'_>) -> Drawn {
        let style = text(TITLE_TEXT, INK, HPos::Left, VPos::Top);
        for (i, line) in self.title.iter().enumerate() {
            let top = 14 * UNIT + i as i32 * line_height(TITLE_TEXT);
            area.draw_text(line, &style, (MARGIN, top))?;
        }
        for (i, row) in self.rows.iter().enumerate() {
            let middle = self.rows_top() + i as i32 * LEGEND_ROW + LEGEND_ROW / 2;
            let mut left = MARGIN;
            for (mark, label) in row {
                let indent = mark_width(*mark);
                mark.draw(area, (left + indent / 2 - 3 * UNIT, middle))?;
                let style = text(LEGEND_TEXT, INK, HPos::Left, VPos::Center);
                area.draw_text(label, &style, (left + indent, middle))?;
                left += entry_width(*mark, label);
            }
        }
        Ok(())
    }
}

fn mark_width(mark: Mark) -> i32 {
    match mark {
        Mark::None => 0,
        _ => MARK_WIDTH,
    }
}

fn entry_width(mark: Mark, label: &str) -> i32 {
    mark_width(mark) + text_width(label, LEGEND_TEXT) + 22 * UNIT
}

impl Mark {
    /// Draws the mark around a point of the paper.
    pub fn draw(self, area: &Area<'_>, (x, y): (i32, i32)) -> Drawn {
        let half = (11 * UNIT, 6 * UNIT);
        let corners = [(x - half.0, y - half.1), (x + half.0, y + half.1)];
        match self {
            Mark::Dot(colour) => {
                area.draw(&Circle::new((x, y), 4 * UNIT, colour.filled()))?;
            }
            Mark::Line(colour, dash) => {
                let stroke = colour.stroke_width(2 * UNIT as u32);
                let strokes: &[(i32, i32)] = match dash {
                    Dash::Solid => &[(-110, 110)],
                    Dash::Dashed => &[(-110, -40), (0, 70)],
                    Dash::Dotted => &[(-110, -90), (-60, -40), (-10, 10), (40, 60), (90, 110)],
                    Dash::Centre => &[(-110, -40), (-10, 10), (40, 110)],
                };
                for (from, to) in strokes {
                    area.draw(&PathElement::new([(x + from, y), (x + to, y)], stroke))?;
                }
            }
            Mark::Styled(colour, dash, marker) => {
                if let Some(dash) = dash {
                    Mark::Line(colour, dash).draw(area, (x, y))?;
                }
                if marker != Marker::None {
                    Mark::Ring(colour, marker == Marker::Filled).draw(area, (x, y))?;
                }
            }
            Mark::Ring(colour, filled) => {
                let inner = if filled { colour } else { WHITE };
                for (radius, colour) in [(45, colour), (28, inner)] {
                    area.draw(&Circle::new((x, y), radius, colour.filled()))?;
                }
            }
            Mark::Diamond(colour) => {
                // A white rim separates it from the dots below.
                for (reach, colour) in [(9 * UNIT, WHITE), (7 * UNIT, colour)] {
                    let tips = [(0, -reach), (reach, 0), (0, reach), (-reach, 0)];
                    let tips = tips.map(|(dx, dy)| (x + dx, y + dy));
                    area.draw(&Polygon::new(tips, colour.filled()))?;
                }
            }
            Mark::Plus(colour) => {
                for (reach, width, colour) in [(9, 5, WHITE), (8, 2, colour)] {
                    let reach = reach * UNIT;
                    let stroke = colour.stroke_width((width * UNIT) as u32);
                    area.draw(&PathElement::new([(x - reach, y), (x + reach, y)], stroke))?;
                    area.draw(&PathElement::new([(x, y - reach), (x, y + reach)], stroke))?;
                }
            }
            Mark::Box(colour) => area.draw(&Rectangle::new(corners, colour.filled()))?,
            Mark::Hatched => {
                area.draw(&Rectangle::new(corners, ABSENT.filled()))?;
                let stroke = HATCH.stroke_width(UNIT as u32);
                let (low, high) = (y + half.1, y - half.1);
                for left in [-11, -5, 1].map(|dx| x + dx * UNIT) {
                    let rise = [(left, low), (left + 2 * half.1 - 2 * UNIT, high)];
                    area.draw(&PathElement::new(rise, stroke))?;
                }
            }
            Mark::None => {}
        }
        Ok(())
    }
}

/// A picture without data: the title and a sentence.
pub(super) fn sentence(title: &str, words: &str) -> String {
    let header = Header::new(title, Vec::new());
    let mut sheet = Sheet::new(header.height() + 120 * UNIT);
    sheet.draw(|area| {
        header.draw(area)?;
        let style = text(16, GREY, HPos::Center, VPos::Center);
        area.draw_text(words, &style, (WIDTH / 2, header.height() + 50 * UNIT))
    });
    sheet.finish()
}
