//! The shades and colours of values: those of a heat map.

use ratatui::style::{Color, Style};
use taxel_files::formats::value;

use crate::tui::widget::theme::{ColorDepth, Palette, Theme, Tone};

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
