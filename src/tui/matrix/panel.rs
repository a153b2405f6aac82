//! The panel: the descriptors of the chosen region.
//!
//! ```text
//! Region 1 of 2: exterior
//! NA     36                                    symbol, value, and where there is room:
//! P      16.97            8.49 mm              the value in millimetres if a pitch is set,
//! xg     5.5              centroid, x          otherwise the name of the descriptor
//! Ratio (side_ratio)  1.29                     on a wide screen its key, as in JSON, follows the symbol
//! ```
//! If the pane is low, the rows stand in several columns.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use taxel_core::description::{DESCRIPTORS, Description, Descriptor};
use taxel_files::formats::value;

use crate::tui::app::App;
use crate::tui::widget::write::{self, narrow};
use crate::tui::widget::{Role, Theme};

const SYMBOL: usize = 7;
const SYMBOL_AND_KEY: usize = 23;
const NAME: usize = 18;

pub fn draw(app: &App, buffer: &mut Buffer, area: Rect) {
    let (theme, reading) = (&app.theme, app.reading());
    // The text after the title is plain like the values, so that little changes here when a taxel is toggled.
    let (title, which) = match reading.region(app.chosen()) {
        Some((index, region)) => {
            let (kind, all) = (region.kind().name(), reading.regions.len());
            ("Region ", format!("{} of {all}: {kind}", index + 1))
        }
        None => ("The matrix is empty", String::new()),
    };
    let heading = [(title, Role::Title), (which.as_str(), Role::Text)];
    write::line(buffer, area, theme, heading);
    let description = reading.description(app.chosen());
    let pitch_mm = app.shown().sensor.pitch_mm();
    let below = write::below(area, 1);
    let columns = DESCRIPTORS.len().div_ceil(usize::from(below.height).max(1));
    // The columns are equally long: a single descriptor in the last one would look misplaced.
    let lines = DESCRIPTORS.len().div_ceil(columns);
    let width = area.width / narrow(columns).max(1);
    for (index, descriptor) in DESCRIPTORS.iter().enumerate() {
        let row = Rect {
            x: area.x + narrow(index / lines) * width,
            width,
            ..write::row(below, index % lines)
        };
        let (region, row) = (description.as_ref(), row.intersection(area));
        draw_row(theme, descriptor, region, pitch_mm, buffer, row);
    }
}

fn draw_row(
    theme: &Theme,
    descriptor: &Descriptor,
    description: Option<&Description>,
    pitch_mm: f64,
    buffer: &mut Buffer,
    row: Rect,
) {
    let measured = description.map_or(descriptor.of_nothing, descriptor.measure);
    let text = value::text(measured, descriptor.dimension);
    let text = text
        .as_deref()
        .map_or(theme.none().into(), |text| theme.text(text));
    let (room, most) = (usize::from(row.width), if theme.ascii { 19 } else { 17 });
    let is_wide = room >= SYMBOL_AND_KEY + most + NAME;
    let symbol = if is_wide { SYMBOL_AND_KEY } else { SYMBOL };
    let label = if is_wide && !descriptor.symbol.eq_ignore_ascii_case(descriptor.key) {
        format!("{} ({})", descriptor.symbol, descriptor.key)
    } else {
        descriptor.symbol.to_owned()
    };
    let room = room.saturating_sub(symbol);
    // A pitch of 1 would only repeat the value.
    let scaled = value::in_millimetres(measured, descriptor.dimension, pitch_mm);
    let named = room >= most + NAME;
    let name = description.map_or(descriptor.name, |own| descriptor.name_of(own.kind));
    let remark = match scaled.as_deref().filter(|_| pitch_mm != 1.0) {
        Some(scaled) => scaled,
        None if named => name,
        None => "",
    };
    let least = write::width(&text) + 1;
    let width = most.min(room.saturating_sub(write::width(remark)));
    let (label, value) = (format!("{label:symbol$}"), format!("{text:width$}"));
    let pieces = [
        (label.as_str(), Role::Key),
        (value.as_str(), Role::Text),
        (if least <= width { remark } else { "" }, Role::Quiet),
    ];
    write::line(buffer, row, theme, pieces);
}
