//! `taxel batch`: answers lines of JSON with lines of JSON, in the same order.
//! ```text
//! {"imprint":["##","#."]}   ->   {"imprint":["##","#."],"na":3,"regions":[…]}
//! {"figure":"hexagonal"}    ->   {"error":"line 2: …"}
//! ```

use std::io::Write;

use crate::cli::error::CliError;
use crate::cli::input::lines::{self, LineInput};
use crate::formats::{DescribedImprint, Job};
use crate::imprint::Imprint;
use crate::quote::shortened_message;
use crate::sensor::Sensor;
use crate::touch::Plane;

pub(crate) fn answer_lines(
    sensor: Sensor,
    jobs: usize,
    lookup: &(dyn Fn(&str) -> Result<Imprint, String> + Sync),
    input: LineInput,
    output: impl Write,
) -> Result<(), CliError> {
    lines::answer_all(jobs, input, output, "pose", || {
        let (mut plane, mut other) = (Plane::new(sensor), Plane::new(sensor));
        move |line: &[u8], answer: &mut Vec<u8>| {
            let job = Job::read(line, sensor, lookup);
            let job = job.map_err(|error| shortened_message(&error.to_string()))?;
            let plane = match &job {
                // A line with a sensor of its own does not replace the plane of the others.
                Job::Touch(own, _) if *own != sensor => &mut other,
                _ => &mut plane,
            };
            let imprint = job.imprint(plane);
            serde_json::to_writer(answer, &DescribedImprint(&imprint))
                .map_err(|error| error.to_string())
        }
    })
}
