//! The user's files: opening, writing, completion.

use crate::session::{press, session, shows, then};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("there is a folder for temporary files")
}

#[test]
fn files_are_written_by_extension_and_opened_by_content() {
    let folder = folder();
    let place = folder.path().to_str().expect("a name in ASCII").to_owned();
    let mut session = session("f<Enter><Space>");
    for ending in ["txt", "csv", "npy", "json", "svg"] {
        then(
            &mut session,
            &format!(":write {place}/made.{ending}<Enter>"),
            &["written: "],
        );
    }
    for ending in ["txt", "csv", "npy"] {
        then(
            &mut session,
            &format!("n:open {place}/made.{ending}<Enter>"),
            &["opened\n", "NA 51 in all"],
        );
    }
    // Some editors write a byte order mark before a text.
    let shape = std::fs::read(folder.path().join("made.json")).expect("written");
    let marked = [b"\xef\xbb\xbf", &shape[..]].concat();
    std::fs::write(folder.path().join("marked.json"), marked).expect("written");
    then(
        &mut session,
        &format!("n:open {place}/marked.json<Enter>"),
        &["ellipse rx 4.00"],
    );
    // A shape restores the figure that made it.
    then(
        &mut session,
        &format!("n:open {place}/made.json<Enter>"),
        &["ellipse rx 4.00", "+ 1 by hand"],
    );
    then(
        &mut session,
        &format!(":write {place}/made.txt<Enter>"),
        &["already exists. Replace it?"],
    );
    then(&mut session, "n", &[&format!(":write {place}/made.txt")]);
    then(&mut session, "<Enter>", &["already exists. Replace it?"]);
    then(&mut session, "y", &["written: "]);
    let drawing = std::fs::read_to_string(folder.path().join("made.svg")).expect("written");
    assert!(drawing.starts_with("<svg") || drawing.starts_with("<?xml"));
}

#[test]
fn files_that_cannot_be_opened_or_written_are_reported() {
    let folder = folder();
    let place = folder.path().to_str().expect("a name in ASCII").to_owned();
    std::fs::write(folder.path().join("a.png"), b"\x89PNG\r\n\x1a\n").expect("written");
    let mut session = session("");
    then(&mut session, ":write x.csv<Enter>", &["nothing to write"]);
    press(&mut session, "<Esc>");
    then(
        &mut session,
        &format!(":open {place}/a.png<Enter>"),
        &["not an imprint: expected rows of"],
    );
    press(&mut session, "<Esc>");
    then(
        &mut session,
        &format!(":open {place}<Enter>"),
        &["not a regular file"],
    );
    press(&mut session, "<Esc>");
    // In the same words as `taxel describe`.
    then(
        &mut session,
        &format!(":open {place}/nope<Enter>"),
        &["nope: cannot read: no such file or folder"],
    );
    press(&mut session, "<Esc>");
    then(
        &mut session,
        "<Space>:write x.doc<Enter>",
        &["expected a name that ends in one of .txt"],
    );
}

#[test]
fn paths_are_completed() {
    let folder = folder();
    let place = folder.path().to_str().expect("a name in ASCII").to_owned();
    for name in ["mask one.csv", "mask two.csv", "other.txt"] {
        std::fs::write(folder.path().join(name), "0,1,0\n").expect("written");
    }
    let mut session = session("");
    press(&mut session, &format!(":open {place}/m<Tab>"));
    shows(&session, &["mask "]);
    press(&mut session, "o<Tab><Enter>");
    shows(&session, &["mask one.csv opened", "NA 1 in all"]);
}
