//! The README's screen and tables are what the program shows. `TAXEL_UPDATE=1 cargo test --test readme` writes them
//! anew.

use taxel::description::descriptor::{DESCRIPTORS, Unit};
use taxel::tui::binding::Context;
use taxel::tui::keymap::KEYMAP;

#[path = "readme/dependencies.rs"]
mod dependencies;
#[path = "../examples/positions.rs"]
#[expect(dead_code, reason = "its main prints the report")]
mod positions;
#[path = "common/screen.rs"]
mod screen;
use screen::{press, session, shows};

const README: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");

/// The paper's Fig. 1.
fn figure() -> String {
    let mut session = session("");
    press(&mut session, "f<3x:Tab>1.99<Tab>1.47<Tab><Tab>2<Enter>");
    shows(&session, &["NA     36"]);
    format!("\n```text\n{}```\n\n", session.screen())
}

fn descriptors() -> String {
    let row = |descriptor: &taxel::description::descriptor::Descriptor| {
        let unit = match descriptor.unit {
            Unit::Count => "taxels",
            Unit::Length => "cell sides",
            Unit::Area => "cells",
            Unit::Direction => "degrees",
            _ => "",
        };
        format!(
            "| `{}` | {} | {} | {unit} |\n",
            descriptor.key, descriptor.symbol, descriptor.name
        )
    };
    let rows: String = DESCRIPTORS.iter().map(row).collect();
    format!("| key | symbol | meaning | unit |\n|---|---|---|---|\n{rows}")
}

fn keys() -> String {
    let mut text = String::new();
    for context in Context::ALL {
        text += &format!("| {} | |\n|---|---|\n", context.title());
        for binding in KEYMAP.iter().filter(|binding| binding.context == context) {
            text += &format!("| `{}` | {} |\n", binding.labels(), binding.help);
        }
        text.push('\n');
    }
    text.trim_end().to_owned() + "\n"
}

/// The script that `tests/scripts.rs` runs.
fn tour() -> String {
    format!("\n```sh\n{}```\n\n", include_str!("scripts/tour.taxel"))
}

#[test]
fn screen_and_tables_are_those_of_the_program() {
    let text = std::fs::read_to_string(README).expect("the README is there");
    let mut wanted = text.clone();
    for (name, block) in [
        ("screen", figure()),
        ("descriptors", descriptors()),
        ("tour", tour()),
        ("keys", keys()),
        ("positions", positions::report()),
        ("dependencies", dependencies::block()),
    ] {
        let (start, end) = (format!("<!-- {name} -->\n"), format!("<!-- /{name} -->"));
        let (before, rest) = wanted.split_once(&start).expect("the README has the mark");
        let (_, after) = rest
            .split_once(&end)
            .expect("the README has the closing mark");
        wanted = format!("{before}{start}{block}{end}{after}");
    }
    if std::env::var_os("TAXEL_UPDATE").is_some() {
        std::fs::write(README, &wanted).expect("the README can be written");
    }
    let text = std::fs::read_to_string(README).expect("the README is there");
    assert!(
        text == wanted,
        "the README is out of date: TAXEL_UPDATE=1 cargo test --test readme"
    );
}

/// The settings that it shows are ones, and say something of everything.
#[test]
fn the_file_of_settings_is_one() {
    let text = std::fs::read_to_string(README).expect("the README is there");
    let (_, rest) = text.split_once("```toml\n").expect("a file of settings");
    let (file, _) = rest.split_once("```").expect("its end");
    let config = taxel::cli::config::Config::read(file).expect("right");
    assert_eq!((config.sensor().len(), config.changes().len()), (4, 2));
}

#[test]
fn the_two_commands_come_first() {
    let text = std::fs::read_to_string(README).expect("the README is there");
    let (run, test) = (text.find("cargo run --release"), text.find("cargo test "));
    assert!(run.is_some() && run < test && test < text.find("## On the command line"));
}
