//! Lines, rows and widths that the pages have in common.

use crate::parameter::Parameter;
use crate::pose::PoseGrid;

/// The first row that is visible: rows are shown page by page, so that what is clicked on stays where it is.
pub(in crate::tui) fn first(visible: usize, selected: usize) -> usize {
    selected - selected % visible.max(1)
}

/// Characters of the values of a range, and of its name.
pub(in crate::tui) fn width_of(grid: &PoseGrid, parameter: Parameter) -> usize {
    let rows = grid.ranges().by_parameter();
    let range = rows.iter().find(|(own, _)| *own == parameter);
    let width = range.map_or(0, |(_, range)| {
        let ends = [range.value(0), range.value(1), range.last()];
        let widths = ends.map(|value| parameter.format(value).len());
        widths.into_iter().max().unwrap_or(0)
    });
    width.max(parameter.row().short.len())
}
