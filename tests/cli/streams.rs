//! Properties of every command: characters, help, closed pipes, full disks.

use super::RING;
use super::batch::POINT;
use super::describe::SHAPE;
use super::finish;
use super::program;
use super::run_in;
use super::taxel;

/// Commands that write to standard output, each in its own way.
const WRITING: [&str; 10] = [
    RING,
    "figure hexagon --json",
    "picture washer",
    "library list",
    "describe -",
    "batch",
    "--help",
    "--version",
    "completions bash",
    "man",
];

#[test]
fn output_is_ascii_if_the_locale_is_not_utf_8() {
    let ascii = |arguments: &[&str], input: &str| {
        for locale in ["C", "POSIX", "ro_RO.ISO-8859-2"] {
            let run = run_in(locale, arguments, input.as_bytes());
            assert!(
                run.stdout.is_ascii() && run.stderr.is_ascii(),
                "{arguments:?} {run:?}"
            );
        }
        let mut flagged = arguments.to_vec();
        flagged.push("--ascii");
        let run = run_in("C.UTF-8", &flagged, input.as_bytes());
        assert!(
            run.stdout.is_ascii() && run.stderr.is_ascii(),
            "{flagged:?} {run:?}"
        );
    };
    ascii(
        &["figure", "hexagon", "--angle", "12.5", "--pitch", "2"],
        "",
    );
    ascii(&["figure", "hexágono"], "");
    ascii(&["describe", "-"], "##\n#é\n");
    ascii(&["describe", "-"], &SHAPE.replace("corner", "colț"));
    ascii(&["describe", "colț"], "");
    ascii(&["picture", "washer", "--angle", "12.5"], "");
    ascii(&["batch"], "{\"figure\":\"hexágono\"}\n{\"é\":1}\n");
    ascii(&["figure", "--help"], "");
}

#[test]
fn the_help_is_the_same_by_flag_and_by_command() {
    let whole = taxel("--help", "").stdout;
    assert!(whole.contains("Examples:"), "{whole}");
    assert_eq!(taxel("help", "").stdout, whole);
    assert_eq!(
        taxel("help figure", "").stdout,
        taxel("figure --help", "").stdout
    );
}

#[test]
fn the_version_is_that_of_the_package() {
    // An optimised build also reports its commit.
    let version = concat!("taxel ", env!("CARGO_PKG_VERSION"));
    let shown = taxel("--version", "").stdout;
    let commit = shown.strip_prefix(version).map(str::trim_end);
    assert!(
        commit.is_some_and(|rest| rest.is_empty() || rest.starts_with(" (")),
        "{shown}"
    );
}

#[cfg(unix)]
#[test]
fn a_closed_pipe_ends_the_program_quietly() {
    for line in WRITING {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let child = program(&arguments, "C").stdout(writer).spawn();
        let input = if line == "batch" {
            format!("{POINT}\n").repeat(10_000)
        } else {
            "#\n".to_owned()
        };
        let run = finish(child.expect("the program starts"), input.as_bytes());
        assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""), "{line}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_reported() {
    for line in WRITING {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .expect("there is one");
        let child = program(&arguments, "C")
            .stdout(full)
            .spawn()
            .expect("the program starts");
        let input = if line == "batch" { POINT } else { "#\n" };
        let run = finish(child, input.as_bytes());
        super::refused(
            &run,
            1,
            "cannot write to standard output: No space left on device",
        );
    }
}

#[cfg(target_os = "linux")]
#[test]
fn unreadable_input_is_reported() {
    let folder = std::fs::File::open(".").expect("a folder");
    let output = program(&["batch"], "C")
        .stdin(folder)
        .output()
        .expect("the program runs");
    let stderr = String::from_utf8(output.stderr).expect("text");
    assert_eq!(
        stderr,
        "error: standard input: cannot read: it is a folder\n"
    );
    assert_eq!(output.status.code(), Some(1));
}
