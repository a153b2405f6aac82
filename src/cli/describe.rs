//! `taxel describe`: what is stored under a name or in a file, shown.

use super::arguments::Form;
use super::input::Content;
use super::locale::Charset;
use super::report;

/// The imprint with what describes it. A stored shape says what made it; its pitch counts only where none is given.
pub(super) fn content(content: &Content, form: Form, charset: Charset) -> String {
    let imprint = match content {
        Content::Imprint(imprint) => imprint,
        Content::Shape(shape) => &shape.imprint,
    };
    let Form::Table(pitch) = form else {
        return report::json(imprint);
    };
    let mut made = Vec::new();
    match content {
        Content::Imprint(_) => made.push(report::size(imprint, None, pitch)),
        Content::Shape(shape) => {
            made.push(shape.name.to_string());
            if let Some(source) = &shape.source {
                made.extend(report::made(source, &shape.sensor));
            }
            let stored = Some(shape.sensor.pitch_mm());
            made.push(report::size(imprint, Some(&shape.sensor), pitch.or(stored)));
        }
    }
    report::table(imprint, &made, pitch, charset)
}
