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
use crate::formats::file::has_ending;
use crate::formats::{ImprintFormat, Name};
use crate::parameter::Parameter;
use crate::storage::Existing;

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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExportFormat {
    Imprint(ImprintFormat),
    Svg,
}

impl ExportFormat {
    fn of(name: &str) -> Option<Self> {
        match name {
            "svg" => Some(Self::Svg),
            name => name.parse().ok().map(Self::Imprint),
        }
    }

    fn of_ending(path: &Path) -> Option<Self> {
        let format = ImprintFormat::of_path(path).map(Self::Imprint);
        format.or_else(|| has_ending(path, "svg").then_some(Self::Svg))
    }
}

pub(crate) fn names() -> Vec<&'static str> {
    let imprints = ImprintFormat::ALL.iter().map(|format| format.name());
    imprints.chain(["svg"]).collect()
}

#[derive(Clone, Debug)]
pub(crate) struct Export {
    /// Its path; None for standard output.
    pub(crate) path: Option<PathBuf>,
    pub(crate) format: ExportFormat,
    pub(crate) existing: Existing,
}

impl Export {
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
                "'{}': expected a name that ends in .txt, .pbm, .csv, .npy or .svg, or a '--format'",
                path.display()
            )
        })?;
        Ok(Self {
            path: (!is_standard).then(|| path.to_owned()),
            format,
            existing,
        })
    }

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

    pub(crate) fn is_drawing(&self) -> bool {
        self.format == ExportFormat::Svg
    }
}
