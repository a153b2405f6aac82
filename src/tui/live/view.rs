//! The look of the live page.
//!
//! ```text
//! mat.csv  frame 65 (label 66)  6.5 s  frozen, 3 frames behind
//! ░░▒▒▓▓██          range      0 ░▒▓█ 100 kPa
//! ░░▒▒▓▓••          force      1234 kPa on 5 taxels
//! force  0 to 2000  NA, NAE, P, F, CG …
//! ▄▄▄███▄
//! ```

use std::path::Path;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::description::Descriptor;
use taxel_core::frame::RuleOrigin;
use taxel_core::imprint::Imprint;
use taxel_files::formats::recording::FrameMark;
use taxel_files::formats::value::{self, counted, fitting, grouped, measured};

use crate::tui::app::{App, Canvas, Flow, Message, Page, Place, Placed, Wheel};
use crate::tui::keys::{Arrow, Context, Keymap, action};
use crate::tui::live::heat::{self, HeatMap, LivePanes, cells, scale};
use crate::tui::live::reading::{progress_text, rule_text};
use crate::tui::live::update::in_live;
use crate::tui::live::{HeatLayer, Live, LiveMessage, LiveReading, NO_FRAME, SourceState, trend};
use crate::tui::widget::{Role, Theme, write};

const LABEL: usize = 11;

/// The label of the answer of recognition.
pub(super) const SHAPE: &str = "shape";

/// Lines of the panel, each with its label.
pub(super) type Lines = Vec<(&'static str, String)>;

const SHOWN: [&str; 5] = ["na", "nae", "p", "f", "cg"];

/// The most marks that are listed, the newest ones.
const LISTED: usize = 20;

impl Page for Live {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_live(self, app, message)
    }

    /// The source of a page that is closed may be watched again.
    fn closed(self: Box<Self>, app: &mut App) {
        app.live = Some(self);
    }

    fn placed(&self) -> Placed {
        (Context::Live, Place::Screen, Wheel::Step)
    }

    fn cancels_itself(&self) -> bool {
        true
    }

    fn has_use_for(&self, message: &Message, area: Rect) -> bool {
        match message {
            Message::Live(LiveMessage::Window(_)) => hides_taxels(self, area),
            Message::Live(LiveMessage::Record) => {
                self.recording.name.is_some() || !self.status.state.is_final()
            }
            Message::Live(LiveMessage::Again) => self.check_again().is_ok(),
            _ => true,
        }
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let (theme, keymap, buffer) = (canvas.theme, canvas.keymap, canvas.buffer);
        let panes = panes(self, area);
        let map = self
            .shown_reading()
            .map(|own| HeatMap::of(self, own, theme, panes.map));
        let window = map.as_ref().and_then(HeatMap::window);
        draw_title(self, window, theme, buffer, panes.title);
        if let Some(map) = &map {
            map.draw(buffer);
        }
        let lines = lines(self, theme, keymap, map.as_ref().and_then(HeatMap::legend));
        let lines = with_whole_answer(lines, theme, panes.panel.width);
        let mut panel = panes.panel;
        if let Some((plot, rest)) = panes.plot(lines.len()).filter(|_| map.is_some()) {
            trend::draw(self, theme, buffer, plot);
            panel = rest;
        }
        draw_lines(&lines, theme, buffer, panel);
        None
    }

    fn remark(&self, keymap: &Keymap, _area: Rect) -> Option<(String, Role)> {
        let error = self.error().map(ToString::to_string);
        let troubles: Vec<String> = error.into_iter().chain(self.trouble()).collect();
        let text = match (&troubles[..], self.unseen_note()) {
            ([], Some(note)) => note.to_owned(),
            ([], None) => return Some((at_end(self, keymap)?, Role::Quiet)),
            (troubles, _) => troubles.join("; "),
        };
        Some((format!("! {text}"), Role::Error))
    }

    fn alarm(&self) -> Option<String> {
        self.trouble()
    }
}

impl Live {
    /// Returns the reading of the taxels that are drawn; None if only the panel is.
    fn shown_reading(&self) -> Option<&LiveReading> {
        self.reading.as_ref().filter(|_| !self.only_panel)
    }
}

/// Returns what can be done after the end of the source; None before it.
fn at_end(live: &Live, keymap: &Keymap) -> Option<String> {
    if live.status.state != SourceState::Ended {
        return None;
    }
    let key = |action| keymap.label(Context::Live, action);
    let (earlier, first) = (key(&action::SCROLL_UP), key(&action::FIRST));
    let (again, close) = (key(&action::WATCH_AGAIN), key(&action::CANCEL));
    let again = live.check_again().map(|()| format!("{again}: again, "));
    let again = again.unwrap_or_default();
    Some(format!(
        "ended; {earlier}: earlier frames, {first}: the first one, {again}{close}: close"
    ))
}

fn panes(live: &Live, area: Rect) -> LivePanes {
    let reading = live.shown_reading();
    LivePanes::of(area, reading.map(|reading| &reading.values), live.numbers)
}

/// Returns true if some taxels do not fit on a page of this area, although the heat map is shown.
fn hides_taxels(live: &Live, area: Rect) -> bool {
    live.shown_reading().is_some_and(|reading| {
        let map = panes(live, area).map;
        !heat::grid(map, &reading.values, live.numbers, (0, 0)).is_whole()
    })
}

/// Returns the taxel to look at to see hidden ones in a direction, on a page of this area; None if none are hidden
/// there.
pub(super) fn beyond(live: &Live, theme: &Theme, area: Rect, towards: Arrow) -> Option<(u8, u8)> {
    let map = HeatMap::of(live, live.shown_reading()?, theme, panes(live, area).map);
    map.beyond(towards, live)
}

/// Returns all lines of the panel, each with its label, the most important ones first. A low screen cuts them off at
/// the bottom, so lines about the touch come before lines about the source. `marks` is the legend of the mark on taxels.
fn lines(live: &Live, theme: &Theme, keymap: &Keymap, marks: Option<String>) -> Lines {
    let mut lines = Vec::new();
    if let Some(reading) = &live.reading {
        let shown = SHOWN.iter().filter_map(|key| Descriptor::from_key(key));
        lines.extend(shown.map(|own| (own.symbol, described(reading, own, theme))));
        lines.push(("regions", regions(reading)));
    }
    let imprint = live.reading.as_ref().and_then(|reading| reading.imprint);
    let any = imprint.is_some_and(|imprint| !imprint.is_empty());
    lines.extend(live.names.lines(any, theme));
    lines.push(("threshold", threshold(live, keymap)));
    lines.push(("tare", tare(live)));
    if let Some(reading) = &live.reading {
        lines.extend(of_values(live, reading, theme, marks));
    }
    let rate = live.rate().map(|rate| format!("{}/s", fitting(rate, 5)));
    lines.push(("rate", rate.unwrap_or_else(|| theme.none().to_owned())));
    lines.push(("dropped", dropped(live)));
    lines.push((
        "not drawn",
        grouped(live.not_drawn + live.status.overflowed),
    ));
    let gaps = live.status.gaps;
    if gaps.count > 0 {
        let (count, missing) = (grouped(gaps.count), value::decimal(gaps.missing, 1));
        lines.push(("gaps", format!("{count}, {missing} s missing")));
    }
    lines.extend(marked(live).map(|text| ("marked", text)));
    lines.extend(recording(live).map(|text| ("recording", text)));
    lines
}

/// Returns the last marked frames: those marked by keys, and those that were marked while the recording was made, which
/// it knows by their labels. None if no frame is marked.
fn marked(live: &Live) -> Option<String> {
    let text = |what, marks: &mut dyn DoubleEndedIterator<Item = &FrameMark>| {
        let numbers = marks.rev().map(|mark| mark.number.to_string());
        let numbers: Vec<String> = numbers.take(LISTED).collect();
        (!numbers.is_empty()).then(|| format!("{what} {}", numbers.join(", ")))
    };
    let own = text("frame", &mut live.marks.iter().map(|(_, mark)| mark));
    let recorded = text("label", &mut live.status.channel.marks.iter());
    let texts: Vec<String> = own.into_iter().chain(recorded).collect();
    (!texts.is_empty()).then(|| texts.join("; "))
}

/// Returns a descriptor of the imprint. An imprint without active taxels has counts of 0; without an imprint there is
/// no number.
fn described(reading: &LiveReading, descriptor: &Descriptor, theme: &Theme) -> String {
    let of_nothing = reading.imprint.map(|_| descriptor.of_nothing);
    let described = reading.description.as_ref().map(descriptor.measure);
    let measured = described.or(of_nothing);
    let text = measured.and_then(|measured| value::text(measured, descriptor.dimension));
    text.unwrap_or_else(|| theme.none().to_owned())
}

fn of_values(live: &Live, reading: &LiveReading, theme: &Theme, marks: Option<String>) -> Lines {
    let unit = live.unit();
    let ends = live.ends();
    // Small sums of large values are rounding errors, not measured values.
    let value = if ends.1 < 0.1 { measured } else { fitting };
    let contact = counted(reading.contact, "taxel");
    let force = format!("{}{unit} on {contact}", value(reading.force, 9));
    let mut lines = vec![("force", force), ("range", scale(theme, ends, &unit))];
    lines.extend(marks.map(|marks| ("legend", marks)));
    let mut raw = format!("sum {}{unit}", value(reading.sum, 9));
    if let Some((largest, (column, row))) = reading.max {
        let largest = value(largest, 9);
        raw += &format!(", max {largest}{unit} at {column}, {row}");
    }
    lines.push(("raw", raw));
    let cells = counted(cells(&reading.values) as u64, "cell");
    let (columns, rows) = (reading.values.columns(), reading.values.rows());
    lines.push(("size", format!("{columns} × {rows}, {cells}")));
    lines
}

/// Returns the file that is written and the number of its frames; or why nothing is recorded although it was requested.
fn recording(live: &Live) -> Option<String> {
    let Some(path) = &live.recording.name else {
        let reason = live.recording.refusal.as_ref()?;
        return Some(format!("none: {reason}"));
    };
    let name = Path::new(path).file_name().unwrap_or_default();
    let recorded = live.status.recorded.unwrap_or_default();
    let frames = counted(recorded.frames, "frame");
    let left_out = match recorded.left_out {
        0 => String::new(),
        left_out => format!("; {} left out", grouped(left_out)),
    };
    Some(format!("{}, {frames}{left_out}", name.to_string_lossy()))
}

fn regions(reading: &LiveReading) -> String {
    let all = reading.imprint.as_ref().map_or(0, Imprint::count);
    match reading.regions {
        count @ 0..2 => count.to_string(),
        count => format!("{count}, largest above; NA {all} in all"),
    }
}

/// Returns the threshold. "of the file" marks one that came with a recording; other origins have no remark.
fn threshold(live: &Live, keymap: &Keymap) -> String {
    let Some(set) = live.rule() else {
        let key = keymap.label(Context::Live, &action::THRESHOLD_UP);
        return format!("none; {key} sets one");
    };
    let text = rule_text(set.rule, &live.unit());
    match set.from {
        RuleOrigin::File => format!("{text}, of the file"),
        RuleOrigin::Flag | RuleOrigin::Settings | RuleOrigin::Key => text,
    }
}

/// Returns how many frames the tare was made of, and its age: in seconds if the frames have times, otherwise in
/// frames; no age for a tare made after the shown frame. For a tare that is being made, returns how many of its
/// frames have come.
fn tare(live: &Live) -> String {
    if let Some(progress) = live.pipeline.progress() {
        return progress_text(progress);
    }
    let Some(origin) = live.pipeline.origin else {
        return "none".to_owned();
    };
    let frames = counted(origin.frames, "frame");
    let shown = live.reading.as_ref().map(|reading| &reading.frame);
    let age = shown.zip(origin.last);
    let age = age.and_then(|(frame, (number, time))| {
        if let (Some(now), Some(then)) = (frame.time, time) {
            return (now > then).then(|| format!("{} s ago", value::decimal(now - then, 1)));
        }
        let frames = frame.number.checked_sub(number)?;
        Some(format!("{} ago", counted(frames, "frame")))
    });
    age.map_or(frames.clone(), |age| format!("{frames}, {age}"))
}

/// Returns how many frames were dropped, a sample of the last one, and why it is not a frame.
fn dropped(live: &Live) -> String {
    let counts = &live.status.counts;
    let mut text = grouped(counts.dropped);
    if let Some(sample) = counts.sample.as_ref().filter(|_| counts.dropped > 0) {
        let reason = counts.reason.as_ref();
        let reason = reason.map_or(String::new(), |reason| format!(" ({reason})"));
        text += &format!(", the last: {sample}{reason}");
    }
    text
}

/// Breaks the answer of recognition into lines that fit beside their label: its end says how well the shape fits.
fn with_whole_answer(mut lines: Lines, theme: &Theme, width: u16) -> Lines {
    let room = usize::from(width).saturating_sub(LABEL);
    if let Some(at) = lines.iter().position(|(label, _)| *label == SHAPE) {
        let answer = theme.text(&lines[at].1).into_owned();
        let parts = write::broken(&answer, room).into_iter();
        let labels = std::iter::once(SHAPE).chain(std::iter::repeat(""));
        let parts = labels.zip(parts.map(str::to_owned));
        lines.splice(at..=at, parts);
    }
    lines
}

/// Draws the lines from the top; lines that do not fit into the area are left out.
fn draw_lines(lines: &Lines, theme: &Theme, buffer: &mut Buffer, area: Rect) {
    let mut shown = lines.len();
    if shown > area.height.into() {
        shown = area.height.saturating_sub(1).into();
        let last = write::row(area, shown);
        let left = format!("and {} more on a larger screen", lines.len() - shown);
        write::text(buffer, last, theme, &left, Role::Quiet);
    }
    for (index, (label, text)) in lines.iter().take(shown).enumerate() {
        let label = format!("{label:LABEL$}");
        let pieces = [(&*label, Role::Key), (text, Role::Text)];
        write::line(buffer, write::row(area, index), theme, pieces);
    }
}

/// Draws the title. The name of the source is cut off first: the user typed it and knows it. Usual states, such as
/// following the source, are omitted; a channel is named only if there are several.
fn draw_title(live: &Live, window: Option<String>, theme: &Theme, buffer: &mut Buffer, area: Rect) {
    let window = window.map(|window| (window, Role::Text));
    let pieces = of_state(live).into_iter().chain(window);
    let pieces = pieces.map(|(text, role)| (format!("  {text}"), role));
    let pieces: Vec<(String, Role)> = pieces.collect();
    let others: usize = pieces.iter().map(|(text, _)| write::width(text)).sum();
    let room = usize::from(area.width).saturating_sub(others).max(LABEL);
    let name = live.request.name();
    let name = (&*write::fitted(&name, room, theme), Role::Title);
    let pieces = pieces.iter().map(|(text, role)| (&**text, *role));
    write::line(buffer, area, theme, std::iter::once(name).chain(pieces));
}

/// Returns which frame is shown, and everything unusual about it and its source.
fn of_state(live: &Live) -> Vec<(String, Role)> {
    let mut pieces = Vec::new();
    let mut say = |text: String, role| pieces.push((text, role));
    let status = &live.status;
    if let Some(name) = status.channel.name.as_ref().filter(|_| status.channels > 1) {
        say(format!("channel {name} of {}", status.channels), Role::Text);
    }
    let shown = || live.history.shown().map(|(_, frame)| frame);
    let frame = (live.reading.as_ref()).map_or_else(shown, |own| Some(own.frame.clone()));
    match &frame {
        Some(frame) => {
            let label = frame.label.as_ref();
            let label = label.map_or(String::new(), |label| format!(" (label {label})"));
            say(format!("frame {}{label}", frame.number), Role::Text);
        }
        None => say(NO_FRAME.to_owned(), Role::Quiet),
    }
    if let Some(time) = frame.and_then(|frame| frame.time) {
        say(format!("{} s", value::decimal(time, 3)), Role::Text);
    }
    if let Some(back) = live.history.behind() {
        let behind = format!("frozen, {} behind", counted(back, "frame"));
        let frozen = if back > 0 {
            behind
        } else {
            "frozen".to_owned()
        };
        say(frozen, Role::Focus);
    }
    if live.recording.name.is_some() {
        say("recording".to_owned(), Role::Focus);
    }
    if status.state == SourceState::Ended {
        say("source ended".to_owned(), Role::Quiet);
    }
    let layer = match live.layer {
        HeatLayer::Tared if live.pipeline.origin.is_none() => HeatLayer::Raw,
        layer => layer,
    };
    say(layer.name().to_owned(), Role::Quiet);
    if let Some(progress) = live.pipeline.progress() {
        say(format!("tare: {}", progress_text(progress)), Role::Focus);
    }
    if live.is_marked() {
        say("marked".to_owned(), Role::Focus);
    }
    pieces
}
