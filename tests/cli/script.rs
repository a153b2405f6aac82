//! Tests of `taxel script`: its output, and its messages about expectations that fail.

use super::Run;
use super::run_in;
use super::taxel;
use super::wait;

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
        (
            "\u{feff}Set columns 99",
            2,
            "line 1: columns: 99 is above 64",
        ),
        ("Keys q\nKeys f", 3, "line 2: the program had already ended"),
        (
            "Source nofile.csv",
            1,
            "line 1: nofile.csv: cannot open: no such file or folder",
        ),
        (
            "Source tests/scripts/touch.csv\nFrames 3\nFrames 6",
            1,
            "line 3: expected 6 frames, found 5: the source has ended",
        ),
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
    let run = run_in("C.UTF-8", &["script", "-"], b"Keys f\nType \"\xff\"\n");
    let message = "error: standard input: line 2: not UTF-8\n";
    assert_eq!((run.status, run.stderr.as_str()), (Some(2), message));
    let run = taxel("script nowhere.taxel", "");
    assert!(
        run.stderr
            .starts_with("error: nowhere.taxel: cannot read: "),
        "{run:?}"
    );
    assert_eq!(run.status, Some(2));
}

/// The screens before a failed expectation are printed.
#[test]
fn screens_are_printed_before_the_message() {
    let Run { stdout, .. } = taxel("script -", "Size 60x20\nScreen one\nKeys q\nScreen two\n");
    assert!(
        stdout.starts_with("--- screen one 60x20 cursor "),
        "{stdout}"
    );
    assert_eq!(stdout.lines().count(), 21, "{stdout}");
}

/// Neither output nor messages depend on the locale.
#[test]
fn a_script_is_the_same_in_every_locale() {
    let script = b"Screen\nExpect /\xc2\xb7 x \xc3\xa9/\n";
    let [unicode, plain] = ["C.UTF-8", "C"].map(|locale| run_in(locale, &["script", "-"], script));
    assert_eq!(
        (&plain.stdout, &plain.stderr),
        (&unicode.stdout, &unicode.stderr)
    );
    assert!(
        plain.stderr.contains("no /\u{b7} x \u{e9}/ on the screen"),
        "{plain:?}"
    );
    let ascii = run_in("C.UTF-8", &["script", "-"], b"Set ascii on\nScreen\n");
    assert!(ascii.stdout.is_ascii(), "{ascii:?}");
}

/// All are run, and the worst status is that of all.
#[test]
fn several_scripts_are_run_in_one_call() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let names = ["a", "b", "c"].map(|name| folder.path().join(name));
    let names = names.each_ref().map(|name| name.to_str().expect("a name"));
    for (name, script) in
        names
            .iter()
            .zip(["State /na\n", "Fly\n", "Keys <Space>\nState /na\nQuit\n"])
    {
        std::fs::write(name, script).expect("written");
    }
    let run = run_in("C.UTF-8", &[&["script"], &names[..]].concat(), b"");
    assert_eq!((run.status, run.stdout.as_str()), (Some(2), "0\n1\n"));
    for message in [
        format!("error: {}: line 1: \"Fly\" is unknown", names[1]),
        format!("error: {}: line 3: the program has not ended", names[2]),
    ] {
        assert!(run.stderr.contains(&message), "{run:?}");
    }
}

/// A script answers its own questions, so it must not reach the user's own files.
#[test]
fn a_script_changes_nothing_outside_its_folder() {
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path().join("scripts");
    std::fs::create_dir(&folder).expect("made");
    let theirs = folder.join("theirs.svg");
    std::fs::write(&theirs, "theirs").expect("written");
    let outside = place.path().join("outside.svg");
    std::fs::write(&outside, "outside").expect("written");
    let run = |name: &str, script: &str, flags: &[&str]| {
        let file = folder.join(name);
        std::fs::write(&file, script).expect("written");
        let file = file.to_str().expect("text");
        run_in("C.UTF-8", &[&["script", file][..], flags].concat(), b"")
    };
    let export = |path: &str, answer: &str| {
        format!("Keys f<Enter>:write<Space>\nType \"{path}\"\nKeys <Enter>{answer}\nWait\nScreen\n")
    };
    // A refusal is shown on the screen.
    for (path, answer, refusal) in [
        ("../outside.svg", "", "a script writes only below"),
        ("theirs.svg", "y", "existed before the script"),
    ] {
        let shown = run("a.taxel", &export(path, answer), &["--size", "200x24"]);
        assert!(shown.stdout.contains(refusal), "{path}: {shown:?}");
    }
    let read = |path: &std::path::Path| std::fs::read_to_string(path).expect("there");
    assert_eq!(
        (read(&outside), read(&theirs)),
        ("outside".into(), "theirs".into())
    );
    // The script may write and replace its own files, also from another folder.
    let twice = export("own.svg", "") + &export("own.svg", "y");
    let own = run("b.taxel", &twice, &[]);
    assert_eq!(own.status, Some(0), "{own:?}");
    assert!(folder.join("own.svg").exists(), "{own:?}");
    // A script must not set up a device, make a connection, or wait for a pipe.
    let pipe = place.path().join("pipe");
    let mut sources = vec!["tcp://127.0.0.1:9", "-"];
    if wait::fifo(&pipe) {
        sources.push(pipe.to_str().expect("text"));
    }
    for source in sources {
        let script = format!("Source {source}\nFrames 1\nScreen\n");
        let refused = run("d.taxel", &script, &[]);
        let refusal = "a script reads frames only from files";
        assert!(refused.stderr.contains(refusal), "{source}: {refused:?}");
        assert_eq!(refused.status, Some(1), "{source}: {refused:?}");
    }
    // A library is refused before anything is done.
    let library = place.path().join("library");
    let script = format!(
        "Set library {:?}\nKeys f<Enter>sx<Enter>\n",
        library.display().to_string()
    );
    let refused = run("c.taxel", &script, &[]);
    assert_eq!(refused.status, Some(2), "{refused:?}");
    assert!(
        refused
            .stderr
            .contains("line 1: Set library needs --allow-outside"),
        "{refused:?}"
    );
    assert!(!library.exists());
    let allowed = run("c.taxel", &script, &["--allow-outside"]);
    assert_eq!(allowed.status, Some(0), "{allowed:?}");
    assert!(library.join("x.json").exists());
    let allowed = run(
        "a.taxel",
        &export(outside.to_str().expect("text"), "y"),
        &["--allow-outside"],
    );
    assert_eq!(allowed.status, Some(0), "{allowed:?}");
    assert!(read(&outside).starts_with('<'));
}
