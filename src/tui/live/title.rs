//! The title of the live page: which frame of which source is shown, and how.

use crate::formats::value::{self, counted};
use crate::tui::live::message::SourceState;
use crate::tui::live::reading::HeatLayer;
use crate::tui::live::state::Live;
use crate::tui::live::tare::progress_text;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

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
            let label = frame.label.map(|label| format!(" (label {label})"));
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
        HeatLayer::Tared if live.tare.origin().is_none() => HeatLayer::Raw,
        layer => layer,
    };
    say(8, layer.name().to_owned(), Role::Quiet);
    if let Some(progress) = live.tare.progress() {
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
