//! `--export FILE` and `taxel export`: the file to write, and its format.

use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgMatches, Command, value_parser};

use crate::cli::arguments::flags::{self, misused, of_sensor, option, replace, what};
use crate::cli::arguments::help::EXPORT_EXAMPLES;
use crate::cli::arguments::{form, parameters};
use crate::cli::error::CliError;
use crate::cli::settings::pitch::Pitch;
use crate::cli::settings::resolved::Effective;
use crate::formats::{DrawingFormat, ImprintFormat, Name};
use crate::parameter::Parameter;
use crate::storage::Existing;

/// Defines `taxel export NAME|FILE TO`, such as `taxel export washer washer.svg`. Standard output is `-` with
/// `--format`.
pub(super) fn command() -> Command {
    let to = Arg::new("to")
        .value_name("TO")
        .required(true)
        .value_parser(value_parser!(PathBuf))
        .help("File to write; '-' for standard output");
    Command::new("export")
        .about("Write a shape for other programs, or draw it")
        .after_help(EXPORT_EXAMPLES)
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .arg(to)
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(format())
        .arg(replace())
}

/// Defines `--format`, for file names whose extension does not tell the format.
pub(super) fn format() -> Arg {
    let names = names();
    let help = format!(
        "Format, if not given by the extension: {}",
        names.join(", ")
    );
    option("format", "FORMAT", parameters::wrapped(&help, 52))
        .value_parser(PossibleValuesParser::new(names))
        .hide_possible_values(true)
}

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExportFormat {
    /// The imprint, as text, PBM, CSV or NPY.
    Imprint(ImprintFormat),
    /// A drawing of the imprint with its descriptors.
    Drawing(DrawingFormat),
}

impl ExportFormat {
    /// Returns the format of this name, as in `--format`.
    fn of(name: &str) -> Option<Self> {
        let format = name.parse().map(Self::Imprint);
        format.or_else(|_| name.parse().map(Self::Drawing)).ok()
    }

    /// Returns the format of a file's extension.
    fn of_ending(path: &Path) -> Option<Self> {
        let format = ImprintFormat::of_path(path).map(Self::Imprint);
        format.or_else(|| DrawingFormat::of_path(path).map(Self::Drawing))
    }
}

/// Returns the names of all formats, for `--format`.
pub(crate) fn names() -> Vec<&'static str> {
    let imprints = ImprintFormat::ALL.iter().map(|format| format.name());
    let drawings = DrawingFormat::ALL.iter().map(|format| format.name());
    imprints.chain(drawings).collect()
}

/// A file to write.
#[derive(Clone, Debug)]
pub(crate) struct Export {
    /// Its path; None for standard output.
    pub(crate) path: Option<PathBuf>,
    /// The format that is written.
    pub(crate) format: ExportFormat,
    /// Whether an existing file is replaced.
    pub(crate) existing: Existing,
}

impl Export {
    /// Creates an export to `path`, or to standard output for `-`, in the format named by `format`, or else by the
    /// path's extension.
    ///
    /// # Errors
    /// Returns a message if neither names a format.
    pub(crate) fn new(
        path: &Path,
        format: Option<&str>,
        existing: Existing,
    ) -> Result<Self, String> {
        let format = match format {
            Some(name) => ExportFormat::of(name),
            None => ExportFormat::of_ending(path),
        };
        let is_standard = path.as_os_str() == "-";
        let format = format.ok_or_else(|| {
            if is_standard {
                return "writing to standard output needs '--format'".to_owned();
            }
            format!(
                "'{}': expected a name that ends in .txt, .pbm, .csv, .npy, .svg or .png, or a '--format'",
                path.display()
            )
        })?;
        Ok(Self {
            path: (!is_standard).then(|| path.to_owned()),
            format,
            existing,
        })
    }

    /// Returns the file to write, in the format given by `--format` or by its extension.
    ///
    /// # Errors
    /// Returns an error if the format is not known, and [`CliError::Unused`] for a `--force` that replaces nothing.
    pub(super) fn of(
        matches: &ArgMatches,
        path: &Path,
        command: &mut Command,
        name: &str,
    ) -> Result<Self, CliError> {
        let format = matches.get_one::<String>("format").map(String::as_str);
        let export = Self::new(path, format, flags::existing(matches));
        let export = export.map_err(|message| misused(command, name, &message))?;
        // It may be meant for the shape of --save.
        let saves = matches!(matches.try_get_one::<Name>("save"), Ok(Some(_)));
        if export.path.is_none() && export.existing == Existing::Replaced && !saves {
            let reason = "on standard output".to_owned();
            let flag = "force";
            return Err(CliError::Unused { flag, reason });
        }
        Ok(export)
    }

    /// Returns the pitch for an export.
    ///
    /// # Errors
    /// Returns [`CliError::Unused`] if a flag gives one and nothing is drawn.
    pub(super) fn pitch(
        &self,
        matches: &ArgMatches,
        settings: &Effective,
    ) -> Result<Pitch, CliError> {
        let pitch = form::pitch_of(matches, settings)?;
        if pitch.given.is_some() && !self.is_drawing() {
            let reason = "on this format: it is for drawings".to_owned();
            return Err(CliError::Unused {
                flag: "pitch",
                reason,
            });
        }
        Ok(pitch)
    }

    /// Returns true if it is a drawing.
    pub(crate) fn is_drawing(&self) -> bool {
        matches!(self.format, ExportFormat::Drawing(_))
    }
}
