//! The keys in use: the default keys with the changes from a settings file.
//!
//! A change gives a key of a place to one of the actions of that place, or makes it do nothing. A key is changed once
//! in a place; Ctrl-C and Esc, which close what is open, are not changed.

use std::sync::LazyLock;

use crate::tui::app::Message;
use crate::tui::keys::action::Action;
use crate::tui::keys::default_keys::{KeyPlace, PLACES};
use crate::tui::keys::{Arrow, Key, parse};

/// The places in which keys have a meaning: pages, and parts of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Context {
    Matrix,
    Hold,
    Draw,
    Explain,
    Form,
    List,
    Compare,
    Name,
    Command,
    Ranges,
    Running,
    Explore,
    Imprints,
    Statistics,
    Histogram,
    Map,
    Export,
    Recognise,
    Live,
    Question,
    Help,
    Line,
    Everywhere,
}

impl Context {
    pub fn all() -> impl Iterator<Item = Self> {
        PLACES.iter().map(|(place, ..)| *place)
    }

    fn row(self) -> &'static KeyPlace {
        &PLACES[self as usize]
    }

    /// The name in a settings file.
    pub fn name(self) -> &'static str {
        self.row().1
    }

    pub fn title(self) -> &'static str {
        self.row().2
    }

    pub fn outer(self) -> Option<Self> {
        Some(self.row().3).filter(|outer| *outer != self)
    }

    /// The place and the outer ones.
    pub fn around(self) -> impl Iterator<Item = Self> {
        std::iter::successors(Some(self), |place| place.outer())
    }

    /// The screen around a place that is a part of one.
    pub fn screen(self) -> Option<Self> {
        let screens = [Self::Explore, Self::Matrix];
        let is_mode = matches!(self, Self::Hold | Self::Draw);
        self.outer()
            .filter(|outer| screens.contains(outer) && !is_mode)
    }

    pub fn leads_to(self, place: Self) -> bool {
        self.around().any(|own| own == place)
    }

    pub fn takes_text(self) -> bool {
        self.leads_to(Self::Line)
    }

    /// The actions that keys of the place can have.
    pub fn actions(self) -> Vec<&'static Action> {
        let rows = DEFAULT_KEYS.iter().filter(|row| row.context == self);
        rows.flat_map(|row| row.actions.iter().copied()).collect()
    }
}

#[derive(Clone, Debug)]
pub struct Binding {
    pub context: Context,
    /// Empty after a settings file has taken them all away.
    pub keys: Vec<(Key, &'static Action)>,
    /// The actions of its keys, each once.
    pub actions: Vec<&'static Action>,
    pub hint: &'static str,
    pub help: &'static str,
}

impl Binding {
    pub fn does(&self, message: &Message) -> bool {
        self.actions.iter().any(|action| action.message == *message)
    }

    pub fn labels(&self) -> String {
        let mut labels = Vec::new();
        for (key, _) in &self.keys {
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

pub static DEFAULT_KEYS: LazyLock<Vec<Binding>> = LazyLock::new(|| {
    let rows = |(context, _, _, _, rows): &'static KeyPlace| {
        rows.iter().map(|&(keys, own, hint, help)| {
            let keys = parse(keys).unwrap_or_default().into_iter().enumerate();
            let action = |at: usize| own.get(at).or(own.last()).copied();
            let keys = keys.filter_map(|(at, key)| Some((key, action(at)?)));
            let mut actions: Vec<&'static Action> = own.to_vec();
            actions.dedup();
            Binding {
                context: *context,
                keys: keys.collect(),
                actions,
                hint,
                help,
            }
        })
    };
    PLACES.iter().flat_map(rows).collect()
});

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    pub context: Context,
    pub key: Key,
    pub action: Option<&'static Action>,
}

#[derive(Clone, Debug)]
pub struct Keymap {
    pub rows: Vec<Binding>,
}

impl Default for Keymap {
    fn default() -> Self {
        Self {
            rows: DEFAULT_KEYS.clone(),
        }
    }
}

impl Keymap {
    pub fn with(changes: &[Change]) -> Result<Self, String> {
        for (index, change) in changes.iter().enumerate() {
            let Change {
                context,
                key,
                action,
            } = *change;
            let is_same = |other: &Change| other.context == context && other.key == key;
            if matches!(key, Key::Esc | Key::Ctrl('c')) {
                return Err(format!("{key} closes what is open and cannot be changed"));
            }
            if changes[..index].iter().any(is_same) {
                return Err(format!("{key} is bound twice here"));
            }
            if let Some(action) = action.filter(|own| !context.actions().contains(own)) {
                let (action, place) = (action.name, context.name());
                return Err(format!(
                    "{action:?} is not an action of [keys.{place}]; 'taxel config' lists them"
                ));
            }
        }
        let mut keymap = Self::default();
        for row in &mut keymap.rows {
            let here = || {
                changes
                    .iter()
                    .filter(|change| change.context == row.context)
            };
            let mut keys = Vec::new();
            for &action in &row.actions {
                // A new key comes before the others of its action, so that hints show it.
                let new = here().filter(|change| change.action == Some(action));
                keys.extend(new.map(|change| (change.key, action)));
                let old = row.keys.iter().filter(|(_, own)| *own == action);
                keys.extend(old.filter(|(key, _)| here().all(|change| change.key != *key)));
            }
            row.keys = keys;
        }
        Ok(keymap)
    }

    pub fn of(&self, context: Context) -> impl Iterator<Item = &Binding> {
        self.rows.iter().filter(move |row| row.context == context)
    }

    /// The keys of a place and of the outer ones, in the order of their meaning.
    fn around(&self, context: Context) -> impl Iterator<Item = &(Key, &'static Action)> {
        let rows = context.around().flat_map(|place| self.of(place));
        rows.flat_map(|row| &row.keys)
    }

    /// A key that has no binding there is looked up in the outer places; if it has none there either, a character is
    /// typed if the place has a field.
    pub fn lookup(&self, context: Context, key: Key) -> Option<Message> {
        match (self.around(context).find(|(bound, _)| *bound == key), key) {
            (Some((_, action)), _) => Some(action.message.clone()),
            (None, Key::Char(character)) if context.takes_text() => Some(Message::Type(character)),
            _ => None,
        }
    }

    /// The key of an action, or its name if it has none.
    pub fn label(&self, context: Context, action: &Action) -> String {
        let key = self.around(context).find(|(_, own)| *own == action);
        key.map_or_else(|| action.name.to_owned(), |(key, _)| key.label())
    }
}

/// A line of help: the title of a place, or keys with what they do.
#[derive(Clone, Debug)]
pub struct HelpLine {
    pub title: &'static str,
    pub keys: String,
    pub text: &'static str,
}

/// The rows of the place and its outer places, without keys that an inner one binds; then those of the other places on
/// the matrix or on the pages of Explore.
pub fn help(context: Context, keymap: &Keymap) -> Vec<HelpLine> {
    let inner: Vec<Context> = context.around().collect();
    let screens = [Context::Matrix, Context::Explore];
    let others = Context::all().filter(|place| {
        let screen = place.outer().filter(|outer| screens.contains(outer));
        screen.is_some_and(|screen| inner.contains(&screen)) && !inner.contains(place)
    });
    let mut lines = Vec::new();
    let mut taken: Vec<Key> = Vec::new();
    for place in inner.iter().copied().chain(others) {
        let mut rows: Vec<Binding> = keymap.of(place).cloned().collect();
        if inner.contains(&place) {
            for row in &mut rows {
                row.keys.retain(|(key, _)| !taken.contains(key));
            }
            taken.extend(rows.iter().flat_map(|row| &row.keys).map(|(key, _)| *key));
        }
        rows.retain(|row| !row.keys.is_empty());
        if !rows.is_empty() {
            let (title, keys, text) = (place.title(), String::new(), "");
            lines.push(HelpLine { title, keys, text });
        }
        lines.extend(rows.iter().map(|row| HelpLine {
            title: "",
            keys: row.labels(),
            text: row.help,
        }));
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn change(context: Context, key: &str, name: &str) -> Change {
        let actions = DEFAULT_KEYS
            .iter()
            .flat_map(|row| row.actions.iter().copied());
        let action = actions.into_iter().find(|action| action.name == name);
        assert_eq!(action.is_some(), name != "none", "{name}");
        let key = parse(key).expect("a key")[0];
        Change {
            context,
            key,
            action,
        }
    }

    #[test]
    fn each_row_has_keys_for_its_actions() {
        for (index, (place, ..)) in PLACES.iter().enumerate() {
            assert_eq!(*place as usize, index);
        }
        let rows = PLACES.iter().flat_map(|(.., rows)| rows.iter());
        for (row, (keys, actions, ..)) in DEFAULT_KEYS.iter().zip(rows) {
            assert!(
                row.keys.len() >= actions.len() && !actions.is_empty(),
                "{keys}"
            );
        }
        for action in Context::all().flat_map(Context::actions) {
            let mut all = Context::all().flat_map(Context::actions);
            assert!(all.all(|other| other == action || other.name != action.name));
        }
    }

    #[test]
    fn keys_can_be_added_freed_and_swapped() {
        use crate::tui::keys::keymap::Context::{Everywhere, Form, Hold, List, Matrix};
        let keymap = Keymap::with(&[
            change(Matrix, "x", "toggle"),
            change(Matrix, "u", "redo"),
            change(Matrix, "U", "undo"),
            change(Matrix, "d", "none"),
            change(Form, "<C-n>", "next"),
        ])
        .expect("nothing against it");
        let key = |key| keymap.lookup(Matrix, Key::Char(key));
        assert_eq!(
            [key('x'), key(' ')],
            [Some(Message::Toggle), Some(Message::Toggle)]
        );
        assert_eq!(
            [key('u'), key('U'), key('d')],
            [Some(Message::Redo), Some(Message::Undo), None]
        );
        // While a shape is held, keys without a binding are looked up on the matrix.
        assert_eq!(keymap.lookup(Hold, Key::Char('x')), Some(Message::Toggle));
        assert_eq!(keymap.lookup(Form, Key::Ctrl('n')), Some(Message::Field(1)));
        assert_eq!(keymap.label(Matrix, &crate::tui::keys::action::TOGGLE), "x");
        assert_eq!(
            keymap.label(Matrix, &crate::tui::keys::action::DELETE),
            "delete"
        );
        let free = change(Matrix, "x", "toggle");
        for wrong in [
            change(Everywhere, "<C-c>", "none"),
            change(List, "<Esc>", "none"),
            change(Matrix, "x", "undo"),
            change(Matrix, "a", "increase"),
        ] {
            assert!(Keymap::with(&[free, wrong]).is_err(), "{wrong:?}");
        }
    }
}
