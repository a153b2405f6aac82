//! `explore --x0 5:5.99:0.01 --angle 0:359:1 --anchor centre`: the command line's names for a sweep of what is on the
//! matrix.

use crate::pose::{Anchor, Axis, PoseGrid, RangeError, Ranges};
use crate::quote::shortened;
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::ranges::state::explored;

/// What the flags ask for; ranges that are not given are the defaults.
///
/// # Errors
/// What is wrong with them, in a sentence.
pub(in crate::tui) fn read(words: &[&str], app: &App) -> Result<Message, String> {
    let document = app.shown();
    let source = explored(&document).ok_or_else(|| app.nothing_to_explore())?;
    let (mut ranges, mut anchor) = (Ranges::default(), Anchor::default());
    let mut given: Vec<&str> = Vec::new();
    for pair in words.chunks(2) {
        let flag = pair.first().copied().unwrap_or_default();
        let name = flag
            .strip_prefix("--")
            .ok_or_else(|| format!("expected a flag like --x0, found {}", shortened(flag)))?;
        let text = pair
            .get(1)
            .ok_or_else(|| format!("{} needs a value", shortened(flag)))?;
        if given.contains(&flag) {
            return Err(format!("{flag} is given twice"));
        }
        given.push(flag);
        if name == "anchor" {
            anchor = Anchor::from_name(text).ok_or_else(|| {
                let names = Anchor::NAMES.join(" or ");
                format!("--anchor takes {names}, found {}", shortened(text))
            })?;
            continue;
        }
        let mut axes = Axis::ALL.into_iter();
        let axis = axes.find(|axis| axis.parameter().flag() == name);
        let axis = axis.ok_or_else(|| {
            format!(
                "{} is unknown, expected --x0, --y0, --angle, --zoom-x, --zoom-y or --anchor",
                shortened(flag)
            )
        })?;
        ranges[axis] = text
            .parse()
            .map_err(|error: RangeError| format!("{flag}: {error}"))?;
    }
    let grid = PoseGrid::new(source, document.sensor, anchor, ranges);
    let grid = grid.map_err(|error| error.to_string())?;
    Ok(Message::Explore(ExploreMessage::Start(Box::new(grid))))
}
