//! Lines, rows and widths that the pages have in common.

use crate::pose::{Axis, PoseGrid};

/// The first row that is visible: rows are shown page by page, so that what is clicked on stays where it is.
pub(in crate::tui) fn first(visible: usize, selected: usize) -> usize {
    selected - selected % visible.max(1)
}

/// Characters of the values of a range, and of its name.
pub(in crate::tui) fn width_of(grid: &PoseGrid, axis: Axis) -> usize {
    let (range, parameter) = (grid.ranges()[axis], axis.parameter());
    let ends = [range.value(0), range.value(1), range.last()];
    let widths = ends.map(|value| parameter.format(value).len());
    widths
        .into_iter()
        .fold(parameter.row().short.len(), usize::max)
}
