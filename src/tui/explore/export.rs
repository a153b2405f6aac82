//! The prompt for the name of the file that results are exported to. The ending decides the format.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::quote::shortened;
use crate::storage::{AtlasFile, is_poses};
use crate::tui::app::page::{Page, Slot};
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::Theme;
use crate::tui::widget::write;

/// No name is longer: that of a Linux file with its folders.
const LONGEST: usize = 4096;

/// The label of the field.
const LABEL: &str = "Export to: ";

/// What a name can end in.
const ENDINGS: &str = ".csv, .jsonl, .npz or .npy";

/// The field.
#[derive(Clone, Debug)]
pub struct ExportDialog {
    /// What was typed.
    pub field: TextField,
}

impl ExportDialog {
    /// A field that proposes a name: what is typed replaces it.
    pub fn proposing(name: &str) -> Self {
        let mut dialog = Self::new(name);
        dialog.field.enter();
        dialog
    }

    /// A field that starts with a name.
    pub fn new(name: &str) -> Self {
        Self {
            field: TextField::new(name, LONGEST),
        }
    }

    /// The name of the file.
    ///
    /// # Errors
    /// What is wrong with it, and what was expected.
    pub fn name(&self) -> Result<String, String> {
        let name = self.field.text().trim();
        if is_poses(name) || AtlasFile::new(name).is_ok() {
            return Ok(name.to_owned());
        }
        let found = if name.is_empty() {
            String::new()
        } else {
            format!("{:?}: ", shortened(name))
        };
        Err(format!("{found}expected a name that ends in {ENDINGS}"))
    }
}

impl Page for ExportDialog {
    fn context(&self) -> Context {
        Context::Export
    }

    fn slot(&self) -> Slot {
        Slot::Prompt
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let endings = format!("   ({ENDINGS})");
        Some(write::prompt(
            buffer,
            area,
            theme,
            LABEL,
            &self.field,
            &endings,
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_tells_the_form() {
        let name = |text: &str| ExportDialog::new(text).name();
        for good in ["a.csv", " a/b.jsonl ", "./c.npz", "poses.npy"] {
            assert_eq!(name(good).as_deref(), Ok(good.trim()));
        }
        for bad in ["", "a", "a.txt", ".csv", "csv", "npy"] {
            let error = name(bad).expect_err("no form");
            assert!(
                error.contains("expected a name that ends in .csv"),
                "{error}"
            );
        }
        assert!(is_poses("a.npy") && !is_poses("a.csv") && !is_poses("npy"));
    }
}
