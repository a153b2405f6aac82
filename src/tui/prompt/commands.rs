//! The `:` commands: their arguments, what they mean, and their completion.
//!
//! ```text
//! figure hexagon --side 3 --angle 17     a kind, then flags as on the command line
//! sensor --columns 32 --rows 32          only what changes
//! explore --x0 5:5.99:0.01 --anchor centre
//! open ~/mask.csv      open part.svg --pitch 2.5      write drawing.svg
//! watch run 2.csv --rows 4 --columns 5   a name, then flags
//! load my shape                          names may contain spaces, and are never quoted
//! cursor 3 4      move 0.5 -1      turn 15
//! ```
//! Names, flags and ranges are those of the program's own command line, and so are the errors. Parameters of a figure
//! that are not given have their defaults; those of the sensor keep their values.

use clap::{CommandFactory, FromArgMatches, Parser};
use taxel_core::figure::FigureKind;
use taxel_core::frame::{FrameSize, MAX_FRAME_SIDE, Rule};
use taxel_core::pose::{Anchor, GivenRanges, PoseGrid, default_ranges};
use taxel_core::source::Source;
use taxel_files::formats::Name;
use taxel_files::storage::ModelChoice;

use crate::cli::arguments::flags::{one_of, parse_number};
use crate::cli::arguments::parameters::{FigureFlags, PitchFlag, RangeFlags, SensorFlags};
use crate::cli::commands::recognise;
use crate::cli::input::outlines::OutlineFlags;
use crate::naming::Terms;
use crate::tui::app::document::Document;
use crate::tui::app::message::{Message, Purpose};
use crate::tui::app::page::Page;
use crate::tui::app::state::App;
use crate::tui::explore::ExploreMessage;
use crate::tui::explore::work::explored;
use crate::tui::files::FileToOpen;
use crate::tui::keys::keymap::Context;
use crate::tui::live::state::Live;
use crate::tui::live::{LiveMessage, NamedSource};
use crate::tui::recognise::RecogniseMessage;

#[derive(Debug, Parser)]
#[command(
    no_binary_name = true,
    disable_help_flag = true,
    disable_help_subcommand = true
)]
#[expect(clippy::large_enum_variant, reason = "there is one at a time")]
enum Colon {
    /// the threshold, in the sensor's unit
    AtLeast {
        #[arg(value_parser = parse_number, allow_hyphen_values = true)]
        value: f64,
    },
    /// compare with a stored shape, or with the step before
    Compare { name: Vec<String> },
    /// put the cursor on a taxel
    Cursor { column: u8, row: u8 },
    /// move a stored shape to the trash
    Delete { name: Vec<String> },
    /// all imprints in these ranges
    Explore {
        #[command(flatten)]
        ranges: RangeFlags,
        #[arg(long, value_parser = one_of::<Anchor, _>(Anchor::ALL.iter().map(|own| own.name())))]
        anchor: Option<Anchor>,
    },
    /// place one of the seven figures
    Figure {
        #[arg(value_parser = one_of::<FigureKind, _>(FigureKind::names()))]
        kind: Option<FigureKind>,
        #[command(flatten)]
        flags: FigureFlags,
    },
    /// the keys that work here
    Help,
    /// bring a stored shape onto the matrix
    Load { name: Vec<String> },
    /// move the shape right and down, in cells
    Move {
        #[arg(value_parser = parse_number, allow_hyphen_values = true)]
        dx: f64,
        #[arg(value_parser = parse_number, allow_hyphen_values = true)]
        dy: f64,
    },
    /// empty the matrix, to draw by hand
    New,
    /// how often taxels flip; 0: trained poses only; auto: usual
    Noise {
        #[arg(value_name = "E", value_parser = noise)]
        noise: Option<GivenNoise>,
    },
    /// open a shape, an imprint or an outline from a file
    Open {
        #[arg(required = true)]
        file: Vec<String>,
        #[command(flatten)]
        pitch: PitchFlag,
        #[command(flatten)]
        outlines: OutlineFlags,
    },
    /// place a stored shape
    Picture { name: Vec<String> },
    /// leave; asks first if work would be lost
    #[command(alias = "q")]
    Quit,
    /// quit without asking about unsaved work
    #[command(name = "quit!", alias = "q!")]
    QuitNow,
    /// a random touch of a shape of the model
    RandomTouch,
    /// which shape of this model left the imprint
    Recognise { model: Vec<String> },
    /// bring back this deleted shape, or the one deleted last
    Restore { name: Vec<String> },
    /// store what is on the matrix
    Save { name: Vec<String> },
    /// set the seed of random touches
    Seed { number: u64 },
    /// change the sensor
    Sensor {
        #[command(flatten)]
        flags: SensorFlags,
    },
    /// the sensor's columns and rows
    Size {
        #[arg(value_name = "COLUMNSxROWS", value_parser = sides)]
        size: FrameSize,
    },
    /// the most taxels that may differ from a shape; auto if left out
    Tolerance { taxels: Option<u32> },
    /// turn the shape right; negative degrees: left
    Turn {
        #[arg(value_parser = parse_number, allow_hyphen_values = true)]
        degrees: f64,
    },
    /// watch frames, live or recorded
    Watch {
        #[command(flatten)]
        source: NamedSource,
    },
    /// write an imprint, shape or drawing, by file extension
    #[command(alias = "w")]
    Write {
        #[arg(required = true)]
        file: Vec<String>,
    },
}

/// The commands that mean something while a sensor is watched, and those that mean nothing elsewhere.
const ON_LIVE: [&str; 7] = [
    "at-least",
    "noise",
    "size",
    "tolerance",
    "watch",
    "quit",
    "quit!",
];
const ONLY_ON_LIVE: [&str; 2] = ["at-least", "size"];

/// None leaves it to the model.
type GivenNoise = Option<f64>;

fn noise(text: &str) -> Result<GivenNoise, String> {
    let is_given = text != "auto";
    is_given.then(|| recognise::noise(text)).transpose()
}

fn sides(text: &str) -> Result<FrameSize, String> {
    let sides = text.split_once(['x', '×']);
    let size = sides
        .and_then(|(columns, rows)| FrameSize::of_sides(columns.parse().ok(), rows.parse().ok()));
    size.ok_or_else(|| format!("expected columns and rows from 1 to {MAX_FRAME_SIDE}, as in 16x16"))
}

/// The commands of a page. Those of other pages are hidden.
fn command(page: Context) -> clap::Command {
    let mut all = Colon::command().mut_subcommands(|own| {
        let name = own.get_name();
        let is_shown = match page {
            Context::Live => ON_LIVE.contains(&name),
            _ => !ONLY_ON_LIVE.contains(&name),
        };
        own.hide(!is_shown)
    });
    all.build();
    all
}

/// Returns what a line means. An error is the first paragraph of clap's, and its tip.
pub fn read(line: &str, app: &App) -> Result<Message, String> {
    let page = app.pane().map_or(Context::Matrix, Page::context);
    let matches = command(page).try_get_matches_from(line.split_whitespace());
    let matches = matches.map_err(|error| {
        let text = error.render().to_string();
        let lines = text.trim_start_matches("error: ").lines().map(str::trim);
        let said = lines.clone().take_while(|line| !line.is_empty());
        let tip = lines.filter_map(|line| line.strip_prefix("tip: "));
        let said = said.collect::<Vec<_>>().join(" ");
        tip.take(1).fold(said, |said, tip| format!("{said}; {tip}"))
    })?;
    let colon = Colon::from_arg_matches(&matches).map_err(|error| error.to_string())?;
    colon.meaning(app)
}

impl Colon {
    fn meaning(self, app: &App) -> Result<Message, String> {
        let document = app.shown();
        Ok(match self {
            Self::AtLeast { value } => {
                let rule = Rule::at_least(value).map_err(|error| error.to_string())?;
                Message::Live(LiveMessage::AtLeast(rule))
            }
            Self::Compare { name } => shape(Purpose::Compare, &name, Message::Compare)?,
            Self::Cursor { column, row } => {
                let size = document.sensor.size();
                if column >= document.sensor.columns() || row >= document.sensor.rows() {
                    return Err(format!(
                        "column {column}, row {row} is not on the sensor ({size})"
                    ));
                }
                Message::PointAt(column, row)
            }
            Self::Delete { name } => shape(Purpose::Delete, &name, Message::Delete)?,
            Self::Explore { ranges, anchor } => {
                let RangeFlags(ranges) = ranges;
                if anchor.is_none() && ranges == GivenRanges::default() {
                    return Ok(Message::Explore(ExploreMessage::Open));
                }
                let source = explored(app).ok_or_else(|| app.nothing_to_explore())?;
                let (sensor, anchor) = (document.sensor, anchor.unwrap_or_default());
                let grid = default_ranges(&source, &sensor, anchor, &ranges)
                    .and_then(|ranges| PoseGrid::new(source, sensor, anchor, ranges))
                    .map_err(|error| error.to_string())?;
                Message::Explore(ExploreMessage::Start(Box::new(grid)))
            }
            Self::Figure { kind: None, flags } if flags.first().is_none() => Message::Figure,
            Self::Figure { kind, flags } => {
                let kind =
                    kind.ok_or_else(|| format!("which kind: {}?", FigureKind::names().join(", ")))?;
                let figure = flags.figure(kind, &document.sensor);
                let figure = Source::Figure(figure.map_err(|failure| failure.text)?);
                Message::Become(Box::new(Document::touched(document.sensor, figure)))
            }
            Self::Help => Message::Help,
            Self::Load { name } => shape(Purpose::Load, &name, Message::Load)?,
            Self::Move { dx, dy } => Message::Move(dx, dy),
            Self::New => Message::New,
            Self::Noise { noise } => named_on(app, |terms| terms.noise = noise.flatten()),
            Self::Open {
                file,
                pitch,
                outlines,
            } => {
                let sensor = pitch.sensor(document.sensor);
                let sensor = sensor.map_err(|failure| failure.text)?;
                Message::OpenFile(Box::new(FileToOpen {
                    name: file.join(" "),
                    pitch: pitch.first().map(|_| sensor.pitch_mm()),
                    outlines,
                }))
            }
            Self::Picture { name } => shape(Purpose::Picture, &name, Message::Picture)?,
            Self::Quit => Message::Quit,
            Self::QuitNow => Message::QuitNow,
            Self::RandomTouch => Message::Recognise(RecogniseMessage::Touch),
            Self::Recognise { model } => Message::Recognise(if model.is_empty() {
                RecogniseMessage::Open
            } else {
                RecogniseMessage::Choose(ModelChoice::from_text(model.join(" ")))
            }),
            Self::Restore { name } => {
                let name = (!name.is_empty()).then(|| name_of(&name)).transpose()?;
                Message::Restore(name.map(|name| name.to_string()))
            }
            Self::Save { name } if name.is_empty() => Message::Save,
            Self::Save { .. } if app.reading().imprint.is_empty() => {
                return Err("nothing to save: the matrix is empty".to_owned());
            }
            Self::Save { name } => Message::SaveAs(name_of(&name)?),
            Self::Seed { number } => Message::Recognise(RecogniseMessage::Seed(number)),
            Self::Sensor { flags } if flags.first().is_none() => Message::Sensor,
            Self::Sensor { flags } => {
                let sensor = flags
                    .sensor(document.sensor)
                    .map_err(|failure| failure.text)?;
                Message::Become(Box::new(document.on(sensor)))
            }
            Self::Size { size } => Message::Live(LiveMessage::Size(size)),
            Self::Tolerance { taxels } => named_on(app, |terms| terms.tolerance = taxels),
            Self::Turn { degrees } => Message::Turn(degrees),
            Self::Watch { source } if source.name.is_empty() => Message::Live(LiveMessage::Open),
            Self::Watch { source } => Message::Live(LiveMessage::Source(Box::new(source))),
            Self::Write { file } => Message::WriteFile(file.join(" ")),
        })
    }
}

fn shape(purpose: Purpose, words: &[String], otherwise: Message) -> Result<Message, String> {
    if words.is_empty() {
        return Ok(otherwise);
    }
    Ok(Message::Named(purpose, name_of(words)?.to_string()))
}

/// Names touches on other terms, on the page that is open.
fn named_on(app: &App, change: impl FnOnce(&mut Terms)) -> Message {
    let live = app.page::<Live>();
    let mut terms = live.map_or(app.recognition.terms, |page| page.names.terms);
    change(&mut terms);
    match live {
        Some(_) => Message::Live(LiveMessage::Terms(terms)),
        None => Message::Recognise(RecogniseMessage::Terms(terms)),
    }
}

fn name_of(words: &[String]) -> Result<Name, String> {
    Name::new(&words.join(" ")).map_err(|error| error.to_string())
}

/// What the names are of that complete a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Names {
    /// All shapes, or only those of the user's own.
    Shapes {
        own: bool,
    },
    Deleted,
    Models,
    Paths,
}

/// Returns the command that a line begins with, and the rest; None until a space follows its name.
pub(super) fn begun(line: &str) -> Option<(&str, &str)> {
    let (name, rest) = line.trim_start().split_once(' ')?;
    Some((name, rest.trim_start()))
}

pub fn wants_names(line: &str) -> Option<Names> {
    let (name, rest) = begun(line)?;
    match name {
        "load" | "picture" | "compare" => Some(Names::Shapes { own: false }),
        "delete" | "save" => Some(Names::Shapes { own: true }),
        "restore" => Some(Names::Deleted),
        "recognise" => Some(Names::Models),
        "write" | "w" => Some(Names::Paths),
        // The name ends where the flags begin.
        "open" | "watch" if !rest.contains("--") => Some(Names::Paths),
        _ => None,
    }
}

/// Completes the last word of a line, or the name at its end, as far as all candidates agree. Returns the line and
/// the candidates. `names` are the names that [`wants_names`] asks for.
pub fn complete(line: &str, names: &[String], page: Context) -> (String, Vec<String>) {
    let is_name = wants_names(line).is_some();
    let (typed, candidates) = match begun(line) {
        None => {
            let names = listed(page).into_iter().map(|own| own.line);
            (line.trim_start(), names.collect())
        }
        Some((_, rest)) if is_name => (rest, names.to_vec()),
        Some((name, rest)) => {
            let (before, last) = rest.rsplit_once(' ').unwrap_or(("", rest));
            (last, next_words(name, before, page))
        }
    };
    let fits = |candidate: &String| {
        let start = candidate.get(..typed.len());
        start.is_some_and(|start| {
            start == typed || is_name && start.to_lowercase() == typed.to_lowercase()
        })
    };
    let fitting: Vec<String> = candidates.into_iter().filter(fits).collect();
    let completed = match &fitting[..] {
        [] => typed.to_owned(),
        // A name is the last thing in its line.
        [only] if is_name => only.clone(),
        [only] => format!("{only} "),
        [first, others @ ..] => {
            let same = |other: &String| {
                let both = first.chars().zip(other.chars());
                both.take_while(|(own, other)| own == other).count()
            };
            let common = others.iter().map(same).min().unwrap_or(0);
            let common = common.max(typed.chars().count());
            first.chars().take(common).collect()
        }
    };
    let before = &line[..line.len() - typed.len()];
    (format!("{before}{completed}"), fitting)
}

/// The values of the first argument, or the flags that are not given yet.
fn next_words(name: &str, before: &str, page: Context) -> Vec<String> {
    let all = command(page);
    let said: Vec<&str> = before.split_whitespace().collect();
    let Some(command) = all.find_subcommand(name) else {
        return Vec::new();
    };
    if let Some(first) = command.get_positionals().next().filter(|_| said.is_empty()) {
        let values = first.get_possible_values();
        if !values.is_empty() {
            return values.iter().map(|own| own.get_name().to_owned()).collect();
        }
    }
    let awaits_value = |word: &&str| word.starts_with("--") && !word.contains('=');
    if said.last().is_some_and(awaits_value) {
        return Vec::new();
    }
    let kind: Option<FigureKind> = said.first().and_then(|kind| kind.parse().ok());
    let is_offered = |flag: &&str| {
        let mut own = kind.into_iter().flat_map(FigureKind::parameters);
        let given = |word: &&str| {
            word.split('=')
                .next()
                .and_then(|own| own.strip_prefix("--"))
                == Some(flag)
        };
        (kind.is_none() || own.any(|parameter| parameter.flag() == *flag))
            && !said.iter().any(given)
    };
    let flags = command.get_opts().filter_map(clap::Arg::get_long);
    flags
        .filter(is_offered)
        .map(|flag| format!("--{flag}"))
        .collect()
}

/// A line that the prompt offers, with what may follow and what it does; without help, it is an earlier line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Offer {
    pub line: String,
    pub follows: String,
    pub help: Option<String>,
}

/// The commands of a page, by name.
pub fn listed(page: Context) -> Vec<Offer> {
    let all = command(page);
    let own = all.get_subcommands().filter(|own| !own.is_hide_set());
    let offers = own.map(|own| {
        let names = own.get_positionals().filter_map(clap::Arg::get_value_names);
        let flag = own.get_opts().find_map(clap::Arg::get_long);
        let flag = flag.map(|flag| format!("--{flag} ..."));
        let words = names.flatten().map(ToString::to_string).chain(flag);
        Offer {
            line: own.get_name().to_owned(),
            follows: words.collect::<Vec<_>>().join(" "),
            help: own.get_about().map(ToString::to_string),
        }
    });
    let mut offers: Vec<Offer> = offers.collect();
    offers.sort_by(|one, other| one.line.cmp(&other.line));
    offers
}

/// The last five lines that begin as the typed one, then the commands.
pub fn offers(typed: &str, given: &[String], page: Context) -> Vec<Offer> {
    let typed = typed.trim_start();
    let mut offers: Vec<Offer> = Vec::new();
    for line in given.iter().rev() {
        let is_new = line != typed && offers.iter().all(|offer| offer.line != *line);
        if line.starts_with(typed) && is_new && offers.len() < 5 {
            offers.push(Offer {
                line: line.clone(),
                follows: String::new(),
                help: None,
            });
        }
    }
    let begun = begun(typed);
    let name = begun.map_or(typed, |(name, _)| name);
    let mut named = listed(page);
    named.retain(|own| own.line == name || begun.is_none() && own.line.contains(name));
    named.sort_by_key(|own| !own.line.starts_with(name));
    offers.extend(named);
    offers
}
