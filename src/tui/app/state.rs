//! The state of the program.
//!
//! Everything may read it. Once the program runs, only what [`crate::tui::app::update`] calls changes it, so all changes
//! happen in the order of the messages.

use std::collections::VecDeque;

use ratatui::layout::Rect;

use crate::formats::{Name, StoredShape};
use crate::imprint::{Bounds, Imprint};
use crate::sensor::Sensor;
use crate::source::Source;
use crate::storage::{Expected, ShapeOrigin, UNNAMED};
use crate::tui::app::dialog::{Dialog, topmost};
use crate::tui::app::document::{Document, ReadDocument, Reading};
use crate::tui::app::history::{History, StoredName};
use crate::tui::app::layout::Panes;
use crate::tui::app::library::LibraryRequest;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot};
use crate::tui::explore::results::Results;
use crate::tui::form::memory::FormMemory;
use crate::tui::keys::action::{self, Action};
use crate::tui::keys::binding::Context;
use crate::tui::keys::key::Key;
use crate::tui::keys::keymap::Keymap;
use crate::tui::live::request::WatchRequest;
use crate::tui::live::state::Live;
use crate::tui::matrix::layers::Layers;
use crate::tui::matrix::layout::TaxelGrid;
use crate::tui::recognise::state::Recognition;
use crate::tui::widget::theme::Theme;

/// How the program starts.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// The sensor of the empty matrix.
    pub sensor: Sensor,
    /// How it looks.
    pub theme: Theme,
    /// Whether the mouse sets taxels at the start.
    pub mouse: bool,
    /// What random touches are made from.
    pub seed: u64,
}

impl Options {
    /// As scripts and tests have it: the sensor of the paper, no colours, a mouse.
    pub fn plain(ascii: bool) -> Self {
        Self {
            sensor: Sensor::default(),
            theme: Theme::plain(ascii),
            mouse: true,
            seed: 0,
        }
    }
}

/// What the arrows do on the matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// They move the cursor.
    Draw,
    /// They move the shape.
    Grab,
}

/// A way of moving the shape. Moves of the same kind, one after the other, are one step of the history; so are all moves
/// while the shape is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// Any, while the shape is held.
    Held,
    /// Along x and y.
    Along,
    /// About its centre.
    Turn,
    /// Larger or smaller.
    Zoom,
}

/// What stays in sight on a matrix that is seen through a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::tui) enum Followed {
    /// The taxel under the cursor.
    Cursor,
    /// The described region.
    Region,
}

/// What decides what the window follows, before or after a message.
#[derive(Clone, Debug)]
pub(in crate::tui) struct Attention {
    /// The taxel under the cursor.
    cursor: (u8, u8),
    /// Whether a page stands beside the matrix.
    accompanied: bool,
    /// What touches: a small move of it may leave the same taxels active.
    source: Option<Source>,
    /// The active taxels.
    imprint: Imprint,
}

/// How taxels are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Display {
    /// Active or not.
    Imprint,
    /// Coverage in shades.
    Shades,
    /// Coverage in percent.
    Percent,
}

/// What a screen shows that is too small for matrix and descriptors side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NarrowPage {
    /// The matrix.
    Matrix,
    /// The descriptors.
    Panel,
}

/// A step of nudging.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NudgeStep {
    /// 0.01 cells.
    Hundredth,
    /// 0.1 cells.
    Tenth,
    /// One cell.
    One,
}

impl NudgeStep {
    /// Its length in cell sides.
    pub fn length(self) -> f64 {
        match self {
            Self::Hundredth => 0.01,
            Self::Tenth => 0.1,
            Self::One => 1.0,
        }
    }

    /// The next larger or smaller one, or the same at the end.
    #[must_use]
    pub fn other(self, direction: i8) -> Self {
        match (self, direction > 0) {
            (Self::Hundredth, true) | (Self::One, false) => Self::Tenth,
            (_, true) => Self::One,
            (_, false) => Self::Hundredth,
        }
    }
}

/// Whether the program runs, and how it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunState {
    /// It runs.
    Running,
    /// Its end was asked for: what is not saved was given up.
    Quit,
    /// It ends without having asked: what is not saved stays in the journal.
    Terminated,
}

/// A notice, shown until the next key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Notice {
    /// For information.
    Info(String),
    /// Why something was not done.
    Refusal(String),
}

/// A shape that is being saved.
#[derive(Clone, Debug)]
pub(in crate::tui) struct UnfinishedSave {
    /// The shape.
    pub(in crate::tui) shape: Box<StoredShape>,
    /// The document that it was made from.
    pub(in crate::tui) document: Document,
    /// The number of that document's origin.
    pub(in crate::tui) origin: usize,
}

/// The state of the program.
#[derive(Clone, Debug)]
pub struct App {
    /// The document and its earlier states.
    pub(in crate::tui) history: History,
    /// The document that the matrix shows, as it was read last.
    shown: ReadDocument,
    /// The taxel under the cursor: column, row.
    pub(in crate::tui) cursor: (u8, u8),
    /// What the window of a large matrix follows.
    pub(in crate::tui) followed: Followed,
    /// The region chosen with Tab; none: the main one.
    pub(in crate::tui) chosen: Option<usize>,
    /// What the arrows do.
    pub(in crate::tui) mode: Mode,
    /// How taxels are shown.
    pub(in crate::tui) display: Display,
    /// What is shown over the taxels.
    pub(in crate::tui) layers: Layers,
    /// What a narrow screen shows.
    pub(in crate::tui) page: NarrowPage,
    /// How far a key moves or zooms the shape.
    pub(in crate::tui) step: NudgeStep,
    /// Whether a picture is zoomed about its centre, not about the origin.
    pub(in crate::tui) zoom_centre: bool,
    /// How many times the next message is meant, None if no count was typed.
    pub(in crate::tui) count: Option<u16>,
    /// The pages over the matrix; the last one is on top.
    pub(in crate::tui) dialogs: Vec<Dialog>,
    /// The prompt that the last message came from, until something else is done: it opens again if what it asked for is
    /// refused.
    pub(in crate::tui) prompt: Option<Dialog>,
    /// What the line of notices says.
    pub(in crate::tui) notice: Option<Notice>,
    /// What a change of files waits for, if it takes long: the status line says it while there is no notice.
    pub(in crate::tui) waiting: Option<String>,
    /// What is being saved, in the order in which the library answers.
    pub(in crate::tui) saving: VecDeque<UnfinishedSave>,
    /// The shape that was removed last, until something else is done: undo brings it back.
    pub(in crate::tui) removed: Option<String>,
    /// The results of the last sweep, while they are closed.
    pub(in crate::tui) results: Option<Box<Results>>,
    /// Recognition, while it is not looked at.
    pub(in crate::tui) recognition: Option<Box<Recognition>>,
    /// What a source that is named at the prompt is watched with.
    pub(in crate::tui) watch_settings: WatchRequest,
    /// The page of a source of frames, while it is not looked at.
    pub(in crate::tui) live: Option<Box<Live>>,
    /// How many sweeps and exports were begun; the number of the last one.
    pub(in crate::tui) works: u64,
    /// The commands that were given, the last one last.
    pub(in crate::tui) commands: Vec<String>,
    /// The values that forms were accepted with.
    pub(in crate::tui) forms: FormMemory,
    /// Whether the mouse is wanted.
    pub(in crate::tui) mouse: bool,
    /// What was on the matrix when the shape was taken hold of.
    pub(in crate::tui) held: Option<Box<Document>>,
    /// How the last message moved the shape, if it did: the next move of that kind is the same step of the history.
    pub(in crate::tui) moves: Option<MoveKind>,
    /// During a drag of the mouse: the state that it gives taxels, and the last taxel on its way.
    pub(in crate::tui) paint: Option<(bool, (u8, u8))>,
    /// Columns and rows of the screen.
    pub(in crate::tui) screen: (u16, u16),
    /// Colours and characters.
    pub(in crate::tui) theme: Theme,
    /// What each key does.
    pub(in crate::tui) keymap: Keymap,
    /// Whether the program runs.
    pub(in crate::tui) run_state: RunState,
    /// Whether it ends once what is on the matrix is saved: so the question at Quit was answered.
    pub(in crate::tui) quits_when_saved: bool,
    /// The keys without a meaning that a notice has named: each is named once.
    pub(in crate::tui) unknown_keys: Vec<Key>,
}

impl App {
    /// An empty matrix, the cursor in its middle.
    pub fn new(options: &Options) -> Self {
        let document = Document::empty(options.sensor);
        Self {
            cursor: (options.sensor.columns() / 2, options.sensor.rows() / 2),
            shown: ReadDocument::new(document.clone()),
            history: History::new(document),
            followed: Followed::Cursor,
            chosen: None,
            mode: Mode::Draw,
            display: Display::Imprint,
            layers: Layers::default(),
            page: NarrowPage::Matrix,
            step: NudgeStep::Hundredth,
            zoom_centre: false,
            count: None,
            dialogs: Vec::new(),
            prompt: None,
            notice: None,
            waiting: None,
            saving: VecDeque::new(),
            removed: None,
            results: None,
            recognition: Some(Box::new(Recognition::new(options.seed))),
            watch_settings: WatchRequest::new(""),
            live: None,
            works: 0,
            commands: Vec::new(),
            forms: FormMemory::default(),
            mouse: options.mouse,
            held: None,
            moves: None,
            paint: None,
            screen: (80, 24),
            theme: options.theme,
            keymap: Keymap::default(),
            run_state: RunState::Running,
            quits_when_saved: false,
            unknown_keys: Vec::new(),
        }
    }

    /// The same with other keys.
    #[must_use]
    pub fn with_keymap(self, keymap: Keymap) -> Self {
        Self { keymap, ..self }
    }

    /// The same with other settings for sources that are named at the prompt.
    #[must_use]
    pub fn with_watch_settings(self, watch_settings: WatchRequest) -> Self {
        Self {
            watch_settings,
            ..self
        }
    }

    /// What each key means.
    pub fn keymap(&self) -> &Keymap {
        &self.keymap
    }

    /// The key of something that can be done on the matrix, as notices name it.
    pub(in crate::tui) fn key_of(&self, action: &Action) -> String {
        self.keymap.label(Context::Matrix, action)
    }

    /// Why nothing can be explored: what is missing, and how it is made.
    pub(in crate::tui) fn nothing_to_explore(&self) -> String {
        let [figure, picture, draw] = [&action::FIGURE, &action::PICTURE, &action::TOGGLE];
        format!(
            "nothing to explore: {} places a figure, {} a stored shape, {} draws",
            self.key_of(figure),
            self.key_of(picture),
            self.key_of(draw)
        )
    }

    /// Where keys are looked up.
    pub fn context(&self) -> Context {
        self.context_on(self.dialogs.last().map(Dialog::page))
    }

    /// The same with this page on top; None for the matrix.
    pub(in crate::tui) fn context_on(&self, page: Option<&dyn Page>) -> Context {
        match (page, self.mode) {
            (Some(page), Mode::Grab) if page.leaves_matrix() => Context::Grab,
            (Some(page), _) => page.context(),
            (None, Mode::Grab) => Context::Grab,
            (None, Mode::Draw) => Context::Matrix,
        }
    }

    /// What a key means now.
    pub fn meaning(&self, key: Key) -> Message {
        let message = self.keymap.lookup(self.context(), key);
        message.unwrap_or(Message::Unknown(key))
    }

    /// The top page that has a pane of its own, None if that is the matrix.
    pub fn pane(&self) -> Option<&dyn Page> {
        let dialog = self.dialogs.iter().rev().find(|dialog| dialog.has_pane());
        dialog.map(Dialog::page)
    }

    /// The panes of the screen, None if it is too small.
    pub fn panes(&self) -> Option<Panes> {
        let (columns, rows) = self.screen;
        let area = Rect::new(0, 0, columns, rows);
        Panes::of(area, &self.reading().imprint, self.halves())
    }

    /// Whether a key shows the matrix or what else is on the screen in turn: where only one of them has room, and where
    /// descriptors may be cut beside the matrix.
    pub(in crate::tui) fn has_pages(&self, panes: &Panes) -> bool {
        panes.panel.is_none() || self.pane().is_none() && !panes.is_panel_roomy
    }

    /// Where the descriptors stand beside the matrix; None where one of them has the whole page.
    pub(in crate::tui) fn beside(&self, panes: &Panes) -> Option<Rect> {
        let alone = self.page == NarrowPage::Panel && self.has_pages(panes);
        panes.panel.filter(|_| !alone)
    }

    /// Whether two taxels may share a character of the screen. Coverage and marks of a comparison need one for each.
    pub(in crate::tui) fn halves(&self) -> bool {
        let compared = self.pane().and_then(Page::compared_with);
        self.display == Display::Imprint && compared.is_none()
    }

    /// Where the taxels are on the screen; None if it is too small.
    pub(in crate::tui) fn grid(&self) -> Option<TaxelGrid> {
        let area = self.panes()?.matrix;
        let imprint = &self.reading().imprint;
        let (cursor, seen) = (self.cursor(), self.seen());
        Some(TaxelGrid::of(area, imprint, cursor, seen, self.halves()))
    }

    /// What the window of a large matrix shows.
    pub(in crate::tui) fn seen(&self) -> Bounds {
        let region = self.reading().region(self.chosen);
        match region.filter(|_| self.followed == Followed::Region) {
            Some((_, region)) => region.bounds(),
            None => Bounds::of_taxel(self.cursor().0, self.cursor().1),
        }
    }

    /// What decides what the window follows.
    pub(in crate::tui) fn attention(&self) -> Attention {
        let page = self.pane().map(Page::slot);
        Attention {
            cursor: self.cursor(),
            accompanied: matches!(page, Some(Slot::Form | Slot::Panel)),
            source: self.shown().source.clone(),
            imprint: self.reading().imprint,
        }
    }

    /// Has the window follow the cursor after it was moved or its taxel was switched; the described region where the shape or
    /// the imprint changed otherwise, and where a page opened that is about it. Else it stays.
    pub(in crate::tui) fn follow(&mut self, before: &Attention) {
        let now = self.attention();
        let sides = |imprint: &Imprint| (imprint.columns(), imprint.rows());
        let same_sensor = sides(&now.imprint) == sides(&before.imprint);
        let mut changed = now.imprint.differing(&before.imprint);
        changed.set(now.cursor.0, now.cursor.1, false);
        let elsewhere = !same_sensor
            || !changed.is_empty()
            || now.source != before.source
            || now.accompanied && !before.accompanied;
        if same_sensor && now.cursor != before.cursor {
            self.followed = Followed::Cursor;
        } else if elsewhere {
            self.followed = Followed::Region;
        } else if now.imprint != before.imprint {
            self.followed = Followed::Cursor;
        }
    }

    /// Columns and rows of a page that fills the body; 0 on a screen that is too small for any.
    pub(in crate::tui) fn body_size(&self) -> (u16, u16) {
        self.panes()
            .map_or((0, 0), |panes| panes.body.as_size().into())
    }

    /// The results that are open, perhaps under other pages.
    pub(in crate::tui) fn results_below(&self) -> Option<&Results> {
        topmost!(&self.dialogs, Results).map(|results| &**results)
    }

    /// The document that the matrix shows: what an open form would make of it, or the present one.
    pub fn shown(&self) -> &Document {
        self.shown.document()
    }

    /// What can be read off that document.
    pub fn reading(&self) -> &Reading {
        self.shown.reading()
    }

    /// Reads the document that the matrix shows now, if it is another one. Called after every change, so that drawing,
    /// keys and the journal share one reading.
    pub(in crate::tui) fn read(&mut self) {
        let document = self.on_matrix();
        if document != self.shown.document() {
            self.shown = ReadDocument::new(document.clone());
        }
    }

    /// The document of the topmost form, or the present one.
    fn on_matrix(&self) -> &Document {
        match topmost!(&self.dialogs, Form) {
            Some(form) => form.shown(),
            None => self.history.present(),
        }
    }

    /// Called before each action of the user: ends what belongs to the last one.
    pub(in crate::tui) fn begin_action(&mut self) {
        self.notice = None;
        self.prompt = None;
        if self.dialogs.is_empty() {
            self.quits_when_saved = false;
        }
        // A key between press and release: what is dragged on would change another document than the press did.
        self.paint = None;
    }

    /// Whether there is work that would be lost.
    pub fn unsaved(&self) -> bool {
        self.history.origin().would_lose(self.history.present())
    }

    /// Whether the document differs from what is stored under its name. What is empty may, although nothing is lost.
    pub(in crate::tui) fn is_changed(&self) -> bool {
        *self.history.present() != self.history.origin().saved
    }

    /// Whether what is on the matrix is being saved.
    pub(in crate::tui) fn is_being_saved(&self) -> bool {
        let present = self.history.present();
        self.saving.iter().any(|save| save.document == *present)
    }

    /// What would be lost, to be kept in the journal: what is on the matrix, else what is being saved. At an end that was
    /// asked for, the former was given up.
    pub fn unsaved_work(&self) -> Option<StoredShape> {
        let shown = self.shown();
        if self.run_state == RunState::Quit || !self.history.origin().would_lose(shown) {
            return self.saving.back().map(|save| (*save.shape).clone());
        }
        let stored = self.stored_name().unwrap_or(UNNAMED);
        let name = Name::new(stored).or_else(|_| Name::new(UNNAMED)).ok()?;
        Some(shown.to_shape(name, self.reading()))
    }

    /// The taxel that the cursor is on: column, row. While a form shows a smaller sensor, it stands at the rim of that.
    pub fn cursor(&self) -> (u8, u8) {
        let (sensor, (column, row)) = (&self.shown().sensor, self.cursor);
        (column.min(sensor.columns() - 1), row.min(sensor.rows() - 1))
    }

    /// The region that was chosen, by its number from 0; none: the main one.
    pub fn chosen(&self) -> Option<usize> {
        self.chosen
    }

    /// Where the document is stored.
    pub(in crate::tui) fn stored(&self) -> Option<&StoredName> {
        self.history.origin().name.as_ref()
    }

    /// The name that the document was loaded from or stored under.
    pub fn stored_name(&self) -> Option<&str> {
        self.stored().map(|stored| stored.name.as_str())
    }

    /// The imprint of a stored shape that nothing made, and its name; None where a source made what is on the matrix, or it
    /// has no name.
    pub(in crate::tui) fn loaded_imprint(&self) -> Option<(&str, &Imprint)> {
        let document = self.history.present();
        let name = self.stored_name().filter(|_| document.source.is_none())?;
        (!document.edits.is_empty()).then_some((name, &document.edits))
    }

    /// Whether the program has come to its end.
    pub fn ended(&self) -> bool {
        self.run_state != RunState::Running
    }

    /// What a change of files waits for, if it takes long.
    pub fn waiting(&self) -> Option<&str> {
        self.waiting.as_deref()
    }

    /// How it looks.
    pub fn theme(&self) -> &Theme {
        &self.theme
    }

    /// The message that stores the document under a name. It asks before it replaces the file that the document came
    /// from, as for any other.
    pub(in crate::tui) fn storing(&self, name: Name) -> Message {
        let own = self
            .stored()
            .filter(|stored| stored.owner == ShapeOrigin::Own && name.same(&stored.name));
        let stamp = own.map(|stored| stored.stamp);
        let present = self.history.present();
        let shape = Box::new(present.to_shape(name, &Reading::of(present)));
        match stamp {
            Some(stamp) => Message::Replace(shape, stamp),
            None => Message::Request(LibraryRequest::Store(shape, Expected::Nothing)),
        }
    }
}
