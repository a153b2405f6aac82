//! The flags that keep the result of a touch: `--save` and `--export`. `figure`, `picture` and `frames` have them.

use std::path::PathBuf;

use clap::{Arg, ArgGroup, ArgMatches, Command, value_parser};

use crate::cli::arguments::export::{self, Export};
use crate::cli::arguments::flags::{existing, force, misused, option};
use crate::cli::arguments::parameters;
use crate::cli::error::CliError;
use crate::formats::Name;
use crate::storage::Existing;

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

pub(super) fn flags() -> [Arg; 4] {
    let save = option("save", "NAME", "Also store the shape in the library")
        .value_parser(Name::new)
        .help_heading("Library");
    let what =
        "Write the imprint, or a drawing of it; '-' for standard output, instead of the table";
    let file = option("export", "FILE", parameters::wrapped(what, 52))
        .value_parser(value_parser!(PathBuf))
        .help_heading("Export");
    let force = force().help("Replace an existing shape or file");
    [
        save,
        file,
        export::format().help_heading("Export").requires("export"),
        force.requires("kept"),
    ]
}

pub(super) fn group() -> ArgGroup {
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
