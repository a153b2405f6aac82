//! Files of the user: opened, written, completed; and the commands that are remembered.

use taxel::storage::Library;
use taxel::tui::runtime::World;

use crate::session::{hides, press, session, shows, started, then};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("there is a folder for temporary files")
}

#[test]
fn the_matrix_is_written_by_the_ending_and_opened_by_the_content() {
    let folder = folder();
    let place = folder.path().to_str().expect("a name in ASCII").to_owned();
    let mut session = session("f<Enter><Space>");
    for ending in ["txt", "csv", "npy", "pbm", "json", "svg", "png"] {
        then(
            &mut session,
            &format!(":write {place}/made.{ending}<Enter>"),
            &["written: "],
        );
    }
    for ending in ["txt", "csv", "npy", "pbm"] {
        then(
            &mut session,
            &format!("n:open {place}/made.{ending}<Enter>"),
            &["opened", "drawn by hand", "NA 51 in all"],
        );
    }
    // A shape brings back what touched.
    then(
        &mut session,
        &format!("n:open {place}/made.json<Enter>"),
        &["ellipse rx 4.00", "+ 1 by hand"],
    );
    then(
        &mut session,
        &format!(":export {place}/made.txt<Enter>"),
        &["Replace ", "made.txt?"],
    );
    then(&mut session, "y", &["written: "]);
    let drawing = std::fs::read_to_string(folder.path().join("made.svg")).expect("written");
    assert!(drawing.starts_with("<svg") || drawing.starts_with("<?xml"));
}

#[test]
fn what_cannot_be_opened_or_written_is_said() {
    let folder = folder();
    let place = folder.path().to_str().expect("a name in ASCII").to_owned();
    std::fs::write(folder.path().join("a.png"), b"\x89PNG\r\n\x1a\n").expect("written");
    let mut session = session("");
    then(&mut session, ":write x.csv<Enter>", &["nothing to write"]);
    press(&mut session, "<Esc>");
    then(
        &mut session,
        &format!(":open {place}/a.png<Enter>"),
        &["a PNG image, expected rows of"],
    );
    then(
        &mut session,
        &format!(":open {place}<Enter>"),
        &["not a regular file"],
    );
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

#[test]
fn the_prompt_offers_commands_and_remembers_lines_between_runs() {
    let folder = folder();
    let world = || World::new(Library::open(folder.path().to_owned()));
    let mut first = started(world(), ":");
    shows(&first, &["  copy", "copy descriptors, imprint"]);
    then(&mut first, "fig", &["figure  KIND --side 3"]);
    hides(&first, &["copy descriptors, imprint"]);
    press(&mut first, "<C-u>figure hexagon --side 3<Enter>");
    let mut second = started(world(), ":");
    shows(&second, &["figure hexagon --side 3", "earlier"]);
    then(
        &mut second,
        "<Down>",
        &["> figure hexagon --side 3", ":figure hexagon --side 3"],
    );
    then(&mut second, "<Enter>", &["hexagon side 3.00"]);
}
