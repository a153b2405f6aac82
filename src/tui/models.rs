//! Models of recognition for the pages: read from a file, or trained on the thread of a job.

use taxel_core::progress::Progress;
use taxel_core::recognition::{Model, TrainingError};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{ModelChoice, Models};

/// Reads a model, or trains it unless the cache has it: `begins` is told the number of its poses. The error is a
/// sentence.
pub(super) fn ready(
    models: &Models,
    choice: ModelChoice,
    begins: impl FnOnce(u64),
    progress: &dyn Progress,
) -> Result<Model, String> {
    let found = models.find(choice).map_err(|error| error.to_string())?;
    found.ready(|training| {
        begins(training.poses());
        let memory = MemoryGuard::new(
            None,
            "take fewer shapes or coarser steps, or train it in shards on the command line (taxel model train --shard)",
        );
        memory
            .limit(progress, |progress| training.with_progress(progress).run())?
            .map_err(|error| match error {
                TrainingError::Stopped => "training was stopped".to_owned(),
                error => error.to_string(),
            })
    })
}
