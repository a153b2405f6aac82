//! The imprint of the shown frame, which Enter puts onto the matrix.

use crate::formats::Name;
use crate::formats::recording::ChannelInfo;
use crate::parameter::Parameter;
use crate::sensor::Sensor;
use crate::tui::app::change::{begin, inform, refuse};
use crate::tui::app::document::Document;
use crate::tui::app::history::DocumentOrigin;
use crate::tui::app::state::App;
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::live::refusal::LiveRefusal;
use crate::tui::live::state::Live;

/// Returns the shown imprint as a drawn one; None without one. The sensor has the size of the frame, and its pitch in
/// mm if that is known and cells are square; otherwise the default pitch is kept, with which lengths are shown in
/// taxels only.
pub(super) fn document(page: &Live) -> Option<Document> {
    let imprint = page.reading()?.imprint?;
    let sensor = Sensor::of_size(imprint.size());
    let channel = page.status().channel.as_deref();
    let pitch = channel.and_then(ChannelInfo::square_pitch_mm);
    let scaled = pitch.and_then(|pitch| sensor.with(Parameter::Pitch, pitch).ok());
    Some(Document::drawn(scaled.unwrap_or(sensor), imprint))
}

/// Puts the imprint onto the matrix; the source keeps running. The imprint counts as unsaved, because no source sends
/// the same frame again. If the recording gives the size of its cells but lengths are not in mm, the notice says why.
pub(super) fn take(app: &mut App, page: Box<Live>, document: Document) {
    let number = page.reading().map(|reading| reading.frame.number);
    let channel = page.status().channel.as_deref();
    let without_mm = channel.and_then(ChannelInfo::why_not_in_mm);
    let source = page.request().name();
    app.live = Some(page);
    let frame = number.map_or("a frame".to_owned(), |number| format!("frame {number}"));
    let brought_by = format!("imprint of {frame}, {source}");
    // Not every source has a name that a shape may have.
    let stem = source.rsplit_once('.').map_or(&*source, |(stem, _)| stem);
    let named = Name::new(&format!("{frame} of {stem}"));
    let proposed = named.map_or_else(|_| frame.clone(), |name| name.to_string());
    let origin = DocumentOrigin::unsaved(&document)
        .called(brought_by)
        .proposing(proposed);
    begin(app, origin, document);
    let back = app.key_of(&action::WATCH);
    let mut text = format!("the imprint of {frame}; {back} goes back to the source");
    if let Some(reason) = without_mm {
        text += &format!("; {reason}");
    }
    inform(app, text);
}

pub(super) fn refuse_imprint(app: &mut App, page: &Live) {
    let key = app.keymap().label(Context::Live, &action::THRESHOLD_UP);
    let text = match page.no_imprint() {
        refusal @ LiveRefusal::NoThreshold => format!("{refusal}; {key} sets one"),
        refusal => refusal.to_string(),
    };
    refuse(app, text);
}
