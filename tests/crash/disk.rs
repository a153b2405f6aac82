//! A full disk and a read-only disk: small ones in memory, mounted for one program only.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::act;
use super::array;
use super::state::State;
use super::state::finish;
use super::state::program;
use super::state::shape;
use super::state::taxel;
use taxel::storage::{Expected, Journal, Library, Orphan, ShapeOrigin};
use taxel::tui::app::state::Options;
use taxel::tui::runtime::World;
use taxel::tui::script::Session;

/// The exit status of a program that is not allowed to mount.
const NOT_ALLOWED: i32 = 77;

/// Performs an act with a disk of 64 KiB mounted over the library's folder.
fn on_own_disk(act: &str) -> Result<(), String> {
    let state = State::new();
    let own = act::command(act, &state.folder);
    let mut command = Command::new("unshare");
    command
        .args(["--map-root-user", "--mount", "sh", "-c"])
        .arg("mount -t tmpfs -o size=64k taxel \"$1\" || exit 77; exec \"$0\"")
        .arg(own.get_program())
        .arg(&state.folder)
        .envs(
            own.get_envs()
                .filter_map(|(name, value)| Some((name, value?))),
        );
    if Command::new("unshare").arg("--version").output().is_err() {
        return Err("SKIPPED, there is no unshare".to_owned());
    }
    let output = finish(&mut command);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    match output.status.code() {
        Some(0) => Ok(()),
        Some(NOT_ALLOWED) => Err("SKIPPED, nothing may be mounted".to_owned()),
        _ if message.starts_with("unshare:") => {
            Err(format!("SKIPPED, nothing may be mounted: {message}"))
        }
        _ => panic!("{message}"),
    }
}

pub(crate) fn full() -> String {
    let done = "message, status 1, old file whole, nothing left behind".to_owned();
    on_own_disk("full").map_or_else(|skipped| skipped, |()| done)
}

pub(crate) fn full_of_frames() -> String {
    let done = "all whole records counted, the reason beside them".to_owned();
    on_own_disk("full-recording").map_or_else(|skipped| skipped, |()| done)
}

pub(crate) fn read_only() -> String {
    let done = "listed, loaded, work offered back; saving and deleting refused".to_owned();
    on_own_disk("read-only").map_or_else(|skipped| skipped, |()| done)
}

/// Runs on the mounted disk, which it fills to the last byte.
pub(crate) fn on_full_disk(folder: &Path) {
    let library = Library::open(folder.to_owned());
    let stamp = library.save(&shape("one", 1), Expected::Nothing);
    let stamp = stamp.expect("there is room");
    let mut journal = Journal::new(&library);
    journal.keep(&shape("work", 1)).expect("there is room");
    let mut size = 1 << 16;
    for number in 0.. {
        while size > 0
            && fs::write(folder.join(format!("filler {number}")), vec![b'x'; size]).is_err()
        {
            size /= 2;
        }
        if size == 0 {
            break;
        }
    }
    let saved = library.save(&shape("one", 9), Expected::Stamp(stamp));
    let message = saved.expect_err("no room").to_string();
    assert!(
        message.contains("one.json") && message.contains("No space left on device"),
        "{message}"
    );
    let kept = journal.keep(&shape("work", 2));
    let message = kept.expect_err("no room").to_string();
    assert!(message.contains("No space left on device"), "{message}");
    drop(journal);
    assert_eq!(
        library.load("one").map(|one| one.shape).ok(),
        Some(shape("one", 1))
    );
    let work = Orphan::all(&library).into_iter().next();
    assert_eq!(work.map(|work| work.shape), Some(shape("work", 1)));
    let run = taxel(&["figure", "hexagon", "--save", "new"], folder);
    assert_eq!(
        (run.status.code(), run.stdout.len()),
        (Some(1), 0),
        "{run:?}"
    );
    let leftovers = library.leftovers().expect("read").into_iter();
    let half: Vec<_> = leftovers
        .filter(|(_, what)| what.contains("half"))
        .collect();
    assert_eq!(half, []);
    // Deleting needs no room except for the trash folder, and frees none. It may fail, but its result must be true.
    let deleted = library.delete("one");
    assert!(deleted.is_ok() == library.load("one").is_err());
    if deleted.is_ok() {
        library.restore("one").expect("back again");
    }
}

/// Runs on the mounted disk: records more frames than fit.
pub(crate) fn records_on_full_disk(folder: &Path) {
    let elsewhere = tempfile::tempdir().expect("there is a folder for temporary files");
    let source = elsewhere.path().join("frames.txt");
    fs::write(&source, "1 2\n3 4\n\n".repeat(6000)).expect("written");
    let touch = folder.join("touch.npy");
    let paths = [&source, &touch].map(|path| path.to_string_lossy().into_owned());
    let arguments = ["watch", &paths[0], "--once", "--write", &paths[1]];
    let run = program(&arguments, folder).output().expect("it runs");
    let said = String::from_utf8_lossy(&run.stderr);
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(said.contains("No space left on device"), "{said}");
    let bytes = fs::read(&touch).expect("it is there");
    let records = (bytes.len() - 256) / 48;
    assert!(records > 100 && bytes.len() == 256 + 48 * records);
    assert_eq!(array::records(&bytes), Some(records));
    let beside = fs::read(touch.with_extension("json")).expect("it is there");
    let beside: serde_json::Value = serde_json::from_slice(&beside).expect("whole");
    assert_eq!(beside["ended"], true, "{beside}");
    let reason = beside["ended_by"].as_str().expect("a reason");
    assert!(reason.contains("No space left on device"), "{reason}");
}

/// Runs on the mounted disk: what is there can be read, but nothing can be changed.
pub(crate) fn on_read_only_disk(folder: &Path) {
    let library = Library::open(folder.to_owned());
    library
        .save(&shape("one", 1), Expected::Nothing)
        .expect("saved");
    let mut journal = Journal::new(&library);
    journal.keep(&shape("work", 1)).expect("kept");
    drop(journal);
    fs::write(folder.join(".taxel-tmp"), "{").expect("written");
    let mounted = Command::new("mount")
        .args(["-o", "remount,bind,ro"])
        .arg(folder)
        .status();
    if !mounted.is_ok_and(|status| status.success()) {
        std::process::exit(NOT_ALLOWED);
    }
    let library = Library::open(folder.to_owned());
    let own = library.list().expect("listed").into_iter();
    let own = own.filter(|entry| entry.origin == ShapeOrigin::Own).count();
    assert_eq!(own, 1);
    let one = library.load("one").expect("loaded");
    let work = Orphan::all(&library);
    assert_eq!(work.len(), 1, "offered");
    let read_only = |error: Option<String>| {
        let message = error.expect("refused");
        assert!(message.contains("Read-only file system"), "{message}");
    };
    let text = |error: taxel::storage::LibraryError| error.to_string();
    read_only(
        library
            .save(&shape("one", 2), Expected::Stamp(one.stamp))
            .map_err(text)
            .err(),
    );
    read_only(
        library
            .save(&shape("new", 2), Expected::Nothing)
            .map_err(text)
            .err(),
    );
    read_only(library.delete("one").map_err(text).err());
    read_only(
        Journal::new(&library)
            .keep(&shape("work", 2))
            .map_err(text)
            .err(),
    );
    let list = taxel(&["library", "list"], folder);
    assert_eq!(list.status.code(), Some(0), "{list:?}");
    on_the_screen(library);
}

/// The screen says it in its own words, and before a question.
fn on_the_screen(library: Library) {
    let world = World::for_script(library);
    let mut session = Session::new(&Options::plain(false), world, 80, 24);
    for (keys, said) in [
        (
            "<Space>snew<Enter>",
            "! not saved: the library is read-only; :write FILE saves elsewhere",
        ),
        (
            "<Esc>done<Enter>",
            "! not deleted: the library is read-only",
        ),
    ] {
        session.keys(keys).expect("the keys of a test are right");
        let screen = session.screen();
        assert!(screen.contains(said), "{screen}");
    }
}
