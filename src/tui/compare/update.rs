//! The effects of messages over two imprints that are compared.

use crate::tui::app::change::refuse;
use crate::tui::app::dialog::Dialog;
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::page::Page;
use crate::tui::app::state::App;
use crate::tui::compare::page::Comparison;
use crate::tui::keys::key::Arrow;
use crate::tui::runtime::effect::Effect;

pub(in crate::tui) fn in_comparison(
    app: &mut App,
    mut page: Comparison,
    message: &Message,
) -> Option<Effect> {
    let by = match *message {
        Message::Scroll(lines) => Some((0, lines)),
        Message::ScrollTo(Endpoint::First) => Some((0, i16::MIN)),
        Message::ScrollTo(Endpoint::Last) => Some((0, i16::MAX)),
        Message::Choose(Arrow::Left) => Some((-1, 0)),
        Message::Choose(Arrow::Right) => Some((1, 0)),
        _ => None,
    };
    if let Some(panes) = app.panes() {
        let area = panes.area(page.slot());
        if let Message::Field(by) = *message {
            page.next_view(by, area.width);
        } else if let Some(by) = by
            && !page.scroll(by, area)
        {
            refuse(app, "all of it is visible");
        }
    }
    app.dialogs.push(Dialog::Compare(page));
    None
}
