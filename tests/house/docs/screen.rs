//! Screens of the program, as text and as drawings, and the tour through the program.

use std::ops::ControlFlow;
use std::path::PathBuf;

use taxel::tui::app::Options;
use taxel::tui::jobs::Jobs;
use taxel::tui::keys::{Key, Keymap, parse};
use taxel::tui::script::runner::{ScriptOptions, Shown, run};
use taxel::tui::widget::{ColorDepth, Palette, Theme};

/// `tests/screen/scripts.rs` runs these scripts, too.
const FIGURE: &str = include_str!("../../scripts/paper_figure.taxel");
const TOUR: &str = include_str!("../../scripts/tour.taxel");
const FIRST_STEPS: &str = include_str!("../../scripts/first_steps.taxel");

/// Returns the screens that a script shows: the name, and a drawing with a title.
fn screens(script: &str, title: impl Fn(&str) -> String) -> Vec<(String, String)> {
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
        keymap: Keymap::default(),
        folder: PathBuf::from("."),
        is_confined: false,
        update: false,
    };
    let world = Jobs::scratch().expect("there is a folder for temporary files");
    let mut screens = Vec::new();
    run(script, &[], &settings, world, &mut |shown: Shown<'_>| {
        if let Some((name, session)) = shown.screen {
            let drawn = session.svg(&title(name));
            screens.push((name.to_owned(), drawn));
        }
        ControlFlow::Continue(())
    })
    .expect("the script holds");
    screens
}

/// The paper's Fig. 1 on the screen.
pub(crate) fn svg() -> String {
    let title = "taxel: the imprint of a ring and its descriptors";
    let last = screens(FIGURE, |_| title.to_owned()).pop();
    last.expect("the script shows a screen").1
}

/// The pages of Explore for the rectangle at every tenth degree, with the names of their files.
pub(crate) fn explore_svgs() -> Vec<(String, String)> {
    const SCRIPT: &str = "
Keys fr<Enter>:explore --angle 0:350:10<Enter>
Expect /360,000 poses/
Keys s<Down>
Screen explore-imprints
Keys 2<4x:Down>
Screen explore-statistics
Keys 3
Screen explore-histogram
Keys 4>>>>>>>>>>
Keys <30x:Right>
Screen explore
Keys ++++
Screen explore-letters
";
    let title = |name: &str| {
        let page = name.strip_prefix("explore-").unwrap_or("map");
        format!("taxel: Explore, the {page} of a rectangle")
    };
    screens(SCRIPT, title)
}

/// The tour as numbered steps. In the script, a comment describes each step; the lines after it give the keys.
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

/// The first steps, each with its picture. The keys are those in the script before its screen.
pub(crate) fn first_steps() -> String {
    let mut text = String::new();
    for (number, step) in (1..).zip(FIRST_STEPS.split("\n\n")) {
        let comments = step.lines().filter_map(|line| line.strip_prefix("# "));
        let said = comments.collect::<Vec<_>>().join("\n");
        let (title, rest) = said.split_once(": ").expect("a step has a title");
        let name = step.lines().find_map(|line| line.strip_prefix("Screen "));
        let before = step.lines().take_while(|line| !line.starts_with("Screen "));
        let keys = before.filter_map(pressed).collect::<Vec<_>>().join(", ");
        text += &format!("\n## {number}. {title}\n\n");
        if let Some((first, others)) = keys.split_at_checked(1) {
            text += &format!("{}{others}.\n\n", first.to_uppercase());
        }
        text += &format!("{rest}\n");
        if let Some(name) = name {
            text += &format!("\n![The screen after this step: {title}]({name}.svg)\n");
        }
    }
    text + "\n"
}

/// The pictures of the first steps, with the names of their files.
pub(crate) fn first_steps_svgs() -> Vec<(String, String)> {
    let title = |name: &str| format!("taxel: {}", name.replace('-', " "));
    screens(FIRST_STEPS, title)
}

/// Describes in words what a line of the script presses or types; None for lines that only check something.
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
