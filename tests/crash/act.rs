//! The programs that are killed: this binary, started again with a variable that names an act.
//!
//! Each act prints every step as soon as it is done; what was printed must survive the kill.

use std::fs::{self, File};
use std::io::{Write, stdout};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use taxel::storage::{Expected, Journal, Library, Orphan};

use super::state::shape;

/// The name of the variable. Its value is an act and a folder, separated by a colon.
const VARIABLE: &str = "TAXEL_CRASH_ACT";

/// Returns the command that starts this binary to perform an act.
pub(crate) fn command(act: &str, folder: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("this binary"));
    command
        .env(VARIABLE, format!("{act}:{}", folder.display()))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// Performs the act that the variable names; returns false if it is not set.
pub(crate) fn perform() -> bool {
    let Ok(asked) = std::env::var(VARIABLE) else {
        return false;
    };
    let (act, folder) = asked.split_once(':').expect("an act and a folder");
    let folder = PathBuf::from(folder);
    match act {
        "journal" => journal(&folder),
        "throw away" => throw_away(&folder),
        "recover" => recover(&folder),
        "churn" => churn(&folder),
        "naive" => naive(&folder),
        "full-recording" => super::disk::records_on_full_disk(&folder),
        "full" => super::disk::on_full_disk(&folder),
        "read-only" => super::disk::on_read_only_disk(&folder),
        _ => panic!("an unknown act: {act}"),
    }
    true
}

fn say(text: &str) {
    let mut out = stdout().lock();
    // Once this program is to be killed, nobody reads its output any more.
    let _ = writeln!(out, "{text}").and_then(|()| out.flush());
}

/// Keeps two versions of unsaved work, one after the other, and then clears the journal.
fn journal(folder: &Path) {
    let mut journal = Journal::new(&Library::open(folder.to_owned()));
    for version in [1, 2] {
        journal.keep(&shape("work", version)).expect("kept");
        say(&format!("kept {version}"));
    }
    say("clearing");
    journal.clear();
    say("cleared");
}

/// Puts a shape that was never saved into the trash.
fn throw_away(folder: &Path) {
    let library = Library::open(folder.to_owned());
    library.throw_away(&shape("lost", 7)).expect("thrown away");
    say("thrown away");
}

/// Takes over the unsaved work of a dead program.
fn recover(folder: &Path) {
    let library = Library::open(folder.to_owned());
    let mut journal = Journal::new(&library);
    for orphan in Orphan::all(&library) {
        journal.keep(&orphan.shape).expect("kept");
        orphan.discard();
    }
    say("recovered");
}

/// Saves, journals, deletes and restores for ever.
fn churn(folder: &Path) {
    let library = Library::open(folder.to_owned());
    let mut journal = Journal::new(&library);
    let mut stamp = library.load("one").expect("it is there").stamp;
    for version in 2.. {
        stamp = library
            .save(&shape("one", version), Expected::Stamp(stamp))
            .expect("saved");
        say(&format!("saved {version}"));
        journal.keep(&shape("work", version)).expect("kept");
        say(&format!("kept {version}"));
        library.delete("two").expect("deleted");
        library.restore("two").expect("restored");
    }
}

/// Saves for ever in the unsafe way: writes into the file itself, line by line.
fn naive(folder: &Path) {
    for version in 2.. {
        let mut file = File::create(folder.join("one.json")).expect("created");
        for line in shape("one", version).write().lines() {
            writeln!(file, "{line}").expect("written");
        }
        file.sync_all().expect("synced");
        say(&format!("saved {version}"));
        if fs::exists(folder.join("enough")).unwrap_or(false) {
            return;
        }
    }
}
