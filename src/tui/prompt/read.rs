//! Reads a line of the `:` prompt: the name of an action, or a command with arguments.
//!
//! ```text
//! figure hexagon --side 3 --angle 17     a kind, then flags as on the command line
//! sensor --columns 32 --rows 32          only what changes
//! explore --x0 5:5.99:0.01 --anchor centre
//! open ~/mask.csv      write drawing.svg
//! watch run 2.csv --rows 4 --columns 5   a name, then flags
//! load my shape                          names may contain spaces, and are never quoted
//! cursor 3 4      move 0.5 -1      turn 15
//! ```
//! Names, flags and ranges are those of the program's own command line. Parameters of a figure that are not given have
//! their defaults; those of the sensor keep their values.

use taxel_core::figure::{Figure, FigureKind};
use taxel_core::frame::{FrameError, FrameSize, MAX_FRAME_SIDE, Rule};
use taxel_core::parameter::{Parameter, UnknownName, number};
use taxel_core::pose::{Anchor, Axis, GivenRanges, PoseGrid, RangeError, default_ranges};
use taxel_core::quote::{did_you_mean, joined, shortened};
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_core::source::Source;
use taxel_files::formats::Name;
use taxel_files::storage::ModelChoice;

use crate::tui::app::document::Document;
use crate::tui::app::message::{LibraryRequest, Message};
use crate::tui::app::state::App;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::work::explored;
use crate::tui::keys::action::{self, Arguments, FilePurpose};
use crate::tui::keys::keymap::Context;
use crate::tui::live::message::{LiveMessage, NamedSource};
use crate::tui::prompt::commands::{ANCHOR, PromptCommand, commands, find};
use crate::tui::recognise::state::RecogniseMessage;

pub fn read(line: &str, app: &App) -> Result<Message, String> {
    let line = line.trim();
    let (name, rest) = line
        .split_once(' ')
        .map_or((line, ""), |(name, rest)| (name, rest.trim()));
    let command = find(name).ok_or_else(|| {
        let complete = app.keymap().label(Context::Command, &action::NEXT);
        format!(
            "no command named {:?}; {complete} shows all{}",
            shortened(name),
            did_you_mean(name, commands().iter().map(|command| command.name))
        )
    })?;
    let words: Vec<&str> = rest.split_whitespace().collect();
    let mut said = command.words.iter().filter(|(word, _)| *word == rest);
    if let Some(message) = said.find_map(|(_, action)| action.message()) {
        return Ok(message.clone());
    }
    let unexpected = || unexpected(&command, rest);
    let Some(arguments) = command.arguments else {
        return Err(unexpected());
    };
    match (arguments, &words[..]) {
        (Arguments::Deleted, []) => Ok(Message::Request(LibraryRequest::Restore(None))),
        (_, []) => Err(unexpected()),
        (arguments, words) => with_arguments(arguments, rest, words, app, unexpected),
    }
}

/// `unexpected` returns the error that says what they should be.
fn with_arguments(
    arguments: Arguments,
    rest: &str,
    words: &[&str],
    app: &App,
    unexpected: impl Fn() -> String,
) -> Result<Message, String> {
    match (arguments, words) {
        (Arguments::Shape(purpose), _) => {
            let name = name_of(rest)?.to_string();
            Ok(Message::Request(LibraryRequest::Named(purpose, name)))
        }
        (Arguments::File(FilePurpose::Open), _) => Ok(Message::OpenFile(rest.to_owned())),
        (Arguments::File(FilePurpose::Write), _) => Ok(Message::WriteFile(rest.to_owned())),
        (Arguments::Deleted, _) => {
            let name = name_of(rest)?.to_string();
            Ok(Message::Request(LibraryRequest::Restore(Some(name))))
        }
        (Arguments::Name, _) if app.reading().imprint.is_empty() => {
            Err("nothing to save: the matrix is empty".to_owned())
        }
        (Arguments::Name, _) => Ok(Message::Request(LibraryRequest::Save(name_of(rest)?))),
        (Arguments::Figure, [kind, words @ ..]) => figure(kind, words, app),
        (Arguments::Sensor, words) => sensor(words, app),
        (Arguments::Ranges, words) => explore(words, app),
        (Arguments::Model, _) => {
            let choice = ModelChoice::from_text(rest);
            Ok(Message::Recognise(RecogniseMessage::Choose(choice)))
        }
        (Arguments::Seed, _) => seed(rest),
        (Arguments::FrameSource, _) => {
            let source = NamedSource::read(rest)?;
            Ok(Message::Live(LiveMessage::Source(source)))
        }
        (Arguments::Threshold, _) => threshold(rest),
        (Arguments::FrameSize, _) => frame_size(rest),
        (Arguments::Degrees, _) => degrees(rest),
        (Arguments::Taxel, [column, row]) => taxel(column, row, &app.shown().sensor),
        (Arguments::Distance, [dx, dy]) => distance(dx, dy).ok_or_else(unexpected),
        (Arguments::Taxel | Arguments::Distance | Arguments::Figure, _) => Err(unexpected()),
    }
}

fn seed(text: &str) -> Result<Message, String> {
    let seed = text.parse().map_err(|_| {
        format!(
            "seed takes a whole number from 0 to {}, found {:?}",
            u64::MAX,
            shortened(text)
        )
    })?;
    Ok(Message::Recognise(RecogniseMessage::Seed(seed)))
}

fn threshold(text: &str) -> Result<Message, String> {
    let found = shortened(text);
    let value = number::read(text);
    let value = value.ok_or_else(|| format!("at-least takes a number like 10, found {found:?}"))?;
    let rule = Rule::at_least(value).map_err(|error| match error {
        FrameError::Rule { allowed, .. } => {
            format!("at-least: {found} is out of range (allowed: {allowed})")
        }
        error => error.to_string(),
    })?;
    Ok(Message::Live(LiveMessage::AtLeast(rule)))
}

/// Reads columns and rows, as in `16x16`.
fn frame_size(text: &str) -> Result<Message, String> {
    let sides = text.split_once(['x', '×']).and_then(|(columns, rows)| {
        let side = |text: &str| text.trim().parse().ok();
        FrameSize::of_sides(side(columns), side(rows))
    });
    let size = sides.ok_or_else(|| {
        let found = shortened(text);
        format!(
            "size takes columns and rows from 1 to {MAX_FRAME_SIDE}, as in 16x16, found {found:?}"
        )
    });
    Ok(Message::Live(LiveMessage::Size(size?)))
}

/// Reads an angle in degrees: any number, also a negative one.
fn degrees(text: &str) -> Result<Message, String> {
    let degrees = number::read(text).map(Message::Turn);
    degrees.ok_or_else(|| format!("turn takes degrees like 30.5, found {:?}", shortened(text)))
}

fn taxel(column: &str, row: &str, sensor: &Sensor) -> Result<Message, String> {
    let index = |what: &str, text: &str, count: u8| {
        let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
        let found = shortened(text);
        if digits.is_empty() || !digits.bytes().all(|digit| digit.is_ascii_digit()) {
            return Err(format!(
                "cursor takes a column and a row like 3 4, or a direction alone, found {found:?}"
            ));
        }
        let within = text.parse().ok().filter(|&at: &u8| at < count);
        let last = count - 1;
        within.ok_or_else(|| format!("{what} {found} is not on the sensor (allowed: 0 to {last})"))
    };
    let column = index("column", column, sensor.columns())?;
    Ok(Message::PointAt(column, index("row", row, sensor.rows())?))
}

/// Reads a distance in cells along x and y; None unless both are finite numbers.
fn distance(dx: &str, dy: &str) -> Option<Message> {
    Some(Message::Move(number::read(dx)?, number::read(dy)?))
}

fn unexpected(command: &PromptCommand, rest: &str) -> String {
    let words = command.words.iter().map(|(word, _)| *word);
    let mut taken: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    let form = command.arguments.map(|arguments| match arguments {
        Arguments::Degrees => "DEGREES (like 30.5)",
        Arguments::Distance => "DX DY in cells (like 0.5 -1)",
        Arguments::Taxel => "COLUMN ROW (like 3 4)",
        other => other.form(),
    });
    taken.extend(form);
    if taken.is_empty() {
        taken.push("nothing");
    }
    let taken = joined(taken, "or");
    let found = if rest.is_empty() {
        String::new()
    } else {
        format!(", found {:?}", shortened(rest))
    };
    format!("{} takes {taken}{found}", command.name)
}

fn name_of(text: &str) -> Result<Name, String> {
    Name::new(text).map_err(|error| error.to_string())
}

fn flag_of(parameter: Parameter) -> String {
    format!("--{}", parameter.flag())
}

fn numbers(
    words: &[&str],
    parameters: &[Parameter],
    sensor: &Sensor,
) -> Result<Vec<(Parameter, f64)>, String> {
    let known = |flag: &str| Parameter::from_flag(flag.strip_prefix("--")?);
    let names: Vec<String> = parameters.iter().copied().map(flag_of).collect();
    let number = |(_, parameter, text): Flag<'_, Parameter>| {
        let value = sensor.read(parameter, text);
        Ok((parameter, value.map_err(|error| error.labelled())?))
    };
    let flags = read_flags(words, &names, known)?.into_iter();
    flags.map(number).collect()
}

/// Parameters that are not given have their defaults; one that the figure does not have is an error.
fn figure(kind: &str, words: &[&str], app: &App) -> Result<Message, String> {
    let sensor = app.shown().sensor;
    let kind: FigureKind = kind.parse().map_err(|error: UnknownName| {
        let bare = kind.trim_matches(['"', '\'']);
        match bare.parse::<FigureKind>() {
            Ok(_) => format!("leave out the quotes: figure {bare}"),
            Err(_) => error.to_string(),
        }
    })?;
    let values = numbers(words, kind.parameters(), &sensor)?;
    if let Some((foreign, _)) = values
        .iter()
        .find(|(parameter, _)| !kind.parameters().contains(parameter))
    {
        return Err(format!(
            "--{}: the {} has none",
            foreign.flag(),
            kind.name()
        ));
    }
    let figure = values.into_iter().try_fold(
        Figure::default_of(kind, &sensor),
        |figure, (parameter, value)| figure.with(parameter, value, &sensor),
    );
    let figure = figure.map_err(|error| error.to_string())?;
    Ok(Message::Become(Box::new(Document::touched(
        sensor,
        Source::Figure(figure),
    ))))
}

/// Parameters that are not given keep their values.
fn sensor(words: &[&str], app: &App) -> Result<Message, String> {
    let document = app.shown();
    let values = numbers(words, SENSOR_PARAMETERS, &Sensor::LARGEST)?;
    let sensor = values
        .into_iter()
        .try_fold(document.sensor, |sensor, (parameter, value)| {
            sensor.with(parameter, value)
        });
    Ok(Message::Become(Box::new(
        document.on(sensor.map_err(|error| error.to_string())?),
    )))
}

/// Ranges that are not given have their defaults.
fn explore(words: &[&str], app: &App) -> Result<Message, String> {
    let document = app.shown();
    let source = explored(app).ok_or_else(|| app.nothing_to_explore())?;
    let (mut ranges, mut anchor) = (GivenRanges::default(), Anchor::default());
    // An axis, or None for the anchor.
    let known = |flag: &str| {
        let axis = Axis::ALL
            .into_iter()
            .find(|axis| flag_of(axis.parameter()) == flag);
        (axis.is_some() || flag == ANCHOR).then_some(axis)
    };
    let axes = Axis::ALL.map(|axis| flag_of(axis.parameter()));
    let names = [&axes[..], &[ANCHOR.to_owned()]].concat();
    for (flag, axis, text) in read_flags(words, &names, known)? {
        match axis {
            Some(axis) => {
                let range = text.parse();
                ranges[axis] = Some(range.map_err(|error: RangeError| format!("{flag}: {error}"))?);
            }
            None => {
                anchor = text.parse().map_err(|_| {
                    let names = Anchor::NAMES.join(" or ");
                    format!("{ANCHOR} takes {names}, found {}", shortened(text))
                })?;
            }
        }
    }
    let ranges = default_ranges(&source, &document.sensor, anchor, &ranges);
    let ranges = ranges.map_err(|error| error.to_string())?;
    let grid = PoseGrid::new(source, document.sensor, anchor, ranges);
    let grid = grid.map_err(|error| error.to_string())?;
    Ok(Message::Explore(ExploreMessage::Start(Box::new(grid))))
}

pub type Flag<'a, T> = (&'a str, T, &'a str);

/// Reads flags, each with its value and none twice. `known` returns the meaning of a flag; None if it is unknown. An
/// error lists `names`, the first one as an example.
pub fn read_flags<'a, T: PartialEq>(
    words: &[&'a str],
    names: &[impl AsRef<str>],
    known: impl Fn(&str) -> Option<T>,
) -> Result<Vec<Flag<'a, T>>, String> {
    let mut flags: Vec<Flag<'a, T>> = Vec::new();
    let mut words = words.iter().copied().peekable();
    while let Some(word) = words.next() {
        if !word.starts_with("--") {
            let (example, found) = (names.first().map_or("--", AsRef::as_ref), shortened(word));
            return Err(format!("expected a flag like {example}, found {found}"));
        }
        let (flag, value) = match word.split_once('=') {
            Some((flag, value)) => (flag, Some(value)),
            None => (word, None),
        };
        let what = known(flag).ok_or_else(|| unknown(flag, names))?;
        if flags.iter().any(|(_, own, _)| *own == what) {
            return Err(format!("{flag} is given twice"));
        }
        // A number may begin with a minus; a flag in place of the value means that it was left out.
        let value = value.or_else(|| words.next_if(|next| !next.starts_with("--")));
        let value = value.filter(|value| !value.is_empty());
        let value = value.ok_or_else(|| format!("{flag} needs a value"))?;
        flags.push((flag, what, value));
    }
    Ok(flags)
}

fn unknown(flag: &str, names: &[impl AsRef<str>]) -> String {
    let names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    format!(
        "{} is unknown, expected one of {}{}",
        shortened(flag),
        names.join(", "),
        did_you_mean(flag, names)
    )
}

pub(super) fn lacks_value(words: &[&str]) -> bool {
    words
        .iter()
        .fold(false, |lacks, word| !lacks && !word.contains('='))
}

pub(super) fn is_given(flag: &str, words: &[&str]) -> bool {
    words
        .iter()
        .any(|word| word.split('=').next() == Some(flag))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_read_with_a_blank_or_an_equals_sign() {
        let all = ["--side", "--x0"];
        let known = |flag: &str| all.iter().position(|own| *own == flag);
        let given = |line: &'static str| {
            let words: Vec<&str> = line.split_whitespace().collect();
            read_flags(&words, &all, known)
        };
        let both = Ok(vec![("--side", 0, "3.5"), ("--x0", 1, "-2")]);
        assert_eq!(given("--side=3.5 --x0=-2"), both);
        assert_eq!(given("--side 3.5 --x0 -2"), both);
        assert_eq!(given(""), Ok(Vec::new()));
        for (line, error) in [
            ("--side", "--side needs a value"),
            ("--side=", "--side needs a value"),
            ("--side --x0 3", "--side needs a value"),
            ("--side=1 --side 2", "--side is given twice"),
            (
                "--sid=3",
                "--sid is unknown, expected one of --side, --x0; did you mean \"--side\"?",
            ),
            (
                "--angle=3",
                "--angle is unknown, expected one of --side, --x0",
            ),
            ("side=3", "expected a flag like --side, found side=3"),
        ] {
            assert_eq!(given(line), Err(error.to_owned()), "{line}");
        }
        assert!(lacks_value(&["--side=3", "--x0"]) && !lacks_value(&["--side=3"]));
    }
}
