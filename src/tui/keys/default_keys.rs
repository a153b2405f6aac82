//! The default keys: for each place its keys with their actions, a hint for the bottom of the screen and a line of
//! help.
//!
//! Help, hints, the menu and `docs/keys.md` are made from this table; a key that is not in it does nothing. A
//! settings file can give the actions of a place other keys: [`crate::tui::keys::keymap`]. Hint and help are part of
//! the place, not of the action, because the same action means different things in different places: Enter takes a
//! figure, starts a sweep, writes a file.
//!
//! The arrows move the cursor, not `hjkl`: `l` is Load, as in the paper's menu.

use crate::tui::keys::action;
use crate::tui::keys::key::{Arrow, Key};
use crate::tui::keys::keymap::{Binding, Context};

use Arrow::{Down, Left, Right, Up};
use Key::{
    BackTab, Backspace, Char, Ctrl, Delete, End, Enter, Esc, Home, PageDown, PageUp, ShiftArrow,
    Tab,
};

const F1: Key = Key::Function(1);
const LEFT: Key = Key::Arrow(Left);
const RIGHT: Key = Key::Arrow(Right);
const UP: Key = Key::Arrow(Up);
const DOWN: Key = Key::Arrow(Down);

/// Builds the table from rows `[key => ACTION, ...] hint help`, grouped by place. It is a macro, so that a row stays
/// on one line; the formatter would make eight of it. Notes about a place are above it.
macro_rules! table {
    ($($(#[$doc:meta])* $place:ident {$(
        [$($key:expr => $action:ident),+] $hint:literal $help:literal;
    )+})+) => {
        &[$($(Binding::row(Context::$place, &[$(($key, &action::$action)),+], $hint, $help)),+),+]
    };
}

pub static DEFAULT_KEYS: &[Binding] = table! {
    /// The first seven rows are the menu, in its order.
    Matrix {
        [Char('n') => NEW] "" "New: empty the matrix, to draw by hand";
        [Char('l') => LOAD] "" "Load: bring a stored shape onto the matrix";
        [Char('f') => FIGURE] "" "Figure: place one of the seven figures";
        [Char('p') => PICTURE] "" "Picture: place a stored shape, or move the one placed";
        [Char('s') => SAVE] "" "Save: store what is on the matrix";
        [Char('d') => DELETE] "" "Delete: move a stored shape to the trash";
        [Char('q') => QUIT] "" "Quit: asks first if work would be lost";
        [LEFT => CURSOR_LEFT, RIGHT => CURSOR_RIGHT, UP => CURSOR_UP, DOWN => CURSOR_DOWN]
            "" "move the cursor";
        [Home => FIRST_COLUMN, End => LAST_COLUMN] "" "cursor to the first, the last column";
        [PageUp => FIRST_ROW, PageDown => LAST_ROW] "" "cursor to the first, the last row";
        [Char(' ') => TOGGLE] "toggle" "turn the taxel under the cursor on or off";
        [Char('u') => UNDO] "undo" "undo the last change, then earlier ones";
        [Char('U') => REDO, Ctrl('r') => REDO] "" "redo what was undone";
        [Char('=') => COMPARE] "" "compare with the state before the last step";
        [Char('H') => HISTORY] "" "History: all steps, to go back to any of them";
        [Tab => REGION, BackTab => PREVIOUS_REGION]
            "region" "describe the next, the previous piece or hole";
        [Char('e') => EXPLORE] "explore" "Explore: all imprints of the shape, over all poses";
        [Char('r') => RECOGNISE] "recognise" "Recognise: name the shape from its imprint";
        [Char('c') => COVERAGE] "coverage" "coverage in shades, in percent, the imprint again";
        [Char('o') => OUTLINE] "" "the true outline of the shape";
        [Char('b') => RECTANGLE] "" "the rectangle with CG (G), CD (D)";
        [Char('g') => HOLD] "hold" "hold the shape, to move it with the arrows";
        [Char('w') => WATCH] "" "Watch: back to the frames of the watched sensor";
        [ShiftArrow(Left) => NUDGE_LEFT, ShiftArrow(Right) => NUDGE_RIGHT,
            ShiftArrow(Up) => NUDGE_UP, ShiftArrow(Down) => NUDGE_DOWN]
            "" "move the shape by a step, without holding it";
        [Char('<') => TURN_LEFT, Char('>') => TURN_RIGHT]
            "turn" "turn it by 1 degree, counter-clockwise, clockwise";
        [Char('(') => TURN_LEFT_10, Char(')') => TURN_RIGHT_10] "" "turn it by 10 degrees";
        [Char('z') => ZOOM_IN, Char('Z') => ZOOM_OUT]
            "" "zoom a picture in, out, by the current step";
        [Char('+') => LARGER_STEP, Char('-') => SMALLER_STEP]
            "step" "a larger, a smaller step: 0.01, 0.1, 1";
        [Char('S') => SENSOR] "" "Sensor: columns, rows, threshold, pitch";
        [Char('i') => PANEL] "descriptors" "on a small screen: descriptors or matrix";
        [Char('y') => COPY_DESCRIPTORS, Char('Y') => COPY_IMPRINT]
            "" "copy descriptors, imprint to your terminal's clipboard";
        [Char(':') => COMMAND] "" "type a command";
        [Char('?') => HELP] "help" "Help: all keys";
    }

    Hold {
        [LEFT => NUDGE_LEFT, RIGHT => NUDGE_RIGHT, UP => NUDGE_UP, DOWN => NUDGE_DOWN]
            "move" "move the shape by a step";
        [Char('+') => LARGER_STEP, Char('=') => LARGER_STEP, Char('-') => SMALLER_STEP]
            "step" "a larger, a smaller step: 0.01, 0.1, 1";
        [Char('g') => HOLD, Enter => HOLD] "let go" "let the shape go where it is";
        [Esc => PUT_BACK, Ctrl('g') => PUT_BACK, Ctrl('c') => PUT_BACK]
            "put back" "put it back where it was, and let go";
    }

    Form {
        [Tab => NEXT, BackTab => PREVIOUS] "field" "next, previous field";
        [LEFT => LEFT, RIGHT => RIGHT, UP => UP, DOWN => DOWN]
            "" "choose the kind (or type its letter); move; next field";
        [PageUp => INCREASE, PageDown => DECREASE]
            "step" "to the next 0.01 (from 10 on 0.1), the next degree";
        [Ctrl('d') => DEFAULTS] "defaults" "the defaults, not what was accepted last";
        [Enter => ACCEPT] "accept" "accept; refused while a field is invalid";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "cancel" "close it and change nothing";
        [Char('?') => HELP] "help" "these keys";
    }

    /// A key without a row leaves it open.
    Question {
        [Char('y') => ACCEPT] "yes" "yes";
        [Char('n') => DECLINE] "no" "no; at the start: move the unsaved work to the trash";
        [Char('s') => SAVE] "save first" "at the end: save first, then quit";
        [Esc => CANCEL, Ctrl('g') => CANCEL, Char('q') => CANCEL] "cancel" "cancel, without an answer";
        [Char('?') => HELP] "help" "these keys";
    }

    /// Letters are typed into the filter, so that `q` does not close this page as it does others.
    List {
        [UP => SCROLL_UP, DOWN => SCROLL_DOWN] "choose" "previous, next shape";
        [PageUp => PAGE_UP, PageDown => PAGE_DOWN] "" "ten shapes back, forward";
        [Home => FIRST, End => LAST] "" "first, last shape";
        [Enter => ACCEPT] "accept" "accept the selected shape";
        [Char('/') => ERASE_ALL, Ctrl('u') => ERASE_ALL]
            "new search" "type part of a name to filter the list; / starts again";
        [Backspace => ERASE_BEFORE] "" "delete a character of the filter";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "cancel" "close it and change nothing";
        [Char('?') => HELP] "help" "these keys";
    }

    History {
        [UP => SCROLL_UP, DOWN => SCROLL_DOWN] "choose" "earlier, later step";
        [PageUp => PAGE_UP, PageDown => PAGE_DOWN] "" "ten steps back, forward";
        [Home => FIRST, End => LAST] "" "the start, the latest step";
        [Enter => ACCEPT] "go there" "go to the state after this step";
        [Char('=') => COMPARE] "compare" "compare that state with the present one";
        [Esc => CANCEL, Ctrl('g') => CANCEL, Char('q') => CANCEL, Char('H') => CANCEL]
            "close" "leave everything as it is";
        [Char('?') => HELP] "help" "these keys";
    }

    Compare {
        [Tab => NEXT, BackTab => PREVIOUS] "view" "show the differences, the first, or the second";
        [LEFT => LEFT, RIGHT => RIGHT, UP => SCROLL_UP, DOWN => SCROLL_DOWN]
            "scroll" "scroll, if not everything fits";
        [PageUp => PAGE_UP, PageDown => PAGE_DOWN] "" "ten rows up, down";
        [Home => FIRST, End => LAST] "" "the first, the last rows";
        [Esc => CANCEL, Ctrl('g') => CANCEL, Char('q') => CANCEL, Char('=') => CANCEL]
            "close" "back to where you were";
        [Char('?') => HELP] "help" "these keys";
    }

    /// `?` may be typed in a line of text, so help is F1 here and in the prompts below.
    Name {
        [Enter => ACCEPT] "save" "save under this name";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "cancel" "do not save";
        [F1 => HELP] "help" "these keys";
    }

    Command {
        [Enter => ACCEPT] "run" "run the command";
        [Tab => NEXT] "complete" "complete the word";
        [UP => UP, DOWN => DOWN] "earlier" "earlier commands; choose a completion";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "cancel" "run nothing";
        [F1 => HELP] "help" "these keys";
    }

    Ranges {
        [Tab => NEXT, BackTab => PREVIOUS] "field" "next, previous field";
        [LEFT => LEFT, RIGHT => RIGHT, UP => UP, DOWN => DOWN]
            "" "move within and between fields; change the anchor";
        [Ctrl('d') => DEFAULTS] "defaults" "the defaults, not what was accepted last";
        [Enter => ACCEPT] "start" "sweep all poses; refused while a range is invalid";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "cancel" "close it and change nothing";
        [Char('?') => HELP] "help" "these keys";
    }

    Running {
        [Esc => STOP, Char('s') => STOP, Ctrl('g') => STOP]
            "stop" "stop; a sweep keeps what is complete";
        [Ctrl('c') => QUIT] "" "stop; again while it stops: quit at once";
    }

    Explore {
        [Char('1') => IMPRINTS,
            Char('2') => STATISTICS,
            Char('3') => HISTOGRAM,
            Char('4') => MAP,
            Char('5') => SCATTER,
            Char('6') => ANGLES] "" "imprints, statistics, histogram, map, scatter, angles";
        [Tab => NEXT_TAB, BackTab => PREVIOUS_TAB]
            "page" "next, previous page";
        [Char('d') => NEXT_DESCRIPTOR, Char('D') => PREVIOUS_DESCRIPTOR]
            "descriptor" "next, previous descriptor, except on the map";
        [Char('x') => EXPORT]
            "export" "write all imprints, or this page's numbers or drawing";
        [Char('e') => RANGES] "ranges" "explore other ranges";
        [Char('?') => HELP] "help" "all keys";
        [Esc => CANCEL, Ctrl('g') => CANCEL, Char('q') => CANCEL]
            "close" "back to the matrix; the results are kept";
    }

    Imprints {
        [UP => SCROLL_UP, DOWN => SCROLL_DOWN] "" "previous, next imprint";
        [PageUp => PAGE_UP, PageDown => PAGE_DOWN] "" "ten imprints back, forward";
        [Home => FIRST, End => LAST] "" "first, last imprint";
        [Enter => ACCEPT] "to matrix" "put it onto the matrix, in its first pose";
        [Char('/') => FILTER, Char('f') => FILTER]
            "filter" "show only imprints that fit, such as na>=40 holes=0";
        [Char('s') => SORT] "sort" "sort by the chosen heading; again: reversed";
        [LEFT => COLUMNS_LEFT, RIGHT => COLUMNS_RIGHT]
            "heading" "choose a heading to sort by";
        [Char('#') => SORT_BY_FIRST_POSE, Char('n') => SORT_BY_POSES,
            Char('c') => SORT_BY_PIECES, Char('h') => SORT_BY_HOLES,
            Char('v') => SORT_BY_VALUE]
            "" "sort by #, poses, pieces, holes, value";
        [Char('=') => COMPARE] "compare" "compare it with the imprint on the matrix";
        [Char('j') => FIND] "jump" "jump to the imprint that is on the matrix";
        [Char('g') => FOLLOW] "map" "go to its first pose on the map";
    }

    Statistics {
        [UP => SCROLL_UP, DOWN => SCROLL_DOWN, PageUp => PAGE_UP, PageDown => PAGE_DOWN]
            "" "choose a descriptor";
        [Home => FIRST, End => LAST] "" "first, last descriptor";
        [Enter => HISTOGRAM] "histogram" "show its histogram";
    }

    Histogram {
        [UP => SCROLL_UP, DOWN => SCROLL_DOWN, PageUp => PAGE_UP, PageDown => PAGE_DOWN]
            "descriptor" "choose a descriptor";
        [Home => FIRST, End => LAST] "" "first, last descriptor";
    }

    /// Keys move in the grid of poses, never between its points: every pose that can be reached is part of the sweep.
    Map {
        [LEFT => CURSOR_LEFT, RIGHT => CURSOR_RIGHT, UP => CURSOR_UP, DOWN => CURSOR_DOWN]
            "" "to the next pose; each letter or colour is an imprint";
        [Char('+') => ZOOM_IN, Char('-') => ZOOM_OUT]
            "zoom" "zoom in, down to letters; out, to the whole range";
        [PageUp => PAGE_UP, PageDown => PAGE_DOWN] "" "ten poses up, down";
        [Home => FIRST, End => LAST] "" "to the first, the last x0";
        [Char('<') => PREVIOUS_ANGLE, Char('>') => NEXT_ANGLE]
            "angle" "previous, next angle";
        [Char('(') => TEN_ANGLES_BACK, Char(')') => TEN_ANGLES_ON]
            "" "ten angles back, forward";
        [Char('z') => NEXT_ZOOM_X, Char('Z') => PREVIOUS_ZOOM_X,
            Char('w') => NEXT_ZOOM_Y, Char('W') => PREVIOUS_ZOOM_Y]
            "" "next, previous zoom x, zoom y of a picture";
        [Enter => ACCEPT] "to matrix" "put this pose onto the matrix";
        [Char('g') => FOLLOW] "list" "go to its imprint in the list";
    }

    Scatter {
        [UP => SCROLL_UP, DOWN => SCROLL_DOWN, PageUp => PAGE_UP, PageDown => PAGE_DOWN]
            "y axis" "choose the descriptor of the vertical axis";
        [Home => FIRST, End => LAST] "" "first, last descriptor for that axis";
        [LEFT => COLUMNS_LEFT, RIGHT => COLUMNS_RIGHT]
            "x axis" "choose the descriptor of the horizontal axis";
        [Char('/') => FILTER, Char('f') => FILTER]
            "filter" "show only imprints that fit, such as na>=40 holes=0";
        [Enter => ACCEPT] "to matrix" "put the selected imprint onto the matrix";
        [Char('j') => FIND] "jump" "jump to the imprint that is on the matrix";
        [Char('g') => FOLLOW] "map" "go to its first pose on the map";
    }

    Angles {
        [UP => SCROLL_UP, DOWN => SCROLL_DOWN, PageUp => PAGE_UP, PageDown => PAGE_DOWN]
            "descriptor" "choose a descriptor";
        [Home => FIRST, End => LAST] "" "first, last descriptor";
        [LEFT => PREVIOUS_ANGLE, RIGHT => NEXT_ANGLE, Char('<') => PREVIOUS_ANGLE, Char('>') => NEXT_ANGLE]
            "angle" "previous, next angle";
        [Char('(') => TEN_ANGLES_BACK, Char(')') => TEN_ANGLES_ON]
            "" "ten angles back, forward";
        [Enter => ACCEPT] "to matrix" "put the pose of the map at this angle onto the matrix";
        [Char('g') => FOLLOW] "list" "go to the imprint of that pose in the list";
    }

    Filter {
        [Enter => ACCEPT] "keep" "keep the filter; an empty one shows all imprints";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "cancel" "leave the list as it was";
        [F1 => HELP] "help" "these keys";
    }

    Export {
        [Enter => ACCEPT] "write" "write the file";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "cancel" "write nothing";
        [F1 => HELP] "help" "these keys";
    }

    Recognise {
        [Char('t') => RANDOM_TOUCH] "touch" "a random touch of a shape of the model";
        [Char('a') => KEEP, Char('x') => FORGET]
            "keep, forget" "keep this touch as one of several; forget them";
        [Char('o') => NEXT_MODEL, Char('O') => PREVIOUS_MODEL]
            "other model" "next, previous model: built in, then your own";
        [Char('v') => CONFUSION] "confusion" "which shapes are confused with which";
        [Char('i') => PANEL] "answer" "on a narrow screen: the answer or the matrix";
        [Char('P') => POSES] "" "outlines of the likeliest pose and of others";
        [Enter => ACCEPT] "" "train the model after a stop";
        [Esc => CANCEL, Char('r') => CANCEL, Ctrl('g') => CANCEL, Char('q') => CANCEL]
            "close" "stop training; back to the descriptors";
    }

    Confusion {
        [LEFT => CURSOR_LEFT, RIGHT => CURSOR_RIGHT, UP => CURSOR_UP, DOWN => CURSOR_DOWN]
            "cell" "to another cell";
        [PageUp => PAGE_UP, PageDown => PAGE_DOWN] "" "ten rows up, down";
        [Home => FIRST, End => LAST] "" "first, last cell";
        [Enter => ACCEPT] "to matrix" "put the imprint of the cell onto the matrix";
        [Char('?') => HELP] "help" "these keys";
        [Esc => CANCEL, Ctrl('g') => CANCEL, Char('q') => CANCEL] "close" "back to Recognise";
    }

    Live {
        [Char('t') => TARE, Char('T') => NO_TARE]
            "tare" "subtract the median of the last 30 frames; no tare";
        [Char('+') => THRESHOLD_UP, Char('=') => THRESHOLD_UP, Char('-') => THRESHOLD_DOWN]
            "threshold" "the threshold up, down";
        [Char('%') => PERCENT] "" "a threshold in percent of the maximum, or in the unit";
        [Char(' ') => FREEZE] "freeze" "freeze this frame, or follow the source again";
        [LEFT => SCROLL_UP, RIGHT => SCROLL_DOWN, UP => SCROLL_UP, DOWN => SCROLL_DOWN]
            "scrub" "to an earlier, a later frame";
        [PageUp => SECOND_BACK, PageDown => SECOND_ON] "" "a second back, forward";
        [Char('[') => PREVIOUS_TOUCH, Char(']') => NEXT_TOUCH] "" "to where the previous, the next touch begins";
        [Home => FIRST, End => LAST] "" "the oldest frame; follow the source";
        [ShiftArrow(Left) => WINDOW_LEFT, ShiftArrow(Right) => WINDOW_RIGHT,
            ShiftArrow(Up) => WINDOW_UP, ShiftArrow(Down) => WINDOW_DOWN]
            "other taxels" "see other taxels, if not all fit on the screen";
        [Char('c') => FOLLOW_CONTACT] "" "keep the contact in sight again";
        [Char('p') => PEAK_HOLD] "hold" "hold the largest value of each cell, or release it";
        [Char('v') => NEXT_LAYER] "view" "raw values, tared values, the imprint";
        [Char('f') => PLOT] "" "plot contact over time, or force";
        [Char('#') => NUMBERS] "" "values as numbers, or in shades";
        [Char('g') => OWN_RANGE] "" "scale the shades to this frame, or to all so far";
        [Char('i') => PANEL] "" "only the numbers, or the taxels as well";
        [Char('r') => RECORD] "record" "record all frames in a file, or stop recording";
        [Char('w') => WATCH_AGAIN] "again" "play again; reopen a stream that has ended";
        [Char('m') => MARK_FRAME] "" "mark this frame, or remove its mark";
        [Char('o') => NAME_SHAPE] "name" "name the shape by the next model, or by none";
        [Enter => ACCEPT] "to matrix" "take the imprint to the matrix";
        [Char(':') => COMMAND] "" "type a command, such as at-least 10 for the threshold";
        [Char('?') => HELP] "help" "these keys";
        [Esc => CANCEL, Ctrl('g') => CANCEL, Char('q') => CANCEL]
            "close" "back to the source from a frozen frame, then stop watching; w on the matrix comes back";
    }

    /// Esc only leaves the search first, so that it does not close too much; the other keys close help at once.
    Help {
        [UP => SCROLL_UP, DOWN => SCROLL_DOWN] "scroll" "scroll by a line";
        [PageUp => SCREEN_UP, PageDown => SCREEN_DOWN, Char(' ') => SCREEN_DOWN]
            "" "scroll by a page";
        [Home => FIRST, End => LAST] "" "the first, the last line";
        [Char('/') => SEARCH] "search" "search for a key or what it does";
        [Char('n') => NEXT_MATCH, Char('N') => PREVIOUS_MATCH] "match" "next, previous match";
        [Char('q') => QUIT, Char('?') => QUIT, F1 => QUIT, Enter => QUIT] "close" "close";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "" "leave the search; without one: close";
    }

    Search {
        [Enter => ACCEPT] "keep" "keep the search, to go to other matches";
        [Esc => CANCEL, Ctrl('g') => CANCEL] "cancel" "back to where the search began";
        [F1 => HELP] "help" "these keys";
    }

    Line {
        [LEFT => LEFT, RIGHT => RIGHT] "" "move in the line";
        [Home => TO_START, End => TO_END] "" "to its start, its end";
        [Backspace => ERASE_BEFORE, Delete => ERASE_UNDER] "" "delete a character";
        [Ctrl('u') => ERASE_ALL] "clear" "clear the line";
    }

    /// Looked up last, so that any place can give these keys another meaning.
    Everywhere {
        [Ctrl('l') => REDRAW] "" "redraw the screen";
        [Ctrl('z') => SUSPEND] "" "back to the shell; fg returns here";
        [Ctrl('c') => QUIT] "" "close what is open; on the matrix: quit";
        [F1 => HELP] "" "the keys that work here";
    }
};

pub const MENU: usize = 7;
