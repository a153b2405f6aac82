//! Turns the spans of a band into the events of a row of the grid.
//!
//! A taxel in column `i` inside of a span from `a` to `b` is active while `i − b ≤ x0 ≤ i − a`. If a value of x0 lies
//! within [`NEAR`] of the end of a span, or in a span that is in doubt, [`Exact`] decides for that taxel and pose.
//!
//! [`FlipWriter`] does this: it reads [`Spans`], asks [`Exact`] and writes [`Events`], which stand below it in this
//! order: `Spans`, `Events`, `Exact`.

use crate::atlas::Layout;
use crate::geometry::{Double, Overlap, Point, Real, nearest};
use crate::index::{from_first, index, narrow, wide};
use crate::pose::{Boundary, PoseGrid};
use crate::touch::{DOUBTFUL, least};

/// The values of x0 as places in the plane: `first + k / per_cell`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steps {
    pub(crate) first: f64,
    pub(crate) per_cell: f64,
    pub(crate) count: i32,
}

/// Rounds a place that is counted in steps down to a whole number, kept within ±1e9.
fn floor(place: f64) -> i32 {
    Real::floor(place.clamp(-1e9, 1e9))
}

/// Writes the events of a row of the sensor.
pub(crate) struct FlipWriter<'s, 'a> {
    steps: Steps,
    row: usize,
    y: u64,
    /// The word of the row in a key, its place in the word, and the hashes of its taxels.
    word: u32,
    shift: usize,
    numbers: &'a [u64],
    events: &'s mut Events<'a>,
    exact: &'s mut Exact<'a>,
}

impl<'s, 'a> FlipWriter<'s, 'a> {
    pub(crate) fn new(
        (steps, row, y): (Steps, usize, u64),
        events: &'s mut Events<'a>,
        exact: &'s mut Exact<'a>,
    ) -> Self {
        let layout = events.layout;
        let (word, shift) = layout.slot(row);
        Self {
            steps,
            row,
            y,
            word: narrow(word),
            shift,
            numbers: layout.numbers(row),
            events,
            exact,
        }
    }

    pub(crate) fn spans(&mut self, spans: &Spans) {
        // The fast path needs span ends that are known more precisely than the grid step.
        if spans.sharp && NEAR * self.steps.per_cell < 0.25 {
            for span in spans.all() {
                let (left, right) = (self.end(span.from, false), self.end(span.to, true));
                if left < right {
                    let ones = u64::MAX >> (64 - (right - left));
                    self.start(ones << left);
                }
            }
        } else {
            self.each_taxel(spans.all());
        }
    }

    /// Marks where the taxels of the row pass the left or the right end of a span. Returns the first taxel that does so
    /// after the first x0, or the number of columns.
    fn end(&mut self, at: f64, is_right: bool) -> usize {
        let columns = self.numbers.len();
        let start = at + self.steps.first;
        let near = NEAR * self.steps.per_cell;
        let last = f64::from(self.steps.count - 1) + near;
        let mut column = from_first(nearest(start - NEAR + 0.5));
        let mut first = None;
        while column < columns {
            #[expect(clippy::cast_precision_loss, reason = "a column")]
            let place = (column as f64 - start) * self.steps.per_cell;
            if place > last {
                return first.unwrap_or(column);
            }
            let step = self.passing(column, place, is_right);
            if step > 0 {
                first = first.or(Some(column));
                if step < self.steps.count {
                    self.flip(column, step.unsigned_abs());
                }
            }
            column += 1;
        }
        first.unwrap_or(columns)
    }

    /// Returns the first step at which a taxel is past an end. `place` is where it passes the end, counted in steps;
    /// it is at most [`NEAR`] before the first step or after the last.
    fn passing(&mut self, column: usize, place: f64, is_right: bool) -> i32 {
        let nearest = nearest(place);
        let after = place - f64::from(nearest);
        if after.abs() > NEAR * self.steps.per_cell {
            return nearest + i32::from(after > 0.0);
        }
        if nearest < 0 || nearest >= self.steps.count {
            return nearest;
        }
        // At exactly this step: past a right end the taxel is active, past a left end it is not.
        nearest + i32::from(self.active(column, nearest) != is_right)
    }

    fn active(&mut self, column: usize, step: i32) -> bool {
        let x = step.unsigned_abs().into();
        self.exact.active(column, self.row, x, self.y)
    }

    /// Marks the spans taxel by taxel: slowly, for spans that are in doubt or close to each other.
    #[cold]
    #[expect(clippy::cast_precision_loss, reason = "a column")]
    fn each_taxel(&mut self, spans: &[Span]) {
        let Steps {
            first,
            per_cell,
            count,
        } = self.steps;
        for column in 0..self.numbers.len() {
            let place = |at: f64| (column as f64 - at - first) * per_cell;
            // Whether the taxel is active after the steps that are done, those below `next`.
            let (mut active, mut next) = (false, 0);
            // From right to left, since the taxel moves that way along the spans.
            for span in spans.iter().rev() {
                let from = (-floor(-place(span.to + NEAR))).max(next);
                let to = floor(place(span.from - NEAR)).min(count - 1);
                let sure = (floor(place(span.to - NEAR)) + 1)..floor(place(span.from + NEAR));
                if from > to {
                    continue;
                }
                if from > next {
                    self.set(column, next, &mut active, false);
                }
                let mut step = from;
                while step <= to && !self.exact.stopped {
                    if span.sharp && sure.contains(&step) {
                        self.set(column, step, &mut active, true);
                        step = sure.end.min(to + 1);
                    } else {
                        let now = self.active(column, step);
                        self.set(column, step, &mut active, now);
                        step += 1;
                    }
                }
                next = to + 1;
            }
            if next < count {
                self.set(column, next, &mut active, false);
            }
        }
    }

    /// Marks whether a taxel is active from a step on, which is not negative.
    fn set(&mut self, column: usize, step: i32, active: &mut bool, now: bool) {
        if now == std::mem::replace(active, now) {
            return;
        }
        if step == 0 {
            self.start(1 << column);
        } else {
            self.flip(column, step.unsigned_abs());
        }
    }

    /// Marks taxels that are active at the first step; a bit for each.
    fn start(&mut self, taxels: u64) {
        self.events.key[wide(self.word)] ^= taxels << self.shift;
        self.events.hash ^= self.events.layout.hash(self.row, taxels);
    }

    /// Marks that a taxel switches at a step, from 1 to the last.
    #[inline]
    fn flip(&mut self, column: usize, step: u32) {
        let events = &mut *self.events;
        let step = wide(step);
        let event = narrow(events.list.len());
        events.marked[step / 64] |= 1 << (step % 64);
        let before = std::mem::replace(&mut events.last[step], event);
        events.list.push(Event {
            mask: 1 << (self.shift + column),
            number: self.numbers[column],
            word: self.word,
            before,
        });
    }
}

// The places `u` along a band of the shape at which a taxel is active, as intervals.
//
// For one angle and one y0 the coverage of a taxel in row `j` depends only on `u = i − x0`, its column relative to the
// shape's anchor: it is the shape's area inside the unit square whose top left corner is (`u`, `j − y0`). So one
// function of `u` per row serves all columns and all x0. [`Spans`] is the set of `u` at which it reaches the threshold.

/// The distance from the threshold below which a coverage is not decided in `f64`, as a share of a cell.
pub(crate) const DOUBT: f64 = DOUBTFUL;

/// The distance within which the ends of a sharp span lie from their true places, in cell sides. Where the coverage
/// passes the threshold with a slope of [`STEEP`] or more, it is out of [`DOUBT`] after this distance.
pub(crate) const NEAR: f64 = 1e-8;

/// The least slope at a sharp end, see [`NEAR`]; the factor of two leaves room for the curvature.
pub(crate) const STEEP: f64 = 2.0 * DOUBT / NEAR;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Level {
    Below,
    Doubtful,
    Above,
}

impl Level {
    pub(crate) fn of(excess: f64) -> Self {
        Self::unless(excess, DOUBT)
    }

    /// The level of a coverage that exceeds the threshold by `excess`, unless that is less than `doubt`.
    pub(crate) fn unless(excess: f64, doubt: f64) -> Self {
        if excess > doubt {
            Self::Above
        } else if excess < -doubt {
            Self::Below
        } else {
            Self::Doubtful
        }
    }
}

/// An interval of places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// If true, the taxel is active inside and inactive outside, except within [`NEAR`] of the ends, where it may be
    /// either. If false, it may be either inside, and within [`NEAR`] of it.
    pub(crate) sharp: bool,
}

/// The spans of one band, ascending and apart from each other by more than four times [`NEAR`] if all are sharp.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spans {
    list: Vec<Span>,
    pub(crate) sharp: bool,
    level: Option<(f64, Level)>,
}

impl Spans {
    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.sharp = true;
        self.level = None;
    }

    /// Sets the level from `at` on. Places come in ascending order.
    #[inline]
    pub(crate) fn set_level(&mut self, at: f64, level: Level) {
        if level != self.level.map_or(Level::Below, |(_, level)| level) {
            self.change(at, level);
        }
    }

    /// Notes a level that differs from the one before, from `at` on.
    fn change(&mut self, at: f64, level: Level) {
        if let Some((from, old)) = self.level {
            let doubtful = old == Level::Doubtful;
            // A doubtful interval narrower than `NEAR` between Below and Above, or the reverse, is one crossing.
            let passing = doubtful
                && at - from <= NEAR
                && level != Level::Doubtful
                && self.side_before(from) != level;
            if passing {
                let middle = f64::midpoint(from, at);
                if level == Level::Above {
                    self.level = Some((middle, level));
                } else {
                    if let Some(last) = self.list.last_mut() {
                        last.to = middle;
                    }
                    self.level = None;
                }
                return;
            }
            self.push(Span {
                from,
                to: at,
                sharp: !doubtful,
            });
        }
        self.level = (level != Level::Below).then_some((at, level));
    }

    /// Writes the mirror image of the spans, with right and left exchanged: a place and its image sum up to `sum`.
    pub(crate) fn mirror(&self, sum: f64, image: &mut Self) {
        let mirrored = |span: &Span| Span {
            from: sum - span.to,
            to: sum - span.from,
            ..*span
        };
        image.list.clear();
        image.list.extend(self.list.iter().rev().map(mirrored));
        (image.sharp, image.level) = (self.sharp, None);
    }

    /// Returns the level before the span that begins at `from`.
    fn side_before(&self, from: f64) -> Level {
        match self.list.last() {
            Some(last) if last.to == from => {
                if last.sharp {
                    Level::Above
                } else {
                    Level::Doubtful
                }
            }
            _ => Level::Below,
        }
    }

    fn push(&mut self, mut span: Span) {
        if span.to - span.from <= 4.0 * NEAR {
            span.sharp = false;
        }
        if let Some(last) = self.list.last() {
            // A gap that is too narrow to be certain.
            if span.from > last.to && span.from - last.to <= 4.0 * NEAR {
                let gap = Span {
                    from: last.to,
                    to: span.from,
                    sharp: false,
                };
                self.list.push(gap);
                self.sharp = false;
            }
        }
        self.sharp &= span.sharp;
        self.list.push(span);
    }

    pub(crate) fn all(&self) -> &[Span] {
        &self.list
    }
}

// The events along one row of the grid: which taxels are active at its first x0, and which switch at which step.
//
// Events are stored in an unordered list for each step, and a bit per step says whether there are any. Playing them
// back gives one imprint per run of steps without events.

#[derive(Clone, Debug)]
pub(crate) struct Events<'a> {
    layout: &'a Layout,
    count: u64,
    key: Vec<u64>,
    /// The hash of that imprint.
    hash: u64,
    /// A bit for each step: whether it has events. `last` is the last event of each step, or `NONE`.
    marked: Vec<u64>,
    last: Vec<u32>,
    /// All events; the events of a step are chained.
    list: Vec<Event>,
}

#[derive(Clone, Copy, Debug)]
struct Event {
    mask: u64,
    /// The hash of this taxel alone. The hash of an imprint joins the hashes of its taxels by exclusive or.
    number: u64,
    word: u32,
    /// The event before it at the same step, or `NONE`.
    before: u32,
}

const NONE: u32 = u32::MAX;

impl<'a> Events<'a> {
    /// Creates a row without events.
    pub(crate) fn new(layout: &'a Layout, count: u64) -> Self {
        let steps = index(count);
        Self {
            layout,
            count,
            key: vec![0; layout.words()],
            hash: 0,
            marked: vec![0; steps.div_ceil(64)],
            last: vec![NONE; steps],
            list: Vec::new(),
        }
    }

    /// Begins another row. Playing back the previous one has cleared the marks.
    pub(crate) fn clear(&mut self) {
        self.key.fill(0);
        self.hash = 0;
        self.list.clear();
    }

    /// Calls `run` with the key, the hash, the first step and the step after the last of each run in turn, and clears
    /// the marks.
    pub(crate) fn play(&mut self, mut run: impl FnMut(&[u64], u64, u64, u64)) {
        let mut from = 0;
        for (place, marked) in self.marked.iter_mut().enumerate() {
            while *marked != 0 {
                let bit = marked.trailing_zeros();
                *marked &= *marked - 1;
                let step = place * 64 + wide(bit);
                run(&self.key, self.hash, from, step as u64);
                from = step as u64;
                let mut event = std::mem::replace(&mut self.last[step], NONE);
                while let Some(turned) = self.list.get(wide(event)) {
                    self.key[wide(turned.word)] ^= turned.mask;
                    self.hash ^= turned.number;
                    event = turned.before;
                }
            }
        }
        run(&self.key, self.hash, from, self.count);
    }
}

// Decides what `f64` cannot, with 32 digits: whether the shape covers exactly the threshold of a cell.
//
// The rule is that of a touch ([`crate::touch`]): a coverage that falls short by less than 1e-20 does not count as
// short. The boundary is drawn in [`Double`] once per orientation, at the origin, and shifted by the decimals of the
// ranges; in real arithmetic, this is exactly the shape in that pose.

/// The number of values of x0 and of y0 whose positions are kept.
const REMEMBERED: usize = 128;

/// The effort of decisions after which to ask whether to go on: about a millisecond.
const ASK_EVERY: u64 = 256;

/// The number of edges that doubles the effort. A picture may have thousands of edges.
const EDGES: usize = 64;

/// Returns the effort of a pose or a decision; 1 for a shape with few edges.
pub(crate) fn effort(edges: usize) -> u64 {
    (1 + edges / EDGES) as u64
}

/// The shape of one orientation, ready for exact decisions.
pub(crate) struct Exact<'a> {
    grid: &'a PoseGrid,
    orientation: u64,
    /// Drawn when first needed: in most orientations nothing is in doubt.
    boundary: Option<Boundary<Double>>,
    /// The same in `f64`, which decides first if chords replace curves: then much is in doubt, but little of it by
    /// rounding.
    rough: Option<(Boundary<f64>, Overlap<f64>)>,
    /// The positions of the anchor for the last values of x0 and y0.
    positions: Box<[(Option<u64>, Double)]>,
    /// The area in one cell, added up piece by piece.
    cell: Overlap<Double>,
    /// The least coverage that reaches the threshold.
    least: Double,
    /// Returns whether to go on: a single row may need millions of decisions.
    go_on: &'a dyn Fn() -> bool,
    /// The effort since the last call of `go_on`.
    unasked: u64,
    /// Whether `go_on` has returned `false`.
    pub(crate) stopped: bool,
}

impl<'a> Exact<'a> {
    pub(crate) fn new(grid: &'a PoseGrid, orientation: u64, go_on: &'a dyn Fn() -> bool) -> Self {
        Self {
            grid,
            orientation,
            boundary: None,
            rough: None,
            positions: vec![(None, Double::ZERO); 2 * REMEMBERED].into(),
            cell: Overlap::new(1, 1),
            least: least(grid.sensor().threshold()),
            go_on,
            unasked: 0,
            stopped: false,
        }
    }

    /// Returns the same for a shape whose curves are replaced by chords.
    pub(crate) fn of_chords(self) -> Self {
        let boundary = Boundary::of(&self.grid.at_origin(self.orientation));
        Self {
            rough: Some((boundary, Overlap::new(1, 1))),
            ..self
        }
    }

    /// Returns true if the taxel is active when the shape lies at value `x` of x0 and value `y` of y0.
    #[cold]
    #[expect(clippy::cast_precision_loss, reason = "a column or a row")]
    pub(crate) fn active(&mut self, column: usize, row: usize, x: u64, y: u64) -> bool {
        let whole = |index: usize| Double::from(index as f64);
        let by = Point::new(
            self.position(x, false) - whole(column),
            self.position(y, true) - whole(row),
        );
        if let Some((boundary, cell)) = &mut self.rough {
            cell.grid.clear();
            boundary.draw(Point::new(by.x.to_f64(), by.y.to_f64()), cell);
            let excess = cell.grid.first() - self.grid.sensor().threshold();
            if excess.abs() > DOUBTFUL {
                return excess > 0.0;
            }
        }
        let boundary = self
            .boundary
            .get_or_insert_with(|| Boundary::of(&self.grid.at_origin(self.orientation)));
        self.unasked += effort(boundary.edges.len());
        if self.unasked >= ASK_EVERY {
            self.unasked = 0;
            self.stopped |= !(self.go_on)();
        }
        self.cell.grid.clear();
        boundary.draw(by, &mut self.cell);
        self.cell.grid.first() >= self.least
    }

    /// Returns the position of the anchor at a value of x0, or of y0 if `down`. Looking it up is faster than reading
    /// a decimal.
    fn position(&mut self, number: u64, down: bool) -> Double {
        let slot = index(number) % REMEMBERED;
        let (known, position) = &mut self.positions[2 * slot + usize::from(down)];
        if *known != Some(number) {
            let offset = self.grid.offset::<Double>(self.orientation, number, number);
            (*known, *position) = (Some(number), if down { offset.y } else { offset.x });
        }
        *position
    }
}
