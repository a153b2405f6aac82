//! What keys can do, by name: for the file in which a user gives actions other keys.
//!
//! Where the command line at the foot knows the same action, it has the same name.

use crate::atlas::SortKey;
use crate::tui::app::message::{Copied, Endpoint, Erase, Message};
use crate::tui::explore::message::{ExploreMessage, ExplorePage, Zoom};
use crate::tui::keys::key::Arrow;

/// All actions that keys have. Which of them belong to a place is what the table of keys has there.
pub const ACTIONS: &[(&str, Message)] = &[
    ("new", Message::New),
    ("load", Message::Load),
    ("figure", Message::Figure),
    ("picture", Message::Picture),
    ("save", Message::Save),
    ("delete", Message::Delete),
    ("quit", Message::Quit),
    ("cursor-left", Message::Cursor(Arrow::Left)),
    ("cursor-right", Message::Cursor(Arrow::Right)),
    ("cursor-up", Message::Cursor(Arrow::Up)),
    ("cursor-down", Message::Cursor(Arrow::Down)),
    ("first-column", Message::ToColumn(Endpoint::First)),
    ("last-column", Message::ToColumn(Endpoint::Last)),
    ("first-row", Message::ToRow(Endpoint::First)),
    ("last-row", Message::ToRow(Endpoint::Last)),
    ("toggle", Message::Toggle),
    ("undo", Message::Undo),
    ("redo", Message::Redo),
    ("region", Message::Region(1)),
    ("previous-region", Message::Region(-1)),
    ("coverage", Message::Display),
    ("grab", Message::Grab),
    ("nudge-left", Message::Nudge(Arrow::Left)),
    ("nudge-right", Message::Nudge(Arrow::Right)),
    ("nudge-up", Message::Nudge(Arrow::Up)),
    ("nudge-down", Message::Nudge(Arrow::Down)),
    ("turn-left", Message::Turn(-1)),
    ("turn-right", Message::Turn(1)),
    ("turn-left-10", Message::Turn(-10)),
    ("turn-right-10", Message::Turn(10)),
    ("zoom-in", Message::Zoom(1)),
    ("zoom-out", Message::Zoom(-1)),
    ("sensor", Message::Sensor),
    ("panel", Message::SwitchPage),
    ("copy-descriptors", Message::Copy(Copied::Descriptors)),
    ("copy-imprint", Message::Copy(Copied::Imprint)),
    ("mouse", Message::MouseOnOff),
    ("command", Message::Command),
    ("help", Message::Help),
    ("larger-step", Message::NudgeStep(1)),
    ("smaller-step", Message::NudgeStep(-1)),
    ("next", Message::Field(1)),
    ("previous", Message::Field(-1)),
    ("left", Message::Choose(Arrow::Left)),
    ("right", Message::Choose(Arrow::Right)),
    ("up", Message::Choose(Arrow::Up)),
    ("down", Message::Choose(Arrow::Down)),
    ("increase", Message::Step(1)),
    ("decrease", Message::Step(-1)),
    ("erase-before", Message::Erase(Erase::Before)),
    ("erase-under", Message::Erase(Erase::Under)),
    ("erase-all", Message::Erase(Erase::All)),
    ("to-start", Message::ToEdge(Endpoint::First)),
    ("to-end", Message::ToEdge(Endpoint::Last)),
    ("accept", Message::Accept),
    ("cancel", Message::Cancel),
    ("decline", Message::Decline),
    ("scroll-up", Message::Scroll(-1)),
    ("scroll-down", Message::Scroll(1)),
    ("page-up", Message::Scroll(-10)),
    ("page-down", Message::Scroll(10)),
    ("first", Message::ScrollTo(Endpoint::First)),
    ("last", Message::ScrollTo(Endpoint::Last)),
    ("explore", Message::Explore(ExploreMessage::Open)),
    ("ranges", Message::Explore(ExploreMessage::Ranges)),
    ("stop", Message::Explore(ExploreMessage::Stop)),
    ("quit-at-once", Message::Terminate),
    (
        "imprints",
        Message::Explore(ExploreMessage::Page(ExplorePage::Imprints)),
    ),
    (
        "statistics",
        Message::Explore(ExploreMessage::Page(ExplorePage::Statistics)),
    ),
    (
        "histogram",
        Message::Explore(ExploreMessage::Page(ExplorePage::Histogram)),
    ),
    (
        "map",
        Message::Explore(ExploreMessage::Page(ExplorePage::Map)),
    ),
    ("next-page", Message::Explore(ExploreMessage::NextPage(1))),
    (
        "previous-page",
        Message::Explore(ExploreMessage::NextPage(-1)),
    ),
    (
        "next-descriptor",
        Message::Explore(ExploreMessage::Feature(1)),
    ),
    (
        "previous-descriptor",
        Message::Explore(ExploreMessage::Feature(-1)),
    ),
    (
        "later-columns",
        Message::Explore(ExploreMessage::Columns(1)),
    ),
    (
        "earlier-columns",
        Message::Explore(ExploreMessage::Columns(-1)),
    ),
    (
        "sort-by-poses",
        Message::Explore(ExploreMessage::Sort(SortKey::Poses)),
    ),
    (
        "sort-by-first-pose",
        Message::Explore(ExploreMessage::Sort(SortKey::FirstPose)),
    ),
    (
        "sort-by-value",
        Message::Explore(ExploreMessage::Sort(SortKey::Value)),
    ),
    (
        "sort-by-pieces",
        Message::Explore(ExploreMessage::Sort(SortKey::Pieces)),
    ),
    (
        "sort-by-holes",
        Message::Explore(ExploreMessage::Sort(SortKey::Holes)),
    ),
    ("find", Message::Explore(ExploreMessage::Find)),
    ("follow", Message::Explore(ExploreMessage::Follow)),
    ("export", Message::Explore(ExploreMessage::Export)),
    ("next-angle", Message::Explore(ExploreMessage::Angle(1))),
    (
        "previous-angle",
        Message::Explore(ExploreMessage::Angle(-1)),
    ),
    ("ten-angles-on", Message::Explore(ExploreMessage::Angle(10))),
    (
        "ten-angles-back",
        Message::Explore(ExploreMessage::Angle(-10)),
    ),
    (
        "next-zoom-x",
        Message::Explore(ExploreMessage::Zoomed(Zoom::X, 1)),
    ),
    (
        "previous-zoom-x",
        Message::Explore(ExploreMessage::Zoomed(Zoom::X, -1)),
    ),
    (
        "next-zoom-y",
        Message::Explore(ExploreMessage::Zoomed(Zoom::Y, 1)),
    ),
    (
        "previous-zoom-y",
        Message::Explore(ExploreMessage::Zoomed(Zoom::Y, -1)),
    ),
    ("redraw", Message::Redraw),
    ("suspend", Message::Suspend),
];

/// The action of that name.
pub fn named(name: &str) -> Option<&'static Message> {
    let found = ACTIONS.iter().find(|(known, _)| *known == name);
    found.map(|(_, action)| action)
}

/// The name of an action; none for what no key can do.
pub fn name(action: &Message) -> Option<&'static str> {
    let found = ACTIONS.iter().find(|(_, known)| known == action);
    found.map(|(name, _)| *name)
}
