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

const LONGEST: usize = 4096;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExportKind {
    /// Whether all poses were swept, so that they can be written too.
    poses: bool,
    drawing: bool,
    table: bool,
}

impl ExportKind {
    pub fn of(results: &Results) -> Self {
        let tab = tabs::row(results.tab());
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
        is_poses(name) || has_ending(name, "svg") || AtlasFile::new(name).is_ok()
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
            field: TextField::new(name, LONGEST),
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
