//! The library on the screen: Load, Save, Delete, Picture, the sensor and the mouse.

mod unsaved;

use std::path::Path;

use proptest::prelude::*;
use taxel::tui::app::Document;

use taxel::tui::jobs::Jobs;
use taxel::tui::script::Session;
use taxel_files::storage::Library;

use crate::property::config;
use crate::session::{press, session, shows, started, then};

/// Starts a session on a library that outlasts it.
fn session_on(folder: &Path, keys: &str) -> Session {
    started(Jobs::new(Library::open(folder.to_owned())), keys)
}

#[test]
fn saving_over_another_shape_asks() {
    let mut session = session("<Space>sone<Enter>n<Space><Right><Space>sone<Enter>");
    shows(&session, &["\"one\" already exists. Replace it? (y/n)"]);
    // Without a yes, the prompt is open again, with the name.
    then(&mut session, "n", &["Save as: one"]);
    then(&mut session, "<Enter><Esc>", &["Save as: one"]);
    then(&mut session, "<Esc>lone<Enter>", &["NA 1 in all"]);
    // Replacing the shape's own file also asks, and a name in another case is the same name.
    then(
        &mut session,
        "<Right><Right><Space>s<Enter>",
        &["· one*\n", "\"one\" already exists. Replace it? (y/n)"],
    );
    then(&mut session, "y", &["saved as one"]);
    then(
        &mut session,
        "n<Space>sOne<Enter>",
        &["\"one\" already exists"],
    );
    then(&mut session, "ynlone<Enter>", &["NA 1 in all"]);
}

#[test]
fn two_programs_do_not_overwrite_each_other_unnoticed() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut first = session_on(folder.path(), "<Space>sshared<Enter>");
    let mut second = session_on(folder.path(), "lshared<Enter><Right><Space>s<Enter>y");
    shows(&second, &["saved as shared"]);
    // There is one question, and it is about what the file holds now.
    let changed = "\"shared\" was changed by another program since it was loaded. Replace it?";
    then(&mut first, "<Down><Space>s<Enter>", &[changed]);
    then(&mut first, "n", &["Save as: shared"]);
    then(&mut first, "<Enter>", &[changed]);
    press(&mut second, "<Right><Space>s<Enter>y");
    then(&mut first, "y", &[changed]);
    then(&mut first, "n<Esc>", &[]);
    then(&mut second, "nlshared<Enter>", &["NA 3 in all"]);
    // A file that is gone is not replaced.
    then(&mut second, "dshared<Enter>y", &["shared deleted"]);
    then(&mut first, "s<Enter>", &["saved as shared"]);
}

#[test]
fn deleting_asks_and_can_be_taken_back() {
    let mut session = session("<Space>sone<Enter>dn");
    shows(&session, &["Delete  filter: n", "> one"]);
    then(&mut session, "<Enter>", &["Delete \"one\"? (y/n)"]);
    // Without a yes, the list opens again for another choice.
    then(&mut session, "n", &["Delete  filter: n", "> one"]);
    let deleted = "one deleted; :restore one brings it back";
    then(&mut session, "<Enter>y", &[deleted]);
    then(&mut session, "d", &["there are no shapes of your own"]);
    then(&mut session, "<Esc>:restore<Enter>", &["one is back"]);
    then(&mut session, "lone<Enter>", &["one loaded"]);
}

#[test]
fn the_sensor_is_changed_and_cut_taxels_are_reported() {
    let mut session = session("<Space>S");
    shows(
        &session,
        &["Sensor", "Columns   16", "Threshold 0.5", "Pitch     1"],
    );
    then(
        &mut session,
        "8<Tab>4",
        &["! 1 active taxel will be cut", "NA 0 in all"],
    );
    then(&mut session, "<Enter>", &["column 7, row 3"]);
    then(&mut session, "u", &["NA 1 in all"]);
    then(&mut session, "S65", &["! expected 1 to 64, a whole number"]);
    then(
        &mut session,
        "<Esc>f<Enter>S<Tab><Tab><Tab>2.5<Enter>",
        &["58.2843 mm", "400 mm²"],
    );
    // A figure that a small sensor does not allow is kept as a drawing.
    then(
        &mut session,
        "fr<3x:Tab>0<Tab>0<Enter>S5<Tab>5<Enter>",
        &["drawn by hand", "NA 15 in all"],
    );
}

/// Keys of every kind that change the document.
fn any_keys() -> impl Strategy<Value = String> {
    let key = prop::sample::select(vec![
        "<Space>",
        "<Left>",
        "<Right>",
        "<Up>",
        "<Down>",
        "u",
        "U",
        "n",
        "g",
        "<Enter>",
        "<Esc>",
        "f",
        "fh<Enter>",
        "fr<Tab>3<Enter>",
        "f<6x:Tab>1<Enter>",
        ">",
        ")",
        "<lt>",
        "+",
        "<S-Left>",
        "<Tab>",
        "c",
        "S8<Enter>",
        "S<Esc>",
        "p<Esc>",
    ]);
    prop::collection::vec(key, 0..40).prop_map(|keys| keys.concat())
}

proptest! {
    #![proptest_config(config(200))]

    #[test]
    fn any_document_is_saved_and_loaded_unchanged(keys in any_keys()) {
        let folder = tempfile::tempdir().expect("there is a folder for temporary files");
        let mut session = session_on(folder.path(), &keys);
        press(&mut session, "<Esc><Esc>");
        let before: Document = session.app().shown().clone();
        if session.app().reading().imprint.is_empty() {
            return Ok(());
        }
        press(&mut session, "skept<Enter>");
        prop_assert!(session.screen().contains("saved as kept"), "{}", session.screen());
        let mut other = session_on(folder.path(), "");
        let (columns, rows) = (before.sensor.columns(), before.sensor.rows());
        press(&mut other, &format!("S{columns}<Tab>{rows}<Enter>lkept<Enter>"));
        prop_assert_eq!(other.app().shown(), &before);
    }
}

#[test]
fn the_shape_whose_name_was_typed_comes_first() {
    let mut session =
        session("<Space>sturned washer<Enter><Space><Right><Space>s<C-u>washers<Enter>");
    press(&mut session, "lwasher");
    let screen = session.screen();
    let line = |name: &str| screen.lines().position(|line| line.contains(name));
    assert!(line("> washer  ") < line("washers "), "{screen}");
    assert!(line("washers ") < line("turned washer"), "{screen}");
    press(&mut session, "<Enter>");
    assert_eq!(session.app().stored_name(), Some("washer"));
}
