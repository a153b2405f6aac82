//! The flags that override settings: `--theme`, `--color`, `--ascii`, `--no-mouse`, `--library` and those of the
//! sensor.

use std::path::PathBuf;

use clap::ArgMatches;

use crate::cli::arguments::parameters::Given;
use crate::tui::widget::theme::{ColorDepth, Palette};

/// The value of a flag that takes one of several words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Choice<T> {
    /// `auto`: the program chooses, even if the file says otherwise.
    Auto,
    /// Another word, which means this value.
    Made(T),
}

impl<T> Choice<T> {
    /// Returns the value chosen, or None for `auto`.
    pub(crate) fn made(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Made(value) => Some(value),
        }
    }
}

/// The settings given by flags. None, false or empty means that the flag was not given.
#[derive(Clone, Debug, Default)]
pub(crate) struct Chosen {
    /// `--theme`.
    pub(crate) theme: Option<Choice<Palette>>,
    /// `--color`.
    pub(crate) color: Option<Choice<ColorDepth>>,
    /// `--ascii`.
    pub(crate) ascii: bool,
    /// `--no-mouse`.
    pub(crate) no_mouse: bool,
    /// `--library`.
    pub(crate) library: Option<PathBuf>,
    /// `--columns`, `--rows`, `--threshold` and `--pitch`.
    pub(crate) sensor: Given,
}

impl Chosen {
    /// Reads the flags of a command. A flag that the command does not have counts as not given.
    pub(crate) fn of(matches: &ArgMatches) -> Self {
        let chosen = |name: &str| {
            let chosen = matches.try_get_one::<String>(name).ok().flatten();
            chosen.map(String::as_str)
        };
        let switched = |name: &str| {
            let switch = matches.try_get_one::<bool>(name).ok().flatten();
            switch.copied().unwrap_or(false)
        };
        Self {
            theme: chosen("theme").map(|name| value_of(&Palette::NAMES, name)),
            color: chosen("color").map(|name| value_of(&ColorDepth::NAMES, name)),
            ascii: switched("ascii"),
            no_mouse: switched("no-mouse"),
            library: matches.get_one::<PathBuf>("library").cloned(),
            sensor: Given::of(matches),
        }
    }
}

/// Returns the value of a word. Unknown words give `auto`, but clap has refused them already.
fn value_of<T: Copy>(names: &[(&'static str, T)], name: &str) -> Choice<T> {
    let found = names.iter().find(|(own, _)| *own == name);
    found.map_or(Choice::Auto, |(_, value)| Choice::Made(*value))
}
