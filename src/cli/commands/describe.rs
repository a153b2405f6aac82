//! `taxel describe`: prints an imprint or a stored shape with its descriptors.

use crate::cli::arguments::form::Form;
use crate::cli::output::charset::Charset;
use crate::cli::output::report;
use crate::formats::Content;

/// Returns the answer: one line of JSON, or the matrix and a table of its regions. For a stored shape, its name,
/// source and sensor come before the table.
pub(crate) fn content(content: &Content, form: Form, charset: Charset) -> String {
    let imprint = content.imprint();
    let Form::Table(pitch) = form else {
        return report::json(imprint);
    };
    let sensor = match content {
        Content::Imprint(_) => None,
        Content::Shape(shape) => Some(&shape.sensor),
    };
    let pitch = pitch.of(sensor);
    let mut made = Vec::new();
    match content {
        Content::Imprint(_) => made.push(report::size(imprint, None, pitch)),
        Content::Shape(shape) => {
            made.push(shape.name.to_string());
            if let Some(source) = &shape.source {
                made.push(source.to_string());
                made.extend(report::beyond(source, &shape.sensor));
            }
            made.push(report::size(imprint, sensor, pitch));
        }
    }
    report::table(imprint, &made, pitch, charset)
}
