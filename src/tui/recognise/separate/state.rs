//! The state of the page of sizes: what was found so far, the size under the cursor, the work in progress.

use std::sync::Arc;

use crate::formats::separation::{SeparationCurve, csv, drawing};
use crate::recognition::{SeparationPoint, SmallestSize};
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::explore::drawing::drawn_format;
use crate::tui::explore::page::is_csv;
use crate::tui::recognise::message::RecogniseMessage;
use crate::tui::recognise::separate::found::{SizeFound, SizesFound};
use crate::tui::recognise::separate::request::SeparationRequest;

/// The errors that can be wanted by keys.
const WANTED: [f64; 11] = [
    0.0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5,
];

/// Work in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizeWork {
    /// Its number.
    pub number: u64,
    /// Touches that are done.
    pub done: u64,
    /// Touches of all sizes that it looks at.
    pub all: u64,
    /// The error that it looks for.
    wanted: f64,
    /// Whether a stop was requested.
    pub stopping: bool,
}

/// The page.
#[derive(Clone, Debug)]
pub struct Separate {
    /// What is looked at.
    request: Arc<SeparationRequest>,
    /// What was found, the smallest size first.
    found: Vec<SizeFound>,
    /// The smallest size that reaches the wanted error, once that was searched.
    smallest: Option<SmallestSize>,
    /// Whether it was searched.
    searched: bool,
    /// Whether the work was stopped, or failed: it continues only on request.
    stopped: bool,
    /// The work in progress.
    work: Option<SizeWork>,
    /// The row of the table under the cursor.
    cursor: usize,
    /// Whether the user has moved it; until then it goes to the size that is looked for.
    moved: bool,
}

impl Separate {
    /// A page that knows of no size yet.
    pub fn new(request: SeparationRequest) -> Self {
        Self {
            request: Arc::new(request),
            found: Vec::new(),
            smallest: None,
            searched: false,
            stopped: false,
            work: None,
            cursor: 0,
            moved: false,
        }
    }

    /// What is looked at.
    pub fn request(&self) -> &Arc<SeparationRequest> {
        &self.request
    }

    /// What was found, the smallest size first.
    pub fn found(&self) -> &[SizeFound] {
        &self.found
    }

    /// The row of the table under the cursor.
    pub fn cursor(&self) -> usize {
        self.cursor
    }

    /// What was found of the size under the cursor.
    pub fn selected(&self) -> Option<&SizeFound> {
        self.found.get(self.cursor)
    }

    /// The smallest size that reaches the wanted error: None if it was not searched, or there is none.
    pub fn smallest(&self) -> Option<Option<&SmallestSize>> {
        self.searched.then_some(self.smallest.as_ref())
    }

    /// The work in progress.
    pub fn work(&self) -> Option<&SizeWork> {
        self.work.as_ref()
    }

    /// Begins the rest of the work as that of a number: the sizes that are not known yet, and the search. Returns what is
    /// asked for and the points that are known; None while work is in progress, after it was stopped, or where there is
    /// nothing to do.
    pub fn begin(&mut self, number: u64) -> Option<(Arc<SeparationRequest>, Vec<SeparationPoint>)> {
        if self.work.is_some() || self.searched || self.stopped {
            return None;
        }
        let left = self.request.values().len() - self.found.len();
        let touches = self.request.separation().map_or(0, |set| set.touches());
        self.work = Some(SizeWork {
            number,
            done: 0,
            all: touches * left as u64,
            wanted: self.request.wanted,
            stopping: false,
        });
        Some((Arc::clone(&self.request), self.points()))
    }

    /// The points that are known.
    fn points(&self) -> Vec<SeparationPoint> {
        self.found.iter().map(|size| size.point.clone()).collect()
    }

    /// Notes how far the work of a number is.
    pub fn take_progress(&mut self, number: u64, done: u64) {
        if let Some(work) = self.work.as_mut().filter(|work| work.number == number) {
            work.done = done;
        }
    }

    /// Lets stopped work go on; `false` if none was stopped.
    pub fn go_on(&mut self) -> bool {
        std::mem::take(&mut self.stopped)
    }

    /// Notes that the work should stop; `false` if there is none, or a stop was requested already.
    pub fn stop(&mut self) -> bool {
        let work = self.work.as_mut();
        work.is_some_and(|work| !std::mem::replace(&mut work.stopping, true))
    }

    /// Takes what was found. Returns why the work ended too early.
    pub fn take_found(&mut self, found: SizesFound) -> Option<String> {
        let work = self.work.filter(|work| work.number == found.number)?;
        self.found.extend(found.sizes);
        let end = found.end?;
        self.work = None;
        match end {
            Ok(smallest) => {
                self.smallest = smallest;
                // Another error may be wanted by now.
                self.searched = work.wanted == self.request.wanted;
                self.go_to_wanted();
                None
            }
            Err(reason) => {
                self.stopped = true;
                Some(reason)
            }
        }
    }

    /// Puts the cursor onto the first size that reaches the wanted error, or the last one, unless the user has moved it.
    fn go_to_wanted(&mut self) {
        if !self.moved {
            let wanted = self.request.wanted;
            let reaches = |size: &SizeFound| size.point.error() <= wanted;
            let first = self.found.iter().position(reaches);
            self.cursor = first.unwrap_or(self.found.len().saturating_sub(1));
        }
    }

    /// Wants the next smaller or larger error of a list.
    pub fn want(&mut self, by: i8) {
        let now = self.request.wanted;
        let next = match by {
            0.. => WANTED.iter().copied().find(|error| *error > now),
            _ => WANTED.iter().rev().copied().find(|error| *error < now),
        };
        let Some(wanted) = next else { return };
        let request = SeparationRequest {
            wanted,
            ..(*self.request).clone()
        };
        self.want_as(request);
    }

    /// Wants the error of a request for the same sizes.
    pub fn want_as(&mut self, request: SeparationRequest) {
        if self.request.wanted != request.wanted {
            self.searched = false;
            self.stopped = false;
            self.moved = false;
        }
        self.request = Arc::new(request);
        self.go_to_wanted();
    }

    /// Moves the cursor.
    pub fn take(&mut self, message: &Message) {
        let row = match *message {
            Message::Scroll(lines) => self.cursor.saturating_add_signed(isize::from(lines)),
            Message::ScrollTo(Endpoint::First) => 0,
            Message::ScrollTo(Endpoint::Last) => usize::MAX,
            Message::Recognise(RecogniseMessage::Select(row)) => row,
            _ => return,
        };
        self.cursor = row.min(self.found.len().saturating_sub(1));
        self.moved = true;
    }

    /// The content of a file of that name, by its ending: numbers or curves.
    ///
    /// # Errors
    /// What was expected of the name.
    pub fn file(&self, name: &str) -> Result<Vec<u8>, String> {
        let request = &self.request;
        let curves = [SeparationCurve {
            threshold: request.threshold,
            points: self.points(),
            smallest: self.smallest.clone(),
        }];
        if is_csv(name) {
            return Ok(csv(request.axis, &curves).into_bytes());
        }
        let format = drawn_format(name).ok_or("expected a name that ends in .csv, .svg or .png")?;
        let plot = drawing(request.axis, &curves, Some(request.wanted));
        plot.content(format).map_err(|error| error.to_string())
    }
}
