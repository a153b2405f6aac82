//! The `:` commands, made from the table of actions: their names, the words and arguments that may follow, and their
//! completion.
//!
//! A command is the first word of a spelling of an action ("cursor" of "cursor left"), or the name of an action that
//! has no other spelling. The full name of an action works as well.

use std::sync::LazyLock;

use taxel_core::figure::FigureKind;
use taxel_core::parameter::Parameter;
use taxel_core::pose::Axis;
use taxel_core::sensor::SENSOR_PARAMETERS;

use crate::tui::app::message::Message;
use crate::tui::keys::action::{ACTIONS, Action, Arguments};
use crate::tui::keys::default_keys::DEFAULT_KEYS;
use crate::tui::keys::keymap::Context;
use crate::tui::live::message::{NamedSource, flags_start};
use crate::tui::prompt::read::{is_given, lacks_value};

pub(super) const ANCHOR: &str = "--anchor";

#[derive(Clone, Debug)]
pub struct PromptCommand {
    pub name: &'static str,
    pub words: Vec<(&'static str, &'static Action)>,
    /// The arguments that may follow instead.
    pub arguments: Option<Arguments>,
    pub help: &'static str,
}

const MOST_RECENT: usize = 5;

const SHORT: [(&str, &str); 3] = [("q", "quit"), ("q!", "quit!"), ("w", "write")];

pub fn actions() -> impl Iterator<Item = &'static Action> {
    static LISTED: LazyLock<Vec<&Action>> = LazyLock::new(|| of_the_matrix().collect());
    LISTED.iter().copied()
}

fn of_the_matrix() -> impl Iterator<Item = &'static Action> {
    let places = [Context::Matrix, Context::Hold, Context::Everywhere];
    let bound = |action: &Action, places: &[Context]| {
        let mut rows = DEFAULT_KEYS
            .iter()
            .filter(|row| places.contains(&row.context));
        rows.any(|row| row.keys.iter().any(|(_, own)| *own == action))
    };
    // The page of recognition uses the prompt of the matrix.
    let recognises = |action: &Action| matches!(action.message(), Some(Message::Recognise(_)));
    ACTIONS.iter().copied().filter(move |action| {
        let works = recognises(action) || bound(action, &places) || !bound(action, &Context::ALL);
        // To type a command is no command.
        works && action.message() != Some(&Message::Command)
    })
}

pub fn commands() -> &'static [PromptCommand] {
    // The list is kept, because each key in the prompt needs it.
    static LISTED: LazyLock<Vec<PromptCommand>> = LazyLock::new(listed);
    &LISTED
}

fn listed() -> Vec<PromptCommand> {
    let mut names: Vec<&str> = actions()
        .flat_map(spellings)
        .map(|line| split(line).0)
        .collect();
    names.sort_unstable();
    names.dedup();
    names.into_iter().map(command).collect()
}

fn spellings(action: &'static Action) -> impl Iterator<Item = &'static str> {
    let name = action.spellings.is_empty().then_some(action.name);
    name.into_iter().chain(action.spellings.iter().copied())
}

fn split(line: &str) -> (&str, &str) {
    line.split_once(' ')
        .map_or((line, ""), |(name, rest)| (name, rest.trim_start()))
}

fn command(name: &'static str) -> PromptCommand {
    let own = |action: &'static Action| {
        spellings(action)
            .chain([action.name])
            .map(split)
            .filter(move |(first, _)| *first == name)
            .map(move |(_, word)| (word, action))
    };
    let mut words: Vec<(&str, &Action)> = Vec::new();
    for (word, action) in actions()
        .filter(|own| own.arguments().is_none())
        .flat_map(own)
    {
        if !words.contains(&(word, action)) {
            words.push((word, action));
        }
    }
    let with = actions().find(|action| action.name == name && action.arguments().is_some());
    let all = with.into_iter().chain(words.iter().map(|(_, word)| *word));
    let mut helps = all.map(help).filter(|help| !help.is_empty());
    PromptCommand {
        name,
        arguments: with.and_then(Action::arguments),
        help: helps.next().unwrap_or(""),
        words,
    }
}

/// Returns the help of an action, otherwise the help of its key's row.
fn help(action: &Action) -> &'static str {
    if !action.help.is_empty() {
        return action.help;
    }
    let mut rows = DEFAULT_KEYS.iter();
    let row = rows.find(|row| row.keys.iter().any(|(_, own)| *own == action));
    row.map_or("", |row| row.help)
}

pub fn find(name: &str) -> Option<PromptCommand> {
    let short = SHORT.iter().find(|(short, _)| *short == name);
    let name = short.map_or(name, |(_, name)| *name);
    let listed = commands().iter().find(|command| command.name == name);
    listed.cloned().or_else(|| {
        actions()
            .find(|action| action.name == name)
            .map(|action| command(action.name))
    })
}

/// Returns the command that a line begins with, and the rest; None until a space follows its name.
fn begun(line: &str) -> Option<(PromptCommand, &str)> {
    let (name, rest) = line.trim_start().split_once(' ')?;
    Some((find(name)?, rest.trim_start()))
}

pub fn wants_names(line: &str) -> Option<Arguments> {
    let (command, rest) = begun(line)?;
    let arguments = command.arguments.filter(|arguments| arguments.is_name())?;
    // The name of a source ends where its flags begin.
    let has_flags = arguments == Arguments::FrameSource && flags_start(rest).is_some();
    (!has_flags).then_some(arguments)
}

/// Completes the last word of a line, or the name at its end, as far as all candidates agree. Returns the line and
/// the candidates. `names` are the names that [`wants_names`] asks for.
pub fn complete(line: &str, names: &[String]) -> (String, Vec<String>) {
    let is_name = wants_names(line).is_some();
    let (typed, candidates) = match begun(line) {
        None if line.trim_start().contains(' ') => return (line.to_owned(), Vec::new()),
        None => (
            line.trim_start(),
            commands()
                .iter()
                .map(|command| command.name.to_owned())
                .collect(),
        ),
        Some((_, rest)) if is_name => (rest, names.to_vec()),
        Some((command, rest)) => {
            let (before, last) = rest.rsplit_once(' ').unwrap_or(("", rest));
            (last, next_words(&command, before))
        }
    };
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

fn next_words(command: &PromptCommand, before: &str) -> Vec<String> {
    let said: Vec<&str> = before.split_whitespace().collect();
    let words = |flags: Vec<String>, said: &[&str]| {
        if lacks_value(said) {
            return Vec::new();
        }
        let unsaid = flags.into_iter();
        unsaid.filter(|flag| !is_given(flag, said)).collect()
    };
    let flags = |parameters: Vec<Parameter>, said: &[&str]| {
        let flags = parameters.iter();
        let flags = flags.map(|parameter| format!("--{}", parameter.flag()));
        words(flags.collect(), said)
    };
    match (command.arguments, &said[..]) {
        (Some(Arguments::Figure), []) => {
            FigureKind::names().into_iter().map(str::to_owned).collect()
        }
        (Some(Arguments::Figure), [kind, said @ ..]) => {
            let kind = kind.parse::<FigureKind>().into_iter();
            flags(
                kind.flat_map(FigureKind::parameters).copied().collect(),
                said,
            )
        }
        (Some(Arguments::Sensor), said) => flags(SENSOR_PARAMETERS.to_vec(), said),
        (Some(Arguments::Ranges), said) => {
            let ranges = Axis::ALL.map(|axis| format!("--{}", axis.parameter().flag()));
            words([&ranges[..], &[ANCHOR.to_owned()]].concat(), said)
        }
        (Some(Arguments::FrameSource), said) => {
            let is_flag = |word: &&str| word.starts_with("--");
            let flags = said.iter().position(is_flag).unwrap_or(said.len());
            words(
                NamedSource::flags().map(str::to_owned).to_vec(),
                &said[flags..],
            )
        }
        (_, []) => {
            let words = command.words.iter().filter(|(word, _)| !word.is_empty());
            words.map(|(word, _)| (*word).to_owned()).collect()
        }
        _ => Vec::new(),
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Offer {
    pub line: String,
    pub help: Option<String>,
}

pub fn offers(typed: &str, given: &[String]) -> Vec<Offer> {
    let typed = typed.trim_start();
    let mut recent: Vec<&String> = Vec::new();
    for line in given.iter().rev() {
        if line.starts_with(typed) && line != typed && !recent.contains(&line) {
            recent.push(line);
        }
    }
    let recent = recent.into_iter().take(MOST_RECENT).map(|line| Offer {
        line: line.clone(),
        help: None,
    });
    let name = typed.split(' ').next().unwrap_or(typed);
    let more = name.len() < typed.len();
    let named = commands().iter();
    let fits =
        |command: &&PromptCommand| command.name == name || !more && command.name.contains(name);
    let mut named: Vec<&PromptCommand> = named.filter(fits).collect();
    named.sort_by_key(|command| !command.name.starts_with(name));
    let named = named.into_iter().map(|command| Offer {
        line: command.name.to_owned(),
        help: Some(match command.arguments {
            Some(arguments) => format!("{}  {}", arguments.form(), command.help),
            None => command.help.to_owned(),
        }),
    });
    recent.chain(named).collect()
}

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
    use crate::tui::app::message::Purpose;

    fn completed(line: &str) -> (String, Vec<String>) {
        let names = ["washer", "Wasp", "my shape"].map(str::to_owned);
        complete(line, &names)
    }

    #[test]
    fn each_command_has_a_help_of_its_own() {
        let mut helps: Vec<&str> = commands().iter().map(|command| command.help).collect();
        assert!(helps.iter().all(|help| !help.is_empty()));
        helps.sort_unstable();
        let twice = helps.windows(2).find(|pair| pair[0] == pair[1]);
        assert_eq!(twice, None);
        // A line of the list fits on a screen of 80 columns: two blanks, the command, two blanks, the rest.
        let offers = offers("", &[]);
        let widest = offers.iter().map(|offer| offer.line.len()).max();
        let room = 80 - 4 - widest.expect("there are commands");
        for Offer { line, help } in &offers {
            let length = help.as_deref().map_or(0, str::len);
            assert!(length <= room, "{line}: {length} of {room} columns");
        }
    }

    #[test]
    fn lines_are_completed_as_far_as_all_candidates_agree() {
        for (line, expected, candidates) in [
            ("fi", "figure ", 1),
            ("re", "re", 6),
            ("res", "restore ", 1),
            ("co", "co", 4),
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
                "figure hexagon --side=3 --s",
                "figure hexagon --side=3 --s",
                0,
            ),
            (
                "figure hexagon --side=3 --an",
                "figure hexagon --side=3 --angle ",
                1,
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
            ("watch a b.csv --ba", "watch a b.csv --baud ", 1),
            ("watch a --baud 9600 --ba", "watch a --baud 9600 --ba", 0),
            ("nothing x", "nothing x", 0),
        ] {
            let (line_now, found) = completed(line);
            assert_eq!(
                (line_now.as_str(), found.len()),
                (expected, candidates),
                "{line}"
            );
        }
        assert_eq!(completed("").1.len(), commands().len());
        let load = Arguments::Shape(Purpose::Load);
        assert_eq!(wants_names("load "), Some(load));
        assert_eq!(wants_names("load"), None);
        assert_eq!(wants_names("zoom "), None);
    }
}
