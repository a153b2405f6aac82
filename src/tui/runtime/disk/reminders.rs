//! What a run remembers for the next one: commands, the set of shapes that was recognised last, the values of forms.
//!
//! Scripts and recorded runs have none of it: they do the same every time.

use crate::formats::Name;
use crate::storage::ModelChoice;
use crate::storage::{Library, RememberedFile};
use crate::tui::app::state::App;
use crate::tui::form::memory::FormMemory;
use crate::tui::recognise::reach::trained_set;
use crate::tui::runtime::disk::queue::{DiskQueue, DiskRequest};

/// The files, and what is in them as far as that is known.
#[derive(Debug)]
pub(in crate::tui::runtime) struct Reminders {
    /// The commands of the prompt.
    commands: RememberedFile,
    /// How many of them are remembered.
    remembered: usize,
    /// The set.
    set: RememberedFile,
    /// Which one is remembered.
    chosen: Option<ModelChoice>,
    /// The values of forms.
    forms: RememberedFile,
    /// Those that are remembered.
    values: FormMemory,
}

impl Reminders {
    /// The files in the folder of a library.
    pub(in crate::tui::runtime) fn of(library: &Library) -> Self {
        Self {
            commands: RememberedFile::commands(library),
            remembered: 0,
            set: RememberedFile::recognised_set(library),
            chosen: None,
            forms: RememberedFile::forms(library),
            values: FormMemory::default(),
        }
    }

    /// Gives the program what earlier runs remembered.
    pub(in crate::tui::runtime) fn remind(&mut self, app: &mut App) {
        app.commands = self.commands.read();
        self.remembered = app.commands.len();
        let set = self.set.read().pop();
        self.chosen = set
            .and_then(|name| Name::new(&name).ok())
            .map(ModelChoice::from_name);
        if let (Some(own), Some(page)) = (&self.chosen, app.recognition.as_mut()) {
            page.begin_with(own.clone());
        }
        self.values = FormMemory::read(&self.forms.read());
        app.forms = self.values.clone();
    }

    /// Remembers what is new. A set counts once its model is there, so that none is remembered that does not exist; a file
    /// does not, since the next run may begin in another folder.
    pub(in crate::tui::runtime) fn note(&mut self, app: &App, queue: &mut DiskQueue) {
        let mut write = |file: &RememberedFile, lines| {
            // The answer says nothing.
            let _ = queue.begin(DiskRequest::Remember(file.clone(), lines));
        };
        if app.commands.len() > self.remembered {
            write(&self.commands, app.commands.clone());
            self.remembered = app.commands.len();
        }
        let is_new = |now: &&ModelChoice| {
            !matches!(now, ModelChoice::File(_)) && self.chosen.as_ref() != Some(*now)
        };
        let now = trained_set(app).filter(is_new);
        if let Some(now) = now {
            write(&self.set, vec![now.name().to_owned()]);
            self.chosen = Some(now.clone());
        }
        if app.forms != self.values {
            write(&self.forms, app.forms.lines());
            self.values = app.forms.clone();
        }
    }
}
