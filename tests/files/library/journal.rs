//! Unsaved work is kept and offered back, but never taken from a running program.

use std::time::{Duration, Instant};

use taxel::formats::{Name, StoredShape};
use taxel::prelude::*;
use taxel::storage::{Expected, Journal, Orphan};

use super::Scratch;
use super::files;
use super::shape;

fn offered(scratch: &Scratch) -> Vec<StoredShape> {
    let orphans = Orphan::all(&scratch.library);
    orphans.into_iter().map(|orphan| orphan.shape).collect()
}

/// Like [`offered`], but waits until something is offered: programs that other tests start inherit open files, and so
/// the locks of journals, for a moment.
fn offered_soon(scratch: &Scratch) -> Vec<StoredShape> {
    let end = Instant::now() + Duration::from_secs(10);
    loop {
        let found = offered(scratch);
        if !found.is_empty() || Instant::now() > end {
            return found;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Leaves work like a program that died.
fn left(scratch: &Scratch, work: &StoredShape) {
    let mut journal = Journal::new(&scratch.library);
    journal.keep(work).expect("kept");
}

#[test]
fn work_of_a_dead_program_is_offered_until_it_is_discarded() {
    let scratch = Scratch::new();
    assert_eq!(offered(&scratch), []);
    let mut journal = Journal::new(&scratch.library);
    journal.keep(&shape("work", 1)).expect("kept");
    journal.keep(&shape("work", 2)).expect("kept");
    assert_eq!(offered(&scratch), [], "its program is running");
    drop(journal);
    assert_eq!(offered_soon(&scratch), [shape("work", 2)]);
    let orphans = Orphan::all(&scratch.library);
    assert_eq!(offered(&scratch), [], "another program looks at it");
    drop(orphans);
    for orphan in Orphan::all(&scratch.library) {
        orphan.discard();
    }
    assert_eq!(files(&scratch.path(".journal")), [""; 0]);
}

/// A name begins with the number of a process, which does not grow with time.
#[test]
fn the_newest_work_comes_last_regardless_of_its_name() {
    let scratch = Scratch::new();
    left(&scratch, &shape("work", 1));
    let folder = scratch.path(".journal");
    let own = folder.join(&files(&folder)[0]).with_extension("json");
    let now = std::time::SystemTime::now();
    for (seconds, name) in [(30, "4711-0"), (20, "999-0"), (10, "1-10"), (10, "1-9")] {
        let path = folder.join(name).with_extension("json");
        std::fs::write(&path, shape(&format!("w{name}"), 1).write()).expect("written");
        let file = std::fs::File::options().write(true).open(&path);
        let changed = now - Duration::from_secs(seconds);
        file.expect("opened").set_modified(changed).expect("set");
    }
    std::fs::remove_file(own).expect("removed");
    let names = offered(&scratch).into_iter().map(|work| work.name);
    let names: Vec<String> = names.map(|name| name.to_string()).collect();
    assert_eq!(names, ["w4711-0", "w999-0", "w1-9", "w1-10"]);
}

#[test]
fn cleared_work_is_gone_and_more_can_be_kept() {
    let scratch = Scratch::new();
    let mut journal = Journal::new(&scratch.library);
    journal.clear();
    journal.keep(&shape("work", 1)).expect("kept");
    journal.clear();
    assert_eq!(files(&scratch.path(".journal")), [""; 0]);
    journal.keep(&shape("work", 2)).expect("kept");
    drop(journal);
    assert_eq!(offered_soon(&scratch), [shape("work", 2)]);
}

/// The user has removed the folder while the program runs.
#[test]
fn a_folder_that_was_removed_is_made_again() {
    let scratch = Scratch::new();
    let mut journal = Journal::new(&scratch.library);
    journal.keep(&shape("work", 1)).expect("kept");
    std::fs::remove_dir_all(scratch.path(".journal")).expect("it is there");
    journal.keep(&shape("work", 2)).expect("kept again");
    drop(journal);
    assert_eq!(offered_soon(&scratch), [shape("work", 2)]);
}

/// Without its lock, other programs would offer the work while this one runs.
#[test]
fn a_journal_whose_lock_was_removed_gets_another_one() {
    for removed in [".lock", ""] {
        let scratch = Scratch::new();
        let mut journal = Journal::new(&scratch.library);
        journal.keep(&shape("work", 1)).expect("kept");
        assert!(journal.is_intact());
        for file in files(&scratch.path(".journal")) {
            if file.ends_with(removed) {
                std::fs::remove_file(scratch.path(".journal").join(file)).expect("removed");
            }
        }
        assert!(!journal.is_intact());
        journal.keep(&shape("work", 2)).expect("kept again");
        assert!(journal.is_intact());
        assert_eq!(offered(&scratch), [], "its program is running");
        drop(journal);
        assert_eq!(offered_soon(&scratch), [shape("work", 2)], "{removed:?}");
    }
}

/// It would be offered again and again, and each refusal would fill the trash.
#[cfg(unix)]
#[test]
fn work_that_this_user_cannot_remove_is_not_offered() {
    use std::fs::{Permissions, set_permissions};
    use std::os::unix::fs::PermissionsExt;
    if super::is_root() {
        crate::skip::skipped("root may remove everything");
        return;
    }
    let scratch = Scratch::new();
    left(&scratch, &shape("work", 1));
    assert_eq!(offered_soon(&scratch).len(), 1);
    let mode = |mode| set_permissions(scratch.path(".journal"), Permissions::from_mode(mode));
    mode(0o555).expect("set");
    let found = offered(&scratch);
    mode(0o755).expect("set");
    assert_eq!(found, []);
}

#[test]
fn each_of_several_programs_keeps_its_own_work() {
    let scratch = Scratch::new();
    let mut journals: Vec<Journal> = (0..5).map(|_| Journal::new(&scratch.library)).collect();
    for (number, journal) in journals.iter_mut().enumerate() {
        journal.keep(&shape("work", number)).expect("kept");
    }
    let running = journals.split_off(3);
    drop(journals);
    // An empty matrix is not worth recovering.
    assert_eq!(offered_soon(&scratch), [shape("work", 1), shape("work", 2)]);
    drop(running);
    assert_eq!(offered(&scratch).len(), 4);
}

#[test]
fn only_work_that_is_not_saved_is_offered() {
    let scratch = Scratch::with(&["one"]);
    left(&scratch, &shape("one", 1));
    assert_eq!(offered(&scratch), [], "just so it is saved");
    assert_eq!(files(&scratch.path(".journal")), [""; 0]);
    left(&scratch, &shape("one", 2));
    left(&scratch, &shape("other", 1));
    assert_eq!(offered(&scratch).len(), 2);
    let stamp = scratch.library.load("one").expect("loaded").stamp;
    scratch
        .library
        .save(&shape("one", 2), Expected::Stamp(stamp))
        .expect("saved");
    assert_eq!(offered_soon(&scratch), [shape("other", 1)]);
    let washer = scratch.library.load("washer").expect("shipped").shape;
    left(&scratch, &washer);
    assert_eq!(offered_soon(&scratch), [shape("other", 1)]);
}

#[test]
fn a_figure_with_an_empty_imprint_is_also_offered() {
    let scratch = Scratch::new();
    let sensor = Sensor::default();
    let dot = Figure::rectangle(0.5, 0.5).on(&sensor).expect("in range");
    let name = Name::new("dot").expect("a name");
    let nothing = Imprint::empty(Sensor::default().size());
    let of = |source| StoredShape::new(name.clone(), sensor, nothing, source);
    left(&scratch, &of(None).expect("16 x 16 both"));
    assert_eq!(offered(&scratch), []);
    let work = of(Some(dot.into())).expect("16 x 16 both");
    left(&scratch, &work);
    assert_eq!(offered_soon(&scratch), [work]);
}

#[test]
fn only_the_newest_hundred_works_are_offered() {
    let scratch = Scratch::new();
    left(&scratch, &shape("work", 1));
    let folder = scratch.path(".journal");
    let now = std::time::SystemTime::now();
    for number in 0..101 {
        let path = folder.join(format!("1-{number}.json"));
        std::fs::write(&path, shape(&format!("w{number}"), 1).write()).expect("written");
        let file = std::fs::File::options().write(true).open(&path);
        let changed = now + Duration::from_secs(number);
        file.expect("opened").set_modified(changed).expect("set");
    }
    let names: Vec<String> = offered(&scratch)
        .iter()
        .map(|work| work.name.to_string())
        .collect();
    let newest: Vec<String> = (1..101).map(|number| format!("w{number}")).collect();
    assert_eq!(names, newest);
}

#[test]
fn unreadable_work_is_kept_and_half_written_files_are_removed() {
    let scratch = Scratch::new();
    left(&scratch, &shape("work", 1));
    let newer = shape("work", 2).write().replace("shape/1", "shape/2");
    scratch.put(".journal/1-0.json", &newer);
    scratch.put(".journal/1-0.tmp", "{");
    scratch.put(".journal/2-0.json", "{");
    scratch.put(".journal/3-0.lock", "");
    scratch.put(".journal/3-0.tmp", "{");
    scratch.put(".journal/4-0.lock", "");
    scratch.put(".journal/notes.txt", "");
    assert_eq!(offered_soon(&scratch), [shape("work", 1)]);
    let mut left = files(&scratch.path(".journal"));
    left.retain(|name| !name.starts_with(&std::process::id().to_string()));
    assert_eq!(
        left,
        [
            "1-0.json",
            "1-0.lock",
            "1-0.tmp",
            "2-0.json",
            "2-0.lock",
            "notes.txt"
        ]
    );
    // The journal of another program with the same process number is not overwritten.
    let own = std::process::id();
    scratch.put(&format!(".journal/{own}-1.json"), &newer);
    let mut journals = [0, 1].map(|_| Journal::new(&scratch.library));
    for journal in &mut journals {
        journal.keep(&shape("work", 5)).expect("kept");
    }
    let kept = std::fs::read_to_string(scratch.path(&format!(".journal/{own}-1.json")));
    assert_eq!(kept.ok(), Some(newer));
}
