//! Places where keys are pressed, and rows of the table of keys.

use std::borrow::Cow;

use crate::tui::app::message::Message;
use crate::tui::keys::action::Action;
use crate::tui::keys::key::{Arrow, Key};

/// The effect of a key that has no binding in a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unbound {
    /// The key does nothing.
    Ignored,
    /// If the key is a character, it is typed into the field.
    Typed,
}

use Unbound::{Ignored, Typed};

/// Builds the table of places from rows `Place "name in a settings file" "heading in help" unbound keys, outer
/// place`. A key that has no binding in a place is looked up in the outer one.
macro_rules! contexts {
    ($($(#[$doc:meta])+ $place:ident $name:literal $title:literal $unbound:expr, $outer:expr;)+) => {
        /// The place where a key is pressed; it decides what the key does.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Context {
            $($(#[$doc])+ $place,)+
        }

        impl Context {
            /// All places, in the order of help.
            pub const ALL: [Self; [$(Self::$place),+].len()] = [$(Self::$place),+];

            /// Returns the heading of the place in help.
            pub fn title(self) -> &'static str {
                match self {
                    $(Self::$place => $title,)+
                }
            }

            /// Returns the name of the place in a settings file.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$place => $name,)+
                }
            }

            /// Returns the effect of a key that has no binding here.
            fn unbound(self) -> Unbound {
                match self {
                    $(Self::$place => $unbound,)+
                }
            }

            /// Returns the place in which to look up a key that has no binding here.
            pub(in crate::tui) fn outer(self) -> Option<Self> {
                match self {
                    $(Self::$place => $outer,)+
                }
            }
        }
    };
}

/// The outer place of most places.
const EVERYWHERE: Option<Context> = Some(Context::Everywhere);
/// The outer place of most places with a field.
const LINE: Option<Context> = Some(Context::Line);
/// The outer place of the tabs of Explore.
const EXPLORE: Option<Context> = Some(Context::Explore);

contexts! {
    /// On the matrix.
    Matrix "matrix" "On the matrix" Ignored, EVERYWHERE;
    /// On the matrix, while a shape is held.
    Hold "hold" "While a shape is held" Ignored, Some(Self::Matrix);
    /// In a form.
    Form "form" "In a form" Typed, LINE;
    /// In the list of shapes.
    List "list" "In the list of shapes" Typed, EVERYWHERE;
    /// In the list of steps, the history.
    History "history" "In the history" Ignored, EVERYWHERE;
    /// On the page that compares two imprints.
    Compare "compare" "Comparing" Ignored, EVERYWHERE;
    /// In the field for a name.
    Name "name" "Saving" Typed, LINE;
    /// In the `:` prompt.
    Command "command" "In the command line" Typed, LINE;
    /// In the form of ranges.
    Ranges "ranges" "Ranges of a sweep" Typed, LINE;
    /// While a worker runs.
    Running "running" "While work is under way" Ignored, EVERYWHERE;
    /// On every tab of Explore.
    Explore "explore" "Exploring, on every page" Ignored, EVERYWHERE;
    /// On the imprints tab of Explore.
    Imprints "imprints" "In the list of imprints" Ignored, EXPLORE;
    /// On the statistics tab of Explore.
    Statistics "statistics" "In the statistics" Ignored, EXPLORE;
    /// On the histogram tab of Explore.
    Histogram "histogram" "At the histogram" Ignored, EXPLORE;
    /// On the map tab of Explore.
    Map "map" "On the map" Ignored, EXPLORE;
    /// On the scatter tab of Explore.
    Scatter "scatter" "At the scatter plot" Ignored, EXPLORE;
    /// On the angles tab of Explore.
    Angles "angles" "At the plot of angles" Ignored, EXPLORE;
    /// In the field for a filter of the list of imprints.
    Filter "filter" "Filtering the list of imprints" Typed, LINE;
    /// In the field for the name of an exported file.
    Export "export" "Exporting" Typed, LINE;
    /// On the matrix, with recognition beside it.
    Recognise "recognise" "Recognising" Ignored, Some(Self::Matrix);
    /// On the confusion matrix.
    Confusion "confusion" "At the confusion matrix" Ignored, EVERYWHERE;
    /// On the page that watches the frames of a sensor.
    Live "live" "Watching a sensor" Ignored, EVERYWHERE;
    /// At a yes-or-no question.
    Question "question" "At a question" Ignored, EVERYWHERE;
    /// In the list of keys.
    Help "help" "In the help" Ignored, EVERYWHERE;
    /// In the field for the text to search for in the list of keys, or in that of steps.
    Search "search" "Searching" Typed, LINE;
    /// In any text field, unless its page gives the key another meaning.
    Line "line" "In a line of text" Typed, EVERYWHERE;
    /// Everywhere, unless the place gives the key another meaning.
    Everywhere "everywhere" "Everywhere" Ignored, None;
}

impl Context {
    /// Returns the screen that this place is a part of; hints show the keys of both.
    pub fn screen(self) -> Option<Self> {
        let screens = [Self::Explore, Self::Matrix];
        let own = self.outer().filter(|outer| screens.contains(outer));
        own.filter(|_| self != Self::Hold)
    }

    /// Returns the places of the other tabs of Explore; none elsewhere.
    pub(in crate::tui) fn other_tabs(self) -> impl Iterator<Item = Self> {
        let is_tab = |place: Self| place.outer() == EXPLORE;
        let others = Self::ALL.into_iter();
        others.filter(move |other| is_tab(self) && is_tab(*other) && *other != self)
    }

    /// Returns true if a key that has no binding here may be looked up in `place`, directly or through other places.
    pub(in crate::tui) fn leads_to(self, place: Self) -> bool {
        std::iter::successors(Some(self), |context| context.outer()).any(|own| own == place)
    }

    /// Returns true if a character that has no binding is typed into a field.
    pub(in crate::tui) fn takes_text(self) -> bool {
        self.unbound() == Typed
    }
}

/// A row of the table of keys: some keys of a place that are shown together in hints and help.
#[derive(Clone, Debug)]
pub struct Binding {
    /// The place.
    pub context: Context,
    /// The keys, each with its action. Empty after a settings file has taken them all away.
    pub keys: Cow<'static, [(Key, &'static Action)]>,
    /// A word or two for the line of hints; empty if there is no hint.
    pub hint: &'static str,
    /// The effect of the keys, for help.
    pub help: &'static str,
}

impl Binding {
    /// Creates a row of the default keys.
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

    /// Returns true if one of the keys sends this message.
    pub fn does(&self, message: &Message) -> bool {
        self.keys.iter().any(|(_, action)| action.sends(message))
    }

    /// Returns the row without some keys.
    pub(in crate::tui) fn without(&self, others: &[Key]) -> Self {
        let keys = self.keys.iter().filter(|(key, _)| !others.contains(key));
        Self {
            keys: keys.copied().collect(),
            ..self.clone()
        }
    }

    /// Returns the names of the keys, such as "Home End"; the four arrows are one word.
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

    /// Returns "arrows" or "Shift-arrows" if the key is one of four arrows that are all in this row.
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

    /// Returns the names of the keys for hints: the first one, or, if both are short, the first two that do different
    /// things.
    pub fn short_labels(&self) -> String {
        let parts = self.short_parts().into_iter();
        parts.map(|(label, _)| label).collect()
    }

    /// Returns the parts of [`Self::short_labels`], each with the action of a click on it; the four arrows together
    /// have no action.
    pub fn short_parts(&self) -> Vec<(String, Option<&'static Action>)> {
        if let Some(arrows) = self.keys.iter().find_map(|(key, _)| self.all_arrows(*key)) {
            return vec![(arrows.to_owned(), None)];
        }
        let Some(&(first, action)) = self.keys.first() else {
            return Vec::new();
        };
        let opposite = self.keys.iter().find(|(_, other)| *other != action);
        let opposite = opposite.map(|&(key, other)| (key.label(), other));
        let first = first.label();
        match opposite {
            Some((second, other)) if first.len() + second.len() <= 9 => {
                vec![(first, Some(action)), (format!(" {second}"), Some(other))]
            }
            // Two long names that begin alike.
            Some((second, other)) if second == "PageDown" && first == "PageUp" => {
                vec![(first, Some(action)), ("/Down".to_owned(), Some(other))]
            }
            _ => vec![(first, Some(action))],
        }
    }
}
