//! The command line at the foot of the screen: every action by its name, figures and sensors with their numbers.
//!
//! Names and flags are those of the program's own command line: `figure hexagon --side 3 --angle 17`,
//! `load washer`, `sensor --columns 32 --rows 32`. What is not given is as it is now, or the default.

use super::app::App;
use super::document::Document;
use super::message::{Copied, Message};
use crate::figure::{Figure, Kind};
use crate::formats::name::Name;
use crate::library::store::{Expected, Origin};
use crate::parameter::Parameter;
use crate::source::Source;

/// What a line asks for.
///
/// # Errors
/// What is wrong with it, in a sentence.
pub fn read(line: &str, app: &App) -> Result<Message, String> {
    let line = line.trim();
    let (name, rest) = line
        .split_once(' ')
        .map_or((line, ""), |(name, rest)| (name, rest.trim()));
    let words: Vec<&str> = rest.split_whitespace().collect();
    let alone = |message: Message| {
        if rest.is_empty() {
            Ok(message)
        } else {
            Err(format!("{name} takes nothing, found {rest}"))
        }
    };
    let with_name = |otherwise: Message, named: fn(String) -> Message| {
        if rest.is_empty() {
            Ok(otherwise)
        } else {
            Name::new(rest)
                .map(|name| named(name.to_string()))
                .map_err(|error| error.to_string())
        }
    };
    match name {
        "copy" => match rest {
            "imprint" => Ok(Message::Copy(Copied::Imprint)),
            "" | "descriptors" => Ok(Message::Copy(Copied::Descriptors)),
            other => Err(format!("copy takes imprint or descriptors, found {other}")),
        },
        "coverage" => alone(Message::Display),
        "delete" => with_name(Message::Delete, Message::AskRemove),
        "figure" if rest.is_empty() => Ok(Message::Figure),
        "figure" => figure(&words, app),
        "grab" => alone(Message::Grab),
        "help" => alone(Message::Help),
        "load" => with_name(Message::Load, Message::LoadNamed),
        "mouse" => alone(Message::MouseOnOff),
        "new" => alone(Message::New),
        "panel" => alone(Message::Page),
        "picture" => with_name(Message::Picture, Message::PictureNamed),
        "quit" | "q" => alone(Message::Quit),
        "quit!" | "q!" => alone(Message::QuitNow),
        "redo" => alone(Message::Redo),
        "redraw" => alone(Message::Redraw),
        "region" => alone(Message::Region(1)),
        "restore" => with_name(Message::Undo, Message::Restore),
        "save" if rest.is_empty() => Ok(Message::Save),
        "save" => save(rest, app),
        "sensor" if rest.is_empty() => Ok(Message::Sensor),
        "sensor" => sensor(&words, app),
        "toggle" => alone(Message::Toggle),
        "turn" => match rest.parse() {
            Ok(degrees) if (-360..=360).contains(&degrees) => Ok(Message::Turn(degrees)),
            _ => Err(format!(
                "turn takes whole degrees from -360 to 360, found {rest:?}"
            )),
        },
        "zoom" => match rest {
            "in" => Ok(Message::Zoom(1)),
            "out" => Ok(Message::Zoom(-1)),
            _ => Err(format!("zoom takes in or out, found {rest:?}")),
        },
        "undo" => alone(Message::Undo),
        _ => Err(format!("{name:?} is unknown; Tab shows the commands")),
    }
}

/// The numbers of `--key value` pairs.
fn pairs(words: &[&str], side: u8) -> Result<Vec<(Parameter, f64)>, String> {
    let pair = |pair: &[&str]| {
        let flag = pair.first().copied().unwrap_or_default();
        let key = flag
            .strip_prefix("--")
            .ok_or_else(|| format!("expected a flag like --side, found {flag}"))?;
        let parameter = Parameter::from_flag(key).ok_or_else(|| format!("{flag} is unknown"))?;
        let text = pair
            .get(1)
            .ok_or_else(|| format!("{flag} needs a number"))?;
        let value = parameter.read(text, side);
        Ok((parameter, value.map_err(|error| error.to_string())?))
    };
    words.chunks(2).map(pair).collect()
}

fn figure(words: &[&str], app: &App) -> Result<Message, String> {
    let sensor = app.shown().sensor;
    let (name, rest) = words.split_first().ok_or("figure needs a kind")?;
    let kind = Kind::from_name(name).ok_or_else(|| {
        format!(
            "figure: {name:?} is unknown, expected one of {}",
            Kind::ALL.map(Kind::name).join(", ")
        )
    })?;
    let values = pairs(rest, sensor.side())?;
    let own: Vec<Parameter> = kind.parameters().collect();
    if let Some((foreign, _)) = values
        .iter()
        .find(|(parameter, _)| !own.contains(parameter))
    {
        return Err(format!(
            "{}: not a value of the {}",
            foreign.row().key,
            kind.name()
        ));
    }
    let figure = values.into_iter().try_fold(
        Figure::default_of(kind, sensor.side()),
        |figure, (parameter, value)| figure.with(parameter, value, sensor.side()),
    );
    let figure = figure.map_err(|error| error.to_string())?;
    Ok(Message::Become(Box::new(Document::touched(
        sensor,
        Source::Figure(figure),
    ))))
}

fn sensor(words: &[&str], app: &App) -> Result<Message, String> {
    let document = app.shown();
    let values = pairs(words, crate::sensor::MAX_SIDE)?;
    let sensor = values
        .into_iter()
        .try_fold(document.sensor, |sensor, (parameter, value)| {
            sensor.with(parameter, value)
        });
    Ok(Message::Become(Box::new(
        document.on(sensor.map_err(|error| error.to_string())?),
    )))
}

fn save(name: &str, app: &App) -> Result<Message, String> {
    let name = Name::new(name).map_err(|error| error.to_string())?;
    if app.seen().imprint.is_empty() {
        return Err("nothing to save: the matrix is empty".to_owned());
    }
    Ok(app.storing(name))
}

impl App {
    /// What stores the document under a name. Over the file that it came from it asks, as over any other.
    pub(super) fn storing(&self, name: Name) -> Message {
        let own = self
            .stored()
            .filter(|stored| stored.owner == Origin::Own && name.same(&stored.name));
        let stamp = own.map(|stored| stored.stamp);
        let shape = Box::new(self.history.present().to_shape(name));
        match stamp {
            Some(stamp) => Message::Replace(shape, stamp),
            None => Message::Store(shape, Expected::Nothing),
        }
    }
}
