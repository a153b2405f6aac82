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
use taxel_core::description::{Descriptor, Value};
use taxel_core::frame::RuleOrigin;
use taxel_core::imprint::Imprint;
use taxel_core::recognition::AnswerState;
use taxel_files::formats::recording::FrameMark;
use taxel_files::formats::value::{self, counted, fitting, grouped, measured};

use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot, Wheel};
use crate::tui::keys::action;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::live::heat::{HeatGrid, HeatMap, LivePanes, cells, scale};
use crate::tui::live::message::{LiveMessage, NamedImprint, Naming, RecordedFrames, SourceState};
use crate::tui::live::reading::{HeatLayer, LiveReading};
use crate::tui::live::state::Live;
use crate::tui::live::threshold::{self, progress_text};
use crate::tui::live::trend;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

const LABEL: usize = 11;

const SHOWN: [&str; 5] = ["na", "nae", "p", "f", "cg"];

impl Page for Live {
    fn context(&self) -> Context {
        Context::Live
    }

    fn slot(&self) -> Slot {
        Slot::Screen
    }

    fn cancels_itself(&self) -> bool {
        true
    }

    fn wheel(&self) -> Wheel {
        Wheel::Step
    }

    fn has_use_for(&self, message: &Message, area: Rect) -> bool {
        match message {
            Message::Live(LiveMessage::Window(_)) => hides_taxels(self, area),
            Message::Live(LiveMessage::Record) => {
                self.recording().name().is_some() || !self.status().state.is_final()
            }
            Message::Live(LiveMessage::Again) => self.check_again().is_ok(),
            _ => true,
        }
    }

    fn draw(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let reading = self.reading();
        let panes = panes(self, area);
        let shown = reading.filter(|_| !self.display.only_panel);
        let map = shown.map(|reading| HeatMap::of(self, reading, theme, panes.map));
        let title = title(self, map.as_ref().and_then(HeatMap::window));
        let title = fitting_title(title, panes.title.width.into(), theme);
        let pieces = title.iter().map(|piece| (piece.text.as_str(), piece.role));
        write::line(buffer, panes.title, theme, pieces);
        let mut marks = None;
        if let Some(map) = map {
            map.draw(buffer, panes.map);
            marks = map.legend();
        }
        let lines = lines(self, theme, keymap, marks);
        let mut panel = panes.panel;
        if let Some((plot, rest)) = panes.plot(lines.len()).filter(|_| shown.is_some()) {
            trend::draw(self, theme, buffer, plot);
            panel = rest;
        }
        draw_lines(&lines, theme, buffer, panel);
        None
    }

    fn remark(&self, keymap: &Keymap, area: Rect) -> Option<(String, Role)> {
        let error = self.error().map(ToString::to_string);
        let troubles: Vec<String> = error.into_iter().chain(self.trouble()).collect();
        let text = match (&troubles[..], self.unseen_note()) {
            ([], Some(note)) => note.to_owned(),
            ([], None) => return Some((at_end(self, keymap, area)?, Role::Quiet)),
            (troubles, _) => troubles.join("; "),
        };
        Some((format!("! {text}"), Role::Error))
    }

    fn makes_room(&self) -> bool {
        true
    }

    fn alarm(&self) -> Option<String> {
        self.trouble()
    }
}

/// Returns what can be done after the end of the source, as far as there is room for it on a page of this area; None
/// before the end.
fn at_end(live: &Live, keymap: &Keymap, area: Rect) -> Option<String> {
    if !live.has_ended() {
        return None;
    }
    let key = |action| keymap.label(Context::Live, action);
    let (earlier, first) = (key(&action::SCROLL_UP), key(&action::FIRST));
    let (again, close) = (key(&action::WATCH_AGAIN), key(&action::CANCEL));
    let again = match live.check_again() {
        Ok(()) => format!("{again}: again, "),
        Err(_) => String::new(),
    };
    let forms = [
        format!("ended; {earlier}: earlier frames, {first}: the first one, {again}{close}: close"),
        format!("ended; {again}{close}: close"),
    ];
    let most = usize::from(area.height / 8).max(1);
    let fits = |text: &String| write::broken(text, area.width.into()).len() <= most;
    Some(forms.into_iter().find(fits).unwrap_or("ended".to_owned()))
}

fn panes(live: &Live, area: Rect) -> LivePanes {
    let reading = live.reading().filter(|_| !live.display.only_panel);
    let size = reading.map(|reading| (reading.values.columns(), reading.values.rows()));
    LivePanes::of(area, size, live.display.numbers)
}

/// Returns true if some taxels do not fit on a page of this area, although the heat map is shown.
pub(super) fn hides_taxels(live: &Live, area: Rect) -> bool {
    let Some(reading) = live.reading().filter(|_| !live.display.only_panel) else {
        return false;
    };
    let size = (reading.values.columns(), reading.values.rows());
    let grid = HeatGrid::of(panes(live, area).map, size, live.display.numbers, (0, 0));
    !(grid.columns.is_whole() && grid.rows.is_whole())
}

/// Returns the taxel to look at to see hidden ones in a direction, on a page of this area; None if none are hidden
/// there.
pub(super) fn beyond(live: &Live, theme: &Theme, area: Rect, towards: Arrow) -> Option<(u8, u8)> {
    let reading = live.reading().filter(|_| !live.display.only_panel)?;
    let map = HeatMap::of(live, reading, theme, panes(live, area).map);
    map.beyond(towards, live)
}

/// A line of the panel: a number with its label.
struct PanelLine {
    label: &'static str,
    text: String,
    shorter: Vec<String>,
}

impl PanelLine {
    fn new(label: &'static str, text: String) -> Self {
        Self {
            label,
            text,
            shorter: Vec::new(),
        }
    }

    /// Creates a line in several forms, longer ones first; its text is `none` if there are no forms.
    fn of_forms(label: &'static str, forms: Vec<String>, none: &str) -> Self {
        let mut forms = forms.into_iter();
        let text = forms.next().unwrap_or_else(|| none.to_owned());
        Self {
            label,
            text,
            shorter: forms.collect(),
        }
    }

    fn up_to(label: &'static str, text: String, mark: &str) -> Self {
        let shorter = text.split_once(mark).map(|(head, _)| head.to_owned());
        let shorter = shorter.into_iter().collect();
        Self {
            label,
            text,
            shorter,
        }
    }
}

/// Returns all lines of the panel, the most important ones first. A low screen cuts them off at the bottom, so lines
/// about the touch come before lines about the source. `marks` is the legend of the mark on taxels.
fn lines(live: &Live, theme: &Theme, keymap: &Keymap, marks: Option<String>) -> Vec<PanelLine> {
    let mut lines = Vec::new();
    if let Some(reading) = live.reading() {
        let shown = SHOWN.iter().filter_map(|key| Descriptor::from_key(key));
        lines.extend(shown.map(|descriptor| described(reading, descriptor, theme)));
        lines.push(regions(reading));
    }
    if let Some(naming) = live.names.naming() {
        let shown = live.reading().and_then(|reading| reading.imprint);
        lines.extend(named(naming, shown.as_ref(), theme));
    }
    lines.push(threshold(live, keymap));
    lines.push(PanelLine::up_to("tare", tare(live), ", "));
    if let Some(reading) = live.reading() {
        lines.extend(of_values(live, reading, theme, marks));
    }
    let rate = live.rate().map(|rate| format!("{}/s", fitting(rate, 5)));
    let rate = rate.unwrap_or_else(|| theme.none().to_owned());
    lines.push(PanelLine::new("rate", rate));
    lines.push(PanelLine::of_forms("dropped", dropped(live), "0"));
    let mut say = |label, text: String| lines.push(PanelLine::new(label, text));
    say("not drawn", grouped(live.not_drawn()));
    if let Some(text) = gaps(live) {
        say("gaps", text);
    }
    if let Some(text) = marked(live) {
        say("marked", text);
    }
    let recording = recording(live);
    if !recording.is_empty() {
        lines.push(PanelLine::of_forms("recording", recording, ""));
    }
    lines
}

/// Returns the last marked frames: those marked by keys, and those that were marked while the recording was made, which
/// it knows by their labels. None if no frame is marked.
fn marked(live: &Live) -> Option<String> {
    let (own, recorded) = (live.marks(), live.marks.recorded());
    let text = |what, marks: &[FrameMark]| {
        let numbers = marks.iter().rev().map(|mark| mark.number.to_string());
        let numbers: Vec<String> = numbers.take(20).collect();
        (!marks.is_empty()).then(|| format!("{what} {}", numbers.join(", ")))
    };
    let texts = [text("frame", &own), text("label", recorded)];
    let texts: Vec<String> = texts.into_iter().flatten().collect();
    (!texts.is_empty()).then(|| texts.join("; "))
}

/// Returns the line of a descriptor of the imprint; a point gets fewer decimals in its shorter forms. An imprint
/// without active taxels has counts of 0; without an imprint there is no number.
fn described(reading: &LiveReading, descriptor: &'static Descriptor, theme: &Theme) -> PanelLine {
    let of_nothing = reading.imprint.map(|_| descriptor.of_nothing);
    let described = reading.description.as_ref().map(descriptor.measure);
    let measured = described.or(of_nothing);
    let text = measured.and_then(|measured| value::text(measured, descriptor.dimension));
    let mut line = PanelLine::new(
        descriptor.symbol,
        text.unwrap_or_else(|| theme.none().to_owned()),
    );
    if let Some(Value::Point(point)) = measured {
        let shorter = [2, 1, 0].map(|decimals| {
            let [x, y] = [point.x, point.y].map(|number| value::decimal(number, decimals));
            format!("{x}, {y}")
        });
        line.shorter = shorter.to_vec();
    }
    line
}

fn of_values(
    live: &Live,
    reading: &LiveReading,
    theme: &Theme,
    marks: Option<String>,
) -> Vec<PanelLine> {
    let unit = live.unit();
    // Small sums of large values are rounding errors, not measured values.
    let is_small = live.range().1 < 0.1;
    let value = if is_small { measured } else { fitting };
    let contact = counted(reading.contact, "taxel");
    let force = format!("{}{unit} on {contact}", value(reading.force, 9));
    let mut lines = vec![
        PanelLine::up_to("force", force, " on "),
        PanelLine::new("range", scale(theme, live.range(), &unit)),
    ];
    lines.extend(marks.map(|marks| PanelLine::new("legend", marks)));
    let mut raw = format!("sum {}{unit}", value(reading.sum, 9));
    if let Some((largest, (column, row))) = reading.max {
        let largest = value(largest, 9);
        raw += &format!(", max {largest}{unit} at {column}, {row}");
    }
    lines.push(PanelLine::up_to("raw", raw, " at "));
    let cells = counted(cells(&reading.values) as u64, "cell");
    let (columns, rows) = (reading.values.columns(), reading.values.rows());
    let size = format!("{columns} × {rows}, {cells}");
    lines.push(PanelLine::up_to("size", size, ", "));
    lines
}

/// Returns how often the source was lost, and how many seconds of frames are missing; None if it was not lost.
fn gaps(live: &Live) -> Option<String> {
    let gaps = live.status().gaps;
    let missing = value::decimal(gaps.missing, 1);
    (gaps.count > 0).then(|| format!("{}, {missing} s missing", grouped(gaps.count)))
}

/// Returns the file that is written and the number of its frames, longer forms first; or why nothing is recorded
/// although it was requested.
fn recording(live: &Live) -> Vec<String> {
    let Some(path) = live.recording().name() else {
        let reason = live.recording().refusal();
        return reason
            .map(|reason| format!("none: {reason}"))
            .into_iter()
            .collect();
    };
    let name = Path::new(path)
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    let RecordedFrames { frames, left_out } = live.status().recorded.unwrap_or_default();
    let frames = counted(frames, "frame");
    if left_out == 0 {
        return vec![
            format!("{path}, {frames}"),
            format!("{name}, {frames}"),
            frames,
        ];
    }
    let left_out = grouped(left_out);
    vec![
        format!("{path}, {frames}; {left_out} of another size left out"),
        format!("{name}, {frames}; {left_out} of another size left out"),
        format!("{frames}; {left_out} of another size left out"),
        format!("{frames}; {left_out} left out"),
    ]
}

fn regions(reading: &LiveReading) -> PanelLine {
    let count = reading.regions.to_string();
    if reading.regions < 2 {
        return PanelLine::new("regions", count);
    }
    let all = reading.imprint.as_ref().map_or(0, Imprint::count);
    PanelLine {
        label: "regions",
        text: format!("{count}, largest above; NA {all} in all"),
        shorter: vec![format!("{count}; NA {all} in all"), count],
    }
}

/// Returns the lines with the name of the shape, the nearest imprint, and the model with its noise; no name where
/// nothing is active. Answers about an earlier imprint end in dots.
fn named(naming: &Naming, shown: Option<&Imprint>, theme: &Theme) -> [PanelLine; 3] {
    let name = naming.request.choice.name();
    let model = match naming.request.noise {
        Some(noise) => format!("{name}, noise {}", noise.flip()),
        None => name.to_owned(),
    };
    let shown = shown.filter(|imprint| !imprint.is_empty());
    let answer = naming.answer.as_ref().filter(|_| shown.is_some());
    let late = |text: String| match answer {
        Some(answer) if Some(&answer.imprint) != shown => text + " …",
        _ => text,
    };
    let shape = match (&naming.failure, answer) {
        (Some(reason), _) => vec![format!("! {reason}")],
        (None, None) => {
            let waiting = shown.map(|_| "training or reading the model".to_owned());
            waiting.into_iter().collect()
        }
        (None, Some(answer)) => answered(answer).map(late).into(),
    };
    let nearest = answer.and_then(|answer| answer.nearest.as_ref());
    let nearest = nearest.map_or_else(Vec::new, |(name, distance)| {
        let forms = match distance {
            0 => [format!("{name}, the same"), format!("{name}, same")],
            1 => [
                format!("{name}, 1 taxel differs"),
                format!("{name}, 1 differs"),
            ],
            taxels => [
                format!("{name}, {taxels} taxels differ"),
                format!("{name}, {taxels} differ"),
            ],
        };
        forms.map(late).into()
    });
    [
        PanelLine::of_forms("shape", shape, theme.none()),
        PanelLine::of_forms("nearest", nearest, theme.none()),
        PanelLine::new("model", model),
    ]
}

fn answered(answer: &NamedImprint) -> [String; 3] {
    let name = answer.names.join(" or ");
    match answer.state {
        AnswerState::Tied => [
            format!("{name}: tied"),
            format!("tied: {name}"),
            "tied".to_owned(),
        ],
        AnswerState::Unknown => ["unknown"; 3].map(str::to_owned),
        state => {
            let how_sure = match answer.unexplained {
                Some(_) => "perhaps none",
                None => state.name(),
            };
            let short = format!("{name}, {how_sure}");
            match answer.probability.map(|own| fitting(100.0 * own, 4)) {
                Some(percent) => [
                    format!("{name} {percent} %, {how_sure}"),
                    short,
                    format!("{name} {percent} %"),
                ],
                None => [short.clone(), short, name],
            }
        }
    }
}

/// Returns the line of the threshold. "of the file" marks a threshold that came with a recording; other origins have
/// no remark.
fn threshold(live: &Live, keymap: &Keymap) -> PanelLine {
    let label = "threshold";
    let Some(set) = live.rule() else {
        let key = keymap.label(Context::Live, &action::THRESHOLD_UP);
        let shorter = vec![format!("none ({key})"), "none".to_owned()];
        return PanelLine {
            label,
            text: format!("none; {key} sets one"),
            shorter,
        };
    };
    let text = threshold::text(set.rule, &live.unit());
    match set.from {
        RuleOrigin::File => PanelLine::up_to(label, format!("{text}, of the file"), ", of"),
        RuleOrigin::Flag | RuleOrigin::Settings | RuleOrigin::Key => {
            PanelLine::up_to(label, text, " of max")
        }
    }
}

/// Returns how many frames the tare was made of, and its age: in seconds if the frames have times, otherwise in
/// frames; no age for a tare made after the shown frame. For a tare that is being made, returns how many of its
/// frames have come.
fn tare(live: &Live) -> String {
    if let Some(progress) = live.pipeline.progress() {
        return progress_text(progress);
    }
    let Some(origin) = live.pipeline.origin() else {
        return "none".to_owned();
    };
    let frames = counted(origin.frames, "frame");
    let shown = live.reading().map(|reading| &reading.frame);
    let age = shown.and_then(
        |frame| match (frame.time, origin.last.and_then(|(_, time)| time)) {
            (Some(now), Some(then)) if now > then => {
                Some(format!(", {} s ago", value::decimal(now - then, 1)))
            }
            (Some(_), Some(_)) => None,
            _ => {
                let frames = frame.number.checked_sub(origin.last?.0)?;
                Some(format!(", {} ago", counted(frames, "frame")))
            }
        },
    );
    age.map_or(frames.clone(), |age| frames + &age)
}

/// Returns how many frames were dropped, a sample of the last one, and why it is not a frame; then shorter forms.
fn dropped(live: &Live) -> Vec<String> {
    let status = live.status();
    let mut forms = vec![grouped(status.lost)];
    if let Some(sample) = status.sample.as_ref().filter(|_| status.lost > 0) {
        forms.insert(0, format!("{}, the last: {sample}", forms[0]));
        if let Some(reason) = &status.reason {
            forms.insert(0, format!("{} ({reason})", forms[0]));
        }
    }
    forms
}

/// Draws the lines from the top; lines that do not fit into the area are left out.
fn draw_lines(lines: &[PanelLine], theme: &Theme, buffer: &mut Buffer, area: Rect) {
    let room = usize::from(area.width).saturating_sub(LABEL);
    let height = usize::from(area.height);
    let shown = if lines.len() > height {
        height.saturating_sub(1)
    } else {
        lines.len()
    };
    if shown < lines.len() {
        let last = write::row(area, shown);
        write::left_out(buffer, last, theme, lines.len() - shown);
    }
    for (index, line) in lines.iter().take(shown).enumerate() {
        let label = format!("{:LABEL$}", line.label);
        let texts = std::iter::once(&line.text).chain(&line.shorter);
        let texts: Vec<_> = texts.map(|text| theme.text(text)).collect();
        let texts: Vec<&str> = texts.iter().map(|text| &**text).collect();
        let text = write::first_fitting(&texts, room);
        let pieces = [(&*label, Role::Key), (text, Role::Text)];
        write::line(buffer, write::row(area, index), theme, pieces);
    }
}

/// The columns that the name of the source keeps in the title when pieces of rank 2 to 4 are left out, and when
/// pieces of rank 1 are shortened. The name is shortened first, because the user typed it and knows it.
const SHORT_NAME: usize = 16;
const SHORTEST_NAME: usize = 4;

/// Returns the pieces of the title. `window` is the visible part of the taxels, as a long and a short text. Usual
/// states, such as following the source, are omitted; a channel is named only if there are several.
pub(super) fn title(live: &Live, window: Option<[String; 2]>) -> Vec<TitlePiece> {
    let mut pieces = vec![TitlePiece {
        text: live.request().name(),
        short: None,
        role: Role::Title,
        rank: 0,
    }];
    pieces.extend(of_frame(live));
    pieces.extend(of_state(live));
    let window = window.map(|[text, short]| TitlePiece::new(3, &text, Role::Text).or(&short));
    pieces.extend(window);
    pieces
}

fn of_frame(live: &Live) -> Vec<TitlePiece> {
    let mut pieces = Vec::new();
    let mut say = |rank, text: String, role| pieces.push(TitlePiece::new(rank, &text, role));
    let status = live.status();
    let channel = status.channel.as_deref();
    if let Some(name) = channel.and_then(|own| own.name.as_deref())
        && status.channels > 1
    {
        let channel = format!("channel {name} of {}", status.channels);
        say(5, channel, Role::Text);
    }
    match live.frame() {
        Some(frame) => {
            let label = frame
                .label
                .as_ref()
                .map(|label| format!(" (label {label})"));
            let label = label.as_deref().unwrap_or("");
            say(2, format!("frame {}{label}", frame.number), Role::Text);
            if let Some(time) = frame.time {
                say(6, format!("{} s", value::decimal(time, 3)), Role::Text);
            }
        }
        None => say(2, "no frame yet".to_owned(), Role::Quiet),
    }
    pieces
}

/// Returns the pieces about the state: whether the frame is frozen, which layer is shown, and everything unusual.
fn of_state(live: &Live) -> Vec<TitlePiece> {
    let frozen = live.cursor.frozen().map(|back| {
        if back == 0 {
            return TitlePiece::new(1, "frozen", Role::Focus);
        }
        let behind = counted(back, "frame");
        TitlePiece::new(1, &format!("frozen, {behind} behind"), Role::Focus).or("frozen")
    });
    let mut pieces: Vec<TitlePiece> = frozen.into_iter().collect();
    let mut say = |rank, text: String, role| pieces.push(TitlePiece::new(rank, &text, role));
    if live.recording().name().is_some() {
        say(1, "recording".to_owned(), Role::Focus);
    }
    match (&live.status().state, live.stopped()) {
        (_, true) => say(3, "stopped".to_owned(), Role::Quiet),
        (SourceState::Ended, _) => say(3, "source ended".to_owned(), Role::Quiet),
        _ => {}
    }
    let layer = match live.layer {
        HeatLayer::Tared if live.pipeline.origin().is_none() => HeatLayer::Raw,
        layer => layer,
    };
    say(8, layer.name().to_owned(), Role::Quiet);
    if let Some(progress) = live.pipeline.progress() {
        say(4, format!("tare: {}", progress_text(progress)), Role::Focus);
    }
    if live.cursor.holds_peak() {
        // A frozen frame is shown as it came, without the held peak.
        let rank = if live.cursor.frozen().is_none() { 1 } else { 4 };
        say(rank, "max held".to_owned(), Role::Focus);
    }
    if live.is_marked() {
        say(4, "marked".to_owned(), Role::Focus);
    }
    pieces
}

pub(super) struct TitlePiece {
    /// The text; it begins with two blanks, except for the name of the source.
    pub(super) text: String,
    /// A shorter text; None if there is none.
    short: Option<String>,
    pub(super) role: Role,
    /// The rank: pieces of the highest rank are left out first if there is no room for all; the name never is.
    rank: u8,
}

impl TitlePiece {
    fn new(rank: u8, text: &str, role: Role) -> Self {
        Self {
            text: format!("  {text}"),
            short: None,
            role,
            rank,
        }
    }

    fn or(self, short: &str) -> Self {
        Self {
            short: Some(format!("  {short}")),
            ..self
        }
    }
}

/// Shortens the title to a number of columns. Pieces that are needed to read the numbers correctly (frozen, peak
/// held), and the note that they are recorded, stay longest; then the name is shortened.
pub(super) fn fitting_title(
    mut pieces: Vec<TitlePiece>,
    room: usize,
    theme: &Theme,
) -> Vec<TitlePiece> {
    let width = |pieces: &[TitlePiece], name: usize| -> usize {
        let mut widths = pieces.iter().map(|piece| write::width(&piece.text));
        let name = widths.next().map_or(0, |own| own.min(name));
        name + widths.sum::<usize>()
    };
    while let Some(last) = (1..pieces.len()).max_by_key(|&index| {
        let piece = &pieces[index];
        (piece.rank, piece.short.is_some())
    }) {
        let rank = pieces[last].rank;
        let name = match rank {
            ..=1 => SHORTEST_NAME,
            2..=4 => SHORT_NAME,
            _ => usize::MAX,
        };
        if width(&pieces, name) <= room {
            break;
        }
        match pieces[last].short.take() {
            Some(short) => pieces[last].text = short,
            None if rank > 1 => drop(pieces.remove(last)),
            None => break,
        }
    }
    let others = width(&pieces, 0);
    if let Some(name) = pieces.first_mut() {
        let room = room.saturating_sub(others);
        name.text = write::fitted(&name.text, room, theme).into_owned();
    }
    pieces
}
