//! Finds the imprints of the rows of one orientation, run by run instead of pose by pose.
//!
//! [`crate::sweep::flips`] turns the spans of a band into events; between two events the imprint is the same: one *run*.
//! Rows that are images of rows swept before ([`PointSymmetry`]) follow from those rows.
//!
//! For each row, [`Sweeper`] asks its groups whether they have to see it ([`Group::begin`]), shows them the spans of
//! each band ([`Group::add_flips`]), and lets them count its runs ([`Group::end`]).

use std::ops::Range;
use std::sync::Arc;

use crate::atlas::{ImprintCounter, Layout};
use crate::geometry::{Ellipse, Extent, Point, Real, Side};
use crate::index::{from_first, narrow, wide};
use crate::pose::{Boundary, PoseGrid};
use crate::progress::Progress;
use crate::sweep::ellipse::Elliptic;
use crate::sweep::flips::{DOUBT, Events, Exact, FlipWriter, Spans, Steps, effort};
use crate::sweep::plan::{PointSymmetry, Task};
use crate::sweep::polygon::Polygonal;
use crate::touch::DOUBTFUL;

/// The result of a task for one of its groups.
#[derive(Debug)]
pub(crate) struct GroupResult {
    pub(crate) orientations: Arc<[u64]>,
    pub(crate) rows: Range<u64>,
    /// The imprints of one orientation, with the number of their poses.
    pub(crate) counter: ImprintCounter,
    /// The number of poses of one orientation that reach beyond the sensor.
    pub(crate) partly_off: u64,
    pub(crate) runs: Runs,
}

impl GroupResult {
    /// The number of orientations.
    pub(crate) fn multiplicity(&self) -> u64 {
        self.orientations.len() as u64
    }

    /// The number of poses of all orientations.
    pub(crate) fn poses(&self, grid: &PoseGrid) -> u64 {
        (self.rows.end - self.rows.start) * grid.row_length() * self.multiplicity()
    }
}

/// The number of poses of an orientation between two reports of progress, for a shape with few edges.
const REPORT_EVERY: u64 = 4_000;

/// Sweeps the rows of a task. `progress` receives the number of poses done since the last report, counted over all
/// orientations of the task, which is 0 within a long row; if it returns `Break`, the sweep stops and the result is
/// None. Otherwise there is a result for each group of the task.
pub(crate) fn sweep_task(
    grid: &PoseGrid,
    layout: &Layout,
    task: &Task,
    progress: &impl Progress,
) -> Option<Vec<GroupResult>> {
    let go_on = || progress.add(0).is_continue();
    let mut sweeper = Sweeper::new(grid, layout, task, &go_on);
    let (width, orientations) = (grid.row_length(), task.orientations());
    let mut unreported = 0;
    for y in task.rows.clone() {
        if !sweeper.row(y) {
            return None;
        }
        unreported += width;
        if unreported >= sweeper.report_every
            && (progress.add(std::mem::take(&mut unreported) * orientations)).is_break()
        {
            return None;
        }
    }
    let mut found: Vec<_> = sweeper
        .groups
        .into_iter()
        .map(|group| group.found)
        .collect();
    if !task.with_runs {
        // Kept for images only.
        for found in &mut found {
            found.runs = Runs::default();
        }
    }
    let flow = progress.add(unreported * orientations);
    flow.is_continue().then_some(found)
}

/// A shape prepared for sweeping, by kind.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "one per task")]
enum Shape {
    Polygonal(Polygonal),
    Elliptic(Elliptic),
}

impl Shape {
    /// Uses the method for one ellipse, with or without a hole, if there is nothing else, and otherwise that for straight
    /// edges. Ellipses beside others become polygons then, so coverages near the threshold are decided exactly.
    fn new(boundary: &Boundary<f64>) -> Self {
        let elliptic = Elliptic::new(&boundary.ellipses).filter(|_| boundary.edges.is_empty());
        if let Some(elliptic) = elliptic {
            return Self::Elliptic(elliptic);
        }
        let mut edges = boundary.edges.clone();
        for (ellipse, material) in &boundary.ellipses {
            chords(ellipse, *material, &mut edges);
        }
        let doubt = if boundary.ellipses.is_empty() {
            DOUBT
        } else {
            // Within a cell, a convex arc is no longer than the cell's outline.
            let count = u32::try_from(boundary.ellipses.len()).unwrap_or(u32::MAX);
            DOUBT + 4.0 * HEIGHT * f64::from(count)
        };
        Self::Polygonal(Polygonal::new(&edges, doubt))
    }

    fn has_chords(&self) -> bool {
        matches!(self, Self::Polygonal(shape) if shape.doubt > DOUBT)
    }

    /// Notes where taxels in a row of the sensor switch, for the band that begins at `top`.
    fn band(&mut self, top: f64, row: usize, threshold: f64, spans: &mut Spans) {
        match self {
            Self::Polygonal(shape) => shape.band(top, threshold, spans),
            Self::Elliptic(shape) => shape.band(top, row, threshold, spans),
        }
    }
}

/// The largest distance between an ellipse and its chords, in cell sides.
const HEIGHT: f64 = 5e-4;

/// Adds the chords of an ellipse to the edges of a boundary.
fn chords(ellipse: &Ellipse<f64>, material: Side, edges: &mut Vec<(Point<f64>, Point<f64>)>) {
    let reach = ellipse.reach();
    // The longer radius is at most this.
    let radius = libm::hypot(reach.x, reach.y);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 8 to 100,000"
    )]
    let count = (std::f64::consts::PI / libm::acos((1.0 - HEIGHT / radius).max(0.0)))
        .ceil()
        .clamp(8.0, 1e5) as u32;
    let at = |chord: u32| {
        let degrees = 360.0 * f64::from(chord % count) / f64::from(count);
        let (sin, cos) = degrees.sin_cos_degrees();
        let axis = |own: Point<f64>, part: f64| Point::new(own.x * part, own.y * part);
        let across = axis(ellipse.across, cos);
        ellipse.centre.moved(across).moved(axis(ellipse.along, sin))
    };
    // Clockwise as seen, unless the second axis lies on the other side of the first.
    let turned = ellipse.across.x * ellipse.along.y < ellipse.across.y * ellipse.along.x;
    let is_reversed = turned != (material == Side::Outside);
    edges.extend((0..count).map(|chord| {
        let (from, to) = (at(chord), at(chord + 1));
        if is_reversed { (to, from) } else { (from, to) }
    }));
}

/// Sweeps the orientations of a task, one value of y0 after another.
struct Sweeper<'a> {
    grid: &'a PoseGrid,
    /// The shape in the first orientation of the first group, at the origin.
    shape: Shape,
    /// The number of poses of an orientation between two reports of progress.
    report_every: u64,
    /// The top and the bottom of the shape at the origin.
    height: [f64; 2],
    steps: Steps,
    spans: Spans,
    /// The spans of the mirror image.
    mirrored: Spans,
    /// The sum of the x of a place and of its mirror image, in cell sides, with the anchor at the origin.
    mirror_sum: f64,
    groups: Vec<Group<'a>>,
}

impl<'a> Sweeper<'a> {
    fn new(
        grid: &'a PoseGrid,
        layout: &'a Layout,
        task: &Task,
        go_on: &'a dyn Fn() -> bool,
    ) -> Self {
        let orientation = task.groups[0][0];
        let at_origin = grid.at_origin(orientation);
        let boundary = Boundary::of(&at_origin);
        let count = grid.row_length();
        let place = |x: u64| grid.offset::<f64>(orientation, x, 0).x;
        let (first, last) = (place(0), place(count - 1));
        let count = i32::try_from(count).unwrap_or(i32::MAX);
        let groups = task.groups.iter();
        let shape = Shape::new(&boundary);
        let groups = groups.map(|orientations| {
            let mut group = Group::new(grid, layout, orientations, task, go_on);
            if shape.has_chords() {
                group.exact = group.exact.of_chords();
            }
            group
        });
        Self {
            grid,
            groups: groups.collect(),
            shape,
            report_every: REPORT_EVERY / effort(boundary.edges.len()),
            // Without a boundary there is no row between them.
            height: Extent::of(&at_origin)
                .map_or([0.0, -1.0], |extent| [extent.top, extent.bottom]),
            steps: Steps {
                first,
                // For a range of one value, any number will do.
                per_cell: if count > 1 {
                    f64::from(count - 1) / (last - first)
                } else {
                    1.0
                },
                count,
            },
            spans: Spans::default(),
            mirrored: Spans::default(),
            mirror_sum: 2.0 * at_origin.centre()[0],
        }
    }

    /// Counts the imprints of a row. Returns `false` if the sweep was stopped before its end.
    fn row(&mut self, y: u64) -> bool {
        let mut due = false;
        for group in &mut self.groups {
            due |= group.begin(y);
        }
        if due && !self.sweep(y) {
            return false;
        }
        for group in &mut self.groups {
            group.end(y);
        }
        true
    }

    /// Finds the events of a row. Returns `false` if the sweep was stopped before its end.
    fn sweep(&mut self, y: u64) -> bool {
        let [top, bottom] = self.height;
        let orientation = self.groups[0].orientation();
        let offset = self.grid.offset::<f64>(orientation, 0, y).y;
        let threshold = self.grid.sensor().threshold();
        let rows = i32::from(self.grid.sensor().rows());
        let first = Real::floor(top + offset).max(0);
        let last = Real::floor(bottom + offset).min(rows - 1);
        for row in first..=last {
            let (top, row) = (f64::from(row) - offset, from_first(row));
            self.shape.band(top, row, threshold, &mut self.spans);
            if self.groups.len() > 1 {
                // A cell is named by its left side, which is the right side of its image.
                self.spans.mirror(self.mirror_sum - 1.0, &mut self.mirrored);
            }
            let spans = [&self.spans, &self.mirrored];
            for (group, spans) in self.groups.iter_mut().zip(spans) {
                group.add_flips(self.steps, row, y, spans);
            }
            if self.groups.iter().any(|group| group.exact.stopped) {
                return false;
            }
        }
        true
    }
}

/// A group of orientations, of which only the first is swept.
struct Group<'a> {
    grid: &'a PoseGrid,
    /// The number of values of x0 for which the shape reaches beyond the left or right side.
    beyond: u64,
    /// The indices of the values of y0 at which the shape reaches beyond neither the upper nor the lower side.
    rows_inside: Range<u64>,
    /// The events of the current row.
    events: Events<'a>,
    /// Whether the current row must be swept, because it is not the image of one that was.
    due: bool,
    /// Decides taxels that `f64` cannot decide.
    exact: Exact<'a>,
    /// Rows that are images of others, if there are any.
    images: Option<ReflectedRows<'a>>,
    /// Whether runs are kept, for the caller or for images.
    keep_runs: bool,
    found: GroupResult,
}

impl<'a> Group<'a> {
    fn new(
        grid: &'a PoseGrid,
        layout: &'a Layout,
        orientations: &Arc<[u64]>,
        task: &Task,
        go_on: &'a dyn Fn() -> bool,
    ) -> Self {
        let orientation = orientations[0];
        let (width, height) = (grid.row_length(), grid.rows_per_orientation());
        // What the sensor's rim cuts or touches has no image.
        let is_inside = || grid.positions_inside(orientation, -DOUBTFUL) == [0..width, 0..height];
        let half_turn = PointSymmetry::of(grid).filter(|_| is_inside());
        let [columns_inside, rows_inside] = grid.positions_inside(orientation, DOUBTFUL);
        Self {
            grid,
            beyond: width - (columns_inside.end - columns_inside.start),
            rows_inside,
            events: Events::new(layout, grid.row_length()),
            due: false,
            exact: Exact::new(grid, orientation, go_on),
            images: half_turn.map(|half_turn| ReflectedRows::new(layout, half_turn)),
            keep_runs: task.with_runs || half_turn.is_some(),
            found: GroupResult {
                orientations: Arc::clone(orientations),
                rows: task.rows.clone(),
                counter: ImprintCounter::new(layout.words()),
                partly_off: 0,
                runs: Runs::default(),
            },
        }
    }

    fn orientation(&self) -> u64 {
        self.found.orientations[0]
    }

    fn first(&self, y: u64) -> u64 {
        (self.orientation() * self.grid.rows_per_orientation() + y) * self.grid.row_length()
    }

    /// Begins a row. Returns whether it must be swept; the image of a row that was swept is counted at once.
    fn begin(&mut self, y: u64) -> bool {
        let first = self.first(y);
        self.events.clear();
        self.found.runs.begin();
        let known = self.images.as_mut().and_then(|images| {
            let (source, round) = images.half_turn.y.image(y);
            let row = usize::try_from(source.checked_sub(self.found.rows.start)?).ok()?;
            (source < y).then_some((images, (row, round)))
        });
        self.due = known.is_none();
        if let Some((images, source)) = known {
            let GroupResult { counter, runs, .. } = &mut self.found;
            images.add(counter, runs, source, first);
        }
        self.due
    }

    /// Marks the events in a row of the sensor.
    fn add_flips(&mut self, steps: Steps, row: usize, y: u64, spans: &Spans) {
        if !self.due {
            return;
        }
        FlipWriter::new((steps, row, y), &mut self.events, &mut self.exact).spans(spans);
    }

    fn end(&mut self, y: u64) {
        if !self.due {
            return;
        }
        let first = self.first(y);
        self.found.partly_off += if self.rows_inside.contains(&y) {
            self.beyond
        } else {
            self.grid.row_length()
        };
        let GroupResult { counter, runs, .. } = &mut self.found;
        self.events.play(|key, hash, from, to| {
            let index = counter.add(key, hash, to - from, first + from);
            if self.keep_runs {
                runs.push(index, to - from);
            }
        });
    }
}

// The runs of rows that are images of rows swept before, read backwards.
//
// The image of a row has the same runs in reverse order, cut in two where the range of x0 wraps around. The imprint of
// each run is turned by 180° and shifted by whole cells. The counts and their order are the same as if the row had
// been swept itself.

/// The runs of several rows. A run is the index of its imprint in a counter, and its length.
#[derive(Clone, Debug, Default)]
pub(crate) struct Runs {
    list: Vec<(u32, u32)>,
    /// The index of each row's first run.
    starts: Vec<usize>,
}

impl Runs {
    pub(crate) fn begin(&mut self) {
        self.starts.push(self.list.len());
    }

    pub(crate) fn push(&mut self, index: usize, length: u64) {
        self.list.push((narrow(index), narrow(length)));
    }

    /// Returns the runs of a row, counted from 0; empty for a row that does not exist.
    pub(crate) fn row(&self, row: usize) -> &[(u32, u32)] {
        let start = self.starts.get(row).copied().unwrap_or(self.list.len());
        let end = self.starts.get(row + 1).copied();
        &self.list[start..end.unwrap_or(self.list.len())]
    }
}

/// The images of the imprints of a task.
#[derive(Debug)]
pub(crate) struct ReflectedRows<'a> {
    layout: &'a Layout,
    half_turn: PointSymmetry,
    /// For each index in the counter, the indices of its images, by whether x0 and y0 wrap around.
    known: Vec<[Option<u32>; 4]>,
    key: Vec<u64>,
    /// The runs of the row being made. They are added when it is complete, because it is made from the rows before.
    row: Vec<(usize, u64)>,
}

impl<'a> ReflectedRows<'a> {
    pub(crate) fn new(layout: &'a Layout, half_turn: PointSymmetry) -> Self {
        Self {
            layout,
            half_turn,
            known: Vec::new(),
            key: vec![0; layout.words()],
            row: Vec::new(),
        }
    }

    /// Counts the image of a row; `first` is the number of its first pose.
    pub(crate) fn add(
        &mut self,
        counter: &mut ImprintCounter,
        runs: &mut Runs,
        (source, round): (usize, bool),
        first: u64,
    ) {
        let x = self.half_turn.x;
        self.row.clear();
        let mut pose = first;
        // Backwards from `last` to 0, then from the end to the value after `last`.
        for (part, after) in [(0..x.last + 1, false), (x.last + 1..x.count, true)] {
            let mut end = x.count;
            for &(index, length) in runs.row(source).iter().rev() {
                let start = end - u64::from(length);
                let length = end.min(part.end).saturating_sub(start.max(part.start));
                end = start;
                if length == 0 {
                    continue;
                }
                let image = self.image(counter, wide(index), [after, round], pose);
                counter.count(image, length);
                self.row.push((image, length));
                pose += length;
            }
        }
        for &(index, length) in &self.row {
            runs.push(index, length);
        }
    }

    /// Returns the index of an imprint's image. If the image is new, pose `first` is its first one.
    fn image(
        &mut self,
        counter: &mut ImprintCounter,
        index: usize,
        after: [bool; 2],
        first: u64,
    ) -> usize {
        if self.known.len() <= index {
            self.known.resize(index + 1, [None; 4]);
        }
        let slot = &mut self.known[index][usize::from(after[0]) + 2 * usize::from(after[1])];
        let image = slot.get_or_insert_with(|| {
            let cells = [
                self.half_turn.x.cells(after[0]),
                self.half_turn.y.cells(after[1]),
            ];
            let hash = self
                .layout
                .half_turned(counter.key(index), cells, &mut self.key);
            let image = counter.add(&self.key, hash, 0, first);
            narrow(image)
        });
        wide(*image)
    }
}
