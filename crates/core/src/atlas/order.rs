use std::cmp::Ordering;

use crate::atlas::distinct::Atlas;
use crate::index::narrow;

/// A key by which the imprints of an atlas can be sorted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SortKey<'a> {
    /// The number of the first pose, which is the order of the imprints' numbers too.
    FirstPose,
    /// The number of poses that leave an imprint.
    Poses,
    /// The number of pieces.
    Pieces,
    /// The number of holes.
    Holes,
    /// One value per imprint, such as those of a feature ([`Atlas::values`]); imprints beyond the end have no value.
    Value(&'a [Option<f64>]),
}

/// The direction in which imprints are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SortDirection {
    /// The smallest comes first.
    Ascending,
    /// The largest comes first.
    Descending,
}

impl SortDirection {
    /// Returns the other direction.
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Ascending => Self::Descending,
            Self::Descending => Self::Ascending,
        }
    }

    /// Returns the order, in this direction, of two keys that have an ascending order.
    fn apply(self, ascending: Ordering) -> Ordering {
        match self {
            Self::Ascending => ascending,
            Self::Descending => ascending.reverse(),
        }
    }
}

/// Returns the numbers of all imprints, sorted by a key. In both directions, imprints with equal keys stay in the order
/// of their first poses, and those without a value come last.
pub fn sorted(atlas: &Atlas, by: SortKey<'_>, direction: SortDirection) -> Vec<u32> {
    let count = narrow(atlas.len());
    let summaries = |of: fn(&crate::atlas::feature::ImprintSummary) -> u16| {
        let keys: Vec<u64> = atlas
            .summaries()
            .iter()
            .map(|summary| of(summary).into())
            .collect();
        keys
    };
    let keys: Vec<u64> = match by {
        SortKey::FirstPose => (0..count).map(u64::from).collect(),
        SortKey::Poses => atlas.counts().collect(),
        SortKey::Pieces => summaries(|summary| summary.pieces),
        SortKey::Holes => summaries(|summary| summary.holes),
        SortKey::Value(values) => return by_value(count, values, direction),
    };
    let mut ids: Vec<(u64, u32)> = keys.into_iter().zip(0..count).collect();
    // The sort is stable, and the numbers are in order already. Many keys are equal, which makes a stable sort faster.
    ids.sort_by(|(one, _), (other, _)| direction.apply(one.cmp(other)));
    ids.into_iter().map(|(_, id)| id).collect()
}

fn by_value(count: u32, values: &[Option<f64>], direction: SortDirection) -> Vec<u32> {
    let values = values.iter().copied().chain(std::iter::repeat(None));
    let mut ids: Vec<(Option<f64>, u32)> = values.zip(0..count).collect();
    ids.sort_by(|(one, _), (other, _)| match (one, other) {
        (Some(one), Some(other)) => direction.apply(one.total_cmp(other)),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => Ordering::Equal,
    });
    ids.into_iter().map(|(_, id)| id).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atlas::feature::features;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::{Anchor, Axis, PoseGrid, Ranges};
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::sweep::Sweep;

    fn atlas() -> Atlas {
        let source = Source::Figure(Figure::default_of(
            FigureKind::Rectangle,
            &Sensor::default(),
        ));
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, range("-8:15:0.5"))
            .with(Axis::Y0, range("7:8:0.25"))
            .with(Axis::Angle, range("0:30:30"));
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
        Sweep::new(&grid.expect("in range")).run().atlas
    }

    #[test]
    fn every_imprint_comes_once_in_the_order_of_the_key() {
        let atlas = atlas();
        let count = u32::try_from(atlas.len()).expect("few");
        let values = atlas.values(0);
        assert_eq!(values.len(), atlas.len());
        assert!(values.contains(&None) && features()[0].key == "na");
        for by in [
            SortKey::FirstPose,
            SortKey::Poses,
            SortKey::Pieces,
            SortKey::Holes,
            SortKey::Value(&values),
        ] {
            for direction in [SortDirection::Ascending, SortDirection::Descending] {
                let ids = sorted(&atlas, by, direction);
                let mut all = ids.clone();
                all.sort_unstable();
                assert!(all.into_iter().eq(0..count), "{by:?}");
                let key = |id: u32| {
                    let entry = atlas.entry(id).expect("one of them");
                    #[expect(clippy::cast_precision_loss, reason = "small numbers")]
                    match by {
                        SortKey::FirstPose => Some(entry.first_pose as f64),
                        SortKey::Poses => Some(entry.count as f64),
                        SortKey::Pieces => Some(entry.summary.pieces.into()),
                        SortKey::Holes => Some(entry.summary.holes.into()),
                        SortKey::Value(_) => entry.summary.description.map(|one| one.na.into()),
                    }
                };
                for pair in ids.windows(2) {
                    let fits = match (key(pair[0]), key(pair[1])) {
                        (Some(one), Some(other)) if one == other => pair[0] < pair[1],
                        (Some(one), Some(other)) => {
                            (one < other) == (direction == SortDirection::Ascending)
                        }
                        (None, None) => pair[0] < pair[1],
                        (one, _) => one.is_some(),
                    };
                    assert!(fits, "{by:?}, {direction:?}: {pair:?}");
                }
            }
        }
    }

    #[test]
    fn imprints_without_a_value_come_last() {
        let atlas = atlas();
        let by = SortKey::Value(&[None, Some(2.0), Some(1.0)]);
        let ids = sorted(&atlas, by, SortDirection::Descending);
        assert_eq!(ids[..4], [1, 2, 0, 3]);
    }
}
