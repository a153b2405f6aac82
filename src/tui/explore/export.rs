//! The prompt for the name of the file that results are exported to. The extension decides the format.

use std::borrow::Cow;

use crate::formats::file::has_ending;
use crate::quote::{joined, shortened};
use crate::storage::{AtlasFile, is_poses};
use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::explore::results::Results;
use crate::tui::explore::tabs;
use crate::tui::keys::binding::Context;
use crate::tui::widget::text_field::TextField;

/// The maximum number of characters of a name: the longest path of a file on Linux.
const LONGEST: usize = 4096;

/// The kind of export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExportKind {
    /// Whether all poses were swept, so that they can be written too.
    poses: bool,
    /// Whether the tab has a drawing.
    drawing: bool,
    /// Whether a CSV file holds the table of the tab.
    table: bool,
}

impl ExportKind {
    /// Returns the kind of export of a sweep's results from the open tab.
    pub fn of(results: &Results) -> Self {
        let tab = tabs::row(results.tab());
        Self {
            poses: results.sweep().complete(),
            drawing: tab.drawing.is_some(),
            table: tab.table.is_some(),
        }
    }

    /// Returns the extensions that a name can have.
    fn endings(self) -> Vec<&'static str> {
        let poses: &[&str] = if self.poses { &[".npy"] } else { &[] };
        let drawings: &[&str] = if self.drawing { &[".svg"] } else { &[] };
        [&[".csv", ".jsonl", ".npz"], poses, drawings].concat()
    }

    /// Returns true if a file of that name can be made, at least on some tab.
    fn takes(name: &str) -> bool {
        is_poses(name) || has_ending(name, "svg") || AtlasFile::new(name).is_ok()
    }
}

/// The prompt for the name.
#[derive(Clone, Debug)]
pub struct ExportDialog {
    /// The typed text.
    pub field: TextField,
    /// The kind of export.
    pub what: ExportKind,
}

impl ExportDialog {
    /// Creates a prompt that proposes a name; typing replaces it.
    pub fn proposing(name: &str, what: ExportKind) -> Self {
        let mut dialog = Self::new(name, what);
        dialog.field.enter();
        dialog
    }

    /// Creates a prompt that starts with a name.
    pub fn new(name: &str, what: ExportKind) -> Self {
        Self {
            field: TextField::new(name, LONGEST),
            what,
        }
    }

    /// Returns the name of the file.
    ///
    /// # Errors
    /// Returns a message that says what is wrong with the name, and what was expected.
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

    /// Returns the extensions that a name can have.
    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        let endings = self.what.endings().join(" ");
        let has_page = self.what.table;
        match endings.split_once(' ').filter(|_| has_page) {
            Some((table, others)) => format!("   ({table} page; {others} imprints)").into(),
            None => format!("   ({endings})").into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_decides_the_format() {
        let all = ExportKind {
            poses: true,
            drawing: true,
            table: false,
        };
        let name = |text: &str| ExportDialog::new(text, all).name();
        for good in ["a.csv", " a/b.jsonl ", "./c.npz", "poses.npy", "map.SVG"] {
            assert_eq!(name(good).as_deref(), Ok(good.trim()));
        }
        for bad in ["", "a", "a.txt", ".csv", "csv", "npy"] {
            let error = name(bad).expect_err("no format");
            assert!(
                error.contains("expected a name that ends in .csv"),
                "{error}"
            );
        }
        assert!(is_poses("a.npy") && !is_poses("a.csv") && !is_poses("npy"));
    }
}
