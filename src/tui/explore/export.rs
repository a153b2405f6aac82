//! The prompts over the results: the filter of the list, and the name of a file.

use ratatui::layout::{Position, Rect};
use taxel_core::quote::{joined, shortened};
use taxel_files::formats::file::has_ending;
use taxel_files::formats::value::grouped;
use taxel_files::storage::{Existing, atlas_path, is_poses};

use crate::tui::app::{
    App, Canvas, Flow, Message, Page, Place, Placed, Wheel, inform, refuse, write_file,
};
use crate::tui::explore::imprints::ImprintList;
use crate::tui::explore::name_of;
use crate::tui::explore::results::{Results, TABS, tab_area};
use crate::tui::explore::work::export;
use crate::tui::keys::{Context, Keymap};
use crate::tui::widget::{Role, TextField};

const LONGEST_FILTER: usize = 200;

/// The prompt for a filter. The list follows what is typed; a filter that cannot be read leaves it as it is.
pub(crate) struct FilterDialog {
    field: TextField,
    before: ImprintList,
    kept: Result<String, String>,
}

impl FilterDialog {
    pub(super) fn new(results: &Results) -> Self {
        let before = results.list.clone();
        let mut field = TextField::new(before.filter.as_str(), LONGEST_FILTER);
        if !before.filter.is_empty() {
            field.enter();
        }
        let kept = Ok(results.kept_of_all());
        Self {
            field,
            before,
            kept,
        }
    }
}

impl Page for FilterDialog {
    /// The prompt stays open until the filter can be read.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let Some(results) = app.top_mut::<Results>() else {
            return Flow::Close;
        };
        if matches!(message, Message::Cancel | Message::Quit) {
            results.list.clone_from(&self.before);
            return Flow::Close;
        }
        let accepts = *message == Message::Accept;
        if accepts || self.field.take(message) {
            let kept = results.list.keep(self.field.text(), &results.findings);
            let kept = kept.map_err(|error| error.to_string());
            self.kept = kept.map(|()| results.kept_of_all());
        }
        match &self.kept {
            _ if !accepts => {}
            Ok(kept) => {
                inform(app, format!("{kept} imprints"));
                return Flow::Close;
            }
            Err(reason) => refuse(app, reason.clone()),
        }
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Filter, Place::Prompt, Wheel::Idle)
    }

    /// The list has to be restored.
    fn cancels_itself(&self) -> bool {
        true
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let kept = match &self.kept {
            _ if self.field.text().trim().is_empty() => {
                "   such as na>=40 holes=0; empty shows all".to_owned()
            }
            Ok(kept) => format!("   {kept}"),
            Err(_) => String::new(),
        };
        Some(canvas.prompt(area, "Filter: ", &self.field, &kept))
    }

    fn remark(&self, _keymap: &Keymap, _body: Rect) -> Option<(String, Role)> {
        let reason = self.kept.as_ref().err()?;
        Some((format!("! {reason}"), Role::Error))
    }
}

const LONGEST_NAME: usize = 4096;

/// The prompt for a file. Its ending says what is written: the table or the drawing of the open tab, all imprints, or
/// all poses.
pub(crate) struct ExportDialog {
    field: TextField,
    endings: Vec<&'static str>,
    label: &'static str,
    has_table: bool,
}

impl ExportDialog {
    /// Proposes the tab's drawing or table if it has one, otherwise the table of all imprints.
    pub(super) fn new(results: &Results) -> Self {
        let (tab, sweep) = (results.tab(), results.sweep());
        // A slash would separate folders.
        let what = name_of(sweep.grid.source()).replace('/', "-");
        let (name, label) = match (tab.drawing, tab.table) {
            (Some(_), _) => (format!("{what}-{}.svg", tab.title), "Export to: "),
            (_, Some(_)) => (format!("{what}-{}.csv", tab.title), "Export to: "),
            // Says "all", because all imprints are written even if their list is filtered.
            _ => (format!("{what}.csv"), "Export all imprints to: "),
        };
        let mut field = TextField::new(name, LONGEST_NAME);
        field.enter();
        let mut endings = vec![".csv", ".jsonl", ".npz"];
        endings.extend(sweep.complete().then_some(".npy"));
        endings.extend(tab.drawing.map(|_| ".svg"));
        Self {
            field,
            endings,
            label,
            has_table: tab.table.is_some(),
        }
    }

    fn name(&self) -> Result<String, String> {
        let name = self.field.text().trim();
        if is_poses(name) || has_ending(name, "svg") || atlas_path(name).is_ok() {
            return Ok(name.to_owned());
        }
        let endings = joined(self.endings.iter().copied(), "or");
        let expected = format!("expected a name that ends in {endings}");
        Err(match name {
            "" => expected,
            name => format!("{:?}: {expected}", shortened(name)),
        })
    }
}

impl Page for ExportDialog {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        if *message != Message::Accept {
            self.field.take(message);
            return Flow::Stay;
        }
        match self.name() {
            Ok(name) => Flow::ask(|app| write_to(app, name)),
            Err(reason) => {
                refuse(app, reason);
                Flow::Stay
            }
        }
    }

    fn placed(&self) -> Placed {
        (Context::Export, Place::Prompt, Wheel::Idle)
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let endings = self.endings.join(" ");
        let endings = match endings.split_once(' ').filter(|_| self.has_table) {
            Some((table, others)) => format!("   ({table} page; {others} imprints)"),
            None => format!("   ({endings})"),
        };
        Some(canvas.prompt(area, self.label, &self.field, &endings))
    }
}

fn write_to(app: &mut App, name: String) {
    let Some(results) = app.page::<Results>() else {
        return;
    };
    let sweep = results.sweep();
    if is_poses(&name) && !sweep.complete() {
        let [done, all] = [sweep.poses, sweep.grid.poses()].map(grouped);
        let text = format!(".npy needs all poses: only {done} of {all} were swept");
        return refuse(app, text);
    }
    let tab = results.tab();
    let file = if has_ending(&name, "svg") {
        let Some(drawing) = tab.drawing else {
            let drawn = TABS.iter().filter(|tab| tab.drawing.is_some());
            let titles = drawn.map(|tab| tab.title).collect::<Vec<_>>().join(", ");
            let text = format!("this page has no drawing for .svg; {titles} have one");
            return refuse(app, text);
        };
        drawing(results).map(String::into_bytes)
    } else if let Some(table) = tab.table.filter(|_| has_ending(&name, "csv")) {
        Ok(table(results, tab_area(app, results)).into_bytes())
    } else {
        return export(app, name, Existing::Kept);
    };
    write_file(app, name, file, Existing::Kept);
}
