//! A survey as plain numbers, for files: what shards are merged from.
//!
//! Imprints, how often each occurs and where first, and the sums that the statistics need beside these. Descriptors
//! are not among them: they follow from the imprints.

use crate::atlas::Atlas;
use crate::atlas::counter::Census;
use crate::atlas::values::Table;
use crate::atlas::variance::Spread;
use crate::imprint::Imprint;
use crate::pose::grid::Grid;
use crate::sweep::plan::Shard;
use crate::sweep::survey::Survey;

/// The numbers of a survey.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Parts {
    /// Poses gone through.
    pub(crate) poses: u64,
    /// Poses that reach beyond the sensor.
    pub(crate) partly_off: u64,
    /// The imprints one after another, a word per row of the sensor, bit `i` for column `i`.
    pub(crate) rows: Vec<u64>,
    /// How often each imprint occurs.
    pub(crate) counts: Vec<u64>,
    /// The number of the first pose of each.
    pub(crate) first_poses: Vec<u64>,
    /// Sums about the turns; their meaning is a matter of this version of the program.
    pub(crate) spread: Vec<u64>,
}

impl Survey {
    /// The numbers that it is made of.
    pub(crate) fn parts(&self) -> Parts {
        let mut parts = Parts {
            poses: self.poses,
            partly_off: self.partly_off,
            spread: self.spread.words(),
            ..Parts::default()
        };
        for entry in self.atlas.entries() {
            parts.rows.extend_from_slice(entry.imprint.words());
            parts.counts.push(entry.count);
            parts.first_poses.push(entry.first_pose);
        }
        parts
    }

    /// The survey that such numbers make.
    ///
    /// # Errors
    /// Where they contradict each other or the grid.
    pub(crate) fn from_parts(grid: Grid, shard: Shard, parts: &Parts) -> Result<Self, PartsError> {
        let check = |holds: bool, what: &'static str| holds.then_some(()).ok_or(PartsError(what));
        let (columns, rows) = (grid.sensor().columns(), grid.sensor().rows());
        let height = usize::from(rows);
        let same = parts.counts.len() == parts.first_poses.len()
            && parts.counts.len().checked_mul(height) == Some(parts.rows.len());
        check(same, "arrays of different lengths")?;
        let sum = parts
            .counts
            .iter()
            .map(|&count| u128::from(count))
            .sum::<u128>();
        check(sum == u128::from(parts.poses), "counts that do not add up")?;
        let own = shard.rows(grid.rows());
        let width = grid.ranges().x0.count();
        check(
            parts.poses <= (own.end - own.start) * width && parts.partly_off <= parts.poses,
            "more poses than there are",
        )?;
        let ascending = parts.first_poses.windows(2).all(|pair| pair[0] < pair[1]);
        let (first, last) = (parts.first_poses.first(), parts.first_poses.last());
        let inside = first.is_none_or(|&first| first >= own.start * width)
            && last.is_none_or(|&last| last < own.end * width);
        check(ascending && inside, "first poses out of order")?;
        let mut atlas = Atlas::new(columns, rows);
        let mut census = Census::new(atlas.layout().words());
        let entries = parts.counts.iter().zip(&parts.first_poses);
        for (words, (&count, &first)) in parts.rows.chunks_exact(height).zip(entries) {
            let mut imprint = Imprint::empty(columns, rows);
            for (row, &word) in words.iter().enumerate() {
                imprint.set_word(row, word);
            }
            check(imprint.words() == words, "taxels beyond the sensor")?;
            let (key, hash) = atlas.layout().key(&imprint);
            let known = census.len();
            census.add(&key, hash, count, first);
            check(
                census.len() > known && count > 0,
                "an imprint that is there twice",
            )?;
        }
        let spread = Spread::from_words(width * grid.ranges().y0.count(), &parts.spread)
            .ok_or(PartsError("sums of another version"))?;
        atlas.add(&census, 1);
        atlas.describe();
        let mut table = Table::default();
        table.extend(atlas.notes());
        let poses = (parts.poses, parts.partly_off);
        Ok(Self::new(grid, shard, poses, atlas, &table, spread))
    }
}

/// Why numbers make no survey.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PartsError(&'static str);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::grid::{Anchor, Ranges};
    use crate::pose::range::DecimalRange;
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::sweep::survey::Watch;

    #[test]
    fn first_poses_lie_in_the_shard() {
        let ranges = Ranges {
            angle: DecimalRange::whole(0),
            ..Ranges::default()
        };
        let source = Source::Figure(Figure::default_of(FigureKind::Hexagon, 16));
        let grid = Grid::new(source, Sensor::default(), Anchor::Corner, ranges).expect("a grid");
        let shard = Shard::new(2, 2).expect("a shard");
        let parts = Survey::of(&grid, shard, Watch::nothing()).parts();
        let read = |first: u64| {
            let mut parts = parts.clone();
            parts.first_poses[0] = first;
            Survey::from_parts(grid.clone(), shard, &parts).map(|survey| survey.parts() == parts)
        };
        assert_eq!(parts.first_poses[0], 5000);
        assert_eq!(read(5000), Ok(true));
        assert_eq!(read(4999), Err(PartsError("first poses out of order")));
    }
}
