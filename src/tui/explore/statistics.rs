//! The tabs of numbers: statistics of all descriptors, and the histogram of the chosen one.
//!
//! ```text
//! 175 distinct up to shifts, 105 up to quarter turns and mirror images too
//! poses cut off by the sensor: 316  without imprint: 32
//! 1 of 23                     min   mean    max     sd     the number of the chosen descriptor, and columns
//! > NA (na)                     1 22.405     29 7.3052     a row for each descriptor
//! ```
//!
//! ```text
//! NA (na): active taxels                               the descriptor and its unit
//! mean 52.3  sd 1.2  min 49  max 56  no value: 0 poses
//! 49 |██                      1,204   0.12 %           an interval, a bar, poses, their share
//! 50 |█████▌                  3,611   0.36 %
//! ```
//! Counts with few values have a bar for each value, everything else has one for each interval of round width. The
//! bar of a value that occurs is at least half a character long.

use ratatui::layout::{Position, Rect};
use taxel_core::atlas::{Histogram, STATISTIC_COLUMNS, features};
use taxel_core::description::Dimension;
use taxel_files::formats::value::{counted, grouped, percentage};

use crate::tui::app::{Canvas, Message, Wheel};
use crate::tui::explore::results::{Results, Tab, choose_descriptor, described, named, row_style};
use crate::tui::keys::Context;
use crate::tui::widget::write::{below, row};
use crate::tui::widget::{ListRows, Role};

const NAME: usize = 24;

pub(super) static STATISTICS: Tab = Tab {
    title: "statistics",
    context: Context::Statistics,
    wheel: Wheel::Rows,
    draw: draw_statistics,
    click: |results, area, at| Some(Message::Select(rows(area, results).at(at)?)),
    on: choose_descriptor,
};

pub(super) static HISTOGRAM: Tab = Tab {
    title: "histogram",
    context: Context::Histogram,
    wheel: Wheel::Step,
    draw: draw_histogram,
    click: |_, _, _| None,
    on: choose_descriptor,
};

fn rows(area: Rect, results: &Results) -> ListRows {
    ListRows::around(below(area, 3), features().len(), results.chosen.number)
}

/// Returns the position of the chosen descriptor.
fn draw_statistics(results: &Results, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
    let (sweep, classes) = (results.sweep(), &results.findings.classes);
    let [shifts, symmetry] = [classes.up_to_shifts, classes.up_to_symmetry];
    let [shifts, symmetry] = [shifts, symmetry].map(|count| grouped(count as u64));
    let text = format!(
        "{shifts} distinct up to shifts, {symmetry} up to quarter turns and mirror images too"
    );
    canvas.text(area, &text, Role::Text);
    let [cut, empty] = [sweep.partly_off, sweep.atlas.empty_poses()].map(grouped);
    let text = format!("poses cut off by the sensor: {cut}  without imprint: {empty}");
    canvas.text(row(area, 1), &text, Role::Text);
    let (rows, chosen, all) = (rows(area, results), results.chosen.number, features().len());
    // All columns fit into 80 characters.
    let room = usize::from(area.width).saturating_sub(NAME);
    let width = (room / STATISTIC_COLUMNS.len()).clamp(7, 10);
    let is_cut = usize::from(rows.area.height) < all;
    let number = is_cut.then(|| format!("{} of {all}", chosen + 1));
    let mut headings = format!("{:NAME$}", number.unwrap_or_default());
    for column in STATISTIC_COLUMNS {
        let title: String = column.title.chars().take(width - 1).collect();
        headings += &format!("{title:>width$}");
    }
    canvas.text(row(area, 2), &headings, Role::Title);
    for (index, line, statistic) in rows.visible(sweep.statistics.iter()) {
        let (sign, role) = row_style(index == chosen);
        let name = format!("{:width$}", named(statistic.feature), width = NAME - 2);
        let mut values = String::new();
        for column in STATISTIC_COLUMNS {
            let text = canvas.theme.number((column.value)(statistic), width - 1);
            values += &format!("{text:>width$}");
        }
        canvas.line(
            line,
            [(sign, Role::Key), (&*name, role), (&*values, Role::Text)],
        );
    }
    rows.position(chosen)
}

/// Three lines of the tab have no bar: the title, the numbers, and a spare one.
fn histogram(results: &Results, area: Rect) -> Histogram {
    let room = usize::from(area.height.saturating_sub(3)).max(1);
    let (atlas, chosen) = (&results.sweep().atlas, &results.chosen);
    Histogram::of(atlas, chosen.feature(), &chosen.values, room)
}

fn draw_histogram(results: &Results, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
    let (feature, histogram) = (results.chosen.feature(), histogram(results, area));
    let unit = match feature.descriptor.dimension {
        Dimension::Count => "",
        Dimension::Length => ", cells",
        Dimension::Area => ", taxels",
        Dimension::Direction => ", degrees",
        _ => ", ratio",
    };
    canvas.text(area, &(described(feature) + unit), Role::Title);
    let statistic = &results.sweep().statistics[results.chosen.number];
    let numbers = [statistic.mean, statistic.sd, statistic.min, statistic.max];
    let [mean, sd, min, max] = numbers.map(|value| canvas.theme.number(value, 9));
    let without = counted(histogram.without, "pose");
    let text = format!("mean {mean}  sd {sd}  min {min}  max {max}  no value: {without}");
    canvas.text(row(area, 1), &text, Role::Text);
    if histogram.poses.is_empty() {
        let text = format!("{}  no pose has a value", canvas.theme.none());
        canvas.text(row(area, 2), &text, Role::Quiet);
    }
    let unit = feature.descriptor.dimension;
    bars(&mut canvas, &histogram, unit, below(area, 2));
    None
}

fn bars(canvas: &mut Canvas<'_>, histogram: &Histogram, unit: Dimension, area: Rect) {
    let (bins, decimals) = (histogram.poses.len(), histogram.decimals());
    // Counts are whole, so an interval shows its last value. Other values show the start of the next interval, and
    // the last interval its end.
    let label = |bin: usize| {
        let (from, to) = (histogram.from(bin), histogram.from(bin + 1));
        match unit {
            Dimension::Count if histogram.width == 1.0 => format!("{from:.0}"),
            Dimension::Count => format!("{from:.0} to {:.0}", to - 1.0),
            _ if bin + 1 < bins => format!("{from:.decimals$} to <{to:.decimals$}"),
            _ => format!("{from:.decimals$} to  {to:.decimals$}"),
        }
    };
    let labels: Vec<String> = (0..bins).map(label).collect();
    let longest = labels.iter().map(String::len).fold(0, usize::max);
    let most = histogram.poses.iter().copied().fold(1, u64::max);
    let count = grouped(most).len();
    let all: u64 = histogram.poses.iter().sum::<u64>() + histogram.without;
    let room = usize::from(area.width).saturating_sub(longest + count + 12);
    let [full, half, _] = canvas.theme.bar();
    for (index, (label, &poses)) in labels.iter().zip(&histogram.poses).enumerate() {
        let halves = u128::from(poses) * 2 * room as u128 / u128::from(most);
        let halves = usize::try_from(halves).unwrap_or(2 * room);
        let halves = halves.max(usize::from(poses > 0));
        let mut bar = full.to_string().repeat(halves / 2);
        if halves % 2 == 1 && room > 0 {
            bar.push(half);
        }
        #[expect(clippy::cast_precision_loss, reason = "for reading")]
        let share = percentage(poses as f64 / all.max(1) as f64, 2);
        let label = format!("{label:>longest$} |");
        let numbers = format!(" {:>count$} {share:>6} %", grouped(poses));
        let pieces = [
            (label, Role::Quiet),
            (format!("{bar:room$}"), Role::Chosen),
            (numbers, Role::Text),
        ];
        let pieces = pieces.iter().map(|(text, role)| (text.as_str(), *role));
        canvas.line(row(area, index), pieces);
    }
}
