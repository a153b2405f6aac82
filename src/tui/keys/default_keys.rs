//! The table of keys as it is unless a user changes it: [`crate::tui::keys::keymap`]. Help, hints and the menu are made from it; a
//! key that is not in it does nothing.
//!
//! The arrows move the cursor, not `hjkl`: `l` is Load, as in the paper's menu.

use crate::atlas::SortKey;
use crate::tui::app::message::{Copied, Endpoint, Erase, Message};
use crate::tui::explore::message::{ExploreMessage, ExplorePage, Zoom};
use crate::tui::keys::binding::{Binding, Context, bind};
use crate::tui::keys::key::{Arrow, Key};

use Arrow::{Down, Left, Right, Up};
use Endpoint::{First, Last};
use Key::{
    BackTab, Backspace, Char, Ctrl, Delete, Enter, Esc, F1, Home, PageDown, PageUp, ShiftArrow, Tab,
};

const LEFT: Key = Key::Arrow(Left);
const RIGHT: Key = Key::Arrow(Right);
const UP: Key = Key::Arrow(Up);
const DOWN: Key = Key::Arrow(Down);
// Not imported: the name is that of the two ends, too.
const END: Key = Key::End;

/// A table by places: each row its keys with their messages, a hint for the footer, a line of help. A macro, so that a
/// row stays a line: the formatter would make eight of it.
macro_rules! table {
    ($($place:ident {$(
        [$($key:expr => $message:ident $(($($what:tt)+))?),+] $hint:literal $help:literal;
    )+})+) => {
        &[$($(bind(Context::$place, &[$(($key, Message::$message $(($($what)+))?)),+], $hint, $help)),+),+]
    };
}

/// The table, in the order of help and hints; the first seven are the paper's options and make the menu.
pub const KEYMAP: &[Binding] = table! {
    Matrix {
        [Char('n') => New] "" "New: empty the matrix, to draw by hand";
        [Char('l') => Load] "" "Load: bring a stored shape onto the matrix";
        [Char('f') => Figure] "" "Figure: place one of the seven figures";
        [Char('p') => Picture] "" "Picture: move, turn and zoom a stored shape";
        [Char('s') => Save] "" "Save: store what is on the matrix";
        [Char('d') => Delete] "" "Delete: remove a stored shape";
        [Char('q') => Quit] "" "Quit: asks first where work would be lost";
        [LEFT => Cursor(Left), RIGHT => Cursor(Right), UP => Cursor(Up), DOWN => Cursor(Down)]
            "" "move the cursor";
        [Home => ToColumn(First), END => ToColumn(Last)] "" "cursor to the first, the last column";
        [PageUp => ToRow(First), PageDown => ToRow(Last)] "" "cursor to the first, the last row";
        [Char(' ') => Toggle] "toggle" "turn the taxel under the cursor on or off";
        [Char('u') => Undo] "undo" "undo the last change, then those before";
        [Char('U') => Redo, Ctrl('r') => Redo] "redo" "redo what was undone";
        [Tab => Region(1), BackTab => Region(-1)]
            "region" "describe the next, the previous piece or hole";
        [Char('c') => Display] "coverage" "coverage in shades, in percent, the imprint again";
        [Char('g') => Grab] "grab" "hold the shape, to move it with the arrows";
        [Char('e') => Explore(ExploreMessage::Open)] "explore" "Explore: all imprints of the shape, over all poses";
        [ShiftArrow(Left) => Nudge(Left), ShiftArrow(Right) => Nudge(Right),
            ShiftArrow(Up) => Nudge(Up), ShiftArrow(Down) => Nudge(Down)]
            "" "move the shape without holding it";
        [Char('<') => Turn(-1), Char('>') => Turn(1)]
            "turn" "turn the shape by 1 degree, left, right";
        [Char('(') => Turn(-10), Char(')') => Turn(10)] "" "turn it by 10 degrees";
        [Char('z') => Zoom(1), Char('Z') => Zoom(-1)]
            "" "zoom a picture in, out, by the current step";
        [Char('S') => Sensor] "" "Sensor: columns, rows, threshold, pitch";
        [Char('i') => SwitchPage] "descriptors" "on a narrow screen: descriptors or matrix";
        [Char('y') => Copy(Copied::Descriptors), Char('Y') => Copy(Copied::Imprint)]
            "" "copy descriptors, imprint to your terminal's clipboard";
        [Char('m') => MouseOnOff] "" "the mouse sets taxels, or selects text";
        [Char(':') => Command] "" "type a command";
        [Char('?') => Help] "help" "Help: this list";
    }

    Grab {
        [LEFT => Nudge(Left), RIGHT => Nudge(Right), UP => Nudge(Up), DOWN => Nudge(Down)]
            "move" "move the shape by a step";
        [Char('+') => NudgeStep(1), Char('=') => NudgeStep(1), Char('-') => NudgeStep(-1)]
            "step" "a larger, a smaller step: 0.01, 0.1, 1";
        [Char('g') => Grab, Enter => Grab, Esc => Grab] "let go" "let the shape go";
    }

    Form {
        [Tab => Field(1), BackTab => Field(-1)] "field" "next, previous field";
        [LEFT => Choose(Left), RIGHT => Choose(Right), UP => Choose(Up), DOWN => Choose(Down)]
            "" "choose the kind (or by its letter); move, change field";
        [Char('+') => Step(1), Char('=') => Step(1), Char('-') => Step(-1)]
            "step" "change the number by its last decimal";
        [Backspace => Erase(Erase::Before), Delete => Erase(Erase::Under)] "" "delete a character";
        [Ctrl('u') => Erase(Erase::All)] "clear" "clear the field";
        [Home => ToEdge(First), END => ToEdge(Last)] "" "to the start, the end of the field";
        [Enter => Accept] "take it" "take it; refused while a field is wrong";
        [Esc => Cancel, Ctrl('g') => Cancel] "cancel" "leave everything as it was";
        [Char('?') => Help] "help" "these keys";
    }

    Question {
        [Char('y') => Accept] "yes" "yes";
        [Char('n') => Decline] "no" "no";
        [Esc => Cancel, Ctrl('g') => Cancel, Char('q') => Cancel] "not now" "no answer now";
        [Char('?') => Help] "help" "these keys";
    }

    List {
        [UP => Scroll(-1), DOWN => Scroll(1)] "choose" "previous, next shape";
        [PageUp => Scroll(-10), PageDown => Scroll(10)] "" "ten shapes back, on";
        [Home => ScrollTo(First), END => ScrollTo(Last)] "" "first, last shape";
        [Enter => Accept] "take it" "take the shape";
        [Backspace => Erase(Erase::Before)] "" "delete a character of the filter";
        [Ctrl('u') => Erase(Erase::All)] "clear" "clear the filter";
        [Esc => Cancel, Ctrl('g') => Cancel] "cancel" "leave everything as it was";
        [Char('?') => Help] "help" "these keys";
    }

    Name {
        [Enter => Accept] "save" "store under this name";
        [LEFT => Choose(Left), RIGHT => Choose(Right)] "" "move in the name";
        [Home => ToEdge(First), END => ToEdge(Last)] "" "to its start, its end";
        [Backspace => Erase(Erase::Before), Delete => Erase(Erase::Under)] "" "delete a character";
        [Ctrl('u') => Erase(Erase::All)] "clear" "clear the name";
        [Esc => Cancel, Ctrl('g') => Cancel] "cancel" "do not store";
        [F1 => Help] "help" "these keys";
    }

    Command {
        [Enter => Accept] "do it" "do it";
        [Tab => Field(1)] "complete" "complete the word";
        [UP => Choose(Up), DOWN => Choose(Down)] "earlier" "earlier, later commands";
        [LEFT => Choose(Left), RIGHT => Choose(Right)] "" "move in the line";
        [Home => ToEdge(First), END => ToEdge(Last)] "" "to its start, its end";
        [Backspace => Erase(Erase::Before), Delete => Erase(Erase::Under)] "" "delete a character";
        [Ctrl('u') => Erase(Erase::All)] "" "clear the line";
        [Esc => Cancel, Ctrl('g') => Cancel] "cancel" "do nothing";
        [F1 => Help] "help" "these keys";
    }

    Ranges {
        [Tab => Field(1), BackTab => Field(-1)] "field" "next, previous field";
        [LEFT => Choose(Left), RIGHT => Choose(Right), UP => Choose(Up), DOWN => Choose(Down)]
            "" "move in a field, to other fields; the other anchor";
        [Backspace => Erase(Erase::Before), Delete => Erase(Erase::Under)] "" "delete a character";
        [Ctrl('u') => Erase(Erase::All)] "clear" "clear the field";
        [Home => ToEdge(First), END => ToEdge(Last)] "" "to the start, the end of the field";
        [Enter => Accept] "start" "sweep all poses; refused while a range is wrong";
        [Esc => Cancel, Ctrl('g') => Cancel] "cancel" "leave everything as it was";
        [Char('?') => Help] "help" "these keys";
    }

    Running {
        [Esc => Explore(ExploreMessage::Stop), Char('s') => Explore(ExploreMessage::Stop), Ctrl('g') => Explore(ExploreMessage::Stop)]
            "stop" "stop; a sweep keeps what is complete";
        [Ctrl('c') => Terminate] "quit" "quit at once; unsaved work is offered next time";
    }

    Explore {
        [Char('1') => Explore(ExploreMessage::Page(ExplorePage::Imprints)),
            Char('2') => Explore(ExploreMessage::Page(ExplorePage::Statistics)),
            Char('3') => Explore(ExploreMessage::Page(ExplorePage::Histogram)),
            Char('4') => Explore(ExploreMessage::Page(ExplorePage::Map))] "" "imprints, statistics, histogram, map";
        [Tab => Explore(ExploreMessage::NextPage(1)), BackTab => Explore(ExploreMessage::NextPage(-1))]
            "page" "next, previous page";
        [Char('d') => Explore(ExploreMessage::Feature(1)), Char('D') => Explore(ExploreMessage::Feature(-1))]
            "descriptor" "next, previous descriptor";
        [Char('x') => Explore(ExploreMessage::Export)]
            "export" "write a file: .csv .jsonl .npz imprints, .npy poses";
        [Char('e') => Explore(ExploreMessage::Ranges)] "ranges" "explore other ranges";
        [Char('?') => Help] "help" "all keys";
        [Esc => Cancel, Ctrl('g') => Cancel, Char('q') => Cancel]
            "close" "back to the matrix; what was found is kept";
    }

    Imprints {
        [UP => Scroll(-1), DOWN => Scroll(1)] "" "previous, next imprint";
        [PageUp => Scroll(-10), PageDown => Scroll(10)] "" "ten imprints back, on";
        [Home => ScrollTo(First), END => ScrollTo(Last)] "" "first, last imprint";
        [Enter => Accept] "to matrix" "put it onto the matrix, in its first pose";
        [Char('n') => Explore(ExploreMessage::Sort(SortKey::Poses)),
            Char('f') => Explore(ExploreMessage::Sort(SortKey::FirstPose)),
            Char('v') => Explore(ExploreMessage::Sort(SortKey::Value)),
            Char('c') => Explore(ExploreMessage::Sort(SortKey::Pieces)), Char('h') => Explore(ExploreMessage::Sort(SortKey::Holes))]
            "sort" "poses, 1st pose, value, pieces, holes; again: reversed";
        [Char('j') => Explore(ExploreMessage::Find)] "find" "jump to the imprint that is on the matrix";
        [Char('g') => Explore(ExploreMessage::Follow)] "map" "go to its first pose on the map";
    }

    Statistics {
        [UP => Scroll(-1), DOWN => Scroll(1), PageUp => Scroll(-10), PageDown => Scroll(10)]
            "" "choose a descriptor";
        [Home => ScrollTo(First), END => ScrollTo(Last)] "" "first, last descriptor";
        [LEFT => Explore(ExploreMessage::Columns(-1)), RIGHT => Explore(ExploreMessage::Columns(1))]
            "columns" "earlier, later columns";
        [Enter => Explore(ExploreMessage::Page(ExplorePage::Histogram))] "histogram" "its histogram";
    }

    Histogram {
        [UP => Scroll(-1), DOWN => Scroll(1), PageUp => Scroll(-10), PageDown => Scroll(10)]
            "" "choose a descriptor";
        [Home => ScrollTo(First), END => ScrollTo(Last)] "" "first, last descriptor";
    }

    Map {
        [LEFT => Cursor(Left), RIGHT => Cursor(Right), UP => Cursor(Up), DOWN => Cursor(Down)]
            "" "to the next pose; each letter is an imprint";
        [PageUp => Scroll(-10), PageDown => Scroll(10)] "" "ten poses up, down";
        [Home => ScrollTo(First), END => ScrollTo(Last)] "" "to the first, the last x0";
        [Char('<') => Explore(ExploreMessage::Angle(-1)), Char('>') => Explore(ExploreMessage::Angle(1))]
            "angle" "previous, next angle";
        [Char('(') => Explore(ExploreMessage::Angle(-10)), Char(')') => Explore(ExploreMessage::Angle(10))]
            "" "ten angles back, on";
        [Char('z') => Explore(ExploreMessage::Zoomed(Zoom::X, 1)), Char('Z') => Explore(ExploreMessage::Zoomed(Zoom::X, -1)),
            Char('w') => Explore(ExploreMessage::Zoomed(Zoom::Y, 1)), Char('W') => Explore(ExploreMessage::Zoomed(Zoom::Y, -1))]
            "" "next, previous zoom x, zoom y of a picture";
        [Enter => Accept] "to matrix" "put this pose onto the matrix";
        [Char('g') => Explore(ExploreMessage::Follow)] "list" "go to its imprint in the list";
    }

    Export {
        [Enter => Accept] "write" "write the file";
        [LEFT => Choose(Left), RIGHT => Choose(Right)] "" "move in the name";
        [Home => ToEdge(First), END => ToEdge(Last)] "" "to its start, its end";
        [Backspace => Erase(Erase::Before), Delete => Erase(Erase::Under)] "" "delete a character";
        [Ctrl('u') => Erase(Erase::All)] "clear" "clear the name";
        [Esc => Cancel, Ctrl('g') => Cancel] "cancel" "write nothing";
        [F1 => Help] "help" "these keys";
    }

    Help {
        [UP => Scroll(-1), DOWN => Scroll(1), PageUp => Scroll(-10), PageDown => Scroll(10)]
            "scroll" "scroll";
        [Char('q') => Cancel, Char('?') => Cancel, F1 => Cancel, Enter => Cancel, Esc => Cancel,
            Ctrl('g') => Cancel] "close" "close";
    }

    Everywhere {
        [Ctrl('l') => Redraw] "" "draw the screen anew";
        [Ctrl('z') => Suspend] "" "back to the shell; fg returns here";
        [Ctrl('c') => Quit] "" "close what is open; on the matrix: quit";
        [F1 => Help] "" "the keys that mean something here";
    }
};

/// How many rows at the head of the table make the menu.
pub const MENU: usize = 7;
