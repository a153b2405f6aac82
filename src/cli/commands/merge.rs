//! `taxel merge`: merges the shards of a sweep or of a training; the content of the files decides which.

use std::collections::HashSet;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::time::Instant;

use taxel_core::recognition::{Evaluation, ModelMerge};
use taxel_core::sweep::SweepMerge;
use taxel_files::formats::{MODEL_FORMAT, archive_kind, json};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{self, check_writable, load_atlas, load_model, save_model, write_atlas};

use crate::cli::commands::export::{replacing, written};
use crate::cli::commands::model::{fits_in_table, model_file};
use crate::cli::commands::sweep::{atlas, summary};
use crate::cli::output::evaluation::{self, NamedBy};
use crate::cli::{Context, Failure, Named};

const EXAMPLES: &str = "\
All shards together give the same atlas as one sweep of the whole grid, or the
same model as one training. Each file says whether it is an atlas or a model.

Examples:
  taxel merge hexagon-*.npz --out hexagon.npz
  taxel merge a.npz b.npz --out both.csv --json
  taxel merge part-*.npz --out parts.npz";

/// Merge the shards of a sweep or a training
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Merge {
    /// Atlases or models of all shards, in any order
    #[arg(value_name = "FILE.npz", required = true)]
    files: Vec<PathBuf>,
    /// Write the atlas (.csv, .jsonl, .npz) or the model (.npz); --atlas means the same
    #[arg(long, alias = "atlas", value_name = "FILE", value_parser = atlas())]
    out: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
    /// Show no notes
    #[arg(long)]
    quiet: bool,
}

impl Merge {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let start = Instant::now();
        let existing = replacing(self.force);
        check_writable(&self.out, existing)?;
        let (parts, is_model) = self.parts()?;
        let memory = MemoryGuard::new("merge on a machine that has more");
        let (text, done) = if is_model {
            model_file(&self.out)?;
            let mut merge = ModelMerge::default();
            for path in parts {
                let model = load_model(path)?;
                if self.json {
                    fits_in_table("confusion matrix", model.shapes().len())?;
                }
                merge.add(&model).named(path.display())?;
                memory.check().map_err(Failure::new)?;
            }
            let model = merge.finish()?;
            let limit = Evaluation::of(&model);
            let text = if self.json {
                json::ascii(&evaluation::record(&limit, None)) + "\n"
            } else {
                evaluation::summary(&limit, NamedBy::Imprint)
            };
            (text, save_model(&model, &self.out, existing))
        } else {
            let mut merge = SweepMerge::default();
            for path in parts {
                merge.add(load_atlas(path)?).named(path.display())?;
                memory.check().map_err(Failure::new)?;
            }
            let result = merge.finish()?;
            let text = summary(&result, start.elapsed(), self.json);
            let file = write_atlas(&self.out, &result, existing);
            (text, file.and_then(|file| file.persist().map(drop)))
        };
        // The work is not lost if its file cannot be written.
        cx.write(text.as_bytes())?;
        done?;
        if !self.quiet {
            cx.note(&written(&self.out));
        }
        Ok(())
    }

    /// Returns the shards in their order, and whether they are models. All that are missing are named before hours of
    /// reading; the merge refuses the rest.
    fn parts(&self) -> Result<(Vec<&Path>, bool), Failure> {
        let mut parts = Vec::new();
        let mut is_model = false;
        let out = self.out.canonicalize().ok();
        for path in &self.files {
            // The shards could not be merged again.
            if out.is_some() && out == path.canonicalize().ok() {
                let text = "one of the shards; write to another file";
                return Err(Failure::new(text)).named(path.display());
            }
            let kind = archive_kind(BufReader::new(storage::open(path)?));
            let (format, shard) = kind.named(path.display())?;
            is_model = format == MODEL_FORMAT;
            parts.push((shard, path.as_path()));
        }
        parts.sort_by_key(|(shard, _)| shard.number());
        let of = parts[0].0.of();
        let given: HashSet<u32> = parts.iter().map(|(shard, _)| shard.number()).collect();
        let missing = (1..=of).filter(|number| !given.contains(number));
        let missing: Vec<String> = missing.map(|number| number.to_string()).collect();
        // The merge refuses one that is given twice.
        if missing.is_empty() || given.len() < parts.len() {
            return Ok((parts.into_iter().map(|(_, path)| path).collect(), is_model));
        }
        let count = missing.len();
        let are = if count == 1 { "is" } else { "are" };
        let missing = missing.join(", ");
        Err(Failure::new(format!(
            "{count} of {of} shards {are} missing: {missing}"
        )))
    }
}
