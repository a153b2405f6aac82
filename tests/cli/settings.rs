//! Tests of `taxel config`: the settings in effect, and the origin of each.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::Run;
use super::program;
use super::wait;

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
    command
        .env_remove("TAXEL_CONFIG")
        .env_remove("TAXEL_LIBRARY")
        .env_remove("NO_COLOR")
        .env_remove("XDG_CONFIG_HOME")
        .env_remove("XDG_DATA_HOME")
        .env("HOME", home);
    command
}

fn shows(command: &mut Command, lines: &[(&str, &str)]) {
    let run = run(command);
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
    for (entry, origin) in lines {
        let line = format!("{entry:<37}  # {origin}\n");
        assert!(run.stdout.contains(&line), "no {line} in\n{}", run.stdout);
    }
}

#[test]
fn each_value_is_shown_with_its_origin() {
    let home = home(FILE);
    let folder = home.path();
    let shapes = format!("library = \"{}\"", folder.join("shapes").display());
    shows(
        &mut at_home("config", folder),
        &[
            ("theme = \"light\"", "file, line 1"),
            ("color = \"256\"", "file, line 2"),
            ("charset = \"auto\"", "default"),
            ("mouse = false", "file, line 3"),
            (&shapes, "file, line 4"),
            ("columns = 32", "file, line 7"),
            ("rows = 16", "default"),
            ("pitch = 2.5", "file, line 8"),
            ("\"x\" = \"toggle\"", "file, line 11"),
            ("\"<Space>\" = \"toggle\"", "default"),
            ("\"d\" = \"none\"", "file, line 12"),
        ],
    );
    // A flag overrides a variable, which overrides the file.
    shows(
        at_home("config --theme mono --columns 8 --ascii", folder)
            .env("NO_COLOR", "1")
            .env("TAXEL_LIBRARY", "/shapes"),
        &[
            ("theme = \"mono\"", "flag, --theme"),
            ("color = \"never\"", "environment, NO_COLOR"),
            ("charset = \"ascii\"", "flag, --ascii"),
            ("library = \"/shapes\"", "environment, TAXEL_LIBRARY"),
            ("columns = 8", "flag, --columns"),
            ("pitch = 2.5", "file, line 8"),
        ],
    );
    shows(
        at_home("config --color 16 --library /other", folder)
            .env("NO_COLOR", "1")
            .env("TAXEL_LIBRARY", "/shapes"),
        &[
            ("color = \"16\"", "flag, --color"),
            ("library = \"/other\"", "flag, --library"),
        ],
    );
    let empty = tempfile::tempdir().expect("a folder");
    shows(
        &mut at_home("config", empty.path()),
        &[
            ("theme = \"auto\"", "default"),
            ("mouse = true", "default"),
            ("# pitch is not set", "default"),
            ("\"<C-c>\" = \"quit\"", "default"),
        ],
    );
}

/// The output is a file with the same settings.
#[test]
fn the_printed_settings_read_back() {
    let home = home(&FILE.replace("~/shapes", "/a \\\"b\\\" \\\\ é"));
    let values = |text: &str| -> Vec<String> {
        let entries = text.lines().filter(|line| !line.starts_with('#'));
        entries
            .map(|line| {
                line.split("  #")
                    .next()
                    .unwrap_or_default()
                    .trim()
                    .to_owned()
            })
            .collect()
    };
    for flag in ["", "--ascii"] {
        let first = run(&mut at_home(&format!("config {flag}"), home.path()));
        let file = home.path().join("printed.toml");
        fs::write(&file, &first.stdout).expect("written");
        let line = format!("config {flag} --config {}", file.display());
        let second = run(&mut at_home(&line, home.path()));
        assert_eq!(second.stderr, "");
        assert_eq!(values(&first.stdout), values(&second.stdout));
    }
}

#[test]
fn the_settings_file_applies_to_every_command_except_scripts() {
    let home = home(FILE);
    let folder = home.path();
    let figure = run(&mut at_home("figure ellipse", folder)).stdout;
    assert!(
        figure.contains("32 x 16") || figure.contains("32 × 16"),
        "{figure}"
    );
    assert!(figure.contains("mm"), "{figure}");
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
    let mut charset = taxel("library list");
    let ascii = folder.join("ascii.toml");
    fs::write(&ascii, "charset = 'unicode'\n").expect("written");
    let unicode = run(charset.env("LC_ALL", "C").env("TAXEL_CONFIG", &ascii));
    assert!(unicode.stdout.contains('×'), "{}", unicode.stdout);
}

#[test]
fn a_broken_settings_file_is_reported_and_nothing_is_started() {
    let home = home("theme = \"light\"\ncolour = \"never\"\n");
    let folder = home.path();
    let file = folder.join(".config/taxel/config.toml");
    let message = format!(
        "error: {}: line 2, column 1: unknown key \"colour\", expected one of theme, color, charset, mouse, library, sensor, source, frames, keys; did you mean \"color\"?\n",
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
        assert_eq!(
            (run.status, run.stdout.as_str(), run.stderr.as_str()),
            (Some(2), "", message.as_str()),
            "{line}"
        );
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
        let mut command = taxel("config");
        let run = run(command.env("TAXEL_CONFIG", &file));
        let expected = format!("error: {}: {message}", file.display());
        assert_eq!(run.status, Some(2));
        assert!(run.stderr.starts_with(&expected), "{}", run.stderr);
    };
    told("cannot read: no such file or folder");
    fs::write(&file, b"theme = '\xff'").expect("written");
    told("not UTF-8");
    fs::write(&file, vec![b'#'; (1 << 20) + 1]).expect("written");
    told("larger than 64 KiB, the limit for a file of settings");
    let run = run(taxel("config").env("TAXEL_CONFIG", "/dev/zero"));
    assert_eq!(run.status, Some(2), "it comes to an end");
}

/// The disk that a link leads to may not be mounted; then the usual settings would be a surprise.
#[cfg(unix)]
#[test]
fn a_link_to_settings_that_are_missing_is_reported() {
    let home = tempfile::tempdir().expect("a folder");
    let folder = home.path().join(".config");
    fs::create_dir_all(&folder).expect("made");
    assert_eq!(run(&mut at_home("config", home.path())).status, Some(0));
    std::os::unix::fs::symlink("/nonexistent/taxel", folder.join("taxel")).expect("linked");
    let run = run(&mut at_home("config", home.path()));
    assert_eq!(run.status, Some(2));
    let message = "config.toml: cannot read: no such file or folder";
    assert!(run.stderr.contains(message), "{}", run.stderr);
}

#[cfg(unix)]
#[test]
fn a_library_whose_path_is_not_utf_8_is_a_comment_in_the_settings() {
    use std::os::unix::ffi::OsStrExt;
    let folder = std::ffi::OsStr::from_bytes(b"/srv/caf\xe9");
    let run = run(taxel("config").env("TAXEL_LIBRARY", folder));
    let line =
        "# library: /srv/caf\u{fffd}; this path is not UTF-8, so it cannot be in a settings file";
    assert!(run.stdout.contains(line), "{}", run.stdout);
    assert!(!run.stdout.contains("library = "), "{}", run.stdout);
}

/// A flag of the screen before a command would have no effect, so it is refused.
#[test]
fn flags_of_the_screen_are_refused_before_a_command() {
    for flag in [
        "--theme light",
        "--record r.taxel",
        "--size 80x24",
        "--no-mouse",
        "--columns 8",
    ] {
        let run = run(&mut taxel(&format!("{flag} library list")));
        assert_eq!(run.status, Some(2), "{flag}");
        let name = flag.split(' ').next().expect("a flag");
        let expected = format!("cannot be used with '{name}', which is only for the screen");
        assert!(run.stderr.contains(&expected), "{flag}: {}", run.stderr);
    }
    // The live page is also a screen.
    let run = run(&mut taxel("--no-mouse watch touch.csv"));
    let expected = "'--no-mouse' must come after 'watch'";
    assert!(run.stderr.contains(expected), "{}", run.stderr);
}

/// Opening a pipe would wait for a writer.
#[test]
fn a_settings_file_that_is_a_pipe_is_refused_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let pipe = folder.path().join("pipe");
    if !wait::fifo(&pipe) {
        return;
    }
    let mut command = taxel("config");
    let run = run(command.arg("--config").arg(&pipe));
    assert_eq!(run.status, Some(2));
    assert!(
        run.stderr
            .ends_with("cannot read: a pipe, expected a regular file\n"),
        "{}",
        run.stderr
    );
}

/// Settings of real sensors apply to frames and watch; flags override them.
#[test]
fn settings_for_frames_are_used() {
    let text =
        "[source]\nrows = 4\ncolumns = 5\nformat = 'flexitac'\n[frames]\npercent = 40\ntare = 1\n";
    let home = home(text);
    shows(
        &mut at_home("config", home.path()),
        &[
            ("format = \"flexitac\"", "file, line 4"),
            ("baud = 115200", "default"),
            ("rows = 4", "file, line 2"),
            ("percent = 40", "file, line 6"),
            ("# at_least is not set", "default"),
            ("history_bytes = 33554432", "default"),
        ],
    );
    let samples = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files/frames/samples");
    let answered = |line: String| {
        let run = run(&mut at_home(&line, home.path()));
        assert_eq!(run.status, Some(0), "{}", run.stderr);
        run.stdout
    };
    let settings = answered(format!("frames {samples}/tekscan.asf --frame 2 --json"));
    assert!(
        settings.contains("\"tare\":1,\"rule\":{\"percent\":40,\"from\":\"settings\"}"),
        "{settings}"
    );
    let flags = answered(format!(
        "frames {samples}/tekscan.asf --frame 2 --json --at-least 9 --tare 0"
    ));
    assert!(
        flags.contains("\"rule\":{\"at_least\":9,\"from\":\"flag\"}") && !flags.contains("tare"),
        "{flags}"
    );
    // A tare that is impossible is reported as coming from the settings.
    let few = self::home("[frames]\ntare = 9\n");
    for command in ["frames --all", "watch --once"] {
        let line = |tare| format!("{command} {samples}/tekscan.asf --json --at-least 9 {tare}");
        let said = |tare| run(&mut at_home(&line(tare), few.path())).stderr;
        let lacking = "the tare needs 9 frames, but there are only 3";
        let of_settings = format!("{lacking} (tare under [frames] in the settings");
        assert!(said("").contains(&of_settings), "{}", said(""));
        let of_flag = said("--tare 9");
        assert!(of_flag.ends_with(&format!("{lacking}\n")), "{of_flag}");
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
    let named = watched(" --format flexitac");
    assert!(!named.stderr.contains("settings"), "{}", named.stderr);
    assert_eq!(watched(" --format lines").status, Some(0));
}

#[test]
fn a_bad_number_for_a_flag_is_refused_with_the_expected_range() {
    for (line, expected) in [
        ("batch --jobs -1", "expected a whole number from 1 to 1024"),
        (
            "batch --jobs many",
            "expected a whole number from 1 to 1024",
        ),
        (
            "frames a.csv --rows 0",
            "expected a whole number from 1 to 512",
        ),
        (
            "frames a.csv --frame -1",
            "expected a whole number, 0 or more",
        ),
        ("frames a.csv --label nope", "expected a whole number"),
        (
            "recognise a.txt --top 0.5",
            "expected a whole number, 1 or more",
        ),
        (
            "recognise a.txt --top 9999999999",
            "the number is too large",
        ),
    ] {
        let run = run(&mut taxel(line));
        assert_eq!(run.status, Some(2), "{line}");
        let expected = format!(">': {expected}\n");
        assert!(run.stderr.contains(&expected), "{line}: {}", run.stderr);
    }
}
