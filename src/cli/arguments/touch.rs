//! The commands that describe one imprint, or one per line: `figure`, `picture`, `describe`, `export` and `batch`; and the
//! flags that keep the result of a touch, `--save` and `--export`.

use std::path::{Path, PathBuf};

use clap::builder::PossibleValuesParser;
use clap::{Arg, ArgGroup, ArgMatches, Command, value_parser};
use taxel_core::figure::FigureKind;
use taxel_core::parameter::Parameter;
use taxel_core::picture::PICTURE_PARAMETERS;
use taxel_core::quote::joined;
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_core::source::Source;
use taxel_files::formats::{ExportFormat, Name};
use taxel_files::storage::Existing;

use crate::cli::arguments::flags::{
    self, Given, existing, force, jobs, json, misused, of_sensor, option, replace, required,
    sensor, sensor_of_imprints, what,
};
use crate::cli::arguments::help::{
    BATCH_EXAMPLES, DESCRIBE_EXAMPLES, EXPORT_EXAMPLES, FIGURE_EXAMPLES, PICTURE_EXAMPLES,
};
use crate::cli::error::CliError;
use crate::cli::settings::resolved::{Effective, Pitch};

/// Defines `taxel figure KIND`, such as `taxel figure ellipse --x0 1.99 --radius-x 4`. There is a flag for each
/// parameter of any kind; [`Given::figure`](flags::Given::figure) refuses those that the given kind does not
/// have. Angles are degrees clockwise as seen, lengths are in cell sides.
pub(super) fn figure() -> Command {
    let kinds = FigureKind::names();
    let kind = Arg::new("kind")
        .value_name("KIND")
        .required(true)
        .value_parser(flags::one_of::<FigureKind, _>(kinds.clone()))
        .hide_possible_values(true)
        .help(flags::wrapped(&joined(kinds, "or"), 64));
    let own = flags::figure_parameters();
    Command::new("figure")
        .about("Touch a figure and describe its imprint")
        .after_help(FIGURE_EXAMPLES)
        .arg(kind)
        .args(own.map(|parameter| flags::arg(parameter).help_heading("Figure")))
        .args(sensor())
        .args(keeping())
        .group(keeping_group())
        .arg(json())
}

pub(super) fn picture() -> Command {
    let own = |parameter: Parameter| flags::arg_with_own(parameter);
    Command::new("picture")
        .about("Move, zoom and turn a stored shape and describe its imprint")
        .after_help(PICTURE_EXAMPLES)
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .args(
            PICTURE_PARAMETERS
                .iter()
                .map(|&parameter| own(parameter).help_heading("Picture")),
        )
        .args(
            SENSOR_PARAMETERS
                .iter()
                .map(|&parameter| own(parameter).help_heading("Sensor")),
        )
        .args(keeping())
        .group(keeping_group())
        .arg(json())
}

pub(super) fn describe() -> Command {
    Command::new("describe")
        .about("Describe an imprint or a stored shape")
        .after_help(DESCRIBE_EXAMPLES)
        .arg(what(
            "Shape of the library, or file; '-' for standard input",
        ))
        .args(of_sensor(&[Parameter::Pitch]))
        .arg(json())
}

pub(super) fn batch() -> Command {
    Command::new("batch")
        .about("Describe poses, one JSON object per line")
        .after_help(BATCH_EXAMPLES)
        .arg(
            Arg::new("file")
                .value_name("FILE")
                .value_parser(value_parser!(PathBuf))
                .help("File of JSON lines; standard input if left out or '-'"),
        )
        .args(sensor_of_imprints())
        .arg(jobs())
}

pub(super) fn source(
    matches: &ArgMatches,
    settings: &Effective,
) -> Result<(Source, Sensor), CliError> {
    let kind = required::<FigureKind>(matches, "kind")?;
    let given = Given::of(matches);
    let sensor = settings.sensor;
    let figure = Source::Figure(given.figure(kind, &sensor)?);
    Ok((figure, sensor))
}

pub(super) fn export() -> Command {
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
        .arg(format_flag())
        .arg(replace())
}

pub(super) fn format_flag() -> Arg {
    let names = names();
    let help = format!(
        "Format, if not given by the extension: {}",
        names.join(", ")
    );
    option("format", "FORMAT", flags::wrapped(&help, 52))
        .value_parser(PossibleValuesParser::new(names))
        .hide_possible_values(true)
}

pub(crate) fn names() -> Vec<&'static str> {
    ExportFormat::ALL.iter().map(|format| format.name).collect()
}

#[derive(Clone, Debug)]
pub(crate) struct Export {
    /// Its path; None for standard output.
    pub(crate) path: Option<PathBuf>,
    pub(crate) format: &'static ExportFormat,
    pub(crate) existing: Existing,
}

impl Export {
    pub(crate) fn new(
        path: &Path,
        format: Option<&str>,
        existing: Existing,
    ) -> Result<Self, String> {
        let format = match format {
            Some(name) => ExportFormat::ALL.iter().find(|format| format.name == name),
            None => ExportFormat::of_path(path),
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
        let export = Self::new(path, format, existing(matches));
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
        let pitch = flags::pitch_of(matches, settings)?;
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
        self.format.name == ExportFormat::SVG
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Kept {
    pub(crate) saving: Option<Saving>,
    pub(crate) export: Option<Export>,
}

#[derive(Clone, Debug)]
pub(crate) struct Saving {
    pub(crate) name: Name,
    pub(crate) existing: Existing,
}

pub(super) fn keeping() -> [Arg; 4] {
    let save = option("save", "NAME", "Also store the shape in the library")
        .value_parser(Name::new)
        .help_heading("Library");
    let what =
        "Write the imprint, or a drawing of it; '-' for standard output, instead of the table";
    let file = option("export", "FILE", flags::wrapped(what, 52))
        .value_parser(value_parser!(PathBuf))
        .help_heading("Export");
    let force = force().help("Replace an existing shape or file");
    [
        save,
        file,
        format_flag().help_heading("Export").requires("export"),
        force.requires("kept"),
    ]
}

pub(super) fn keeping_group() -> ArgGroup {
    ArgGroup::new("kept")
        .args(["save", "export"])
        .multiple(true)
}

impl Kept {
    pub(super) fn of(
        matches: &ArgMatches,
        command: &mut Command,
        name: &str,
    ) -> Result<Self, CliError> {
        let path = matches.get_one::<PathBuf>("export");
        if path.is_some_and(|path| path.as_os_str() == "-") {
            if matches.get_flag("json") {
                let message = "the argument '--json' cannot be used with '--export -': both write to standard output";
                return Err(misused(command, name, message));
            }
            // Only `taxel frames` has this flag.
            if let Ok(Some(true)) = matches.try_get_one::<bool>("all") {
                let message = "the argument '--all' cannot be used with '--export -', which takes one frame; \
                               with a name each frame has a file of its own";
                return Err(misused(command, name, message));
            }
        }
        let export = path.map(|path| Export::of(matches, path, command, name));
        Ok(Self {
            saving: Saving::of(matches),
            export: export.transpose()?,
        })
    }

    pub(crate) fn is_asked(&self) -> bool {
        self.saving.is_some() || self.export.is_some()
    }
}

impl Saving {
    fn of(matches: &ArgMatches) -> Option<Self> {
        let name = matches.get_one::<Name>("save")?.clone();
        let existing = existing(matches);
        Some(Self { name, existing })
    }
}
