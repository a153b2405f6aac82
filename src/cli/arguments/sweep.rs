//! The commands `sweep` and `merge`, which write the same files.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::builder::{OsStringValueParser, TypedValueParser};
use clap::{Arg, ArgGroup, ArgMatches, Command, value_parser};
use taxel_core::figure::FigureKind;
use taxel_core::pose::{Anchor, Axis, GivenRanges};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::Shard;
use taxel_files::memory::MemorySize;
use taxel_files::storage::{Existing, atlas_path};

use crate::cli::arguments::flags::{
    self, Given, anchor, jobs, json, memory, misused, name_or_path, npy, option, quiet, range,
    replace, sensor_of_imprints, shard,
};
use crate::cli::arguments::help::{MERGE_EXAMPLES, SWEEP_EXAMPLES};
use crate::cli::arguments::touch;
use crate::cli::error::CliError;
use crate::cli::settings::resolved::Effective;

#[derive(Clone, Debug)]
pub(crate) struct SweepArguments {
    pub(crate) what: Swept,
    pub(crate) anchor: Anchor,
    pub(crate) ranges: GivenRanges,
    pub(crate) shard: Shard,
    pub(crate) jobs: usize,
    pub(crate) wanted: Wanted,
}

#[derive(Clone, Debug)]
pub(crate) struct Wanted {
    pub(crate) atlas: Option<PathBuf>,
    pub(crate) poses: Option<PathBuf>,
    pub(crate) existing: Existing,
    pub(crate) json: bool,
    pub(crate) quiet: bool,
    pub(crate) memory: Option<MemorySize>,
}

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of these at a time")]
pub(crate) enum Swept {
    Figure(Source, Sensor),
    Picture(OsString, Given),
}

/// Defines `taxel sweep KIND` and `taxel sweep --picture NAME|FILE`. Axes are ranges here, not numbers:
/// `--x0 5:5.99:0.01`. Their flags have the names of parameters, so these parameters are left out of the flags of
/// sizes.
pub(super) fn command() -> Command {
    let kind = Arg::new("kind")
        .value_name("KIND")
        .value_parser(flags::one_of::<FigureKind, _>(FigureKind::names()))
        .hide_possible_values(true)
        .help("Kind of figure, as in 'taxel figure'; or --picture");
    let picture =
        option("picture", "NAME|FILE", "Sweep a stored shape instead").value_parser(name_or_path());
    let sizes = flags::figure_parameters()
        .filter(|&parameter| Axis::ALL.iter().all(|axis| axis.parameter() != parameter));
    let poses = option("poses", "FILE.npy", "Write which imprint each pose leaves")
        .value_parser(npy())
        .conflicts_with("shard");
    Command::new("sweep")
        .about("Find every imprint that a shape can leave")
        .after_help(SWEEP_EXAMPLES)
        .arg(kind)
        .arg(picture)
        .group(
            ArgGroup::new("shape")
                .args(["kind", "picture"])
                .required(true),
        )
        .args(sizes.map(|parameter| flags::arg(parameter).help_heading("Figure")))
        .args(Axis::ALL.map(|axis| match axis {
            Axis::X0 | Axis::Y0 => range(axis, "one cell in which nothing is cut off"),
            _ => range(axis, ""),
        }))
        .arg(anchor())
        .args(sensor_of_imprints())
        .args([
            atlas(),
            poses,
            replace().requires("files"),
            jobs(),
            memory(),
            shard(),
            json(),
            quiet(),
        ])
        .group(
            ArgGroup::new("files")
                .args(["atlas", "poses"])
                .multiple(true),
        )
}

/// Defines `taxel merge FILE.npz…`. Shards of a training are merged by the same command, such as
/// `taxel merge part-*.npz --out whole.npz`; the content of the files decides.
pub(super) fn merge_command() -> Command {
    let files = Arg::new("files")
        .value_name("FILE.npz")
        .required(true)
        .num_args(1..)
        .value_parser(value_parser!(PathBuf))
        .help("Atlases or models of all shards, in any order");
    Command::new("merge")
        .about("Merge the shards of a sweep or a training")
        .after_help(MERGE_EXAMPLES)
        .args([
            files,
            atlas()
                .long("out")
                .alias("atlas")
                .help("Write the atlas (.csv, .jsonl, .npz) or the model\n(.npz); --atlas means the same")
                .required(true),
            replace(),
            memory(),
            json(),
            quiet(),
        ])
}

/// Defines `--atlas`, the file that a sweep or a merge writes. Its extension decides the format, so there is no flag
/// for this; only `.npz` can be read again.
fn atlas() -> Arg {
    option(
        "atlas",
        "FILE",
        "Write the atlas, a list of all imprints found, as\n.csv, .jsonl or .npz",
    )
    .value_parser(OsStringValueParser::new().try_map(atlas_path))
}

impl SweepArguments {
    pub(super) fn of(
        matches: &ArgMatches,
        command: &mut Command,
        settings: &Effective,
    ) -> Result<Self, CliError> {
        let given = Given::of(matches);
        let what = if let Some(picture) = matches.get_one::<OsString>("picture") {
            let size = flags::figure_parameters().find(|&parameter| given.has(parameter));
            if let Some(size) = size {
                let message = format!("'--{}' does not belong to a picture", size.flag());
                return Err(misused(command, "sweep", &message));
            }
            Swept::Picture(picture.clone(), given)
        } else {
            let (figure, sensor) = touch::source(matches, settings)?;
            Swept::Figure(figure, sensor)
        };
        let anchor = matches.get_one::<Anchor>("anchor").copied();
        Ok(Self {
            what,
            anchor: anchor.unwrap_or_default(),
            ranges: flags::ranges_of(matches),
            shard: flags::shard_of(matches),
            jobs: flags::jobs_of(matches),
            wanted: Wanted::of(matches),
        })
    }
}

impl Wanted {
    pub(super) fn of(matches: &ArgMatches) -> Self {
        let poses = matches.try_get_one::<PathBuf>("poses");
        Self {
            atlas: matches.get_one::<PathBuf>("atlas").cloned(),
            poses: poses.ok().flatten().cloned(),
            existing: flags::existing(matches),
            json: matches.get_flag("json"),
            quiet: matches.get_flag("quiet"),
            memory: flags::memory_of(matches),
        }
    }
}
