//! Files that the screen opens and writes, and what is remembered from run to run.

pub(crate) mod disk;


pub use crate::tui::jobs::Jobs as World;
pub use crate::tui::live::source::check as check_source;

use crate::tui::app::state::App;
use crate::tui::jobs::Jobs;
use crate::tui::live::source;

/// Finishes changes and recordings and writes unsaved work at once, because the program is about to end. Returns lines
/// about everything that is not on the disk.
pub fn end(app: &mut App) -> Vec<String> {
    source::stop(app);
    let mut lines = Jobs::finish(app);
    if !lines.is_empty() && !app.unsaved_work().is_empty() {
        lines.push("the next start offers it as unsaved work\n".to_owned());
    }
    lines
}

/// Writes everything out because the program is about to be stopped, perhaps for ever. Everything goes on when it is
/// continued.
pub fn flush(app: &mut App) -> Vec<String> {
    source::flush(app);
    Jobs::finish(app)
}
