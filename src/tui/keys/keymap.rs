//! The keys in use: the default keys with the changes from a settings file.
//!
//! A change gives a key of a place to one of the actions of that place, or makes it do nothing. Changes that would
//! surprise are refused: changing the same key twice, taking away the last key of an action without giving it a new
//! one, a letter where text is typed, and any change of Ctrl-C, which always closes what is open.

use std::borrow::Cow;

use crate::tui::app::message::Message;
use crate::tui::keys::action::Action;
use crate::tui::keys::default_keys::DEFAULT_KEYS;
use crate::tui::keys::key::{Arrow, Key};
use Unbound::{Ignored, Typed};

const WAY_OUT: Key = Key::Ctrl('c');

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    pub context: Context,
    pub key: Key,
    pub action: Option<&'static Action>,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KeymapError {
    #[error("{WAY_OUT} always closes what is open and cannot be changed")]
    WayOut,
    #[error("{0} types text here; choose a key like <C-x>")]
    Text(Key),
    #[error("{0} is bound twice here")]
    Twice(Key),
    #[error("{action:?} is not an action of [keys.{}]; 'taxel config' lists them", context.name())]
    Elsewhere {
        action: &'static str,
        context: Context,
    },
    /// The former action of the key would have no key left.
    #[error("{key} is the only key of {action:?} here; give the action another key first")]
    LastKey { key: Key, action: &'static str },
}

#[derive(Clone, Debug)]
pub struct Keymap {
    rows: Vec<Binding>,
}

impl Default for Keymap {
    fn default() -> Self {
        Self {
            rows: DEFAULT_KEYS.to_vec(),
        }
    }
}

impl Keymap {
    pub fn with(changes: &[Change]) -> Result<Self, (usize, KeymapError)> {
        for (index, change) in changes.iter().enumerate() {
            allowed(change, &changes[..index]).map_err(|error| (index, error))?;
        }
        let rows: Vec<Binding> = DEFAULT_KEYS
            .iter()
            .map(|row| changed(row, changes))
            .collect();
        for (index, change) in changes.iter().enumerate() {
            lasting(change, &rows).map_err(|error| (index, error))?;
        }
        Ok(Self { rows })
    }

    pub fn rows(&self) -> &[Binding] {
        &self.rows
    }

    pub fn of(&self, context: Context) -> impl Iterator<Item = &Binding> {
        self.rows
            .iter()
            .filter(move |binding| binding.context == context)
    }

    /// A key that has no binding there is looked up in the outer places; if it has none there either, a character is
    /// typed if the place has a field.
    pub fn lookup(&self, context: Context, key: Key) -> Option<Message> {
        let mut place = Some(context);
        while let Some(here) = place {
            let mut keys = self.of(here).flat_map(|binding| binding.keys.iter());
            if let Some((_, action)) = keys.find(|(bound, _)| *bound == key) {
                return action.message().cloned();
            }
            place = here.outer();
        }
        match key {
            Key::Char(character) if context.takes_text() => Some(Message::Type(character)),
            _ => None,
        }
    }

    pub fn label(&self, context: Context, action: &Action) -> String {
        let places = std::iter::successors(Some(context), |place| place.outer());
        let mut keys = places
            .flat_map(|place| self.of(place))
            .flat_map(|binding| binding.keys.iter());
        keys.find(|(_, own)| *own == action)
            .map_or_else(|| format!(":{}", action.name), |(key, _)| key.label())
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HelpLine {
    Place(Context),
    Keys(String, &'static str),
    More(&'static str),
}

/// On the matrix, where a user begins, these are all rows; elsewhere the rows of the place and its outer places,
/// without keys that an inner one binds, then those of the screen's other tabs.
pub fn help(context: Context, keymap: &Keymap) -> Vec<HelpLine> {
    let whole = |place| section(place, keymap, &[]);
    if context == Context::Matrix {
        return Context::ALL.into_iter().flat_map(whole).collect();
    }
    let mut lines = Vec::new();
    let mut taken: Vec<Key> = Vec::new();
    for place in std::iter::successors(Some(context), |place| place.outer()) {
        lines.extend(section(place, keymap, &taken));
        let own = keymap.of(place).flat_map(|row| row.keys.iter());
        taken.extend(own.map(|(key, _)| *key));
    }
    lines.extend(context.other_tabs().flat_map(whole));
    lines
}

fn section(place: Context, keymap: &Keymap, taken: &[Key]) -> Vec<HelpLine> {
    let rows = keymap.of(place).map(|row| row.without(taken));
    let rows = rows.filter(|row| taken.is_empty() || !row.keys.is_empty());
    let mut lines = vec![HelpLine::Place(place)];
    lines.extend(rows.map(|row| HelpLine::Keys(row.labels(), row.help)));
    if lines.len() == 1 {
        lines.clear();
    }
    lines
}

fn allowed(change: &Change, before: &[Change]) -> Result<(), KeymapError> {
    let Change {
        context,
        key,
        action,
    } = *change;
    let mut bound = default_rows(context).flat_map(|row| row.keys.iter());
    // A key that works everywhere works in every field, too.
    let takes_text = context.takes_text() || context == Context::Everywhere;
    let is_text = matches!(key, Key::Char(_)) && takes_text;
    let as_before = |(own, meaning): &(Key, &Action)| *own == key && Some(*meaning) == action;
    if key == WAY_OUT && !bound.clone().any(as_before) {
        return Err(KeymapError::WayOut);
    }
    if is_text && !bound.clone().any(|(own, _)| *own == key) {
        return Err(KeymapError::Text(key));
    }
    if before
        .iter()
        .any(|other| other.context == context && other.key == key)
    {
        return Err(KeymapError::Twice(key));
    }
    match action {
        Some(action) if !bound.any(|(_, own)| *own == action) => {
            let action = action.name;
            Err(KeymapError::Elsewhere { action, context })
        }
        _ => Ok(()),
    }
}

fn lasting(change: &Change, rows: &[Binding]) -> Result<(), KeymapError> {
    let lost = default_rows(change.context)
        .flat_map(|row| row.keys.iter())
        .find(|(key, _)| *key == change.key && change.action.is_some());
    let Some((key, action)) = lost else {
        return Ok(());
    };
    let mut now = rows
        .iter()
        .filter(|row| row.context == change.context)
        .flat_map(|row| row.keys.iter());
    if now.any(|(_, other)| other == action) {
        return Ok(());
    }
    Err(KeymapError::LastKey {
        key: *key,
        action: action.name,
    })
}

/// Returns a row after the changes. A new key comes before the others of its action, so that hints show it.
fn changed(row: &Binding, changes: &[Change]) -> Binding {
    let here = || {
        changes
            .iter()
            .filter(|change| change.context == row.context)
    };
    let mut actions: Vec<&'static Action> = Vec::new();
    for &(_, action) in row.keys.iter() {
        if !actions.contains(&action) {
            actions.push(action);
        }
    }
    let keys = actions.into_iter().flat_map(|action| {
        let new = here()
            .filter(move |change| change.action == Some(action))
            .map(|change| change.key);
        let old = row
            .keys
            .iter()
            .filter(move |(_, own)| *own == action)
            .map(|(key, _)| *key)
            .filter(|key| here().all(|change| change.key != *key));
        new.chain(old).map(|key| (key, action)).collect::<Vec<_>>()
    });
    Binding {
        keys: keys.collect(),
        ..row.clone()
    }
}

fn default_rows(context: Context) -> impl Iterator<Item = &'static Binding> + Clone {
    DEFAULT_KEYS
        .iter()
        .filter(move |binding| binding.context == context)
}

pub fn actions(context: Context) -> Vec<&'static str> {
    let mut names = Vec::new();
    for (_, action) in default_rows(context).flat_map(|row| row.keys.iter()) {
        if !names.contains(&action.name) {
            names.push(action.name);
        }
    }
    names
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Unbound {
    Ignored,
    Typed,
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::keys::action::{self, ACTIONS};
    use crate::tui::keys::key::parse;

    fn change(context: Context, key: &str, action: &str) -> Change {
        let keys = parse(key).expect("a key");
        Change {
            context,
            key: keys[0],
            action: (action != "none").then(|| action::named(action).expect("an action")),
        }
    }

    fn refused(changes: &[Change]) -> (usize, String) {
        let (index, error) = Keymap::with(changes).expect_err("refused");
        (index, error.to_string())
    }

    #[test]
    fn every_action_has_one_name_and_a_key() {
        for (index, action) in ACTIONS.iter().enumerate() {
            if action.message().is_none() {
                continue;
            }
            assert_eq!(action::named(action.name), Some(*action));
            let before = ACTIONS[..index].iter();
            let mut before = before.filter(|other| other.message().is_some());
            assert!(
                before.all(|other| other.name != action.name),
                "{}",
                action.name
            );
            let mut bound = DEFAULT_KEYS.iter().flat_map(|binding| binding.keys.iter());
            let has_key = bound.any(|(_, own)| own == action);
            assert_eq!(has_key, **action != action::QUIT_NOW, "{}", action.name);
        }
    }

    #[test]
    fn keys_can_be_added_freed_and_swapped() {
        use crate::tui::keys::keymap::Context::{Form, Hold, Matrix};
        let keymap = Keymap::with(&[
            change(Matrix, "x", "toggle"),
            change(Matrix, "u", "redo"),
            change(Matrix, "U", "undo"),
            change(Matrix, "d", "none"),
            change(Form, "<C-n>", "next"),
        ])
        .expect("nothing against it");
        let matrix = |key| keymap.lookup(Matrix, Key::Char(key));
        assert_eq!(matrix('x'), Some(Message::Toggle));
        assert_eq!(matrix(' '), Some(Message::Toggle), "keys are added");
        assert_eq!(
            (matrix('u'), matrix('U')),
            (Some(Message::Redo), Some(Message::Undo))
        );
        assert_eq!(matrix('d'), None);
        // While a shape is held, keys without a binding are looked up on the matrix.
        assert_eq!(keymap.lookup(Hold, Key::Char('x')), Some(Message::Toggle));
        assert_eq!(keymap.lookup(Form, Key::Ctrl('n')), Some(Message::Field(1)));
        assert_eq!(keymap.label(Matrix, &action::TOGGLE), "x");
        assert_eq!(keymap.label(Matrix, &action::DELETE), ":delete");
        let lengths = (keymap.rows().len(), DEFAULT_KEYS.len());
        assert_eq!(lengths.0, lengths.1, "no row comes or goes");
    }

    #[test]
    fn surprising_changes_are_refused() {
        use crate::tui::keys::keymap::Context::{Everywhere, List, Matrix};
        let free = change(Matrix, "x", "toggle");
        for (wrong, message) in [
            (
                change(Everywhere, "<C-c>", "none"),
                "<C-c> always closes what is open and cannot be changed",
            ),
            (
                change(List, "j", "scroll-down"),
                "j types text here; choose a key like <C-x>",
            ),
            (
                change(Everywhere, "r", "redraw"),
                "r types text here; choose a key like <C-x>",
            ),
            (change(Matrix, "x", "undo"), "x is bound twice here"),
            (
                change(Matrix, "a", "increase"),
                "\"increase\" is not an action of [keys.matrix]; 'taxel config' lists them",
            ),
            (
                change(Matrix, "d", "undo"),
                "d is the only key of \"delete\" here; give the action another key first",
            ),
        ] {
            let expected = (1, message.to_owned());
            assert_eq!(refused(&[free, wrong]), expected);
        }
    }
}
