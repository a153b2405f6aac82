//! The prompt for a filter: the conditions that imprints in the list must meet. The list follows as you type.
//!
//! ```text
//! Filter: na>=40 holes=0   312 of 4,102        how many it keeps
//! Filter: na>=40 weight<3                      what is wrong with it stands above the line
//! ```

use std::borrow::Cow;

use crate::atlas::{AtlasFilter, FilterError};
use crate::formats::value::grouped;
use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::explore::results::Results;
use crate::tui::keys::binding::Context;
use crate::tui::widget::text_field::TextField;

/// Nobody types a longer one.
const LONGEST: usize = 200;

/// What stands behind an empty field.
const EXAMPLE: &str = "   such as na>=40 holes=0; empty shows all";

/// The field, and what becomes of the list if it is left.
#[derive(Clone, Debug)]
pub struct FilterDialog {
    /// What was typed.
    pub field: TextField,
    /// The filter before, and the imprint that was selected.
    before: (String, Option<u32>),
    /// How many imprints are kept, of how many; or what is wrong with what was typed.
    kept: Result<(usize, usize), FilterError>,
}

impl FilterDialog {
    /// A field that starts with the filter of a list.
    pub fn new(results: &Results) -> Self {
        let selected = results.rows_from(results.selected()).next();
        let mut field = TextField::new(results.filter(), LONGEST);
        if !results.filter().is_empty() {
            field.enter();
        }
        Self {
            field,
            before: (
                results.filter().to_owned(),
                selected.map(|(_, entry)| entry.id),
            ),
            kept: Ok((results.row_count(), results.sweep().atlas.len())),
        }
    }

    /// Applies what was typed to a list; one that cannot be read leaves it as it is.
    pub fn apply(&mut self, results: &mut Results) {
        let typed = self.field.text();
        self.kept = typed.parse::<AtlasFilter>().map(|filter| {
            results.keep(typed, &filter);
            (results.row_count(), results.sweep().atlas.len())
        });
    }

    /// What is wrong with what was typed, None if nothing is.
    pub fn error(&self) -> Option<&FilterError> {
        self.kept.as_ref().err()
    }

    /// Gives a list the filter and the selected imprint that it had before.
    pub fn restore(&self, results: &mut Results) {
        let (typed, selected) = &self.before;
        if let Ok(filter) = typed.parse() {
            results.keep(typed, &filter);
        }
        if let Some(id) = selected {
            results.find(*id);
        }
    }
}

impl LinePrompt for FilterDialog {
    const CONTEXT: Context = Context::Filter;
    const RESTORES: bool = true;

    fn label(&self) -> &'static str {
        "Filter: "
    }

    fn field(&self) -> &TextField {
        &self.field
    }

    /// How many imprints it keeps.
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
