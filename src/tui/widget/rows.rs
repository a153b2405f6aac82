//! The selected row of a list.

use crate::tui::app::message::{Endpoint, Message};

/// Returns the row that a message selects if `row` is selected now; None if it selects no row. The result may lie
/// beyond the last row, since only the list knows how many rows there are.
pub fn moved(row: usize, message: &Message) -> Option<usize> {
    match *message {
        Message::Scroll(lines) => Some(row.saturating_add_signed(lines.into())),
        Message::ScrollTo(Endpoint::First) => Some(0),
        Message::ScrollTo(Endpoint::Last) => Some(usize::MAX),
        Message::Select(row) => Some(row),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moving_up_stops_at_the_first_row() {
        let moved = |message| moved(3, &message);
        assert_eq!(moved(Message::Scroll(-10)), Some(0));
        assert_eq!(moved(Message::Scroll(10)), Some(13));
        assert_eq!(moved(Message::ScrollTo(Endpoint::First)), Some(0));
        assert_eq!(moved(Message::Select(7)), Some(7));
        assert_eq!(moved(Message::Accept), None);
    }
}
