//! Tests of `taxel export` and `--export`: writing and reading every format, the places of files, and refusals.

use std::os::unix::fs::PermissionsExt;

use tempfile::TempDir;

use super::RING;
use super::Run;
use super::misused;
use super::program;
use super::refused;
use super::taxel;

/// A folder that commands run in.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("there is a folder for temporary files"))
    }

    fn run(&self, line: &str) -> Run {
        let arguments: Vec<&str> = line.split_whitespace().collect();
        let mut command = program(&arguments, "C.UTF-8");
        let child = command.current_dir(self.0.path()).spawn();
        super::finish(child.expect("the program starts"), b"")
    }

    fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.0.path().join(name)).expect("the file is there")
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).expect("text")
    }

    fn write(&self, name: &str, content: &[u8]) {
        std::fs::write(self.0.path().join(name), content).expect("written");
    }

    /// Returns the names of the files in the folder.
    fn names(&self) -> Vec<String> {
        super::sweep::names(self.0.path())
    }
}

fn said(text: &str) -> Run {
    Run {
        status: Some(0),
        stdout: text.to_owned(),
        stderr: String::new(),
    }
}

#[test]
fn every_format_of_an_imprint_has_the_same_description() {
    let folder = Folder::new();
    assert_eq!(folder.run("export washer a.txt"), said("written: a.txt\n"));
    let expected = folder.run("describe a.txt --json");
    assert!(expected.stdout.contains("\"nae\":"));
    for name in ["a.csv", "a.npy", "A.CSV"] {
        let run = folder.run(&format!("export a.txt {name}"));
        assert_eq!(run.status, Some(0), "{name}");
        let described = folder.run(&format!("describe {name} --json"));
        assert_eq!(described, expected, "{name}");
        let saved = folder.run(&format!("--library lib library save same {name} --force"));
        assert_eq!(saved, said("saved as same\n"));
    }
    let stored = folder.run("--library lib describe same --json");
    assert_eq!(stored.stdout, expected.stdout);
    // The byte order mark that editors write before a text is not a taxel.
    folder.write("a.csv", "\u{feff}0,1\n1,1\n".as_bytes());
    let marked = folder.run("describe a.csv --json").stdout;
    assert!(
        marked.starts_with(r###"{"imprint":[".#","##"],"###),
        "{marked}"
    );
}

#[test]
fn a_figure_is_exported_and_its_table_is_still_printed() {
    let folder = Folder::new();
    let table = taxel(RING, "").stdout;
    let run = folder.run(&format!("{RING} --export ring.svg"));
    let line = "NA 36 in all\n";
    let table = table.replace(line, &format!("{line}written: ring.svg\n"));
    assert_eq!(run, said(&table));
    let drawing = folder.text("ring.svg");
    for part in [">x / cells<", ">CG 6, 5.5 cells<", "class=\"outline\""] {
        assert!(drawing.contains(part), "{part}: {drawing}");
    }
    // In mm if a pitch is given, also with JSON.
    let run = folder.run(&format!(
        "{RING} --pitch 2 --json --export ring.svg --force"
    ));
    assert_eq!(run.stdout, include_str!("ring.json"));
    let drawing = folder.text("ring.svg");
    assert!(drawing.contains(">x / mm<") && drawing.contains(">CG 12, 11 mm<"));
}

#[test]
fn a_stored_shape_is_drawn_with_its_outline_name_and_pitch() {
    let folder = Folder::new();
    let drawn = |line: &str| {
        folder.run(&format!("export {line} --force drawn.svg"));
        folder.text("drawn.svg")
    };
    let washer = drawn("washer");
    assert!(washer.contains("<title>washer: ellipse rx "), "{washer}");
    assert!(washer.contains("class=\"outline\"") && washer.contains(">x / cells</text>"));
    let key = drawn("key");
    assert!(key.contains("<title>key</title>") && !key.contains("outline"));
    let line = format!("{RING} --pitch 2.5 --save pit --library .");
    assert_eq!(folder.run(&line).status, Some(0));
    let pit = drawn("pit --library .");
    assert!(pit.contains(">x / mm</text>") && pit.contains("(in cells)</text>"));
    let tiny = drawn("washer --pitch 5e-324");
    assert!(tiny.contains("<svg") && !tiny.contains("NaN"));
}

#[test]
fn files_are_only_overwritten_with_force() {
    let folder = Folder::new();
    folder.write("old.svg", b"mine");
    let path = |name: &str| folder.0.path().join(name);
    let own = std::fs::Permissions::from_mode(0o600);
    std::fs::set_permissions(path("old.svg"), own).expect("set");
    let there = "\"old.svg\" already exists; --force replaces it";
    refused(&folder.run("export washer old.svg"), 1, there);
    refused(&folder.run(&format!("{RING} --export old.svg")), 1, there);
    assert_eq!(folder.read("old.svg"), b"mine");
    let run = folder.run("export washer old.svg --force");
    assert_eq!(run, said("written: old.svg\n"));
    assert!(folder.read("old.svg").starts_with(b"<svg"));
    let mode = std::fs::metadata(path("old.svg")).expect("there");
    assert_eq!(mode.permissions().mode() & 0o777, 0o600);
    // Only files are replaced, and no partial file is left.
    std::fs::create_dir(path("folder.svg")).expect("made");
    std::os::unix::fs::symlink("old.svg", path("link.svg")).expect("made");
    for name in ["folder.svg", "link.svg"] {
        let message = format!("{name}: cannot write: only regular files are replaced");
        refused(
            &folder.run(&format!("export washer {name} --force")),
            1,
            &message,
        );
    }
    let nowhere = folder.run("export washer no/such.svg");
    refused(&nowhere, 1, "no/such.svg: cannot write: no such folder");
    assert_eq!(folder.names(), ["folder.svg", "link.svg", "old.svg"]);
    // Either the shape is stored and the file written, or neither.
    let run = folder.run(&format!("{RING} --export ring.txt --save washer"));
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert_eq!(folder.names().len(), 3, "{}", run.stderr);
}

#[test]
fn bad_targets_are_refused_with_what_is_expected() {
    for (line, message) in [
        (
            "export washer washer.bmp",
            "invalid value 'washer.bmp' for '<TO>': expected a name that ends in .txt, .csv, .npy or .svg\n",
        ),
        (
            "figure hexagon --force",
            "the following required arguments were not provided",
        ),
    ] {
        misused(line, message);
    }
}

#[test]
fn screens_of_a_script_are_drawn() {
    let folder = Folder::new();
    folder.write(
        "tour.taxel",
        b"Set theme light\nSize 60x20\nScreen\nKeys f<Enter>\nScreen ../a figure!\nState /na\n",
    );
    let plain = folder.run("script tour.taxel");
    assert_eq!(plain.status, Some(0));
    let drawn = folder.run("script tour.taxel --svg .");
    assert_eq!(drawn, plain, "what is printed is the same");
    let names = ["screen-1.svg", "screen-2.svg", "tour.taxel"];
    assert_eq!(folder.names(), names);
    let light = folder.text("screen-2.svg");
    assert!(light.contains("fill=\"#ffffff\"/>") && light.contains("fill=\"#008700\"/>"));
    let line = "script -k f<Enter> --size 60x20 --svg .";
    let there = "\"./screen-1.svg\" already exists; --force replaces it";
    refused(&folder.run(line), 1, there);
    assert_eq!(folder.run(&format!("{line} --force")).status, Some(0));
    let dark = folder.text("screen-1.svg");
    // 60 × 20 characters of 9 × 18, and the margin.
    assert!(dark.starts_with("<svg ") && dark.contains("viewBox=\"0 0 564 384\""));
    assert!(dark.contains("fill=\"#1c1c1c\"/>") && dark.contains("fill=\"#87d787\"/>"));
    assert!(dark.contains("NA 52 in all"));
}
