//! The statistics tab.
//!
//! ```text
//! 175 distinct up to shifts, 105 up to quarter turns and mirror images too
//! poses cut off by the sensor: 316  without imprint: 32
//! 1 of 23              min   mean    max     sd        the number of the chosen descriptor, and columns
//! > na                   1 22.405     29 7.3052        a row for each descriptor
//! ```
//! The columns are [`STATISTIC_COLUMNS`]. The descriptor that is chosen here is also the one of the histogram and of the list of imprints.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::atlas::{STATISTIC_COLUMNS, features};
use taxel_files::formats::value::grouped;

use crate::tui::app::message::Message;
use crate::tui::app::page::Wheel;
use crate::tui::explore::results::Results;
use crate::tui::explore::view::{ResultsTab, choose_descriptor};
use crate::tui::keys::keymap::Context;
use crate::tui::widget::rows::ListRows;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, below};

pub static TAB: ResultsTab = ResultsTab {
    title: "statistics",
    context: Context::Statistics,
    filtered: false,
    drawing: None,
    table: Some(table),
    wheel: Wheel::Rows,
    draw,
    click: |results, area, at| {
        let row = StatisticsTable::of(area, results).rows.at(at)?;
        Some(Message::Select(row))
    },
    update: choose_descriptor,
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

#[derive(Clone, Copy, Debug)]
pub struct StatisticsTable {
    pub totals: Rect,
    pub head: Rect,
    pub rows: ListRows,
    pub name: usize,
    pub column: usize,
}

impl StatisticsTable {
    pub fn of(area: Rect, results: &Results) -> Self {
        let (name, count) = (17, STATISTIC_COLUMNS.len());
        let room = usize::from(area.width).saturating_sub(name);
        // Eight columns fit into 80 characters.
        let column = (room / count).clamp(7, 10);
        let totals = Rect {
            height: area.height.min(2),
            ..area
        };
        let table = below(area, totals.height);
        let rows = below(table, 1);
        Self {
            totals,
            head: Rect {
                height: table.height.min(1),
                ..table
            },
            rows: ListRows::around(rows, features().len(), results.feature),
            name,
            column,
        }
    }
}

/// Returns the position of the chosen descriptor.
fn draw(results: &Results, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let table = StatisticsTable::of(area, results);
    for (index, total) in totals(results).iter().enumerate() {
        let row = write::row(table.totals, index);
        write::text(buffer, row, theme, total, Role::Text);
    }
    let (name, width) = (table.name, table.column);
    let mut headings = format!("{:name$}", head(&table, results));
    for column in STATISTIC_COLUMNS {
        let title: String = column.title.chars().take(width - 1).collect();
        headings += &format!("{title:>width$}");
    }
    write::text(buffer, table.head, theme, &headings, Role::Title);
    for (index, row, statistic) in table.rows.visible(results.sweep().statistics.iter()) {
        let chosen = index == results.feature;
        let sign = if chosen { "> " } else { "  " };
        let key = format!("{:width$}", statistic.feature.key, width = name - 2);
        let mut values = String::new();
        for column in STATISTIC_COLUMNS {
            let text = theme.number((column.value)(statistic), width - 1);
            values += &format!("{text:>width$}");
        }
        let role = if chosen { Role::Focus } else { Role::Text };
        let pieces = [
            (sign, Role::Key),
            (key.as_str(), role),
            (values.as_str(), Role::Text),
        ];
        write::line(buffer, row, theme, pieces);
    }
    table.rows.position(results.feature)
}

/// Returns the number of the chosen descriptor where not all of them are visible.
fn head(table: &StatisticsTable, results: &Results) -> String {
    let all = features().len();
    if usize::from(table.rows.area.height) >= all {
        return String::new();
    }
    format!("{} of {all} ", results.feature + 1)
}

fn totals(results: &Results) -> [String; 2] {
    let findings = &results.findings;
    let (result, classes) = (&findings.sweep, findings.classes);
    let (shifts, symmetry) = (classes.up_to_shifts, classes.up_to_symmetry);
    let many = |count: usize| grouped(count as u64);
    [
        format!(
            "{} distinct up to shifts, {} up to quarter turns and mirror images too",
            many(shifts),
            many(symmetry)
        ),
        format!(
            "poses cut off by the sensor: {}  without imprint: {}",
            grouped(result.partly_off),
            grouped(result.atlas.empty_poses())
        ),
    ]
}
