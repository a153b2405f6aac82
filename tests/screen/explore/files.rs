//! Writing the results of a sweep to files.

use std::path::Path;
use std::process::Command;

use taxel::tui::app::Message;
use taxel::tui::script::Session;

use super::{Beside, SHORT};
use crate::session::{press, session, shows};

fn export(session: &mut Session, path: &Path) {
    press(session, "x");
    session.send(Message::Paste(path.display().to_string()));
    press(session, "<Enter>");
}

/// The files have the same bytes as those of the command line, and each is complete.
#[test]
fn exported_files_equal_those_of_the_command_line() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut session = session("fp<Enter>");
    press(&mut session, SHORT);
    for name in ["a.csv", "a.jsonl", "a.npz"] {
        let (own, other) = (
            folder.path().join(name),
            folder.path().join(format!("cli-{name}")),
        );
        export(&mut session, &own);
        shows(&session, &["written: "]);
        let status = Command::new(env!("CARGO_BIN_EXE_taxel"))
            .args("sweep pentagon --x0 5:5.9:0.1 --y0 5:5.9:0.1 --angle 0:50:10 --quiet".split(' '))
            .arg("--atlas")
            .arg(&other)
            .env("TAXEL_CONFIG", "/dev/null")
            .output()
            .expect("it runs");
        assert!(status.status.success(), "{status:?}");
        let read = |path: &Path| std::fs::read(path).expect("it is there");
        if name == "a.npz" {
            // The header contains where the shape was, so only the lengths can be compared.
            assert_eq!(read(&own).len(), read(&other).len());
        } else {
            assert!(read(&own) == read(&other), "{name}");
        }
    }
}

#[test]
fn the_program_asks_before_it_replaces_a_file() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let path = folder.path().join("mine.csv");
    std::fs::write(&path, "mine").expect("written");
    let mut program = Beside::new("fp<Enter>");
    program.press(SHORT);
    program.until("pentagon: 600 poses");
    export(&mut program.session, &path);
    program.until("already exists. Replace it?");
    // Without a yes, the prompt is open again, with the name.
    program.press("n");
    program.until("mine.csv   (");
    program.press("<Esc>");
    assert_eq!(std::fs::read(&path).ok().as_deref(), Some(&b"mine"[..]));
    export(&mut program.session, &path);
    program.until("already exists. Replace it?");
    program.press("y");
    program.until("written: ");
    let text = std::fs::read_to_string(&path).expect("it is there");
    assert!(text.starts_with("id,count,share"), "{text:.50}");
    let names = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(names, 1, "nothing else is left there");
}
