//! Places where keys are pressed, and rows of the table of keys.

use std::borrow::Cow;

use crate::tui::app::message::Message;
use crate::tui::keys::action::Action;
use crate::tui::keys::key::{Arrow, Key};

/// The place where a key is pressed; it decides what the key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Context {
    /// Everywhere, unless the key means something else there.
    Everywhere,
    /// On the matrix.
    Matrix,
    /// On the matrix, while a shape is held.
    Grab,
    /// In a form.
    Form,
    /// In the list of shapes.
    List,
    /// In the field for a name.
    Name,
    /// In the `:` prompt.
    Command,
    /// In the list of keys.
    Help,
    /// At a yes-or-no question.
    Question,
    /// In the form of ranges.
    Ranges,
    /// While a worker runs.
    Running,
    /// On every page of Explore.
    Explore,
    /// On the imprints page of Explore.
    Imprints,
    /// On its statistics page.
    Statistics,
    /// On its histogram page.
    Histogram,
    /// On its map page.
    Map,
    /// In the field for the name of an exported file.
    Export,
}

impl Context {
    /// All places, in the order of help.
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

    /// Its name in a settings file.
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

    /// The place where a key that means nothing here is looked up next.
    pub(in crate::tui) fn outer(self) -> Option<Self> {
        match self {
            Self::Everywhere => None,
            Self::Grab => Some(Self::Matrix),
            _ => self.screen().or(Some(Self::Everywhere)),
        }
    }

    /// The screen that this place is a page of; hints show the keys of both.
    pub fn screen(self) -> Option<Self> {
        match self {
            Self::Imprints | Self::Statistics | Self::Histogram | Self::Map => Some(Self::Explore),
            _ => None,
        }
    }

    /// Whether a character that is not bound is typed into a field.
    pub(in crate::tui) fn takes_text(self) -> bool {
        matches!(
            self,
            Self::Form | Self::List | Self::Name | Self::Command | Self::Ranges | Self::Export
        )
    }
}

/// A row of the table of keys: some keys of a place, shown together in hints and help.
#[derive(Clone, Debug)]
pub struct Binding {
    /// The place.
    pub context: Context,
    /// The keys, each with its action. Empty after a settings file has taken all of them away.
    pub keys: Cow<'static, [(Key, &'static Action)]>,
    /// A word or two for the line of hints; empty for no hint.
    pub hint: &'static str,
    /// What the keys do, for help.
    pub help: &'static str,
}

impl Binding {
    /// A row of the default keys.
    pub(in crate::tui) const fn row(
        context: Context,
        keys: &'static [(Key, &'static Action)],
        hint: &'static str,
        help: &'static str,
    ) -> Self {
        Self {
            context,
            keys: Cow::Borrowed(keys),
            hint,
            help,
        }
    }

    /// Whether one of its keys sends this message.
    pub fn does(&self, message: &Message) -> bool {
        self.keys.iter().any(|(_, action)| action.sends(message))
    }

    /// The row without some keys.
    pub(in crate::tui) fn without(&self, others: &[Key]) -> Self {
        let keys = self.keys.iter().filter(|(key, _)| !others.contains(key));
        Self {
            keys: keys.copied().collect(),
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

    /// "arrows" or "Shift-arrows" if the key is one of four that are all in this row.
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

    /// Its keys in short, for hints: the first one, or the first two that do different things if both are short.
    pub fn short_labels(&self) -> String {
        if let Some(arrows) = self.keys.iter().find_map(|(key, _)| self.all_arrows(*key)) {
            return arrows.to_owned();
        }
        let Some((first, action)) = self.keys.first() else {
            return String::new();
        };
        let opposite = self.keys.iter().find(|(_, other)| other != action);
        let opposite = opposite.map(|(key, _)| key.label());
        let first = first.label();
        match opposite {
            Some(second) if first.len() + second.len() <= 9 => format!("{first} {second}"),
            _ => first,
        }
    }
}
