//! Counts the distinct imprints of a grid without describing them, and finds the poses that leave an imprint. Models
//! are made from these counts.

use std::ops::ControlFlow;

use crate::atlas::{ImprintCounter, Layout};
use crate::imprint::Imprint;
use crate::index::wide;
use crate::sweep::run::Sweep;

/// The distinct imprints of a grid, counted.
#[derive(Clone, Debug)]
pub struct CountedImprints {
    layout: Layout,
    counter: ImprintCounter,
    /// The number of poses.
    pub poses: u64,
    /// The number of poses that reach beyond the sensor.
    pub partly_off: u64,
}

impl CountedImprints {
    /// Returns the number of distinct imprints.
    pub fn len(&self) -> usize {
        self.counter.len()
    }

    /// Returns true if there is no imprint.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// An imprint, counted from 0, and the number of poses in which it occurs.
    ///
    /// # Panics
    /// Panics if there are not that many imprints.
    pub fn get(&self, index: usize) -> (Imprint, u64) {
        let imprint = self.layout.imprint(self.counter.key(index));
        (imprint, self.counter.tallies()[index].count)
    }
}

/// A run of neighbouring poses of one row that leave the same imprint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PoseRun {
    /// The number of the first pose in the grid.
    pub first: u64,
    /// The number of poses.
    pub poses: u64,
    /// The number of orientations that show the same because of symmetry, including this one; the numbers of the
    /// others are not given.
    pub orientations: u64,
}

impl Sweep<'_> {
    /// Counts the imprints without describing them. Returns None if the sweep was stopped.
    pub fn count(self) -> Option<CountedImprints> {
        let layout = Layout::new(self.grid.sensor().size());
        let mut counted = CountedImprints {
            counter: ImprintCounter::new(layout.words()),
            layout,
            poses: 0,
            partly_off: 0,
        };
        let grid = self.grid;
        let complete = self.each_portion(&counted.layout, false, |portion| {
            for found in portion {
                let own = &found.counter;
                for (index, tally) in own.tallies().iter().enumerate() {
                    let count = tally.count * found.multiplicity();
                    let (key, hash) = (own.key(index), own.hash(index));
                    counted.counter.add(key, hash, count, tally.first);
                }
                counted.poses += found.poses(grid);
                counted.partly_off += found.partly_off * found.multiplicity();
            }
            ControlFlow::Continue(())
        });
        counted.counter.sort_by_first_pose();
        complete.then_some(counted)
    }

    /// Finds the poses whose imprint satisfies `wanted`. Returns None if the sweep was stopped.
    ///
    /// The order of the runs does not depend on the number of threads.
    pub fn poses_where(self, wanted: &(dyn Fn(&Imprint) -> bool + Sync)) -> Option<Vec<PoseRun>> {
        let (width, height) = (self.grid.row_length(), self.grid.rows_per_orientation());
        let layout = Layout::new(self.grid.sensor().size());
        let mut runs = Vec::new();
        self.each_portion(&layout, true, |portion| {
            for found in portion {
                let wanted: Vec<bool> = (0..found.counter.len())
                    .map(|index| wanted(&layout.imprint(found.counter.key(index))))
                    .collect();
                for (row, y) in found.rows.clone().enumerate() {
                    let mut first = (found.orientations[0] * height + y) * width;
                    for &(index, length) in found.runs.row(row) {
                        if wanted[wide(index)] {
                            runs.push(PoseRun {
                                first,
                                poses: u64::from(length),
                                orientations: found.multiplicity(),
                            });
                        }
                        first += u64::from(length);
                    }
                }
            }
            ControlFlow::Continue(())
        })
        .then_some(runs)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::{Anchor, Axis, PoseGrid, Ranges};
    use crate::sensor::Sensor;

    #[test]
    fn runs_hold_each_pose_once_and_agree_with_the_counts() {
        for kind in [
            FigureKind::Triangle,
            FigureKind::Rectangle,
            FigureKind::Ellipse,
        ] {
            let sensor = Sensor::default();
            let coarse = |text: &str| text.parse().expect("a range");
            let ranges = Ranges::default()
                .with(Axis::X0, coarse("5:6:0.1"))
                .with(Axis::Y0, coarse("5:6:0.2"))
                .with(Axis::Angle, coarse("0:350:10"));
            let source = Figure::default_of(kind, &sensor).into();
            let grid = PoseGrid::new(source, sensor, Anchor::Corner, ranges).expect("in range");
            let counted = Sweep::new(&grid).count().expect("not stopped");
            let mut poses = 0;
            for (imprint, count) in (0..counted.len()).map(|index| counted.get(index)) {
                let same = |other: &Imprint| *other == imprint;
                let runs = Sweep::new(&grid).poses_where(&same).expect("not stopped");
                let found: u64 = runs.iter().map(|run| run.poses * run.orientations).sum();
                assert_eq!(found, count, "{imprint}");
                for run in runs {
                    let placed = grid.placed(run.first + run.poses - 1);
                    assert_eq!(crate::touch::Plane::new(sensor).touch(&placed), imprint);
                }
                poses += count;
            }
            assert_eq!((poses, counted.poses), (grid.poses(), grid.poses()));
        }
    }

    #[test]
    fn a_sweep_can_be_stopped_within_a_row() {
        let sensor = Sensor::default();
        let source = Figure::default_of(FigureKind::Rectangle, &sensor).into();
        let range = |text: &str| text.parse().expect("a range");
        // Half of a row of cells is covered: each of a million positions is decided exactly.
        let ranges = Ranges::default()
            .with(Axis::X0, range("4:4.999999:0.000001"))
            .with(Axis::Y0, range("4.5"))
            .with(Axis::Angle, range("0"));
        let grid = PoseGrid::new(source, sensor, Anchor::Corner, ranges).expect("in range");
        let done = AtomicU64::new(0);
        let progress = |poses| {
            done.fetch_add(poses, Ordering::Relaxed);
            ControlFlow::Break(())
        };
        assert!(Sweep::new(&grid).with_progress(&progress).count().is_none());
        assert_eq!(done.into_inner(), 0);
    }
}
