//! Merges the shards of a sweep.
//!
//! Shards are merged in the order of the grid, so first poses stay the first, and imprints have the same numbers as in
//! a single sweep. Memory holds only what is already merged and one shard.

use crate::atlas::{Atlas, Table, VarianceParts};
use crate::pose::PoseGrid;
use crate::sweep::plan::{Shard, ShardOrderError};
use crate::sweep::result::SweepResult;

/// The shards of a sweep that were added so far.
#[derive(Debug, Default)]
pub struct SweepMerge(Option<Merged>);

#[derive(Debug)]
struct Merged {
    grid: PoseGrid,
    last: Shard,
    atlas: Atlas,
    variance_parts: VarianceParts,
    poses: u64,
    partly_off: u64,
}

impl Merged {
    fn of(first: &SweepResult) -> Self {
        let (grid, sensor) = (first.grid.clone(), first.grid.sensor());
        Self {
            last: first.shard,
            atlas: Atlas::new(sensor.size()),
            variance_parts: VarianceParts::new(grid.row_length() * grid.rows_per_orientation()),
            grid,
            poses: 0,
            partly_off: 0,
        }
    }
}

impl SweepMerge {
    /// Adds the next shard: the first, then the second, and so on.
    ///
    /// # Errors
    /// Returns an error if it is incomplete, not the next one, or of another grid than the first. The merge then
    /// stays unchanged.
    pub fn add(&mut self, result: SweepResult) -> Result<(), MergeError> {
        let shard = result.shard;
        // Everything is checked before anything changes: after a refusal, the right shard can still be added.
        if let Some(merged) = &self.0 {
            let difference = if shard.of() == merged.last.of() {
                difference(&result.grid, &merged.grid)
            } else {
                Some("the number of shards")
            };
            if let Some(difference) = difference {
                return Err(MergeError::Foreign { shard, difference });
            }
        }
        shard.check_after(self.0.as_ref().map(|merged| merged.last))?;
        if !result.complete() {
            return Err(MergeError::Incomplete { shard });
        }
        let merged = self.0.get_or_insert_with(|| Merged::of(&result));
        merged.last = shard;
        merged.atlas.add_all(&result.atlas);
        merged.variance_parts.merge(result.variance_parts);
        merged.poses += result.poses;
        merged.partly_off += result.partly_off;
        Ok(())
    }

    /// Returns the result of all shards together.
    ///
    /// # Errors
    /// Returns an error if some are missing.
    pub fn finish(self) -> Result<SweepResult, MergeError> {
        let Merged {
            grid,
            last,
            atlas,
            variance_parts,
            poses,
            partly_off,
        } = self.0.ok_or(ShardOrderError::Nothing)?;
        last.check_last()?;
        let mut table = Table::default();
        table.extend(atlas.summaries());
        let poses = (poses, partly_off);
        Ok(SweepResult::new(
            grid,
            Shard::WHOLE,
            poses,
            atlas,
            &table,
            variance_parts,
        ))
    }
}

/// Returns what differs between two grids; None if they are equal. The source lies where its ranges begin, so it is
/// compared last.
fn difference(one: &PoseGrid, other: &PoseGrid) -> Option<&'static str> {
    if one == other {
        None
    } else if one.sensor() != other.sensor() {
        Some("its sensor")
    } else if (one.ranges(), one.anchor()) != (other.ranges(), other.anchor()) {
        Some("its ranges or their anchor")
    } else {
        Some("its shape")
    }
}

/// The error of a merge.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// Shards that are missing, or given twice.
    #[error(transparent)]
    Order(#[from] ShardOrderError),
    /// A shard of another grid than the first one, or of another number of shards.
    #[error("shard {shard} differs from the first one in {difference}")]
    Foreign {
        /// The shard.
        shard: Shard,
        /// The difference: "its shape", for example.
        difference: &'static str,
    },
    /// A shard whose sweep was stopped early.
    #[error("shard {shard} was stopped early, run it again")]
    Incomplete {
        /// The shard.
        shard: Shard,
    },
}

#[cfg(test)]
mod tests {
    #[test]
    fn examples() -> Result<(), Box<dyn std::error::Error>> {
        use crate::prelude::*;
        use crate::sweep::{Shard, SweepMerge};
        let square = Source::Figure(Figure::default_of(
            FigureKind::Rectangle,
            &Sensor::default(),
        ));
        let ranges = Ranges::default().with(Axis::Angle, "0".parse()?);
        let grid = PoseGrid::new(square, Sensor::default(), Anchor::Corner, ranges)?;
        let mut merge = SweepMerge::default();
        for number in 1..=2 {
            merge.add(
                Sweep::new(&grid)
                    .with_shard(Shard::new(number, 2).unwrap())
                    .run(),
            )?;
        }
        assert_eq!(merge.finish()?, Sweep::new(&grid).run());
        Ok(())
    }
}
