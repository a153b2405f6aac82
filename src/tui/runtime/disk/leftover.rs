//! Describes unsaved work in a few words, by which its owner recognises it.

use std::time::Duration;

use crate::formats::value::counted;
use crate::source::Source;
use crate::storage::{Orphan, UNNAMED};
use crate::tui::explore::ranges::view::about;

/// Returns the name, the size and the age of the work: `hexagon side 4.00, 40 taxels, about 12 minutes ago`.
pub(in crate::tui::runtime) fn described(orphan: &Orphan) -> String {
    let shape = &orphan.shape;
    let called = match (shape.name.as_str(), &shape.source) {
        (UNNAMED, Some(Source::Figure(figure))) => Some(figure.kind_and_sizes()),
        (UNNAMED, Some(Source::Picture(picture))) => picture.name().map(str::to_owned),
        (UNNAMED, None) => None,
        (name, _) => Some(name.to_owned()),
    };
    let taxels = counted(shape.imprint.count(), "taxel");
    let pieces = [called, Some(taxels), orphan.age().map(ago)];
    pieces.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Returns how long ago something happened, in words. Within the first minute, seconds would say nothing useful.
fn ago(time: Duration) -> String {
    if time < Duration::from_secs(60) {
        "less than a minute ago".to_owned()
    } else {
        format!("{} ago", about(time))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_age_is_given_in_the_unit_that_fits() {
        let said = [0, 59, 60, 720, 400_000].map(|seconds| ago(Duration::from_secs(seconds)));
        assert_eq!(
            said,
            [
                "less than a minute ago",
                "less than a minute ago",
                "about 60 seconds ago",
                "about 12 minutes ago",
                "about 5 days ago",
            ]
        );
    }
}
