//! Two programs on one library: neither overwrites the other's work unnoticed.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use taxel::storage::{Expected, Library, LibraryError};

use super::Scratch;
use super::refusal;
use super::shape;

#[test]
fn a_shape_that_was_changed_meanwhile_is_not_overwritten() {
    let scratch = Scratch::with(&["one"]);
    let other = Library::open(scratch.folder.clone());
    let mine = scratch.library.load("one").expect("loaded").stamp;
    let theirs = other
        .save(&shape("one", 2), Expected::Stamp(mine))
        .expect("nobody else has written");
    let saved = scratch
        .library
        .save(&shape("one", 3), Expected::Stamp(mine));
    assert!(matches!(&saved, Err(LibraryError::Changed { stamp, .. }) if *stamp == theirs));
    assert_eq!(
        refusal(saved, &scratch),
        "\"one\" was changed by another program since it was loaded"
    );
    assert_eq!(scratch.number("one"), Some(2));
    // When asked, the user wants to overwrite it.
    let saved = scratch
        .library
        .save(&shape("one", 3), Expected::Stamp(theirs));
    assert!(saved.is_ok());
    assert_eq!(scratch.number("one"), Some(3));
    // A shape that was deleted meanwhile is stored again, since this overwrites nothing.
    other.delete("one").expect("deleted");
    let saved = scratch
        .library
        .save(&shape("one", 4), Expected::Stamp(theirs));
    assert!(saved.is_ok());
    let exists = scratch.library.save(&shape("one", 5), Expected::Nothing);
    assert!(matches!(exists, Err(LibraryError::Exists { .. })));
}

const VARIABLE: &str = "TAXEL_LIBRARY_COUNTER";

/// The number of increments by each program.
const COUNTS: usize = 40;

/// The other program, which is this test with a variable set: it increments "counter", and also saves a new shape.
#[test]
fn counter() {
    let Ok(asked) = std::env::var(VARIABLE) else {
        return;
    };
    let (own, folder) = asked.split_once(':').expect("a name and a folder");
    let library = Library::open(folder.into());
    for index in 0..COUNTS {
        loop {
            let loaded = library.load("counter").expect("whole");
            let number = usize::try_from(loaded.shape.imprint.words()[0]).expect("small");
            match library.save(&shape("counter", number + 1), Expected::Stamp(loaded.stamp)) {
                Ok(_) => break,
                Err(LibraryError::Changed { .. }) => {}
                Err(error) => panic!("{error}"),
            }
        }
        match library.save(&shape(&format!("new {index}"), 1), Expected::Nothing) {
            Ok(_) => println!("FIRST {own} {index}"),
            Err(LibraryError::Exists { .. }) => {}
            Err(error) => panic!("{error}"),
        }
    }
}

fn count(own: &str, folder: &Path) -> Child {
    Command::new(std::env::current_exe().expect("this binary"))
        .args(["--exact", "library::stamps::counter", "--nocapture"])
        .env(VARIABLE, format!("{own}:{}", folder.display()))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

#[test]
fn programs_that_save_at_once_lose_nothing() {
    let scratch = Scratch::with(&["counter"]);
    scratch.library.delete("counter").expect("deleted");
    scratch.save("counter", 0);
    let programs = ["a", "b", "c"].map(|own| count(own, &scratch.folder));
    let mut said = String::new();
    for program in programs {
        let output = program.wait_with_output().expect("it ends");
        assert!(output.status.success(), "{output:?}");
        said += &String::from_utf8(output.stdout).expect("text");
    }
    assert_eq!(
        scratch.number("counter"),
        Some(3 * COUNTS),
        "every save counts on from the one before"
    );
    for index in 0..COUNTS {
        let firsts = said
            .lines()
            .filter(|line| line.contains("FIRST ") && line.ends_with(&format!(" {index}")));
        assert_eq!(
            firsts.count(),
            1,
            "one is the first, the others are told: {index}"
        );
    }
}
