//! The panel: the descriptors of the chosen region.
//!
//! ```text
//! Region 1 of 2: exterior
//! NA     36                                    symbol, value, and where there is room:
//! P      16.97            8.49 mm              the value in millimetres if a pitch is set,
//! xg     5.5              centroid, x          otherwise the name of the descriptor
//! ```
//! The rows are [`DESCRIPTORS`]. If the pane is low, they are shown in several columns, each as wide as its values if
//! space is scarce.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use taxel_core::description::{DESCRIPTORS, Description, Descriptor, Value};
use taxel_files::formats::value;

use crate::tui::matrix::view::MatrixView;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

const SYMBOL: usize = 7;
const VALUE: usize = 17;

const VALUE_IN_ASCII: usize = 19;

pub fn draw(matrix: &MatrixView<'_>, theme: &Theme, buffer: &mut Buffer, area: Rect) {
    let (seen, chosen) = (matrix.reading, matrix.chosen);
    let described = seen.region(chosen).zip(seen.description(chosen));
    // The text after the title is plain like the values, so that little changes here when a taxel is toggled.
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
    for (cells, column) in cells.chunks(lines).zip(columns) {
        for (index, cell) in cells.iter().enumerate() {
            let row = write::row(column.area, index);
            cell.draw(theme, matrix.pitch_mm, column.symbol, buffer, row);
        }
    }
}

struct PanelColumn {
    area: Rect,
    symbol: usize,
}

/// Returns the number of lines of the panel's columns, and the columns. They are equally wide if all values fit;
/// otherwise each is as wide as it needs to be, with as many lines as all of them need.
fn columns(cells: &[PanelCell], area: Rect) -> (usize, Vec<PanelColumn>) {
    let most = usize::from(area.height).max(1);
    let count = cells.len().div_ceil(most);
    // The columns are equally long: a single descriptor in the last one would look misplaced.
    let even = cells.len().div_ceil(count);
    let width = usize::from(area.width) / count;
    let needed = |cells: &[PanelCell], symbol: usize| {
        let values = cells.iter().map(|cell| write::width(&cell.text));
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
    // The gap after the last column may be cut off.
    let fits = |columns: &[(usize, usize)]| {
        columns.iter().map(|(width, _)| width).sum::<usize>() <= usize::from(area.width) + 1
    };
    let mut all = (even..=most).map(|lines| (lines, own(lines)));
    let fitting = all.find(|(_, columns)| fits(columns));
    let (lines, widths) = fitting.unwrap_or_else(|| (even, own(even)));
    (lines, placed(area, &widths))
}

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

struct PanelCell<'a> {
    descriptor: &'static Descriptor,
    description: Option<&'a Description>,
    measured: Value,
    text: String,
}

impl<'a> PanelCell<'a> {
    fn of(
        theme: &Theme,
        descriptor: &'static Descriptor,
        description: Option<&'a Description>,
    ) -> Self {
        let measured = description.map_or(descriptor.of_nothing, descriptor.measure);
        let text = value::text(measured, descriptor.dimension);
        let shown = text
            .as_deref()
            .map_or(theme.none().into(), |text| theme.text(text));
        Self {
            descriptor,
            description,
            measured,
            text: shown.into_owned(),
        }
    }

    fn draw(&self, theme: &Theme, pitch_mm: f64, symbols: usize, buffer: &mut Buffer, row: Rect) {
        let (descriptor, description) = (self.descriptor, self.description);
        // The value in millimetres if the user gave a pitch; a pitch of 1 would only repeat the value.
        let scaled = value::in_millimetres(self.measured, descriptor.dimension, pitch_mm)
            .filter(|_| pitch_mm != 1.0);
        let symbol = format!("{:symbols$}", descriptor.symbol);
        let width = if theme.ascii { VALUE_IN_ASCII } else { VALUE };
        let name = description.map_or(descriptor.name, |described| {
            descriptor.name_of(described.kind)
        });
        // Shortened names say nothing, and names of only some descriptors would look as if the others had none.
        let rest = usize::from(row.width).saturating_sub(symbols);
        let room = rest.saturating_sub(width);
        let named = DESCRIPTORS.iter().all(|own| write::width(own.name) <= room);
        let (remark, width) = match scaled.as_deref() {
            // Where the column of remarks is too narrow, the remark ends at the edge.
            Some(scaled) => {
                let end = rest.saturating_sub(write::width(scaled));
                let fits = write::width(&self.text) + 2 <= end;
                (if fits { scaled } else { "" }, width.min(end))
            }
            None if named && write::width(name) <= room => (name, width),
            None => ("", width),
        };
        let value = format!("{:width$}", self.text);
        // If the value needs more room, the remark is shortened.
        let gap = if self.text.chars().count() < width {
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
