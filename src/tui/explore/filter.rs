//! The prompt for a filter: the conditions that imprints in the list must meet. The list follows as you type.
//!
//! ```text
//! Filter: na>=40 holes=0   312 of 4,102        how many imprints the filter keeps
//! Filter: na>=40 weight<3                      an error is shown above the line
//! ```

use std::borrow::Cow;

use crate::atlas::{AtlasFilter, FilterError};
use crate::formats::value::grouped;
use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::explore::results::Results;
use crate::tui::keys::binding::Context;
use crate::tui::widget::text_field::TextField;

const LONGEST: usize = 200;

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
        let mut field = TextField::new(results.list.filter(), LONGEST);
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
