//! The keys of the matrix that can do something now: hints leave the others out.

use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::work::explored;

/// Returns true unless the matrix would refuse a message. Only messages of keys with a hint are looked at. One without
/// an arm here keeps its hint, as on a page ([`crate::tui::app::page::Page::has_use_for`]): if it is refused, its key
/// says why.
pub(in crate::tui) fn is_usable(app: &App, message: &Message) -> bool {
    match message {
        Message::Undo => !app.removed.is_empty() || app.history.can_undo(),
        // With a single region, the key brings it into sight.
        Message::Region(_) => !app.reading().regions.is_empty(),
        Message::Explore(ExploreMessage::Open) => explored(app).is_some(),
        // A drawing has neither coverage nor a position.
        Message::Display | Message::Hold | Message::Turn(_) | Message::NudgeStep(_) => {
            app.history.present().source.is_some()
        }
        _ => true,
    }
}
