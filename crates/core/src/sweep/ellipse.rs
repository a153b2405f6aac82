//! Spans of ellipses, solid or with one ellipse as their hole, row by row of the grid.
//!
//! **Method.** Let `O` and `I` be the areas of the outer and the inner ellipse in the cell. A taxel is active where
//! `O − I` reaches the threshold `t`. `O` reaches it between one rising and one falling passage
//! ([`Track`]), and outside of these nothing is active. If the cell lies inside the outer ellipse
//! (`O = 1`), it matters where `I` exceeds `1 − t`: again between one rising and one falling passage. What remains
//! are places where the cell reaches both the hole and the outside. There, `O` rises from its value at the first
//! touch of the hole, `I` rises to its value at the last touch of the outside, and usually the difference of these
//! two values stays above `t`. Whenever one of these conditions does not hold, the band is computed from scratch
//! ([`HollowEllipse::isolate_all`]).

use std::f64::consts::FRAC_PI_4;

use crate::geometry::{Ellipse, Side};
use crate::sensor::MAX_SIDE;
use crate::sweep::flips::{DOUBT, Level, NEAR, STEEP, Spans};

/// Where the coverage by the outer ellipse rises and falls, and where that by the hole does.
type Tracks = [Track; 4];

#[derive(Clone, Debug)]
pub(crate) struct Elliptic {
    ellipse: HollowEllipse,
    /// For each row of the sensor, where the passages were in the previous rows of the grid.
    tracks: Box<[Tracks]>,
}

impl Elliptic {
    pub(crate) fn new(ellipses: &[(Ellipse<f64>, Side)]) -> Option<Self> {
        let (outer, inner) = match ellipses {
            [(outer, Side::Inside)] => (outer, None),
            [(outer, Side::Inside), (inner, Side::Outside)] => {
                (outer, Some(EllipseBand::new(inner)))
            }
            _ => return None,
        };
        Some(Self {
            ellipse: HollowEllipse {
                threshold: 1.0,
                outer: EllipseBand::new(outer),
                inner,
            },
            tracks: vec![Tracks::default(); usize::from(MAX_SIDE)].into(),
        })
    }

    /// Finds the spans at which the coverage of the cells from `top` to `top + 1` reaches the threshold. `row` is the
    /// row of the sensor: the previous passages of the same row predict where to look.
    pub(crate) fn band(&mut self, top: f64, row: usize, threshold: f64, spans: &mut Spans) {
        spans.clear();
        self.ellipse.threshold = threshold;
        let outer = &mut self.ellipse.outer;
        // If no section is high enough, no cell is covered enough.
        if !outer.cut(top) || outer.highest < threshold - 2.0 * DOUBT {
            return;
        }
        if let Some(inner) = &mut self.ellipse.inner {
            inner.cut(top);
        }
        let Some(tracks) = self.tracks.get_mut(row) else {
            return self.ellipse.isolate_all(spans);
        };
        let Some(([from, to], hole)) = self.ellipse.follow(tracks) else {
            self.ellipse.isolate_all(spans);
            return learn(spans, tracks);
        };
        spans.set_level(from, Level::Above);
        if let Some([hole, end]) = hole {
            spans.set_level(hole, Level::Below);
            spans.set_level(end, Level::Above);
        }
        spans.set_level(to, Level::Below);
    }
}

fn learn(spans: &Spans, tracks: &mut Tracks) {
    let places = match (spans.sharp, spans.all()) {
        (true, [only]) => [Some(only.from), Some(only.to), None, None],
        (true, [left, right]) => [left.from, right.to, left.to, right.from].map(Some),
        _ => [None; 4],
    };
    for (track, place) in tracks.iter_mut().zip(places) {
        match place {
            Some(place) => track.note(place),
            None => track.known = 0,
        }
    }
}

// One ellipse, cut to bands: the height of its section at a place, and the area to the left of it.
//
// Inside of a band the ellipse is bounded by arcs and by the band's two lines; between the places where an arc
// meets a line the area has a closed form. Frame: the anchor at the origin; cell sides.

/// The amount by which bounds of sections are widened.
const SLACK: f64 = 1e-12;

/// An ellipse prepared for bands; see `geometry::ellipse` for the formulas.
#[derive(Clone, Debug, Default)]
struct EllipseBand {
    x: f64,
    y: f64,
    /// Half of the extent along x.
    reach_x: f64,
    /// Half of the extent along y.
    reach_y: f64,
    /// The slope, y by x, of the line through the middles of the vertical sections.
    middle_y: f64,
    /// The slope, x by y, of the line through the middles of the horizontal sections.
    middle_x: f64,
    /// Half of the vertical section at distance d from the centre is this times the root of `reach_x`² − d².
    scale_y: f64,
    scale_x: f64,
    top: f64,
    stretches: [EllipseStretch; 5],
    /// The number of stretches in use, at most five: the band's lines cross the ellipse at up to four places.
    count: usize,
    /// The places between which the section is highest; `highest` is its height there.
    peak: (f64, f64),
    highest: f64,
    /// The area of the ellipse in the band.
    total: f64,
}

/// A closed form `W = area + linear·d + square·d² + round·Φ(d)` between two places, relative to the centre.
#[derive(Clone, Copy, Debug, Default)]
struct EllipseStretch {
    left: f64,
    right: f64,
    area: f64,
    linear: f64,
    square: f64,
    round: f64,
}

/// The section at a place: its height, the area on the left of it, and half of the ellipse's own section.
#[derive(Clone, Copy, Debug)]
struct Section {
    /// The height of the shape here, inside the band.
    height: f64,
    /// The area on the left of the place.
    area: f64,
    half: f64,
    /// The index of its stretch; None outside the ellipse.
    stretch: Option<usize>,
}

impl EllipseBand {
    fn new(ellipse: &Ellipse<f64>) -> Self {
        let (centre, reach) = (ellipse.centre, ellipse.reach());
        let (x_square, y_square) = (reach.x * reach.x, reach.y * reach.y);
        let (mixed, area) = (ellipse.skew(), ellipse.span());
        Self {
            x: centre.x,
            y: centre.y,
            reach_x: reach.x,
            reach_y: reach.y,
            middle_y: mixed / x_square,
            middle_x: mixed / y_square,
            scale_y: area / x_square,
            scale_x: area / y_square,
            ..Self::default()
        }
    }

    /// Returns half of the height at a distance from the centre, divided by `scale_y`.
    fn half(&self, d: f64) -> f64 {
        ((self.reach_x - d) * (self.reach_x + d)).max(0.0).sqrt()
    }

    /// Returns the integral of [`Self::half`] from the centre on; `half` is its value at `d`.
    fn round(&self, d: f64, half: f64) -> f64 {
        let reach = self.reach_x;
        0.5 * (d * half + reach * reach * libm::atan2(d, half))
    }

    /// Prepares the band from `top` to `top + 1`. Returns false if the ellipse does not reach it.
    fn cut(&mut self, top: f64) -> bool {
        let (top, bottom) = (top - self.y, top - self.y + 1.0);
        (self.top, self.count, self.total, self.highest) = (top, 0, 0.0, -1.0);
        if top >= self.reach_y || bottom <= -self.reach_y {
            return false;
        }
        // The ends and the crossings with the lines, in order.
        let mut places = [-self.reach_x; 6];
        let mut last = 0;
        for line in [top, bottom] {
            if line.abs() < self.reach_y {
                let root = self.scale_x * ((self.reach_y - line) * (self.reach_y + line)).sqrt();
                let middle = self.middle_x * line;
                for place in [middle - root, middle + root] {
                    let mut at = last + 1;
                    while at > 1 && places[at - 1] > place {
                        places[at] = places[at - 1];
                        at -= 1;
                    }
                    places[at] = place;
                    last += 1;
                }
            }
        }
        last += 1;
        places[last] = self.reach_x;
        let end = FRAC_PI_4 * self.reach_x * self.reach_x;
        let (mut left, mut round) = (-self.reach_x, -end);
        for &right in &places[1..=last] {
            let right = right.min(self.reach_x);
            if right > left {
                let next = if right < self.reach_x {
                    self.round(right, self.half(right))
                } else {
                    end
                };
                self.stretch((left, right), (round, next));
                (left, round) = (right, next);
            }
        }
        self.count > 0
    }

    fn stretch(&mut self, (left, right): (f64, f64), (round, next): (f64, f64)) {
        let (top, bottom) = (self.top, self.top + 1.0);
        let middle = f64::midpoint(left, right);
        let half = self.scale_y * self.half(middle);
        let (upper, lower) = (self.middle_y * middle - half, self.middle_y * middle + half);
        if upper >= bottom || lower <= top {
            return;
        }
        // A line that does not cross the ellipse may touch it right here; then the middle does not show on which side
        // it lies.
        let (upper, lower) = (
            top <= -self.reach_y || upper > top,
            bottom >= self.reach_y || lower < bottom,
        );
        let (linear, square, arcs) = match (upper, lower) {
            (true, true) => (0.0, 0.0, 2.0),
            (true, false) => (bottom, -0.5 * self.middle_y, 1.0),
            (false, true) => (-top, 0.5 * self.middle_y, 1.0),
            (false, false) => (1.0, 0.0, 0.0),
        };
        let mut stretch = EllipseStretch {
            left,
            right,
            area: 0.0,
            linear,
            square,
            round: arcs * self.scale_y,
        };
        stretch.area = self.total - stretch.grown(left, round);
        self.total = stretch.area + stretch.grown(right, next);
        // Between two lines the section has its full height all along; otherwise it is highest above or below an
        // extreme point of the ellipse, or at an end. `skew` is the place of the lowest point.
        let skew = self.middle_x * self.reach_y;
        let (from, to) = match (upper, lower) {
            (true, true) => (0.0, 0.0),
            (true, false) => (-skew, -skew),
            (false, true) => (skew, skew),
            (false, false) => (left, right),
        };
        let (from, to) = (from.max(left).min(right), to.max(left).min(right));
        let height = if arcs > 0.0 {
            self.height(self.x + from)
        } else {
            1.0
        };
        if height > self.highest {
            (self.highest, self.peak) = (height, (self.x + from, self.x + to));
        }
        // An ellipse and two lines: at most four places strictly inside, so at most five stretches.
        if let Some(slot) = self.stretches.get_mut(self.count) {
            *slot = stretch;
            self.count += 1;
        }
    }

    /// Returns the height of the section inside the band, given half of the ellipse's own section.
    fn clipped(&self, d: f64, half: f64) -> f64 {
        let (middle, half) = (self.middle_y * d, self.scale_y * half);
        ((middle + half).min(self.top + 1.0) - (middle - half).max(self.top)).max(0.0)
    }

    fn height(&self, x: f64) -> f64 {
        let d = x - self.x;
        if d.abs() >= self.reach_x {
            return 0.0;
        }
        self.clipped(d, self.half(d))
    }

    fn at(&self, x: f64) -> Section {
        let d = x - self.x;
        let stretches = &self.stretches[..self.count];
        let outside = |area: f64| Section {
            height: 0.0,
            area,
            half: 0.0,
            stretch: None,
        };
        // The stretches of a convex set follow on each other without a gap.
        let Some(index) = stretches.iter().position(|stretch| d <= stretch.right) else {
            return outside(self.total);
        };
        if d <= stretches[0].left {
            return outside(0.0);
        }
        let stretch = &stretches[index];
        let half = self.half(d);
        let round = if stretch.round > 0.0 {
            self.round(d, half)
        } else {
            0.0
        };
        Section {
            height: self.clipped(d, half),
            area: stretch.area + stretch.grown(d, round),
            half,
            stretch: Some(index),
        }
    }

    fn coverage(&self, left: &Section, right: &Section) -> f64 {
        match (left.stretch, right.stretch) {
            // Between the lines all along: full, without any rounding.
            (Some(first), Some(last)) if first == last && self.stretches[first].round == 0.0 => 1.0,
            _ => right.area - left.area,
        }
    }

    fn covered(&self, u: f64) -> f64 {
        self.coverage(&self.at(u), &self.at(u + 1.0))
    }

    /// Returns how much `w` may change within `way` of a place.
    ///
    /// Half of the ellipse's own section is `√((R − d)(R + d))`, with slope `d / half`; within `way` of `d` it stays
    /// above 0.7 of itself where `half² ≥ 4·R·way`. Near an end of the ellipse it changes by the root of `2·R·way` at
    /// most. Clipping by the band's lines only makes a change smaller.
    fn change(&self, place: &Section, way: f64) -> f64 {
        let reach = self.reach_x;
        let half = if place.half * place.half >= 4.0 * reach * way {
            1.5 * reach / place.half * way
        } else {
            (2.0 * reach * way).sqrt()
        };
        2.0 * self.scale_y * half + self.middle_y.abs() * way
    }

    /// Returns bounds of `w` from `x` to `end`: it is concave where it is not 0, so it is least at an end.
    fn bounds(&self, x: f64, end: f64) -> (f64, f64) {
        if self.count == 0 {
            return (0.0, 0.0);
        }
        let (one, other) = (self.height(x), self.height(end));
        let most = if x <= self.peak.1 && end >= self.peak.0 {
            self.highest
        } else {
            one.max(other)
        };
        // 0 and 1 are exact; elsewhere rounding errors count.
        let least = one.min(other);
        let least = if least < 1.0 { least - SLACK } else { least };
        let most = if most > 0.0 { most + SLACK } else { most };
        (least.max(0.0), most.min(1.0))
    }

    fn reach(&self) -> (f64, f64) {
        let stretches = &self.stretches[..self.count];
        match (stretches.first(), stretches.last()) {
            (Some(first), Some(last)) => (self.x + first.left, self.x + last.right),
            _ => (self.x, self.x),
        }
    }

    /// Returns the places between which a cell is full; None if no cell is.
    fn full(&self) -> Option<(f64, f64)> {
        let full =
            |stretch: &&EllipseStretch| stretch.round == 0.0 && stretch.right - stretch.left > 1.0;
        let stretch = self.stretches[..self.count].iter().find(full)?;
        Some((self.x + stretch.left, self.x + stretch.right - 1.0))
    }
}

impl EllipseStretch {
    /// Returns `W` without its constant.
    fn grown(&self, d: f64, round: f64) -> f64 {
        (self.linear + self.square * d) * d + self.round * round
    }
}

// The spans of an ellipse, solid or with an elliptic hole, without an earlier row to start from: slow, but always
// correct.
//
// **Method.** As for polygons the coverage at place `u` is `C(u) = W(u + 1) − W(u)`, with `W` the integral of the
// height `w` of the section inside the band. It is not a polynomial, so its passages through the threshold are
// isolated first: on an interval the section of a convex set is concave in `x`, which bounds `w` there by its ends and
// its greatest value, and so bounds the slope of `C`. An interval on which the slope keeps its sign holds at most one
// passage; one on which `C` cannot reach the threshold holds none; any other is halved. Nothing is missed,
// however thin the wall is.
//
// **Error.** Below 1e-11: closed forms of numbers below 10^4. Frame: the anchor at the origin; cell sides.

/// The width, in cells, below which intervals are not halved. Narrower ones are decided with more digits.
const NARROW: f64 = 1e-6;

/// An ellipse and perhaps a hole, both cut to the band.
#[derive(Clone, Debug)]
struct HollowEllipse {
    threshold: f64,
    outer: EllipseBand,
    inner: Option<EllipseBand>,
}

/// A place, and the coverage there minus the threshold.
type Sample = (f64, f64);

impl HollowEllipse {
    /// Follows the passages from the previous rows: the beginning and the end of the span, as columns of the cell
    /// relative to the shape's anchor, and those of the gap in it. None if they are not certain.
    fn follow(&self, tracks: &mut Tracks) -> Option<([f64; 2], Option<[f64; 2]>)> {
        let [from, to, hole, end] = tracks;
        let (outer, threshold) = (&self.outer, self.threshold);
        let from = from.follow(outer, threshold, true)?;
        let to = to.follow(outer, threshold, false)?;
        let Some(inner) = self.inner.as_ref().filter(|inner| inner.count > 0) else {
            return Some(([from, to], None));
        };
        // Between these places the cell reaches the hole.
        let (first, last) = (inner.reach().0 - 1.0, inner.reach().1);
        if first <= from + 2.0 * NEAR || last >= to - 2.0 * NEAR {
            return None;
        }
        let least = outer.covered(first).min(outer.covered(last));
        // The hole is nowhere high enough to matter.
        if least - inner.highest > threshold + DOUBT {
            return Some(([from, to], None));
        }
        let hole = hole.follow(inner, 1.0 - threshold, true)?;
        let end = end.follow(inner, 1.0 - threshold, false)?;
        let (full, full_end) = outer.full()?;
        let apart = full < hole - NEAR && full_end > end + NEAR;
        // Up to `full` both areas rise, from `full_end` on both fall.
        let enough = |place, full| outer.covered(place) - inner.covered(full) > threshold + DOUBT;
        let left = first >= full || enough(first, full);
        let right = last <= full_end || enough(last, full_end);
        (apart && left && right).then_some(([from, to], Some([hole, end])))
    }

    fn isolate_all(&self, spans: &mut Spans) {
        let (left, right) = self.outer.reach();
        let ends = ((left - 1.0, -self.threshold), (right, -self.threshold));
        self.isolate(ends.0, ends.1, spans);
        spans.set_level(right, Level::Below);
    }

    fn excess(&self, u: f64) -> f64 {
        let outer = self.outer.covered(u);
        let inner = self.inner.as_ref().map_or(0.0, |inner| inner.covered(u));
        if outer == 1.0 && inner == 0.0 {
            // Full without any doubt, even where the threshold is 1.
            return (1.0 - self.threshold).max(2.0 * DOUBT);
        }
        outer - inner - self.threshold
    }

    fn slopes(&self, from: f64, to: f64) -> (f64, f64) {
        let (low, high) = self.outer.bounds(from, to);
        let (low_ahead, high_ahead) = self.outer.bounds(from + 1.0, to + 1.0);
        let (least, most) = (low_ahead - high, high_ahead - low);
        let Some(inner) = &self.inner else {
            return (least, most);
        };
        let (low, high) = inner.bounds(from, to);
        let (low_ahead, high_ahead) = inner.bounds(from + 1.0, to + 1.0);
        (least - high_ahead + low, most - low_ahead + high)
    }

    fn isolate(&self, from: Sample, to: Sample, spans: &mut Spans) {
        let (before, after) = (Level::of(from.1), Level::of(to.1));
        let (least, most) = self.slopes(from.0, to.0);
        let width = to.0 - from.0;
        if least >= 0.0 || most <= 0.0 {
            return self.passage(from, to, spans);
        }
        if before == after && before != Level::Doubtful {
            // Two lines, as steep as the slope can be, from the ends towards the threshold.
            let (near, far) = if before == Level::Above {
                (least, most)
            } else {
                (most, least)
            };
            let meeting = (from.1 - to.1 + far * width) / (far - near);
            let extreme = from.1 + near * meeting;
            if Level::of(extreme) == before {
                return spans.set_level(from.0, before);
            }
        }
        if width < NARROW {
            spans.set_level(from.0, Level::Doubtful);
            return spans.set_level(to.0, after);
        }
        let middle = from.0 + width / 2.0;
        let middle = (middle, self.excess(middle));
        self.isolate(from, middle, spans);
        self.isolate(middle, to, spans);
    }

    fn passage(&self, from: Sample, to: Sample, spans: &mut Spans) {
        let (before, after) = (Level::of(from.1), Level::of(to.1));
        spans.set_level(from.0, before);
        if before == after {
            return;
        }
        let sense = if to.1 > from.1 { 1.0 } else { -1.0 };
        if before != Level::Doubtful && after != Level::Doubtful {
            let at = self.solve(from, to, 0.0, 1e-5);
            let certain = |u: f64, level: Level| Level::of(self.excess(u)) == level;
            let (left, right) = (at - 0.5 * NEAR, at + 0.5 * NEAR);
            if left > from.0 && right < to.0 && certain(left, before) && certain(right, after) {
                return spans.set_level(at, after);
            }
        }
        if before != Level::Doubtful {
            let at = self.solve(from, to, -sense * DOUBT, 1e-13);
            spans.set_level(at, Level::Doubtful);
        }
        if after != Level::Doubtful {
            let at = self.solve(from, to, sense * DOUBT, 1e-13);
            spans.set_level(at, after);
        }
    }

    /// Returns where the excess reaches a height, by Newton's method kept inside a bracket.
    fn solve(&self, from: Sample, to: Sample, height: f64, precision: f64) -> f64 {
        let rising = to.1 > from.1;
        let (mut low, mut high) = (from.0, to.0);
        let share = (height - from.1) / (to.1 - from.1);
        let mut at = low + (high - low) * share.clamp(0.0, 1.0);
        for _ in 0..60 {
            let gap = self.excess(at) - height;
            if (gap > 0.0) == rising {
                high = at;
            } else {
                low = at;
            }
            let next = at - gap / self.slope(at);
            if (next - at).abs() < precision {
                return next.clamp(from.0, to.0);
            }
            let next = if next > low && next < high {
                next
            } else {
                low + (high - low) / 2.0
            };
            at = next;
        }
        at
    }

    fn slope(&self, u: f64) -> f64 {
        let slope = |band: &EllipseBand| band.height(u + 1.0) - band.height(u);
        let inner = self.inner.as_ref().filter(|inner| inner.count > 0);
        slope(&self.outer) - inner.map_or(0.0, slope)
    }
}

// Follows where the coverage of an ellipse passes through a level, from one row of the grid to the next.
//
// The area of a convex set in a moving cell rises to a plateau and falls again: its root is concave where it is not 0
// (Brunn and Minkowski). So the coverage passes a level at most twice: there is at most one rising and one falling
// passage. From one row to the next a passage moves smoothly, so the last three predict the next, and one step of
// Newton's method usually suffices.
//
// **Certainty.** At a position the excess over the level is `e` and the slope `m`; within `e/m` and a little the slope
// cannot change by more than `c` ([`EllipseBand::change`]). Then the distance to the passage is between `e/(m + c)`
// and `e/(m − c)`. The passage counts as known once this interval is narrower than [`NEAR`] requires.

/// The positions of a passage in the last rows.
#[derive(Clone, Copy, Debug, Default)]
struct Track {
    positions: [f64; 3],
    known: usize,
}

impl Track {
    /// Extrapolates the next position; None for a new track.
    fn expected(&self) -> Option<f64> {
        let [last, before, first] = self.positions;
        match self.known {
            0 => None,
            1 => Some(last),
            2 => Some(2.0 * last - before),
            _ => Some(3.0 * (last - before) + first),
        }
    }

    fn note(&mut self, position: f64) {
        self.positions = [position, self.positions[0], self.positions[1]];
        self.known = (self.known + 1).min(3);
    }

    /// Finds the rising or the falling passage through a level in the present band; None if it is not certain.
    fn follow(&mut self, band: &EllipseBand, level: f64, is_rising: bool) -> Option<f64> {
        let mut u = self.expected()?;
        for _ in 0..4 {
            let (left, right) = (band.at(u), band.at(u + 1.0));
            let excess = band.coverage(&left, &right) - level;
            let slope = right.height - left.height;
            if (slope > 0.0) != is_rising {
                return None;
            }
            let way = excess / slope;
            let around = way.abs() * 1.5 + NEAR;
            let change = band.change(&left, around) + band.change(&right, around);
            let steep = slope.abs() - change;
            u -= way;
            let enough = slope.abs() <= 1.5 * steep && way.abs() * change <= 0.5 * NEAR * steep;
            if steep > STEEP && enough {
                self.note(u);
                return Some(u);
            }
        }
        None
    }
}
