//! `taxel script`: what it prints, and how it tells what did not hold.

use super::Run;
use super::run_in;
use super::taxel;

#[test]
fn messages_name_the_script_and_the_line() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let file = folder.path().join("walk.taxel");
    let name = file.to_str().expect("a name");
    let of_file = |script: &str| {
        std::fs::write(&file, script).expect("it is written");
        run_in("C.UTF-8", &["script", name], b"")
    };
    for (script, status, message) in [
        ("Keys f\nExpect /zzz/", 1, "line 2: no /zzz/ on the screen"),
        ("Keys f\nFly", 2, "line 2: \"Fly\" is unknown"),
        ("Set columns 99", 2, "line 1: columns: 99 is out of range"),
        ("Keys q\nKeys f", 3, "line 2: the program had already ended"),
    ] {
        let run = of_file(script);
        assert_eq!(run.status, Some(status), "{run:?}");
        let expected = format!("error: {name}: {message}");
        assert!(run.stderr.starts_with(&expected), "{run:?}");
        let run = taxel("script -", script);
        let expected = format!("error: standard input: {message}");
        assert!(run.stderr.starts_with(&expected), "{run:?}");
    }
    let run = taxel("script -k <Foo>", "");
    assert!(
        run.stderr.starts_with("error: -k: key \"<Foo>\""),
        "{run:?}"
    );
    let run = taxel("script nowhere.taxel", "");
    assert!(
        run.stderr
            .starts_with("error: nowhere.taxel: cannot read: "),
        "{run:?}"
    );
    assert_eq!(run.status, Some(2));
}

/// What held before something did not is printed, screen by screen.
#[test]
fn screens_come_before_the_message() {
    let Run { stdout, .. } = taxel("script -", "Size 20x6\nScreen one\nKeys q\nScreen two\n");
    assert!(
        stdout.starts_with("--- screen one 20x6 cursor "),
        "{stdout}"
    );
    assert_eq!(stdout.lines().count(), 7, "{stdout}");
}

/// A record of many shapes is longer than any shape.
#[test]
fn a_script_may_be_long() {
    let script = "# nothing but a remark that is repeated\n".repeat(40_000) + "State /na\n";
    assert!(script.len() > 1 << 20);
    let run = taxel("script -", &script);
    assert_eq!((run.status, run.stdout.as_str()), (Some(0), "0\n"));
}

/// `~/` is the home in the name of a file, and what was written is named with its whole path.
#[test]
fn a_file_may_be_named_below_the_home() {
    let home = tempfile::tempdir().expect("there is a folder for temporary files");
    let keys = "fh<Enter>:explore --x0 5 --y0 5 --angle 0:59:1<Enter>x~/in-home.csv<Enter>";
    let mut command = super::program(&["script", "-k", keys], "C.UTF-8");
    command.env("HOME", home.path());
    let run = super::finish(command.spawn().expect("the program starts"), b"");
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    let file = home.path().join("in-home.csv");
    let screen: String = run.stdout.split_whitespace().collect();
    let said = format!("written:{}", file.display());
    assert!(screen.contains(&said), "{said}: {}", run.stdout);
    assert!(file.exists());
}
