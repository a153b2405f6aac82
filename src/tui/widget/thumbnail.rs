//! A small picture of an imprint, with one column per taxel. A line shows two rows by half blocks, in ASCII one row.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use taxel_core::imprint::Imprint;
use taxel_files::formats::value;

use crate::tui::widget::theme::{ColorDepth, Palette, Role, Theme, Tone};
use crate::tui::widget::write::{self, taxels};

pub fn size(theme: &Theme, imprint: &Imprint) -> (u16, u16) {
    let rows = u16::from(imprint.rows());
    let lines = if theme.ascii { rows } else { rows.div_ceil(2) };
    (imprint.columns().into(), lines)
}

pub fn draw(theme: &Theme, imprint: &Imprint, buffer: &mut Buffer, area: Rect) {
    let step: u8 = if theme.ascii { 1 } else { 2 };
    let (columns, rows) = (imprint.columns(), imprint.rows());
    let (width, height) = (
        taxels(area.width).min(columns),
        taxels(area.height.saturating_mul(step.into())).min(rows),
    );
    let (mut left, mut top) = (0, 0);
    if let Some(bounds) = imprint.bounds() {
        let middle = |low: u8, high: u8| low + (high - low) / 2;
        let from = |middle: u8, seen: u8, all: u8, step: u8| {
            let last = (all - seen).next_multiple_of(step);
            (middle.saturating_sub(seen / 2) / step * step).min(last)
        };
        left = from(middle(bounds.left, bounds.right), width, columns, 1);
        // The same rows share a line as in the whole imprint.
        top = from(middle(bounds.top, bounds.bottom), height, rows, step);
    }
    for (line, row) in (top..rows).step_by(step.into()).enumerate() {
        let half = |column: u8| {
            let lower = step == 2 && imprint.get(column, row + 1);
            theme.half(imprint.get(column, row), lower)
        };
        let text: String = (left..left + width).map(half).collect();
        let place = write::row(area, line);
        write::text(buffer, place, theme, &text, Role::Chosen);
    }
}

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

pub(in crate::tui) fn shades(theme: &Theme) -> &'static [char] {
    value::characters(theme.ascii)
}

pub(in crate::tui) fn shade(theme: &Theme, share: f64) -> char {
    value::character(share, theme.ascii)
}

pub(in crate::tui) fn has_halves(theme: &Theme) -> bool {
    let many = matches!(theme.depth, ColorDepth::TwoFiftySix | ColorDepth::True);
    many && !theme.ascii && theme.palette != Palette::Mono
}

pub(in crate::tui) fn color(theme: &Theme, share: f64) -> Option<Color> {
    let step = value::shade(share, TONES.len() + 1).checked_sub(1)?;
    match theme.palette {
        Palette::Dark => theme.color(TONES[step]),
        Palette::Light => theme.color(TONES[TONES.len() - 1 - step]),
        Palette::Mono => None,
    }
}

pub(in crate::tui) fn style(theme: &Theme, share: f64) -> Style {
    color(theme, share).map_or(Style::new(), |color| Style::new().fg(color))
}

pub(in crate::tui) fn edge(theme: &Theme) -> char {
    if theme.ascii { 'o' } else { '•' }
}

#[cfg(test)]
mod tests {
    use taxel_core::sensor::MatrixSize;

    use super::*;

    #[test]
    fn the_last_of_an_odd_number_of_rows_is_drawn() {
        let mut imprint = Imprint::empty(MatrixSize::new(3, 63).expect("an allowed size"));
        imprint.set(1, 62, true);
        for (ascii, height) in [(false, 22), (true, 22)] {
            let area = Rect::new(0, 0, 3, height);
            let mut buffer = Buffer::empty(area);
            draw(&Theme::plain(ascii), &imprint, &mut buffer, area);
            let last = buffer
                .cell((1, height - 1))
                .map(|cell| cell.symbol().to_owned());
            let sign = if ascii { "#" } else { "▀" };
            assert_eq!(last.as_deref(), Some(sign), "ascii: {ascii}");
        }
    }

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
