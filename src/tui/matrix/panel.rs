//! The panel: the descriptors of the chosen region.
//!
//! ```text
//! Region 1 of 2: exterior
//! NA     36                                    symbol, value, and where there is room:
//! P      16.97            8.49 mm              the value in millimetres if a pitch is set,
//! xg     5.5              centroid, x          otherwise the name of the descriptor
//! ```
//! The rows are those of [`DESCRIPTORS`]. A low pane shows them in several columns, each as wide as its values where room is
//! scarce; where even so not all have room, the first ones are whole, and the last line says how many are missing.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::description::{DESCRIPTORS, Description, Descriptor};
use crate::formats::value;
use crate::tui::matrix::view::MatrixView;
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// Columns of the symbols.
const SYMBOL: usize = 7;
/// Columns of the values.
const VALUE: usize = 17;

/// The same in ASCII, where the longest is `120.96, 59.04 deg`.
const VALUE_IN_ASCII: usize = 19;

/// Draws the panel. Where it has fewer lines than there are descriptors, they stand in several columns.
pub fn draw(matrix: &MatrixView<'_>, theme: &Theme, buffer: &mut Buffer, area: Rect) {
    let (seen, chosen) = (matrix.reading, matrix.chosen);
    let described = seen.region(chosen).zip(seen.description(chosen));
    // What follows is plain as the values, so that a toggle changes little here.
    let (title, which) = match &described {
        Some(((index, region), _)) => {
            let (number, kind) = (index + 1, region.kind().name());
            let all = seen.regions.len();
            ("Region ", format!("{number} of {all}: {kind}"))
        }
        None => ("The matrix is empty", String::new()),
    };
    let heading = [(title, Role::Title), (which.as_str(), Role::Text)];
    write::line(buffer, area, theme, heading);
    let description = described.as_ref().map(|(_, description)| description);
    let cells: Vec<PanelCell> = DESCRIPTORS
        .iter()
        .map(|descriptor| PanelCell::of(theme, descriptor, description))
        .collect();
    let below = write::below(area, 1);
    let (lines, columns) = columns(&cells, below);
    let missing = cells.len().saturating_sub(lines * columns.len());
    if missing > 0 {
        let texts = [
            format!("and {missing} more on a larger screen"),
            format!("and {missing} more"),
        ];
        let texts = texts.each_ref().map(String::as_str);
        let text = write::first_fitting(&texts, below.width.into());
        write::line(
            buffer,
            write::row(below, lines),
            theme,
            [(text, Role::Quiet)],
        );
    }
    for (cells, column) in cells.chunks(lines).zip(columns) {
        for (index, cell) in cells.iter().enumerate() {
            let row = write::row(column.area, index);
            cell.draw(theme, matrix.pitch_mm, column.symbol, buffer, row);
        }
    }
}

/// A column of the panel.
struct PanelColumn {
    /// Where it is.
    area: Rect,
    /// Columns of the screen that its symbols have.
    symbol: usize,
}

/// How many lines the columns of the panel have, and where they are. They are equally wide where all values fit so; else
/// each is as wide as its own need, with as many lines as there must be for all of them to fit. Where there are too few
/// lines for that, the last line stays free, and only the first columns are there.
fn columns(cells: &[PanelCell], area: Rect) -> (usize, Vec<PanelColumn>) {
    let most = usize::from(area.height).max(1);
    let count = cells.len().div_ceil(most);
    // As many in each column: one alone in the last would look forgotten.
    let even = cells.len().div_ceil(count);
    let width = usize::from(area.width) / count;
    let needed = |cells: &[PanelCell], symbol: usize| {
        let values = cells.iter().map(|cell| write::width(&cell.value));
        symbol + values.fold(0, usize::max)
    };
    if count == 1 || needed(cells, SYMBOL) < width {
        return (even, placed(area, &vec![(width, SYMBOL); count]));
    }
    let own = |lines: usize| {
        let columns = cells.chunks(lines).map(|cells| {
            let symbols = cells
                .iter()
                .map(|cell| write::width(cell.descriptor.symbol));
            let symbol = symbols.fold(0, usize::max) + 1;
            (needed(cells, symbol) + 1, symbol)
        });
        columns.collect::<Vec<_>>()
    };
    // The gap behind the last one may be cut.
    let fits = |columns: &[(usize, usize)]| {
        columns.iter().map(|(width, _)| width).sum::<usize>() <= usize::from(area.width) + 1
    };
    let mut all = (even..=most).map(|lines| (lines, own(lines)));
    let fitting = all.find(|(_, columns)| fits(columns));
    let (lines, widths) = fitting.unwrap_or_else(|| {
        let lines = most.saturating_sub(1).max(1);
        let mut columns = own(lines);
        while columns.len() > 1 && !fits(&columns) {
            columns.pop();
        }
        (lines, columns)
    });
    (lines, placed(area, &widths))
}

/// Columns of these widths side by side, each with the width of its symbols.
fn placed(area: Rect, widths: &[(usize, usize)]) -> Vec<PanelColumn> {
    let mut x = area.x;
    let columns = widths.iter().map(|&(width, symbol)| {
        let rest = write::right_of(area, x);
        let width = narrow(width).min(rest.width);
        x = x.saturating_add(width);
        PanelColumn {
            area: Rect { width, ..rest },
            symbol,
        }
    });
    columns.collect()
}

/// A descriptor with its value.
struct PanelCell<'a> {
    /// Which one it is.
    descriptor: &'static Descriptor,
    /// What the value is of; None of an empty matrix.
    description: Option<&'a Description>,
    /// The value as text.
    value: String,
}

impl<'a> PanelCell<'a> {
    /// That of a description.
    fn of(
        theme: &Theme,
        descriptor: &'static Descriptor,
        description: Option<&'a Description>,
    ) -> Self {
        let measured = description.map_or(descriptor.of_nothing, descriptor.measure);
        let text = value::text(measured, descriptor.dimension);
        let value = text
            .as_deref()
            .map_or(theme.none().into(), |text| theme.text(text));
        Self {
            descriptor,
            description,
            value: value.into_owned(),
        }
    }

    /// Draws it: its symbol, its value, and what that is in millimetres or what it means, as far as there is room.
    fn draw(&self, theme: &Theme, pitch_mm: f64, symbols: usize, buffer: &mut Buffer, row: Rect) {
        let (descriptor, description) = (self.descriptor, self.description);
        let measured = description.map_or(descriptor.of_nothing, descriptor.measure);
        // Millimetres where the user gave a pitch; a pitch of 1 says nothing new.
        let scaled = value::in_millimetres(measured, descriptor.dimension, pitch_mm)
            .filter(|_| pitch_mm != 1.0);
        let symbol = format!("{:symbols$}", descriptor.symbol);
        let width = if theme.ascii { VALUE_IN_ASCII } else { VALUE };
        let value = format!("{:width$}", self.value);
        let name = description.map_or(descriptor.name, |described| {
            descriptor.name_of(described.kind)
        });
        // A word that is cut tells nothing, and names of some descriptors only look as if the others had none.
        let room = usize::from(row.width).saturating_sub(symbols + width);
        let named = DESCRIPTORS.iter().all(|own| write::width(own.name) <= room);
        let remark = match scaled.as_deref() {
            Some(scaled) if write::width(scaled) <= room => scaled,
            None if named && write::width(name) <= room => name,
            _ => "",
        };
        // Where the value needs more room, the remark gives way.
        let gap = if self.value.chars().count() < width {
            ""
        } else {
            "  "
        };
        let pieces = [
            (symbol.as_str(), Role::Key),
            (value.as_str(), Role::Text),
            (gap, Role::Text),
            (remark, Role::Quiet),
        ];
        write::line(buffer, row, theme, pieces);
    }
}
