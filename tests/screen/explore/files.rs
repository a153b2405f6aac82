//! Writing the results of a sweep to files.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
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
    press(&mut session, "/na>=1000<Enter>");
    for name in ["a.csv", "a.jsonl", "a.npz", "a.npy"] {
        let (own, other) = (
            folder.path().join(name),
            folder.path().join(format!("cli-{name}")),
        );
        export(&mut session, &own);
        shows(&session, &["written: ", "the filter does not apply"]);
        let flag = ["--atlas", "--poses"][usize::from(name == "a.npy")];
        let status = Command::new(env!("CARGO_BIN_EXE_taxel"))
            .args("sweep pentagon --x0 5:5.9:0.1 --y0 5:5.9:0.1 --angle 0:50:10 --quiet".split(' '))
            .arg(flag)
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

/// The tables of two pages have the numbers of the command line's summary and of the screen.
#[test]
fn statistics_and_histogram_export_their_own_tables() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut session = session("fp<Enter>");
    press(&mut session, SHORT);
    press(&mut session, "2x");
    let offered = "Export to: pentagon-statistics.csv   (.csv page; .jsonl .npz .npy imprints)";
    shows(&session, &[offered]);
    press(&mut session, "<Esc>");
    let path = folder.path().join("s.csv");
    export(&mut session, &path);
    shows(&session, &["written: "]);
    let statistics = std::fs::read_to_string(&path).expect("it is there");
    let mut lines = statistics.lines();
    let head = "descriptor,min,mean,max,sd,cv,ideal,sd_position,sd_angle";
    assert_eq!(lines.next(), Some(head));
    let summary = Command::new(env!("CARGO_BIN_EXE_taxel"))
        .args("sweep pentagon --x0 5:5.9:0.1 --y0 5:5.9:0.1 --angle 0:50:10 --json".split(' '))
        .env("TAXEL_CONFIG", "/dev/null")
        .output()
        .expect("it runs");
    let summary: Value = serde_json::from_slice(&summary.stdout).expect("JSON");
    let descriptors = summary["descriptors"].as_object().expect("an object");
    assert_eq!(lines.clone().count(), descriptors.len());
    for line in lines {
        let mut fields = line.split(',');
        let own = &descriptors[fields.next().expect("a key")];
        for (field, column) in fields.zip(head.split(',').skip(1)) {
            assert_eq!(field.parse().ok(), own[column].as_f64(), "{line}: {column}");
        }
    }
    // Another descriptor of the histogram; the file is there already, so the program asks.
    press(&mut session, "3");
    export(&mut session, &path);
    shows(&session, &["already exists. Replace it?"]);
    press(&mut session, "y");
    shows(&session, &["written: "]);
    let histogram = std::fs::read_to_string(&path).expect("it is there");
    let mut lines = histogram.lines();
    assert_eq!(lines.next(), Some("descriptor,from,to,poses"));
    let poses = lines.map(|line| {
        let (own, poses) = line.rsplit_once(',').expect("four fields");
        assert!(own.starts_with("na,"), "{line}");
        poses.parse::<u64>().expect("a number")
    });
    assert_eq!(poses.sum::<u64>(), 600, "{histogram}");
    // The extension of this name asks for all imprints instead of the page.
    export(&mut session, &folder.path().join("a.jsonl"));
    shows(&session, &["written: "]);
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

/// An export that is running when the program ends is cancelled, and no partial file is left.
#[test]
fn no_part_of_a_file_is_left_at_the_end() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut program = Beside::new("fh<Enter>");
    program.press(":explore --x0 5:5.999:0.001 --y0 5:5.999:0.001 --angle 0:59:1<Enter>");
    program.until("60,000,000 poses, ");
    program.until("distinct imprints");
    export(&mut program.session, &folder.path().join("poses.npy"));
    shows(&program.session, &["stopping leaves no file behind"]);
    drop(program);
    let names = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(names, 0);
}

/// The drawings of pages with a plot are those that the library draws, in both formats.
#[test]
fn a_plot_is_exported_as_a_drawing() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut session = session("fp<Enter>");
    press(&mut session, SHORT);
    for (page, mark) in [
        ("4", "class=\"borders\""),
        ("5", "class=\"points\""),
        ("6", "class=\"curve\""),
    ] {
        press(&mut session, page);
        let path = folder.path().join(format!("{page}.svg"));
        export(&mut session, &path);
        shows(&session, &["written: "]);
        let svg = std::fs::read_to_string(&path).expect("it is there");
        assert!(svg.starts_with("<svg ") && svg.contains(mark), "{svg:.200}");
        assert!(svg.contains("pentagon: 600 poses"), "{svg:.400}");
    }
}
