//! The keys as they are: the table of keys with what a user has changed of it.
//!
//! A change gives a key of a place to one of the actions that the place has, or to none. Refused is what would surprise:
//! a key twice, an action that loses its last key to another without having been given a new one, a letter where letters
//! are typed, and any change of Ctrl-C, which always closes what is open.

use crate::tui::app::message::Message;
use crate::tui::keys::action;
use crate::tui::keys::binding::{Binding, Context};
use crate::tui::keys::default_keys::KEYMAP;
use crate::tui::keys::key::Key;

/// Closes what is open, wherever one is; on the matrix it quits.
const WAY_OUT: Key = Key::Ctrl('c');

/// A key that shall mean something else in a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Where.
    pub context: Context,
    /// Which.
    pub key: Key,
    /// What it does from now on; none for nothing.
    pub action: Option<Message>,
}

/// Why a change cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RemapError {
    /// The key that always closes.
    #[error("{WAY_OUT} always closes what is open and cannot be changed")]
    WayOut,
    /// A letter where text is typed.
    #[error("{0} is typed as text here; a key like <C-x> is not")]
    Text(Key),
    /// The same key a second time.
    #[error("{0} has been given a meaning here already")]
    Twice(Key),
    /// The action belongs to another place.
    #[error("{0:?} is no action of this place; 'taxel config' lists them")]
    Elsewhere(&'static str),
    /// No key would be left for what the key did.
    #[error("{key} is the only key of {action:?} here, which needs another one")]
    LastKey {
        /// The key.
        key: Key,
        /// What it does now.
        action: &'static str,
    },
}

/// What each key means where.
#[derive(Clone, Debug)]
pub struct Keymap {
    rows: Vec<Binding>,
}

impl Default for Keymap {
    /// The table of keys.
    fn default() -> Self {
        Self {
            rows: KEYMAP.to_vec(),
        }
    }
}

impl Keymap {
    /// The table of keys with changes.
    ///
    /// # Errors
    /// The first change that cannot be made, by its number from 0, and why.
    pub fn with(changes: &[Change]) -> Result<Self, (usize, RemapError)> {
        for (index, change) in changes.iter().enumerate() {
            allowed(change, &changes[..index]).map_err(|error| (index, error))?;
        }
        let rows: Vec<Binding> = KEYMAP.iter().map(|row| changed(row, changes)).collect();
        for (index, change) in changes.iter().enumerate() {
            lasting(change, &rows).map_err(|error| (index, error))?;
        }
        Ok(Self { rows })
    }

    /// Its rows, those of the table of keys in the same order.
    pub fn rows(&self) -> &[Binding] {
        &self.rows
    }

    /// The rows of one place.
    pub fn of(&self, context: Context) -> impl Iterator<Item = &Binding> {
        self.rows
            .iter()
            .filter(move |binding| binding.context == context)
    }

    /// What a key means where it is pressed.
    pub fn lookup(&self, context: Context, key: Key) -> Option<Message> {
        let mut place = Some(context);
        while let Some(here) = place {
            let mut keys = self.of(here).flat_map(|binding| binding.keys.iter());
            if let Some((_, message)) = keys.find(|(bound, _)| *bound == key) {
                return Some(message.clone());
            }
            place = here.outer();
        }
        match key {
            Key::Char(character) if context.takes_text() => Some(Message::Type(character)),
            _ => None,
        }
    }

    /// The first key of an action as people write it; without one, how the command line at the foot calls it.
    pub fn label(&self, context: Context, action: &Message) -> String {
        let mut keys = self.of(context).flat_map(|binding| binding.keys.iter());
        keys.find(|(_, own)| own == action).map_or_else(
            || format!(":{}", action::name(action).unwrap_or_default()),
            |(key, _)| key.label(),
        )
    }
}

/// A line of help.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HelpLine {
    /// The heading of a place.
    Place(Context),
    /// The keys of a row of the table, and what they do.
    Keys(String, &'static str),
    /// More of what they do, where one line has no room for all of it.
    More(&'static str),
}

/// The lines of help in a place: on the matrix, where one begins, all of the table; elsewhere what means something
/// there, so without the keys of outer places that mean something else there.
pub fn help(context: Context, keymap: &Keymap) -> Vec<HelpLine> {
    let places = match context {
        Context::Matrix => Context::ALL.to_vec(),
        inner => std::iter::successors(Some(inner), |place| place.outer()).collect(),
    };
    let mut lines = Vec::new();
    let mut taken: Vec<Key> = Vec::new();
    for place in places {
        let rows: Vec<HelpLine> = keymap
            .of(place)
            .map(|row| row.without(&taken))
            .filter(|row| taken.is_empty() || !row.keys.is_empty())
            .map(|row| HelpLine::Keys(row.labels(), row.help))
            .collect();
        if !rows.is_empty() {
            lines.push(HelpLine::Place(place));
            lines.extend(rows);
        }
        if context != Context::Matrix {
            let own = keymap.of(place).flat_map(|row| row.keys.iter());
            taken.extend(own.map(|(key, _)| *key));
        }
    }
    lines
}

/// Whether a change says something sensible for itself, after those before it.
fn allowed(change: &Change, before: &[Change]) -> Result<(), RemapError> {
    let Change {
        context,
        key,
        ref action,
    } = *change;
    let mut bound = of_table(context).flat_map(|row| row.keys.iter());
    // What means something everywhere would mean it in every field.
    let takes_text = context.takes_text() || context == Context::Everywhere;
    let is_text = matches!(key, Key::Char(_)) && takes_text;
    let as_ever = |(own, meaning): &(Key, Message)| *own == key && Some(meaning) == action.as_ref();
    if key == WAY_OUT && !bound.clone().any(as_ever) {
        return Err(RemapError::WayOut);
    }
    if is_text && !bound.clone().any(|(own, _)| *own == key) {
        return Err(RemapError::Text(key));
    }
    if before
        .iter()
        .any(|other| other.context == context && other.key == key)
    {
        return Err(RemapError::Twice(key));
    }
    match action {
        Some(action) if !bound.any(|(_, own)| own == action) => Err(RemapError::Elsewhere(
            action::name(action).unwrap_or_default(),
        )),
        _ => Ok(()),
    }
}

/// Whether what a key did before it was given to something else still has a key.
fn lasting(change: &Change, rows: &[Binding]) -> Result<(), RemapError> {
    let lost = of_table(change.context)
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
    Err(RemapError::LastKey {
        key: *key,
        action: action::name(action).unwrap_or_default(),
    })
}

/// A row with the keys that it has after the changes. A new key comes before the others of its action, so that hints show it.
fn changed(row: &Binding, changes: &[Change]) -> Binding {
    let here = || {
        changes
            .iter()
            .filter(|change| change.context == row.context)
    };
    let mut actions: Vec<&Message> = Vec::new();
    for (_, action) in row.keys.iter() {
        if !actions.contains(&action) {
            actions.push(action);
        }
    }
    let keys = actions.into_iter().flat_map(|action| {
        let new = here()
            .filter(move |change| change.action.as_ref() == Some(action))
            .map(|change| change.key);
        let old = row
            .keys
            .iter()
            .filter(move |(_, own)| own == action)
            .map(|(key, _)| *key)
            .filter(|key| here().all(|change| change.key != *key));
        new.chain(old)
            .map(|key| (key, action.clone()))
            .collect::<Vec<_>>()
    });
    Binding {
        keys: keys.collect(),
        ..row.clone()
    }
}

/// The rows of a place as the table has them.
fn of_table(context: Context) -> impl Iterator<Item = &'static Binding> + Clone {
    KEYMAP
        .iter()
        .filter(move |binding| binding.context == context)
}

/// The actions of a place by their names, in the order of the table.
pub fn actions(context: Context) -> Vec<&'static str> {
    let mut names = Vec::new();
    for (_, action) in of_table(context).flat_map(|row| row.keys.iter()) {
        let name = action::name(action).unwrap_or_default();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::keys::key::parse;

    fn change(context: Context, key: &str, action: &str) -> Change {
        let keys = parse(key).expect("a key");
        Change {
            context,
            key: keys[0],
            action: (action != "none").then(|| action::named(action).expect("an action").clone()),
        }
    }

    fn refused(changes: &[Change]) -> (usize, String) {
        let (index, error) = Keymap::with(changes).expect_err("refused");
        (index, error.to_string())
    }

    /// Whoever adds a row to the table finds here that its actions want names.
    #[test]
    fn every_action_of_the_table_has_one_name_and_every_name_an_action() {
        for binding in KEYMAP {
            for (key, action) in binding.keys.iter() {
                let name = action::name(action);
                assert!(name.is_some(), "{key}: {action:?} has no name in ACTIONS");
                assert_eq!(name.and_then(action::named), Some(action));
            }
        }
        for (index, (name, action)) in action::ACTIONS.iter().enumerate() {
            let before = &action::ACTIONS[..index];
            assert!(before.iter().all(|(other, _)| other != name), "{name}");
            let mut bound = KEYMAP.iter().flat_map(|binding| binding.keys.iter());
            assert!(bound.any(|(_, own)| own == action), "{name} has no key");
        }
    }

    #[test]
    fn without_changes_every_key_means_what_the_table_says() {
        let keymap = Keymap::default();
        for binding in KEYMAP {
            for (key, message) in binding.keys.iter() {
                let meaning = keymap.lookup(binding.context, *key);
                assert_eq!(meaning.as_ref(), Some(message), "{key}");
            }
        }
        assert_eq!(
            keymap.lookup(Context::Name, Key::Char('x')),
            Some(Message::Type('x'))
        );
        assert_eq!(keymap.lookup(Context::Matrix, Key::Char('x')), None);
    }

    #[test]
    fn a_key_is_given_freed_and_exchanged() {
        use Context::{Form, Grab, Matrix};
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
        // What is held looks on the matrix for what it does not know.
        assert_eq!(keymap.lookup(Grab, Key::Char('x')), Some(Message::Toggle));
        assert_eq!(keymap.lookup(Form, Key::Ctrl('n')), Some(Message::Field(1)));
        assert_eq!(keymap.label(Matrix, &Message::Toggle), "x");
        assert_eq!(keymap.label(Matrix, &Message::Delete), ":delete");
        let lengths = (keymap.rows().len(), KEYMAP.len());
        assert_eq!(lengths.0, lengths.1, "no row comes or goes");
    }

    #[test]
    fn what_would_surprise_is_refused() {
        use Context::{Everywhere, List, Matrix};
        let free = change(Matrix, "x", "toggle");
        for (wrong, message) in [
            (
                change(Everywhere, "<C-c>", "none"),
                "<C-c> always closes what is open and cannot be changed",
            ),
            (
                change(List, "j", "scroll-down"),
                "j is typed as text here; a key like <C-x> is not",
            ),
            (
                change(Everywhere, "r", "redraw"),
                "r is typed as text here; a key like <C-x> is not",
            ),
            (
                change(Matrix, "x", "undo"),
                "x has been given a meaning here already",
            ),
            (
                change(Matrix, "a", "increase"),
                "\"increase\" is no action of this place; 'taxel config' lists them",
            ),
            (
                change(Matrix, "d", "undo"),
                "d is the only key of \"delete\" here, which needs another one",
            ),
        ] {
            let expected = (1, message.to_owned());
            assert_eq!(refused(&[free.clone(), wrong]), expected);
        }
    }
}
