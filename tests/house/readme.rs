//! The README's screen and tables are what the program shows. `TAXEL_UPDATE=1 cargo test --test house readme` writes them
//! anew.

use std::ops::ControlFlow;

use taxel::description::{DESCRIPTORS, Dimension};
use taxel::figure::{Figure, FigureKind};
use taxel::formats::Drawing;
use taxel::parameter::Parameter;
use taxel::sensor::Sensor;
use taxel::source::Source;
use taxel::touch::Plane;
use taxel::tui::app::state::Options;
use taxel::tui::keys::binding::Context;
use taxel::tui::keys::default_keys::DEFAULT_KEYS;
use taxel::tui::keys::keymap::Keymap;
use taxel::tui::runtime::perform::World;
use taxel::tui::script::runner::{Settings, Shown, run_shown};
use taxel::tui::widget::theme::{ColorDepth, Palette, Theme};

use crate::dependencies;
use crate::examples::positions;

const README: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");

/// The paper's Fig. 1 on the screen, by a script: as text, and drawn.
fn screen() -> (String, String) {
    let settings = Settings {
        options: Options {
            theme: Theme {
                depth: ColorDepth::True,
                palette: Palette::Dark,
                ..Theme::plain(false)
            },
            ..Options::plain(false)
        },
        size: (80, 24),
        styles: false,
        json: false,
        keymap: Keymap::default(),
    };
    let world = World::scratch().expect("there is a folder for temporary files");
    let (mut text, mut drawn) = (String::new(), String::new());
    let script = include_str!("../scripts/paper_figure.taxel");
    run_shown(script, &[], &settings, world, &mut |shown| {
        if let Shown::Screen(_, session) = shown {
            text = session.screen();
            drawn = session.svg("taxel: the imprint of a ring and what describes it");
        }
        ControlFlow::Continue(())
    })
    .expect("the script holds");
    assert!(text.contains("NA     36"), "{text}");
    (format!("\n```text\n{text}```\n\n"), drawn)
}

/// The same touch, drawn in millimetres.
fn touch() -> String {
    let figure = Figure::default_of(FigureKind::Ellipse, 16);
    let figure = [
        (Parameter::X0, 1.99),
        (Parameter::Y0, 1.47),
        (Parameter::Thickness, 2.0),
    ]
    .into_iter()
    .try_fold(figure, |figure, (parameter, value)| {
        figure.with(parameter, value, 16)
    })
    .expect("in range");
    let imprint = Plane::new(Sensor::default()).touch(&figure);
    Drawing::new(&imprint)
        .with_outline(&figure)
        .with_pitch(2.5)
        .with_title(&Source::Figure(figure).to_string())
        .svg()
}

#[test]
fn pictures_are_those_of_the_program() {
    for (name, drawn) in [("screen.svg", screen().1), ("touch.svg", touch())] {
        let path = format!("{}/docs/{name}", env!("CARGO_MANIFEST_DIR"));
        if std::env::var_os("TAXEL_UPDATE").is_some() {
            std::fs::write(&path, &drawn).expect("the picture can be written");
        }
        let there = std::fs::read_to_string(&path).expect("the picture is there");
        assert!(
            there == drawn,
            "docs/{name} is out of date: TAXEL_UPDATE=1 cargo test --test house readme"
        );
    }
}

fn descriptors() -> String {
    let row = |descriptor: &taxel::description::Descriptor| {
        let unit = match descriptor.dimension {
            Dimension::Count => "taxels",
            Dimension::Length => "cell sides",
            Dimension::Area => "cells",
            Dimension::Direction => "degrees",
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

/// All places, those beside the matrix folded together.
fn keys() -> String {
    let mut text = String::new();
    for context in Context::ALL {
        text += &format!("| {} | |\n|---|---|\n", context.title());
        for binding in DEFAULT_KEYS
            .iter()
            .filter(|binding| binding.context == context)
        {
            text += &format!("| `{}` | {} |\n", binding.labels(), binding.help);
        }
        text.push('\n');
        if context == Context::Matrix {
            text += "<details><summary>In every other place</summary>\n\n";
        }
    }
    text + "</details>\n"
}

/// The script that `tests/screen/scripts.rs` runs.
fn tour() -> String {
    format!("\n```sh\n{}```\n\n", include_str!("../scripts/tour.taxel"))
}

#[test]
fn screen_and_tables_are_those_of_the_program() {
    let text = std::fs::read_to_string(README).expect("the README is there");
    let mut wanted = text.clone();
    for (name, block) in [
        ("screen", screen().0),
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
        "the README is out of date: TAXEL_UPDATE=1 cargo test --test house readme"
    );
}

/// The settings that it shows are ones, and say something of everything.
#[test]
fn the_file_of_settings_is_one() {
    let text = std::fs::read_to_string(README).expect("the README is there");
    let (_, rest) = text.split_once("```toml\n").expect("a file of settings");
    let (file, _) = rest.split_once("```").expect("its end");
    let config = taxel::cli::settings::file::Config::read(file).expect("right");
    assert_eq!((config.sensor().len(), config.changes().len()), (4, 2));
}

#[test]
fn the_two_commands_come_first() {
    let text = std::fs::read_to_string(README).expect("the README is there");
    let (run, test) = (text.find("cargo run --release"), text.find("cargo test "));
    assert!(run.is_some() && run < test && test < text.find("## On the command line"));
}
