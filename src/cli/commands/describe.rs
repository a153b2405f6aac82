//! `taxel describe`: describes an imprint or a stored shape.

use std::ffi::OsString;

use taxel_files::formats::Content;

use crate::cli::arguments::flags::name_or_path;
use crate::cli::arguments::parameters::PitchFlag;
use crate::cli::output::report;
use crate::cli::settings::Pitch;
use crate::cli::{Context, Failure};

const EXAMPLES: &str = "\
An imprint is text with one line per row, '#' for an active taxel and '.' for an
inactive one; or a table of numbers (CSV) or a numpy array (NPY). In a table or an array, inactive taxels are 0, and active ones 1 or 255.
An imprint has at most 64 x 64 taxels. taxel recognises the format from the
content, not from the extension. A stored shape is a JSON file. If a stored
shape and a file have the same name, taxel uses the shape.

Examples:
  taxel describe washer
  taxel describe imprint.txt --pitch 2.5
  taxel describe ./washer.json --json
  printf '.##.\\n#..#\\n.##.\\n' | taxel describe -";

/// Describe an imprint or a stored shape
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Describe {
    /// Shape of the library, or file; '-' for standard input
    #[arg(value_name = "NAME|FILE", value_parser = name_or_path())]
    what: OsString,
    #[command(flatten)]
    pitch: PitchFlag,
    /// Print JSON, one line per answer
    #[arg(long)]
    json: bool,
}

impl Describe {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let pitch = self.pitch.pitch(&cx.settings)?;
        let content = cx.shelf.find(&self.what)?;
        cx.print(&described(&content, self.json, pitch))
    }
}

/// Returns one line of JSON, or the matrix and a table of its regions. For a stored shape, its name, source and sensor
/// come before the table.
pub(crate) fn described(content: &Content, json: bool, pitch: Pitch) -> String {
    let imprint = content.imprint();
    if json {
        return report::json(imprint);
    }
    let mut made = Vec::new();
    let mut own = None;
    if let Content::Shape(shape) = content {
        own = Some(&shape.sensor);
        made.push(shape.name.to_string());
        if let Some(source) = &shape.source {
            made.push(source.to_string());
            made.extend(report::beyond(source, &shape.sensor));
        }
    }
    let pitch = pitch.of(own);
    made.push(report::size(imprint, own, pitch));
    report::table(imprint, &made, pitch)
}
