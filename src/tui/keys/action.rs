//! The table of actions: everything that a user can ask for by a key or after `:`.
//!
//! ```text
//! alone            CURSOR_LEFT "cursor-left" ["cursor left"] Message::Cursor(Arrow::Left);
//!                  constant    name          spellings       message
//!                  KEEP "keep" [] Recognise(RecogniseMessage::Keep), "keep this touch as one of several";
//!                                                                    what it does, if the help of its key does not say it
//! with arguments   "move" Arguments::Distance, "move the shape right and down, in cells";
//!                  name   what follows the name  what it does, if no key has an action of this name
//! ```
//! Everything else refers to these rows. [`crate::tui::keys::default_keys`] gives them keys, with a hint and a line
//! of help for each place; a settings file gives them other keys, by name; and [`crate::tui::prompt::commands`] makes
//! the `:` commands from them.

use taxel_core::pose::Axis;

use crate::tui::app::message::{Copied, Endpoint, Erase, Layer, Message, Purpose};
use crate::tui::explore::message::{ExploreMessage, ExploreTab, ListColumn};
use crate::tui::keys::key::Arrow;
use crate::tui::live::message::LiveMessage;
use crate::tui::recognise::state::RecogniseMessage;
use ExploreMessage::{Along, Angle, Columns, Feature, NextTab, Sort};
use Message::{Explore, Recognise};

#[derive(Debug, PartialEq)]
pub struct Action {
    pub name: &'static str,
    pub spellings: &'static [&'static str],
    pub does: Does,
    pub help: &'static str,
}

#[derive(Debug, PartialEq)]
pub enum Does {
    Message(Message),
    With(Arguments),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arguments {
    Shape(Purpose),
    Deleted,
    Name,
    File(FilePurpose),
    Figure,
    Sensor,
    Ranges,
    /// An angle in degrees.
    Degrees,
    Taxel,
    Distance,
    Model,
    Seed,
    FrameSource,
    Threshold,
    FrameSize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePurpose {
    Open,
    Write,
}

impl Action {
    pub fn message(&self) -> Option<&Message> {
        match &self.does {
            Does::Message(message) => Some(message),
            Does::With(_) => None,
        }
    }

    pub fn arguments(&self) -> Option<Arguments> {
        match self.does {
            Does::Message(_) => None,
            Does::With(arguments) => Some(arguments),
        }
    }

    pub fn sends(&self, message: &Message) -> bool {
        self.message() == Some(message)
    }
}

impl Arguments {
    pub fn form(self) -> &'static str {
        match self {
            Self::Shape(_) | Self::Deleted | Self::Name => "NAME",
            Self::File(_) => "FILE",
            Self::Figure => "KIND --side 3 ...",
            Self::Sensor => "--columns 32 ...",
            Self::Ranges => "--x0 5:5.99:0.01 ...",
            Self::Degrees => "DEGREES",
            Self::Taxel => "COLUMN ROW",
            Self::Distance => "DX DY",
            Self::Model => "MODEL",
            Self::Seed => "NUMBER",
            Self::FrameSource => "SOURCE --baud 9600 ...",
            Self::Threshold => "VALUE",
            Self::FrameSize => "COLUMNSxROWS",
        }
    }

    pub fn is_name(self) -> bool {
        matches!(
            self,
            Self::Shape(_)
                | Self::Deleted
                | Self::Name
                | Self::Model
                | Self::File(_)
                | Self::FrameSource
        )
    }
}

/// Builds the table from rows `CONSTANT "name" ["spelling"…] message, "help"` and `"name" arguments, "help"`; the help
/// may be left out. It is a macro, so that the default keys can name each row and the compiler checks the
/// names.
macro_rules! actions {
    (
        alone {$($constant:ident $name:literal [$($spelling:literal),*] $message:expr $(, $help:literal)?;)+}
        with_arguments {$($command:literal $arguments:expr $(, $use:literal)?;)+}
    ) => {
        $(
            #[doc = concat!("`", $name, "`.")]
            pub static $constant: Action = Action {
                name: $name,
                spellings: &[$($spelling),*],
                does: Does::Message($message),
                help: concat!($($help)?),
            };
        )+

        pub static ACTIONS: &[&Action] = &[
            $(&$constant,)+
            $(&Action {
                name: $command,
                spellings: &[],
                does: Does::With($arguments),
                help: concat!($($use)?),
            }),+
        ];
    };
}

actions! {
    alone {
        NEW "new" [] Message::New;
        LOAD "load" [] Message::Load;
        FIGURE "figure" [] Message::Figure;
        PICTURE "picture" [] Message::Picture;
        SAVE "save" [] Message::Save;
        DELETE "delete" [] Message::Delete;
        QUIT "quit" [] Message::Quit;
        QUIT_NOW "quit!" [] Message::QuitNow, "quit without asking about unsaved work";
        CURSOR_LEFT "cursor-left" ["cursor left"] Message::Cursor(Arrow::Left);
        CURSOR_RIGHT "cursor-right" ["cursor right"] Message::Cursor(Arrow::Right);
        CURSOR_UP "cursor-up" ["cursor up"] Message::Cursor(Arrow::Up);
        CURSOR_DOWN "cursor-down" ["cursor down"] Message::Cursor(Arrow::Down);
        FIRST_COLUMN "first-column" ["cursor start"] Message::ToColumn(Endpoint::First);
        LAST_COLUMN "last-column" ["cursor end"] Message::ToColumn(Endpoint::Last);
        FIRST_ROW "first-row" ["cursor top"] Message::ToRow(Endpoint::First);
        LAST_ROW "last-row" ["cursor bottom"] Message::ToRow(Endpoint::Last);
        TOGGLE "toggle" [] Message::Toggle;
        UNDO "undo" [] Message::Undo;
        REDO "redo" [] Message::Redo;
        REGION "region" ["region next"] Message::Region(1);
        PREVIOUS_REGION "previous-region" ["region previous"] Message::Region(-1);
        COVERAGE "coverage" [] Message::Display;
        OUTLINE "outline" [] Message::Layer(Layer::Outline), "show or hide the true outline";
        RECTANGLE "rectangle" [] Message::Layer(Layer::Rectangle), "show or hide the rectangle with CG (G), CD (D)";
        HOLD "hold" [] Message::Hold;
        PUT_BACK "put-back" [] Message::PutBack;
        COMPARE "compare" [] Message::Compare;
        HISTORY "history" [] Message::History;
        NUDGE_LEFT "nudge-left" ["nudge left"] Message::Nudge(Arrow::Left);
        NUDGE_RIGHT "nudge-right" ["nudge right"] Message::Nudge(Arrow::Right);
        NUDGE_UP "nudge-up" ["nudge up"] Message::Nudge(Arrow::Up);
        NUDGE_DOWN "nudge-down" ["nudge down"] Message::Nudge(Arrow::Down);
        TURN_LEFT "turn-left" [] Message::Turn(-1.0), "turn the shape counter-clockwise by 1 degree";
        TURN_RIGHT "turn-right" [] Message::Turn(1.0), "turn the shape clockwise by 1 degree";
        TURN_LEFT_10 "turn-left-10" [] Message::Turn(-10.0), "turn the shape counter-clockwise by 10 degrees";
        TURN_RIGHT_10 "turn-right-10" [] Message::Turn(10.0), "turn the shape clockwise by 10 degrees";
        ZOOM_IN "zoom-in" ["zoom in"] Message::Zoom(1);
        ZOOM_OUT "zoom-out" ["zoom out"] Message::Zoom(-1);
        SENSOR "sensor" [] Message::Sensor;
        PANEL "panel" [] Message::SwitchPane;
        COPY_DESCRIPTORS "copy-descriptors" ["copy", "copy descriptors"] Message::Copy(Copied::Descriptors);
        COPY_IMPRINT "copy-imprint" ["copy imprint"] Message::Copy(Copied::Imprint);
        COMMAND "command" [] Message::Command;
        HELP "help" [] Message::Help;
        LARGER_STEP "larger-step" ["step larger"] Message::NudgeStep(1);
        SMALLER_STEP "smaller-step" ["step smaller"] Message::NudgeStep(-1);
        NEXT "next" [] Message::Field(1);
        PREVIOUS "previous" [] Message::Field(-1);
        LEFT "left" [] Message::Choose(Arrow::Left);
        RIGHT "right" [] Message::Choose(Arrow::Right);
        UP "up" [] Message::Choose(Arrow::Up);
        DOWN "down" [] Message::Choose(Arrow::Down);
        INCREASE "increase" [] Message::Step(1);
        DECREASE "decrease" [] Message::Step(-1);
        DEFAULTS "defaults" [] Message::Defaults;
        ERASE_BEFORE "erase-before" [] Message::Erase(Erase::Before);
        ERASE_UNDER "erase-under" [] Message::Erase(Erase::Under);
        ERASE_ALL "erase-all" [] Message::Erase(Erase::All);
        TO_START "to-start" [] Message::ToEdge(Endpoint::First);
        TO_END "to-end" [] Message::ToEdge(Endpoint::Last);
        ACCEPT "accept" [] Message::Accept;
        CANCEL "cancel" [] Message::Cancel;
        DECLINE "decline" [] Message::Decline;
        SCROLL_UP "scroll-up" [] Message::Scroll(-1);
        SCROLL_DOWN "scroll-down" [] Message::Scroll(1);
        PAGE_UP "page-up" [] Message::Scroll(-10);
        PAGE_DOWN "page-down" [] Message::Scroll(10);
        SCREEN_UP "screen-up" [] Message::ScrollScreen(-1);
        SCREEN_DOWN "screen-down" [] Message::ScrollScreen(1);
        FIRST "first" [] Message::ScrollTo(Endpoint::First);
        LAST "last" [] Message::ScrollTo(Endpoint::Last);
        SEARCH "search" [] Message::Search;
        NEXT_MATCH "next-match" [] Message::Match(1);
        PREVIOUS_MATCH "previous-match" [] Message::Match(-1);
        EXPLORE "explore" [] Explore(ExploreMessage::Open);
        RANGES "ranges" [] Explore(ExploreMessage::Ranges);
        STOP "stop" [] Explore(ExploreMessage::Stop);
        IMPRINTS "imprints" [] Explore(ExploreMessage::Tab(ExploreTab::Imprints));
        STATISTICS "statistics" [] Explore(ExploreMessage::Tab(ExploreTab::Statistics));
        HISTOGRAM "histogram" [] Explore(ExploreMessage::Tab(ExploreTab::Histogram));
        MAP "map" [] Explore(ExploreMessage::Tab(ExploreTab::Map));
        SCATTER "scatter" [] Explore(ExploreMessage::Tab(ExploreTab::Scatter));
        ANGLES "angles" [] Explore(ExploreMessage::Tab(ExploreTab::Angles));
        NEXT_TAB "next-page" [] Explore(NextTab(1));
        PREVIOUS_TAB "previous-page" [] Explore(NextTab(-1));
        NEXT_DESCRIPTOR "next-descriptor" [] Explore(Feature(1));
        PREVIOUS_DESCRIPTOR "previous-descriptor" [] Explore(Feature(-1));
        COLUMNS_RIGHT "columns-right" [] Explore(Columns(1));
        COLUMNS_LEFT "columns-left" [] Explore(Columns(-1));
        SORT "sort" [] Explore(ExploreMessage::SortHere);
        SORT_BY_POSES "sort-by-poses" [] Explore(Sort(ListColumn::Poses));
        SORT_BY_FIRST_POSE "sort-by-first-pose" [] Explore(Sort(ListColumn::FirstPose));
        SORT_BY_VALUE "sort-by-value" [] Explore(Sort(ListColumn::Value));
        SORT_BY_PIECES "sort-by-pieces" [] Explore(Sort(ListColumn::Pieces));
        SORT_BY_HOLES "sort-by-holes" [] Explore(Sort(ListColumn::Holes));
        FILTER "filter" [] Explore(ExploreMessage::Filter);
        FIND "find" [] Explore(ExploreMessage::Find);
        FOLLOW "follow" [] Explore(ExploreMessage::Follow);
        EXPORT "export" [] Explore(ExploreMessage::Export);
        NEXT_ANGLE "next-angle" [] Explore(Angle(1));
        PREVIOUS_ANGLE "previous-angle" [] Explore(Angle(-1));
        TEN_ANGLES_ON "ten-angles-on" [] Explore(Angle(10));
        TEN_ANGLES_BACK "ten-angles-back" [] Explore(Angle(-10));
        NEXT_ZOOM_X "next-zoom-x" [] Explore(Along(Axis::ZoomX, 1));
        PREVIOUS_ZOOM_X "previous-zoom-x" [] Explore(Along(Axis::ZoomX, -1));
        NEXT_ZOOM_Y "next-zoom-y" [] Explore(Along(Axis::ZoomY, 1));
        PREVIOUS_ZOOM_Y "previous-zoom-y" [] Explore(Along(Axis::ZoomY, -1));
        RECOGNISE "recognise" [] Recognise(RecogniseMessage::Open);
        RANDOM_TOUCH "random-touch" [] Recognise(RecogniseMessage::Touch);
        KEEP "keep" [] Recognise(RecogniseMessage::Keep), "keep this touch as one of several";
        FORGET "forget" [] Recognise(RecogniseMessage::Forget), "forget the touches that were kept";
        NEXT_MODEL "next-model" [] Recognise(RecogniseMessage::NextModel(1)), "the next model";
        PREVIOUS_MODEL "previous-model" [] Recognise(RecogniseMessage::NextModel(-1)), "the previous model";
        CONFUSION "confusion" [] Recognise(RecogniseMessage::Confusion);
        POSES "poses" [] Recognise(RecogniseMessage::Poses);
        WATCH "watch" [] Message::Live(LiveMessage::Open);
        WATCH_AGAIN "watch-again" [] Message::Live(LiveMessage::Again);
        TARE "tare" [] Message::Live(LiveMessage::Tare);
        NO_TARE "no-tare" [] Message::Live(LiveMessage::NoTare);
        THRESHOLD_UP "threshold-up" [] Message::Live(LiveMessage::Threshold(1));
        THRESHOLD_DOWN "threshold-down" [] Message::Live(LiveMessage::Threshold(-1));
        PERCENT "percent" [] Message::Live(LiveMessage::Percent);
        FREEZE "freeze" [] Message::Live(LiveMessage::Freeze);
        SECOND_BACK "second-back" [] Message::Live(LiveMessage::Second(-1));
        SECOND_ON "second-on" [] Message::Live(LiveMessage::Second(1));
        PREVIOUS_TOUCH "previous-touch" [] Message::Live(LiveMessage::Touch(-1));
        NEXT_TOUCH "next-touch" [] Message::Live(LiveMessage::Touch(1));
        PEAK_HOLD "peak-hold" [] Message::Live(LiveMessage::PeakHold);
        NEXT_LAYER "next-layer" [] Message::Live(LiveMessage::NextLayer);
        PLOT "plot" [] Message::Live(LiveMessage::Plot);
        NUMBERS "numbers" [] Message::Live(LiveMessage::Numbers);
        OWN_RANGE "own-range" [] Message::Live(LiveMessage::OwnRange);
        WINDOW_LEFT "window-left" [] Message::Live(LiveMessage::Window(Arrow::Left));
        WINDOW_RIGHT "window-right" [] Message::Live(LiveMessage::Window(Arrow::Right));
        WINDOW_UP "window-up" [] Message::Live(LiveMessage::Window(Arrow::Up));
        WINDOW_DOWN "window-down" [] Message::Live(LiveMessage::Window(Arrow::Down));
        FOLLOW_CONTACT "follow-contact" [] Message::Live(LiveMessage::FollowContact);
        RECORD "record" [] Message::Live(LiveMessage::Record);
        MARK_FRAME "mark-frame" [] Message::Live(LiveMessage::Mark);
        NAME_SHAPE "name-shape" [] Message::Live(LiveMessage::NameShape);
        REDRAW "redraw" [] Message::Redraw;
        SUSPEND "suspend" [] Message::Suspend;
    }

    with_arguments {
        "at-least" Arguments::Threshold, "Watch: the threshold, in the sensor's unit";
        "compare" Arguments::Shape(Purpose::Compare), "compare with a stored shape, or with the step before";
        "cursor" Arguments::Taxel, "move the cursor, or put it on a taxel";
        "delete" Arguments::Shape(Purpose::Delete);
        "explore" Arguments::Ranges, "Explore: all imprints in these ranges";
        "figure" Arguments::Figure;
        "load" Arguments::Shape(Purpose::Load);
        "move" Arguments::Distance, "move the shape right and down, in cells";
        "open" Arguments::File(FilePurpose::Open), "open a shape or an imprint from a file";
        "picture" Arguments::Shape(Purpose::Picture);
        "recognise" Arguments::Model, "Recognise: which shape of this model left the imprint";
        "restore" Arguments::Deleted, "bring back this deleted shape, or the one deleted last";
        "save" Arguments::Name;
        "seed" Arguments::Seed, "set the seed of random touches";
        "sensor" Arguments::Sensor;
        "size" Arguments::FrameSize, "Watch: the sensor's columns and rows";
        "turn" Arguments::Degrees, "turn the shape right; negative degrees: left";
        "watch" Arguments::FrameSource, "Watch: frames, live or recorded";
        "write" Arguments::File(FilePurpose::Write), "write an imprint, shape or drawing, by file extension";
    }
}

pub fn named(name: &str) -> Option<&'static Action> {
    let mut all = ACTIONS.iter().copied();
    all.find(|action| action.name == name && action.message().is_some())
}
