//! Rows of the table of keys: where, which keys, what they mean, how they are shown.

use std::borrow::Cow;

use crate::tui::app::message::Message;
use crate::tui::keys::key::{Arrow, Key};

/// Where a key is pressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Context {
    /// Anywhere, unless the key means something else there.
    Everywhere,
    /// On the matrix.
    Matrix,
    /// On the matrix, the shape being held.
    Grab,
    /// In a form.
    Form,
    /// In the list of shapes.
    List,
    /// In the field for a name.
    Name,
    /// In the command line at the foot.
    Command,
    /// In the list of keys.
    Help,
    /// At a question.
    Question,
    /// In the form of ranges.
    Ranges,
    /// While something is under way.
    Running,
    /// On any page of what a sweep found.
    Explore,
    /// In the list of imprints.
    Imprints,
    /// In the statistics.
    Statistics,
    /// At the histogram.
    Histogram,
    /// On the map.
    Map,
    /// In the field for the name of a file.
    Export,
}

impl Context {
    /// All of them, in the order of help.
    pub const ALL: [Self; 17] = [
        Self::Matrix,
        Self::Grab,
        Self::Form,
        Self::List,
        Self::Name,
        Self::Command,
        Self::Ranges,
        Self::Running,
        Self::Explore,
        Self::Imprints,
        Self::Statistics,
        Self::Histogram,
        Self::Map,
        Self::Export,
        Self::Question,
        Self::Help,
        Self::Everywhere,
    ];

    /// Its heading in help.
    pub fn title(self) -> &'static str {
        match self {
            Self::Everywhere => "Everywhere",
            Self::Matrix => "On the matrix",
            Self::Grab => "While a shape is held",
            Self::Form => "In a form",
            Self::List => "In the list of shapes",
            Self::Name => "Saving",
            Self::Command => "In the command line",
            Self::Help => "In this list",
            Self::Question => "At a question",
            Self::Ranges => "Ranges of a sweep",
            Self::Running => "While work is under way",
            Self::Explore => "Exploring, on every page",
            Self::Imprints => "In the list of imprints",
            Self::Statistics => "In the statistics",
            Self::Histogram => "At the histogram",
            Self::Map => "On the map",
            Self::Export => "Exporting",
        }
    }

    /// Its name where a user changes keys.
    pub fn name(self) -> &'static str {
        match self {
            Self::Everywhere => "everywhere",
            Self::Matrix => "matrix",
            Self::Grab => "grab",
            Self::Form => "form",
            Self::List => "list",
            Self::Name => "name",
            Self::Command => "command",
            Self::Help => "help",
            Self::Question => "question",
            Self::Ranges => "ranges",
            Self::Running => "running",
            Self::Explore => "explore",
            Self::Imprints => "imprints",
            Self::Statistics => "statistics",
            Self::Histogram => "histogram",
            Self::Map => "map",
            Self::Export => "export",
        }
    }

    /// Where a key is looked up next that means nothing here.
    pub(in crate::tui) fn outer(self) -> Option<Self> {
        match self {
            Self::Everywhere => None,
            Self::Grab => Some(Self::Matrix),
            _ => self.screen().or(Some(Self::Everywhere)),
        }
    }

    /// The screen that this is a page of, where it is one: the keys of both are hinted at.
    pub fn screen(self) -> Option<Self> {
        match self {
            Self::Imprints | Self::Statistics | Self::Histogram | Self::Map => Some(Self::Explore),
            _ => None,
        }
    }

    /// Whether characters that are no command are typed into a field.
    pub(in crate::tui) fn takes_text(self) -> bool {
        matches!(
            self,
            Self::Form | Self::List | Self::Name | Self::Command | Self::Ranges | Self::Export
        )
    }
}

/// A row of the table.
#[derive(Clone, Debug)]
pub struct Binding {
    /// Where.
    pub context: Context,
    /// Any of these keys, each with the message it gives.
    pub keys: Cow<'static, [(Key, Message)]>,
    /// A word or two for the line of hints; empty where it does not stand there.
    pub hint: &'static str,
    /// What it does, for help.
    pub help: &'static str,
}

impl Binding {
    /// Whether one of its keys means this.
    pub fn does(&self, message: &Message) -> bool {
        self.keys.iter().any(|(_, meaning)| meaning == message)
    }

    /// The row without some keys.
    pub(in crate::tui) fn without(&self, others: &[Key]) -> Self {
        let keys = self.keys.iter().filter(|(key, _)| !others.contains(key));
        Self {
            keys: keys.cloned().collect(),
            ..self.clone()
        }
    }

    /// Its keys as people write them: "Home End"; the four arrows as one word.
    pub fn labels(&self) -> String {
        let mut labels = Vec::new();
        for (key, _) in self.keys.iter() {
            let label = self.all_arrows(*key).map_or(key.label(), str::to_owned);
            if !labels.contains(&label) {
                labels.push(label);
            }
        }
        labels.join(" ")
    }

    /// What the four arrows are called together, where the key is one of them and all are there.
    fn all_arrows(&self, key: Key) -> Option<&'static str> {
        let (shown, label): (fn(Arrow) -> Key, _) = match key {
            Key::Arrow(_) => (Key::Arrow, "arrows"),
            Key::ShiftArrow(_) => (Key::ShiftArrow, "Shift-arrows"),
            _ => return None,
        };
        let all = [Arrow::Left, Arrow::Right, Arrow::Up, Arrow::Down];
        let bound = |arrow: &Arrow| self.keys.iter().any(|(key, _)| *key == shown(*arrow));
        all.iter().all(bound).then_some(label)
    }

    /// The same in short, for hints: one key, or a pair of opposite ones where these are short.
    pub fn short_labels(&self) -> String {
        let arrows = self.keys.iter().find_map(|(key, _)| self.all_arrows(*key));
        let (Some((first, message)), None) = (self.keys.first(), arrows) else {
            return arrows.unwrap_or_default().to_owned();
        };
        let opposite = self
            .keys
            .iter()
            .find(|(_, other)| other != message)
            .map(|(key, _)| key.label());
        let first = first.label();
        match opposite {
            Some(second) if first.len() + second.len() <= 9 => format!("{first} {second}"),
            _ => first,
        }
    }
}

/// A row.
pub(in crate::tui) const fn bind(
    context: Context,
    keys: &'static [(Key, Message)],
    hint: &'static str,
    help: &'static str,
) -> Binding {
    Binding {
        context,
        keys: Cow::Borrowed(keys),
        hint,
        help,
    }
}
