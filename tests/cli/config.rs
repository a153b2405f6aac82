//! The settings file and the keys that it changes: refusals with their places, and the resulting screen.

use taxel::cli::settings::file::Config;
use taxel::tui::app::message::{Message, Mouse, MouseKind};
use taxel::tui::app::state::{App, Options};
use taxel::tui::keys::keymap::{Context, DEFAULT_KEYS};
use taxel::tui::runtime::World;
use taxel::tui::script::Session;

#[test]
fn an_empty_settings_file_is_valid() {
    for text in ["", "\n# nothing\n", "[sensor]\n[keys]\n[keys.matrix]\n"] {
        let config = Config::read(text).expect("a file of settings");
        assert!(config.sensor_entries().is_empty() && config.changes().is_empty());
    }
}

#[test]
fn wrong_settings_are_refused_with_their_places() {
    let unknown = "expected one of theme, color, charset, mouse, library, sensor, source, frames, keys; did you mean \"color\"?";
    let key = "is not a key that can be bound, expected one such as x, <Tab> or <C-x>";
    let actions = "expected an action that 'taxel config' lists, or \"none\", found";
    let rules =
        "expected one threshold: at_least, percent, or low and high, found at_least and percent";
    for (text, place, expected) in [
        (
            "# a comment\n  colour = 'never'\n",
            "2, column 3",
            format!("unknown key \"colour\", {unknown}").as_str(),
        ),
        (
            "theme = 'blue'",
            "1, column 9",
            "expected one of \"auto\", \"dark\", \"light\", \"mono\", found \"blue\"",
        ),
        (
            "theme = 3",
            "1, column 9",
            "expected text in quotes, found integer",
        ),
        (
            "mouse = 'no'",
            "1, column 9",
            "expected true or false, found string",
        ),
        (
            "library = 'shapes'",
            "1, column 11",
            "expected a path that starts with / or ~/, found \"shapes\"",
        ),
        (
            "sensor = 16",
            "1, column 10",
            "expected a table, found integer",
        ),
        (
            "[sensor]\ncolumns = 16\nzoom = 2\n",
            "3, column 1",
            "unknown key \"zoom\", expected one of columns, rows, threshold, pitch",
        ),
        (
            "[source]\nbaud = 12\n",
            "2, column 8",
            "expected a whole number from 50 to 20000000, found \"12\"",
        ),
        (
            "[source]\nrows = 16\n",
            "2, column 1",
            "expected rows and columns together, found rows",
        ),
        (
            "[frames]\npercent = 5\nat_least = 9\n",
            "2, column 1",
            rules,
        ),
        (
            "[frames]\npercent = 0\n",
            "2, column 11",
            "expected a number above 0, up to 100, found \"0\"",
        ),
        (
            "[frames]\nlow = 5\nhigh = 4\n",
            "2, column 1",
            "expected a number at most that of high, found low",
        ),
        (
            "[sensor]\nrows = 65\n",
            "2, column 8",
            "rows: 65 is above 64 (allowed: 1 to 64)",
        ),
        (
            "[sensor]\npitch = nan\n",
            "2, column 9",
            "pitch_mm: NaN is not a number (allowed: above 0, up to 1000)",
        ),
        (
            "[sensor]\ncolumns = 0x10\n",
            "2, column 11",
            "expected a decimal number, found \"0x10\"",
        ),
        (
            "[frames]\nleast = 1e308\n",
            "2, column 9",
            "expected a whole number from 1 to 4096, found \"1e308\"",
        ),
        (
            "[keys.matrix]\nxy = 'toggle'\n",
            "2, column 1",
            &format!("\"xy\" {key}"),
        ),
        (
            "[keys.matrix]\nx = 'togle'\n",
            "2, column 5",
            &format!("{actions} \"togle\"; did you mean \"toggle\"?"),
        ),
        (
            "theme = 'dark'\ntheme = 'light'\n",
            "2, column 1",
            "key \"theme\" is given twice",
        ),
        (
            "[keys.matrix]\n'<CR>' = 'toggle'\n'<Enter>' = 'undo'\n",
            "3, column 1",
            "<Enter> is bound twice here",
        ),
    ] {
        let error = Config::read(text).expect_err(text).to_string();
        assert_eq!(error, format!("line {place}: {expected}"), "{text}");
    }
    for text in ["theme = \n", "é = 1 =\n", "[sensor\n", "x = 'a\n"] {
        let error = Config::read(text).expect_err(text).to_string();
        assert!(error.starts_with("line 1, "), "{text}: {error}");
    }
}

/// Messages are short enough to read, whatever the file contains.
#[test]
fn messages_are_short() {
    let long = "x".repeat(100_000);
    for text in [
        format!("{long} = 1"),
        format!("theme = '{long}'"),
        format!("[keys.matrix]\n{long} = 'toggle'"),
        format!("[keys.{long}]\nx = 'toggle'"),
        format!("theme = {long}"),
        "[".repeat(100_000),
    ] {
        let error = Config::read(&text).expect_err("nonsense").to_string();
        assert!(error.chars().count() < 1000, "{}", error.len());
    }
}

fn session(config: &str, keys: &str) -> Session {
    let config = Config::read(config).expect("a file of settings");
    let app = App::new(&Options::plain(false)).with_keymap(config.keymap().clone());
    let world = World::scratch().expect("a folder");
    let mut session = Session::of(app, world, 80, 24);
    session.keys(keys).expect("the keys of a test are right");
    session
}

#[test]
fn keys_and_hints_are_those_of_the_settings_file() {
    let config = "[keys.matrix]\nx = 'toggle'\n'<C-n>' = 'new'\nn = 'none'\nh = 'cursor-left'\n'?' = 'undo'\nK = 'help'\nm = 'none'\n[keys.form]\n'<C-n>' = 'next'\n";
    for (keys, texts) in [
        (
            "",
            &["Ctrl-N New   l Load", "q Quit   K Help", "x toggle  "][..],
        ),
        ("x", &["NA 1 in all", "x toggle  ? undo"]),
        ("x<Space>", &["NA 0 in all"]),
        ("hx", &["column  7, row  8    active"]),
        ("x?", &["NA 0 in all"]),
        ("x<C-n>", &["NA 0 in all"]),
        ("xn", &["NA 1 in all"]),
        ("f<C-n>2<Enter>", &["rx 2.00"]),
        (
            "K",
            &[
                "Ctrl-N                  New: empty the matrix",
                "h arrows                move the cursor",
            ],
        ),
        ("f", &["Ctrl-N field"]),
    ] {
        let screen = session(config, keys).screen();
        for text in texts {
            assert!(screen.contains(text), "{keys}: no {text:?} on\n{screen}");
        }
    }
}

#[test]
fn an_option_without_a_key_can_still_be_clicked() {
    let mut session = session("[keys.matrix]\nf = 'none'\n", "f");
    assert!(session.screen().contains("l Load   Figure   p Picture"));
    let column = session.screen().find("Figure").expect("an option");
    let column = u16::try_from(column).expect("on the screen");
    for kind in [MouseKind::Press, MouseKind::Release] {
        session.send(Message::Mouse(Mouse {
            kind,
            column,
            row: 0,
        }));
    }
    assert!(session.screen().contains("Kind"), "{}", session.screen());
}

#[test]
fn the_settings_file_can_name_every_context_and_action() {
    for context in Context::all() {
        for action in context.actions() {
            let (place, name) = (context.name(), action.name);
            let text = format!("[keys.{place}]\n'<C-k>' = '{name}'\n");
            let config = Config::read(&text).expect(&text);
            assert_eq!(config.keymap().rows().len(), DEFAULT_KEYS.len());
        }
    }
}
