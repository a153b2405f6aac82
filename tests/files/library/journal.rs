//! Unsaved work is kept and offered back, but never taken from a running program.

use std::time::{Duration, Instant};

use taxel_core::prelude::*;
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::{Expected, Journal, Orphan};

use super::{Scratch, files, shape};

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
fn left(scratch: &Scratch, work: &[StoredShape]) {
    let mut journal = Journal::new(&scratch.library);
    journal.keep(work.to_vec()).expect("kept");
}

#[test]
fn work_of_a_dead_program_is_offered_until_it_is_discarded() {
    let scratch = Scratch::new();
    assert_eq!(offered(&scratch), []);
    let [one, two, three] = [1, 2, 3].map(|number| shape("work", number));
    let mut journal = Journal::new(&scratch.library);
    journal.keep(vec![one.clone()]).expect("kept");
    let all = vec![two.clone(), three.clone()];
    journal.keep(all.clone()).expect("kept");
    assert_eq!(
        files(&scratch.path(".journal")).len(),
        1,
        "one file a program"
    );
    assert_eq!(offered(&scratch), [], "its program is running");
    drop(journal);
    assert_eq!(offered_soon(&scratch), all);
    let mut orphans = Orphan::all(&scratch.library);
    assert_eq!(offered(&scratch), [], "another program looks at it");
    assert!(orphans.pop().is_some_and(Orphan::discard));
    assert_eq!(
        offered(&scratch),
        [],
        "one of its pieces is still looked at"
    );
    drop(orphans);
    assert_eq!(offered_soon(&scratch), [two]);
    for orphan in Orphan::all(&scratch.library) {
        assert!(orphan.discard());
    }
    assert_eq!(files(&scratch.path(".journal")), [""; 0]);
}

#[test]
fn cleared_work_is_gone_and_more_can_be_kept() {
    let scratch = Scratch::new();
    let mut journal = Journal::new(&scratch.library);
    journal.keep(Vec::new()).expect("nothing to do");
    journal.keep(vec![shape("work", 1)]).expect("kept");
    journal.keep(Vec::new()).expect("cleared");
    assert_eq!(files(&scratch.path(".journal")), [""; 0]);
    journal.keep(vec![shape("work", 2)]).expect("kept");
    assert!(journal.is_intact());
    // The user removes the folder while the program runs.
    std::fs::remove_dir_all(scratch.path(".journal")).expect("it is there");
    assert!(!journal.is_intact());
    journal.keep(vec![shape("work", 3)]).expect("kept again");
    assert!(journal.is_intact());
    drop(journal);
    assert_eq!(offered_soon(&scratch), [shape("work", 3)]);
}

#[test]
fn each_of_several_programs_keeps_its_own_work() {
    let scratch = Scratch::new();
    let mut journals: Vec<Journal> = (0..5).map(|_| Journal::new(&scratch.library)).collect();
    for (number, journal) in journals.iter_mut().enumerate() {
        journal.keep(vec![shape("work", number)]).expect("kept");
    }
    let running = journals.split_off(3);
    drop(journals);
    // An empty matrix is not worth recovering.
    assert_eq!(offered_soon(&scratch), [shape("work", 1), shape("work", 2)]);
    drop(running);
    assert_eq!(offered_soon(&scratch).len(), 4);
}

#[test]
fn only_work_that_is_not_saved_is_offered() {
    let scratch = Scratch::with(&["one"]);
    left(&scratch, &[shape("one", 1)]);
    assert_eq!(offered(&scratch), [], "just so it is saved");
    assert_eq!(files(&scratch.path(".journal")), [""; 0]);
    left(&scratch, &[shape("one", 2), shape("other", 1)]);
    assert_eq!(offered_soon(&scratch).len(), 2);
    let saved = scratch.library.save(&shape("one", 2), Expected::Anything);
    saved.expect("saved");
    assert_eq!(offered_soon(&scratch), [shape("other", 1)]);
    let washer = scratch.library.load("washer").expect("shipped").shape;
    left(&scratch, &[washer]);
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
    let work = of(Some(dot.into())).expect("16 x 16 both");
    left(&scratch, &[of(None).expect("16 x 16 both"), work.clone()]);
    assert_eq!(offered_soon(&scratch), [work]);
}

#[test]
fn unreadable_work_stays_where_it_is() {
    let scratch = Scratch::new();
    left(&scratch, &[shape("work", 1)]);
    let newer = shape("work", 2).write().replace("shape/1", "shape/2");
    let newer = format!("[{newer}]");
    scratch.put(".journal/2-0.json", &newer);
    assert_eq!(offered_soon(&scratch), [shape("work", 1)]);
    let kept = std::fs::read_to_string(scratch.path(".journal/2-0.json"));
    assert_eq!(kept.ok(), Some(newer));
}
