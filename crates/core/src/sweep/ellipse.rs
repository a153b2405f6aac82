//! Spans of ellipses, solid or with one ellipse as their hole, row by row of the grid.
//!
//! **Method.** Let `O` and `I` be the areas of the outer and the inner ellipse in the cell. A taxel is active where
//! `O − I` reaches the threshold `t`. `O` reaches it between one rising and one falling passage
//! ([`crate::sweep::track`]), and outside of these nothing is active. If the cell lies inside the outer ellipse
//! (`O = 1`), it matters where `I` exceeds `1 − t`: again between one rising and one falling passage. What remains
//! are places where the cell reaches both the hole and the outside. There, `O` rises from its value at the first
//! touch of the hole, `I` rises to its value at the last touch of the outside, and usually the difference of these
//! two values stays above `t`. Whenever one of these conditions does not hold, the band is computed from scratch
//! ([`crate::sweep::isolate`]).

use crate::geometry::{Ellipse, Side};
use crate::sensor::MAX_SIDE;
use crate::sweep::ellipse_band::EllipseBand;
use crate::sweep::isolate::HollowEllipse;
use crate::sweep::span::{DOUBT, Level, NEAR, Spans};
use crate::sweep::track::{Passage, Track};

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
        if !outer.cut(top) || outer.highest() < threshold - 2.0 * DOUBT {
            return;
        }
        if let Some(inner) = &mut self.ellipse.inner {
            inner.cut(top);
        }
        let Some(tracks) = self.tracks.get_mut(row) else {
            return self.ellipse.isolate_all(spans);
        };
        let Some(found) = follow(&self.ellipse, tracks) else {
            self.ellipse.isolate_all(spans);
            return learn(spans, tracks);
        };
        spans.set_level(found.from, Level::Above);
        if let Some((hole, end)) = found.hole {
            spans.set_level(hole, Level::Below);
            spans.set_level(end, Level::Above);
        }
        spans.set_level(found.to, Level::Below);
    }
}

struct Passages {
    /// The beginning of the span: the column of the cell relative to the shape's anchor, in cell sides.
    from: f64,
    to: f64,
    hole: Option<(f64, f64)>,
}

fn follow(ellipse: &HollowEllipse, tracks: &mut Tracks) -> Option<Passages> {
    let [from, to, hole, end] = tracks;
    let (outer, threshold) = (&ellipse.outer, ellipse.threshold);
    let (from, to) = (
        from.follow(outer, threshold, Passage::Rising)?,
        to.follow(outer, threshold, Passage::Falling)?,
    );
    let solid = Passages {
        from,
        to,
        hole: None,
    };
    let Some(inner) = ellipse.inner.as_ref().filter(|inner| inner.is_here()) else {
        return Some(solid);
    };
    // Between these places the cell reaches the hole.
    let (first, last) = (inner.reach().0 - 1.0, inner.reach().1);
    if first <= from + 2.0 * NEAR || last >= to - 2.0 * NEAR {
        return None;
    }
    let covered = |band: &EllipseBand, u: f64| band.coverage(&band.at(u), &band.at(u + 1.0));
    let least = covered(outer, first).min(covered(outer, last));
    // The hole is nowhere high enough to matter.
    if least - inner.highest() > threshold + DOUBT {
        return Some(solid);
    }
    let (hole, end) = (
        hole.follow(inner, 1.0 - threshold, Passage::Rising)?,
        end.follow(inner, 1.0 - threshold, Passage::Falling)?,
    );
    let (full, full_end) = outer.full()?;
    let apart = full < hole - NEAR && full_end > end + NEAR;
    // Up to `full` both areas rise, from `full_end` on both fall.
    let left = first >= full || covered(outer, first) - covered(inner, full) > threshold + DOUBT;
    let right =
        last <= full_end || covered(outer, last) - covered(inner, full_end) > threshold + DOUBT;
    (apart && left && right).then_some(Passages {
        hole: Some((hole, end)),
        ..solid
    })
}

fn learn(spans: &Spans, tracks: &mut Tracks) {
    let all = spans.all();
    match (spans.sharp(), all) {
        (true, [only]) => {
            tracks[0].note(only.from);
            tracks[1].note(only.to);
            tracks[2].forget();
            tracks[3].forget();
        }
        (true, [left, right]) => {
            for (track, place) in tracks
                .iter_mut()
                .zip([left.from, right.to, left.to, right.from])
            {
                track.note(place);
            }
        }
        _ => tracks.iter_mut().for_each(Track::forget),
    }
}
