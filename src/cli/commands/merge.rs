//! `taxel merge`: merges the shards of a sweep or of a training; the content of the files decides which.

use std::collections::HashSet;
use std::io::BufReader;
use std::path::PathBuf;
use std::time::Instant;

use taxel_core::recognition::{Evaluation, ModelMerge};
use taxel_core::sweep::{Shard, SweepMerge};
use taxel_files::formats::{MODEL_FORMAT, archive_kind, json};
use taxel_files::memory::{MemoryGuard, MemorySize};
use taxel_files::storage::{self, check_writable, load_atlas, load_model, save_model, write_atlas};

use crate::cli::Context;
use crate::cli::commands::export::{replacing, written};
use crate::cli::commands::model::{fits_in_table, model_file};
use crate::cli::commands::sweep::atlas;
use crate::cli::failure::{Failure, Named};
use crate::cli::output::evaluation::{self, EvaluationJson};
use crate::cli::output::sweep_summary;

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
    /// Most memory to use, such as 500M or 2G; default all that is free
    #[arg(long, value_name = "SIZE")]
    memory: Option<MemorySize>,
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
        let parts = self.parts()?;
        let advice = "allow more (--memory), or merge on a machine that has more";
        let memory = MemoryGuard::new(self.memory, advice);
        let (text, done) = if parts.iter().any(Part::is_model) {
            let mut merge = ModelMerge::default();
            for Part { path, .. } in &parts {
                let model = load_model(path)?;
                if self.json {
                    fits_in_table("confusion matrix", model.shapes().len())?;
                }
                merge.add(&model).named(path.display())?;
                memory.check().map_err(Failure::new)?;
            }
            let model = merge.finish()?;
            let evaluation = &Evaluation::of(&model);
            let text = if self.json {
                let classifier = None;
                json::ascii(&EvaluationJson {
                    evaluation,
                    classifier,
                }) + "\n"
            } else {
                evaluation::summary(evaluation, evaluation::NamedBy::Imprint)
            };
            (text, save_model(&model, &self.out, existing))
        } else {
            let mut merge = SweepMerge::default();
            for Part { path, .. } in &parts {
                merge.add(load_atlas(path)?).named(path.display())?;
                memory.check().map_err(Failure::new)?;
            }
            let result = merge.finish()?;
            let file = write_atlas(&self.out, &result, existing);
            let done = file.and_then(|file| file.persist().map(drop));
            (
                sweep_summary::of(&result, start.elapsed(), self.json, cx.charset),
                done,
            )
        };
        // The work is not lost if its file cannot be written.
        cx.write(text.as_bytes())?;
        done?;
        if !self.quiet {
            cx.note(&written(&self.out));
        }
        Ok(())
    }

    /// Returns the shards in their order. Those that do not belong together are refused before they are read.
    fn parts(&self) -> Result<Vec<Part>, Failure> {
        let mut parts = Vec::new();
        for path in &self.files {
            // The shards could not be merged again.
            if self
                .out
                .canonicalize()
                .is_ok_and(|out| path.canonicalize().is_ok_and(|own| own == out))
            {
                let text = "one of the shards; write to another file";
                return Err(Failure::new(text)).named(path.display());
            }
            let kind = archive_kind(BufReader::new(storage::open(path)?));
            let (format, shard) = kind.named(path.display())?;
            parts.push(Part {
                path: path.clone(),
                format,
                shard,
            });
        }
        parts.sort_by_key(|part| part.shard.number());
        let first = &parts[0];
        let of = first.shard.of();
        for part in &parts {
            let (noun, place) = (first.noun(), first.path.display());
            let difference = if part.is_model() != first.is_model() {
                format!(
                    "{}, but {place} is {noun}; give the shards of one sweep or of one training",
                    part.noun()
                )
            } else if part.shard.of() != of {
                format!(
                    "shard {}, but {place} is shard {}: not the same study",
                    part.shard, first.shard
                )
            } else {
                continue;
            };
            return Err(Failure::new(difference)).named(part.path.display());
        }
        let given: HashSet<u32> = parts.iter().map(|part| part.shard.number()).collect();
        // The merge refuses one that is given twice.
        if given.len() == parts.len() && given.len() < of as usize {
            let missing = (1..=of).filter(|number| !given.contains(number));
            let mut numbers: Vec<String> = missing.map(|number| number.to_string()).collect();
            let count = numbers.len();
            if count > MOST_LISTED {
                numbers.truncate(MOST_LISTED);
                numbers.push("…".to_owned());
            }
            let (numbers, are) = (numbers.join(", "), if count == 1 { "is" } else { "are" });
            let text = format!("{count} of {of} shards {are} missing: {numbers}");
            return Err(Failure::new(text));
        }
        if first.is_model() {
            model_file(&self.out)?;
        }
        Ok(parts)
    }
}

const MOST_LISTED: usize = 10;

struct Part {
    path: PathBuf,
    format: String,
    shard: Shard,
}

impl Part {
    fn is_model(&self) -> bool {
        self.format == MODEL_FORMAT
    }

    fn noun(&self) -> &'static str {
        if self.is_model() {
            "a model"
        } else {
            "an atlas"
        }
    }
}
