//! Links, folders, pipes, read-only places and broken files: each is reported, and none affects the other shapes.
#![cfg(unix)]

use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::Path;
use std::process::Command;
use std::sync::mpsc::channel;
use std::time::Duration;

use taxel::storage::{Expected, Journal, Library, Orphan};

use super::Scratch;
use super::is_root;
use super::refusal;
use super::shape;
use crate::skip::skipped;

fn pipe(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status();
    assert!(made.expect("mkfifo starts").success(), "a pipe");
}

/// Fails if an action waits, as when opening a pipe.
fn soon<T: Send + 'static>(act: impl FnOnce() -> T + Send + 'static) -> T {
    let (done, waiting) = channel();
    std::thread::spawn(move || done.send(act()));
    let result = waiting.recv_timeout(Duration::from_secs(20));
    result.expect("it does not wait")
}

#[test]
fn entries_that_are_not_files_are_reported_and_left_alone() {
    let scratch = Scratch::with(&["good"]);
    let outside = tempfile::NamedTempFile::new().expect("a file");
    fs::write(outside.path(), shape("out", 7).write()).expect("written");
    symlink(outside.path(), scratch.path("link.json")).expect("a link");
    symlink("nowhere", scratch.path("dangling.json")).expect("a link");
    fs::create_dir(scratch.path("dir.json")).expect("a folder");
    pipe(&scratch.path("pipe.json"));
    for (name, what) in [
        ("link", "a symbolic link"),
        ("dangling", "a symbolic link"),
        ("dir", "a folder"),
        ("pipe", "a FIFO"),
    ] {
        let expected = format!("FOLDER/{name}.json: is {what}, expected a regular file");
        let library = scratch.library.clone();
        let (loaded, saved, replaced, deleted) = soon(move || {
            let new = shape(name, 9);
            (
                library.load(name),
                library.save(&new, Expected::Nothing),
                library.save(&new, Expected::Stamp(0)),
                library.delete(name),
            )
        });
        assert_eq!(refusal(loaded, &scratch), expected);
        assert_eq!(refusal(saved, &scratch), expected);
        assert_eq!(refusal(replaced, &scratch), expected);
        assert_eq!(refusal(deleted, &scratch), expected);
        assert!(
            fs::symlink_metadata(scratch.path(&format!("{name}.json"))).is_ok(),
            "{name}"
        );
    }
    let through = fs::read(outside.path()).expect("still there");
    assert_eq!(
        through,
        shape("out", 7).write().into_bytes(),
        "nothing is written through a link"
    );
    assert_eq!(scratch.own(), ["dangling", "dir", "good", "link", "pipe"]);
    assert_eq!(scratch.number("good"), Some(1));
}

#[test]
fn a_pipe_or_a_link_instead_of_a_lock_does_not_block_the_start() {
    for make in [pipe, |path: &Path| {
        symlink("/dev/null", path).expect("a link");
    }] {
        let scratch = Scratch::new();
        fs::create_dir(scratch.path(".journal")).expect("made");
        make(&scratch.path(".lock"));
        make(&scratch.path(".journal/1-0.lock"));
        make(&scratch.path(".journal/2-0.json"));
        scratch.put(".journal/1-0.json", shape("work", 1).write());
        scratch.put(".taxel-tmp", "{");
        let folder = scratch.folder.clone();
        let (listed, orphans, saved) = soon(move || {
            let library = Library::open(folder);
            (
                library.list().is_ok(),
                Orphan::all(&library).len(),
                library.save(&shape("new", 1), Expected::Nothing),
            )
        });
        assert!(listed && orphans == 0);
        let message = refusal(saved, &scratch);
        assert!(message.starts_with("FOLDER/.lock: is "), "{message}");
    }
}

#[test]
fn a_library_path_that_is_not_a_folder_is_reported() {
    let scratch = Scratch::new();
    scratch.put("file", "");
    symlink("nowhere", scratch.path("dangling")).expect("a link");
    for (inner, message) in [
        ("file", "FOLDER/file: is a file, expected a folder"),
        ("file/inner", "FOLDER/file: is a file, expected a folder"),
        (
            "dangling",
            "FOLDER/dangling: is a broken symbolic link, expected a folder",
        ),
    ] {
        let library = Library::open(scratch.path(inner));
        let saved = library.save(&shape("new", 1), Expected::Nothing);
        assert_eq!(refusal(saved, &scratch), message);
        assert_eq!(Orphan::all(&library).len(), 0);
        let kept = Journal::new(&library).keep(&shape("work", 1));
        assert_eq!(refusal(kept, &scratch), message);
    }
    let library = Library::open(scratch.path("file"));
    let message = "FOLDER/file: cannot read the folder: it is a file";
    assert_eq!(refusal(library.list(), &scratch), message);
    let folder = scratch.path("a/b/c");
    let library = Library::open(folder.clone());
    assert!(library.list().is_ok() && library.load("new").is_err());
    assert!(!scratch.path("a").exists(), "nothing is made by looking");
    library
        .save(&shape("new", 1), Expected::Nothing)
        .expect("made with those above it");
    symlink(&folder, scratch.path("linked")).expect("a link");
    let linked = Library::open(scratch.path("linked"));
    assert!(
        linked.load("new").is_ok(),
        "a link to a folder is as good as one"
    );
}

#[test]
fn trash_and_journal_cannot_lead_out_of_the_library() {
    for inner in [".trash", ".journal"] {
        let elsewhere = tempfile::tempdir().expect("a folder");
        let scratch = Scratch::with(&["one"]);
        symlink(elsewhere.path(), scratch.path(inner)).expect("a link");
        let deleted = scratch.library.delete("one");
        let kept = Journal::new(&scratch.library).keep(&shape("work", 1));
        let message = format!("FOLDER/{inner}: is a symbolic link, expected a folder");
        if inner == ".trash" {
            assert_eq!(refusal(deleted, &scratch), message);
            assert_eq!(scratch.number("one"), Some(1));
        } else {
            assert_eq!(refusal(kept, &scratch), message);
        }
        assert_eq!(super::files(elsewhere.path()), [""; 0]);
    }
}

#[test]
fn a_shape_is_not_restored_from_outside_of_the_library() {
    let elsewhere = tempfile::tempdir().expect("a folder");
    let thesis = elsewhere.path().join("1 thesis.json");
    fs::write(&thesis, "precious").expect("written");
    let scratch = Scratch::new();
    symlink(elsewhere.path(), scratch.path(".trash")).expect("a link");
    let message = "FOLDER/.trash: is a symbolic link, expected a folder";
    let library = &scratch.library;
    assert_eq!(refusal(library.restore("thesis"), &scratch), message);
    assert_eq!(refusal(library.restore_last(), &scratch), message);
    assert_eq!(refusal(library.in_trash(), &scratch), message);
    assert!(thesis.exists());
}

/// In a folder that a link leads to, even files that are called like journals belong to others.
#[test]
fn a_start_leaves_files_of_others_alone() {
    let precious = [
        "1-0.lock",
        "2-0.json",
        "2-0.tmp",
        "3-0.json",
        "4-0.lock",
        "4-0.tmp",
        "Cargo.lock",
        "notes.json",
        "notes.tmp",
        "work.json",
    ];
    for (is_linked, left) in [(true, &precious[..]), (false, &precious[6..])] {
        let elsewhere = tempfile::tempdir().expect("a folder");
        let scratch = Scratch::new();
        if is_linked {
            symlink(elsewhere.path(), scratch.path(".journal")).expect("a link");
        } else {
            fs::create_dir(scratch.path(".journal")).expect("made");
        }
        let journal = scratch.path(".journal");
        for name in left {
            fs::write(journal.join(name), "precious").expect("written");
        }
        // A shape can be read, and would be offered.
        fs::write(journal.join("work.json"), shape("work", 7).write()).expect("written");
        assert_eq!(Orphan::all(&scratch.library).len(), 0);
        assert_eq!(super::files(&journal), left);
    }
}

#[test]
fn a_check_reports_links_and_files_of_others_in_inner_folders() {
    let scratch = Scratch::new();
    fs::create_dir(scratch.path(".journal")).expect("made");
    scratch.put(".journal/1-0.json", "");
    scratch.put(".journal/1-0.lock", "");
    scratch.put(".journal/notes.json", "");
    symlink("nowhere", scratch.path(".trash")).expect("a link");
    let left = || {
        let left = scratch.library.leftovers().expect("read").into_iter();
        left.map(|(path, what)| {
            let path = path.strip_prefix(&scratch.folder).expect("inside");
            format!("{}: {what}", path.display())
        })
        .collect::<Vec<_>>()
    };
    let link = ".trash: a symbolic link, which is not followed";
    let unsaved = "unsaved work, of a running program or of one that died";
    assert_eq!(
        left(),
        [
            &format!(".journal/1-0.json: {unsaved}"),
            ".journal/notes.json: not a journal",
            link,
        ]
    );
    fs::rename(scratch.path(".journal"), scratch.path("elsewhere")).expect("moved");
    symlink("elsewhere", scratch.path(".journal")).expect("a link");
    let journal = ".journal: a symbolic link, which is not followed";
    let folder = "elsewhere: not a shape: its name is not NAME.json";
    assert_eq!(left(), [journal, link, folder]);
}

#[test]
fn broken_files_are_listed_and_reported_without_affecting_others() {
    let scratch = Scratch::with(&["good"]);
    let good = shape("x", 1).write();
    for (name, content, message) in [
        (
            "cut",
            &good[..good.len() / 2],
            "line 15, column 20: imprint: EOF while parsing a string",
        ),
        ("empty", "", "line 1, column 1: EOF while parsing a value"),
        (
            "newer",
            &good.replace("shape/1", "shape/2"),
            "format: \"taxel-shape/2\" is unknown to this version, which reads \"taxel-shape/1\"",
        ),
        (
            "ragged",
            &good.replacen("................\"", "...\"", 1),
            "line 12, column 9: imprint: row 2 has 3 characters, expected 16 as in the first row",
        ),
        (
            "named",
            &good.replacen("\"x\",", "\"x/y\"\n,", 1),
            "line 3, column 15: name: '/' cannot be in a name",
        ),
        (
            "wide",
            &good.replacen("\"columns\": 16", "\"columns\": 99", 1),
            "line 9, column 3: sensor: columns: 99 is above 64",
        ),
        (
            "other",
            &good.replacen("\"name\"", "\"nom\"", 1),
            "unknown key \"nom\"",
        ),
        (
            "huge",
            &" ".repeat((1 << 20) + 1),
            "larger than 1 MiB, the limit for a shape",
        ),
    ] {
        scratch.put(&format!("{name}.json"), content);
        let told = refusal(scratch.library.load(name), &scratch);
        let start = format!("FOLDER/{name}.json: ");
        assert!(told.starts_with(&start) && told.contains(message), "{told}");
    }
    let all = [
        "cut", "empty", "good", "huge", "named", "newer", "other", "ragged", "wide",
    ];
    assert_eq!(scratch.own(), all);
    assert_eq!(scratch.number("good"), Some(1));
    // A broken file is moved into the trash and back unchanged.
    scratch.library.delete("cut").expect("deleted");
    scratch.library.restore("cut").expect("restored");
    let back = fs::read_to_string(scratch.path("cut.json")).expect("there");
    assert_eq!(back, good[..good.len() / 2]);
}

#[test]
fn foreign_files_are_skipped_and_reported() {
    let scratch = Scratch::with(&["good"]);
    for file in [
        "notes.txt",
        "a:b.json",
        ".hidden.json",
        "good.json~",
        "x.JSON",
    ] {
        scratch.put(file, "");
    }
    scratch.put(".taxel-tmp", "");
    fs::create_dir(scratch.path(".trash")).expect("made");
    scratch.put(".trash/.taxel-tmp", "");
    assert_eq!(scratch.own(), ["good"]);
    let left = scratch.library.leftovers().expect("read").into_iter();
    let left: Vec<String> = left
        .map(|(path, _)| {
            let path = path.strip_prefix(&scratch.folder).expect("inside");
            path.display().to_string()
        })
        .collect();
    assert_eq!(
        left,
        [
            ".hidden.json",
            ".taxel-tmp",
            ".trash/.taxel-tmp",
            "a:b.json",
            "good.json~",
            "notes.txt",
            "x.JSON"
        ]
    );
    let again = Library::open(scratch.folder.clone());
    assert_eq!(
        again.leftovers().expect("read").len(),
        5,
        "swept at a start"
    );
}

#[test]
fn read_only_files_are_not_replaced_and_modes_are_kept() {
    let scratch = Scratch::with(&["kept", "own"]);
    let mode = |name: &str| {
        let found = fs::metadata(scratch.path(name)).expect("there");
        found.permissions().mode() & 0o7777
    };
    let stamp = |name: &str| scratch.library.load(name).expect("loaded").stamp;
    fs::set_permissions(scratch.path("kept.json"), Permissions::from_mode(0o444)).expect("set");
    fs::set_permissions(scratch.path("own.json"), Permissions::from_mode(0o6640)).expect("set");
    let kept = scratch
        .library
        .save(&shape("kept", 9), Expected::Stamp(stamp("kept")));
    let message = "FOLDER/kept.json: cannot replace it, it is read-only: permission denied";
    assert_eq!(refusal(kept, &scratch), message);
    let own = scratch
        .library
        .save(&shape("own", 9), Expected::Stamp(stamp("own")));
    assert!(own.is_ok());
    assert_eq!(
        (scratch.number("kept"), scratch.number("own")),
        (Some(1), Some(9))
    );
    // It may have another owner now, and does not run as that one.
    assert_eq!((mode("kept.json"), mode("own.json")), (0o444, 0o640));
}

#[test]
fn a_folder_with_the_name_of_a_temporary_file_is_no_obstacle() {
    let scratch = Scratch::with(&["one"]);
    for folder in [".taxel-tmp", ".trash/.taxel-tmp"] {
        fs::create_dir_all(scratch.path(folder)).expect("made");
    }
    scratch.save("two", 2);
    let thrown = scratch.library.throw_away(&shape("lost", 3));
    assert_eq!(thrown.expect("thrown away"), "lost 1");
    assert_eq!(scratch.own(), ["one", "two"]);
    assert!(scratch.path(".taxel-tmp").is_dir());
}

#[test]
fn a_read_only_folder_can_be_read() {
    if is_root() {
        skipped("root may write everywhere; tests/crash does this with a read-only disk");
        return;
    }
    let scratch = Scratch::with(&["one"]);
    let mode = |mode| fs::set_permissions(&scratch.folder, Permissions::from_mode(mode));
    mode(0o555).expect("set");
    let again = Library::open(scratch.folder.clone());
    let (listed, loaded) = (scratch.own(), scratch.number("one"));
    let saved = again.save(&shape("new", 1), Expected::Nothing);
    let deleted = again.delete("one");
    mode(0o755).expect("set");
    assert_eq!((listed, loaded), (vec!["one".to_owned()], Some(1)));
    for message in [refusal(saved, &scratch), refusal(deleted, &scratch)] {
        assert!(
            message.starts_with("FOLDER") && message.contains("Permission denied"),
            "{message}"
        );
    }
    // In a writable folder, another user's lock file is sufficient.
    fs::set_permissions(scratch.path(".lock"), Permissions::from_mode(0o444)).expect("set");
    scratch.save("new", 1);
}
