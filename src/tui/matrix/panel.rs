//! The panel: the descriptors of the chosen region.
//!
//! ```text
//! Region 1 of 2: exterior
//! NA     36                                    symbol, value, and where there is room:
//! P      16.97            8.49 mm              the value in millimetres if a pitch is set,
//! xg     5.5              centroid, x          otherwise the name of the descriptor
//! ```
//! The rows are those of [`DESCRIPTORS`]. A low pane shows them in several columns.

use std::sync::LazyLock;

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

/// Columns of the longest name of a descriptor.
static LONGEST_NAME: LazyLock<usize> = LazyLock::new(|| {
    let names = DESCRIPTORS.iter().map(|own| write::width(own.name));
    names.fold(0, usize::max)
});

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
    let lines = usize::from(area.height.saturating_sub(1)).max(1);
    let columns = DESCRIPTORS.len().div_ceil(lines);
    // As many in each column: one alone in the last would look forgotten.
    let lines = DESCRIPTORS.len().div_ceil(columns);
    let width = area.width / narrow(columns).max(1);
    for (index, descriptor) in DESCRIPTORS.iter().enumerate() {
        let column = narrow(index / lines).saturating_mul(width);
        let row = write::right_of(
            write::row(area, index % lines + 1),
            area.x.saturating_add(column),
        );
        let row = Rect {
            width: row.width.min(width),
            ..row
        };
        let description = described.as_ref().map(|(_, description)| description);
        draw_descriptor(theme, matrix.pitch_mm, descriptor, description, buffer, row);
    }
}

/// A descriptor: its symbol, its value, and what that is in millimetres or what it means, as far as there is room.
fn draw_descriptor(
    theme: &Theme,
    pitch_mm: f64,
    descriptor: &Descriptor,
    description: Option<&Description>,
    buffer: &mut Buffer,
    row: Rect,
) {
    let measured = description.map_or(descriptor.of_nothing, descriptor.measure);
    let text = value::text(measured, descriptor.dimension);
    let text = text
        .as_deref()
        .map_or(theme.none().into(), |text| theme.text(text));
    // Millimetres where the user gave a pitch; a pitch of 1 says nothing new.
    let scaled =
        value::in_millimetres(measured, descriptor.dimension, pitch_mm).filter(|_| pitch_mm != 1.0);
    let symbol = format!("{:SYMBOL$}", descriptor.symbol);
    let width = if theme.ascii { VALUE_IN_ASCII } else { VALUE };
    let value = format!("{text:width$}");
    let name = description.map_or(descriptor.name, |described| {
        descriptor.name_of(described.kind)
    });
    // A word that is cut tells nothing, and names of some descriptors only look as if the others had none.
    let room = usize::from(row.width).saturating_sub(SYMBOL + width);
    let named = *LONGEST_NAME <= room;
    let remark = match scaled.as_deref() {
        Some(scaled) if write::width(scaled) <= room => scaled,
        None if named && write::width(name) <= room => name,
        _ => "",
    };
    // Where the value needs more room, the remark gives way.
    let gap = if text.chars().count() < width {
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
