//! The steps that lead to results: the form of ranges, a sweep in progress, and what comes of it; and their file.
//!
//! ```text
//! Open -> form of ranges -> Start -> Running -> results                 Stop: the results so far
//! ```

use std::sync::Arc;
use std::time::Duration;

use ratatui::layout::{Position, Rect};
use taxel_core::picture::Picture;
use taxel_core::pose::PoseGrid;
use taxel_core::quote::shortened;
use taxel_core::source::Source;
use taxel_core::sweep::{Sweep, SweepResult};
use taxel_files::formats::value::{counted, grouped};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{Existing, atlas_path, write_atlas};

use crate::tui::app::{
    App, Canvas, Flow, Message, Page, Place, Placed, RunState, Wheel, inform, refuse, write_file,
};
use crate::tui::explore::ranges::{RangesForm, about};
use crate::tui::explore::results::Results;
use crate::tui::explore::{ExploreMessage, Findings, name_of};
use crate::tui::jobs::{self, answer};
use crate::tui::keys::Context;
use crate::tui::widget::{Role, TextField, write};

/// What helps a sweep, whose results are in memory.
const COARSER: &str =
    "take coarser steps, or sweep it in shards on the command line (taxel sweep --shard)";

pub(crate) fn act(app: &mut App, asked: ExploreMessage) {
    match asked {
        ExploreMessage::Open => open(app),
        ExploreMessage::Ranges => open_ranges(app, None),
        ExploreMessage::Start(grid) => sweep(app, *grid),
        _ => {}
    }
}

/// Opens the last results if they belong to the shape on the matrix, wherever it is now; otherwise the form. Results of
/// another shape are kept: the form opens, and they are there again with their shape.
fn open(app: &mut App) {
    let (explored, sensor) = (explored(app), app.history.present().sensor);
    let own = app.results.take_if(|results| {
        let grid = &results.sweep().grid;
        explored.is_some_and(|source| grid.is_of(&source, &sensor))
    });
    match own {
        Some(results) => app.pages.push(results),
        None => open_ranges(app, None),
    }
}

pub(crate) fn explored(app: &App) -> Option<Source> {
    let document = app.history.present();
    if document.source.is_some() {
        return document.source.clone();
    }
    // Without a source, the document consists of the edits alone.
    let imprint = document.edits;
    let picture = (!imprint.is_empty()).then(|| Source::from(Picture::at_home(imprint)))?;
    Some(match app.stored_name() {
        Some(name) => picture.named(name),
        None => picture,
    })
}

/// Opens the form with the ranges of an earlier sweep, if there is one.
pub(super) fn open_ranges(app: &mut App, earlier: Option<&PoseGrid>) {
    let document = app.history.present();
    let Some(source) = explored(app) else {
        return refuse(app, app.nothing_to_explore());
    };
    let by_hand = document.source.as_ref();
    let by_hand = by_hand.map_or(0, |_| document.edits.count());
    let of = (source, document.sensor, by_hand);
    app.open(RangesForm::new(of, earlier));
}

pub(super) fn sweep(app: &mut App, grid: PoseGrid) {
    app.open(Running {
        title: format!("Exploring: {}", name_of(grid.source())),
        poses: grid.poses(),
        progress: None,
        stopping: false,
    });
    app.jobs.run(jobs::Slot::Sweep, move |progress| {
        progress.counts(|app, poses, elapsed| {
            if let Some(running) = app.page_mut::<Running>() {
                running.progress = Some((poses, elapsed));
            }
        });
        let memory = MemoryGuard::new(COARSER);
        let swept = memory.limit(progress, |progress| {
            Sweep::new(&grid).with_progress(progress).run()
        });
        let found = swept.map(|result| Arc::new(Findings::new(result)));
        answer(move |app| match (finish(app), found) {
            (Some(place), Ok(found)) => take_findings(app, place, found),
            (_, Err(reason)) => refuse(app, reason),
            _ => {}
        })
    });
}

/// Closes the page of the sweep. Returns its index among the pages.
fn finish(app: &mut App) -> Option<usize> {
    let place = app.pages.iter().position(|page| page.is::<Running>())?;
    app.pages.remove(place);
    Some(place)
}

/// A stopped sweep gives results of what was complete, as a notice says; a sweep stopped before anything was complete
/// gives none.
fn take_findings(app: &mut App, place: usize, findings: Arc<Findings>) {
    let SweepResult {
        poses, ref grid, ..
    } = findings.sweep;
    if poses == 0 {
        return refuse(app, "stopped before anything was complete");
    }
    if poses < grid.poses() {
        let [done, all] = [poses, grid.poses()].map(grouped);
        inform(app, format!("stopped after {done} of {all} poses"));
    }
    let results = Box::new(Results::new(findings));
    app.pages.insert(place, results);
    let mut before = app.pages[..place].iter();
    if let Some(earlier) = before.position(|page| page.is::<Results>()) {
        app.pages.remove(earlier);
    }
    app.results = None;
}

/// The prompt for the file of all imprints; its ending gives the format.
pub(crate) struct ExportDialog(TextField);

impl ExportDialog {
    pub(super) fn new(results: &Results) -> Self {
        // A slash would separate folders.
        let what = name_of(results.sweep().grid.source()).replace('/', "-");
        let mut field = TextField::new(format!("{what}.csv"), 4096);
        field.enter();
        Self(field)
    }
}

impl Page for ExportDialog {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        if *message != Message::Accept {
            self.0.take(message);
            return Flow::Stay;
        }
        let name = self.0.text().trim().to_owned();
        match (atlas_path(&name), app.page::<Results>()) {
            (Ok(_), Some(results)) => {
                let found = Arc::clone(&results.findings);
                Flow::ask(|app| {
                    write_file(app, name, Existing::Kept, move |path, existing| {
                        let file = write_atlas(path, &found.sweep, existing)?;
                        file.persist().map(drop)
                    });
                })
            }
            (Err(expected), _) if name.is_empty() => {
                refuse(app, expected);
                Flow::Stay
            }
            (Err(expected), _) => {
                refuse(app, format!("{:?}: {expected}", shortened(&name)));
                Flow::Stay
            }
            _ => Flow::Close,
        }
    }

    fn placed(&self) -> Placed {
        (Context::Export, Place::Prompt, Wheel::Idle)
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let (label, endings) = ("Export all imprints to: ", "   (.csv .jsonl .npz)");
        Some(canvas.prompt(area, label, &self.0, endings))
    }
}

/// A sweep in progress.
pub(crate) struct Running {
    title: String,
    /// All that there are.
    poses: u64,
    /// The poses so far, and the time that they took.
    progress: Option<(u64, Duration)>,
    stopping: bool,
}

/// Closes the page of a sweep that has failed without an answer of its own.
pub(crate) fn close_if_failed(app: &mut App) {
    if !app.jobs.is_running(jobs::Slot::Sweep) && app.page::<Running>().is_some() {
        finish(app);
    }
}

impl Running {
    /// Says how fast it is and how long it takes: `1,000 poses a second, about 2 s left`.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "for reading"
    )]
    fn speed(&self) -> Option<String> {
        let (poses, elapsed) = self.progress?;
        let rate = poses as f64 / elapsed.as_secs_f64();
        if rate <= 0.0 || !rate.is_finite() {
            return None;
        }
        let mut text = format!("{} poses a second", grouped(rate as u64));
        let left = self.poses.saturating_sub(poses) as f64 / rate;
        if let Ok(left) = Duration::try_from_secs_f64(left) {
            text += &format!(", {} left", about(left));
        }
        Some(text)
    }
}

impl Page for Running {
    /// Closing the page stops the work; the page stays until the worker has answered, because only then is it known
    /// what is complete. Quitting meanwhile ends the program at once.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let stops = matches!(
            message,
            Message::Explore(ExploreMessage::Stop) | Message::Cancel | Message::Quit
        );
        if self.stopping && *message == Message::Quit {
            app.run_state = RunState::Terminated;
        } else if stops {
            app.jobs.stop(jobs::Slot::Sweep);
            self.stopping = true;
            inform(app, "stopping");
        }
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Running, Place::Body, Wheel::Idle)
    }

    fn draw(&self, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let inner = write::right_of(area, area.x.saturating_add(2));
        let row = |index: usize| write::row(inner, 2 * index);
        canvas.text(row(0), &self.title, Role::Title);
        let (done, all) = (self.progress.map_or(0, |(poses, _)| poses), self.poses);
        let percent = u128::from(done) * 100 / u128::from(all.max(1));
        let text = format!("{} of {}, {percent} %", grouped(done), counted(all, "pose"));
        canvas.text(row(1), &text, Role::Text);
        gauge(&mut canvas, done, all, row(2));
        canvas.text(row(3), &self.speed().unwrap_or_default(), Role::Text);
        let end = if self.stopping {
            "stopping; Ctrl-C quits at once"
        } else {
            "stopping keeps what is complete"
        };
        canvas.text(row(4), end, Role::Quiet);
        None
    }

    fn cancels_itself(&self) -> bool {
        true
    }
}

fn gauge(canvas: &mut Canvas<'_>, done: u64, all: u64, row: Rect) {
    let [full, _, empty] = canvas.theme.bar();
    let width = row.width.min(60);
    let filled = u128::from(done.min(all)) * u128::from(width) / u128::from(all.max(1));
    let filled = u16::try_from(filled).unwrap_or(width);
    let text = |character: char, count: u16| character.to_string().repeat(count.into());
    let (done, rest) = (text(full, filled), text(empty, width - filled));
    canvas.line(row, [(&*done, Role::Chosen), (&*rest, Role::Quiet)]);
}
