//! The imprints of the rows of one orientation, run by run instead of pose by pose.
//!
//! From the spans of a band ([`crate::sweep::span`]) [`crate::sweep::flips`] makes events; between two of them the
//! imprint is the same: one *run*. Rows that are images of rows swept before ([`crate::sweep::point_symmetry`]) follow
//! from those.

use crate::atlas::{ImprintCounter, Layout};
use crate::geometry::Extent;
use crate::geometry::Real;
use crate::index::from_first;
use crate::pose::{Axis, Boundary, PoseGrid};
use crate::sweep::ellipse::Elliptic;
use crate::sweep::events::Events;
use crate::sweep::exact::Exact;
use crate::sweep::flips::{Marker, Steps};
use crate::sweep::plan::Task;
use crate::sweep::point_symmetry::PointSymmetry;
use crate::sweep::polygon::Polygonal;
use crate::sweep::reflected_rows::{ReflectedRows, Runs};
use crate::sweep::span::Spans;
use crate::touch::DOUBTFUL;

/// The result of a task.
#[derive(Debug)]
pub(crate) struct Found {
    /// Its imprints, counted once per pose of one of its orientations.
    pub(crate) counter: ImprintCounter,
    /// The number of poses of one orientation that reach beyond the sensor.
    pub(crate) partly_off: u64,
    /// The runs of each row, if they are wanted.
    pub(crate) runs: Runs,
}

/// The number of poses between two reports of progress, for a shape with few edges.
const TOLD: u64 = 4_000;
/// This many more edges double the time per pose. A picture may have thousands, and must report as often.
const EDGES: usize = 64;

/// Sweeps the rows of a task. `progress` receives the number of poses of one orientation done since the last call; if
/// it returns `false`, the sweep stops and the result is None.
pub(crate) fn go(
    grid: &PoseGrid,
    layout: &Layout,
    task: &Task,
    keep_runs: bool,
    progress: impl Fn(u64) -> bool,
) -> Option<Found> {
    let turn = task.turns[0];
    let mut sweeper = Sweeper::new(grid, layout, turn);
    let half_turn = PointSymmetry::of(grid).filter(|_| sweeper.lies_inside());
    let mut images = half_turn.map(|half_turn| ReflectedRows::new(layout, half_turn));
    let mut found = Found {
        counter: ImprintCounter::new(layout.words()),
        partly_off: 0,
        runs: Runs::default(),
    };
    let (width, height) = (grid.row_length(), grid.rows_per_orientation());
    let mut untold = 0;
    for y in task.rows.clone() {
        let first = (turn * height + y) * width;
        // The row of this task whose image this one is.
        let known = images.as_mut().and_then(|images| {
            let (source, round) = images.source(y);
            let row = usize::try_from(source.checked_sub(task.rows.start)?).ok()?;
            (source < y).then_some((images, (row, round)))
        });
        found.runs.begin();
        if let Some((images, source)) = known {
            images.add(&mut found.counter, &mut found.runs, source, first);
        } else {
            sweeper.row(y);
            found.partly_off += sweeper.beyond(y);
            sweeper.events.play(|key, hash, from, to| {
                let index = found.counter.add(key, hash, to - from, first + from);
                if keep_runs || half_turn.is_some() {
                    found.runs.push(index, to - from);
                }
            });
        }
        untold += width;
        if untold >= sweeper.told && !progress(std::mem::take(&mut untold)) {
            return None;
        }
    }
    if !keep_runs {
        found.runs = Runs::default();
    }
    progress(untold).then_some(found)
}

/// A shape prepared for sweeping, by kind.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "one per task")]
enum Shape {
    /// Straight edges only.
    Polygonal(Polygonal),
    /// One ellipse, with or without a hole.
    Elliptic(Elliptic),
}

impl Shape {
    /// Takes the way for one ellipse, with or without a hole, else that for straight edges.
    fn new(boundary: &Boundary<f64>) -> Self {
        match Elliptic::new(&boundary.ellipses) {
            Some(elliptic) => Self::Elliptic(elliptic),
            None => Self::Polygonal(Polygonal::new(&boundary.edges)),
        }
    }

    /// Notes where taxels in a row of the sensor turn over, for the band that begins at `top`.
    fn band(&mut self, top: f64, row: usize, threshold: f64, spans: &mut Spans) {
        match self {
            Self::Polygonal(shape) => shape.band(top, threshold, spans),
            Self::Elliptic(shape) => shape.band(top, row, threshold, spans),
        }
    }
}

/// One orientation of a grid on its way through the values of y0.
struct Sweeper<'a> {
    /// The grid.
    grid: &'a PoseGrid,
    /// The number of the orientation.
    turn: u64,
    /// The shape in this orientation, at the origin.
    shape: Shape,
    /// The number of poses between two reports of progress.
    told: u64,
    /// The extent of the shape at the origin; None if it has no boundary.
    extent: Option<Extent>,
    /// The values of x0.
    steps: Steps,
    /// The number of values of x0 for which the shape reaches beyond the left or right side.
    beyond: u64,
    /// The values of y0, by number, that put it beyond neither the upper nor the lower side.
    rows_inside: std::ops::Range<u64>,
    /// Those of the band at hand, in memory that is used again.
    spans: Spans,
    /// What happens along the row at hand.
    events: Events<'a>,
    /// Decides where `f64` cannot.
    exact: Exact<'a>,
}

impl<'a> Sweeper<'a> {
    fn new(grid: &'a PoseGrid, layout: &'a Layout, turn: u64) -> Self {
        let boundary = grid.boundary::<f64>(turn);
        let count = grid.row_length();
        let place = |x: u64| grid.offset::<f64>(turn, x, 0).x;
        let (first, last) = (place(0), place(count - 1));
        let count = i32::try_from(count).unwrap_or(i32::MAX);
        let extent = boundary.extent();
        let outside = |extent: &Extent| {
            let inside = grid.columns_inside(turn, extent);
            grid.row_length() - (inside.end - inside.start)
        };
        Self {
            grid,
            turn,
            shape: Shape::new(&boundary),
            told: TOLD / (1 + boundary.edges.len() / EDGES) as u64,
            beyond: extent.as_ref().map_or(0, outside),
            rows_inside: extent
                .as_ref()
                .map_or(0..0, |extent| grid.rows_inside(turn, extent)),
            extent,
            steps: Steps {
                first,
                // Any value will do for a range of one value.
                per_cell: if count > 1 {
                    f64::from(count - 1) / (last - first)
                } else {
                    1.0
                },
                count,
            },
            spans: Spans::default(),
            events: Events::new(layout, grid.row_length()),
            exact: Exact::new(grid, turn),
        }
    }

    /// Whether the shape lies inside the sensor in every pose of the orientation, without touching its rim.
    fn lies_inside(&self) -> bool {
        let Some(extent) = &self.extent else {
            return false;
        };
        let (ranges, sensor) = (self.grid.ranges(), self.grid.sensor());
        let place = |x, y| self.grid.offset::<f64>(self.turn, x, y);
        let (first, last) = (
            place(0, 0),
            place(ranges[Axis::X0].count() - 1, ranges[Axis::Y0].count() - 1),
        );
        let beyond = |end: f64, side: u8| end > f64::from(side) - DOUBTFUL;
        let off = extent.left + first.x < DOUBTFUL
            || extent.top + first.y < DOUBTFUL
            || beyond(extent.right + last.x, sensor.columns())
            || beyond(extent.bottom + last.y, sensor.rows());
        !off
    }

    /// The number of poses of a row that reach beyond the sensor.
    fn beyond(&self, y: u64) -> u64 {
        match &self.extent {
            Some(_) if !self.rows_inside.contains(&y) => self.grid.row_length(),
            Some(_) => self.beyond,
            None => 0,
        }
    }

    /// Finds the events of a row.
    fn row(&mut self, y: u64) {
        self.events.clear();
        let Some(extent) = &self.extent else { return };
        let offset = self.grid.offset::<f64>(self.turn, 0, y).y;
        let threshold = self.grid.sensor().threshold();
        let rows = i32::from(self.grid.sensor().rows());
        let first = Real::floor(extent.top + offset).max(0);
        let last = Real::floor(extent.bottom + offset).min(rows - 1);
        for row in first..=last {
            let (top, row) = (f64::from(row) - offset, from_first(row));
            self.shape.band(top, row, threshold, &mut self.spans);
            Marker {
                steps: self.steps,
                row,
                y,
                events: &mut self.events,
                exact: &mut self.exact,
            }
            .spans(&self.spans);
        }
    }
}
