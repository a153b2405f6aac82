//! `taxel export`, and `--save` and `--export` of other commands: writes an imprint in a format for other programs, or
//! draws it. Standard output, `-`, gets the same bytes as a file.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::{fs, io};

use clap::ArgGroup;
use clap::builder::{PossibleValuesParser, TypedValueParser};
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
  .pbm  a bitmap, P4                      rectangle, CG, CD, axes, legend
  .csv  a table of 0 and 1
  .npy  a numpy array of bool
Drawings are grey; with a pitch they are in mm. An existing file is replaced
only with --force. To export a figure, use 'taxel figure ... --export'.

Examples:
  taxel export washer washer.svg --pitch 2.5
  taxel export imprint.txt imprint.npy --force
  taxel export key - --format csv
  taxel figure hexagon --angle 17 --export hexagon.svg";

/// Write a shape for other programs, or draw it
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ExportCommand {
    /// Shape of the library, or file; '-' for standard input
    #[arg(value_name = "NAME|FILE", value_parser = name_or_path())]
    what: OsString,
    /// File to write; '-' for standard output
    #[arg(value_name = "TO")]
    to: PathBuf,
    #[command(flatten)]
    pitch: PitchFlag,
    /// Format, if not given by the extension
    #[arg(long, value_name = "FORMAT", value_parser = format())]
    format: Option<&'static ExportFormat>,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

impl ExportCommand {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let export = Export::new(self.to, self.format)?;
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
        let content = (export.format.write)(&drawing);
        let Some(path) = &export.path else {
            return cx.write(&content);
        };
        storage::write(path, &content, replacing(self.force))?;
        cx.print(&(written(path) + "\n"))
    }
}

fn format() -> impl TypedValueParser<Value = &'static ExportFormat> {
    let names = ExportFormat::ALL.iter().map(|format| format.name);
    PossibleValuesParser::new(names).try_map(|name| {
        let mut all = ExportFormat::ALL.iter();
        all.find(|format| format.name == name).ok_or("unknown")
    })
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
pub(crate) struct Export {
    /// Its path; None for standard output.
    pub(crate) path: Option<PathBuf>,
    pub(crate) format: &'static ExportFormat,
}

impl Export {
    fn new(path: PathBuf, format: Option<&'static ExportFormat>) -> Result<Self, Failure> {
        let path = Some(path).filter(|path| path.as_os_str() != "-");
        let of_path = || path.as_deref().and_then(ExportFormat::of_path);
        let format = format.or_else(of_path).ok_or_else(|| {
            Failure::usage(match &path {
                None => "writing to standard output needs '--format'".to_owned(),
                Some(path) => format!(
                    "'{}': expected a name that ends in .txt, .pbm, .csv, .npy or .svg, or a '--format'",
                    path.display()
                ),
            })
        })?;
        Ok(Self { path, format })
    }

    /// The file of one of several imprints: its name has the number at its end.
    pub(crate) fn numbered(&self, number: u64) -> Self {
        let path = self.path.as_ref().map(|path| {
            let mut name = path.file_stem().unwrap_or(path.as_os_str()).to_owned();
            name.push(format!("-{number}"));
            if let Some(ending) = path.extension() {
                name.push(".");
                name.push(ending);
            }
            path.with_file_name(name)
        });
        Self { path, ..*self }
    }
}

/// The flags that keep what a command makes.
#[derive(Clone, Debug, clap::Args)]
#[command(group = ArgGroup::new("kept").args(["save", "export"]).multiple(true))]
pub(crate) struct KeepFlags {
    /// Also store the shape in the library
    #[arg(long, value_name = "NAME", value_parser = Name::new, help_heading = "Library")]
    save: Option<Name>,
    /// Write the imprint, or a drawing of it; '-' for standard output, instead of the table
    #[arg(long, value_name = "FILE", help_heading = "Export")]
    export: Option<PathBuf>,
    /// Format, if not given by the extension
    #[arg(long, value_name = "FORMAT", value_parser = format(), requires = "export", help_heading = "Export")]
    format: Option<&'static ExportFormat>,
    /// Replace an existing shape or file
    #[arg(long, requires = "kept")]
    force: bool,
}

impl KeepFlags {
    /// Checks the flags. `json` tells whether the answer is JSON, too.
    pub(crate) fn kept(&self, json: bool) -> Result<Kept, Failure> {
        let export = self.export.clone();
        let export = export
            .map(|path| Export::new(path, self.format))
            .transpose()?;
        if json && export.as_ref().is_some_and(|export| export.path.is_none()) {
            let text = "the argument '--json' cannot be used with '--export -': both write to standard output";
            return Err(Failure::usage(text));
        }
        Ok(Kept {
            save: self.save.clone(),
            existing: replacing(self.force),
            export,
        })
    }
}

/// What is kept of a touch.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    pub(crate) save: Option<Name>,
    pub(crate) existing: Existing,
    pub(crate) export: Option<Export>,
}

impl Kept {
    /// The same, for one of several imprints.
    pub(crate) fn numbered(&self, number: u64) -> Self {
        Self {
            save: self.save.clone(),
            export: self.export.as_ref().map(|export| export.numbered(number)),
            ..*self
        }
    }

    /// Keeps a touch: the file is written, then the shape is stored, then the file gets its name, which hardly ever
    /// fails. So both are kept or neither. Notes of what was kept are added to `notes`. Returns the content for
    /// standard output that takes the place of the answer, if any.
    pub(crate) fn keep(
        &self,
        drawing: impl FnOnce() -> Drawing,
        shape: impl FnOnce(Name) -> StoredShape,
        shelf: &Shelf,
        notes: &mut Vec<String>,
    ) -> Result<Option<Vec<u8>>, Failure> {
        let export = self.export.as_ref();
        let content = export.map(|export| (export.format.write)(&drawing()));
        let file = export
            .and_then(|export| export.path.as_ref())
            .zip(content.as_ref());
        let file = file.map(|(path, content)| NewFile::with_content(path, content, self.existing));
        let file = file.transpose()?;
        if let Some(name) = &self.save {
            let saved = shelf.save(&shape(name.clone()), self.existing)?;
            notes.push(format!("saved as {saved}"));
        }
        let Some(file) = file else {
            return Ok(content);
        };
        notes.push(written(&file.path));
        file.persist()?;
        Ok(None)
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
