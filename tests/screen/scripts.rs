//! The program's own screens: the output of each `tests/scripts/NAME.taxel` must equal `NAME.snap` beside it.
//!
//! `INSTA_UPDATE=always cargo test --test screen scripts` rewrites them; then read the difference.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use taxel::tui::app::Options;
use taxel::tui::keys::Keymap;
use taxel::tui::script::runner::{ScriptFailure, ScriptOptions, Shown, run};

use crate::session::world;

fn settings() -> ScriptOptions {
    ScriptOptions {
        options: Options::plain(false),
        size: (80, 24),
        styles: true,
        keymap: Keymap::default(),
        folder: PathBuf::from("tests/scripts"),
        is_confined: false,
        update: false,
    }
}

fn output(script: &str) -> Result<String, ScriptFailure> {
    let settings = settings();
    let mut printed = String::new();
    run(script, &[], &settings, world(), &mut |shown: Shown<'_>| {
        printed.push_str(shown.text);
        ControlFlow::Continue(())
    })
    .map(|()| printed)
}

#[test]
fn every_script_prints_its_screens() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts");
    let files = std::fs::read_dir(&folder)
        .expect("the folder is there")
        .flatten();
    let mut scripts: Vec<_> = files
        .map(|file| file.path())
        .filter(|path| path.extension().is_some_and(|end| end == "taxel"))
        .collect();
    scripts.sort();
    assert!(scripts.len() >= 30, "the scripts are there");
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(&folder);
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    let mut failures = Vec::new();
    for path in scripts {
        let script = std::fs::read_to_string(&path).expect("a script can be read");
        let printed = match output(&script) {
            Ok(printed) => printed,
            Err(failure) => {
                failures.push(format!("{}: {failure}", path.display()));
                continue;
            }
        };
        let name = path
            .file_stem()
            .and_then(|name| name.to_str())
            .expect("a name");
        // Every row ends in a bar, so that no editor removes trailing spaces.
        let shown: String = printed.lines().map(|line| format!("{line}|\n")).collect();
        settings.bind(|| insta::assert_snapshot!(name, shown));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn a_script_gives_the_same_answers_every_time() {
    let script = "Keys f<Enter>smine<Enter><Tab>c\nScreen one\nState\nKeys l\nScreen two\n";
    let first = output(script).expect("it holds");
    assert_eq!(output(script).expect("it holds"), first);
}

/// On a page that hides the cursor, it has no place, not even that of an earlier screen.
#[test]
fn a_hidden_cursor_has_no_place() {
    let script = "Keys f\nScreen\nKeys <Esc>?\nScreen\n";
    let shown = output(script).expect("it holds");
    let screens = shown.lines().filter(|line| line.starts_with("--- screen"));
    assert_eq!(
        screens.collect::<Vec<_>>(),
        [
            "--- screen 80x24 cursor 36,3 ---",
            "--- screen 80x24 no cursor ---"
        ]
    );
}

/// Returns the message of a script that fails.
fn failure(script: &str) -> String {
    let failed = output(script).expect_err("it does not hold");
    failed.to_string()
}

#[test]
fn failed_expectations_and_malformed_commands_are_reported_with_their_line() {
    for (script, message) in [
        (
            "Keys f\nExpect /zzz/",
            "line 2: no /zzz/ on the screen\n  | Enter",
        ),
        ("Quit", "line 1: the program has not ended"),
        ("State /nowhere", "line 1: the state has no \"/nowhere\""),
        (
            "Keys q\nResize 10x10",
            "line 2: the program had already ended",
        ),
        ("\n\nFly", "line 3: \"Fly\" is unknown, expected one of"),
        (
            "Keys <Foo>",
            "line 1: key \"<Foo>\" at character 1 is unknown",
        ),
        (
            "Drag 3,4",
            "line 1: expected two or more positions like 12,5",
        ),
        (
            "Scroll 3,4 2000",
            "line 1: expected a whole number from -1000 to 1000",
        ),
        ("Expect /(/", "line 1: pattern /(/"),
        (
            "Screen\nSize 10x10",
            "line 2: Size, Seed and Set must come before",
        ),
        (
            "Size 80x24\nSet columns 65",
            "line 2: columns: 65 is above 64",
        ),
        (
            "Set shape {}",
            "line 1: Set shape: line 1, column 2: missing key `format`",
        ),
    ] {
        let found = failure(script);
        assert!(found.starts_with(message), "{script:?}: {found}");
    }
    // Reading a pattern of a mebibyte took 138 MiB.
    let long = failure(&format!("Expect /{}/", "a".repeat(20_000)));
    assert!(long.contains("has 20000 bytes"), "{long}");
    let typo = failure("Expct /x/");
    assert!(
        typo.trim_end().ends_with("; did you mean \"Expect\"?"),
        "{typo}"
    );
}

const PAIR: &str = "{\"format\":\"taxel-shape/1\",\"name\":\"pair\",\"sensor\":{\"columns\":4,\"rows\":3},\
                    \"imprint\":[\"....\",\".##.\",\"....\"]}";

/// A script sets the options of the program and the shapes in its library.
#[test]
fn a_script_sets_options_and_shapes() {
    let script = format!(
        "Size 60x20\nSet ascii on\nSet columns 4\nSet rows 3\nSet threshold 0.75\nSet pitch 2\nSet shape {PAIR}\n\
         Expect /column 2, row 1/\nState /document/sensor\nKeys lpair<Enter>\nExpect /pair loaded/\nScreen"
    );
    let printed = output(&script).expect("it holds");
    assert!(printed.is_ascii(), "{printed}");
    let sensor = printed.lines().next().expect("the state");
    for part in [
        "\"columns\":4",
        "\"rows\":3",
        "\"threshold\":0.75",
        "\"pitch_mm\":2",
    ] {
        assert!(sensor.contains(part), "{sensor}");
    }
    let script = format!(
        "Set leftover {PAIR}\nExpect /unsaved work from last time: pair, 2 taxels/\nKeys y\nExpect /restored/\n\
         Expect /NA 2 in all/\nKeys u\nExpect /nothing to undo/"
    );
    output(&script).expect("it holds");
    let both = format!("Set library \"/nowhere\"\nSet shape {PAIR}");
    let told = output(&both).expect_err("it does not hold");
    assert_eq!(
        told.to_string(),
        "line 2: Set library cannot be used with Set shape or Set leftover"
    );
}

/// Output is printed before the script has ended.
#[test]
fn a_script_prints_while_it_runs() {
    let mut printed = 0;
    let stopped = run(
        "Screen\nScreen\nScreen",
        &[],
        &settings(),
        world(),
        &mut |_| {
            printed += 1;
            if printed == 2 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        },
    );
    let told = stopped.expect_err("it was stopped").message;
    assert_eq!(
        (printed, told.as_str()),
        (2, "line 2: the output was closed")
    );
}

/// A screen is compared with a file in the script's folder, below which `--update` writes it.
#[test]
fn a_whole_screen_is_expected() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut settings = settings();
    settings.folder = folder.path().to_owned();
    settings.is_confined = true;
    let mut play = |keys: &str, file: &str, update| {
        settings.update = update;
        let script = format!("Size 60x20\nKeys {keys}\nExpectScreen {file}");
        let ended = run(&script, &[], &settings, world(), &mut |_| {
            ControlFlow::Continue(())
        });
        ended.map_err(|failure| failure.to_string())
    };
    let missing = play("f", "form", false).expect_err("there is none");
    assert!(
        missing
            .starts_with("line 3: form: cannot read: no such file or folder; --update writes it"),
        "{missing}"
    );
    assert_eq!(play("f", "form", true), Ok(()));
    assert_eq!(play("f", "form", false), Ok(()));
    let differs = play("f<Tab>9", "form", false).expect_err("it is another");
    let (told, screens) = differs.split_once('\n').expect("lines");
    assert_eq!(
        told,
        "line 3: the screen is not that of form; --update writes it"
    );
    assert!(
        screens.contains("Radius x  4.00") && screens.contains("Radius x  9"),
        "{screens}"
    );
    let outside = play("f", "../form", true).expect_err("it is outside");
    assert!(
        outside.contains("a script writes only below its folder"),
        "{outside}"
    );
}

/// A wide character covers two columns, and nothing remains visible of the second.
#[test]
fn wide_characters_cover_two_columns() {
    let script = "Keys <Space>sfoobar<Enter>s<C-u>\nType \"字字\"\nKeys <Enter>\n\
                  Expect /saved as 字字/\nExpect /(?m)0.50 · 字字$/";
    output(script).expect("it holds");
}
