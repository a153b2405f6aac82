//! `taxel export`, and `--save` and `--export` of other commands: writes an imprint in a format for other programs, or
//! draws it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::ArgGroup;
use clap::builder::{OsStringValueParser, TypedValueParser};
use taxel_core::imprint::Imprint;
use taxel_core::source::Source;
use taxel_files::formats::{Content, Drawing, ExportFormat, Name, StoredShape};
use taxel_files::storage::{self, Existing, FileError, NewFile};

use crate::cli::arguments::flags::name_or_path;
use crate::cli::arguments::parameters::PitchFlag;
use crate::cli::input::shapes::Shelf;
use crate::cli::{Context, Failure};

const EXAMPLES: &str = "\
The extension of TO decides the format:
  .txt  rows of '#' and '.'         .svg  a drawing: matrix, outline (if known),
  .csv  a table of 0 and 1                rectangle, CG, CD, axes, legend
  .npy  a numpy array of bool
Drawings are grey; with a pitch they are in mm. An existing file is replaced
only with --force. To export a figure, use 'taxel figure ... --export'.

Examples:
  taxel export washer washer.svg --pitch 2.5
  taxel export imprint.txt imprint.npy --force
  taxel export key key.csv
  taxel figure hexagon --angle 17 --export hexagon.svg";

/// Write a shape for other programs, or draw it
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ExportCommand {
    /// Shape of the library, or file; '-' for standard input
    #[arg(value_name = "NAME|FILE", value_parser = name_or_path())]
    what: OsString,
    /// File to write
    #[arg(value_name = "TO", value_parser = export())]
    to: Export,
    #[command(flatten)]
    pitch: PitchFlag,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

impl ExportCommand {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let pitch = self.pitch.pitch(&cx.settings)?;
        let drawing = match cx.shelf.find(&self.what)? {
            Content::Imprint(imprint) => {
                let title = Path::new(&self.what).file_name().unwrap_or(&self.what);
                drawing(&imprint, None, &title.to_string_lossy(), pitch.of(None))
            }
            Content::Shape(shape) => {
                let (source, pitch) = (shape.source.as_ref(), pitch.of(Some(&shape.sensor)));
                let made = source.map_or(String::new(), |source| format!(": {source}"));
                let title = format!("{}{made}", shape.name);
                drawing(&shape.imprint, source, &title, pitch)
            }
        };
        let content = (self.to.format.write)(&drawing);
        storage::write(&self.to.path, &content, replacing(self.force))?;
        cx.print(&(written(&self.to.path) + "\n"))
    }
}

pub(crate) fn replacing(force: bool) -> Existing {
    if force {
        Existing::Replaced
    } else {
        Existing::Kept
    }
}

/// Makes the drawing of an imprint, with the outline of `source` if there is one, and in mm if there is a `pitch`.
pub(crate) fn drawing(
    imprint: &Imprint,
    source: Option<&Source>,
    title: &str,
    pitch: Option<f64>,
) -> Drawing {
    let mut drawing = Drawing::new(imprint);
    title.clone_into(&mut drawing.title);
    drawing.pitch_mm = pitch;
    let Some(source) = source else {
        return drawing;
    };
    if pitch.is_some() {
        // The title describes the source.
        drawing.title += " (in cells)";
    }
    drawing.with_outline(source)
}

/// The file that an imprint is written to.
#[derive(Clone, Debug)]
struct Export {
    path: PathBuf,
    format: &'static ExportFormat,
}

fn export() -> impl TypedValueParser<Value = Export> {
    OsStringValueParser::new().try_map(|name| {
        let path = PathBuf::from(name);
        let format = ExportFormat::of_path(&path)
            .ok_or("expected a name that ends in .txt, .csv, .npy or .svg")?;
        Ok::<_, &str>(Export { path, format })
    })
}

/// The flags that keep what a command makes.
#[derive(Clone, Debug, clap::Args)]
#[command(group = ArgGroup::new("kept").args(["save", "export"]).multiple(true))]
pub(crate) struct KeepFlags {
    /// Also store the shape in the library
    #[arg(long, value_name = "NAME", value_parser = Name::new, help_heading = "Library")]
    save: Option<Name>,
    /// Write the imprint, or a drawing of it
    #[arg(long, value_name = "FILE", value_parser = export(), help_heading = "Export")]
    export: Option<Export>,
    /// Replace an existing shape or file
    #[arg(long, requires = "kept")]
    force: bool,
}

impl KeepFlags {
    /// Keeps a touch: the file is written, then the shape is stored, then the file gets its name, which hardly ever
    /// fails. So both are kept or neither. Returns what was kept, a line each.
    pub(crate) fn keep(
        &self,
        drawing: impl FnOnce() -> Drawing,
        shape: impl FnOnce(Name) -> StoredShape,
        shelf: &Shelf,
    ) -> Result<Vec<String>, Failure> {
        let existing = replacing(self.force);
        let mut kept = Vec::new();
        let file = self.export.as_ref().map(|export| {
            let content = (export.format.write)(&drawing());
            NewFile::with_content(&export.path, &content, existing)
        });
        let file = file.transpose()?;
        if let Some(name) = &self.save {
            let saved = shelf.save(&shape(name.clone()), existing)?;
            kept.push(format!("saved as {saved}"));
        }
        if let Some(file) = file {
            kept.push(written(&file.path));
            file.persist()?;
        }
        Ok(kept)
    }
}

pub(crate) fn written(path: &Path) -> String {
    format!("written: {}", path.display())
}

pub(crate) fn make_folder(folder: &Path) -> Result<(), Failure> {
    Ok(fs::create_dir_all(folder).map_err(|error| {
        let error = if folder.exists() {
            io::Error::other("a file, expected a folder")
        } else {
            error
        };
        FileError::cannot("write", folder)(error)
    })?)
}
