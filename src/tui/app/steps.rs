//! Describes in words what a step of the history did. The words follow from the documents before and after it and are
//! not stored.

use crate::formats::value::counted;
use crate::parameter::Parameter;
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::source::Source;
use crate::touch::Plane;
use crate::tui::app::document::Document;

pub fn difference(from: &Document, to: &Document) -> String {
    let sensor = of_sensor(&from.sensor, &to.sensor);
    let mut parts = vec![sensor, of_source(from.source.as_ref(), to.source.as_ref())];
    let fits = from.edits.columns() == to.edits.columns() && from.edits.rows() == to.edits.rows();
    if parts.iter().all(String::is_empty) && is_emptied(from, to) {
        parts.push("emptied".to_owned());
    }
    // A new source starts without edits, so this is not mentioned.
    if fits && parts.iter().all(String::is_empty) {
        parts.push(of_edits(from, to));
    }
    parts.retain(|part| !part.is_empty());
    parts.join(", ")
}

fn is_emptied(from: &Document, to: &Document) -> bool {
    let is_empty = to.source.is_none() && to.edits.is_empty();
    is_empty && (from.source.is_some() || from.edits.count() > 1)
}

fn of_sensor(from: &Sensor, to: &Sensor) -> String {
    let value = |sensor: &Sensor, parameter| sensor.get(parameter);
    values(SENSOR_PARAMETERS, |p| value(from, p), |p| value(to, p))
}

/// Returns the changes of the source: its values if it is the same kind of figure or the same picture, otherwise the
/// whole new source. Empty if there is no source any more.
fn of_source(from: Option<&Source>, to: Option<&Source>) -> String {
    match (from, to) {
        (_, None) => String::new(),
        (Some(from), Some(to)) if alike(from, to) => {
            values(to.parameters(), |p| from.get(p), |p| to.get(p))
        }
        (_, Some(to)) => to.to_string(),
    }
}

fn alike(from: &Source, to: &Source) -> bool {
    match (from, to) {
        (Source::Figure(from), Source::Figure(to)) => from.kind() == to.kind(),
        (Source::Picture(from), Source::Picture(to)) => from.imprint() == to.imprint(),
        _ => false,
    }
}

fn values(
    parameters: &[Parameter],
    from: impl Fn(Parameter) -> Option<f64>,
    to: impl Fn(Parameter) -> Option<f64>,
) -> String {
    let text = |parameter: Parameter, value: Option<f64>| {
        value.map_or("none".to_owned(), |value| parameter.format(value))
    };
    let changed = parameters.iter().filter(|&&p| from(p) != to(p));
    let changed = changed.map(|&parameter| {
        let (before, after) = (from(parameter), to(parameter));
        let label = parameter.row().label;
        format!(
            "{label} {} → {}",
            text(parameter, before),
            text(parameter, after)
        )
    });
    changed.collect::<Vec<_>>().join(", ")
}

fn of_edits(from: &Document, to: &Document) -> String {
    let switched = from.edits.differing(&to.edits);
    match (switched.count(), switched.active().next()) {
        (0, _) | (_, None) => String::new(),
        (1, Some((column, row))) => {
            let touched = to.source.as_ref().is_some_and(|source| {
                let touched = Plane::new(to.sensor).touch(source);
                touched.get(column, row)
            });
            let is_on = touched != to.edits.get(column, row);
            let state = if is_on { "on" } else { "off" };
            format!("taxel {column}, {row} {state}")
        }
        (count, _) => format!("{} switched", counted(count, "taxel")),
    }
}
