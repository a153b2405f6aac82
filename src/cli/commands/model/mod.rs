//! `taxel model`: trains models of shapes, keeps them, and measures how well one touch tells the shapes apart.
//!
//! A model is the file of a training: every imprint that some shapes leave on a grid of poses, and how often each shape
//! leaves it. A model is named as in `taxel recognise --model`: a built-in set such as `figures` takes precedence over a
//! model of the library, and that over a file.

mod confusion;
mod keeping;
mod noise;
mod separate;
mod train;
pub(crate) mod trial;

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use taxel_core::progress::Progress;
use taxel_core::recognition::{CellPositions, Model, TrainingError};
use taxel_files::formats::Name;
use taxel_files::formats::file::has_ending;
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{
    self, FoundModel, ModelCache, ModelChoice, ModelFolder, Models, check_writable,
};

use crate::cli::arguments::flags::{file_of, name_or_path};
use crate::cli::commands::export::{replacing, written};
use crate::cli::failure::{Failure, Named};
use crate::cli::input::outlines::OutlineFlags;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::progress::ProgressDisplay;
use crate::cli::signals::{Signals, on_threads};
use crate::cli::{Context, note};

/// The model that is used if none is named: all shapes of the library.
pub(crate) const DEFAULT: &str = "library";

/// The most shapes of a table of all pairs; more would take gigabytes.
const MOST_PAIRED: usize = 4096;

const EXAMPLES: &str = "\
A model holds every imprint that its shapes can leave, and in how many poses
each shape leaves it. The best answer to a touch is the shape that leaves its
imprint in the most poses: no method names a smaller share of touches wrong.
MODEL is a file, the name of one of your models, or the name of a
built-in model: library, figures, figures-30 or shapes.

Examples:
  taxel model train parts.jsonl --name parts
  taxel model confusion parts
  taxel recognise imprint.txt --model parts";

#[derive(Debug, clap::Subcommand)]
#[command(after_help = EXAMPLES)]
pub(crate) enum ModelCommand {
    Train(train::Train),
    /// Show what a model was trained on, and its error
    #[command(after_help = keeping::SHOW_EXAMPLES)]
    Show {
        /// Name of a model, or its file
        #[arg(value_parser = name_or_path())]
        model: OsString,
        /// Print JSON, one line per answer
        #[arg(long)]
        json: bool,
    },
    /// List the models
    #[command(after_help = keeping::LIST_EXAMPLES)]
    List,
    /// Delete a model
    #[command(after_help = keeping::DELETE_EXAMPLES)]
    Delete {
        /// Name of the model
        #[arg(value_parser = Name::new)]
        name: Name,
    },
    Confusion(confusion::Confusion),
    Touches(noise::Touches),
    Separate(separate::Separate),
}

impl ModelCommand {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        match self {
            Self::Train(command) => command.run(cx),
            Self::Show { model, json } => keeping::show(&model, json, cx),
            Self::List => keeping::list(cx),
            Self::Delete { name } => keeping::delete(&name, cx),
            Self::Confusion(command) => command.run(cx),
            Self::Touches(command) => command.run(cx),
            Self::Separate(command) => command.run(cx),
        }
    }
}

/// A set of shapes.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct SetFlags {
    /// Shapes: names of the library, outlines (.svg, .csv), files of JSON lines; '-' for standard input
    #[arg(id = "set", value_name = "FILE|NAME", value_parser = name_or_path())]
    #[arg(required_unless_present = "library_all")]
    pub(crate) what: Vec<OsString>,
    /// All shapes of the library
    #[arg(long)]
    pub(crate) library_all: bool,
    #[command(flatten)]
    pub(crate) outlines: OutlineFlags,
}

/// The forms of a table, and the file that it is written to.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct TableFlags {
    /// Write a drawing
    #[arg(long, value_name = "FILE.svg", value_parser = file_of("svg"), group = "with_export")]
    export: Option<PathBuf>,
    /// Replace an existing file
    #[arg(long, requires = "with_export")]
    force: bool,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
    /// Show no progress and no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// An answer in its forms.
pub(crate) trait Table {
    fn text(&self) -> String;

    fn json(&self) -> String;

    /// None if there is no CSV of it.
    fn csv(&self) -> Option<String> {
        None
    }

    /// None if there is no drawing of it.
    fn svg(&self) -> Option<String> {
        None
    }
}

impl TableFlags {
    /// Refuses a file that cannot be written: before the work, not after it.
    fn check(&self) -> Result<(), Failure> {
        if let Some(path) = &self.export {
            check_writable(path, replacing(self.force))?;
        }
        Ok(())
    }

    fn give(&self, table: &impl Table, as_csv: bool, cx: &Context) -> Result<(), Failure> {
        if let Some((path, drawing)) = self.export.as_ref().zip(table.svg()) {
            storage::write(path, drawing.as_bytes(), replacing(self.force))?;
            if !self.quiet {
                cx.note(&written(path));
            }
        }
        cx.print(&match table.csv().filter(|_| as_csv) {
            Some(csv) => csv,
            None if self.json => table.json(),
            None => table.text(),
        })
    }
}

/// Parses a number of positions per cell. Their distance must be a whole number of hundredths of a cell, since ranges
/// are exact in hundredths.
fn positions(text: &str) -> Result<CellPositions, &'static str> {
    let number = text.trim().parse::<u8>().ok();
    let positions = number.and_then(CellPositions::new);
    positions.ok_or("expected 1, 2, 4, 5, 10, 20, 25, 50 or 100")
}

/// Refuses a file name without the extension of a model: such a file would be taken for something else when it is
/// read.
pub(crate) fn model_file(path: &Path) -> Result<(), Failure> {
    if has_ending(path, "npz") {
        return Ok(());
    }
    let expected = "expected a name that ends in .npz, for a model";
    Err(Failure::new(expected)).named(path.display())
}

pub(crate) fn fits_in_table(table: &str, shapes: usize) -> Result<(), Failure> {
    if shapes <= MOST_PAIRED {
        return Ok(());
    }
    let text = format!("the model has {shapes} shapes (allowed: up to {MOST_PAIRED})");
    Err(Failure::new(text)).named(table)
}

fn folder(shelf: &Shelf) -> Result<ModelFolder, Failure> {
    Ok(ModelFolder::of(shelf.library()?.folder()))
}

/// The models that a command may name.
pub(crate) fn models(shelf: &Shelf) -> Models {
    Models {
        library: shelf.readable(),
        cache: ModelCache::of_user(),
    }
}

/// Finds a model without training it, so that other errors come first.
pub(crate) fn find(which: impl AsRef<OsStr>, shelf: &Shelf) -> Result<FoundModel, Failure> {
    Ok(models(shelf).find(ModelChoice::from_text(which))?)
}

/// Returns a model that was found. Shapes of a built-in set that are not in the cache are trained: many in a second.
/// Signals are not caught meanwhile: nothing would have to be removed.
pub(crate) fn ready(found: FoundModel, quiet: bool) -> Result<Model, Failure> {
    let poses = match &found {
        FoundModel::BuiltIn { set, left_out, .. } => {
            if !quiet && !left_out.is_empty() {
                note(&format!("left out: {}", left_out.join(", ")));
            }
            set.poses()
        }
        FoundModel::Read(_) => 0,
    };
    let display = ProgressDisplay::new("poses", poses, quiet);
    found.ready(&display).map_err(Failure::new)
}

/// Long work whose progress is counted in `all` of a noun. None from it means that a signal stopped it.
fn watched<T>(
    (all, noun): (u64, &'static str),
    quiet: bool,
    work: impl FnOnce(&dyn Progress) -> Option<T>,
) -> Result<T, Failure> {
    let signals = Signals::catch()?;
    let display = ProgressDisplay::new(noun, all, quiet);
    let done = work(&signals.progress(&display));
    done.ok_or_else(|| signals.failure())
}

fn trained<T: Send>(
    poses: u64,
    by: (Option<u16>, MemoryGuard, bool),
    work: impl FnOnce(&dyn Progress) -> Result<T, TrainingError> + Send,
) -> Result<T, Failure> {
    let signals = Signals::catch()?;
    let done = on_threads(&signals, poses, by, work)?;
    let hint =
        "; use a larger sensor, other positions or smaller shapes, or allow it with --allow-cut";
    done.map_err(|error| match error {
        TrainingError::Stopped => signals.failure(),
        error @ TrainingError::Cut { .. } => Failure::from(error).with_hint(hint),
        error => error.into(),
    })
}
