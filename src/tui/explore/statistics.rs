//! The statistics tab.
//!
//! ```text
//! 175 distinct up to shifts, 105 up to quarter turns and mirror images too
//! poses cut off by the sensor: 316  without imprint: 32
//! 1 of 23                     min   mean    max     sd     the number of the chosen descriptor, and columns
//! > NA (na)                     1 22.405     29 7.3052     a row for each descriptor
//! ```
//! The chosen descriptor is also that of the other tabs.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::atlas::{STATISTIC_COLUMNS, features};
use taxel_files::formats::value::grouped;

use crate::tui::app::message::Message;
use crate::tui::app::page::Wheel;
use crate::tui::explore::results::{Results, Tab, choose_descriptor, named, row_style};
use crate::tui::keys::keymap::Context;
use crate::tui::widget::rows::ListRows;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, below};

const NAME: usize = 24;

pub(super) static TAB: Tab = Tab {
    title: "statistics",
    context: Context::Statistics,
    filtered: false,
    wheel: Wheel::Rows,
    drawing: None,
    table: Some(table),
    draw,
    click: |results, area, at| Some(Message::Select(rows(area, results).at(at)?)),
    on: choose_descriptor,
};

fn table(results: &Results, _area: Rect) -> String {
    let keys = STATISTIC_COLUMNS.iter().map(|column| column.key);
    let mut text = format!("descriptor,{}\n", keys.collect::<Vec<_>>().join(","));
    for statistic in &results.sweep().statistics {
        text += &statistic.feature.key;
        for column in STATISTIC_COLUMNS {
            let value = (column.value)(statistic);
            text += &value.map_or_else(|| ",".to_owned(), |value| format!(",{value}"));
        }
        text.push('\n');
    }
    text
}

fn rows(area: Rect, results: &Results) -> ListRows {
    ListRows::around(below(area, 3), features().len(), results.chosen.number)
}

/// Returns the position of the chosen descriptor.
fn draw(results: &Results, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let (sweep, classes) = (results.sweep(), &results.findings.classes);
    let totals = [
        format!(
            "{} distinct up to shifts, {} up to quarter turns and mirror images too",
            grouped(classes.up_to_shifts as u64),
            grouped(classes.up_to_symmetry as u64)
        ),
        format!(
            "poses cut off by the sensor: {}  without imprint: {}",
            grouped(sweep.partly_off),
            grouped(sweep.atlas.empty_poses())
        ),
    ];
    for (index, total) in totals.iter().enumerate() {
        write::text(buffer, write::row(area, index), theme, total, Role::Text);
    }
    let rows = rows(area, results);
    // All columns fit into 80 characters.
    let room = usize::from(area.width).saturating_sub(NAME);
    let width = (room / STATISTIC_COLUMNS.len()).clamp(7, 10);
    let (number, all) = (results.chosen.number + 1, features().len());
    let is_cut = usize::from(rows.area.height) < all;
    let number = is_cut.then(|| format!("{number} of {all}"));
    let mut headings = format!("{:NAME$}", number.unwrap_or_default());
    for column in STATISTIC_COLUMNS {
        let title: String = column.title.chars().take(width - 1).collect();
        headings += &format!("{title:>width$}");
    }
    write::text(buffer, write::row(area, 2), theme, &headings, Role::Title);
    for (index, row, statistic) in rows.visible(sweep.statistics.iter()) {
        let (sign, role) = row_style(index == results.chosen.number);
        let name = format!("{:width$}", named(statistic.feature), width = NAME - 2);
        let values = STATISTIC_COLUMNS.iter().map(|column| {
            let text = theme.number((column.value)(statistic), width - 1);
            format!("{text:>width$}")
        });
        let values: String = values.collect();
        let pieces = [(sign, Role::Key), (&*name, role), (&*values, Role::Text)];
        write::line(buffer, row, theme, pieces);
    }
    rows.position(results.chosen.number)
}
