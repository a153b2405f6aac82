//! The steps that lead to results: the form of ranges, a sweep or an export in progress, and what its worker reports.
//!
//! ```text
//! Open -> form of ranges -> Start -> Running -> Swept -> results        Stop: the results so far
//! results -> name of a file -> Running -> Written                       Stop: no file
//! results -> name of a drawing or of the tab's table -> a request about files   explore::update
//! ```
//! Each piece of work has a number, and its events carry it. Events of work that is no longer awaited are dropped.

use std::sync::Arc;
use std::time::Duration;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::picture::Picture;
use taxel_core::pose::{PoseGrid, PoseIndex};
use taxel_core::source::Source;
use taxel_files::formats::file::has_ending;
use taxel_files::formats::value::{counted, grouped};
use taxel_files::storage::{Existing, is_poses};

use crate::tui::app::change::{inform, refuse};
use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, Page, Slot, find_mut};
use crate::tui::app::question::Question;
use crate::tui::app::state::{App, RunState};
use crate::tui::explore::angles::AngleCurve;
use crate::tui::explore::message::{ExploreMessage, Findings, SweepProgress, name_of};
use crate::tui::explore::prompts::{ExportDialog, ExportKind};
use crate::tui::explore::ranges::{RangesForm, about};
use crate::tui::explore::results::Results;
use crate::tui::explore::view::ResultPanes;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::runtime::effect::{Effect, Work};
use crate::tui::runtime::perform;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

pub(in crate::tui) fn act(app: &mut App, asked: ExploreMessage) -> Option<Effect> {
    match asked {
        ExploreMessage::Open => open(app),
        ExploreMessage::Ranges => open_ranges(app, None),
        ExploreMessage::Start(grid) => start(app, *grid),
        ExploreMessage::Write(name, existing) => {
            let found = Arc::clone(&app.results_below()?.findings);
            let poses = is_poses(&name).then(|| found.sweep.grid.poses());
            let number = begin(app, WorkKind::Write(name.clone(), poses));
            return Some(Effect::Work(Work::Write(number, found, name, existing)));
        }
        _ => {}
    }
    None
}

pub(super) fn tab_area(app: &App, results: &Results) -> Rect {
    let area = app.panes().map(|panes| panes.area(results.slot()));
    area.map_or(Rect::default(), |area| ResultPanes::of(area).tab)
}

/// Opens the last results if they belong to the shape on the matrix, otherwise the form. Results of another shape are
/// kept: the form opens, and they are there again with their shape.
fn open(app: &mut App) {
    match app.results.take() {
        Some(results) if is_of(app, &results) => app.pages.push(results),
        others => {
            app.results = others;
            open_ranges(app, None);
        }
    }
}

pub(in crate::tui) fn explored(app: &App) -> Option<Source> {
    let document = app.history.present();
    if document.source.is_some() {
        return document.source.clone();
    }
    // Without a source, the document consists of the edits alone.
    let imprint = document.edits;
    let picture = (!imprint.is_empty()).then(|| Picture::at_home(imprint))?;
    Some(Source::Picture(match app.stored_name() {
        Some(name) => picture.named(name),
        None => picture,
    }))
}

/// Returns true if results belong to the shape on the matrix, wherever the shape is now.
fn is_of(app: &App, results: &Results) -> bool {
    let grid = &results.sweep().grid;
    let present = app.history.present();
    explored(app).is_some_and(|source| grid.is_of(&source, &present.sensor))
}

/// Opens the form, above the results of this grid.
pub(super) fn open_ranges(app: &mut App, below: Option<&PoseGrid>) {
    let present = app.history.present();
    let Some(source) = explored(app) else {
        let text = app.nothing_to_explore();
        return refuse(app, text);
    };
    let last = app.forms.ranges.as_ref();
    let mut form = RangesForm::new(present, source, below, last);
    let effect = measure(&mut form);
    app.open(form);
    perform(app, effect);
}

fn measure(form: &mut RangesForm) -> Option<Effect> {
    let grid = form.unmeasured()?;
    Some(Effect::Work(Work::Measure(Box::new(grid))))
}

fn start(app: &mut App, grid: PoseGrid) {
    let number = begin(app, WorkKind::Sweep(Box::new(grid.clone())));
    perform(app, Some(Effect::Work(Work::Sweep(number, Box::new(grid)))));
}

fn begin(app: &mut App, job: WorkKind) -> u64 {
    app.works += 1;
    app.open(Running::new(app.works, job));
    app.works
}

pub(super) fn in_ranges(form: &mut RangesForm, app: &mut App, message: &Message) -> Flow {
    match message {
        Message::Accept => match form.accepted() {
            Ok(grid) => {
                app.forms.ranges = Some(form.remembered());
                start(app, grid);
                return Flow::Close;
            }
            Err(error) => refuse(app, error.full),
        },
        Message::Type(character) if form.form.focus().is_none() && *character != ' ' => {
            refuse(app, "an arrow or Space chooses the other anchor");
        }
        message => form.take(message),
    }
    let effect = measure(form);
    perform(app, effect);
    Flow::Stay
}

/// Handles a message over work in progress. Closing the page stops the work; the page stays until the worker has
/// answered, because only then is it known what is complete. Quitting meanwhile ends the program at once: nothing
/// else would while a worker hangs, and unsaved work is offered at the next start.
fn in_running(running: &mut Running, app: &mut App, message: &Message) -> Flow {
    let stops = matches!(
        message,
        Message::Explore(ExploreMessage::Stop) | Message::Cancel | Message::Quit
    );
    if running.stopping && *message == Message::Quit {
        app.run_state = RunState::Terminated;
    } else if stops {
        running.stopping = true;
        inform(app, "stopping");
    }
    perform(app, stops.then_some(Effect::Work(Work::Stop)));
    Flow::Stay
}

/// Returns true if this work is awaited.
pub(in crate::tui) fn on_progress(app: &mut App, number: u64, progress: SweepProgress) -> bool {
    let running = running(app, number);
    let waited = running.is_some();
    if let Some(running) = running {
        running.progress = Some(progress);
    }
    waited
}

pub(in crate::tui) fn on_estimate(app: &mut App, grid: &PoseGrid, time: Duration) {
    if let Some(form) = app.page_mut::<RangesForm>() {
        form.take_estimate(grid, time);
    }
}

pub(in crate::tui) fn next_work(app: &mut App) -> Option<Effect> {
    let results = app.top_mut::<Results>()?;
    let place = results.missing_angles()?;
    let findings = Arc::clone(&results.findings);
    Some(Effect::Work(Work::Angles(findings, place)))
}

pub(in crate::tui) fn on_angles(
    app: &mut App,
    findings: &Arc<Findings>,
    place: PoseIndex,
    curve: Result<Arc<AngleCurve>, String>,
) {
    let results = find_mut::<Results>(&mut app.pages).or(app.results.as_deref_mut());
    let Some(results) = results.filter(|own| Arc::ptr_eq(&own.findings, findings)) else {
        return;
    };
    results.take_angles(place, curve.as_ref().ok().cloned());
    if let Err(reason) = curve {
        refuse(app, reason);
    }
}

pub(in crate::tui) fn on_written(app: &mut App, number: u64, name: &str) {
    if finish(app, number).is_some() {
        inform(app, format!("written: {name}{}", filter_remark(app, name)));
    }
}

/// If not, the prompt for its name opens again.
pub(in crate::tui) fn on_existing(app: &mut App, number: u64, name: &str) {
    if let Some(place) = finish(app, number) {
        let again = ExploreMessage::Write(name.to_owned(), Existing::Replaced);
        let yes = |app: &mut App| {
            let effect = act(app, again);
            perform(app, effect);
        };
        let kind = app.results_below().map(ExportKind::of);
        let prompt = kind.map(|kind| Box::new(ExportDialog::new(name, kind)));
        let question = Question {
            prompt: prompt.map(|prompt| prompt as Box<dyn Page>),
            ..Question::replaces(name, yes)
        };
        ask(app, place, question);
    }
}

/// Returns true if this work was awaited.
pub(in crate::tui) fn on_failure(app: &mut App, number: u64, reason: &str) -> bool {
    let name = running(app, number).and_then(|running| match &running.job {
        WorkKind::Write(name, _) if !running.stopping => Some(name.clone()),
        _ => None,
    });
    let Some(place) = finish(app, number) else {
        return false;
    };
    let kind = app.results_below().map(ExportKind::of);
    if let Some((name, kind)) = name.zip(kind) {
        ask(app, place, ExportDialog::new(&name, kind));
    }
    refuse(app, reason);
    true
}

/// Returns the remark that a file holds all imprints although their list is filtered. Empty without a filter, and for
/// a drawing, which shows what its tab shows.
fn filter_remark(app: &App, name: &str) -> String {
    match app.results_below() {
        Some(results) if !results.list.filter().is_empty() && !has_ending(name, "svg") => {
            let imprints = counted(results.sweep().atlas.len() as u64, "imprint");
            format!(", all {imprints} (the filter does not apply)")
        }
        _ => String::new(),
    }
}

fn ask(app: &mut App, place: usize, page: impl Page) {
    app.pages.truncate(place);
    app.open(page);
}

fn running(app: &mut App, number: u64) -> Option<&mut Running> {
    app.page_mut::<Running>()
        .filter(|running| running.number == number)
}

/// Returns its index among the pages; None if it is not awaited.
fn finish(app: &mut App, number: u64) -> Option<usize> {
    running(app, number)?;
    let place = app.pages.iter().rposition(|page| page.is::<Running>())?;
    app.pages.remove(place);
    app.notice = None;
    Some(place)
}

/// A stopped sweep gives results of what was complete, as a notice says; a sweep stopped before anything was complete
/// gives none.
pub(in crate::tui) fn take_findings(app: &mut App, number: u64, findings: Arc<Findings>) {
    let Some(place) = finish(app, number) else {
        return;
    };
    let result = &findings.sweep;
    if result.poses == 0 {
        return refuse(app, "stopped before anything was complete");
    }
    if !result.complete() {
        inform(
            app,
            format!(
                "stopped after {} of {} poses",
                grouped(result.poses),
                grouped(result.grid.poses())
            ),
        );
    }
    let results = Box::new(Results::new(findings));
    app.pages.insert(place, results);
    let mut before = app.pages[..place].iter();
    if let Some(earlier) = before.position(|page| page.is::<Results>()) {
        app.pages.remove(earlier);
    }
    app.results = None;
}

#[derive(Clone, Debug, PartialEq)]
pub enum WorkKind {
    Sweep(Box<PoseGrid>),
    Write(String, Option<u64>),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Running {
    pub number: u64,
    pub job: WorkKind,
    pub progress: Option<SweepProgress>,
    pub stopping: bool,
}

impl Running {
    pub fn new(number: u64, job: WorkKind) -> Self {
        Self {
            number,
            job,
            progress: None,
            stopping: false,
        }
    }

    pub fn poses(&self) -> Option<u64> {
        match &self.job {
            WorkKind::Sweep(grid) => Some(grid.poses()),
            WorkKind::Write(_, poses) => *poses,
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "for reading")]
    pub fn rate(&self) -> Option<f64> {
        let SweepProgress { poses, elapsed } = self.progress?;
        let seconds = elapsed.as_secs_f64();
        (seconds > 0.0 && poses > 0).then(|| poses as f64 / seconds)
    }

    #[expect(clippy::cast_precision_loss, reason = "for reading")]
    pub fn left(&self) -> Option<f64> {
        let rest = self.poses()?.saturating_sub(self.progress?.poses);
        Some(rest as f64 / self.rate()?)
    }
}

const WIDEST: u16 = 60;

impl Page for Running {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_running(self, app, message)
    }

    fn context(&self) -> Context {
        Context::Running
    }

    fn slot(&self) -> Slot {
        Slot::Body
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let inner = write::right_of(area, area.x.saturating_add(2));
        let (title, end) = match &self.job {
            WorkKind::Sweep(grid) => (
                format!("Exploring: {}", name_of(grid.source())),
                "stopping keeps what is complete",
            ),
            WorkKind::Write(name, _) => {
                (format!("Writing {name}"), "stopping leaves no file behind")
            }
        };
        // On a low screen, there are no blank lines between them.
        let spaced = usize::from(area.height >= 9);
        let row = |index: usize| write::row(inner, index * (1 + spaced));
        write::text(buffer, row(0), theme, &title, Role::Title);
        let done = self.progress.map_or(0, |progress| progress.poses);
        if let Some(all) = self.poses() {
            let percent = u128::from(done) * 100 / u128::from(all.max(1));
            let all_of_them = counted(all, "pose");
            let text = format!("{} of {all_of_them}, {percent} %", grouped(done));
            write::text(buffer, row(1), theme, &text, Role::Text);
            gauge(theme, done, all, buffer, row(2));
        }
        let time = speed(self);
        write::text(buffer, row(3), theme, &time, Role::Text);
        let end = if self.stopping {
            "stopping; Ctrl-C quits at once"
        } else {
            end
        };
        write::text(buffer, row(4), theme, end, Role::Quiet);
        None
    }

    fn cancels_itself(&self) -> bool {
        true
    }
}

pub(in crate::tui) fn gauge(theme: &Theme, done: u64, all: u64, buffer: &mut Buffer, row: Rect) {
    let [full, _, empty] = theme.bar();
    let width = row.width.min(WIDEST);
    let filled = u128::from(done) * u128::from(width) / u128::from(all.max(1));
    let filled = u16::try_from(filled).unwrap_or(width).min(width);
    let text = |character: char, count: u16| character.to_string().repeat(count.into());
    let (done, rest) = (text(full, filled), text(empty, width - filled));
    let pieces = [(done.as_str(), Role::Chosen), (rest.as_str(), Role::Quiet)];
    write::line(buffer, row, theme, pieces);
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "saturates"
)]
fn speed(running: &Running) -> String {
    let Some(rate) = running.rate() else {
        return String::new();
    };
    let left = running
        .left()
        .and_then(|left| Duration::try_from_secs_f64(left).ok());
    let left = left.map_or(String::new(), |left| format!(", {} left", about(left)));
    format!("{} poses a second{left}", grouped(rate as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rate_and_time_left_follow_the_progress() {
        let mut running = Running::new(1, WorkKind::Write("a.npy".to_owned(), Some(1000)));
        assert_eq!((running.rate(), running.left()), (None, None));
        let progress = |poses, millis| {
            let elapsed = Duration::from_millis(millis);
            Some(SweepProgress { poses, elapsed })
        };
        running.progress = progress(0, 100);
        assert_eq!((running.rate(), running.left()), (None, None));
        running.progress = progress(250, 500);
        assert_eq!((running.rate(), running.left()), (Some(500.0), Some(1.5)));
        running.progress = progress(250, 0);
        assert_eq!(running.rate(), None, "a clock that stands still");
        running.progress = progress(1200, 500);
        assert_eq!(running.left(), Some(0.0));
    }
}
