//! File systems without some features, simulated with `strace`: locks, renaming without replacing, hard links, free
//! space. Also folders that a stranger has filled.

use std::fs::{self, Permissions};
use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
use std::path::Path;
use std::process::Command;

use taxel::storage::{Library, ModelFolder, Orphan};

use super::array;
use super::state::{State, program, shape, taxel};
use super::strace;

pub(crate) fn done_without() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    for error in ["ENOLCK", "EPERM", "EINVAL"] {
        let state = State::new();
        let new = state.new.to_string_lossy();
        let save = program(&["library", "save", "fresh", &new], &state.folder);
        let run = strace::refused(&save, "?flock", error);
        assert_eq!(run.status.code(), Some(0), "{error}: {run:?}");
        assert_eq!(state.version("fresh"), Some(9), "{error}");
    }
    let state = State::new();
    let target = state.folder.join("fresh.svg");
    let name = target.to_string_lossy();
    let export = program(&["figure", "hexagon", "--export", &name], &state.folder);
    let run = strace::refused(&export, "?renameat2,?link,?linkat", "EPERM");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    let text = fs::read_to_string(&target).expect("written");
    assert!(text.ends_with("</svg>\n"), "whole");
    // A recording continues in the file with the requested name, even if that is a copy.
    let (frames, array) = (
        state.folder.join("frames.txt"),
        state.folder.join("rec.npy"),
    );
    fs::write(&frames, "1 2\n3 4\n\n".repeat(50)).expect("written");
    let (source, name) = (frames.to_string_lossy(), array.to_string_lossy());
    let mut watch = Command::new(env!("CARGO_BIN_EXE_taxel"));
    let arguments = ["--format", "lines", "--once", "--at-least", "1", "--write"];
    watch
        .args(["watch", &source])
        .args(arguments)
        .arg(&*name)
        .env("TAXEL_CONFIG", "/dev/null");
    let run = strace::refused(&watch, "?linkat", "EPERM");
    assert_eq!(run.status.code(), Some(0), "{run:?}");
    assert_eq!(recorded(&array), 50);
    // The message names the requested file, not the temporary one.
    fs::remove_file(&target).expect("removed");
    let run = strace::refused(&export, "?fsync,?fdatasync", "EIO");
    let message = String::from_utf8_lossy(&run.stderr).into_owned();
    assert_eq!(run.status.code(), Some(1), "{run:?}");
    assert!(
        message.contains("fresh.svg: ") && !message.contains(".taxel-"),
        "{message}"
    );
    delete_a_model(&state);
    "no locks, no links, no names without replacing: saved; what is refused is told by its own name"
        .to_owned()
}

/// A model is removed for good, so its folder is synced before the deletion is reported.
fn delete_a_model(state: &State) {
    let models = ModelFolder::beside(&state.folder);
    fs::create_dir_all(models.path()).expect("made");
    fs::write(models.path().join("parts.npz"), "").expect("written");
    let delete = program(&["model", "delete", "parts"], &state.folder);
    let run = strace::refused(&delete, "?fsync,?fdatasync", "EIO");
    let message = String::from_utf8_lossy(&run.stderr).into_owned();
    let expected = "parts.npz: cannot delete: the folder was changed but cannot be synced";
    assert_eq!(run.status.code(), Some(1), "{run:?}");
    assert!(message.contains(expected), "{message}");
}

/// On file systems without modes and owners, and for users who may not set them.
pub(crate) fn owners() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    let replaced = |mode: u32, group: Option<u32>, calls: &str| {
        let state = State::new();
        let path = state.folder.join("one.json");
        fs::set_permissions(&path, Permissions::from_mode(mode)).expect("set");
        let given = group.is_none_or(|group| chown(&path, None, Some(group)).is_ok());
        let new = state.new.to_string_lossy();
        let save = program(&["library", "save", "one", &new, "--force"], &state.folder);
        let run = strace::refused(&save, calls, "EPERM");
        let found = path.metadata().expect("there");
        let now = (found.mode() & 0o777, found.gid());
        (given, run.status.code(), state.version("one"), now)
    };
    let own = State::new().new.metadata().expect("there").gid();
    // A file that replaces another one is private until it has its mode, and stays so if it cannot have it.
    for mode in [0o600, 0o644] {
        let done = (true, Some(0), Some(9), (0o600, own));
        let refused = "?fchmod,?fchmodat,?fchown";
        assert_eq!(replaced(mode, None, refused), done, "{mode:o}");
    }
    // Only root has a group to which it does not belong.
    if replaced(0o660, Some(2000), "?chroot").0 {
        let same = (true, Some(0), Some(9), (0o660, 2000));
        assert_eq!(replaced(0o660, Some(2000), "?chroot"), same);
        for (mode, narrowed) in [(0o660, 0o600), (0o640, 0o600), (0o664, 0o644)] {
            let expected = (true, Some(0), Some(9), (narrowed, own));
            assert_eq!(replaced(mode, Some(2000), "?fchown"), expected, "{mode:o}");
        }
    }
    "modes and groups that cannot be set: saved if nobody else can read it then".to_owned()
}

/// What took long is printed even if its file cannot be named at last.
pub(crate) fn printed() -> String {
    if !strace::works() {
        return "SKIPPED, strace is missing or may not trace".to_owned();
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (atlas, model) = (path("a.csv"), path("m.npz"));
    let sweep = [
        "sweep", "hexagon", "--angle", "0", "--quiet", "--atlas", &atlas,
    ];
    let train = [
        "model",
        "train",
        "washer",
        "key",
        "--positions",
        "2",
        "--angle",
        "0",
        "--quiet",
        "--out",
        &model,
    ];
    let cases: [(&[&str], &str, &str); 2] =
        [(&sweep, &atlas, "poses"), (&train, &model, "distinct")];
    for (arguments, file, printed) in cases {
        let run = strace::refused(
            &program(arguments, folder.path()),
            "?link,?linkat,?rename,?renameat,?renameat2",
            "EIO",
        );
        assert_eq!(run.status.code(), Some(1), "{run:?}");
        let [output, message] =
            [&run.stdout, &run.stderr].map(|text| String::from_utf8_lossy(text));
        assert!(output.contains(printed), "{output}");
        assert!(
            message.starts_with(&format!("error: {file}: ")),
            "{message}"
        );
        assert_eq!(fs::read_dir(folder.path()).expect("read").count(), 0);
    }
    "a sweep and a training whose files are refused: the summary is printed".to_owned()
}

/// Returns the number of frames in an array, and checks that its header and its length agree on it.
fn recorded(path: &Path) -> usize {
    let array = fs::read(path).expect("it is there");
    let records = (array.len() - 256) / (16 + 4 * 8);
    assert_eq!(array::records(&array), Some(records));
    records
}

pub(crate) fn crafted() -> String {
    let state = State::new();
    // The trash entry with the last number but one: later deletions must not be lost.
    let crafted = state.folder.join(".trash/18446744073709551614 z.json");
    fs::write(&crafted, shape("z", 5).write()).expect("written");
    assert!(
        taxel(&["library", "delete", "one"], &state.folder)
            .status
            .success()
    );
    assert!(
        taxel(&["library", "restore", "one"], &state.folder)
            .status
            .success()
    );
    assert_eq!(state.version("one"), Some(1));
    // More unsaved work than the number of files that a program may open.
    let journal = state.folder.join(".journal");
    fs::create_dir(&journal).expect("made");
    for number in 0..1500 {
        fs::write(journal.join(format!("{number}-0.lock")), "").expect("written");
        let work = shape(&format!("work {number}"), 7).write();
        fs::write(journal.join(format!("{number}-0.json")), work).expect("written");
    }
    let waiting = Orphan::all(&Library::open(state.folder.clone()));
    assert_eq!(waiting.len(), 100, "at once; the others wait");
    let list = taxel(&["library", "list"], &state.folder);
    assert!(list.status.success(), "{list:?}");
    "a crafted number in the trash, 1,500 journals: nothing lost, nothing refused".to_owned()
}
