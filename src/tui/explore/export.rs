//! The prompt for the name of the file that results are exported to. The ending decides the format.

use std::borrow::Cow;

use crate::quote::shortened;
use crate::storage::{AtlasFile, is_poses};
use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::explore::drawing::drawn_format;
use crate::tui::explore::page::is_csv;
use crate::tui::explore::pages;
use crate::tui::explore::results::Results;
use crate::tui::keys::binding::Context;
use crate::tui::widget::text_field::TextField;

/// No name is longer: that of a Linux file with its folders.
const LONGEST: usize = 4096;

/// What is exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExportKind {
    /// The imprints of a sweep.
    Sweep {
        /// Whether all poses were swept, so that they can be written too.
        poses: bool,
        /// Whether the page has a drawing.
        drawing: bool,
        /// Whether a CSV file holds the table of the page.
        table: bool,
    },
    /// The error of a set against size.
    Curve,
}

impl ExportKind {
    /// What the results of a sweep can be written as from the page that is open.
    pub fn of(results: &Results) -> Self {
        let page = pages::row(results.page());
        Self::Sweep {
            poses: results.sweep().complete(),
            drawing: page.drawing.is_some(),
            table: page.table.is_some(),
        }
    }

    /// What a name can end in.
    fn endings(self) -> Vec<&'static str> {
        match self {
            Self::Sweep { poses, drawing, .. } => {
                let poses: &[&str] = if poses { &[".npy"] } else { &[] };
                let drawings: &[&str] = if drawing { &[".svg", ".png"] } else { &[] };
                [&[".csv", ".jsonl", ".npz"], poses, drawings].concat()
            }
            Self::Curve => vec![".csv", ".svg", ".png"],
        }
    }

    /// Whether a file of that name can be made, on some page at least.
    fn takes(self, name: &str) -> bool {
        match self {
            Self::Sweep { .. } => {
                is_poses(name) || drawn_format(name).is_some() || AtlasFile::new(name).is_ok()
            }
            Self::Curve => is_csv(name) || drawn_format(name).is_some(),
        }
    }
}

/// The field.
#[derive(Clone, Debug)]
pub struct ExportDialog {
    /// What was typed.
    pub field: TextField,
    /// What is exported.
    pub what: ExportKind,
}

impl ExportDialog {
    /// A field that proposes a name: what is typed replaces it.
    pub fn proposing(name: &str, what: ExportKind) -> Self {
        let mut dialog = Self::new(name, what);
        dialog.field.enter();
        dialog
    }

    /// A field that starts with a name.
    pub fn new(name: &str, what: ExportKind) -> Self {
        Self {
            field: TextField::new(name, LONGEST),
            what,
        }
    }

    /// The name of the file.
    ///
    /// # Errors
    /// What is wrong with it, and what was expected.
    pub fn name(&self) -> Result<String, String> {
        let name = self.field.text().trim();
        if self.what.takes(name) {
            return Ok(name.to_owned());
        }
        let found = if name.is_empty() {
            String::new()
        } else {
            format!("{:?}: ", shortened(name))
        };
        let all = self.what.endings().join(", ");
        let endings = match all.rsplit_once(", ") {
            Some((others, last)) => format!("{others} or {last}"),
            None => all,
        };
        Err(format!("{found}expected a name that ends in {endings}"))
    }
}

impl LinePrompt for ExportDialog {
    const CONTEXT: Context = Context::Export;

    /// The list of imprints may be filtered, and still all are written.
    fn label(&self) -> &'static str {
        match self.what {
            ExportKind::Sweep {
                drawing: false,
                table: false,
                ..
            } => "Export all imprints to: ",
            _ => "Export to: ",
        }
    }

    fn field(&self) -> &TextField {
        &self.field
    }

    /// What a name can end in.
    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        let endings = self.what.endings();
        if let (ExportKind::Sweep { table: true, .. }, [table, others @ ..]) =
            (self.what, &endings[..])
        {
            return format!("   ({table} page; {} imprints)", others.join(" ")).into();
        }
        format!("   ({})", endings.join(" ")).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_tells_the_format() {
        let all = ExportKind::Sweep {
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
