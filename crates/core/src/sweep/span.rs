//! The places `u` along a band of the shape at which a taxel is active, as intervals.
//!
//! For one angle and one y0 the coverage of a taxel in row `j` depends only on `u = i − x0`, its column relative to the
//! shape's anchor: it is the shape's area inside the unit square whose top left corner is (`u`, `j − y0`). So one
//! function of `u` per row serves all columns and all x0. This module holds the set of `u` at which it reaches the
//! threshold.

use crate::touch::DOUBTFUL;

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
        if excess > DOUBT {
            Self::Above
        } else if excess < -DOUBT {
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
    sharp: bool,
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

    pub(crate) fn sharp(&self) -> bool {
        self.sharp
    }

    pub(crate) fn all(&self) -> &[Span] {
        &self.list
    }
}
