//! Handles messages in the prompts over the results: the filter of the list, and the letters of marks.

use std::borrow::Cow;

use taxel_core::atlas::{AtlasFilter, FilterError};
use taxel_core::quote::{joined, shortened};
use taxel_files::formats::file::has_ending;
use taxel_files::formats::value::grouped;
use taxel_files::storage::{atlas_path, is_poses};

use crate::tui::app::change::{inform, refuse};
use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, LinePrompt};
use crate::tui::app::state::App;
use crate::tui::explore::results::Results;
use crate::tui::explore::update::in_export;
use crate::tui::explore::view;
use crate::tui::keys::keymap::Context;
use crate::tui::widget::text_field::TextField;

const LONGEST_FILTER: usize = 200;

const EXAMPLE: &str = "   such as na>=40 holes=0; empty shows all";

#[derive(Clone, Debug)]
pub struct FilterDialog {
    pub field: TextField,
    before: (String, Option<u32>),
    kept: Result<(usize, usize), FilterError>,
}

impl FilterDialog {
    pub fn new(results: &Results) -> Self {
        let selected = results.rows_from(results.list.selected()).next();
        let mut field = TextField::new(results.list.filter(), LONGEST_FILTER);
        if !results.list.filter().is_empty() {
            field.enter();
        }
        Self {
            field,
            before: (
                results.list.filter().to_owned(),
                selected.map(|(_, entry)| entry.id),
            ),
            kept: Ok((results.list.row_count(), results.sweep().atlas.len())),
        }
    }

    /// Applies the typed filter to a list; a filter that cannot be read leaves the list as it is.
    pub fn apply(&mut self, results: &mut Results) {
        let typed = self.field.text();
        self.kept = typed.parse::<AtlasFilter>().map(|filter| {
            results.keep(typed, &filter);
            (results.list.row_count(), results.sweep().atlas.len())
        });
    }

    pub fn error(&self) -> Option<&FilterError> {
        self.kept.as_ref().err()
    }

    pub fn restore(&self, results: &mut Results) {
        let (typed, selected) = &self.before;
        if let Ok(filter) = typed.parse() {
            results.keep(typed, &filter);
        }
        if let Some(id) = selected {
            results.list.find(*id);
        }
    }
}

impl LinePrompt for FilterDialog {
    const CONTEXT: Context = Context::Filter;

    /// The prompt stays open until the filter can be read.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let Some(results) = app.top_mut::<Results>() else {
            return Flow::Close;
        };
        match message {
            Message::Cancel | Message::Quit => {
                self.restore(results);
                return Flow::Close;
            }
            Message::Accept => {
                self.apply(results);
                let Some(error) = self.error() else {
                    let kept = results.kept_of_all();
                    inform(app, format!("{kept} imprints"));
                    return Flow::Close;
                };
                let error = error.to_string();
                refuse(app, error);
            }
            message => {
                if self.field.take(message) {
                    self.apply(results);
                }
            }
        }
        Flow::Stay
    }
    const RESTORES: bool = true;

    fn label(&self) -> &'static str {
        "Filter: "
    }

    fn field(&self) -> &TextField {
        &self.field
    }

    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        let count = |count: usize| grouped(count as u64);
        match self.kept {
            _ if self.field.text().trim().is_empty() => EXAMPLE.into(),
            Ok((kept, all)) => format!("   {} of {}", count(kept), count(all)).into(),
            Err(_) => "".into(),
        }
    }

    fn wrong(&self) -> Option<String> {
        self.error().map(FilterError::to_string)
    }
}

const LONGEST_NAME: usize = 4096;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExportKind {
    /// Whether all poses were swept, so that they can be written too.
    poses: bool,
    drawing: bool,
    table: bool,
}

impl ExportKind {
    pub fn of(results: &Results) -> Self {
        let tab = view::row(results.tab);
        Self {
            poses: results.sweep().complete(),
            drawing: tab.drawing.is_some(),
            table: tab.table.is_some(),
        }
    }

    fn endings(self) -> Vec<&'static str> {
        let poses: &[&str] = if self.poses { &[".npy"] } else { &[] };
        let drawings: &[&str] = if self.drawing { &[".svg"] } else { &[] };
        [&[".csv", ".jsonl", ".npz"], poses, drawings].concat()
    }

    fn takes(name: &str) -> bool {
        is_poses(name) || has_ending(name, "svg") || atlas_path(name).is_ok()
    }
}

#[derive(Clone, Debug)]
pub struct ExportDialog {
    pub field: TextField,
    pub what: ExportKind,
}

impl ExportDialog {
    pub fn proposing(name: &str, what: ExportKind) -> Self {
        let mut dialog = Self::new(name, what);
        dialog.field.enter();
        dialog
    }

    pub fn new(name: &str, what: ExportKind) -> Self {
        Self {
            field: TextField::new(name, LONGEST_NAME),
            what,
        }
    }

    pub fn name(&self) -> Result<String, String> {
        let name = self.field.text().trim();
        if ExportKind::takes(name) {
            return Ok(name.to_owned());
        }
        let found = if name.is_empty() {
            String::new()
        } else {
            format!("{:?}: ", shortened(name))
        };
        let endings = joined(self.what.endings(), "or");
        Err(format!("{found}expected a name that ends in {endings}"))
    }
}

impl LinePrompt for ExportDialog {
    const CONTEXT: Context = Context::Export;

    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_export(self, app, message)
    }

    /// Says "all", because all imprints are written even if their list is filtered.
    fn label(&self) -> &'static str {
        if self.what.drawing || self.what.table {
            "Export to: "
        } else {
            "Export all imprints to: "
        }
    }

    fn field(&self) -> &TextField {
        &self.field
    }

    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        let endings = self.what.endings().join(" ");
        let has_page = self.what.table;
        match endings.split_once(' ').filter(|_| has_page) {
            Some((table, others)) => format!("   ({table} page; {others} imprints)").into(),
            None => format!("   ({endings})").into(),
        }
    }
}
