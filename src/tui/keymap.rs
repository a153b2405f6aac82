//! The table of keys as it is unless a user changes it: [`super::remap`]. Help, hints and the menu are made from it; a
//! key that is not in it does nothing.
//!
//! The arrows move the cursor, not `hjkl`: `l` is Load, as in the paper's menu.

use super::binding::{Binding, Context, bind};
use super::exploring::{ExplorePage, Exploring, Zoom};
use super::key::{Arrow, Key};
use super::message::{Copied, End, Erase, Message};
use crate::sweep::order::SortKey;

use Context::{
    Command, Everywhere, Explore, Export, Form, Grab, Help, Histogram, Imprints, List, Map, Matrix,
    Name, Question, Ranges, Running, Statistics,
};
use Key::Char;

const LEFT: Key = Key::Arrow(Arrow::Left);
const RIGHT: Key = Key::Arrow(Arrow::Right);
const UP: Key = Key::Arrow(Arrow::Up);
const DOWN: Key = Key::Arrow(Arrow::Down);

/// The table, in the order of help and hints; the first seven are the paper's options and make the menu.
pub const KEYMAP: &[Binding] = &[
    bind(
        Matrix,
        &[(Char('n'), Message::New)],
        "",
        "New: empty the matrix, to draw by hand",
    ),
    bind(
        Matrix,
        &[(Char('l'), Message::Load)],
        "",
        "Load: bring a stored shape onto the matrix",
    ),
    bind(
        Matrix,
        &[(Char('f'), Message::Figure)],
        "",
        "Figure: touch one of the seven figures",
    ),
    bind(
        Matrix,
        &[(Char('p'), Message::Picture)],
        "",
        "Picture: move, turn and zoom a stored shape",
    ),
    bind(
        Matrix,
        &[(Char('s'), Message::Save)],
        "",
        "Save: store what is on the matrix",
    ),
    bind(
        Matrix,
        &[(Char('d'), Message::Delete)],
        "",
        "Delete: remove a stored shape",
    ),
    bind(
        Matrix,
        &[(Char('q'), Message::Quit)],
        "",
        "Quit, after a question where work would be lost",
    ),
    bind(
        Matrix,
        &[
            (LEFT, Message::Cursor(Arrow::Left)),
            (RIGHT, Message::Cursor(Arrow::Right)),
            (UP, Message::Cursor(Arrow::Up)),
            (DOWN, Message::Cursor(Arrow::Down)),
        ],
        "",
        "move the cursor",
    ),
    bind(
        Matrix,
        &[
            (Key::Home, Message::ToColumn(End::First)),
            (Key::End, Message::ToColumn(End::Last)),
        ],
        "",
        "cursor to the first, the last column",
    ),
    bind(
        Matrix,
        &[
            (Key::PageUp, Message::ToRow(End::First)),
            (Key::PageDown, Message::ToRow(End::Last)),
        ],
        "",
        "cursor to the first, the last row",
    ),
    bind(
        Matrix,
        &[(Char(' '), Message::Toggle)],
        "toggle",
        "turn the taxel under the cursor on or off",
    ),
    bind(
        Matrix,
        &[(Char('u'), Message::Undo)],
        "undo",
        "take back the last change, and those before",
    ),
    bind(
        Matrix,
        &[(Char('U'), Message::Redo), (Key::Ctrl('r'), Message::Redo)],
        "redo",
        "make it again",
    ),
    bind(
        Matrix,
        &[
            (Key::Tab, Message::Region(1)),
            (Key::BackTab, Message::Region(-1)),
        ],
        "region",
        "describe the next, the previous piece or hole",
    ),
    bind(
        Matrix,
        &[(Char('c'), Message::Display)],
        "coverage",
        "coverage in shades, in percent, the imprint again",
    ),
    bind(
        Matrix,
        &[(Char('g'), Message::Grab)],
        "grab",
        "hold the shape, to move it with the arrows",
    ),
    bind(
        Matrix,
        &[(Char('e'), Message::Explore(Exploring::Open))],
        "explore",
        "Explore: all imprints of the shape, over all poses",
    ),
    bind(
        Matrix,
        &[
            (Key::ShiftArrow(Arrow::Left), Message::Nudge(Arrow::Left)),
            (Key::ShiftArrow(Arrow::Right), Message::Nudge(Arrow::Right)),
            (Key::ShiftArrow(Arrow::Up), Message::Nudge(Arrow::Up)),
            (Key::ShiftArrow(Arrow::Down), Message::Nudge(Arrow::Down)),
        ],
        "",
        "move the shape without holding it",
    ),
    bind(
        Matrix,
        &[
            (Char('<'), Message::Turn(-1)),
            (Char('>'), Message::Turn(1)),
        ],
        "turn",
        "turn the shape by 1 degree, left, right",
    ),
    bind(
        Matrix,
        &[
            (Char('('), Message::Turn(-10)),
            (Char(')'), Message::Turn(10)),
        ],
        "",
        "turn it by 10 degrees",
    ),
    bind(
        Matrix,
        &[
            (Char('z'), Message::Zoom(1)),
            (Char('Z'), Message::Zoom(-1)),
        ],
        "",
        "zoom a picture in, out, by the step of holding",
    ),
    bind(
        Matrix,
        &[(Char('S'), Message::Sensor)],
        "",
        "Sensor: columns, rows, threshold, pitch",
    ),
    bind(
        Matrix,
        &[(Char('i'), Message::Page)],
        "descriptors",
        "on a narrow screen: descriptors, matrix",
    ),
    bind(
        Matrix,
        &[
            (Char('y'), Message::Copy(Copied::Descriptors)),
            (Char('Y'), Message::Copy(Copied::Imprint)),
        ],
        "",
        "copy the descriptors, the imprint to your terminal",
    ),
    bind(
        Matrix,
        &[(Char('m'), Message::MouseOnOff)],
        "",
        "the mouse: to taxel, or to select text",
    ),
    bind(
        Matrix,
        &[(Char(':'), Message::Command)],
        "",
        "a command by its name",
    ),
    bind(
        Matrix,
        &[(Char('?'), Message::Help)],
        "help",
        "Help: this list",
    ),
    bind(
        Grab,
        &[
            (LEFT, Message::Nudge(Arrow::Left)),
            (RIGHT, Message::Nudge(Arrow::Right)),
            (UP, Message::Nudge(Arrow::Up)),
            (DOWN, Message::Nudge(Arrow::Down)),
        ],
        "move",
        "move the shape by a step",
    ),
    bind(
        Grab,
        &[
            (Char('+'), Message::NudgeStep(1)),
            (Char('='), Message::NudgeStep(1)),
            (Char('-'), Message::NudgeStep(-1)),
        ],
        "step",
        "a larger, a smaller step: 0.01, 0.1, 1",
    ),
    bind(
        Grab,
        &[
            (Char('g'), Message::Grab),
            (Key::Enter, Message::Grab),
            (Key::Esc, Message::Grab),
        ],
        "let go",
        "let the shape go",
    ),
    bind(
        Form,
        &[
            (Key::Tab, Message::Field(1)),
            (Key::BackTab, Message::Field(-1)),
        ],
        "field",
        "next, previous field",
    ),
    bind(
        Form,
        &[
            (LEFT, Message::Choose(Arrow::Left)),
            (RIGHT, Message::Choose(Arrow::Right)),
            (UP, Message::Choose(Arrow::Up)),
            (DOWN, Message::Choose(Arrow::Down)),
        ],
        "",
        "choose the kind; move in a field, to other fields",
    ),
    bind(
        Form,
        &[
            (Char('+'), Message::Step(1)),
            (Char('='), Message::Step(1)),
            (Char('-'), Message::Step(-1)),
        ],
        "step",
        "change the number by its last decimal",
    ),
    bind(
        Form,
        &[
            (Key::Backspace, Message::Erase(Erase::Before)),
            (Key::Delete, Message::Erase(Erase::Under)),
        ],
        "",
        "delete a character",
    ),
    bind(
        Form,
        &[(Key::Ctrl('u'), Message::Erase(Erase::All))],
        "clear",
        "clear the field",
    ),
    bind(
        Form,
        &[
            (Key::Home, Message::ToEdge(End::First)),
            (Key::End, Message::ToEdge(End::Last)),
        ],
        "",
        "to the start, the end of the field",
    ),
    bind(
        Form,
        &[(Key::Enter, Message::Accept)],
        "take it",
        "take it; refused while a field is wrong",
    ),
    bind(
        Form,
        &[
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
        ],
        "cancel",
        "leave everything as it was",
    ),
    bind(Form, &[(Char('?'), Message::Help)], "help", "these keys"),
    bind(Question, &[(Char('y'), Message::Accept)], "yes", "yes"),
    bind(Question, &[(Char('n'), Message::Decline)], "no", "no"),
    bind(
        Question,
        &[
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
            (Char('q'), Message::Cancel),
        ],
        "not now",
        "no answer now",
    ),
    bind(
        Question,
        &[(Char('?'), Message::Help)],
        "help",
        "these keys",
    ),
    bind(
        List,
        &[(UP, Message::Scroll(-1)), (DOWN, Message::Scroll(1))],
        "choose",
        "previous, next shape",
    ),
    bind(
        List,
        &[
            (Key::PageUp, Message::Scroll(-10)),
            (Key::PageDown, Message::Scroll(10)),
        ],
        "",
        "ten shapes back, on",
    ),
    bind(
        List,
        &[
            (Key::Home, Message::ScrollTo(End::First)),
            (Key::End, Message::ScrollTo(End::Last)),
        ],
        "",
        "first, last shape",
    ),
    bind(
        List,
        &[(Key::Enter, Message::Accept)],
        "take it",
        "take the shape",
    ),
    bind(
        List,
        &[(Key::Backspace, Message::Erase(Erase::Before))],
        "",
        "delete a character of the filter",
    ),
    bind(
        List,
        &[(Key::Ctrl('u'), Message::Erase(Erase::All))],
        "clear",
        "clear the filter",
    ),
    bind(
        List,
        &[
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
        ],
        "cancel",
        "leave everything as it was",
    ),
    bind(List, &[(Char('?'), Message::Help)], "help", "these keys"),
    bind(
        Name,
        &[(Key::Enter, Message::Accept)],
        "save",
        "store under this name",
    ),
    bind(
        Name,
        &[
            (LEFT, Message::Choose(Arrow::Left)),
            (RIGHT, Message::Choose(Arrow::Right)),
        ],
        "",
        "move in the name",
    ),
    bind(
        Name,
        &[
            (Key::Home, Message::ToEdge(End::First)),
            (Key::End, Message::ToEdge(End::Last)),
        ],
        "",
        "to its start, its end",
    ),
    bind(
        Name,
        &[
            (Key::Backspace, Message::Erase(Erase::Before)),
            (Key::Delete, Message::Erase(Erase::Under)),
        ],
        "",
        "delete a character",
    ),
    bind(
        Name,
        &[(Key::Ctrl('u'), Message::Erase(Erase::All))],
        "clear",
        "clear the name",
    ),
    bind(
        Name,
        &[
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
        ],
        "cancel",
        "do not store",
    ),
    bind(Name, &[(Key::F1, Message::Help)], "help", "these keys"),
    bind(Command, &[(Key::Enter, Message::Accept)], "do it", "do it"),
    bind(
        Command,
        &[(Key::Tab, Message::Field(1))],
        "complete",
        "complete the word",
    ),
    bind(
        Command,
        &[
            (UP, Message::Choose(Arrow::Up)),
            (DOWN, Message::Choose(Arrow::Down)),
        ],
        "earlier",
        "earlier, later commands",
    ),
    bind(
        Command,
        &[
            (LEFT, Message::Choose(Arrow::Left)),
            (RIGHT, Message::Choose(Arrow::Right)),
        ],
        "",
        "move in the line",
    ),
    bind(
        Command,
        &[
            (Key::Home, Message::ToEdge(End::First)),
            (Key::End, Message::ToEdge(End::Last)),
        ],
        "",
        "to its start, its end",
    ),
    bind(
        Command,
        &[
            (Key::Backspace, Message::Erase(Erase::Before)),
            (Key::Delete, Message::Erase(Erase::Under)),
        ],
        "",
        "delete a character",
    ),
    bind(
        Command,
        &[(Key::Ctrl('u'), Message::Erase(Erase::All))],
        "",
        "clear the line",
    ),
    bind(
        Command,
        &[
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
        ],
        "cancel",
        "do nothing",
    ),
    bind(Command, &[(Key::F1, Message::Help)], "help", "these keys"),
    bind(
        Ranges,
        &[
            (Key::Tab, Message::Field(1)),
            (Key::BackTab, Message::Field(-1)),
        ],
        "field",
        "next, previous field",
    ),
    bind(
        Ranges,
        &[
            (LEFT, Message::Choose(Arrow::Left)),
            (RIGHT, Message::Choose(Arrow::Right)),
            (UP, Message::Choose(Arrow::Up)),
            (DOWN, Message::Choose(Arrow::Down)),
        ],
        "",
        "move in a field, to other fields; the other anchor",
    ),
    bind(
        Ranges,
        &[
            (Key::Backspace, Message::Erase(Erase::Before)),
            (Key::Delete, Message::Erase(Erase::Under)),
        ],
        "",
        "delete a character",
    ),
    bind(
        Ranges,
        &[(Key::Ctrl('u'), Message::Erase(Erase::All))],
        "clear",
        "clear the field",
    ),
    bind(
        Ranges,
        &[
            (Key::Home, Message::ToEdge(End::First)),
            (Key::End, Message::ToEdge(End::Last)),
        ],
        "",
        "to the start, the end of the field",
    ),
    bind(
        Ranges,
        &[(Key::Enter, Message::Accept)],
        "start",
        "go through all poses; refused while a range is wrong",
    ),
    bind(
        Ranges,
        &[
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
        ],
        "cancel",
        "leave everything as it was",
    ),
    bind(
        Running,
        &[
            (Key::Esc, Message::Explore(Exploring::Stop)),
            (Char('s'), Message::Explore(Exploring::Stop)),
            (Key::Ctrl('g'), Message::Explore(Exploring::Stop)),
        ],
        "stop",
        "stop, and keep what is complete",
    ),
    bind(
        Running,
        &[(Key::Ctrl('c'), Message::Killed)],
        "quit",
        "quit at once; unsaved work is offered next time",
    ),
    bind(
        Explore,
        &[
            (
                Char('1'),
                Message::Explore(Exploring::Page(ExplorePage::Imprints)),
            ),
            (
                Char('2'),
                Message::Explore(Exploring::Page(ExplorePage::Statistics)),
            ),
            (
                Char('3'),
                Message::Explore(Exploring::Page(ExplorePage::Histogram)),
            ),
            (
                Char('4'),
                Message::Explore(Exploring::Page(ExplorePage::Map)),
            ),
        ],
        "",
        "imprints, statistics, histogram, map",
    ),
    bind(
        Explore,
        &[
            (Key::Tab, Message::Explore(Exploring::NextPage(1))),
            (Key::BackTab, Message::Explore(Exploring::NextPage(-1))),
        ],
        "page",
        "next, previous page",
    ),
    bind(
        Explore,
        &[
            (Char('d'), Message::Explore(Exploring::Quantity(1))),
            (Char('D'), Message::Explore(Exploring::Quantity(-1))),
        ],
        "descriptor",
        "next, previous descriptor",
    ),
    bind(
        Explore,
        &[(Char('x'), Message::Explore(Exploring::Export))],
        "export",
        "write a file: .csv .jsonl .npz imprints, .npy poses",
    ),
    bind(
        Explore,
        &[(Char('e'), Message::Explore(Exploring::Ranges))],
        "ranges",
        "explore other ranges",
    ),
    bind(Explore, &[(Char('?'), Message::Help)], "help", "all keys"),
    bind(
        Explore,
        &[
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
            (Char('q'), Message::Cancel),
        ],
        "close",
        "back to the matrix; e comes back here",
    ),
    bind(
        Imprints,
        &[(UP, Message::Scroll(-1)), (DOWN, Message::Scroll(1))],
        "",
        "previous, next imprint",
    ),
    bind(
        Imprints,
        &[
            (Key::PageUp, Message::Scroll(-10)),
            (Key::PageDown, Message::Scroll(10)),
        ],
        "",
        "ten imprints back, on",
    ),
    bind(
        Imprints,
        &[
            (Key::Home, Message::ScrollTo(End::First)),
            (Key::End, Message::ScrollTo(End::Last)),
        ],
        "",
        "first, last imprint",
    ),
    bind(
        Imprints,
        &[(Key::Enter, Message::Accept)],
        "to matrix",
        "put it onto the matrix, in its first pose",
    ),
    bind(
        Imprints,
        &[
            (Char('n'), Message::Explore(Exploring::Sort(SortKey::Poses))),
            (
                Char('f'),
                Message::Explore(Exploring::Sort(SortKey::FirstPose)),
            ),
            (Char('v'), Message::Explore(Exploring::Sort(SortKey::Value))),
            (
                Char('c'),
                Message::Explore(Exploring::Sort(SortKey::Pieces)),
            ),
            (Char('h'), Message::Explore(Exploring::Sort(SortKey::Holes))),
        ],
        "sort",
        "by poses, first pose, value, pieces, holes; or back",
    ),
    bind(
        Imprints,
        &[(Char('j'), Message::Explore(Exploring::Find))],
        "find",
        "jump to the imprint that is on the matrix",
    ),
    bind(
        Imprints,
        &[(Char('g'), Message::Explore(Exploring::Follow))],
        "map",
        "go to its first pose on the map",
    ),
    bind(
        Statistics,
        &[
            (UP, Message::Scroll(-1)),
            (DOWN, Message::Scroll(1)),
            (Key::PageUp, Message::Scroll(-10)),
            (Key::PageDown, Message::Scroll(10)),
        ],
        "",
        "choose a descriptor",
    ),
    bind(
        Statistics,
        &[
            (Key::Home, Message::ScrollTo(End::First)),
            (Key::End, Message::ScrollTo(End::Last)),
        ],
        "",
        "first, last descriptor",
    ),
    bind(
        Statistics,
        &[
            (LEFT, Message::Explore(Exploring::Columns(-1))),
            (RIGHT, Message::Explore(Exploring::Columns(1))),
        ],
        "columns",
        "earlier, later columns",
    ),
    bind(
        Statistics,
        &[(
            Key::Enter,
            Message::Explore(Exploring::Page(ExplorePage::Histogram)),
        )],
        "histogram",
        "its histogram",
    ),
    bind(
        Histogram,
        &[
            (UP, Message::Scroll(-1)),
            (DOWN, Message::Scroll(1)),
            (Key::PageUp, Message::Scroll(-10)),
            (Key::PageDown, Message::Scroll(10)),
        ],
        "",
        "choose a descriptor",
    ),
    bind(
        Histogram,
        &[
            (Key::Home, Message::ScrollTo(End::First)),
            (Key::End, Message::ScrollTo(End::Last)),
        ],
        "",
        "first, last descriptor",
    ),
    bind(
        Map,
        &[
            (LEFT, Message::Cursor(Arrow::Left)),
            (RIGHT, Message::Cursor(Arrow::Right)),
            (UP, Message::Cursor(Arrow::Up)),
            (DOWN, Message::Cursor(Arrow::Down)),
        ],
        "",
        "to the next pose",
    ),
    bind(
        Map,
        &[
            (Key::PageUp, Message::Scroll(-10)),
            (Key::PageDown, Message::Scroll(10)),
        ],
        "",
        "ten poses up, down",
    ),
    bind(
        Map,
        &[
            (Key::Home, Message::ScrollTo(End::First)),
            (Key::End, Message::ScrollTo(End::Last)),
        ],
        "",
        "to the first, the last x0",
    ),
    bind(
        Map,
        &[
            (Char('<'), Message::Explore(Exploring::Angle(-1))),
            (Char('>'), Message::Explore(Exploring::Angle(1))),
        ],
        "angle",
        "previous, next angle",
    ),
    bind(
        Map,
        &[
            (Char('('), Message::Explore(Exploring::Angle(-10))),
            (Char(')'), Message::Explore(Exploring::Angle(10))),
        ],
        "",
        "ten angles back, on",
    ),
    bind(
        Map,
        &[
            (Char('z'), Message::Explore(Exploring::Zoomed(Zoom::X, 1))),
            (Char('Z'), Message::Explore(Exploring::Zoomed(Zoom::X, -1))),
            (Char('w'), Message::Explore(Exploring::Zoomed(Zoom::Y, 1))),
            (Char('W'), Message::Explore(Exploring::Zoomed(Zoom::Y, -1))),
        ],
        "",
        "next, previous zoom x, zoom y of a picture",
    ),
    bind(
        Map,
        &[(Key::Enter, Message::Accept)],
        "to matrix",
        "put this pose onto the matrix",
    ),
    bind(
        Map,
        &[(Char('g'), Message::Explore(Exploring::Follow))],
        "list",
        "go to its imprint in the list",
    ),
    bind(
        Export,
        &[(Key::Enter, Message::Accept)],
        "write",
        "write the file",
    ),
    bind(
        Export,
        &[
            (LEFT, Message::Choose(Arrow::Left)),
            (RIGHT, Message::Choose(Arrow::Right)),
        ],
        "",
        "move in the name",
    ),
    bind(
        Export,
        &[
            (Key::Home, Message::ToEdge(End::First)),
            (Key::End, Message::ToEdge(End::Last)),
        ],
        "",
        "to its start, its end",
    ),
    bind(
        Export,
        &[
            (Key::Backspace, Message::Erase(Erase::Before)),
            (Key::Delete, Message::Erase(Erase::Under)),
        ],
        "",
        "delete a character",
    ),
    bind(
        Export,
        &[(Key::Ctrl('u'), Message::Erase(Erase::All))],
        "clear",
        "clear the name",
    ),
    bind(
        Export,
        &[
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
        ],
        "cancel",
        "write nothing",
    ),
    bind(
        Help,
        &[
            (UP, Message::Scroll(-1)),
            (DOWN, Message::Scroll(1)),
            (Key::PageUp, Message::Scroll(-10)),
            (Key::PageDown, Message::Scroll(10)),
        ],
        "scroll",
        "scroll",
    ),
    bind(
        Help,
        &[
            (Char('q'), Message::Cancel),
            (Char('?'), Message::Cancel),
            (Key::F1, Message::Cancel),
            (Key::Enter, Message::Cancel),
            (Key::Esc, Message::Cancel),
            (Key::Ctrl('g'), Message::Cancel),
        ],
        "close",
        "close",
    ),
    bind(
        Everywhere,
        &[(Key::Ctrl('l'), Message::Redraw)],
        "",
        "draw the screen anew",
    ),
    bind(
        Everywhere,
        &[(Key::Ctrl('z'), Message::Suspend)],
        "",
        "back to the shell; its fg comes back here",
    ),
    bind(
        Everywhere,
        &[(Key::Ctrl('c'), Message::Quit)],
        "",
        "close what is open; on the matrix: quit",
    ),
    bind(
        Everywhere,
        &[(Key::F1, Message::Help)],
        "",
        "the keys that mean something here",
    ),
];

/// How many rows at the head of the table make the menu.
pub const MENU: usize = 7;
