//! The atlas numbers of some poses, found again when they are looked at: a survey keeps none, so its memory is bounded
//! by the distinct imprints.

use std::ops::Range;
use std::sync::Arc;

use crate::pose::grid::Place;
use crate::sweep::plan::Task;
use crate::sweep::runs;
use crate::sweep::survey::Survey;

impl Survey {
    /// The atlas numbers of the poses that lie at those x0 and y0, row after row, at the angle and the zooms of `turn`
    /// (its own x0 and y0 do not matter). None of a pose whose imprint the atlas does not have, because the sweep was
    /// stopped before. Empty where a range leaves the grid. It takes as long as sweeping these poses does.
    ///
    /// ```
    /// use taxel::figure::{Figure, FigureKind};
    /// use taxel::sensor::Sensor;
    /// use taxel::source::Source;
    /// use taxel::pose::grid::{Anchor, Grid, Ranges};
    /// use taxel::sweep::plan::Shard;
    /// use taxel::sweep::survey::{Survey, Watch};
    /// let square = Source::Figure(Figure::default_of(FigureKind::Rectangle, 16));
    /// let ranges = Ranges { angle: "0".parse()?, ..Ranges::default() };
    /// let grid = Grid::new(square, Sensor::default(), Anchor::Corner, ranges)?;
    /// let survey = Survey::of(&grid, Shard::WHOLE, Watch::nothing());
    /// // At x0 5.5 the columns at both ends are covered by half, and active.
    /// assert_eq!(survey.ids([0; 5], 49..52, 0..1), [Some(0), Some(1), Some(2)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn ids(&self, turn: Place, x0: Range<u64>, y0: Range<u64>) -> Vec<Option<u32>> {
        let [_, _, angle, zoom_x, zoom_y] = turn;
        let from = [x0.start, y0.start, angle, zoom_x, zoom_y];
        let rows = y0.end.saturating_sub(y0.start);
        let counts = [x0.end.saturating_sub(x0.start), rows, 1, 1, 1];
        let Some(part) = self.grid.part(from, counts) else {
            return Vec::new();
        };
        let task = Task {
            turns: Arc::from([0]),
            rows: 0..rows,
        };
        let Some(found) = runs::go(&part, self.atlas.layout(), &task, true, |_| true) else {
            return Vec::new();
        };
        let census = &found.census;
        let ids: Vec<Option<u32>> = (0..census.len())
            .map(|index| self.atlas.number(census.key(index), census.hash(index)))
            .collect();
        let rows = 0..usize::try_from(rows).unwrap_or(0);
        let runs = rows.flat_map(|row| found.runs.row(row));
        let runs = runs.flat_map(|&(index, length)| {
            let index = usize::try_from(index).unwrap_or(usize::MAX);
            let length = usize::try_from(length).unwrap_or(0);
            std::iter::repeat_n(ids.get(index).copied().flatten(), length)
        });
        runs.collect()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::imprint::Imprint;
    use crate::picture::Picture;
    use crate::pose::grid::{Anchor, Grid, Ranges};
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::sweep::plan::Shard;
    use crate::sweep::survey::Watch;
    use crate::touch::Plane;

    #[test]
    fn a_window_shows_what_touching_finds() {
        let range = |text: &str| text.parse().expect("a range");
        let imprint = Imprint::from_rows(["##.", ".##"]).expect("rows");
        let ellipse = Source::Figure(Figure::default_of(FigureKind::Ellipse, 16));
        for (source, zoom) in [
            (ellipse, "1"),
            (Source::Picture(Picture::at_home(imprint)), "1:2:0.5"),
        ] {
            let ranges = Ranges {
                x0: range("3:5:0.1"),
                y0: range("4:6:0.1"),
                angle: range("0:40:20"),
                zoom_x: range(zoom),
                zoom_y: range("1"),
            };
            let grid = Grid::new(source, Sensor::default(), Anchor::Corner, ranges);
            let grid = grid.expect("in range");
            let survey = Survey::of(&grid, Shard::WHOLE, Watch::nothing());
            let mut plane = Plane::new(*grid.sensor());
            for turn in [0, 1, 2] {
                let zoom = turn.min(grid.counts()[3] - 1);
                let ids = survey.ids([9, 9, turn, zoom, 0], 3..17, 2..9);
                assert_eq!(ids.len(), 14 * 7);
                for (index, id) in (0..).zip(ids) {
                    let place = [3 + index % 14, 2 + index / 14, turn, zoom, 0];
                    let pose = grid.pose(grid.number(place));
                    let touched = plane.touch(&grid.placed(pose));
                    assert_eq!(id, survey.atlas.find(&touched), "{pose:?}");
                    assert!(id.is_some());
                }
            }
            assert_eq!(survey.ids([0; 5], 0..22, 0..1), []);
            assert_eq!(survey.ids([0; 5], 4..4, 0..1), []);
            assert_eq!(survey.ids([0, 0, 3, 0, 0], 0..1, 0..1), []);
        }
    }

    #[test]
    fn what_was_not_gone_through_has_no_number() {
        let source = Source::Figure(Figure::default_of(FigureKind::Rectangle, 16));
        let grid = Grid::new(source, Sensor::default(), Anchor::Corner, Ranges::default());
        let grid = grid.expect("in range");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let stopped = pool.expect("threads").install(|| {
            let told = AtomicU64::new(0);
            let watch = Watch {
                // Some turns are complete by then, and far from all.
                progress: &|poses| told.fetch_add(poses, Ordering::Relaxed) < 400_000,
                rows: None,
            };
            Survey::of(&grid, Shard::WHOLE, watch)
        });
        assert!(!stopped.complete() && stopped.poses > 0);
        assert_eq!(stopped.ids([0; 5], 0..1, 0..1), [Some(0)]);
        let ids = stopped.ids([0, 0, 37, 0, 0], 0..100, 0..100);
        assert!(ids.contains(&None));
    }
}
