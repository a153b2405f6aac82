//! The actions: what a user can ask for by a key, each with its name in a settings file.
//!
//! [`crate::tui::keys::default_keys`] gives them keys, with a hint and a line of help for each place.

use crate::tui::app::{
    Copied, Endpoint, Erase, Layer,
    Message::{self, Explore, Live, Recognise},
};
use crate::tui::explore::ExploreMessage::{self, Angle, Columns, Feature, NextTab, Tab};
use crate::tui::keys::{Arrow, Context};
use crate::tui::live::LiveMessage::{self, Threshold, Window};
use crate::tui::recognise::RecogniseMessage;

#[derive(Debug, PartialEq)]
pub struct Action {
    pub name: &'static str,
    pub message: Message,
}

const fn action(name: &'static str, message: Message) -> Action {
    Action { name, message }
}

pub static NEW: Action = action("new", Message::New);
pub static LOAD: Action = action("load", Message::Load);
pub static FIGURE: Action = action("figure", Message::Figure);
pub static PICTURE: Action = action("picture", Message::Picture);
pub static SAVE: Action = action("save", Message::Save);
pub static DELETE: Action = action("delete", Message::Delete);
pub static QUIT: Action = action("quit", Message::Quit);
pub static CURSOR_LEFT: Action = action("cursor-left", Message::Cursor(Arrow::Left));
pub static CURSOR_RIGHT: Action = action("cursor-right", Message::Cursor(Arrow::Right));
pub static CURSOR_UP: Action = action("cursor-up", Message::Cursor(Arrow::Up));
pub static CURSOR_DOWN: Action = action("cursor-down", Message::Cursor(Arrow::Down));
pub static FIRST_COLUMN: Action = action("first-column", Message::ToColumn(Endpoint::First));
pub static LAST_COLUMN: Action = action("last-column", Message::ToColumn(Endpoint::Last));
pub static FIRST_ROW: Action = action("first-row", Message::ToRow(Endpoint::First));
pub static LAST_ROW: Action = action("last-row", Message::ToRow(Endpoint::Last));
pub static TOGGLE: Action = action("toggle", Message::Toggle);
pub static UNDO: Action = action("undo", Message::Undo);
pub static REDO: Action = action("redo", Message::Redo);
pub static REGION: Action = action("region", Message::Region(1));
pub static PREVIOUS_REGION: Action = action("previous-region", Message::Region(-1));
pub static COVERAGE: Action = action("coverage", Message::Display);
pub static OUTLINE: Action = action("outline", Message::Layer(Layer::Outline));
pub static RECTANGLE: Action = action("rectangle", Message::Layer(Layer::Rectangle));
pub static HOLD: Action = action("hold", Message::Hold);
pub static PUT_BACK: Action = action("put-back", Message::PutBack);
pub static COMPARE: Action = action("compare", Message::Compare);
pub static DRAW: Action = action("draw", Message::Draw);
pub static EXPLAIN: Action = action("explain", Message::Explain);
pub static NUDGE_LEFT: Action = action("nudge-left", Message::Nudge(Arrow::Left));
pub static NUDGE_RIGHT: Action = action("nudge-right", Message::Nudge(Arrow::Right));
pub static NUDGE_UP: Action = action("nudge-up", Message::Nudge(Arrow::Up));
pub static NUDGE_DOWN: Action = action("nudge-down", Message::Nudge(Arrow::Down));
pub static TURN_LEFT: Action = action("turn-left", Message::Turn(-1.0));
pub static TURN_RIGHT: Action = action("turn-right", Message::Turn(1.0));
pub static TURN_LEFT_10: Action = action("turn-left-10", Message::Turn(-10.0));
pub static TURN_RIGHT_10: Action = action("turn-right-10", Message::Turn(10.0));
pub static ZOOM_IN: Action = action("zoom-in", Message::Zoom(1));
pub static ZOOM_OUT: Action = action("zoom-out", Message::Zoom(-1));
pub static SENSOR: Action = action("sensor", Message::Sensor);
pub static PANEL: Action = action("panel", Message::SwitchPane);
pub static COPY_DESCRIPTORS: Action =
    action("copy-descriptors", Message::Copy(Copied::Descriptors));
pub static COPY_IMPRINT: Action = action("copy-imprint", Message::Copy(Copied::Imprint));
pub static COMMAND: Action = action("command", Message::Command);
pub static HELP: Action = action("help", Message::Help);
pub static LARGER_STEP: Action = action("larger-step", Message::NudgeStep(1));
pub static SMALLER_STEP: Action = action("smaller-step", Message::NudgeStep(-1));
pub static NEXT: Action = action("next", Message::Field(1));
pub static PREVIOUS: Action = action("previous", Message::Field(-1));
pub static LEFT: Action = action("left", Message::Choose(Arrow::Left));
pub static RIGHT: Action = action("right", Message::Choose(Arrow::Right));
pub static UP: Action = action("up", Message::Choose(Arrow::Up));
pub static DOWN: Action = action("down", Message::Choose(Arrow::Down));
pub static INCREASE: Action = action("increase", Message::Step(1));
pub static DECREASE: Action = action("decrease", Message::Step(-1));
pub static DEFAULTS: Action = action("defaults", Message::Defaults);
pub static ERASE_BEFORE: Action = action("erase-before", Message::Erase(Erase::Before));
pub static ERASE_UNDER: Action = action("erase-under", Message::Erase(Erase::Under));
pub static ERASE_ALL: Action = action("erase-all", Message::Erase(Erase::All));
pub static TO_START: Action = action("to-start", Message::ToEdge(Endpoint::First));
pub static TO_END: Action = action("to-end", Message::ToEdge(Endpoint::Last));
pub static ACCEPT: Action = action("accept", Message::Accept);
pub static CANCEL: Action = action("cancel", Message::Cancel);
pub static DECLINE: Action = action("decline", Message::Decline);
pub static SCROLL_UP: Action = action("scroll-up", Message::Scroll(-1));
pub static SCROLL_DOWN: Action = action("scroll-down", Message::Scroll(1));
pub static PAGE_UP: Action = action("page-up", Message::Scroll(-10));
pub static PAGE_DOWN: Action = action("page-down", Message::Scroll(10));
pub static SCREEN_UP: Action = action("screen-up", Message::ScrollScreen(-1));
pub static SCREEN_DOWN: Action = action("screen-down", Message::ScrollScreen(1));
pub static FIRST: Action = action("first", Message::ScrollTo(Endpoint::First));
pub static LAST: Action = action("last", Message::ScrollTo(Endpoint::Last));
pub static EXPLORE: Action = action("explore", Explore(ExploreMessage::Open));
pub static RANGES: Action = action("ranges", Explore(ExploreMessage::Ranges));
pub static STOP: Action = action("stop", Explore(ExploreMessage::Stop));
pub static IMPRINTS: Action = action("imprints", Explore(Tab(0)));
pub static STATISTICS: Action = action("statistics", Explore(Tab(1)));
pub static HISTOGRAM: Action = action("histogram", Explore(Tab(2)));
pub static MAP: Action = action("map", Explore(Tab(3)));
pub static NEXT_TAB: Action = action("next-page", Explore(NextTab(1)));
pub static PREVIOUS_TAB: Action = action("previous-page", Explore(NextTab(-1)));
pub static NEXT_DESCRIPTOR: Action = action("next-descriptor", Explore(Feature(1)));
pub static PREVIOUS_DESCRIPTOR: Action = action("previous-descriptor", Explore(Feature(-1)));
pub static COLUMNS_RIGHT: Action = action("columns-right", Explore(Columns(1)));
pub static COLUMNS_LEFT: Action = action("columns-left", Explore(Columns(-1)));
pub static SORT: Action = action("sort", Explore(ExploreMessage::Sort));
pub static FOLLOW: Action = action("follow", Explore(ExploreMessage::Follow));
pub static EXPORT: Action = action("export", Explore(ExploreMessage::Export));
pub static NEXT_ANGLE: Action = action("next-angle", Explore(Angle(1)));
pub static PREVIOUS_ANGLE: Action = action("previous-angle", Explore(Angle(-1)));
pub static NEXT_ZOOM: Action = action("next-zoom", Explore(ExploreMessage::Zoom));
pub static RECOGNISE: Action = action("recognise", Recognise(RecogniseMessage::Open));
pub static RANDOM_TOUCH: Action = action("random-touch", Recognise(RecogniseMessage::Touch));
pub static NEXT_MODEL: Action = action("next-model", Recognise(RecogniseMessage::NextModel));
pub static KEEP: Action = action("keep", Recognise(RecogniseMessage::Keep));
pub static FORGET: Action = action("forget", Recognise(RecogniseMessage::Forget));
pub static POSES: Action = action("poses", Message::Layer(Layer::Fit));
pub static WATCH: Action = action("watch", Live(LiveMessage::Open));
pub static WATCH_AGAIN: Action = action("watch-again", Live(LiveMessage::Again));
pub static TARE: Action = action("tare", Live(LiveMessage::Tare));
pub static NO_TARE: Action = action("no-tare", Live(LiveMessage::NoTare));
pub static THRESHOLD_UP: Action = action("threshold-up", Live(Threshold(1)));
pub static THRESHOLD_DOWN: Action = action("threshold-down", Live(Threshold(-1)));
pub static PERCENT: Action = action("percent", Live(LiveMessage::Percent));
pub static FREEZE: Action = action("freeze", Live(LiveMessage::Freeze));
pub static NEXT_LAYER: Action = action("next-layer", Live(LiveMessage::NextLayer));
pub static PLOT: Action = action("plot", Live(LiveMessage::Plot));
pub static NUMBERS: Action = action("numbers", Live(LiveMessage::Numbers));
pub static OWN_RANGE: Action = action("own-range", Live(LiveMessage::OwnRange));
pub static WINDOW_LEFT: Action = action("window-left", Live(Window(Arrow::Left)));
pub static WINDOW_RIGHT: Action = action("window-right", Live(Window(Arrow::Right)));
pub static WINDOW_UP: Action = action("window-up", Live(Window(Arrow::Up)));
pub static WINDOW_DOWN: Action = action("window-down", Live(Window(Arrow::Down)));
pub static FOLLOW_CONTACT: Action = action("follow-contact", Live(LiveMessage::FollowContact));
pub static SECOND_BACK: Action = action("second-back", Live(LiveMessage::Second(-1)));
pub static SECOND_ON: Action = action("second-on", Live(LiveMessage::Second(1)));
pub static PREVIOUS_TOUCH: Action = action("previous-touch", Live(LiveMessage::Touch(-1)));
pub static NEXT_TOUCH: Action = action("next-touch", Live(LiveMessage::Touch(1)));
pub static RECORD: Action = action("record", Live(LiveMessage::Record));
pub static MARK_FRAME: Action = action("mark-frame", Live(LiveMessage::Mark));
pub static NAME_SHAPE: Action = action("name-shape", Live(LiveMessage::NameShape));
pub static REDRAW: Action = action("redraw", Message::Redraw);
pub static SUSPEND: Action = action("suspend", Message::Suspend);

pub fn named(name: &str) -> Option<&'static Action> {
    let mut all = Context::all().flat_map(Context::actions);
    all.find(|action| action.name == name)
}
