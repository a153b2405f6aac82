//! The type of a tab of the results of a sweep.
//!
//! A tab has no state of its own: [`Results`] holds the chosen descriptor, row and pose, so that all tabs agree on
//! them.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::message::Message;
use crate::tui::app::page::Wheel;
use crate::tui::explore::results::Results;
use crate::tui::keys::binding::Context;
use crate::tui::widget::rows::moved;
use crate::tui::widget::theme::Theme;

/// Draws a tab as SVG; a sentence says why there is no drawing.
type TabDrawing = fn(&Results) -> Result<String, String>;

/// The reason why a tab without any value has no drawing.
pub(super) const NOTHING_TO_DRAW: &str = "there is nothing to draw";

/// A tab of the results: what [`crate::tui::explore::tabs`] lists. The functions get the area of the tab.
#[derive(Debug)]
pub struct ResultsTab {
    /// The title on its tab.
    pub title: &'static str,
    /// The context in which its keys are looked up.
    pub context: Context,
    /// Whether it shows only the imprints that the filter keeps.
    pub filtered: bool,
    /// The same for a file: None for a tab that is a table.
    pub drawing: Option<TabDrawing>,
    /// Returns the numbers of the tab for a CSV file. The field is None for tabs with a drawing, and for the list of
    /// imprints, whose file has all imprints.
    pub table: Option<fn(&Results, Rect) -> String>,
    /// The effect of the mouse wheel.
    pub wheel: Wheel,
    /// Draws the tab. Returns the position of the cursor; None if the tab has none.
    pub draw: fn(&Results, &Theme, &mut Buffer, Rect) -> Option<Position>,
    /// Returns the message of a click at a position.
    pub click: fn(&Results, Rect, Position) -> Option<Message>,
    /// Handles the messages whose meaning differs between tabs: to scroll, to select a row, to move a cursor.
    pub update: fn(&mut Results, &Message, Rect),
}

/// Handles a message on a tab whose rows are descriptors.
pub(in crate::tui) fn choose_descriptor(results: &mut Results, message: &Message, _area: Rect) {
    if let Some(row) = moved(results.feature_number(), message) {
        results.choose_feature(row);
    }
}
