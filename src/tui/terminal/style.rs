//! Styles of cells, sent as the difference from the style before.
//!
//! ```text
//! plain -> bold red            ESC [ 1 ; 31 m
//! bold red -> red              ESC [ 22 m
//! red -> plain                 ESC [ m
//! ```
//! If it is shorter, a reset followed by the new style is sent instead.

use ratatui::buffer::Cell;
use ratatui::style::{Color, Modifier};

/// The style of characters: colours and attributes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::tui) struct CellStyle {
    /// The colour of the text.
    pub(in crate::tui) fore: Color,
    /// The colour behind it.
    pub(in crate::tui) back: Color,
    /// The attributes, such as bold, dim, underlined and reversed.
    pub(in crate::tui) attributes: Modifier,
}

/// No colours and no attributes.
pub(in crate::tui) const PLAIN: CellStyle = CellStyle {
    fore: Color::Reset,
    back: Color::Reset,
    attributes: Modifier::empty(),
};

/// The attributes that are sent: the number that switches each on, and the one that switches it off. Bold and dim
/// share the latter.
const ATTRIBUTES: [(Modifier, u8, u8); 7] = [
    (Modifier::BOLD, 1, 22),
    (Modifier::DIM, 2, 22),
    (Modifier::ITALIC, 3, 23),
    (Modifier::UNDERLINED, 4, 24),
    (Modifier::SLOW_BLINK, 5, 25),
    (Modifier::REVERSED, 7, 27),
    (Modifier::CROSSED_OUT, 9, 29),
];

impl CellStyle {
    /// Returns the style of a cell.
    pub(in crate::tui) fn of(cell: &Cell) -> Self {
        Self {
            fore: cell.fg,
            back: cell.bg,
            attributes: cell.modifier,
        }
    }

    /// Returns true if a blank in this style looks like a plain one.
    pub(in crate::tui) fn leaves_blanks_plain(self) -> bool {
        let seen = Modifier::REVERSED | Modifier::UNDERLINED | Modifier::CROSSED_OUT;
        self.back == Color::Reset && !self.attributes.intersects(seen)
    }

    /// Appends the shortest sequence that changes `before` into this style.
    pub(in crate::tui) fn change(self, before: Self, out: &mut Vec<u8>) {
        if self == before {
            return;
        }
        let difference = sgr(&self.steps(before, false));
        let anew = sgr(&self.steps(PLAIN, true));
        out.extend(if difference.len() < anew.len() {
            difference
        } else {
            anew
        });
    }

    /// Returns the parameters that change one style into another; with `reset`, they begin with a reset.
    fn steps(self, before: Self, reset: bool) -> Vec<String> {
        let mut steps = Vec::new();
        let mut held = before.attributes;
        if reset {
            // Empty means 0, and is enough if nothing follows.
            steps.push(if self == PLAIN { "" } else { "0" }.to_owned());
        }
        for (attribute, _, off) in ATTRIBUTES {
            if held.contains(attribute) && !self.attributes.contains(attribute) {
                steps.push(off.to_string());
                let together = ATTRIBUTES.iter().filter(|(_, _, other)| *other == off);
                together.for_each(|(gone, ..)| held.remove(*gone));
            }
        }
        for (attribute, on, _) in ATTRIBUTES {
            if self.attributes.contains(attribute) && !held.contains(attribute) {
                steps.push(on.to_string());
            }
        }
        if self.fore != before.fore {
            steps.push(color(self.fore, 30));
        }
        if self.back != before.back {
            steps.push(color(self.back, 40));
        }
        steps
    }
}

/// Returns the sequence with the given parameters.
fn sgr(steps: &[String]) -> Vec<u8> {
    format!("\x1b[{}m", steps.join(";")).into_bytes()
}

/// Returns a colour's parameters; `base` is 30 for text and 40 for the background. The sixteen colours have short
/// numbers that every terminal knows.
fn color(color: Color, base: u8) -> String {
    let numbered = |number: u8| (base + number).to_string();
    match color {
        Color::Reset => numbered(9),
        Color::Black => numbered(0),
        Color::Red => numbered(1),
        Color::Green => numbered(2),
        Color::Yellow => numbered(3),
        Color::Blue => numbered(4),
        Color::Magenta => numbered(5),
        Color::Cyan => numbered(6),
        Color::Gray => numbered(7),
        Color::DarkGray => numbered(60),
        Color::LightRed => numbered(61),
        Color::LightGreen => numbered(62),
        Color::LightYellow => numbered(63),
        Color::LightBlue => numbered(64),
        Color::LightMagenta => numbered(65),
        Color::LightCyan => numbered(66),
        Color::White => numbered(67),
        Color::Indexed(index) => format!("{};5;{index}", base + 8),
        Color::Rgb(red, green, blue) => match cube(red, green, blue) {
            Some(index) => format!("{};5;{index}", base + 8),
            None => format!("{};2;{red};{green};{blue}", base + 8),
        },
    }
}

/// Returns the number of a colour in the table of 256 if the table's cube of 6 × 6 × 6 contains exactly this colour:
/// the number is shorter.
fn cube(red: u8, green: u8, blue: u8) -> Option<u8> {
    let step = |part: u8| {
        [0, 95, 135, 175, 215, 255]
            .iter()
            .position(|&level| level == part)
    };
    let index = 16 + 36 * step(red)? + 6 * step(green)? + step(blue)?;
    u8::try_from(index).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn styles_are_sent_as_their_difference() {
        let pen = |attributes, fore| CellStyle {
            fore,
            back: Color::Reset,
            attributes,
        };
        let change = |from: CellStyle, to: CellStyle| {
            let mut out = Vec::new();
            to.change(from, &mut out);
            String::from_utf8(out).expect("text")
        };
        let (bold, dim) = (Modifier::BOLD, Modifier::DIM);
        let red = pen(bold, Color::Red);
        assert_eq!(change(red, red), "");
        assert_eq!(change(red, PLAIN), "\x1b[m");
        assert_eq!(change(PLAIN, red), "\x1b[1;31m");
        assert_eq!(change(red, pen(bold, Color::LightGreen)), "\x1b[92m");
        assert_eq!(change(red, pen(dim, Color::Red)), "\x1b[22;2m");
        assert_eq!(
            change(pen(bold | dim, Color::Reset), pen(dim, Color::Reset)),
            "\x1b[0;2m"
        );
        assert_eq!(
            change(PLAIN, pen(Modifier::empty(), Color::Indexed(114))),
            "\x1b[38;5;114m"
        );
        let rgb = |red, green, blue| pen(Modifier::empty(), Color::Rgb(red, green, blue));
        assert_eq!(change(PLAIN, rgb(1, 2, 3)), "\x1b[38;2;1;2;3m");
        assert_eq!(change(PLAIN, rgb(135, 215, 135)), "\x1b[38;5;114m");
        assert_eq!(change(PLAIN, rgb(255, 255, 255)), "\x1b[38;5;231m");
    }
}
