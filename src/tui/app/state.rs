//! The state of the program.
//!
//! All code may read it. While the program runs, only [`crate::tui::app::update`] and the functions that it calls
//! change it, so all changes happen in the order of the messages.

use std::fmt;

use ratatui::layout::Rect;
use taxel_core::imprint::{Bounds, Imprint};
use taxel_core::sensor::Sensor;
use taxel_files::formats::StoredShape;

use crate::tui::app::mouse::Paint;
use crate::tui::app::view::Panes;
use crate::tui::app::{
    Document, History, Message, Page, Place, Reading, StoredName, find, find_mut,
};
use crate::tui::explore::results::Results;
use crate::tui::form::FormDialog;
use crate::tui::grid::Grid;
use crate::tui::jobs::Jobs;
use crate::tui::keys::action::{self, Action};
use crate::tui::keys::{Context, Key, Keymap};
use crate::tui::live::{Live, WatchRequest};
use crate::tui::matrix::layers::Layers;
use crate::tui::matrix::view::grid;
use crate::tui::recognise::page::Recognition;
use crate::tui::widget::Theme;

#[derive(Clone, Copy, Debug)]
pub struct Options {
    pub sensor: Sensor,
    pub theme: Theme,
    pub seed: u64,
}

impl Options {
    pub fn plain(ascii: bool) -> Self {
        Self {
            sensor: Sensor::default(),
            theme: Theme::plain(ascii),
            seed: 0,
        }
    }
}

/// A way of moving the shape. Moves of the same kind, one after the other, are one step of the history; so are all
/// moves while the shape is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    Held,
    Along,
    Turn,
    Zoom,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Display {
    Imprint,
    Shades,
    Percent,
}

pub(crate) const STEPS: [f64; 3] = [0.01, 0.1, 1.0];

/// What the terminal is to do after a message.
#[derive(Clone, Debug, PartialEq)]
pub enum TerminalEffect {
    Redraw,
    Suspend,
    Copy(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunState {
    Running,
    Quit,
    Terminated,
}

/// A notice, shown until the next key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    pub text: String,
    pub is_refusal: bool,
    /// What is said before the next key stands after it.
    pub stays: bool,
}

/// A shape that is being saved, or that could not be saved before the program ended: the journal keeps it.
#[derive(Debug)]
pub(crate) struct Saving {
    pub(crate) shape: Box<StoredShape>,
    pub(crate) document: Document,
    pub(crate) origin: usize,
    /// Whether the program ends once it is saved.
    pub(crate) quits: bool,
}

pub struct App {
    pub jobs: Jobs,
    /// What the terminal is to do after this message.
    pub(crate) terminal: Option<TerminalEffect>,
    pub(in crate::tui) history: History,
    /// What the matrix shows.
    shown: Document,
    reading: Reading,
    /// The taxel that the cursor was put on: column, row. It may lie beyond a sensor that became smaller; so if the
    /// sensor is larger again, the cursor is back.
    pub(in crate::tui) cursor: (u8, u8),
    /// Whether the window follows the described region, not the cursor.
    pub(crate) follows_region: bool,
    pub(in crate::tui) display: Display,
    pub(in crate::tui) layers: Layers,
    /// Whether a narrow screen shows the panel, not the matrix.
    pub(crate) shows_panel: bool,
    /// The step of moving and zooming, one of [`STEPS`].
    pub(crate) step: f64,
    pub(crate) pages: Vec<Box<dyn Page>>,
    /// The prompt that the last message came from, until the next action: it opens again if its request is refused.
    pub(crate) prompt: Option<Box<dyn Page>>,
    pub(in crate::tui) notice: Option<Notice>,
    pub(crate) saving: Option<Saving>,
    pub(in crate::tui) results: Option<Box<Results>>,
    pub(in crate::tui) recognition: Recognition,
    pub(crate) watch_settings: WatchRequest,
    pub(in crate::tui) live: Option<Box<Live>>,
    /// How often a source was watched so far, which is also the number of the last time.
    pub(in crate::tui) works: u64,
    /// The commands given so far, the last one last.
    pub(in crate::tui) commands: Vec<String>,
    /// While the shape is held, so that the arrow keys move it and not the cursor: the document when it was taken.
    pub(in crate::tui) held: Option<Box<Document>>,
    pub(in crate::tui) moves: Option<MoveKind>,
    /// While the cursor draws: the state of the taxels that it passes.
    pub(in crate::tui) pen: Option<bool>,
    pub(in crate::tui) paint: Option<Paint>,
    pub(in crate::tui) screen: (u16, u16),
    pub theme: Theme,
    pub keymap: Keymap,
    pub(in crate::tui) run_state: RunState,
    /// Each is named once.
    pub(in crate::tui) unknown_keys: Vec<Key>,
}

impl App {
    pub fn new(options: &Options) -> Self {
        let document = Document::empty(options.sensor);
        Self {
            jobs: Jobs::without_library(),
            terminal: None,
            cursor: (options.sensor.columns() / 2, options.sensor.rows() / 2),
            reading: Reading::of(&document),
            shown: document.clone(),
            history: History::new(document),
            follows_region: false,
            display: Display::Imprint,
            layers: Layers::default(),
            shows_panel: false,
            step: STEPS[0],
            pages: Vec::new(),
            prompt: None,
            notice: None,
            saving: None,
            results: None,
            recognition: Recognition::new(options.seed),
            watch_settings: WatchRequest::new(""),
            live: None,
            works: 0,
            commands: Vec::new(),
            held: None,
            moves: None,
            pen: None,
            paint: None,
            screen: (80, 24),
            theme: options.theme,
            keymap: Keymap::default(),
            run_state: RunState::Running,
            unknown_keys: Vec::new(),
        }
    }

    pub(in crate::tui) fn key_of(&self, action: &Action) -> String {
        self.keymap.label(Context::Matrix, action)
    }

    pub(in crate::tui) fn nothing_to_explore(&self) -> String {
        let keys = [&action::FIGURE, &action::PICTURE, &action::TOGGLE];
        let [figure, picture, draw] = keys.map(|action| self.key_of(action));
        format!(
            "nothing to explore: {figure} places a figure, {picture} a stored shape, {draw} draws"
        )
    }

    pub fn context(&self) -> Context {
        self.context_on(self.top_page())
    }

    pub(in crate::tui) fn context_on(&self, page: Option<&dyn Page>) -> Context {
        match (page, self.held.is_some()) {
            (Some(page), true) if page.context() == Context::Recognise => Context::Hold,
            (Some(page), _) => page.context(),
            (None, true) => Context::Hold,
            (None, false) if self.pen.is_some() => Context::Draw,
            (None, false) => Context::Matrix,
        }
    }

    pub fn meaning(&self, key: Key) -> Message {
        let message = self.keymap.lookup(self.context(), key);
        message.unwrap_or(Message::Unknown(key))
    }

    pub(in crate::tui) fn pages(&self) -> impl DoubleEndedIterator<Item = &dyn Page> {
        self.pages.iter().map(|page| &**page)
    }

    pub(crate) fn open(&mut self, page: impl Page) {
        self.pages.push(Box::new(page));
    }

    pub(crate) fn page<T: Page>(&self) -> Option<&T> {
        find(&self.pages)
    }

    /// The topmost page of this kind, for the answer of a job.
    pub(crate) fn page_mut<T: Page>(&mut self) -> Option<&mut T> {
        find_mut(&mut self.pages)
    }

    /// The page on top, if it is of this kind.
    pub(crate) fn top_mut<T: Page>(&mut self) -> Option<&mut T> {
        let top = self.pages.len().saturating_sub(1);
        find_mut(&mut self.pages[top..])
    }

    pub(in crate::tui) fn top_page(&self) -> Option<&dyn Page> {
        self.pages().next_back()
    }

    pub fn pane(&self) -> Option<&dyn Page> {
        self.pages().rev().find(|page| page.has_pane())
    }

    pub fn panes(&self) -> Option<Panes> {
        let (columns, rows) = self.screen;
        let area = Rect::new(0, 0, columns, rows);
        Panes::of(area, &self.reading().imprint, self.halves())
    }

    /// The recognition, if its page is visible.
    pub(in crate::tui) fn recognising(&self) -> Option<&Recognition> {
        let is_visible = self.pane()?.context() == Context::Recognise;
        is_visible.then_some(&self.recognition)
    }

    /// Coverage and the marks of a comparison need a character for each taxel.
    pub(in crate::tui) fn halves(&self) -> bool {
        let compared = self.recognising().and_then(Recognition::compared_with);
        self.display == Display::Imprint && compared.is_none()
    }

    pub(in crate::tui) fn grid(&self) -> Option<Grid> {
        Some(grid(self, self.panes()?.matrix))
    }

    pub(in crate::tui) fn seen(&self) -> Bounds {
        let region = self.reading().region(self.chosen());
        match region.filter(|_| self.follows_region) {
            Some((_, region)) => region.bounds(),
            None => Bounds::of_taxel(self.cursor().0, self.cursor().1),
        }
    }

    /// Makes a change and reads the document again. Afterwards the window follows the cursor if the cursor moved or its
    /// taxel was switched, and the described region if the shape or the imprint changed otherwise, or if a page opened
    /// beside the matrix.
    pub(crate) fn following(&mut self, change: impl FnOnce(&mut Self)) {
        let state = |app: &Self| {
            let page = app.pane().map(Page::place);
            let accompanied = matches!(page, Some(Place::Form | Place::Panel));
            // A small move changes the source, but may leave the same taxels active.
            let source = app.shown.source.clone();
            (app.cursor(), accompanied, source, app.reading.imprint)
        };
        let (from, was_accompanied, old_source, old) = state(self);
        change(self);
        self.read();
        let (to, accompanied, source, new) = state(self);
        let same_sensor = new.size() == old.size();
        let mut changed = new.differing(&old);
        changed.set(to.0, to.1, false);
        let elsewhere = !same_sensor
            || !changed.is_empty()
            || source != old_source
            || accompanied && !was_accompanied;
        if same_sensor && to != from {
            self.follows_region = false;
        } else if elsewhere || new != old {
            self.follows_region = elsewhere;
        }
    }

    pub(in crate::tui) fn body_size(&self) -> (u16, u16) {
        self.panes()
            .map_or((0, 0), |panes| panes.body.as_size().into())
    }

    /// Returns the document that the matrix shows: the one that an open form would make, or the present one.
    pub fn shown(&self) -> &Document {
        &self.shown
    }

    pub fn reading(&self) -> &Reading {
        &self.reading
    }

    /// Reads the document that the matrix shows, if it has changed. Called after every change, so that drawing, keys
    /// and the journal share one reading.
    pub(in crate::tui) fn read(&mut self) {
        let form = find::<FormDialog>(&self.pages);
        let document = form.map_or(self.history.present(), |form| &form.shown);
        if *document != self.shown {
            self.reading = Reading::of(document);
            self.shown = document.clone();
        }
    }

    /// Called before each action.
    pub(in crate::tui) fn begin_action(&mut self) {
        self.notice = None;
        self.prompt = None;
        // A key came between press and release: the rest of the drag would change another document than the press
        // did.
        self.paint = None;
    }

    /// On a smaller sensor than the one that the cursor was put on, this is at the rim.
    pub fn cursor(&self) -> (u8, u8) {
        let (sensor, (column, row)) = (&self.shown().sensor, self.cursor);
        (column.min(sensor.columns() - 1), row.min(sensor.rows() - 1))
    }

    pub fn chosen(&self) -> Option<usize> {
        self.history.chosen()
    }

    pub(in crate::tui) fn stored(&self) -> Option<&StoredName> {
        self.history.origin().name.as_ref()
    }

    pub fn stored_name(&self) -> Option<&str> {
        self.stored().map(|stored| stored.name.as_str())
    }

    /// None if a source made the imprint on the matrix, or if it has no name.
    pub(in crate::tui) fn loaded_imprint(&self) -> Option<(&str, &Imprint)> {
        let document = self.history.present();
        let name = self.stored_name().filter(|_| document.source.is_none())?;
        (!document.edits.is_empty()).then_some((name, &document.edits))
    }

    pub fn ended(&self) -> bool {
        self.run_state != RunState::Running
    }
}

impl fmt::Debug for App {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("App")
    }
}
