//! The values that a run remembers for the next one: commands, and the set of shapes that was recognised last.
//!
//! Scripts and recorded runs remember nothing, so that they do the same every time.

use crate::formats::Name;
use crate::storage::ModelChoice;
use crate::storage::{Library, RememberedFile};
use crate::tui::app::state::App;
use crate::tui::runtime::disk::queue::DiskQueue;
use crate::tui::runtime::disk::request::DiskRequest;

#[derive(Debug)]
pub(in crate::tui::runtime) struct Reminders {
    commands: RememberedFile,
    remembered: usize,
    set: RememberedFile,
    chosen: Option<ModelChoice>,
}

impl Reminders {
    pub(in crate::tui::runtime) fn of(library: &Library) -> Self {
        Self {
            commands: RememberedFile::commands(library),
            remembered: 0,
            set: RememberedFile::recognised_set(library),
            chosen: None,
        }
    }

    pub(in crate::tui::runtime) fn remind(&mut self, app: &mut App) {
        app.commands = self.commands.read();
        self.remembered = app.commands.len();
        let set = self.set.read().pop();
        self.chosen = set
            .and_then(|name| Name::new(&name).ok())
            .map(ModelChoice::from_name);
        if let Some(own) = &self.chosen {
            app.recognition.begin_with(own.clone());
        }
    }

    /// Remembers everything new. A set is remembered once its model is ready, so that it surely exists. A model from
    /// a file is not, since the next run may begin in another folder.
    pub(in crate::tui::runtime) fn note(&mut self, app: &App, queue: &mut DiskQueue) {
        if let Some(new @ [_, ..]) = app.commands.get(self.remembered..) {
            let (file, new) = (self.commands.clone(), new.to_vec());
            queue.begin(DiskRequest::RememberMore(file, new));
            self.remembered = app.commands.len();
        }
        let is_new = |now: &&ModelChoice| {
            !matches!(now, ModelChoice::File(_)) && self.chosen.as_ref() != Some(*now)
        };
        let trained = app.recognition.trained();
        let now = trained.map(|trained| &trained.choice).filter(is_new);
        if let Some(now) = now {
            let name = vec![now.name().to_owned()];
            queue.begin(DiskRequest::Remember(self.set.clone(), name));
            self.chosen = Some(now.clone());
        }
    }
}
