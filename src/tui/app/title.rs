//! The title of the matrix screen: the sensor, and the name of what is on the matrix.
//!
//! ```text
//! 32 × 32 · threshold 0.30 · pitch 2.5 mm · washer*      the pitch where one is set; * for changes that are not saved
//! 16 × 16 · threshold 0.50 · recording                   frames are being recorded
//! ```
//! It has no styles, so that it costs few bytes.

use crate::parameter::Parameter;
use crate::sensor::Sensor;
use crate::tui::app::change::is_other;
use crate::tui::app::state::App;
use crate::tui::live::update::recording;

pub fn title(app: &App) -> String {
    let sensor = &app.shown().sensor;
    let pitch = sensor.pitch_mm();
    let is_set = pitch != sensor.default_value(Parameter::Pitch);
    // The page of the recording is closed or covered.
    let is_recording = recording(app).is_some();
    let parts = [
        Some(sensor.size().to_string()),
        Some(format!("threshold {}", threshold(sensor))),
        is_set.then(|| format!("pitch {pitch} mm")),
        name(app),
        is_recording.then(|| "recording".to_owned()),
    ];
    // In ASCII a dot would be an asterisk, and that is the mark of changes.
    let between = if app.theme().ascii { ", " } else { " · " };
    parts
        .into_iter()
        .flatten()
        .collect::<Vec<_>>()
        .join(between)
}

/// Returns the name of the document on the matrix, with `*` if it was changed since it was saved. None if it has no
/// name, and if a form shows something else in place of it.
pub(in crate::tui) fn name(app: &App) -> Option<String> {
    let stored = app.stored_name()?;
    if !app.dialogs.is_empty() && is_other(app, app.shown()) {
        return None;
    }
    let changed = if app.is_changed() { "*" } else { "" };
    Some(format!("{stored}{changed}"))
}

fn threshold(sensor: &Sensor) -> String {
    let (exact, short) = (
        sensor.threshold().to_string(),
        format!("{:.2}", sensor.threshold()),
    );
    if exact.len() > short.len() {
        exact
    } else {
        short
    }
}
