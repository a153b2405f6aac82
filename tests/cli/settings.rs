//! `taxel config`, and the settings that commands and the screen use.

use std::fs;
use std::path::Path;
use std::process::Command;

use taxel::cli::settings::Settings;
use taxel::tui::app::{App, Options};
use taxel::tui::jobs::Jobs;
use taxel::tui::script::Session;

use super::{Run, program};

/// A settings file with settings of every kind.
const FILE: &str = "theme = \"light\"\ncolor = \"256\"\nmouse = false\nlibrary = \"~/shapes\"\n\n\
[sensor]\ncolumns = 32\npitch = 2.5\n\n[source]\nrows = 4\ncolumns = 5\nformat = 'flexitac'\n\n\
[frames]\npercent = 40\ntare = 1\n\n[keys.matrix]\nx = \"toggle\"\nd = \"none\"\n";

#[test]
fn an_empty_settings_file_is_valid() {
    for text in ["", "\n# nothing\n", "[sensor]\n[keys]\n[keys.matrix]\n"] {
        assert!(Settings::read(text).is_ok(), "{text}");
    }
}

/// A file, with `;` for the end of a line, and the beginning of the message about it.
const WRONG: &str = "
# a comment;  colour = 'never' -> line 2, column 3: unknown field `colour`, expected one of `theme`,
theme = 'blue' -> line 1, column 9: expected one of auto, dark, light, mono, found \"blue\"
mouse = 'no' -> line 1, column 9: invalid type: string \"no\", expected a boolean
library = 'shapes' -> line 1, column 11: expected a path that starts with / or ~/
;sensor = 16 -> line 2, column 10: invalid type: integer `16`, expected a table
[source];baud = 12 -> line 2, column 8: expected a whole number from 50 to 20000000
;[source];rows = 16 -> line 2, column 1: expected rows and columns together, 1 to 512 each
[frames];percent = 5;at_least = 9 -> line 1, column 1: expected at_least, percent, or low and high
[frames];percent = 0 -> line 1, column 1: percent: 0 is out of range (allowed: above 0, up to 100)
[frames];low = 5;high = 4 -> line 1, column 1: low 5 is above high 4
[sensor];rows = 65 -> line 1, column 1: rows: 65 is above 64 (allowed: 1 to 64)
[keys.matrix];xy = 'toggle' -> line 2, column 1: \"xy\" is not a key that can be bound
[keys.matrix];x = 'togle' -> line 2, column 5: expected an action that 'taxel config' lists, or \"none\"
[keys.matrx];x = 'toggle' -> line 1, column 7: no place named \"matrx\"
[keys.matrix];'<CR>' = 'undo';'<Enter>' = 'redo' -> line 1, column 2: <Enter> is bound twice here
[keys.everywhere];'<C-c>' = 'none' -> line 1, column 2: <C-c> closes what is open
theme = 'dark';theme = 'light' -> line 2, column 1: duplicate key
[sensor -> line 1, ";

#[test]
fn wrong_settings_are_refused_with_their_places() {
    for row in WRONG.trim_start().lines() {
        let (text, expected) = row.split_once(" -> ").expect("a row");
        let error = Settings::read(&text.replace(';', "\n")).expect_err(text);
        assert!(error.starts_with(expected), "{text}: {error}");
    }
    // Messages are short enough to read, whatever the file contains.
    let long = format!("[keys.{}]\nx = 'toggle'", "x".repeat(100_000));
    let error = Settings::read(&long).expect_err("nonsense");
    assert!(error.chars().count() < 1000, "{}", error.len());
}

fn session(settings: &str, keys: &str) -> Session {
    let settings = Settings::read(settings).expect("a file of settings");
    let mut app = App::new(&Options::plain(false));
    app.keymap = settings.keymap().clone();
    let world = Jobs::scratch().expect("a folder");
    let mut session = Session::of(app, world, 80, 24);
    session.keys(keys).expect("the keys of a test are right");
    session
}

#[test]
fn keys_and_hints_are_those_of_the_settings_file() {
    let settings = "[keys.matrix]\nx = 'toggle'\n'<C-n>' = 'new'\nn = 'none'\n'?' = 'undo'\nK = 'help'\n[keys.form]\n'<C-n>' = 'next'\n";
    for (keys, text) in [
        ("", "Ctrl-N New   l Load"),
        ("", "q Quit   K Help"),
        ("x", "NA 1 in all"),
        ("x", "x toggle  ? undo"),
        ("x?", "NA 0 in all"),
        ("xn", "NA 1 in all"),
        ("f<C-n>2<Enter>", "rx 2.00"),
        ("K", "Ctrl-N                  New: empty the matrix"),
    ] {
        let screen = session(settings, keys).screen();
        assert!(screen.contains(text), "{keys}: no {text:?} on\n{screen}");
    }
}

fn run(command: &mut Command) -> Run {
    super::finish(command.spawn().expect("it starts"), b"")
}

/// Makes a home folder with this settings file.
fn home(text: &str) -> tempfile::TempDir {
    let home = tempfile::tempdir().expect("a folder");
    let folder = home.path().join(".config/taxel");
    fs::create_dir_all(&folder).expect("made");
    fs::write(folder.join("config.toml"), text).expect("written");
    home
}

fn at_home(line: &str, home: &Path) -> Command {
    let words: Vec<&str> = line.split_whitespace().collect();
    let mut command = program(&words, "C.UTF-8");
    for variable in [
        "TAXEL_CONFIG",
        "TAXEL_LIBRARY",
        "NO_COLOR",
        "XDG_CONFIG_HOME",
        "XDG_DATA_HOME",
    ] {
        command.env_remove(variable);
    }
    command.env("HOME", home);
    command
}

fn shows(command: &mut Command, lines: &[&str]) {
    let run = run(command);
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
    for line in lines {
        let is_there = run.stdout.lines().any(|own| own == *line);
        assert!(is_there, "no {line} in\n{}", run.stdout);
    }
}

#[test]
fn a_flag_beats_the_environment_which_beats_the_file() {
    let home = home(FILE);
    let folder = home.path();
    let path = format!("# {}", folder.join(".config/taxel/config.toml").display());
    let shapes = format!("library = \"{}\"", folder.join("shapes").display());
    shows(
        &mut at_home("config", folder),
        &[
            &path,
            "theme = \"light\"",
            "color = \"256\"",
            "charset = \"auto\"",
            "mouse = false",
            &shapes,
            "columns = 32",
            "rows = 16",
            "pitch = 2.5",
            "format = \"flexitac\"",
            "baud = 115200",
            "percent = 40.0",
            "history_bytes = 33554432",
            "x = \"toggle\"",
            "\"<Space>\" = \"toggle\"",
            "d = \"none\"",
        ],
    );
    shows(
        at_home("config --theme mono --columns 8 --ascii", folder)
            .env("NO_COLOR", "1")
            .env("TAXEL_LIBRARY", "/shapes"),
        &[
            "theme = \"mono\"",
            "color = \"never\"",
            "charset = \"ascii\"",
            "library = \"/shapes\"",
            "columns = 8",
            "pitch = 2.5",
        ],
    );
    shows(
        at_home("config --color 16 --library /other", folder)
            .env("NO_COLOR", "1")
            .env("TAXEL_LIBRARY", "/shapes"),
        &["color = \"16\"", "library = \"/other\""],
    );
}

/// The output is a file with the same settings.
#[test]
fn the_printed_settings_read_back() {
    let home = home(&FILE.replace("~/shapes", "/a b é"));
    let first = run(&mut at_home("config", home.path()));
    let file = home.path().join("printed.toml");
    fs::write(&file, &first.stdout).expect("written");
    let line = format!("config --config {}", file.display());
    let second = run(&mut at_home(&line, home.path()));
    let below_path = |run: &Run| run.stdout.split_once('\n').map(|(_, rest)| rest.to_owned());
    assert_eq!(below_path(&first), below_path(&second), "{}", second.stderr);
}

#[test]
fn the_settings_file_applies_to_every_command_except_scripts() {
    let home = home(FILE);
    let folder = home.path();
    let figure = run(&mut at_home("figure ellipse", folder)).stdout;
    assert!(
        figure.contains("32 × 16") && figure.contains("mm"),
        "{figure}"
    );
    let path = run(&mut at_home("library path", folder)).stdout;
    assert_eq!(Path::new(path.trim_end()), folder.join("shapes"));
    // A script is the same for everybody, unless it is given settings.
    let script = |flag: &str| {
        let file = folder.join(".config/taxel/config.toml");
        let mut command = at_home("script -k x", folder);
        if !flag.is_empty() {
            command.arg(flag).arg(file);
        }
        run(&mut command).stdout
    };
    assert!(script("").contains("NA 0 in all"));
    assert!(script("--config").contains("NA 1 in all"));
    let unicode = folder.join("unicode.toml");
    fs::write(&unicode, "charset = 'unicode'\n").expect("written");
    let mut list = at_home("library list", folder);
    let list = run(list.env("LC_ALL", "C").env("TAXEL_CONFIG", &unicode));
    assert!(list.stdout.contains('×'), "{}", list.stdout);
}

#[test]
fn a_broken_settings_file_is_reported_and_nothing_is_started() {
    let home = home("theme = \"light\"\ncolour = \"never\"\n");
    let folder = home.path();
    let file = folder.join(".config/taxel/config.toml");
    let message = format!("error: {}: line 2, column 1: unknown ", file.display());
    for line in ["", "config", "figure ellipse", "library save ring washer"] {
        let run = run(&mut at_home(line, folder));
        assert_eq!((run.status, run.stdout.as_str()), (Some(2), ""), "{line}");
        assert!(run.stderr.starts_with(&message), "{line}: {}", run.stderr);
    }
    assert!(!folder.join(".local").exists(), "nothing was stored");
    // Commands that are the same for everybody do not read the file.
    for line in ["--help", "completions bash", "man", "script -k f"] {
        assert_eq!(run(&mut at_home(line, folder)).status, Some(0), "{line}");
    }
}

#[test]
fn a_named_settings_file_must_exist_and_be_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("missing.toml");
    let told = |message: &str| {
        let run = run(at_home("config", folder.path()).env("TAXEL_CONFIG", &file));
        let expected = format!("error: {}: {message}\n", file.display());
        assert_eq!((run.status, run.stderr), (Some(2), expected));
    };
    told("cannot read: no such file or folder");
    fs::write(&file, b"theme = '\xff'").expect("written");
    told("cannot read: stream did not contain valid UTF-8");
    fs::write(&file, vec![b'#'; (1 << 20) + 1]).expect("written");
    told("larger than 64 KiB, the limit for a file of settings");
}

#[test]
fn settings_for_frames_are_used_unless_flags_override_them() {
    let home = home(FILE);
    let samples = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files/frames/samples");
    let answered = |line: String| {
        let run = run(&mut at_home(&line, home.path()));
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        run.stdout
    };
    let settings = answered(format!("frames {samples}/tekscan.asf --frame 2 --json"));
    let rule = "\"tare\":1,\"rule\":{\"percent\":40,\"from\":\"settings\"}";
    assert!(settings.contains(rule), "{settings}");
    let flags = answered(format!(
        "frames {samples}/tekscan.asf --frame 2 --json --at-least 9 --tare 0"
    ));
    let rule = "\"rule\":{\"at_least\":9,\"from\":\"flag\"}";
    assert!(flags.contains(rule) && !flags.contains("tare"), "{flags}");
    // A stream has the format, rows and columns of the settings; a recording has its own.
    let mut stream = at_home("watch - --once", home.path());
    let bytes = fs::File::open(format!("{samples}/flexitac.bin"));
    let stream = stream.stdin(bytes.expect("a sample")).output();
    let stream = String::from_utf8(stream.expect("it runs").stdout).expect("UTF-8");
    assert_eq!(stream.lines().count(), 3, "{stream}");
    let own = answered(format!("watch {samples}/tekscan.asf --once --tare 0"));
    assert_eq!(own.lines().count(), 3, "{own}");
}
