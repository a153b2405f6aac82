//! Tests of `taxel config`, and of the settings that commands use.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::{Run, program, wait};

/// A settings file with settings of every kind.
const FILE: &str = "theme = \"light\"\ncolor = \"256\"\nmouse = false\nlibrary = \"~/shapes\"\n\n\
[sensor]\ncolumns = 32\npitch = 2.5\n\n[keys.matrix]\nx = \"toggle\"\nd = \"none\"\n";

fn run(command: &mut Command) -> Run {
    super::finish(command.spawn().expect("it starts"), b"")
}

fn taxel(line: &str) -> Command {
    let words: Vec<&str> = line.split_whitespace().collect();
    program(&words, "C.UTF-8")
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
    let mut command = taxel(line);
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
        assert!(
            run.stdout.lines().any(|own| own == *line),
            "no {line} in\n{}",
            run.stdout
        );
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
            "\"x\" = \"toggle\"",
            "\"<Space>\" = \"toggle\"",
            "\"d\" = \"none\"",
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
    let empty = tempfile::tempdir().expect("a folder");
    shows(
        &mut at_home("config", empty.path()),
        &[
            "theme = \"auto\"",
            "mouse = true",
            "# pitch is not set",
            "\"<C-c>\" = \"quit\"",
        ],
    );
}

/// The output is a file with the same settings.
#[test]
fn the_printed_settings_read_back() {
    let home = home(&FILE.replace("~/shapes", "/a \\\"b\\\" \\\\ é"));
    for flag in ["", "--ascii"] {
        let first = run(&mut at_home(&format!("config {flag}"), home.path()));
        let file = home.path().join("printed.toml");
        fs::write(&file, &first.stdout).expect("written");
        let line = format!("config {flag} --config {}", file.display());
        let second = run(&mut at_home(&line, home.path()));
        assert_eq!(second.stderr, "");
        let below_path = |text: &str| text.split_once('\n').map(|(_, rest)| rest.to_owned());
        assert_eq!(below_path(&first.stdout), below_path(&second.stdout));
    }
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
    let explicit = run(&mut at_home("figure ellipse --columns 8", folder)).stdout;
    assert!(explicit.contains("8 × 16"), "{explicit}");
    let path = run(&mut at_home("library path", folder)).stdout;
    assert_eq!(Path::new(path.trim_end()), folder.join("shapes"));
    // A script is the same for everybody, unless it is given settings.
    let script = |line: &str| {
        let mut command = at_home("script -k x", folder);
        command.args(line.split_whitespace());
        run(&mut command).stdout
    };
    assert!(script("").contains("NA 0 in all"));
    let file = folder.join(".config/taxel/config.toml");
    let told = script(&format!("--config {}", file.display()));
    assert!(told.contains("NA 1 in all"), "{told}");
    let ascii = folder.join("ascii.toml");
    fs::write(&ascii, "charset = 'unicode'\n").expect("written");
    let mut list = taxel("library list");
    let unicode = run(list.env("LC_ALL", "C").env("TAXEL_CONFIG", &ascii));
    assert!(unicode.stdout.contains('×'), "{}", unicode.stdout);
}

#[test]
fn a_broken_settings_file_is_reported_and_nothing_is_started() {
    let home = home("theme = \"light\"\ncolour = \"never\"\n");
    let folder = home.path();
    let file = folder.join(".config/taxel/config.toml");
    let message = format!(
        "error: {}: line 2, column 1: unknown key \"colour\", ",
        file.display()
    );
    for line in [
        "",
        "config",
        "figure ellipse",
        "library save ring washer",
        "batch",
    ] {
        let run = run(&mut at_home(line, folder));
        assert_eq!((run.status, run.stdout.as_str()), (Some(2), ""), "{line}");
        assert!(run.stderr.starts_with(&message), "{line}: {}", run.stderr);
    }
    assert!(!folder.join(".local").exists(), "nothing was stored");
    // Commands that are the same for everybody do not read the file.
    for line in [
        "--help",
        "--version",
        "completions bash",
        "man",
        "script -k f",
    ] {
        assert_eq!(run(&mut at_home(line, folder)).status, Some(0), "{line}");
    }
}

#[test]
fn a_named_settings_file_must_exist_and_be_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("missing.toml");
    let told = |message: &str| {
        let run = run(taxel("config").env("TAXEL_CONFIG", &file));
        let expected = format!("error: {}: {message}\n", file.display());
        assert_eq!((run.status, run.stderr), (Some(2), expected));
    };
    told("cannot read: no such file or folder");
    fs::write(&file, b"theme = '\xff'").expect("written");
    told("not UTF-8");
    fs::write(&file, vec![b'#'; (1 << 20) + 1]).expect("written");
    told("larger than 64 KiB, the limit for a file of settings");
    fs::remove_file(&file).expect("it is there");
    // Opening a pipe would wait for a writer.
    if wait::fifo(&file) {
        told("cannot read: a pipe, expected a regular file");
    }
    // The disk that a link leads to may not be mounted; then the usual settings would be a surprise.
    #[cfg(unix)]
    {
        fs::create_dir(folder.path().join(".config")).expect("made");
        let link = folder.path().join(".config/taxel");
        std::os::unix::fs::symlink("/nonexistent/taxel", link).expect("linked");
        let run = run(&mut at_home("config", folder.path()));
        let message = "config.toml: cannot read: no such file or folder";
        assert!(
            run.status == Some(2) && run.stderr.contains(message),
            "{}",
            run.stderr
        );
    }
}

/// A flag of the screen before a command would have no effect, so it is refused.
#[test]
fn flags_of_the_screen_are_refused_before_a_command() {
    for (line, expected) in [
        (
            "--theme light library list",
            "cannot be used with '--theme', which is only for the screen",
        ),
        (
            "--columns 8 library list",
            "cannot be used with '--columns', which is only for the screen",
        ),
        // The live page is also a screen.
        (
            "--no-mouse watch touch.csv",
            "'--no-mouse' must come after 'watch'",
        ),
    ] {
        let run = run(&mut taxel(line));
        assert!(
            run.status == Some(2) && run.stderr.contains(expected),
            "{line}: {}",
            run.stderr
        );
    }
}

#[test]
fn settings_for_frames_are_used_unless_flags_override_them() {
    let text =
        "[source]\nrows = 4\ncolumns = 5\nformat = 'flexitac'\n[frames]\npercent = 40\ntare = 1\n";
    let home = home(text);
    shows(
        &mut at_home("config", home.path()),
        &[
            "format = \"flexitac\"",
            "baud = 115200",
            "rows = 4",
            "percent = 40",
            "# at_least is not set",
            "history_bytes = 33554432",
        ],
    );
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
    // A tare that is impossible is reported as coming from the settings.
    let few = self::home("[frames]\ntare = 9\n");
    for command in ["frames --all", "watch --once"] {
        let line = format!("{command} {samples}/tekscan.asf --json --at-least 9");
        let said = run(&mut at_home(&line, few.path())).stderr;
        let expected =
            "the tare needs 9 frames, but there are only 3 (tare under [frames] in the settings";
        assert!(said.contains(expected), "{said}");
    }
    // A stream has the format, rows and columns of the settings; a recording has its own.
    let mut stream = at_home("watch - --once", home.path());
    let bytes = fs::File::open(format!("{samples}/flexitac.bin"));
    let stream = stream.stdin(bytes.expect("a sample")).output();
    let stream = String::from_utf8(stream.expect("it runs").stdout).expect("UTF-8");
    assert_eq!(stream.lines().count(), 3, "{stream}");
    let own = answered(format!("watch {samples}/tekscan.asf --once --tare 0"));
    assert_eq!(own.lines().count(), 3, "{own}");
    // If that format is the wrong one, the message says where it comes from.
    let watched = |format: &str| {
        let child = at_home(&format!("watch - --once --tare 0{format}"), home.path()).spawn();
        super::finish(
            child.expect("it starts"),
            "1 2 3 4 5\n".repeat(4).as_bytes(),
        )
    };
    let origin = "; the settings say format \"flexitac\", which --format overrides\n";
    let refused = watched("");
    assert_eq!(refused.status, Some(1), "{}", refused.stderr);
    assert!(refused.stderr.ends_with(origin), "{}", refused.stderr);
    assert_eq!(watched(" --format lines").status, Some(0));
}

#[test]
fn a_bad_number_for_a_flag_is_refused_with_the_expected_range() {
    for (line, expected) in [
        (
            "batch --jobs many",
            "expected a whole number from 1 to 1024",
        ),
        (
            "frames a.csv --rows 0",
            "expected a whole number from 1 to 512",
        ),
        (
            "recognise a.txt --top 9999999999",
            "the number is too large",
        ),
    ] {
        let run = run(&mut taxel(line));
        let expected = format!(">': {expected}\n");
        assert!(
            run.status == Some(2) && run.stderr.contains(&expected),
            "{line}: {}",
            run.stderr
        );
    }
}
