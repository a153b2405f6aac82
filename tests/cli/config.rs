//! The settings file and the keys that it changes: valid contents, refusals with their places, and the resulting
//! screen.

use taxel::cli::settings::file::Config;
use taxel::tui::app::state::{App, Options};
use taxel::tui::keys::binding::Context;
use taxel::tui::keys::default_keys::DEFAULT_KEYS;
use taxel::tui::runtime::World;
use taxel::tui::script::Session;

/// Checks that settings are refused with this message.
fn invalid(text: &str, expected: &str) {
    let error = Config::read(text).expect_err(text).to_string();
    assert_eq!(error, expected, "{text}");
}

/// Returns the contexts of keys, as messages list them.
fn contexts() -> String {
    let names: Vec<&str> = Context::ALL.iter().map(|context| context.name()).collect();
    names.join(", ")
}

#[test]
fn an_empty_settings_file_is_valid() {
    for text in ["", "\n# nothing\n", "[sensor]\n[keys]\n[keys.matrix]\n"] {
        let config = Config::read(text).expect("a file of settings");
        assert!(config.sensor_entries().is_empty() && config.changes().is_empty());
    }
}

#[test]
fn unknown_keys_and_bad_values_are_refused_with_their_places() {
    for (text, expected) in [
        (
            "# a comment\n  colour = 'never'\n",
            "line 2, column 3: unknown key \"colour\", expected one of theme, color, charset, mouse, library, sensor, source, frames, keys; did you mean \"color\"?",
        ),
        (
            "theme = 'blue'",
            "line 1, column 9: expected one of \"auto\", \"dark\", \"light\", \"mono\", found \"blue\"",
        ),
        (
            "theme = 3",
            "line 1, column 9: expected text in quotes, found integer",
        ),
        (
            "color = 256",
            "line 1, column 9: expected text in quotes, found integer",
        ),
        (
            "mouse = 'no'",
            "line 1, column 9: expected true or false, found string",
        ),
        (
            "library = 'shapes'",
            "line 1, column 11: expected a path that starts with / or ~/, found \"shapes\"",
        ),
        (
            "sensor = 16",
            "line 1, column 10: expected a table, found integer",
        ),
        (
            "[sensor]\ncolumns = 16\nzoom = 2\n",
            "line 3, column 1: unknown key \"zoom\", expected one of columns, rows, threshold, pitch",
        ),
        (
            "[source]\nbaud = 12\n",
            "line 2, column 8: expected a whole number from 50 to 20000000, found \"12\"",
        ),
        (
            "[source]\nformat = 'csv'\n",
            "line 2, column 10: expected one of \"auto\", \"lines\", \"jsonl\", \"ros2\", \"flexitac\", \"matsense\", found \"csv\"",
        ),
        (
            "[source]\nrows = 16\n",
            "line 2, column 1: expected rows and columns together, found rows",
        ),
        (
            "[frames]\npercent = 5\nat_least = 9\n",
            "line 2, column 1: expected one threshold: at_least, percent, or low and high, found at_least and percent",
        ),
        (
            "[frames]\npercent = 0\n",
            "line 2, column 11: expected a number above 0, up to 100, found \"0\"",
        ),
        (
            "[frames]\nlow = 5\nhigh = 4\n",
            "line 2, column 1: expected a number at most that of high, found low",
        ),
        (
            "[sensor]\nrows = 65\n",
            "line 2, column 8: rows: 65 is above 64 (allowed: 1 to 64)",
        ),
        (
            "[sensor]\npitch = nan\n",
            "line 2, column 9: pitch_mm: NaN is not a number (allowed: above 0, up to 1000)",
        ),
        (
            "[sensor]\ncolumns = 0x10\n",
            "line 2, column 11: expected a decimal number, found \"0x10\"",
        ),
        (
            "[frames]\nleast = 1e308\n",
            "line 2, column 9: expected a whole number from 1 to 4096, found \"1e308\"",
        ),
        (
            "[keys.matrx]\nx = 'toggle'\n",
            &format!(
                "line 1, column 7: unknown key \"matrx\", expected one of {}; did you mean \"matrix\"?",
                contexts()
            ),
        ),
        (
            "[keys.matrix]\nxy = 'toggle'\n",
            "line 2, column 1: \"xy\" is not a key that can be bound, expected one such as x, <Tab> or <C-x>",
        ),
        (
            "[keys.matrix]\n'<A-x>' = 'toggle'\n",
            "line 2, column 1: \"<A-x>\" is not a key that can be bound, expected one such as x, <Tab> or <C-x>",
        ),
    ] {
        invalid(text, expected);
    }
    for (text, place) in [
        ("theme = \n", "line 1, "),
        ("é = 1 =\n", "line 1, "),
        ("[sensor\n", "line 1, "),
        ("x = 'a\n", "line 1, "),
    ] {
        let error = Config::read(text).expect_err(text).to_string();
        assert!(error.starts_with(place), "{text}: {error}");
    }
}

#[test]
fn unknown_actions_and_duplicate_keys_are_named() {
    let actions = "expected an action that 'taxel config' lists, or \"none\"";
    for (text, expected) in [
        (
            "[keys.matrix]\nx = 'togle'\n",
            format!("line 2, column 5: {actions}, found \"togle\"; did you mean \"toggle\"?"),
        ),
        (
            "[keys.matrix]\nx = 'fly'\n",
            format!("line 2, column 5: {actions}, found \"fly\""),
        ),
        (
            "[keys.matrix]\nx = 'toggle'\n\"x\" = 'quit'\n",
            "line 3, column 1: key \"x\" is given twice".to_owned(),
        ),
        (
            "theme = 'dark'\ntheme = 'light'\n",
            "line 2, column 1: key \"theme\" is given twice".to_owned(),
        ),
        (
            "[sensor]\nrows = 8\n[sensor]\n",
            "line 3, column 2: key \"sensor\" is given twice".to_owned(),
        ),
    ] {
        invalid(text, &expected);
    }
}

#[test]
fn surprising_changes_of_keys_are_refused_with_their_places() {
    invalid(
        "[keys.matrix]\n'<CR>' = 'toggle'\n'<Enter>' = 'undo'\n",
        "line 3, column 1: <Enter> is bound twice here",
    );
    invalid(
        "[keys.matrix]\nx = 'undo'\nd = 'toggle'\n",
        "line 3, column 1: d is the only key of \"delete\" here; give the action another key first",
    );
    invalid(
        "keys.matrix.x = 'increase'\n",
        "line 1, column 17: \"increase\" is not an action of [keys.matrix]; 'taxel config' lists them",
    );
    invalid(
        "[keys.list]\nj = 'scroll-down'\n",
        "line 2, column 1: j types text here; choose a key like <C-x>",
    );
    invalid(
        "[keys.everywhere]\n'<C-c>' = 'none'\n",
        "line 2, column 1: <C-c> always closes what is open and cannot be changed",
    );
}

/// Messages are short enough to read, whatever the file contains.
#[test]
fn messages_are_short() {
    let long = "x".repeat(100_000);
    for text in [
        format!("{long} = 1"),
        format!("theme = '{long}'"),
        format!("[keys.matrix]\n{long} = 'toggle'"),
        format!("[keys.matrix]\nx = '{long}'"),
        format!("[keys.{long}]\nx = 'toggle'"),
        format!("theme = {long}"),
        "[".repeat(100_000),
        format!("a = {}", "[".repeat(100_000)),
    ] {
        let error = Config::read(&text).expect_err("nonsense").to_string();
        assert!(error.chars().count() < 1000, "{}", error.len());
    }
}

fn session(config: &str, keys: &str) -> Session {
    let config = Config::read(config).expect("a file of settings");
    let options = Options::plain(false);
    let app = App::new(&options).with_keymap(config.keymap().clone());
    let world = World::scratch().expect("a folder");
    let mut session = Session::of(app, world, 80, 24);
    session.keys(keys).expect("the keys of a test are right");
    session
}

const KEYS: &str = "[keys.matrix]\nx = 'toggle'\n'<C-n>' = 'new'\nn = 'none'\nh = 'cursor-left'\n'?' = 'undo'\nK = 'help'\nm = 'none'\n[keys.form]\n'<C-n>' = 'next'\n";

fn shows(keys: &str, texts: &[&str]) {
    let screen = session(KEYS, keys).screen();
    for text in texts {
        assert!(screen.contains(text), "{keys}: no {text:?} on\n{screen}");
    }
}

#[test]
fn keys_do_what_the_settings_file_says() {
    shows("x", &["NA 1 in all"]);
    shows("x<Space>", &["NA 0 in all"]);
    shows("hx", &["column  7, row  8    active"]);
    shows("x?", &["NA 0 in all"]);
    shows("x<C-n>", &["NA 0 in all"]);
    shows("xn", &["NA 1 in all"]);
    shows("f<C-n>2<Enter>", &["rx 2.00"]);
}

#[test]
fn menu_hints_help_and_notices_show_the_keys_of_the_settings_file() {
    shows(
        "",
        &[
            "Ctrl-N New   l Load",
            "q Quit   K Help",
            "drawn by hand: x draws, f places a figure",
            "x toggle  ",
        ],
    );
    shows("x", &["x toggle  ? undo"]);
    shows(
        "K",
        &[
            "Ctrl-N                  New: empty the matrix",
            "h arrows                move the cursor",
            "? u                     undo the last",
        ],
    );
    shows("f<Enter>x>", &["by hand was dropped; ? restores it"]);
    shows(":mouse<Enter>", &[":mouse lets it draw"]);
    shows("f", &["Ctrl-N field"]);
    shows(
        ":nonsense<Enter>",
        &["no command named \"nonsense\"; Tab shows all"],
    );
}

/// An option without a key can still be clicked.
#[test]
fn an_option_without_a_key_stays_in_the_menu() {
    let mut session = session("[keys.matrix]\nf = 'none'\n", "f");
    assert!(session.screen().contains("l Load   Figure   p Picture"));
    assert!(!session.screen().contains("Kind"));
    let column = session.screen().find("Figure").expect("an option");
    let mouse = |kind| {
        taxel::tui::app::message::Message::Mouse(taxel::tui::app::message::Mouse {
            kind,
            column: u16::try_from(column).expect("on the screen"),
            row: 0,
        })
    };
    session.send(mouse(taxel::tui::app::message::MouseKind::Press));
    session.send(mouse(taxel::tui::app::message::MouseKind::Release));
    assert!(session.screen().contains("Kind"), "{}", session.screen());
}

/// The table keeps its rows and names, whatever keys a file removes or adds.
#[test]
fn the_settings_file_can_name_every_context_and_action() {
    for context in Context::ALL {
        for name in taxel::tui::keys::keymap::actions(context) {
            let text = format!("[keys.{}]\n'<C-k>' = '{name}'\n", context.name());
            let config = Config::read(&text).expect(&text);
            assert_eq!(config.keymap().rows().len(), DEFAULT_KEYS.len());
        }
    }
}
