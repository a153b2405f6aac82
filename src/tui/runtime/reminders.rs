//! What is remembered from run to run: commands, and the set that was recognised by.

use taxel_files::formats::Name;
use taxel_files::storage::{Library, ModelChoice, RememberedFile};

use crate::tui::app::state::App;
use crate::tui::jobs::answer;

/// Scripts and recorded runs remember nothing, so that they do the same every time.
#[derive(Debug)]
pub(crate) struct Reminders {
    commands: RememberedFile,
    remembered: usize,
    set: RememberedFile,
    chosen: Option<ModelChoice>,
}

impl Reminders {
    pub(crate) fn of(library: &Library) -> Self {
        Self {
            commands: RememberedFile::commands(library),
            remembered: 0,
            set: RememberedFile::recognised_set(library),
            chosen: None,
        }
    }

    pub(crate) fn remind(&mut self, app: &mut App) {
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
    pub(crate) fn note(&mut self, app: &App) -> Vec<(RememberedFile, Vec<String>)> {
        let mut remembered = Vec::new();
        if let Some(new @ [_, ..]) = app.commands.get(self.remembered..) {
            let (file, new) = (self.commands.clone(), new.to_vec());
            remembered.push((file, new));
            self.remembered = app.commands.len();
        }
        let is_new = |now: &&ModelChoice| {
            !matches!(now, ModelChoice::File(_)) && self.chosen.as_ref() != Some(*now)
        };
        let trained = app.recognition.model();
        let now = trained.map(|trained| &trained.choice).filter(is_new);
        if let Some(now) = now {
            let name = vec![now.name().to_owned()];
            remembered.push((self.set.clone(), name));
            self.chosen = Some(now.clone());
        }
        remembered
    }
}

/// Gives the program what earlier runs remembered.
pub(crate) fn remind(app: &mut App) {
    if let Some(mut reminders) = app.jobs.reminders.take() {
        reminders.remind(app);
        app.jobs.reminders = Some(reminders);
    }
}

pub(crate) fn remember(app: &mut App) {
    let Some(mut reminders) = app.jobs.reminders.take() else {
        return;
    };
    for (file, lines) in reminders.note(app) {
        app.jobs.disk("Remembering it", move |_| {
            file.add(lines);
            answer(|_| {})
        });
    }
    app.jobs.reminders = Some(reminders);
}
