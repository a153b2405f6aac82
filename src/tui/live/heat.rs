//! The heat map: the values of all taxels in shades or as numbers, and the edge of the imprint.
//!
//! ```text
//! ░░▒▒▒•▓•        two columns a taxel: the second column of a taxel at the edge of the imprint has a mark; or two
//!                 lines of four columns, and so on
//! ░▒▓•            half a character a taxel: the larger of two is drawn; with colours, both are. The mark stands beside
//!                 the imprint, so that no value of a touch is hidden
//!      6     7
//! 12  12   45•    numbers, with rulers
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use taxel_core::imprint::{Bounds, Imprint};
use taxel_core::matrix::Matrix;
use taxel_files::formats::value::{self, measured};

use crate::tui::grid::{CellSize, Grid, Look, Window, beside_rulers};
use crate::tui::keys::Arrow;
use crate::tui::live::{HeatLayer, Live, LiveReading, trend};
use crate::tui::recognise::panel::legend;
use crate::tui::widget::write::{below, right_of};
use crate::tui::widget::{ColorDepth, Palette, Role, Theme, Tone};

/// The least columns of the panel, and those that must remain if taxels are enlarged.
const PANEL: u16 = 26;
const WIDE_PANEL: u16 = 44;

const GAP: u16 = 2;

/// The colours of values, from low to high.
const TONES: [Tone; 9] = [
    (Color::Blue, 53, [68, 1, 84]),
    (Color::Blue, 54, [71, 45, 123]),
    (Color::Blue, 24, [59, 82, 139]),
    (Color::Cyan, 30, [44, 114, 142]),
    (Color::Cyan, 36, [33, 145, 140]),
    (Color::Green, 71, [40, 174, 128]),
    (Color::Green, 77, [94, 201, 98]),
    (Color::Yellow, 148, [173, 220, 48]),
    (Color::Yellow, 220, [253, 231, 37]),
];

/// The columns of a number, without its mark and the blank after it.
const DIGITS: usize = 4;

pub(super) struct HeatMap<'a> {
    theme: &'a Theme,
    reading: &'a LiveReading,
    layer: HeatLayer,
    range: (f64, f64),
    /// What a fitted shape leaves: taxels that differ are marked on the imprint.
    fitted: Option<&'a Imprint>,
    grid: Grid,
}

impl<'a> HeatMap<'a> {
    pub(super) fn of(
        live: &'a Live,
        reading: &'a LiveReading,
        theme: &'a Theme,
        area: Rect,
    ) -> Self {
        Self {
            theme,
            reading,
            layer: live.layer,
            range: live.ends(),
            fitted: live.names.fitted(),
            grid: grid(area, &reading.values, live.numbers, live.looked_at(reading)),
        }
    }

    /// Returns the legend of the mark on taxels; None if no taxel can have one.
    pub(super) fn legend(&self) -> Option<String> {
        let marked = match (self.layer, self.grid.size) {
            (_, CellSize::Number) => "active taxel",
            (HeatLayer::Imprint, CellSize::Half) => return None,
            (HeatLayer::Imprint, _) => {
                let fitted = self.fitted.zip(self.reading.imprint.as_ref());
                let differing = fitted.filter(|(fitted, imprint)| fitted != imprint);
                return differing.map(|(fitted, imprint)| legend(imprint, fitted));
            }
            (_, CellSize::Half) => "near imprint",
            _ => "imprint edge",
        };
        let imprint = self.reading.imprint.filter(|imprint| !imprint.is_empty());
        imprint.map(|_| format!("{} {marked}", edge(self.theme)))
    }

    /// Returns the visible columns and rows, counted from 0; None if all are visible.
    pub(super) fn window(&self) -> Option<String> {
        let (columns, rows) = (self.grid.columns, self.grid.rows);
        let span = |axis: Window| {
            let last = axis.first + axis.count.saturating_sub(1);
            format!("{}-{last}", axis.first)
        };
        (!self.grid.is_whole() && columns.count > 0 && rows.count > 0)
            .then(|| format!("columns {}, rows {}", span(columns), span(rows)))
    }

    pub(super) fn draw(&self, buffer: &mut Buffer) {
        match self.grid.size {
            CellSize::Number => self.draw_numbers(buffer),
            CellSize::Half => self.grid.draw(buffer, |column, row| self.half(column, row)),
            _ => (self.grid).draw(buffer, |column, row| self.square(column, row)),
        }
    }

    /// Returns the value of a taxel as a share of the range; NaN if there is no cell.
    fn share(&self, column: u8, row: u8) -> f64 {
        let value = self.reading.values.get(column, row);
        let (low, high) = self.range;
        value.map_or(f64::NAN, |value| (value - low) / (high - low))
    }

    fn shade(&self, share: f64) -> char {
        value::character(share, self.theme.ascii)
    }

    /// A taxel of several columns. A low one is a single character, so that an area without touch looks less dense than
    /// a touch.
    fn square(&self, column: u8, row: u8) -> Look {
        let share = self.share(column, row);
        let imprint = self.reading.imprint.as_ref();
        if let Some(imprint) = imprint.filter(|_| self.layer == HeatLayer::Imprint) {
            let own = imprint.get(column, row);
            let other = self.fitted.map_or(own, |fitted| fitted.get(column, row));
            let role = match (own, other, self.reading.main.get(column, row)) {
                (true, false, _) => Role::Surplus,
                (false, true, _) => Role::Missing,
                (true, _, true) => Role::Chosen,
                (true, _, false) => Role::Active,
                (false, ..) => Role::Inactive,
            };
            let [sign, fill] = self.theme.taxel(role);
            let signs = [if share.is_nan() { ' ' } else { sign }, fill];
            let style = self.theme.style(role);
            return Look { signs, fill, style };
        }
        let sign = self.shade(share);
        let fill = if share <= 0.0 { ' ' } else { sign };
        let is_marked = imprint.is_some_and(|imprint| is_edge(imprint, column, row));
        let second = if is_marked { edge(self.theme) } else { fill };
        let (signs, style) = ([sign, second], style(self.theme, share));
        Look { signs, fill, style }
    }

    /// Two taxels in one character: one above the other with colours; without colours only the larger one, so that no
    /// touch disappears. With an odd number of rows, the last character has an upper taxel only.
    fn half(&self, column: u8, row: u8) -> Look {
        let shares = [self.share(column, row), self.share(column, row + 1)];
        let larger = match shares {
            [upper, lower] if lower > upper || upper.is_nan() => lower,
            [upper, _] => upper,
        };
        let style = style(self.theme, larger);
        let imprint = self.reading.imprint.as_ref();
        let shown = imprint.filter(|_| self.layer == HeatLayer::Imprint);
        let (sign, style) = if let Some(imprint) = shown {
            let [upper, lower] = [row, row + 1].map(|row| imprint.get(column, row));
            let any = upper || lower;
            let role = if any { Role::Chosen } else { Role::Inactive };
            (self.theme.half(upper, lower), self.theme.style(role))
        } else if self.is_beside(column, row) {
            (edge(self.theme), style)
        } else {
            let halves = has_halves(self.theme);
            match shares.map(|share| color(self.theme, share).filter(|_| halves)) {
                [Some(upper), Some(lower)] => ('▀', Style::new().fg(upper).bg(lower)),
                [Some(upper), None] => ('▀', Style::new().fg(upper)),
                [None, Some(lower)] => ('▄', Style::new().fg(lower)),
                [None, None] => (self.shade(larger), style),
            }
        };
        Look {
            signs: [sign; 2],
            fill: sign,
            style,
        }
    }

    /// Whether two taxels lie beside the imprint, and neither is active.
    fn is_beside(&self, column: u8, row: u8) -> bool {
        let Some(imprint) = &self.reading.imprint else {
            return false;
        };
        let both = |column| imprint.get(column, row) || imprint.get(column, row + 1);
        let near = both(column.wrapping_sub(1))
            || both(column + 1)
            || imprint.get(column, row.wrapping_sub(1))
            || imprint.get(column, row + 2);
        near && !both(column)
    }

    /// A number that is too wide becomes arrows, up or down by its sign; a cell without a value stays empty.
    fn draw_numbers(&self, buffer: &mut Buffer) {
        self.grid.draw_rulers(self.theme, buffer);
        for (place, (column, row)) in self.grid.cells() {
            let value = self.reading.values.get(column, row).unwrap_or(f64::NAN);
            let text = match measured(value, DIGITS) {
                _ if value.is_nan() => String::new(),
                text if text.chars().count() <= DIGITS => text,
                _ if value > 0.0 => "^^^^".to_owned(),
                _ => "vvvv".to_owned(),
            };
            let is_active = self.reading.imprint.is_some_and(|own| own.get(column, row));
            let mark = if is_active { edge(self.theme) } else { ' ' };
            let style = style(self.theme, self.share(column, row));
            let text = format!("{text:>DIGITS$}{mark}");
            buffer.set_stringn(place.x, place.y, text, place.width.into(), style);
        }
    }

    /// Returns the nearest hidden taxel in a direction; None if there is none.
    pub(super) fn beyond(&self, towards: Arrow, live: &Live) -> Option<(u8, u8)> {
        let (column, row) = live.looked_at(self.reading);
        let (columns, rows) = (self.grid.columns, self.grid.rows);
        let before = |axis: Window| axis.hidden().0.then(|| axis.first - 1);
        let after = |axis: Window| axis.hidden().1.then_some(axis.first + axis.count);
        match towards {
            Arrow::Left => before(columns).map(|column| (column, row)),
            Arrow::Right => after(columns).map(|column| (column, row)),
            Arrow::Up => before(rows).map(|row| (column, row)),
            Arrow::Down => after(rows).map(|row| (column, row)),
        }
    }
}

impl Live {
    /// Returns the taxel that must be visible: the chosen one, or the middle of the main region, or the largest value.
    fn looked_at(&self, reading: &LiveReading) -> (u8, u8) {
        let middle = reading.main.bounds().map(|bounds| {
            let of = |side: std::ops::Range<u8>| side.start.midpoint(side.end);
            (of(bounds.columns()), of(bounds.rows()))
        });
        let largest = reading.shown_max.map(|(_, at)| at);
        self.looked_at.or(middle).or(largest).unwrap_or_default()
    }
}

fn has_halves(theme: &Theme) -> bool {
    let many = matches!(theme.depth, ColorDepth::TwoFiftySix | ColorDepth::True);
    many && !theme.ascii && theme.palette != Palette::Mono
}

fn color(theme: &Theme, share: f64) -> Option<Color> {
    let step = value::shade(share, TONES.len() + 1).checked_sub(1)?;
    match theme.palette {
        Palette::Dark => theme.color(TONES[step]),
        Palette::Light => theme.color(TONES[TONES.len() - 1 - step]),
        Palette::Mono => None,
    }
}

fn style(theme: &Theme, share: f64) -> Style {
    color(theme, share).map_or(Style::new(), |color| Style::new().fg(color))
}

fn edge(theme: &Theme) -> char {
    theme.pick('o', '•')
}

fn is_edge(imprint: &Imprint, column: u8, row: u8) -> bool {
    let is_inside = imprint.get(column.wrapping_sub(1), row)
        && imprint.get(column + 1, row)
        && imprint.get(column, row.wrapping_sub(1))
        && imprint.get(column, row + 1);
    imprint.get(column, row) && !is_inside
}

/// Returns the scale of the shades: the lower end of the range, the shades, the upper end and the unit.
pub(super) fn scale(theme: &Theme, (low, high): (f64, f64), unit: &str) -> String {
    let shades: String = value::characters(theme.ascii).iter().skip(1).collect();
    format!("{} {shades} {}{unit}", measured(low, 7), measured(high, 7))
}

pub(super) fn cells(values: &Matrix<f64>) -> usize {
    let values = values.values().iter();
    values.filter(|value| !value.is_nan()).count()
}

pub(super) fn grid(area: Rect, values: &Matrix<f64>, numbers: bool, seen: (u8, u8)) -> Grid {
    let sides = (values.columns(), values.rows());
    let seen = Bounds::of_taxel(seen.0, seen.1);
    if numbers {
        return Grid::new(beside_rulers(area), CellSize::Number, sides, seen);
    }
    Grid::new(area, CellSize::fitting(sides, area, true), sides, seen)
}

/// A taxel is two columns wide, or a multiple of that, if all fit; otherwise it is half a character, so that two stand
/// above each other. If not all fit even then, a window follows the contact until keys move it.
#[derive(Clone, Copy, Debug)]
pub(super) struct LivePanes {
    /// The title line: the source and the frame.
    pub(super) title: Rect,
    pub(super) map: Rect,
    /// The numbers; a low screen shows only the first of them.
    pub(super) panel: Rect,
}

impl LivePanes {
    pub(super) fn of(area: Rect, values: Option<&Matrix<f64>>, numbers: bool) -> Self {
        let title = Rect {
            height: area.height.min(1),
            ..area
        };
        let rest = below(area, 1);
        let Some(values) = values else {
            let map = Rect { width: 0, ..rest };
            return Self {
                title,
                map,
                panel: rest,
            };
        };
        let within = |width: u16| grid(Rect { width, ..rest }, values, numbers, (0, 0));
        let room = |panel: u16| within(rest.width.saturating_sub(GAP + panel));
        let right = |grid: &Grid| grid.x + grid.characters().0 - rest.x;
        let (large, beside) = (room(WIDE_PANEL), room(PANEL));
        let width = match (large.size, beside.size) {
            (CellSize::Square(_), _) => right(&large),
            (_, CellSize::Square(_)) => 2 * u16::from(values.columns()),
            _ => right(&beside),
        };
        let grid = within(width);
        let height = (grid.y + grid.characters().1 - rest.y).min(rest.height);
        let map = Rect {
            width,
            height,
            ..rest
        };
        let panel = right_of(rest, rest.x + width + GAP);
        Self { title, map, panel }
    }

    /// Returns the part below the taxels for a plot, and the part that is left of the panel: the plot is as wide as the
    /// page if this number of lines fits beside the taxels. None if there is no room.
    pub(super) fn plot(&self, lines: usize) -> Option<(Rect, Rect)> {
        let mut plot = Rect {
            y: self.map.bottom(),
            height: self.panel.bottom().saturating_sub(self.map.bottom()),
            ..self.map
        };
        let mut panel = self.panel;
        if lines <= self.map.height.into() {
            plot.width = self.title.width;
            panel.height = self.map.height;
        }
        (plot.height >= trend::LEAST).then_some((plot, panel))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the relative luminance, from 0 to 1.
    fn luminance(rgb: [u8; 3]) -> f64 {
        let linear = rgb.map(|part| libm::pow(f64::from(part) / 255.0, 2.2));
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    fn of_index(index: u8) -> [u8; 3] {
        let level = |place: u8| [0, 95, 135, 175, 215, 255][usize::from((index - 16) / place % 6)];
        [level(36), level(6), level(1)]
    }

    #[test]
    fn each_step_is_lighter_than_the_one_before() {
        for pair in TONES.windows(2) {
            assert!(luminance(pair[0].2) < luminance(pair[1].2), "{pair:?}");
            let [dark, light] = [pair[0].1, pair[1].1].map(of_index).map(luminance);
            assert!(dark < light, "{pair:?}");
        }
    }
}
