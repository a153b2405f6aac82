//! Decides what to send to the terminal, from the environment and the command line, without asking the terminal.
//!
//! The variable `TERM` names the kind of terminal. If it is not set, or is `dumb`, the terminal is taken to move its
//! cursor and no more; names of video terminals (`vt100`) are taken for serial lines.

use std::ffi::OsString;

use crate::tui::terminal::screen::Abilities;
use crate::tui::widget::{ColorDepth, Palette, Theme};

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TerminalKind {
    /// Moves its cursor and clears its screen; has no styles and only ASCII characters.
    Dumb,
    Serial,
    Console,
    Window,
}

impl TerminalKind {
    fn of(term: &str) -> Self {
        let begins = |starts: &[&str]| starts.iter().any(|start| term.starts_with(start));
        match term {
            "" | "dumb" | "unknown" | "network" => Self::Dumb,
            // Its name begins like the old terminals', but it is a library for windows.
            _ if begins(&["vte"]) => Self::Window,
            _ if begins(&["vt", "ansi", "pcansi", "wy"]) => Self::Serial,
            _ if begins(&["linux", "cons25", "bterm", "fbterm"]) => Self::Console,
            _ => Self::Window,
        }
    }

    pub(super) fn has_modes(self) -> bool {
        self >= Self::Console
    }
}

/// The settings that the command line gives; None where it gives none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags {
    /// `--color`; None chooses automatically.
    pub color: Option<ColorDepth>,
    pub palette: Option<Palette>,
    /// Whether characters are ASCII only; None decides by the kind of terminal.
    pub ascii: Option<bool>,
    pub no_mouse: bool,
    /// `--size`: columns and rows.
    pub size: Option<(u16, u16)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TerminalSettings {
    pub kind: TerminalKind,
    pub size: Option<(u16, u16)>,
    pub fallback: (u16, u16),
    pub mouse: bool,
    pub theme: Theme,
    pub abilities: Abilities,
}

impl TerminalSettings {
    pub fn from_environment(
        variable: impl Fn(&'static str) -> Option<OsString>,
        flags: &Flags,
    ) -> Self {
        // A variable that is not set, or is not text, counts as empty.
        let text = |name| {
            let value = variable(name).and_then(|value| value.into_string().ok());
            value.unwrap_or_default()
        };
        let number = |name, otherwise| {
            let number = text(name).trim().parse().ok();
            number.filter(|&number| number > 0).unwrap_or(otherwise)
        };
        let term = text("TERM");
        let kind = TerminalKind::of(&term);
        let color = flags.color.unwrap_or_else(|| match kind {
            _ if !text("NO_COLOR").is_empty() => ColorDepth::Never,
            TerminalKind::Dumb | TerminalKind::Serial => ColorDepth::Never,
            TerminalKind::Console => ColorDepth::Sixteen,
            TerminalKind::Window => depth(&term, &text("COLORTERM")),
        });
        Self {
            kind,
            size: flags.size,
            fallback: (number("COLUMNS", 80), number("LINES", 24)),
            mouse: kind == TerminalKind::Window && !flags.no_mouse,
            theme: Theme {
                ascii: flags.ascii.unwrap_or(kind <= TerminalKind::Serial),
                console: kind < TerminalKind::Window,
                depth: color,
                palette: flags
                    .palette
                    .unwrap_or_else(|| background(&text("COLORFGBG"))),
            },
            abilities: Abilities {
                styles: kind > TerminalKind::Dumb || color != ColorDepth::Never,
                synchronized: kind == TerminalKind::Window,
            },
        }
    }
}

fn depth(term: &str, colorterm: &str) -> ColorDepth {
    let has = |ends: &[&str]| ends.iter().any(|end| term.contains(end));
    if matches!(colorterm, "truecolor" | "24bit") || has(&["direct", "truecolor"]) {
        ColorDepth::True
    } else if has(&["256color", "kitty", "alacritty", "foot", "ghostty"]) {
        ColorDepth::TwoFiftySix
    } else if has(&["mono"]) || term.ends_with("-m") {
        ColorDepth::Never
    } else {
        ColorDepth::Sixteen
    }
}

/// Returns the palette for the colours that some terminals report as "15;0": the last number is the background's; 7
/// and 15 are white.
fn background(colors: &str) -> Palette {
    match colors.rsplit(';').next() {
        Some("7" | "15") => Palette::Light,
        _ => Palette::Dark,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(variables: &[(&str, &str)], flags: Flags) -> TerminalSettings {
        let variable = |name| {
            let found = variables.iter().find(|(own, _)| *own == name);
            found.map(|(_, value)| OsString::from(value))
        };
        TerminalSettings::from_environment(variable, &flags)
    }

    fn term(term: &str) -> TerminalSettings {
        settings(&[("TERM", term)], Flags::default())
    }

    #[test]
    fn colours_follow_the_terminal_unless_a_variable_or_flag_overrides_it() {
        assert_eq!(term("linux").theme.depth, ColorDepth::Sixteen);
        assert_eq!(term("xterm").theme.depth, ColorDepth::Sixteen);
        assert_eq!(term("putty-m1").theme.depth, ColorDepth::Sixteen);
        assert_eq!(term("xterm-mono").theme.depth, ColorDepth::Never);
        assert_eq!(term("ansi-m").theme.depth, ColorDepth::Never);
        assert_eq!(term("screen-256color").theme.depth, ColorDepth::TwoFiftySix);
        assert_eq!(term("vt100").theme.depth, ColorDepth::Never);
        let with = |name, value| {
            let variables = [("TERM", "xterm-256color"), (name, value)];
            settings(&variables, Flags::default()).theme.depth
        };
        assert_eq!(with("COLORTERM", "truecolor"), ColorDepth::True);
        assert_eq!(with("NO_COLOR", "1"), ColorDepth::Never);
        // Empty counts as unset: https://no-color.org
        assert_eq!(with("NO_COLOR", ""), ColorDepth::TwoFiftySix);
        let asked = Flags {
            color: Some(ColorDepth::Sixteen),
            ..Flags::default()
        };
        let forced = settings(&[("TERM", "dumb"), ("NO_COLOR", "1")], asked);
        assert_eq!(
            (forced.theme.depth, forced.abilities.styles),
            (ColorDepth::Sixteen, true),
            "the command line wins"
        );
    }

    #[test]
    fn sizes_and_backgrounds_come_from_the_environment() {
        let none = term("xterm");
        assert_eq!((none.size, none.fallback), (None, (80, 24)));
        let some = settings(
            &[
                ("COLUMNS", "132"),
                ("LINES", " 43 "),
                ("COLORFGBG", "0;default;15"),
            ],
            Flags::default(),
        );
        assert_eq!(
            (some.fallback, some.theme.palette),
            ((132, 43), Palette::Light)
        );
        for wrong in ["0", "-5", "many", "99999999"] {
            let settings = settings(&[("COLUMNS", wrong), ("LINES", wrong)], Flags::default());
            assert_eq!(settings.fallback, (80, 24), "{wrong}");
        }
    }
}
