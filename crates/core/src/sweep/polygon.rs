//! Spans of shapes bounded by straight edges, convex or not: figures with corners, and pictures.
//!
//! **Method.** Cut to a band one cell high, each edge is a piece from `left` to `right` that climbs by `rise` (positive
//! where the material is on its right). The height `w(x)` of the shape's section inside the band is the sum of what the
//! pieces left of `x` have climbed: piecewise linear, with a corner at each piece's ends. Its integral `W` is piecewise
//! quadratic, and the coverage at place `u` is `C(u) = W(u + 1) − W(u)`, with slope `w(u + 1) − w(u)`. Two pointers
//! walk the corners of `w`, one cell apart. Between two stops `C` is one quadratic, which is solved for its crossings
//! of the threshold.
//!
//! **Error.** `w` at a corner is a sum of shares of rises, each in [0, 1], and `W` is a sum of trapezoids. Nothing is
//! extrapolated, so steep pieces do no harm. The error is below 1e-11.

use crate::geometry::{Point, Real};
use crate::sweep::flips::{DOUBT, Level, STEEP, Spans};

/// An edge, from its upper end.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// y of the upper end. All lengths are cell sides, y down, the anchor at the origin.
    top: f64,
    bottom: f64,
    x: f64,
    /// The growth of x per cell downwards.
    slope: f64,
    low: f64,
    high: f64,
    /// +1 for an edge that goes upwards, −1 downwards.
    sign: f64,
}

impl Edge {
    /// Returns x at a height between the ends.
    fn x_at(&self, y: f64) -> f64 {
        // Kept between the ends: the slope of an edge that is horizontal up to a rounding is meaningless.
        within(self.x + (y - self.top) * self.slope, self.low, self.high)
    }
}

#[derive(Clone, Copy, Debug)]
struct Piece {
    left: f64,
    right: f64,
    /// The height that it climbs, −1 to 1; positive where the material is on its right.
    rise: f64,
    /// The slope of `w` that it adds between its ends: the rise over the width.
    steepness: f64,
}

/// The section's height between two corners of `w`, and its integral.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    left: f64,
    right: f64,
    /// `w` at the left end.
    from: f64,
    /// The growth of `w` per cell to the right.
    slope: f64,
    /// `W` at `left`.
    area: f64,
    /// Whether no piece lies here, so that `w` is a whole number.
    flat: bool,
}

impl Stretch {
    /// Creates the stretch left of the shape, where `area` is 0, or right of it, where `area` is the area of the
    /// whole band.
    fn far(left: f64, right: f64, area: f64) -> Self {
        Self {
            left,
            right,
            from: 0.0,
            slope: 0.0,
            area,
            flat: true,
        }
    }

    fn at(&self, x: f64) -> (f64, f64) {
        let way = within(x - self.left, 0.0, self.right - self.left);
        let height = self.from + self.slope * way;
        (height, self.area + (self.from + height) * 0.5 * way)
    }
}

/// A shape of straight edges, with working memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Polygonal {
    /// All edges that are not level, sorted by their upper ends.
    edges: Vec<Edge>,
    /// The heights of the level edges, which have no pieces.
    levels: Vec<f64>,
    /// The distance from the threshold below which a coverage is in doubt: a bound of its error.
    pub(crate) doubt: f64,
    pieces: Vec<Piece>,
    /// Where `w` has a corner, from left to right.
    corners: Vec<f64>,
    stretches: Vec<Stretch>,
}

impl Polygonal {
    /// Prepares the edges of a boundary. A coverage nearer to the threshold than `doubt`, at least [`DOUBT`], is in
    /// doubt: that is more than the edges that replace curves may change it.
    pub(crate) fn new(edges: &[(Point<f64>, Point<f64>)], doubt: f64) -> Self {
        let edge = |&(from, to): &(Point<f64>, Point<f64>)| {
            let (upper, lower, sign) = if to.y < from.y {
                (to, from, 1.0)
            } else {
                (from, to, -1.0)
            };
            Edge {
                top: upper.y,
                bottom: lower.y,
                x: upper.x,
                slope: (lower.x - upper.x) / (lower.y - upper.y),
                low: upper.x.min(lower.x),
                high: upper.x.max(lower.x),
                sign,
            }
        };
        let (mut edges, level): (Vec<Edge>, Vec<Edge>) = edges
            .iter()
            .map(edge)
            .partition(|edge| edge.top < edge.bottom);
        let levels = level.iter().map(|edge| edge.top).collect();
        edges.sort_by(|one, other| one.top.total_cmp(&other.top));
        Self {
            edges,
            levels,
            doubt,
            ..Self::default()
        }
    }

    /// Finds the spans at which the coverage of the cells from `top` to `top + 1` reaches the threshold.
    pub(crate) fn band(&mut self, top: f64, threshold: f64, spans: &mut Spans) {
        spans.clear();
        self.cut(top);
        self.stretch();
        // A full cell just reaches a threshold of 1. Where no level edge comes near, it is full without any doubt.
        let inside = |level: &f64| *level > top - DOUBT && *level < top + 1.0 + DOUBT;
        let certain =
            threshold > 1.0 - 2.0 * DOUBT && self.doubt <= DOUBT && !self.levels.iter().any(inside);
        self.walk(threshold, certain, spans);
    }

    fn cut(&mut self, top: f64) {
        self.pieces.clear();
        self.corners.clear();
        for edge in &self.edges {
            if edge.top >= top + 1.0 {
                break;
            }
            let (from, to) = (Real::max(edge.top, top), Real::min(edge.bottom, top + 1.0));
            if from >= to {
                continue;
            }
            let (upper, lower) = (edge.x_at(from), edge.x_at(to));
            let (left, right) = if upper < lower {
                (upper, lower)
            } else {
                (lower, upper)
            };
            self.pieces.push(Piece {
                left,
                right,
                rise: edge.sign * (to - from),
                steepness: edge.sign * (to - from) / (right - left),
            });
        }
        sort(&mut self.pieces, |piece| piece.left);
        let ends = self.pieces.iter().map(|piece| [piece.left, piece.right]);
        self.corners.extend(ends.flatten());
        sort(&mut self.corners, |&corner| corner);
    }

    /// Computes the section's height and area from corner to corner, with nothing before and after.
    fn stretch(&mut self) {
        self.stretches.clear();
        let (Some(&first), Some(&last)) = (self.corners.first(), self.corners.last()) else {
            return;
        };
        self.stretches.push(Stretch::far(first - 2.0, first, 0.0));
        // Pieces come from left to right. All pieces before `open` are behind; together they have climbed `climbed`.
        let (mut open, mut climbed) = (0, 0.0);
        let mut area = 0.0;
        for ends in self.corners.windows(2) {
            let (left, right) = (ends[0], ends[1]);
            if left >= right {
                continue;
            }
            while let Some(piece) = self.pieces.get(open)
                && piece.right <= left
            {
                climbed += piece.rise;
                open += 1;
            }
            let (mut from, mut slope, mut flat) = (climbed, 0.0, true);
            for piece in &self.pieces[open..] {
                if piece.left >= right {
                    break;
                }
                if piece.right <= left {
                    from += piece.rise;
                } else {
                    from += piece.steepness * (left - piece.left);
                    slope += piece.steepness;
                    flat = false;
                }
            }
            let stretch = Stretch {
                left,
                right,
                from,
                slope,
                area,
                flat,
            };
            self.stretches.push(stretch);
            area += (from + slope * 0.5 * (right - left)) * (right - left);
        }
        self.stretches.push(Stretch::far(last, f64::INFINITY, area));
    }

    /// Follows the coverage from left to right and notes its levels.
    fn walk(&self, threshold: f64, certain: bool, spans: &mut Spans) {
        let Some(first) = self.stretches.get(1) else {
            return;
        };
        // The pointer at u starts left of everything, the one at u + 1 at the first corner. Each has a height and an
        // area.
        let (mut near, mut far) = (0, 1);
        let (mut behind, mut ahead) = (&self.stretches[near], &self.stretches[far]);
        let (mut low, mut left) = (0.0, 0.0);
        let (mut high, mut right) = (ahead.from, 0.0);
        let mut u = first.left - 1.0;
        let end = self.stretches.len() - 1;
        while near < end {
            let (stop_behind, stop_ahead) = (behind.right, ahead.right - 1.0);
            let next = Real::min(stop_behind, stop_ahead);
            let excess = right - left - threshold;
            if next > u {
                let from = CurvePoint::new(u, excess, high - low);
                (low, left) = behind.at(next);
                (high, right) = ahead.at(next + 1.0);
                if certain && near == far && behind.flat && behind.from > 0.5 {
                    spans.set_level(u, Level::Above);
                } else {
                    let to = CurvePoint::new(next, right - left - threshold, high - low);
                    self.quadratic(from, to, spans);
                }
                u = next;
            }
            if stop_behind <= next {
                near += 1;
                behind = &self.stretches[near];
                (low, left) = (behind.from, behind.area);
            }
            if stop_ahead <= next && far < end {
                far += 1;
                ahead = &self.stretches[far];
                (high, right) = (ahead.from, ahead.area);
            }
        }
        spans.set_level(u, Level::Below);
    }
}

/// Returns the place between `low` and `high` that is nearest to `value`, or `low` for NaN. This takes two
/// instructions, where `f64::max` and `f64::min` take ten, because they never choose a NaN.
fn within(value: f64, low: f64, high: f64) -> f64 {
    let above = if value > low { value } else { low };
    if above < high { above } else { high }
}

/// Sorts by insertion: the lists are short and nearly in order.
fn sort<T: Copy>(list: &mut [T], place: impl Fn(&T) -> f64) {
    for end in 1..list.len() {
        let value = list[end];
        let mut at = end;
        while at > 0 && place(&list[at - 1]) > place(&value) {
            list[at] = list[at - 1];
            at -= 1;
        }
        list[at] = value;
    }
}

#[derive(Clone, Copy)]
struct CurvePoint {
    at: f64,
    value: f64,
    slope: f64,
}

impl CurvePoint {
    fn new(at: f64, value: f64, slope: f64) -> Self {
        Self { at, value, slope }
    }
}

impl Polygonal {
    /// Notes the levels that a quadratic takes between two points.
    fn quadratic(&self, from: CurvePoint, to: CurvePoint, spans: &mut Spans) {
        let turning = (from.slope * to.slope < 0.0).then(|| {
            let way = from.slope / (from.slope - to.slope) * (to.at - from.at);
            CurvePoint::new(from.at + way, from.value + from.slope * way * 0.5, 0.0)
        });
        // The usual case: on one side of the threshold throughout.
        let extreme = turning.map_or(from.value, |turning| turning.value);
        if Real::min(Real::min(from.value, to.value), extreme) > self.doubt {
            return spans.set_level(from.at, Level::Above);
        }
        if Real::max(Real::max(from.value, to.value), extreme) < -self.doubt {
            return spans.set_level(from.at, Level::Below);
        }
        match turning {
            Some(turning) => {
                self.monotone(from, turning, spans);
                self.monotone(turning, to, spans);
            }
            None => self.monotone(from, to, spans),
        }
    }

    /// Notes the levels of a quadratic whose slope does not change sign between two points.
    fn monotone(&self, from: CurvePoint, to: CurvePoint, spans: &mut Spans) {
        let level = |at: CurvePoint| Level::unless(at.value, self.doubt);
        let (before, after) = (level(from), level(to));
        spans.set_level(from.at, before);
        if before == after {
            return;
        }
        // In shares of the way: at share `t`, the quadratic is `from.value + rise * t + bend * t²`.
        let way = to.at - from.at;
        let (rise, bend) = (from.slope * way, (to.slope - from.slope) * 0.5 * way);
        let sense = if to.value > from.value { 1.0 } else { -1.0 };
        // The place where the quadratic reaches a height, and its slope there, times the way.
        let passage = |height: f64| {
            let gap = from.value - height;
            let root = (rise * rise - 4.0 * bend * gap).max(0.0).sqrt();
            let share = -2.0 * gap / (rise + sense * root);
            let share = if share.is_finite() { share } else { 1.0 };
            ((from.at + way * share.max(0.0)).min(to.at), root)
        };
        if self.doubt <= DOUBT && before != Level::Doubtful && after != Level::Doubtful {
            let (at, steepness) = passage(0.0);
            if steepness >= STEEP * way && 8.0 * bend.abs() * DOUBT <= steepness * steepness {
                return spans.set_level(at, after);
            }
        }
        // Through the doubtful levels, which are entered at one height and left at another.
        if before != Level::Doubtful {
            spans.set_level(passage(-sense * self.doubt).0, Level::Doubtful);
        }
        if after != Level::Doubtful {
            spans.set_level(passage(sense * self.doubt).0, after);
        }
    }
}
