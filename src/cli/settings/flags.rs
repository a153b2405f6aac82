//! The flags that override settings: `--theme`, `--color`, `--ascii`, `--no-mouse`, `--library` and those of the
//! sensor.

use std::path::PathBuf;

use clap::ArgMatches;

use crate::cli::arguments::parameters::Given;
use crate::tui::widget::theme::{ColorDepth, Palette};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Choice<T> {
    /// `auto`: the program chooses, even if the file says otherwise.
    Auto,
    Made(T),
}

impl<T> Choice<T> {
    pub(crate) fn made(self) -> Option<T> {
        match self {
            Self::Auto => None,
            Self::Made(value) => Some(value),
        }
    }
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Chosen {
    pub(crate) theme: Option<Choice<Palette>>,
    pub(crate) color: Option<Choice<ColorDepth>>,
    pub(crate) ascii: bool,
    pub(crate) no_mouse: bool,
    pub(crate) library: Option<PathBuf>,
    pub(crate) sensor: Given,
}

impl Chosen {
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

fn value_of<T: Copy>(names: &[(&'static str, T)], name: &str) -> Choice<T> {
    let found = names.iter().find(|(own, _)| *own == name);
    found.map_or(Choice::Auto, |(_, value)| Choice::Made(*value))
}
