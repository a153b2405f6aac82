//! Places where keys are pressed, and rows of the table of keys.

use std::borrow::Cow;

use crate::tui::app::message::Message;
use crate::tui::keys::action::Action;
use crate::tui::keys::key::{Arrow, Key};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unbound {
    Ignored,
    Typed,
}

use Unbound::{Ignored, Typed};

/// A key that has no binding in a place is looked up in the outer one.
macro_rules! contexts {
    ($($(#[$doc:meta])* $place:ident $name:literal $title:literal $unbound:expr, $outer:expr;)+) => {
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Context {
            $($(#[$doc])* $place,)+
        }

        impl Context {
            pub const ALL: [Self; [$(Self::$place),+].len()] = [$(Self::$place),+];

            pub fn title(self) -> &'static str {
                match self {
                    $(Self::$place => $title,)+
                }
            }

            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$place => $name,)+
                }
            }

            fn unbound(self) -> Unbound {
                match self {
                    $(Self::$place => $unbound,)+
                }
            }

            pub(in crate::tui) fn outer(self) -> Option<Self> {
                match self {
                    $(Self::$place => $outer,)+
                }
            }
        }
    };
}

const EVERYWHERE: Option<Context> = Some(Context::Everywhere);
const LINE: Option<Context> = Some(Context::Line);
const EXPLORE: Option<Context> = Some(Context::Explore);

contexts! {
    Matrix "matrix" "On the matrix" Ignored, EVERYWHERE;
    Hold "hold" "While a shape is held" Ignored, Some(Self::Matrix);
    Form "form" "In a form" Typed, LINE;
    List "list" "In the list of shapes" Typed, EVERYWHERE;
    History "history" "In the history" Ignored, EVERYWHERE;
    Compare "compare" "Comparing" Ignored, EVERYWHERE;
    Name "name" "Saving" Typed, LINE;
    Command "command" "In the command line" Typed, LINE;
    Ranges "ranges" "Ranges of a sweep" Typed, LINE;
    Running "running" "While work is under way" Ignored, EVERYWHERE;
    Explore "explore" "Exploring, on every page" Ignored, EVERYWHERE;
    Imprints "imprints" "In the list of imprints" Ignored, EXPLORE;
    Statistics "statistics" "In the statistics" Ignored, EXPLORE;
    Histogram "histogram" "At the histogram" Ignored, EXPLORE;
    Map "map" "On the map" Ignored, EXPLORE;
    Scatter "scatter" "At the scatter plot" Ignored, EXPLORE;
    Angles "angles" "At the plot of angles" Ignored, EXPLORE;
    Filter "filter" "Filtering the list of imprints" Typed, LINE;
    Export "export" "Exporting" Typed, LINE;
    Recognise "recognise" "Recognising" Ignored, Some(Self::Matrix);
    Confusion "confusion" "At the confusion matrix" Ignored, EVERYWHERE;
    Live "live" "Watching a sensor" Ignored, EVERYWHERE;
    Question "question" "At a question" Ignored, EVERYWHERE;
    Help "help" "In the help" Ignored, EVERYWHERE;
    Search "search" "Searching" Typed, LINE;
    /// In any text field, unless its page gives the key another meaning.
    Line "line" "In a line of text" Typed, EVERYWHERE;
    /// Everywhere, unless the place gives the key another meaning.
    Everywhere "everywhere" "Everywhere" Ignored, None;
}

impl Context {
    pub fn screen(self) -> Option<Self> {
        let screens = [Self::Explore, Self::Matrix];
        let own = self.outer().filter(|outer| screens.contains(outer));
        own.filter(|_| self != Self::Hold)
    }

    pub(in crate::tui) fn other_tabs(self) -> impl Iterator<Item = Self> {
        let is_tab = |place: Self| place.outer() == EXPLORE;
        let others = Self::ALL.into_iter();
        others.filter(move |other| is_tab(self) && is_tab(*other) && *other != self)
    }

    pub(in crate::tui) fn leads_to(self, place: Self) -> bool {
        std::iter::successors(Some(self), |context| context.outer()).any(|own| own == place)
    }

    pub(in crate::tui) fn takes_text(self) -> bool {
        self.unbound() == Typed
    }
}

#[derive(Clone, Debug)]
pub struct Binding {
    pub context: Context,
    /// Empty after a settings file has taken them all away.
    pub keys: Cow<'static, [(Key, &'static Action)]>,
    pub hint: &'static str,
    pub help: &'static str,
}

impl Binding {
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

    pub fn does(&self, message: &Message) -> bool {
        self.keys.iter().any(|(_, action)| action.sends(message))
    }

    pub(in crate::tui) fn without(&self, others: &[Key]) -> Self {
        let keys = self.keys.iter().filter(|(key, _)| !others.contains(key));
        Self {
            keys: keys.copied().collect(),
            ..self.clone()
        }
    }

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

    pub fn short_labels(&self) -> String {
        let parts = self.short_parts().into_iter();
        parts.map(|(label, _)| label).collect()
    }

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
