//! The table of commands: what a line at the foot of the screen may say, what it means, and how it is completed.

use crate::figure::FigureKind;
use crate::parameter::Parameter;
use crate::pose::Ranges;
use crate::sensor::SENSOR_PARAMETERS;
use crate::tui::app::message::{Copied, Endpoint, Message};
use crate::tui::explore::message::ExploreMessage;
use crate::tui::keys::key::Arrow;
use crate::tui::shapes::purpose::Purpose;

/// What may follow the name of a command, beside its words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Takes {
    /// Nothing.
    Nothing,
    /// The name of a shape, and what for.
    Shape(Purpose),
    /// The name of a shape that was deleted.
    Deleted,
    /// A name to store under.
    Name,
    /// A kind of figure, and its numbers.
    Figure,
    /// Numbers of the sensor.
    Sensor,
    /// Ranges of a sweep.
    Ranges,
    /// Whole degrees.
    Degrees,
    /// Column and row of a taxel.
    Taxel,
    /// How far, along x and along y.
    Way,
}

impl Takes {
    /// How it is written; empty where there is nothing to write.
    pub fn form(self) -> &'static str {
        match self {
            Self::Nothing => "",
            Self::Shape(_) | Self::Deleted | Self::Name => "NAME",
            Self::Figure => "KIND --side 3 ...",
            Self::Sensor => "--columns 32 ...",
            Self::Ranges => "--x0 5:5.99:0.01 ...",
            Self::Degrees => "DEGREES",
            Self::Taxel => "COLUMN ROW",
            Self::Way => "DX DY",
        }
    }

    /// Whether the whole rest of the line is a name of the library.
    fn is_name(self) -> bool {
        matches!(self, Self::Shape(_) | Self::Deleted | Self::Name)
    }
}

/// A command.
#[derive(Clone, Debug)]
pub struct PromptCommand {
    /// The first word.
    pub name: &'static str,
    /// Words that may follow, each with what the line then means; an empty one is the name alone.
    pub words: &'static [(&'static str, Message)],
    /// What else may follow.
    pub takes: Takes,
}

const fn command(
    name: &'static str,
    words: &'static [(&'static str, Message)],
    takes: Takes,
) -> PromptCommand {
    PromptCommand { name, words, takes }
}

/// All commands, by name. Every action of a key is the meaning of a line.
pub const COMMANDS: &[PromptCommand] = &[
    command(
        "copy",
        &[
            ("", Message::Copy(Copied::Descriptors)),
            ("descriptors", Message::Copy(Copied::Descriptors)),
            ("imprint", Message::Copy(Copied::Imprint)),
        ],
        Takes::Nothing,
    ),
    command("coverage", &[("", Message::Display)], Takes::Nothing),
    command(
        "cursor",
        &[
            ("left", Message::Cursor(Arrow::Left)),
            ("right", Message::Cursor(Arrow::Right)),
            ("up", Message::Cursor(Arrow::Up)),
            ("down", Message::Cursor(Arrow::Down)),
            ("start", Message::ToColumn(Endpoint::First)),
            ("end", Message::ToColumn(Endpoint::Last)),
            ("top", Message::ToRow(Endpoint::First)),
            ("bottom", Message::ToRow(Endpoint::Last)),
        ],
        Takes::Taxel,
    ),
    command(
        "delete",
        &[("", Message::Delete)],
        Takes::Shape(Purpose::Delete),
    ),
    command(
        "explore",
        &[("", Message::Explore(ExploreMessage::Open))],
        Takes::Ranges,
    ),
    command("figure", &[("", Message::Figure)], Takes::Figure),
    command("grab", &[("", Message::Grab)], Takes::Nothing),
    command("help", &[("", Message::Help)], Takes::Nothing),
    command("load", &[("", Message::Load)], Takes::Shape(Purpose::Load)),
    command("mouse", &[("", Message::MouseOnOff)], Takes::Nothing),
    command("move", &[], Takes::Way),
    command("new", &[("", Message::New)], Takes::Nothing),
    command(
        "nudge",
        &[
            ("left", Message::Nudge(Arrow::Left)),
            ("right", Message::Nudge(Arrow::Right)),
            ("up", Message::Nudge(Arrow::Up)),
            ("down", Message::Nudge(Arrow::Down)),
        ],
        Takes::Nothing,
    ),
    command("panel", &[("", Message::SwitchPage)], Takes::Nothing),
    command(
        "picture",
        &[("", Message::Picture)],
        Takes::Shape(Purpose::Picture),
    ),
    command("quit", &[("", Message::Quit)], Takes::Nothing),
    command("quit!", &[("", Message::QuitNow)], Takes::Nothing),
    command("redo", &[("", Message::Redo)], Takes::Nothing),
    command("redraw", &[("", Message::Redraw)], Takes::Nothing),
    command(
        "region",
        &[
            ("", Message::Region(1)),
            ("next", Message::Region(1)),
            ("previous", Message::Region(-1)),
        ],
        Takes::Nothing,
    ),
    command("restore", &[], Takes::Deleted),
    command("save", &[("", Message::Save)], Takes::Name),
    command("sensor", &[("", Message::Sensor)], Takes::Sensor),
    command(
        "step",
        &[
            ("larger", Message::NudgeStep(1)),
            ("smaller", Message::NudgeStep(-1)),
        ],
        Takes::Nothing,
    ),
    command("suspend", &[("", Message::Suspend)], Takes::Nothing),
    command("toggle", &[("", Message::Toggle)], Takes::Nothing),
    command("turn", &[], Takes::Degrees),
    command("undo", &[("", Message::Undo)], Takes::Nothing),
    command(
        "zoom",
        &[("in", Message::Zoom(1)), ("out", Message::Zoom(-1))],
        Takes::Nothing,
    ),
];

/// The command of that name, or of its short form.
pub fn find(name: &str) -> Option<&'static PromptCommand> {
    let name = match name {
        "q" => "quit",
        "q!" => "quit!",
        other => other,
    };
    COMMANDS.iter().find(|command| command.name == name)
}

/// The command that a line begins with, and what follows; none while its name is not followed by a space.
fn begun(line: &str) -> Option<(&'static PromptCommand, &str)> {
    let (name, rest) = line.trim_start().split_once(' ')?;
    Some((find(name)?, rest.trim_start()))
}

/// Names of which shapes the completion of a line wants to know; none where it wants no names.
pub fn wants_names(line: &str) -> Option<Takes> {
    let (command, _) = begun(line)?;
    command.takes.is_name().then_some(command.takes)
}

/// The line with its last word, or the name at its end, completed as far as it is certain, and what it could become.
/// `names` are those that [`wants_names`] asks for.
pub fn complete(line: &str, names: &[String]) -> (String, Vec<String>) {
    let (typed, candidates) = match begun(line) {
        None if line.trim_start().contains(' ') => return (line.to_owned(), Vec::new()),
        None => (
            line.trim_start(),
            COMMANDS
                .iter()
                .map(|command| command.name.to_owned())
                .collect(),
        ),
        Some((command, rest)) if command.takes.is_name() => (rest, names.to_vec()),
        Some((command, rest)) => {
            let (before, last) = rest.rsplit_once(' ').unwrap_or(("", rest));
            (last, next_words(command, before))
        }
    };
    let is_name = wants_names(line).is_some();
    let fits = |candidate: &String| {
        if is_name {
            candidate.to_lowercase().starts_with(&typed.to_lowercase())
        } else {
            candidate.starts_with(typed)
        }
    };
    let fitting: Vec<String> = candidates.into_iter().filter(fits).collect();
    let completed = match &fitting[..] {
        [] => typed.to_owned(),
        // A name is the last thing in its line.
        [only] if is_name => only.clone(),
        [only] => format!("{only} "),
        _ => common_start(&fitting)
            .filter(|common| common.chars().count() > typed.chars().count())
            .unwrap_or_else(|| typed.to_owned()),
    };
    let before = &line[..line.len() - typed.len()];
    (format!("{before}{completed}"), fitting)
}

/// The words that may come next in a line whose words so far are known.
fn next_words(command: &PromptCommand, before: &str) -> Vec<String> {
    let said: Vec<&str> = before.split_whitespace().collect();
    let words = |flags: Vec<String>, said: &[&str]| {
        // A flag is followed by its value.
        if said.len() % 2 == 1 {
            return Vec::new();
        }
        let unsaid = flags.into_iter();
        unsaid
            .filter(|flag| !said.contains(&flag.as_str()))
            .collect()
    };
    let flags = |parameters: Vec<Parameter>, said: &[&str]| {
        let flags = parameters.iter();
        let flags = flags.map(|parameter| format!("--{}", parameter.flag()));
        words(flags.collect(), said)
    };
    match (command.takes, &said[..]) {
        (Takes::Figure, []) => FigureKind::ALL.map(|kind| kind.name().to_owned()).to_vec(),
        (Takes::Figure, [kind, said @ ..]) => FigureKind::from_name(kind)
            .map(|kind| flags(kind.parameters().collect(), said))
            .unwrap_or_default(),
        (Takes::Sensor, said) => flags(SENSOR_PARAMETERS.to_vec(), said),
        (Takes::Ranges, said) => {
            let rows = Ranges::default().by_parameter();
            let ranges = rows.map(|(parameter, _)| format!("--{}", parameter.flag()));
            words([&ranges[..], &["--anchor".to_owned()]].concat(), said)
        }
        (_, []) => {
            let words = command.words.iter().filter(|(word, _)| !word.is_empty());
            words.map(|(word, _)| (*word).to_owned()).collect()
        }
        _ => Vec::new(),
    }
}

/// What several words have in common at their start; none of no words.
fn common_start(words: &[String]) -> Option<String> {
    let (first, others) = words.split_first()?;
    let common = others.iter().fold(first.chars().count(), |common, other| {
        let same = first.chars().zip(other.chars()).take_while(|(a, b)| a == b);
        common.min(same.count())
    });
    Some(first.chars().take(common).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn completed(line: &str) -> (String, Vec<String>) {
        let names = ["washer", "Wasp", "my shape"].map(str::to_owned);
        complete(line, &names)
    }

    #[test]
    fn lines_are_completed_as_far_as_it_is_certain() {
        for (line, expected, candidates) in [
            ("fi", "figure ", 1),
            ("re", "re", 4),
            ("res", "restore ", 1),
            ("co", "co", 2),
            ("cop", "copy ", 1),
            ("copy ", "copy ", 2),
            ("copy i", "copy imprint ", 1),
            ("copy imprint ", "copy imprint ", 0),
            ("figure h", "figure he", 2),
            ("figure hex", "figure hexagon ", 1),
            ("figure hexagon --s", "figure hexagon --side ", 1),
            ("figure hexagon --side ", "figure hexagon --side ", 0),
            (
                "figure hexagon --side 3 --s",
                "figure hexagon --side 3 --s",
                0,
            ),
            (
                "figure hexagon --side 3 --an",
                "figure hexagon --side 3 --angle ",
                1,
            ),
            ("figure nothing --s", "figure nothing --s", 0),
            ("sensor --p", "sensor --pitch ", 1),
            ("cursor 3 ", "cursor 3 ", 0),
            ("load w", "load w", 2),
            ("load was", "load was", 2),
            ("load wash", "load washer", 1),
            ("load WASP", "load Wasp", 1),
            ("load my s", "load my shape", 1),
            ("load x", "load x", 0),
            ("nothing x", "nothing x", 0),
        ] {
            let (line_now, found) = completed(line);
            assert_eq!(
                (line_now.as_str(), found.len()),
                (expected, candidates),
                "{line}"
            );
        }
        assert_eq!(completed("").1.len(), COMMANDS.len());
        assert_eq!(wants_names("load "), Some(Takes::Shape(Purpose::Load)));
        assert_eq!(wants_names("load"), None);
        assert_eq!(wants_names("zoom "), None);
    }
}
