//! Screens of the program, as text and drawn, and the tour through it.

use std::ops::ControlFlow;

use taxel::formats::Drawing;
use taxel::sensor::Sensor;
use taxel::source::Source;
use taxel::touch::Plane;
use taxel::tui::app::state::Options;
use taxel::tui::keys::key::{Key, parse};
use taxel::tui::keys::keymap::Keymap;
use taxel::tui::runtime::World;
use taxel::tui::script::runner::{ScriptOptions, ScriptOutput, run_shown};
use taxel::tui::widget::theme::{ColorDepth, Palette, Theme};

use crate::common;

/// What `tests/scripts.rs` runs, too.
const FIGURE: &str = include_str!("../../scripts/paper_figure.taxel");
const TOUR: &str = include_str!("../../scripts/tour.taxel");

/// The last screen that a script shows: as text, and drawn under a title.
fn last_screen(script: &str, title: &str) -> (String, String) {
    let settings = ScriptOptions {
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
        folder: None,
    };
    let world = World::scratch().expect("there is a folder for temporary files");
    let (mut text, mut drawn) = (String::new(), String::new());
    run_shown(script, &[], &settings, world, &mut |shown| {
        if let ScriptOutput::Screen(_, session) = shown {
            text = session.screen();
            drawn = session.svg(title);
        }
        ControlFlow::Continue(())
    })
    .expect("the script holds");
    (text, drawn)
}

/// The paper's Fig. 1 on the screen.
pub(crate) fn text() -> String {
    let (text, _) = last_screen(FIGURE, "");
    assert!(text.contains("NA     36"), "{text}");
    format!("\n```text\n{text}```\n\n")
}

/// The same, drawn.
pub(crate) fn svg() -> String {
    last_screen(FIGURE, "taxel: the imprint of a ring and its descriptors").1
}

/// The map of the imprints of a rectangle at 30 degrees.
pub(crate) fn explore_svg() -> String {
    let script = "Keys fr<Enter>e<Enter>4)))\nExpect /3,600,000 poses/\nScreen\n";
    last_screen(script, "taxel: the map of the imprints of a rectangle").1
}

/// The same touch as on the screen, drawn in millimetres.
pub(crate) fn touch_svg() -> String {
    let figure = common::figure(
        "ellipse radius_x=4 radius_y=4 x0=1.99 y0=1.47 thickness=2",
        16,
    );
    let imprint = Plane::new(Sensor::default()).touch(&figure);
    Drawing::new(&imprint)
        .with_outline(&figure)
        .with_pitch(2.5)
        .with_title(&Source::Figure(figure).to_string())
        .svg()
}

/// The tour as numbered steps: each comment of the script says what happens, the lines after it which keys do it.
pub(crate) fn tour() -> String {
    let (mut text, mut number) = (String::from("\n"), 0);
    for step in TOUR.split("\n\n") {
        let comments = step.lines().filter_map(|line| line.strip_prefix("# "));
        let said = comments.collect::<Vec<_>>().join(" ");
        let (title, rest) = said.split_once(": ").expect("a step has a title");
        let keys = step
            .lines()
            .filter_map(pressed)
            .collect::<Vec<_>>()
            .join(", ");
        number += 1;
        text += &format!("{number}. **{title}:** {keys}.<br>\n   {rest}\n");
    }
    text + "\n"
}

/// How people write what a line of the script presses or types; none for lines that only check.
fn pressed(line: &str) -> Option<String> {
    let (command, rest) = line.split_once(' ')?;
    match command {
        "Keys" => {
            let keys = parse(rest).expect("the script can be read");
            Some(format!(
                "press {}",
                keys.into_iter().map(named).collect::<Vec<_>>().join(" ")
            ))
        }
        "Type" => Some(format!("type `{}`", rest.trim_matches('"'))),
        _ => None,
    }
}

fn named(key: Key) -> String {
    let label = key.label();
    let shown = match label.as_str() {
        "Left" => "←",
        "Right" => "→",
        "Up" => "↑",
        "Down" => "↓",
        other => other,
    };
    format!("`{shown}`")
}
