//! `taxel batch`: answers lines of JSON with lines of JSON, in the same order.
//! ```text
//! {"imprint":["##","#."]}   ->   {"imprint":["##","#."],"na":3,"regions":[…]}
//! {"figure":"hexagonal"}    ->   {"error":"line 2: …"}
//! ```

use std::io::{Read, Write};

use crate::cli::error::CliError;
use crate::cli::input::lines;
use crate::formats::{DescribedImprint, Job};
use crate::imprint::Imprint;
use crate::quote::legible;
use crate::sensor::Sensor;
use crate::touch::Plane;

/// Answers each line of `input`. `sensor` is for lines without one; `lookup` finds pictures given by name.
///
/// # Errors
/// Those of [`lines::answer_each`].
pub(crate) fn answer_lines(
    sensor: Sensor,
    lookup: &dyn Fn(&str) -> Result<Imprint, String>,
    input: impl Read,
    output: impl Write,
) -> Result<(), CliError> {
    let mut plane = Plane::new(sensor);
    lines::answer_each(input, output, "pose", |line, answer| {
        let job = Job::read(line, sensor, lookup);
        let imprint = job
            .map_err(|error| legible(&error.to_string()))?
            .imprint(&mut plane);
        serde_json::to_writer(answer, &DescribedImprint(&imprint))
            .map_err(|error| error.to_string())
    })
}
