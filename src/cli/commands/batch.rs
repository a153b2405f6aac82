//! `taxel batch`: describes poses, one JSON object per line.

use std::io;
use std::path::PathBuf;

use taxel_core::touch::Plane;
use taxel_files::formats::{DescribedImprint, Job};

use crate::cli::Context;
use crate::cli::arguments::flags::whole;
use crate::cli::arguments::parameters::SensorFlags;
use crate::cli::failure::Failure;
use crate::cli::input::content::Input;
use crate::cli::input::lines;

const EXAMPLES: &str = r###"Each line is a JSON object:
  {"figure":"hexagon","side":3,"x0":2.1,"y0":1.35,"angle":17,"thickness":1}
  {"picture":["##","#."],"x0":5,"y0":3,"angle":10,"zoom_x":1.5,"zoom_y":1}
  {"picture":"washer","x0":2,"y0":2,"angle":0,"zoom_x":1,"zoom_y":1}
  {"outline":[[[0,0],[9,0],[9,4],[0,4]],{"cx":2,"cy":2,"rx":1,"ry":1}],
   "x0":5,"y0":3,"angle":10}
  {"imprint":[".##.","#..#",".##."]}
  {"frame":[[0,3,8],[1,9,12]],"at_least":5}
Sizes, position, angle and zooms have no defaults here, unlike the flags of
other commands; a figure without "thickness" is solid. Give a picture by its
rows or by its name in the library; a shape stored with its outline is touched as
that. An outline has rings, here written over two lines: lists of points, and
ellipses. All of these may have a sensor of their own:
  "sensor":{"columns":32,"rows":32,"threshold":0.5,"pitch_mm":2.5}
With "unit":"mm", the sizes of a figure and the rings of an outline are in mm and
are divided by that pitch_mm, or by --pitch; x0 and y0 are in cells.
A frame holds the values of a sensor, row by row. Its threshold is
"at_least":VALUE, "percent":P or "low":VALUE,"high":VALUE; "least":TAXELS drops
pieces of fewer taxels.

Each answer is one line, in the order of the input. If a line is wrong or longer
than 1 MiB, its answer is {"error":"line 3: ..."}, the other lines are still
answered, and the exit status is 1. Blank lines are skipped. Whenever the input
pauses, all answers so far are written.

Examples:
  taxel batch poses.jsonl > answers.jsonl
  echo '{"imprint":["##","#."]}' | taxel batch"###;

/// Describe poses, one JSON object per line
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Batch {
    /// File of JSON lines; standard input if left out or '-'
    #[arg(value_name = "FILE", default_value = "-", hide_default_value = true)]
    file: PathBuf,
    #[command(flatten)]
    sensor: SensorFlags,
    /// Threads; default all cores
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..=1024))]
    jobs: Option<u16>,
}

impl Batch {
    pub(crate) fn run(self, cx: &Context) -> Result<(), Failure> {
        let sensor = self.sensor.sensor(cx.settings.sensor.sensor)?;
        let pitch = self.sensor.pitch(&cx.settings)?;
        let lookup = |name: &str| {
            let source = cx.shelf.source(name).map_err(|error| error.to_string())?;
            let source = source.at_pitch(pitch.given);
            source.map_err(|error| error.to_string())
        };
        let input = Input::open(&self.file)?;
        let jobs = self.jobs.unwrap_or(0).into();
        lines::answer_all(jobs, input, io::stdout().lock(), "pose", || {
            let (mut plane, mut other) = (Plane::new(sensor), Plane::new(sensor));
            move |line: &[u8], answer: &mut Vec<u8>| {
                let job = Job::read(line, sensor, pitch.of(None), &lookup)
                    .map_err(|error| error.to_string())?;
                let plane = match &job {
                    // A line with a sensor of its own does not replace the plane of the others.
                    Job::Touch(own, _) if *own != sensor => &mut other,
                    _ => &mut plane,
                };
                serde_json::to_writer(answer, &DescribedImprint(&job.imprint(plane)))
                    .map_err(|error| error.to_string())
            }
        })
    }
}
