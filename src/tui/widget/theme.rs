//! The look of the screen: a style for each role, and the characters of taxels, bars and signs.
//!
//! Nothing is expressed by colour alone: a character or a word says the same. The Unicode characters are those that
//! the fonts of text consoles have (code page 437).

use std::borrow::Cow;

use ratatui::style::{Color, Modifier, Style};
use taxel_files::formats::value::fitting;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    Text,
    Quiet,
    Key,
    Title,
    Chosen,
    Active,
    Hole,
    Inactive,
    Surplus,
    Missing,
    Cursor,
    Focus,
    Error,
}

/// Roles have no other styles than these, apart from colours.
pub fn letter(style: &Style) -> char {
    let has = |modifier| style.add_modifier.contains(modifier);
    if has(Modifier::REVERSED) {
        'R'
    } else if has(Modifier::BOLD) {
        'B'
    } else if has(Modifier::DIM) {
        'D'
    } else {
        '.'
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColorDepth {
    Never,
    Sixteen,
    TwoFiftySix,
    True,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    Dark,
    Light,
    /// No colours, even if the terminal has them.
    Mono,
}

impl ColorDepth {
    pub const NAMES: [(&'static str, Self); 4] = [
        ("never", Self::Never),
        ("16", Self::Sixteen),
        ("256", Self::TwoFiftySix),
        ("true", Self::True),
    ];
}

impl Palette {
    pub const NAMES: [(&'static str, Self); 3] = [
        ("dark", Self::Dark),
        ("light", Self::Light),
        ("mono", Self::Mono),
    ];
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Theme {
    pub ascii: bool,
    pub console: bool,
    pub depth: ColorDepth,
    pub palette: Palette,
}

pub type Glyphs = [char; 2];

pub(in crate::tui) type Tone = (Color, u8, [u8; 3]);

/// Bright colours of the sixteen are not used: some terminals show them as bold, some not at all.
const DARK: [Tone; 6] = [
    (Color::Cyan, 80, [95, 215, 215]),
    (Color::Yellow, 221, [255, 215, 95]),
    (Color::Blue, 75, [95, 175, 255]),
    (Color::Green, 114, [135, 215, 135]),
    (Color::Magenta, 176, [215, 135, 215]),
    (Color::Red, 203, [255, 95, 95]),
];
/// Yellow on white cannot be read.
const LIGHT: [Tone; 6] = [
    (Color::Cyan, 31, [0, 135, 175]),
    (Color::Magenta, 130, [175, 95, 0]),
    (Color::Blue, 25, [0, 95, 175]),
    (Color::Green, 28, [0, 135, 0]),
    (Color::Magenta, 127, [175, 0, 175]),
    (Color::Red, 160, [215, 0, 0]),
];

impl Theme {
    pub const fn plain(ascii: bool) -> Self {
        Self {
            ascii,
            console: false,
            depth: ColorDepth::Never,
            palette: Palette::Mono,
        }
    }

    /// Chooses what the terminal can show.
    pub(in crate::tui) fn pick<T>(&self, ascii: T, other: T) -> T {
        if self.ascii { ascii } else { other }
    }

    pub fn style(&self, role: Role) -> Style {
        let style = match role {
            Role::Quiet | Role::Inactive => Style::new().add_modifier(Modifier::DIM),
            Role::Key | Role::Title | Role::Error | Role::Surplus | Role::Missing => {
                Style::new().add_modifier(Modifier::BOLD)
            }
            Role::Cursor | Role::Focus => Style::new().add_modifier(Modifier::REVERSED),
            Role::Text | Role::Active | Role::Chosen | Role::Hole => Style::new(),
        };
        let tint = match (role, self.palette) {
            (Role::Title, Palette::Dark) | (Role::Active, Palette::Light) => 0,
            (Role::Hole, _) => 1,
            (Role::Title | Role::Active, _) => 2,
            (Role::Chosen, _) => 3,
            (Role::Error | Role::Surplus | Role::Missing, _) => 5,
            _ => return style,
        };
        style.patch(self.tint(tint))
    }

    pub(in crate::tui) fn color(self, (named, index, [red, green, blue]): Tone) -> Option<Color> {
        match self.depth {
            ColorDepth::Never => None,
            ColorDepth::Sixteen => Some(named),
            ColorDepth::TwoFiftySix => Some(Color::Indexed(index)),
            ColorDepth::True => Some(Color::Rgb(red, green, blue)),
        }
    }

    pub fn tint(&self, number: usize) -> Style {
        let tints = match self.palette {
            Palette::Dark => DARK,
            Palette::Light => LIGHT,
            Palette::Mono => return Style::new(),
        };
        let color = self.color(tints[number % tints.len()]);
        color.map_or(Style::new(), |color| Style::new().fg(color))
    }

    pub fn taxel(&self, role: Role) -> Glyphs {
        match (role, self.ascii) {
            (Role::Chosen, true) => ['#', '#'],
            (Role::Active, true) => ['%', '%'],
            (Role::Surplus, _) => ['+', '+'],
            (Role::Missing, _) => ['-', '-'],
            (Role::Hole, true) => ['o', 'o'],
            (_, true) => ['.', ' '],
            (Role::Chosen, false) => ['█', '█'],
            (Role::Active, false) => ['▒', '▒'],
            (Role::Hole, false) => ['░', '░'],
            (_, false) => ['·', ' '],
        }
    }

    /// Returns the characters for a coverage from 0 to 1, in five shades.
    pub fn shade(&self, coverage: f64) -> Glyphs {
        let shades = self.pick(['.', ':', '+', '%', '#'], ['·', '░', '▒', '▓', '█']);
        let shade = match coverage {
            none if none <= 0.0 => 0,
            low if low < 0.25 => 1,
            low if low < 0.5 => 2,
            high if high < 1.0 => 3,
            _ => 4,
        };
        [shades[shade], if shade == 0 { ' ' } else { shades[shade] }]
    }

    pub fn bar(&self) -> [char; 3] {
        self.pick(['#', '=', '.'], ['█', '▌', '░'])
    }

    /// ASCII does not tell which of the two is.
    pub fn half(&self, upper: bool, lower: bool) -> char {
        match (self.ascii, upper, lower) {
            (true, false, false) => '.',
            (true, ..) => '#',
            (false, true, true) => '█',
            (false, true, false) => '▀',
            (false, false, true) => '▄',
            (false, false, false) => '·',
        }
    }

    /// Returns the character for two taxels with these roles, one above the other, and the role in which to draw it.
    /// If only one is active, the described region has half blocks and the others quarters. A described hole stays
    /// visible beside an active taxel: `b` has the hole below, `p` above.
    pub fn two_taxels(&self, upper: Role, lower: Role) -> (char, Role) {
        use Role::{Active, Chosen, Hole};
        let quarters = !self.ascii && !self.console;
        match (upper, lower) {
            _ if upper == lower => (self.taxel(upper)[0], upper),
            (Hole, Active | Chosen) if quarters => ('▙', Hole),
            (Active | Chosen, Hole) if quarters => ('▛', Hole),
            (Hole, Active | Chosen) => ('p', Hole),
            (Active | Chosen, Hole) => ('b', Hole),
            (Chosen, _) => (self.pick('"', '▀'), Chosen),
            (_, Chosen) => (self.pick('_', '▄'), Chosen),
            (Active, _) if quarters => ('▘', Active),
            (_, Active) if quarters => ('▖', Active),
            (Active, _) => ('\'', Active),
            (_, Active) => (',', Active),
            (Hole, _) => (self.taxel(Hole)[0], Hole),
            _ => (self.taxel(lower)[0], lower),
        }
    }

    pub fn half_cursor(&self, lower: bool, active: bool) -> char {
        let signs = if lower { ['v', 'V'] } else { ['^', 'A'] };
        signs[usize::from(active)]
    }

    pub fn more(&self) -> [char; 4] {
        self.pick(['^', 'v', '<', '>'], ['↑', '↓', '←', '→'])
    }

    pub fn sorted(&self, is_ascending: bool) -> char {
        let [up, down, ..] = self.more();
        if is_ascending { up } else { down }
    }

    pub fn none(&self) -> &'static str {
        if self.ascii { "-" } else { "–" }
    }

    pub fn number(&self, value: Option<f64>, width: usize) -> String {
        value.map_or_else(|| self.none().to_owned(), |value| fitting(value, width))
    }

    /// Returns a text in characters of the terminal; in ASCII, "17°" becomes "17 deg". A character without a spelling
    /// becomes a question mark, so that the columns of the screen stay in place.
    pub fn text<'a>(&self, text: &'a str) -> Cow<'a, str> {
        if !self.ascii || text.is_ascii() {
            return Cow::Borrowed(text);
        }
        let mut plain = String::with_capacity(text.len());
        for character in text.chars() {
            match spelling(character) {
                Some(spelling) => plain.push_str(spelling),
                None if character.is_ascii() => plain.push(character),
                None => plain.push('?'),
            }
        }
        Cow::Owned(plain)
    }
}

/// The screen and the command line share this table.
pub(crate) fn spelling(sign: char) -> Option<&'static str> {
    Some(match sign {
        '°' => " deg",
        '±' => "+-",
        '²' => "^2",
        '×' => "x",
        '·' => "*",
        'π' => "pi",
        '–' | '—' => "-",
        '…' => "...",
        '→' => "->",
        _ => return None,
    })
}
