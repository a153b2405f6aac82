//! Statistics of every descriptor, a row each, and how many poses and imprints there are.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::atlas::{STATISTIC_COLUMNS, features};
use crate::formats::value::{fitting, grouped};
use crate::tui::app::state::App;
use crate::tui::explore::results::Results;
use crate::tui::explore::statistics::layout::StatisticsTable;
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// Draws the page; answers where the chosen descriptor is.
pub fn draw(app: &App, results: &Results, buffer: &mut Buffer, page: Rect) -> Option<Position> {
    let theme = app.theme();
    let table = StatisticsTable::of(page, results);
    for (index, total) in totals(results).iter().enumerate() {
        let row = write::row(table.totals, index);
        write::line(buffer, row, theme, [(total.as_str(), Role::Text)]);
    }
    let (first, visible) = table.columns;
    let (name, width) = (table.name, table.column);
    let columns = || STATISTIC_COLUMNS.iter().skip(first).take(visible);
    let mut headings = format!("{:name$}", head(&table, results));
    for column in columns() {
        let title: String = column.title.chars().take(width - 1).collect();
        headings += &format!("{title:>width$}");
    }
    write::line(
        buffer,
        table.head,
        theme,
        [(headings.as_str(), Role::Title)],
    );
    let mut cursor = None;
    let statistics = results.sweep().statistics.iter().enumerate();
    let rows = statistics.skip(table.first).take(table.rows.height.into());
    for (index, statistic) in rows {
        let row = write::row(table.rows, index - table.first);
        let chosen = index == results.feature_number();
        let sign = if chosen { "> " } else { "  " };
        let key = format!("{:width$}", statistic.feature.key, width = name - 2);
        let mut values = String::new();
        for column in columns() {
            let value = (column.value)(statistic);
            let text = value.map_or_else(
                || theme.none().to_owned(),
                |value| fitting(value, width - 1),
            );
            values += &format!("{text:>width$}");
        }
        let role = if chosen { Role::Focus } else { Role::Text };
        let pieces = [
            (sign, Role::Key),
            (key.as_str(), role),
            (values.as_str(), Role::Text),
        ];
        write::line(buffer, row, theme, pieces);
        if chosen {
            cursor = Some(Position::new(row.x, row.y));
        }
    }
    cursor
}

/// Which row is chosen where not all can be seen, and to which side there are columns that do not fit.
fn head(table: &StatisticsTable, results: &Results) -> String {
    let (first, visible) = table.columns;
    let all = features().len();
    let row = if usize::from(table.rows.height) < all {
        format!("{} of {all} ", results.feature_number() + 1)
    } else {
        String::new()
    };
    let columns = match (first > 0, first + visible < STATISTIC_COLUMNS.len()) {
        (false, false) => "",
        (false, true) => "more >",
        (true, false) => "< more",
        (true, true) => "< more >",
    };
    row + columns
}

/// Poses and imprints.
fn totals(results: &Results) -> [String; 2] {
    let findings = results.findings();
    let (result, (shifts, symmetry)) = (&findings.sweep, findings.classes);
    let many = |count: usize| grouped(count as u64);
    [
        format!(
            "distinct up to shifts: {}  and up to turns and mirrors: {}",
            many(shifts),
            many(symmetry)
        ),
        format!(
            "poses partly off the sensor: {}  without imprint: {}",
            grouped(result.partly_off),
            grouped(result.atlas.empty_poses())
        ),
    ]
}
