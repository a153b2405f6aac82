//! The default keys: for each place its keys with their actions, a hint for the bottom of the screen and a line of
//! help.
//!
//! Help, hints, the menu and `docs/keys.md` are made from this table; a key that is not in it does nothing. A
//! settings file can give the actions of a place other keys: [`crate::tui::keys::keymap`]. Hint and help are part of
//! the place, not of the action, because the same action means different things in different places: Enter takes a
//! figure, starts a sweep, writes a file.
//!
//! The arrows move the cursor, not `hjkl`: `l` is Load, as in the paper's menu.

use crate::tui::keys::Context;
#[allow(clippy::wildcard_imports, reason = "the table has all of them")]
use crate::tui::keys::action::*;

/// Keys in notation, their actions (the last one is that of all other keys, too), hint and help.
pub type Row = (
    &'static str,
    &'static [&'static Action],
    &'static str,
    &'static str,
);

/// A place with its name in a settings file and its title. A key without a row is looked up in the outer place.
pub type KeyPlace = (Context, &'static str, &'static str, Context, &'static [Row]);

/// The options of the menu: the first rows of the matrix.
pub const MENU: usize = 7;

/// In the order of [`Context`].
#[rustfmt::skip]
pub static PLACES: &[KeyPlace] = &[
    // The first seven rows are the menu, in its order.
    (Context::Matrix, "matrix", "On the matrix", Context::Everywhere, &[
        ("n", &[&NEW], "", "New: empty the matrix, to draw by hand"),
        ("l", &[&LOAD], "", "Load: bring a stored shape onto the matrix"),
        ("f", &[&FIGURE], "", "Figure: place one of the seven figures"),
        ("p", &[&PICTURE], "", "Picture: place a stored shape, or move the one placed"),
        ("s", &[&SAVE], "", "Save: store what is on the matrix"),
        ("d", &[&DELETE], "", "Delete: move a stored shape to the trash"),
        ("q", &[&QUIT], "", "Quit: asks first if work would be lost"),
        ("<Left><Right><Up><Down>", &[&CURSOR_LEFT, &CURSOR_RIGHT, &CURSOR_UP, &CURSOR_DOWN], "", "move the cursor"),
        ("<Home><End>", &[&FIRST_COLUMN, &LAST_COLUMN], "", "cursor to the first, the last column"),
        ("<PageUp><PageDown>", &[&FIRST_ROW, &LAST_ROW], "", "cursor to the first, the last row"),
        ("<Space>", &[&TOGGLE], "toggle", "turn the taxel under the cursor on or off"),
        ("u", &[&UNDO], "undo", "undo the last change, then earlier ones"),
        ("U<C-r>", &[&REDO], "", "redo what was undone"),
        ("=", &[&COMPARE], "", "compare with the state before the last step"),
        ("<Tab><S-Tab>", &[&REGION, &PREVIOUS_REGION], "region", "describe the next, previous piece or hole; or click it"),
        ("e", &[&EXPLORE], "explore", "Explore: all imprints of the shape, over all poses"),
        ("r", &[&RECOGNISE], "recognise", "Recognise: name the shape from its imprint"),
        ("c", &[&COVERAGE], "coverage", "coverage in shades, in percent, the imprint again"),
        ("o", &[&OUTLINE], "", "the true outline of the shape"),
        ("b", &[&RECTANGLE], "", "the rectangle with CG (G), CD (D)"),
        ("g", &[&HOLD], "hold", "hold the shape, to move it with the arrows"),
        ("w", &[&WATCH], "", "Watch: back to the frames of the watched sensor"),
        ("<S-Left><S-Right><S-Up><S-Down>", &[&NUDGE_LEFT, &NUDGE_RIGHT, &NUDGE_UP, &NUDGE_DOWN],
            "", "move the shape by a step, without holding it"),
        ("<lt>>", &[&TURN_LEFT, &TURN_RIGHT], "turn", "turn it by 1 degree, counter-clockwise, clockwise"),
        ("()", &[&TURN_LEFT_10, &TURN_RIGHT_10], "", "turn it by 10 degrees"),
        ("zZ", &[&ZOOM_IN, &ZOOM_OUT], "", "zoom a stored shape in, out, by the current step"),
        ("+-", &[&LARGER_STEP, &SMALLER_STEP], "step", "a larger, a smaller step: 0.01, 0.1, 1"),
        ("v", &[&DRAW], "", "draw a run of taxels with the arrows, or erase one"),
        ("S", &[&SENSOR], "", "Sensor: columns, rows, threshold, pitch"),
        ("i", &[&PANEL], "descriptors", "on a small screen: descriptors or matrix"),
        ("K", &[&EXPLAIN], "", "explain the descriptors: formula, unit, meaning"),
        ("yY", &[&COPY_DESCRIPTORS, &COPY_IMPRINT], "", "copy descriptors, imprint to your terminal's clipboard"),
        (":", &[&COMMAND], "", "type a command"),
        ("?", &[&HELP], "help", "Help: the keys that work here"),
    ]),
    (Context::Hold, "hold", "While a shape is held", Context::Matrix, &[
        ("<Left><Right><Up><Down>", &[&NUDGE_LEFT, &NUDGE_RIGHT, &NUDGE_UP, &NUDGE_DOWN],
            "move", "move the shape by a step"),
        ("+=-", &[&LARGER_STEP, &LARGER_STEP, &SMALLER_STEP], "step", "a larger, a smaller step: 0.01, 0.1, 1"),
        ("g<Enter>", &[&HOLD], "let go", "let the shape go where it is"),
        ("<Esc><C-g><C-c>", &[&PUT_BACK], "put back", "put it back where it was, and let go"),
    ]),
    (Context::Draw, "draw", "While drawing", Context::Matrix, &[
        ("<Left><Right><Up><Down>", &[&CURSOR_LEFT, &CURSOR_RIGHT, &CURSOR_UP, &CURSOR_DOWN],
            "draw", "draw on, in the state of the first taxel"),
        ("v<Enter><Esc><C-c>", &[&DRAW], "stop", "stop drawing"),
    ]),
    (Context::Explain, "explain", "Explaining descriptors", Context::Everywhere, &[
        ("<Left><Right>", &[&LEFT, &RIGHT], "descriptor", "the previous, the next descriptor"),
        ("<Up><Down>", &[&SCROLL_UP, &SCROLL_DOWN], "scroll", "scroll"),
        ("<PageUp><PageDown>", &[&PAGE_UP, &PAGE_DOWN], "", "ten lines up, down"),
        ("<Home><End>", &[&FIRST, &LAST], "", "the first, the last descriptor"),
        ("<Esc><C-g>qK", &[&CANCEL], "close", "back to where you were"),
        ("?", &[&HELP], "help", "these keys"),
    ]),
    (Context::Form, "form", "In a form", Context::Line, &[
        ("<Tab><S-Tab>", &[&NEXT, &PREVIOUS], "field", "next, previous field"),
        ("<Left><Right><Up><Down>", &[&LEFT, &RIGHT, &UP, &DOWN],
            "", "choose the kind (or type its letter); move; next field"),
        ("<PageUp><PageDown>", &[&INCREASE, &DECREASE], "step", "to the next 0.01 (from 10 on 0.1), the next degree"),
        ("<C-d>", &[&DEFAULTS], "defaults", "the defaults"),
        ("<Enter>", &[&ACCEPT], "accept", "accept; refused while a field is invalid"),
        ("<Esc><C-g>", &[&CANCEL], "cancel", "close it and change nothing"),
        ("?", &[&HELP], "help", "these keys"),
    ]),
    // Letters are typed into the filter, so that `q` does not close this page as it does others.
    (Context::List, "list", "In the list of shapes", Context::Line, &[
        ("<Up><Down>", &[&SCROLL_UP, &SCROLL_DOWN], "choose", "previous, next shape"),
        ("<PageUp><PageDown>", &[&PAGE_UP, &PAGE_DOWN], "", "ten shapes back, forward"),
        ("<Home><End>", &[&FIRST, &LAST], "", "first, last shape"),
        ("<Enter>", &[&ACCEPT], "accept", "accept the selected shape"),
        ("/<C-u>", &[&ERASE_ALL], "new search", "type part of a name to filter the list; / starts again"),
        ("<BS>", &[&ERASE_BEFORE], "", "delete a character of the filter"),
        ("<Esc><C-g>", &[&CANCEL], "cancel", "close it and change nothing"),
        ("?", &[&HELP], "help", "these keys"),
    ]),
    (Context::Compare, "compare", "Comparing", Context::Everywhere, &[
        ("<Tab>", &[&NEXT], "descriptors", "on a small screen: the descriptors or the imprints"),
        ("<Left><Right><Up><Down>", &[&LEFT, &RIGHT, &SCROLL_UP, &SCROLL_DOWN],
            "scroll", "scroll, if not everything fits"),
        ("<PageUp><PageDown>", &[&PAGE_UP, &PAGE_DOWN], "", "ten rows up, down"),
        ("<Home><End>", &[&FIRST, &LAST], "", "the first, the last rows"),
        ("<Esc><C-g>q=", &[&CANCEL], "close", "back to where you were"),
        ("?", &[&HELP], "help", "these keys"),
    ]),
    // `?` may be typed in a line of text, so help is F1 here and in the prompts below.
    (Context::Name, "name", "Saving", Context::Line, &[
        ("<Enter>", &[&ACCEPT], "save", "save under this name"),
        ("<Esc><C-g>", &[&CANCEL], "cancel", "do not save"),
        ("<F1>", &[&HELP], "help", "these keys"),
    ]),
    (Context::Command, "command", "In the command line", Context::Line, &[
        ("<Enter>", &[&ACCEPT], "run", "run the command"),
        ("<Tab>", &[&NEXT], "complete", "complete the word"),
        ("<Up><Down>", &[&UP, &DOWN], "earlier", "earlier commands; choose a completion"),
        ("<Esc><C-g>", &[&CANCEL], "cancel", "run nothing"),
        ("<F1>", &[&HELP], "help", "these keys"),
    ]),
    (Context::Ranges, "ranges", "Ranges of a sweep", Context::Line, &[
        ("<Tab><S-Tab>", &[&NEXT, &PREVIOUS], "field", "next, previous field"),
        ("<Left><Right><Up><Down>", &[&LEFT, &RIGHT, &UP, &DOWN],
            "", "move within and between fields; change the anchor"),
        ("<C-d>", &[&DEFAULTS], "defaults", "the defaults"),
        ("<Enter>", &[&ACCEPT], "start", "sweep all poses; refused while a range is invalid"),
        ("<Esc><C-g>", &[&CANCEL], "cancel", "close it and change nothing"),
        ("?", &[&HELP], "help", "these keys"),
    ]),
    (Context::Running, "running", "While work is under way", Context::Everywhere, &[
        ("<Esc>s<C-g>", &[&STOP], "stop", "stop; a sweep keeps what is complete"),
        ("<C-c>", &[&QUIT], "", "stop; again while it stops: quit at once"),
    ]),
    (Context::Explore, "explore", "Exploring, on every page", Context::Everywhere, &[
        ("1234", &[&IMPRINTS, &STATISTICS, &HISTOGRAM, &MAP], "", "imprints, statistics, histogram, map"),
        ("<Tab><S-Tab>", &[&NEXT_TAB, &PREVIOUS_TAB], "page", "next, previous page"),
        ("dD", &[&NEXT_DESCRIPTOR, &PREVIOUS_DESCRIPTOR],
            "descriptor", "next, previous descriptor, except on the map"),
        ("K", &[&EXPLAIN], "", "explain the chosen descriptor: formula, unit, meaning"),
        ("x", &[&EXPORT], "export", "write all imprints to a file"),
        ("e", &[&RANGES], "ranges", "explore other ranges"),
        ("?", &[&HELP], "help", "all keys"),
        ("<Esc><C-g>q", &[&CANCEL], "close", "back to the matrix; the results are kept"),
    ]),
    (Context::Imprints, "imprints", "In the list of imprints", Context::Explore, &[
        ("<Up><Down>", &[&SCROLL_UP, &SCROLL_DOWN], "", "previous, next imprint"),
        ("<PageUp><PageDown>", &[&PAGE_UP, &PAGE_DOWN], "", "ten imprints back, forward"),
        ("<Home><End>", &[&FIRST, &LAST], "", "first, last imprint"),
        ("<Enter>", &[&ACCEPT], "to matrix", "put it onto the matrix, in its first pose"),
        ("s", &[&SORT], "sort", "sort by the chosen heading; again: reversed"),
        ("<Left><Right>", &[&COLUMNS_LEFT, &COLUMNS_RIGHT], "heading", "choose a heading to sort by"),
        ("=", &[&COMPARE], "compare", "compare it with the imprint on the matrix"),
        ("g", &[&FOLLOW], "map", "go to its first pose on the map"),
    ]),
    (Context::Statistics, "statistics", "In the statistics", Context::Explore, &[
        ("<Up><Down><PageUp><PageDown>", &[&SCROLL_UP, &SCROLL_DOWN, &PAGE_UP, &PAGE_DOWN], "", "choose a descriptor"),
        ("<Home><End>", &[&FIRST, &LAST], "", "first, last descriptor"),
        ("<Enter>", &[&HISTOGRAM], "histogram", "show its histogram"),
    ]),
    (Context::Histogram, "histogram", "At the histogram", Context::Explore, &[
        ("<Up><Down><PageUp><PageDown>", &[&SCROLL_UP, &SCROLL_DOWN, &PAGE_UP, &PAGE_DOWN],
            "descriptor", "choose a descriptor"),
        ("<Home><End>", &[&FIRST, &LAST], "", "first, last descriptor"),
    ]),
    // Keys move in the grid of poses, never between its points: every pose that can be reached is part of the sweep.
    (Context::Map, "map", "On the map", Context::Explore, &[
        ("<Left><Right><Up><Down>", &[&CURSOR_LEFT, &CURSOR_RIGHT, &CURSOR_UP, &CURSOR_DOWN],
            "", "to the next pose; each letter or colour is an imprint"),
        ("+-", &[&ZOOM_IN, &ZOOM_OUT], "zoom", "zoom in, down to letters; out, to the whole range"),
        ("<PageUp><PageDown>", &[&PAGE_UP, &PAGE_DOWN], "", "ten poses up, down"),
        ("<Home><End>", &[&FIRST, &LAST], "", "to the first, the last x0"),
        ("<lt>>", &[&PREVIOUS_ANGLE, &NEXT_ANGLE], "angle", "previous, next angle"),
        ("z", &[&NEXT_ZOOM], "", "the next zoom of a stored shape"),
        ("<Enter>", &[&ACCEPT], "to matrix", "put this pose onto the matrix"),
        ("g", &[&FOLLOW], "list", "go to its imprint in the list"),
    ]),
    (Context::Export, "export", "Exporting", Context::Line, &[
        ("<Enter>", &[&ACCEPT], "write", "write the file"),
        ("<Esc><C-g>", &[&CANCEL], "cancel", "write nothing"),
        ("<F1>", &[&HELP], "help", "these keys"),
    ]),
    (Context::Recognise, "recognise", "Recognising", Context::Matrix, &[
        ("t", &[&RANDOM_TOUCH], "touch", "a random touch of a shape of the model"),
        ("ax", &[&KEEP, &FORGET], "keep, forget", "keep this touch as one of several; forget them"),
        ("o", &[&NEXT_MODEL], "model", "next model: built in, then your own"),
        ("i", &[&PANEL], "answer", "on a narrow screen: the answer or the matrix"),
        ("P", &[&POSES], "", "the outline of the fitted shape"),
        ("<Enter>", &[&ACCEPT], "", "read or train the model again"),
        ("<Esc>r<C-g>q", &[&CANCEL], "close", "back to the descriptors; stops a training"),
    ]),
    (Context::Live, "live", "Watching a sensor", Context::Everywhere, &[
        ("tT", &[&TARE, &NO_TARE], "tare", "subtract the median of the last 30 frames; no tare"),
        ("+=-", &[&THRESHOLD_UP, &THRESHOLD_UP, &THRESHOLD_DOWN], "threshold", "the threshold up, down"),
        ("%", &[&PERCENT], "", "a threshold in percent of the maximum, or in the unit"),
        ("<Space>", &[&FREEZE], "freeze", "freeze this frame, or follow the source again"),
        ("<Left><Right><Up><Down>", &[&SCROLL_UP, &SCROLL_DOWN, &SCROLL_UP, &SCROLL_DOWN],
            "scrub", "to an earlier, a later frame"),
        ("<PageUp><PageDown>", &[&SECOND_BACK, &SECOND_ON], "", "a second back, forward"),
        ("[]", &[&PREVIOUS_TOUCH, &NEXT_TOUCH], "", "to where the previous, the next touch begins"),
        ("<Home><End>", &[&FIRST, &LAST], "", "the oldest frame; follow the source"),
        ("<S-Left><S-Right><S-Up><S-Down>", &[&WINDOW_LEFT, &WINDOW_RIGHT, &WINDOW_UP, &WINDOW_DOWN],
            "other taxels", "see other taxels, if not all fit on the screen"),
        ("c", &[&FOLLOW_CONTACT], "", "keep the contact in sight again"),
        ("v", &[&NEXT_LAYER], "view", "raw values, tared values, the imprint"),
        ("f", &[&PLOT], "", "plot contact over time, or force"),
        ("#", &[&NUMBERS], "", "values as numbers, or in shades"),
        ("g", &[&OWN_RANGE], "", "scale the shades to this frame, or to all so far"),
        ("i", &[&PANEL], "", "only the numbers, or the taxels as well"),
        ("r", &[&RECORD], "record", "record all frames in a file, or stop recording"),
        ("w", &[&WATCH_AGAIN], "again", "play again; reopen a stream that has ended"),
        ("m", &[&MARK_FRAME], "", "mark this frame, or remove its mark"),
        ("o", &[&NAME_SHAPE], "name", "name the shape by the next model, or by none"),
        ("<Enter>", &[&ACCEPT], "to matrix", "take the imprint to the matrix"),
        (":", &[&COMMAND], "", "type a command, such as at-least 10 for the threshold"),
        ("?", &[&HELP], "help", "these keys"),
        ("<Esc><C-g>q", &[&CANCEL], "close", "go on from a frozen frame, then stop; w comes back"),
    ]),
    // A key without a row leaves it open.
    (Context::Question, "question", "At a question", Context::Everywhere, &[
        ("y", &[&ACCEPT], "yes", "yes"),
        ("n", &[&DECLINE], "no", "no; at the start: move the unsaved work to the trash"),
        ("s", &[&SAVE], "save first", "at the end: save first, then quit"),
        ("<Esc><C-g>q", &[&CANCEL], "cancel", "cancel, without an answer"),
        ("?", &[&HELP], "help", "these keys"),
    ]),
    (Context::Help, "help", "In the help", Context::Everywhere, &[
        ("<Up><Down>", &[&SCROLL_UP, &SCROLL_DOWN], "scroll", "scroll by a line"),
        ("<PageUp><PageDown><Space>", &[&SCREEN_UP, &SCREEN_DOWN, &SCREEN_DOWN], "", "scroll by a page"),
        ("<Home><End>", &[&FIRST, &LAST], "", "the first, the last line"),
        ("<Esc><C-g>q?<F1><Enter>", &[&CANCEL], "close", "close"),
    ]),
    // In any text field, unless its page gives the key another meaning.
    (Context::Line, "line", "In a line of text", Context::Everywhere, &[
        ("<Left><Right>", &[&LEFT, &RIGHT], "", "move in the line"),
        ("<Home><End>", &[&TO_START, &TO_END], "", "to its start, its end"),
        ("<BS><Del>", &[&ERASE_BEFORE, &ERASE_UNDER], "", "delete a character"),
        ("<C-u>", &[&ERASE_ALL], "clear", "clear the line"),
    ]),
    // Everywhere, unless the place gives the key another meaning.
    // Looked up last, so that any place can give these keys another meaning.
    (Context::Everywhere, "everywhere", "Everywhere", Context::Everywhere, &[
        ("<C-l>", &[&REDRAW], "", "redraw the screen"),
        ("<C-z>", &[&SUSPEND], "", "back to the shell; fg returns here"),
        ("<C-c>", &[&QUIT], "", "close what is open; on the matrix: quit"),
        ("<F1>", &[&HELP], "", "the keys that work here"),
    ]),
];
