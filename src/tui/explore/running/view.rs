//! Work under way: a gauge, how fast it goes, how long it will take.

use std::time::Duration;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::formats::value::{counted, grouped};
use crate::tui::app::state::App;
use crate::tui::explore::message::name_of;
use crate::tui::explore::ranges::view::about;
use crate::tui::explore::running::state::{Running, WorkKind};
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// The gauge is no wider.
const WIDEST: u16 = 60;

/// Draws it in a pane of its own.
pub fn draw(app: &App, running: &Running, buffer: &mut Buffer, area: Rect) {
    let theme = app.theme();
    write::clear(buffer, area);
    let inner = write::right_of(area, area.x.saturating_add(2));
    let (title, end) = match &running.job {
        WorkKind::Sweep(grid) => (
            format!("Exploring: {}", name_of(grid.source())),
            "stop keeps what is complete",
        ),
        WorkKind::Write(name, _) => (format!("Writing {name}"), "stop leaves nothing behind"),
    };
    // On a low screen what matters most comes first.
    let spaced = usize::from(area.height >= 9);
    let row = |index: usize| write::row(inner, index * (1 + spaced));
    write::line(buffer, row(0), theme, [(title.as_str(), Role::Title)]);
    let done = running.progress.map_or(0, |progress| progress.poses);
    if let Some(all) = running.poses() {
        let percent = u128::from(done) * 100 / u128::from(all.max(1));
        let all_of_them = counted(all, "pose");
        let text = format!("{} of {all_of_them}, {percent} %", grouped(done));
        write::line(buffer, row(1), theme, [(text.as_str(), Role::Text)]);
        gauge(app, done, all, buffer, row(2));
    }
    let time = speed(running);
    write::line(buffer, row(3), theme, [(time.as_str(), Role::Text)]);
    let end = if running.stopping { "stopping" } else { end };
    write::line(buffer, row(4), theme, [(end, Role::Quiet)]);
}

/// A bar as long as what is done.
fn gauge(app: &App, done: u64, all: u64, buffer: &mut Buffer, row: Rect) {
    let [full, _, empty] = app.theme().bar();
    let width = row.width.min(WIDEST);
    let filled = u128::from(done) * u128::from(width) / u128::from(all.max(1));
    let filled = u16::try_from(filled).unwrap_or(width).min(width);
    let text = |character: char, count: u16| character.to_string().repeat(count.into());
    let (done, rest) = (text(full, filled), text(empty, width - filled));
    let pieces = [(done.as_str(), Role::Chosen), (rest.as_str(), Role::Quiet)];
    write::line(buffer, row, app.theme(), pieces);
}

/// Poses a second, and the time that is left; nothing before that can be told.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
fn speed(running: &Running) -> String {
    let Some(rate) = running.rate() else {
        return String::new();
    };
    let left = running
        .left()
        .and_then(|left| Duration::try_from_secs_f64(left).ok());
    let left = left.map_or(String::new(), |left| format!(", {} left", about(left)));
    format!("{} poses a second{left}", grouped(rate as u64))
}
