//! `--resume`: continues a large study. A shard whose file is complete and belongs to the same study is not computed
//! again.
//!
//! A file gets its name only when it is complete, so a killed shard leaves no file and is computed. A file that is
//! damaged or belongs to another study is refused with an error that names it; it is neither merged by mistake nor
//! replaced.

use std::path::Path;

use crate::cli::error::CliError;
use crate::formats::ArchiveError;
use crate::pose::{Anchor, Axis, PoseGrid, Ranges};
use crate::recognition::{Model, Training};
use crate::sensor::Sensor;
use crate::storage::{ArchiveFileError, load_atlas, load_model};
use crate::sweep::{Shard, SweepResult};

/// The words before the name of a file that is kept.
pub(crate) const KEPT: &str = "kept, complete and part of this study";

/// Returns the atlas of a shard that was swept before; None if there is no such file.
///
/// # Errors
/// Returns [`CliError::NotResumed`] if the file is damaged or belongs to another study.
pub(crate) fn atlas(
    path: &Path,
    grid: &PoseGrid,
    shard: Shard,
) -> Result<Option<SweepResult>, CliError> {
    let Some(found) = whole(path, load_atlas(path))? else {
        return Ok(None);
    };
    let own = StudyGrid::of(&found.grid, found.shard);
    if let Some(difference) = own.difference(&StudyGrid::of(grid, shard)) {
        return Err(foreign(path, &difference));
    }
    if found.grid.source() != grid.source() {
        return Err(foreign(path, "its shape is another one"));
    }
    if !found.complete() {
        return Err(torn(path, "not all of its poses were swept"));
    }
    Ok(Some(found))
}

/// Returns the model of a shard that was trained before; None if there is no such file.
///
/// # Errors
/// Returns [`CliError::NotResumed`] if the file is damaged or belongs to another study.
pub(crate) fn model(
    path: &Path,
    training: &Training<'_>,
    shard: Shard,
    allow_cut: bool,
) -> Result<Option<Model>, CliError> {
    let Some(found) = whole(path, load_model(path))? else {
        return Ok(None);
    };
    let grid = &training.grids()[0];
    let own = StudyGrid {
        sensor: *found.sensor(),
        anchor: found.anchor(),
        ranges: *found.ranges(),
        shard: found.shard(),
    };
    if let Some(difference) = own.difference(&StudyGrid::of(grid, shard)) {
        return Err(foreign(path, &difference));
    }
    let (mut shapes, asked) = (found.shapes().iter(), training.shapes());
    let other = asked.iter().find(|&shape| shapes.next() != Some(shape));
    if let Some(shape) = other {
        let difference = format!("the shape {:?} is missing, or differs", shape.name);
        return Err(foreign(path, &difference));
    }
    if shapes.next().is_some() {
        return Err(foreign(path, "it has more shapes"));
    }
    if !allow_cut && found.cut().iter().any(|&cut| cut > 0) {
        return Err(foreign(path, "it has poses that the sensor cuts off"));
    }
    if found.poses() * asked.len() as u64 != training.poses() {
        return Err(torn(path, "not all of its poses were trained"));
    }
    Ok(Some(found))
}

/// Returns what was read from a file; None if it does not exist. A damaged file is an error that names it.
fn whole<T>(path: &Path, read: Result<T, ArchiveFileError>) -> Result<Option<T>, CliError> {
    match read {
        Ok(found) => Ok(Some(found)),
        Err(error) if error.is_missing() => Ok(None),
        Err(ArchiveFileError {
            error: ArchiveError::Io(error),
            ..
        }) if error.raw_os_error().is_some() => Err(ArchiveFileError::new(path, error).into()),
        Err(error) if matches!(error.error, ArchiveError::Format { .. }) => {
            Err(foreign(path, &error.error.to_string()))
        }
        Err(error) => Err(torn(path, &error.error.to_string())),
    }
}

/// Returns the error of a file that is damaged.
fn torn(path: &Path, reason: &str) -> CliError {
    CliError::NotResumed {
        name: path.to_string_lossy().into_owned(),
        what: "incomplete",
        reason: reason.to_owned(),
    }
}

/// Returns the error of a file that belongs to another study.
fn foreign(path: &Path, reason: &str) -> CliError {
    CliError::NotResumed {
        name: path.to_string_lossy().into_owned(),
        what: "part of another study",
        reason: reason.to_owned(),
    }
}

/// The poses that a shard was to compute, without the shapes.
#[derive(Clone, Copy, Debug)]
struct StudyGrid {
    sensor: Sensor,
    anchor: Anchor,
    ranges: Ranges,
    shard: Shard,
}

impl StudyGrid {
    fn of(grid: &PoseGrid, shard: Shard) -> Self {
        Self {
            sensor: *grid.sensor(),
            anchor: grid.anchor(),
            ranges: *grid.ranges(),
            shard,
        }
    }

    /// Returns the first difference between a file and the request, in words; None if there is none.
    fn difference(&self, asked: &Self) -> Option<String> {
        let unlike = |what: &str, own: String, asked: String| {
            (own != asked).then(|| format!("its {what} is {own}, not {asked}"))
        };
        let axis = |axis: Axis| {
            let (own, asked) = (self.ranges[axis], asked.ranges[axis]);
            unlike(axis.name(), own.to_string(), asked.to_string())
        };
        unlike("shard", self.shard.to_string(), asked.shard.to_string())
            .or_else(|| unlike("sensor", self.sensor.to_string(), asked.sensor.to_string()))
            .or_else(|| {
                let (own, asked) = (self.anchor.name(), asked.anchor.name());
                unlike("anchor", own.to_owned(), asked.to_owned())
            })
            .or_else(|| Axis::ALL.into_iter().find_map(axis))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

    use super::*;
    use crate::figure::Figure;
    use crate::progress::stop_if;
    use crate::storage::{AtlasFile, Existing};
    use crate::sweep::Sweep;

    #[test]
    fn an_atlas_that_was_not_swept_to_the_end_is_not_whole() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("part.npz");
        let sensor = Sensor::default();
        let bar = Figure::rectangle(3.0, 2.0).on(&sensor).expect("in range");
        let grid = PoseGrid::new(bar.into(), sensor, Anchor::Corner, Ranges::default());
        let grid = grid.expect("in range");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let stopped = pool.expect("threads").install(|| {
            let done = AtomicU64::new(0);
            let progress = |poses| stop_if(done.fetch_add(poses, Ordering::Relaxed) >= 100_000);
            Sweep::new(&grid).with_progress(&progress).run()
        });
        assert!(!stopped.complete());
        let file = AtlasFile::new(&path).expect("an archive");
        let written = file.write(&stopped, Existing::Kept, &AtomicBool::new(false));
        written.expect("written");
        let refused = atlas(&path, &grid, Shard::WHOLE).expect_err("incomplete");
        let said = "is incomplete (not all of its poses were swept)";
        assert!(refused.to_string().contains(said), "{refused}");
    }
}
