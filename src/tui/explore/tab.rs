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

type TabDrawing = fn(&Results) -> Result<String, String>;

pub(super) const NOTHING_TO_DRAW: &str = "there is nothing to draw";

/// The functions get the area of the tab.
#[derive(Debug)]
pub struct ResultsTab {
    pub title: &'static str,
    pub context: Context,
    pub filtered: bool,
    pub drawing: Option<TabDrawing>,
    /// The field is None for tabs with a drawing, and for the list of imprints, whose file has all imprints.
    pub table: Option<fn(&Results, Rect) -> String>,
    pub wheel: Wheel,
    pub draw: fn(&Results, &Theme, &mut Buffer, Rect) -> Option<Position>,
    pub click: fn(&Results, Rect, Position) -> Option<Message>,
    pub update: fn(&mut Results, &Message, Rect),
}

pub(in crate::tui) fn choose_descriptor(results: &mut Results, message: &Message, _area: Rect) {
    if let Some(row) = moved(results.feature_number(), message) {
        results.choose_feature(row);
    }
}
