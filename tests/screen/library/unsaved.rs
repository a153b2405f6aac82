//! Unsaved work is kept while the program runs, offered after a crash, and thrown away so that it can be restored.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};

use taxel::tui::app::Message;
use taxel::tui::jobs::Jobs;
use taxel_files::storage::{Library, LibraryEntry, ShapeOrigin};

use super::session_on;
use crate::session::{press, session, shows, started, then};

#[test]
fn unsaved_work_is_offered_back_once() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let lost = session_on(folder.path(), "f<Enter><Space>");
    // The work of a running program is not offered to another one.
    let running = session_on(folder.path(), "<Space>");
    assert!(!running.screen().contains("unsaved work"));
    drop((lost, running));
    let mut later = session_on(folder.path(), "");
    shows(
        &later,
        &[
            "There is unsaved work from last time (1 of 2): 1 taxel, less than a minute ago.\nRestore it?",
        ],
    );
    then(
        &mut later,
        "n",
        &["unsaved 1 is in the trash; :restore unsaved 1 brings it back. There is"],
    );
    then(
        &mut later,
        "y",
        &["ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0° + 1 by hand"],
    );
    // The work that was declined is in the trash.
    then(
        &mut later,
        ":restore unsaved 1<Enter>lunsaved 1<Enter>",
        &["unsaved 1 loaded", "NA 1 in all"],
    );
    press(&mut later, "un<Space>smine<Enter>q");
    shows(&later, &["1 earlier shape is not saved; u goes back."]);
    press(&mut later, "y");
    assert!(later.app().ended());
    drop(later);
    assert!(
        !session_on(folder.path(), "")
            .screen()
            .contains("unsaved work")
    );
}

/// Nobody has to start the program again for the next piece, and restoring one does not lose another.
#[test]
fn all_unsaved_work_is_offered_one_after_the_other() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    drop(session_on(
        folder.path(),
        "<Space>n<Space><Right><Space>n<Space><Right><Space><Right><Space>",
    ));
    let mut later = session_on(folder.path(), "");
    shows(&later, &["last time (1 of 3): 3 taxels"]);
    then(&mut later, "y", &["last time (1 of 2): ", "NA     3 "]);
    then(&mut later, "y", &["last time: "]);
    then(&mut later, "y", &["restored; s saves it"]);
    then(&mut later, "u", &["undone: 1 taxel restored"]);
    then(
        &mut later,
        "uu",
        &["! nothing to undo", "3 taxels restored"],
    );
    press(&mut later, "UU");
    let left = "The imprint and 2 earlier shapes are not saved; u goes back.";
    then(&mut later, "q", &[left]);
    // All of it is kept if the program dies once more.
    drop(later);
    shows(&session_on(folder.path(), ""), &["last time (1 of 3): "]);
}

/// An undo of the restoring would lose the work without a question.
#[test]
fn restored_work_is_not_lost_by_undo() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    drop(session_on(folder.path(), "f<Enter>"));
    let mut later = session_on(folder.path(), "y");
    then(&mut later, "u", &["nothing to undo", "\nellipse"]);
    then(&mut later, "q", &["The imprint is not saved. Quit anyway?"]);
    // It is still kept if the program ends without an answer.
    drop(later);
    let mut again = session_on(folder.path(), "yn");
    then(
        &mut again,
        "q",
        &["1 earlier shape is not saved; u goes back."],
    );
}

/// Returns what is said about unsaved work from last time, and moves all of it to the trash.
fn offers(library: &Path) -> String {
    let mut later = session_on(library, "");
    let mut said = String::new();
    loop {
        // The lines break anywhere.
        let screen = later.screen();
        let words = screen.split_whitespace().collect::<Vec<_>>().join(" ");
        if !words.contains("unsaved work from last time") {
            return said;
        }
        said += &words;
        press(&mut later, "n");
    }
}

/// The work that the question before quitting warns of is also kept if the program dies without a question.
#[test]
fn work_that_was_left_for_something_else_is_kept() {
    let drawn = "<Space><Right><Space><Right><Space>";
    for left in [
        "lwasher<Enter>",
        "n",
        "rt",
        // A form shows its figure instead, but Esc would bring the drawing back.
        "f<Tab>",
    ] {
        let folder = tempfile::tempdir().expect("there is a folder for temporary files");
        drop(session_on(folder.path(), &format!("{drawn}{left}")));
        let said = offers(folder.path());
        assert!(said.contains(": 3 taxels, "), "{left}: {said}");
    }
}

/// Only what could be lost is kept: not what was saved, undone, or given up.
#[test]
fn work_that_was_saved_undone_or_given_up_is_not_kept() {
    for keys in [
        "<Space>sx<Enter>lwasher<Enter>",
        "<Space>lwasher<Enter>uqsx<Enter>",
        "lwasher<Enter><Space>u",
        "<Space>nqy",
        "<Space>uqy",
    ] {
        let folder = tempfile::tempdir().expect("there is a folder for temporary files");
        drop(session_on(folder.path(), keys));
        let later = session_on(folder.path(), "");
        assert!(!later.screen().contains("unsaved work"), "{keys}");
    }
}

/// Waits until unsaved work is on the disk.
fn journal_is_written(library: &Path) {
    let end = Instant::now() + Duration::from_secs(60);
    let is_there = || {
        let files = std::fs::read_dir(library.join(".journal"));
        let mut paths = files
            .into_iter()
            .flatten()
            .flatten()
            .map(|file| file.path());
        paths.any(|path| path.extension().is_some_and(|ending| ending == "json"))
    };
    while !is_there() {
        assert!(Instant::now() < end, "nothing is written");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Someone has removed the folder, or a stick was pulled and put back.
#[test]
fn work_that_vanished_from_the_disk_is_written_again_at_the_end() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let library = folder.path().join("library");
    let world = Jobs::new(Library::open(library.clone()));
    let session = started(world.with_threads(Arc::new(|| {})), "<Space>");
    journal_is_written(&library);
    std::fs::remove_dir_all(&library).expect("removed");
    drop(session);
    let later = session_on(&library, "");
    shows(&later, &["There is unsaved work from last time: 1 taxel"]);
}

/// If it cannot be thrown away, nothing is left of the attempt, and this program does not ask again.
#[test]
fn unsaved_work_that_cannot_go_to_the_trash_stays() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    drop(session_on(folder.path(), "<Space>"));
    std::fs::write(folder.path().join(".trash"), "in the way").expect("written");
    let mut later = session_on(folder.path(), "n");
    shows(
        &later,
        &["! the unsaved work cannot be moved to the trash, and is offered again at"],
    );
    press(&mut later, "q");
    assert!(later.app().ended());
    drop(later);
    let listed = Library::open(folder.path().to_owned()).list();
    let own = |entry: &LibraryEntry| entry.origin == ShapeOrigin::Own;
    assert!(!listed.expect("listed").iter().any(own));
    let again = session_on(folder.path(), "");
    shows(
        &again,
        &["There is unsaved work from last time: 1 taxel, less than a minute ago."],
    );
}

#[test]
fn a_drawing_whose_file_was_deleted_is_unsaved() {
    let mut session = session("<Space>sa<Enter>da<Enter>yq");
    shows(&session, &["The imprint is not saved. Quit anyway?"]);
    then(&mut session, "<Esc>s", &["Save as:"]);
    then(&mut session, "a<Enter>", &["saved as a"]);
}

/// A journal that cannot be written is reported once, and the work is written when it can be.
#[test]
fn work_that_could_not_be_kept_is_kept_later() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let journal = folder.path().join(".journal");
    std::fs::write(&journal, "in the way").expect("written");
    let (post, told) = channel();
    let world = Jobs::new(Library::open(folder.path().to_owned()));
    let world = world.with_threads(Arc::new(move || {
        let _ = post.send(());
    }));
    let mut session = started(world, "<Space>");
    told.recv_timeout(Duration::from_secs(60))
        .expect("it is told");
    session.send(Message::Answered);
    shows(&session, &["! unsaved work cannot be kept: "]);
    std::fs::remove_file(&journal).expect("removed");
    // Without a further change.
    journal_is_written(folder.path());
    drop(session);
    let later = session_on(folder.path(), "");
    shows(
        &later,
        &["There is unsaved work from last time: 1 taxel, less than a minute ago."],
    );
}
