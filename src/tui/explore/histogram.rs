//! The histogram tab: how often each value of the chosen descriptor occurs.
//!
//! ```text
//! NA (na): active taxels                               the descriptor and its unit
//! mean 52.3  sd 1.2  min 49  max 56  no value: 0 poses
//! 49 |██                      1,204   0.12 %           an interval, a bar, poses, their share
//! 50 |█████▌                  3,611   0.36 %
//! ```
//! Counts with few values have a bar for each value, everything else has one for each interval of round width. The
//! bar of a value that occurs is at least half a character long.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::atlas::Histogram;
use taxel_core::description::Dimension;
use taxel_files::formats::value::{counted, grouped, percentage};

use crate::tui::app::page::Wheel;
use crate::tui::explore::results::{Results, Tab, choose_descriptor, described};
use crate::tui::keys::keymap::Context;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

pub(super) static TAB: Tab = Tab {
    title: "histogram",
    context: Context::Histogram,
    filtered: false,
    wheel: Wheel::Step,
    drawing: None,
    table: Some(table),
    draw,
    click: |_, _, _| None,
    on: choose_descriptor,
};

/// Three lines of the tab have no bar: the title, the numbers, and a spare one.
fn histogram(results: &Results, area: Rect) -> Histogram {
    let room = usize::from(area.height.saturating_sub(3)).max(1);
    let (atlas, chosen) = (&results.sweep().atlas, &results.chosen);
    Histogram::of(atlas, chosen.feature(), &chosen.values, room)
}

fn table(results: &Results, area: Rect) -> String {
    let histogram = histogram(results, area);
    let (key, decimals) = (&results.chosen.feature().key, histogram.decimals());
    let mut text = "descriptor,from,to,poses\n".to_owned();
    for (bin, poses) in histogram.poses.iter().enumerate() {
        let (from, to) = (histogram.from(bin), histogram.from(bin + 1));
        text += &format!("{key},{from:.decimals$},{to:.decimals$},{poses}\n");
    }
    if histogram.without > 0 {
        text += &format!("{key},,,{}\n", histogram.without);
    }
    text
}

fn draw(results: &Results, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let feature = results.chosen.feature();
    let statistic = &results.sweep().statistics[results.chosen.number];
    let unit = match feature.descriptor.dimension {
        Dimension::Count => "",
        Dimension::Length => ", cells",
        Dimension::Area => ", taxels",
        Dimension::Direction => ", degrees",
        _ => ", ratio",
    };
    let title = described(feature) + unit;
    write::text(buffer, area, theme, &title, Role::Title);
    let histogram = histogram(results, area);
    let number = |value| theme.number(value, 9);
    let facts = format!(
        "mean {}  sd {}  min {}  max {}  no value: {}",
        number(statistic.mean),
        number(statistic.sd),
        number(statistic.min),
        number(statistic.max),
        counted(histogram.without, "pose")
    );
    write::text(buffer, write::row(area, 1), theme, &facts, Role::Text);
    if histogram.poses.is_empty() {
        let text = format!("{}  no pose has a value", theme.none());
        write::text(buffer, write::row(area, 2), theme, &text, Role::Quiet);
    }
    let unit = feature.descriptor.dimension;
    bars(theme, &histogram, unit, buffer, write::below(area, 2));
    None
}

fn bars(theme: &Theme, histogram: &Histogram, unit: Dimension, buffer: &mut Buffer, area: Rect) {
    let decimals = histogram.decimals();
    let single = unit == Dimension::Count && histogram.width == 1.0;
    let bins = histogram.poses.len();
    // Counts are whole, so an interval shows its last value. Other values show the start of the next interval, and
    // the last interval its end.
    let label = |bin: usize| {
        let (from, to) = (histogram.from(bin), histogram.from(bin + 1));
        match unit {
            _ if single => format!("{from:.0}"),
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
    let [full, half, _] = theme.bar();
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
        let pieces = [
            (&*format!("{label:>longest$} |"), Role::Quiet),
            (&*format!("{bar:room$}"), Role::Chosen),
            (
                &*format!(" {:>count$} {share:>6} %", grouped(poses)),
                Role::Text,
            ),
        ];
        write::line(buffer, write::row(area, index), theme, pieces);
    }
}
