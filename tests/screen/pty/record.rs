//! `--record` writes a script that shows the same screens.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use taxel::formats::StoredShape;
use taxel::storage::{Expected, Journal, Library};

use super::program::{Program, Start, TAXEL};
use super::tracer::Tracer;

/// Returns a shape with this first row, on 12 × 10 taxels.
pub(super) fn shape(name: &str, row: &str) -> StoredShape {
    let text = format!(
        "{{\"format\":\"taxel-shape/1\",\"name\":\"{name}\",\"sensor\":{{\"columns\":12,\"rows\":10}},\
          \"imprint\":[\"{row}\"{}]}}",
        ",\"............\"".repeat(9)
    );
    StoredShape::read(text.as_bytes()).expect("a shape")
}

/// Returns the output of `taxel script`.
fn replayed(script: &str, folder: &Path) -> Output {
    let file = folder.join("replayed.taxel");
    fs::write(&file, script).expect("a file");
    Command::new(TAXEL)
        .arg("script")
        .arg(&file)
        .env("LANG", "C.UTF-8")
        .env_remove("LC_ALL")
        .output()
        .expect("it runs")
}

#[test]
fn a_record_shows_the_same_screens() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().join("library");
    let library = Library::open(place.clone());
    for (name, row) in [("a b", "..##........"), ("z secret", "######......")] {
        let saved = library.save(&shape(name, row), Expected::Nothing);
        saved.expect("saved");
    }
    Journal::new(&library)
        .keep(&shape("lost", ".#.#.#......"))
        .expect("kept");
    let record = folder.path().join("record.taxel");
    let name = record.to_str().expect("a name");
    let command = [
        TAXEL,
        "--record",
        name,
        "--columns",
        "12",
        "--rows",
        "10",
        "--threshold",
        "0.6",
        "--pitch",
        "2",
        "--theme",
        "light",
        "--ascii",
    ];
    let mut program = Program::start(&Start {
        command: &command,
        library: Some(&place),
        size: (72, 22),
        ..Start::default()
    });
    program.shows("There is unsaved work from last time: lost, 3 taxels");
    // Keys, and a text that is then on the screen.
    let acts: [(&[u8], &str); 10] = [
        (b"y", "restored"),
        (b"fr\t3.57\x1b[D\x7f\r", "rectangle length 3.70"),
        (
            b"\x1b[<0;4;3M\x1b[<32;14;3M\x1b[<32;14;7M\x1b[<0;14;7m",
            "by hand",
        ),
        (b"\x1b[1;2C", "dropped"),
        (b"s\xe3\x80\x80a\x1b[200~ b\"c \x1b[201~", "! "),
        (b"\x15new one\r", "saved as new one"),
        (b"l", "filter:"),
        (b"\x1b[<65;5;5M", "> "),
        (b"\x1bla b\r", "a b loaded"),
        (b":figure hexagon --side 2\r\x1b[<0;6;5Mg", "held"),
    ];
    for (index, (bytes, shown)) in acts.into_iter().enumerate() {
        if index == 6 {
            program.resize((90, 26));
        }
        program.types(bytes);
        program.shows(shown);
        program.until("the screen of its record", |program| {
            let record = fs::read_to_string(&record).expect("a record");
            let output = replayed(&format!("{record}Screen\n"), folder.path());
            let printed = String::from_utf8_lossy(&output.stdout).into_owned();
            let screen = printed.split_once('\n').map_or("", |(_, screen)| screen);
            screen.trim_end() == program.rows()
        });
    }
    program.signal(rustix::process::Signal::TERM);
    program.ends_well(143);
    let whole = fs::read_to_string(&record).expect("a record");
    for line in [
        "Set ascii on",
        "Set theme light",
        "Set threshold 0.6",
        "Keys <U+3000>",
        "Resize 90x26",
        "Signal TERM",
    ] {
        assert!(
            whole.lines().any(|own| own == line),
            "no {line:?} in\n{whole}"
        );
    }
    let output = replayed(&format!("{whole}Quit\n"), folder.path());
    assert!(output.status.success(), "{output:?}");
    assert!(
        whole.contains("..##........"),
        "a shape that was loaded\n{whole}"
    );
    // None of this touches the library of the record.
    assert_eq!(
        library
            .list()
            .expect("a list")
            .iter()
            .filter(|own| own.name == "new one")
            .count(),
        1
    );
}

#[test]
fn a_record_says_how_many_frames_came_between_keys() {
    let folder = tempfile::tempdir().expect("a folder");
    let [record, source] = ["record.taxel", "touch.csv"].map(|name| folder.path().join(name));
    let rows = "time,r0c0,r0c1\n0.0,1,2\n0.1,3,4\n0.2,5,60\n";
    fs::write(&source, rows).expect("written");
    let name = record.to_str().expect("a name");
    let mut program = Program::started(&Start {
        command: &[TAXEL, "--record", name],
        ..Start::default()
    });
    program.types(format!(":watch {}\r", source.display()).as_bytes());
    program.shows("ended");
    program.types(b"+");
    program.shows("threshold  5");
    program.types(b"\r");
    program.shows("the imprint of frame 2");
    let mut text = String::new();
    // The screen does not wait for the record.
    program.until("the screen of its record", |program| {
        text = fs::read_to_string(&record).expect("a record");
        let output = replayed(&format!("{text}Screen\n"), folder.path());
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        printed.trim_end().ends_with(&program.rows())
    });
    let counts = text.lines().filter_map(|line| line.strip_prefix("Frames "));
    let frames: usize = counts.filter_map(|count| count.parse::<usize>().ok()).sum();
    assert_eq!(frames, 3, "{text}");
    program.types(b"qy");
    program.ends_well(0);
}

/// A disk that hangs delays neither keys nor the end, which reports it.
#[test]
fn keys_work_while_a_hanging_disk_writes_the_record() {
    for answers in [true, false] {
        let folder = tempfile::tempdir().expect("a folder");
        let record = folder.path().join("record.taxel");
        let name = record.to_str().expect("a name");
        let mut program = Program::started(&Start {
            command: &[TAXEL, "--record", name],
            ..Start::default()
        });
        let Some(hanging) = Tracer::hang(&mut program, "?write", &[&record]) else {
            return;
        };
        program.types(b" ");
        program.shows("NA 1 in all");
        program.types(b"\x1b[C ");
        program.shows("NA 2 in all");
        program.types(b"q");
        program.shows("not saved");
        if answers {
            hanging.end();
            program.types(b"y");
            program.ends_well(0);
            let whole = fs::read_to_string(&record).expect("a record");
            assert!(whole.ends_with("Keys q\nKeys y\n"), "{whole}");
        } else {
            program.types(b"y");
            program.shows("the record ends early: the disk does not answer");
            program.until("its end", |program| program.state() == 'Z');
            hanging.end();
            program.ends_well(1);
        }
    }
}

/// A full disk ends the record after a complete line. This is reported at once, and by the exit status.
#[test]
fn a_full_disk_ends_a_record_after_a_complete_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let record = folder.path().join("record.taxel");
    // A limit in blocks of at least 512 bytes acts as a full disk.
    let command = format!(
        "trap '' XFSZ; ulimit -f 4; exec '{TAXEL}' --record '{}'",
        record.display()
    );
    let mut program = Program::started(&Start {
        command: &["sh", "-c", &command],
        ..Start::default()
    });
    program.types(&b"\x1b[C".repeat(400));
    program.shows("the record ends here: File too large");
    program.types(b"q");
    program.shows("the record ends early: File too large");
    program.ends_well(1);
    let whole = fs::read_to_string(&record).expect("a record");
    assert!(whole.ends_with("\nKeys <Right>\n"), "{whole}");
    let output = replayed(&format!("{whole}Screen\n"), folder.path());
    assert!(output.status.success(), "{output:?}");
}

/// An existing file is not replaced, and an empty record leaves no file.
#[test]
fn a_record_does_not_replace_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("walk.taxel");
    fs::write(&file, "mine").expect("a file");
    fs::write(folder.path().join("walk-2.taxel"), "mine too").expect("a file");
    let run = |name: &Path| {
        Command::new(TAXEL)
            .arg("--record")
            .arg(name)
            .env("TAXEL_LIBRARY", folder.path().join("library"))
            .env("TAXEL_CONFIG", "/dev/null")
            .stdin(std::process::Stdio::null())
            .output()
            .expect("it runs")
    };
    let output = run(&file);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    let shown = file.display().to_string();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        told.starts_with(&format!("error: {shown:?} already exists")),
        "{told}"
    );
    assert!(told.contains("walk-3.taxel is free"), "{told}");
    assert_eq!(fs::read_to_string(&file).expect("it is there"), "mine");
    let nowhere = folder.path().join("no/walk.taxel");
    let told = String::from_utf8_lossy(&run(&nowhere).stderr).into_owned();
    assert!(
        told.starts_with(&format!("error: {}: cannot record: ", nowhere.display())),
        "{told}"
    );
    // Without a terminal, nothing is recorded.
    let none = folder.path().join("none.taxel");
    let command = format!(
        "'{TAXEL}' --record '{}' </dev/null 2>&1 | cat; echo left",
        none.display()
    );
    let mut program = Program::start(&Start {
        command: &["sh", "-c", &command],
        controlling: false,
        ..Start::default()
    });
    program.shows("left");
    assert!(!none.exists());
}
