//! Turns the spans of a band into the events of a row of the grid.
//!
//! A taxel in column `i` inside of a span from `a` to `b` is active while `i − b ≤ x0 ≤ i − a`. If a value of x0 lies
//! within [`NEAR`] of the end of a span, or in a span that is in doubt, [`Exact`] decides for that taxel and pose.

use crate::geometry::{Real, nearest};
use crate::index::from_first;
use crate::sweep::events::RowEvents;
use crate::sweep::exact::Exact;
use crate::sweep::span::{NEAR, Span, Spans};

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

pub(crate) struct FlipWriter<'s, 'e, 'a> {
    pub(crate) steps: Steps,
    pub(crate) row: usize,
    pub(crate) y: u64,
    /// The events that are written.
    pub(crate) events: RowEvents<'s, 'e>,
    pub(crate) exact: &'s mut Exact<'a>,
}

impl FlipWriter<'_, '_, '_> {
    pub(crate) fn spans(&mut self, spans: &Spans) {
        // The fast path needs span ends that are known more precisely than the grid step.
        if spans.sharp() && NEAR * self.steps.per_cell < 0.25 {
            for span in spans.all() {
                self.span(span);
            }
        } else {
            self.each_taxel(spans.all());
        }
    }

    /// Marks the events that a span with two sharp ends causes in all columns.
    fn span(&mut self, span: &Span) {
        let left = self.end(span.from, SpanEnd::Left);
        let right = self.end(span.to, SpanEnd::Right);
        if left < right {
            let ones = u64::MAX >> (64 - (right - left));
            self.events.start(ones << left);
        }
    }

    /// Marks where the taxels of the row pass an end of a span. Returns the first taxel that does so after the first x0, or the number of columns.
    fn end(&mut self, at: f64, end: SpanEnd) -> usize {
        let columns = self.events.columns();
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
            let step = self.passing(column, place, end);
            if step > 0 {
                first = first.or(Some(column));
                if step < self.steps.count {
                    self.events.flip(column, step.unsigned_abs());
                }
            }
            column += 1;
        }
        first.unwrap_or(columns)
    }

    /// Returns the first step at which a taxel is past an end. `place` is where it passes the end, counted in steps;
    /// it is at most [`NEAR`] before the first step or after the last.
    fn passing(&mut self, column: usize, place: f64, end: SpanEnd) -> i32 {
        let nearest = nearest(place);
        let after = place - f64::from(nearest);
        if after.abs() > NEAR * self.steps.per_cell {
            return nearest + i32::from(after > 0.0);
        }
        if nearest < 0 || nearest >= self.steps.count {
            return nearest;
        }
        // At exactly this step: past a right end the taxel is active, past a left end it is not.
        let active = self.active(column, nearest);
        nearest + i32::from(active != (end == SpanEnd::Right))
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
        for column in 0..self.events.columns() {
            let place = |at: f64| (column as f64 - at - first) * per_cell;
            let mut taxel = Taxel {
                column,
                active: false,
                next: 0,
            };
            // From right to left, since the taxel moves that way along the spans.
            for span in spans.iter().rev() {
                let from = (-floor(-place(span.to + NEAR))).max(taxel.next);
                let to = floor(place(span.from - NEAR)).min(count - 1);
                let sure = (floor(place(span.to - NEAR)) + 1)..floor(place(span.from + NEAR));
                if from > to {
                    continue;
                }
                if from > taxel.next {
                    taxel.set(taxel.next, false, &mut self.events);
                }
                let mut step = from;
                while step <= to && !self.exact.stopped() {
                    if span.sharp && sure.contains(&step) {
                        taxel.set(step, true, &mut self.events);
                        step = sure.end.min(to + 1);
                    } else {
                        let active = self.active(column, step);
                        taxel.set(step, active, &mut self.events);
                        step += 1;
                    }
                }
                taxel.next = to + 1;
            }
            if taxel.next < count {
                taxel.set(taxel.next, false, &mut self.events);
            }
        }
    }
}

/// An end of a span. The taxels of a row pass it from right to left.
#[derive(Clone, Copy, PartialEq, Eq)]
enum SpanEnd {
    Left,
    Right,
}

/// A taxel that moves along the range of x0.
struct Taxel {
    column: usize,
    /// Whether it is active after the steps that are done.
    active: bool,
    /// Steps below this one are done.
    next: i32,
}

impl Taxel {
    /// Sets whether the taxel is active from a step on, which is not negative.
    fn set(&mut self, step: i32, active: bool, events: &mut RowEvents<'_, '_>) {
        if active == self.active {
            return;
        }
        self.active = active;
        if step == 0 {
            events.start(1 << self.column);
        } else {
            events.flip(self.column, step.unsigned_abs());
        }
    }
}
