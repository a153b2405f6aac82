//! Tables in the documents, made from the program's own tables.

use taxel::tui::keys::{Binding, Context, DEFAULT_KEYS};
use taxel::tui::prompt::commands::listed;
use taxel_core::description::{DESCRIPTORS, Dimension};
use taxel_core::parameter::{PARAMETERS, Parameter};
use taxel_core::sensor::Sensor;

pub(crate) fn descriptors() -> String {
    let row = |descriptor: &taxel_core::description::Descriptor| {
        let unit = match descriptor.dimension {
            Dimension::Count | Dimension::Area => "taxels",
            Dimension::Length => "cells",
            Dimension::Direction => "degrees",
            _ => "",
        };
        let (key, symbol, name) = (descriptor.key, descriptor.symbol, descriptor.name);
        format!("| `{key}` | [{symbol}](#{key}) | {name} | {unit} |\n")
    };
    let rows: String = DESCRIPTORS.iter().map(row).collect();
    format!("\n| key | symbol | meaning | unit |\n|---|---|---|---|\n{rows}\n")
}

/// A table for each of these places. The others, such as a question, show all their keys at the bottom of the screen.
pub(crate) fn keys() -> String {
    let places = [
        Context::Matrix,
        Context::Form,
        Context::Explore,
        Context::Imprints,
        Context::Map,
        Context::Recognise,
        Context::Live,
        Context::Everywhere,
    ];
    // The text of the page explains these keys, which do the same in many places.
    let usual = ["Up Down", "PageUp PageDown", "Home End", "?", "F1"];
    let is_usual = |binding: &Binding| {
        let labels = binding.labels();
        let own = [Context::Matrix, Context::Form, Context::Live];
        labels == "?"
            || !own.contains(&binding.context)
                && (usual.contains(&labels.as_str()) || labels.starts_with("Esc"))
    };
    let mut text = String::new();
    for place in places {
        let title = place.title();
        text += &format!("\n### {title}\n\n| key | what it does |\n|---|---|\n");
        let own = DEFAULT_KEYS.iter().filter(|row| row.context == place);
        for row in own.filter(|row| !is_usual(row)) {
            text += &format!("| `{}` | {} |\n", row.labels(), row.help);
        }
    }
    text + "\n"
}

/// The commands after `:`, each with what may follow it and its help.
pub(crate) fn prompt() -> String {
    let live = listed(Context::Live).into_iter();
    let live = live.filter(|own| ["at-least", "size"].contains(&own.line.as_str()));
    let rows = listed(Context::Matrix).into_iter().chain(live);
    let rows = rows.map(|offer| {
        let line = format!("{} {}", offer.line, offer.follows);
        format!(
            "| `:{}` | {} |\n",
            line.trim_end(),
            offer.help.unwrap_or_default()
        )
    });
    let rows: String = rows.collect();
    format!("\n| command | what it does |\n|---|---|\n{rows}\n")
}

/// The parameters that can be set, with their ranges on the paper's sensor.
pub(crate) fn parameters() -> String {
    let row = |row: &taxel_core::parameter::ParameterRow| {
        let (range, unit) = (Sensor::default().range(row.parameter), row.unit.name());
        // The table of parameters has values for these two, which apply once they are switched on. Without the flag
        // there is neither a hole nor a scale.
        let default = match row.parameter {
            Parameter::Thickness | Parameter::Pitch => "none".to_owned(),
            _ => row.default.to_string(),
        };
        let range = format!("{range} {unit}");
        let (key, range) = (row.key, range.trim_end());
        format!("| `{key}` | {} | {range} | {default} |\n", row.meaning)
    };
    let rows: String = PARAMETERS.iter().map(row).collect();
    format!("\n| key | meaning | range on 16 × 16 | default |\n|---|---|---|---|\n{rows}\n")
}
