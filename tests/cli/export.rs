//! Tests of `taxel export` and `--export`: writing and reading every format, the places of files, and refusals.

use tempfile::TempDir;

use super::RING;
use super::Run;
use super::library::Shelf;
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

    fn write(&self, name: &str, content: &[u8]) {
        std::fs::write(self.0.path().join(name), content).expect("written");
    }

    /// Returns the names of the files in the folder.
    fn names(&self) -> Vec<String> {
        let files = std::fs::read_dir(self.0.path())
            .expect("a folder")
            .flatten();
        let names = files.map(|file| file.file_name().into_string().expect("text"));
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
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
    assert_eq!(expected.status, Some(0));
    assert!(expected.stdout.contains("\"nae\":"));
    for name in [
        "a.pbm",
        "a.csv",
        "a.npy",
        "A.CSV",
        "plain --format pbm-plain",
    ] {
        assert_eq!(
            folder.run(&format!("export a.txt {name}")).status,
            Some(0),
            "{name}"
        );
        let file = name.split(' ').next().expect("a name");
        assert_eq!(
            folder.run(&format!("describe {file} --json")),
            expected,
            "{name}"
        );
        let saved = folder.run(&format!("--library lib library save same {file} --force"));
        assert_eq!(saved, said("saved as same\n"));
    }
    assert!(folder.read("plain").starts_with(b"P1\n16 16\n"));
    assert!(folder.read("a.pbm").starts_with(b"P4\n16 16\n"));
    let stored = folder.run("--library lib library show same --json");
    assert_eq!(stored.stdout, expected.stdout);
}

#[test]
fn a_figure_is_exported_and_its_table_is_still_printed() {
    let folder = Folder::new();
    let table = taxel(RING, "").stdout;
    let run = folder.run(&format!("{RING} --export ring.svg"));
    let line = "NA 36 in all\n";
    assert_eq!(
        run,
        said(&table.replace(line, &format!("{line}written: ring.svg\n")))
    );
    let drawing = String::from_utf8(folder.read("ring.svg")).expect("text");
    assert!(drawing.starts_with("<svg ") && drawing.contains(">x / cells<"));
    assert!(drawing.contains(">CG 6, 5.5 cells<") && drawing.contains("class=\"outline\""));
    // In mm if a pitch is given, also with JSON.
    let run = folder.run(&format!(
        "{RING} --pitch 2 --json --export ring.svg --force"
    ));
    assert_eq!(run.stdout, include_str!("ring.json"));
    let drawing = String::from_utf8(folder.read("ring.svg")).expect("text");
    assert!(drawing.contains(">x / mm<") && drawing.contains(">CG 12, 11 mm<"));
}

#[test]
fn a_stored_shape_is_drawn_with_its_outline_and_name() {
    let folder = Folder::new();
    assert_eq!(folder.run("export washer washer.svg").status, Some(0));
    let drawing = String::from_utf8(folder.read("washer.svg")).expect("text");
    assert!(drawing.contains("<title>washer: ellipse rx "), "{drawing}");
    assert!(drawing.contains("class=\"outline\""));
    assert_eq!(folder.run("export key key.svg").status, Some(0));
    let drawing = String::from_utf8(folder.read("key.svg")).expect("text");
    assert!(drawing.contains("<title>key</title>") && !drawing.contains("outline"));
}

#[test]
fn imprints_are_exported_through_standard_input_and_output() {
    let plain = "P1\n3 2\n101\n111\n";
    let run = taxel("export - - --format pbm-plain", "1,0,1\n1,1,1\n");
    assert_eq!(run, said(plain));
    assert_eq!(taxel("export - - --format txt", plain), said("#.#\n###\n"));
    misused(
        "figure ellipse --export - --format txt --json",
        "the argument '--json' cannot be used with '--export -': both write to standard output",
    );
    let run = taxel(
        "figure hexagon --export - --format csv --columns 4 --rows 1",
        "",
    );
    // Drawn on a sensor this small, the upper side extends from 2 to 6.
    let beyond = "the figure reaches beyond the sensor\n".to_owned();
    assert_eq!(
        run,
        Run {
            stderr: beyond,
            ..said("0,0,1,1\n")
        }
    );
}

#[test]
fn force_without_a_file_or_a_shape_is_refused() {
    let shelf = Shelf::new();
    for line in [
        "export|washer|-|--format|txt|--force",
        "figure|ellipse|--export|-|--format|txt|--force",
    ] {
        let run = shelf.run(line, "");
        refused(&run, 2, "--force has no effect on standard output");
    }
    // Here it is for the shape.
    for force in ["", "|--force"] {
        let run = shelf.run(
            &format!("figure|ellipse|--save|oval|--export|-|--format|txt{force}"),
            "",
        );
        assert_eq!((run.status, &*run.stderr), (Some(0), "saved as oval\n"));
    }
}

#[test]
fn files_are_only_overwritten_with_force() {
    let folder = Folder::new();
    folder.write("old.svg", b"mine");
    let there = "\"old.svg\" already exists; --force replaces it";
    refused(&folder.run("export washer old.svg"), 1, there);
    refused(&folder.run(&format!("{RING} --export old.svg")), 1, there);
    assert_eq!(folder.read("old.svg"), b"mine");
    assert_eq!(
        folder.run("export washer old.svg --force"),
        said("written: old.svg\n")
    );
    assert!(folder.read("old.svg").starts_with(b"<svg"));
    // Only files are replaced, and no partial file is left.
    let path = |name: &str| folder.0.path().join(name);
    std::fs::create_dir(path("folder.svg")).expect("made");
    std::os::unix::fs::symlink("old.svg", path("link.svg")).expect("made");
    for name in ["folder.svg", "link.svg"] {
        refused(
            &folder.run(&format!("export washer {name} --force")),
            1,
            &format!("{name}: cannot write: only regular files are replaced"),
        );
    }
    std::fs::remove_file(path("link.svg")).expect("removed");
    if super::wait::fifo(&path("pipe.svg")) {
        refused(
            &folder.run("export washer pipe.svg --force"),
            1,
            "pipe.svg: cannot write: only regular files are replaced",
        );
        std::fs::remove_file(path("pipe.svg")).expect("removed");
    }
    refused(
        &folder.run("export washer no/such.svg"),
        1,
        "no/such.svg: cannot write: no such folder",
    );
    assert_eq!(folder.names(), ["folder.svg", "old.svg"]);
}

#[test]
fn bad_targets_are_refused_with_what_is_expected() {
    refused(
        &taxel("export washer - --format csv --pitch 2", ""),
        2,
        "--pitch has no effect on this format: it is for drawings",
    );
    misused(
        "export washer washer.bmp",
        "'washer.bmp': expected a name that ends in .txt, .pbm, .csv, .npy or .svg, or a '--format'",
    );
    misused(
        "export washer -",
        "writing to standard output needs '--format'",
    );
    misused(
        "export washer a.svg --format gif",
        "invalid value 'gif' for '--format <FORMAT>'",
    );
    misused(
        "figure hexagon --format svg",
        "the following required arguments were not provided",
    );
    misused(
        "figure hexagon --force",
        "the following required arguments were not provided",
    );
    refused(
        &taxel("export nowhere a.svg", ""),
        1,
        "no stored shape or file named \"nowhere\"; to list all shapes: taxel library list",
    );
    refused(
        &taxel("export - - --format csv", "P1 2 1 2"),
        1,
        "standard input: PBM: expected 2 digits, each 0 or 1",
    );
}

#[test]
fn screens_of_a_script_are_drawn() {
    let folder = Folder::new();
    folder.write(
        "tour.taxel",
        b"Size 60x20\nScreen\nKeys f<Enter>\nScreen ../a figure!\nState /na\n",
    );
    let plain = folder.run("script tour.taxel");
    assert_eq!(plain.status, Some(0));
    let drawn = folder.run("script tour.taxel --svg .");
    assert_eq!(drawn, plain, "what is printed is the same");
    assert_eq!(
        folder.names(),
        ["screen-1.svg", "screen-2.svg", "tour.taxel"]
    );
}

#[test]
fn a_drawn_screen_has_the_theme_and_is_not_overwritten() {
    let folder = Folder::new();
    let line = "script -k f<Enter> --size 60x20 --svg .";
    assert_eq!(folder.run(line).status, Some(0));
    let dark = String::from_utf8(folder.read("screen-1.svg")).expect("text");
    // 60 × 20 characters of 9 × 18, and the margin.
    assert!(
        dark.starts_with("<svg ") && dark.contains("viewBox=\"0 0 564 384\""),
        "{dark}"
    );
    assert!(dark.contains("fill=\"#1c1c1c\"/>") && dark.contains("fill=\"#87d787\"/>"));
    assert!(dark.contains("NA 52 in all"));
    let there = "\"./screen-1.svg\" already exists; --force replaces it";
    refused(&folder.run(line), 1, there);
    folder.write(
        "light.taxel",
        b"Set theme light\nSize 60x20\nKeys f<Enter>\nScreen screen-1\n",
    );
    let light = folder.run("script light.taxel --svg . --force");
    assert_eq!((light.status, light.stderr.as_str()), (Some(0), ""));
    let light = String::from_utf8(folder.read("screen-1.svg")).expect("text");
    assert!(light.contains("fill=\"#ffffff\"/>") && light.contains("fill=\"#008700\"/>"));
}

#[test]
fn export_and_save_either_both_happen_or_neither() {
    let folder = Folder::new();
    let run = folder.run(&format!("{RING} --export ring.txt --save washer"));
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    assert_eq!(folder.names(), [""; 0], "{}", run.stderr);
}

#[cfg(unix)]
#[test]
fn a_replaced_file_keeps_its_permissions() {
    use std::os::unix::fs::PermissionsExt;
    let folder = Folder::new();
    folder.write("own.svg", b"mine");
    let path = folder.0.path().join("own.svg");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600)).expect("set");
    assert_eq!(folder.run("export washer own.svg --force").status, Some(0));
    let mode = std::fs::metadata(&path)
        .expect("there")
        .permissions()
        .mode();
    assert_eq!(mode & 0o777, 0o600);
}

/// The byte order mark that editors write before a text is not a taxel.
#[test]
fn a_byte_order_mark_is_skipped() {
    let folder = Folder::new();
    for (name, content) in [("a.txt", ".#\n##\n"), ("a.csv", "0,1\n1,1\n")] {
        folder.write(name, format!("\u{feff}{content}").as_bytes());
        let run = folder.run(&format!("describe {name} --json"));
        assert!(
            run.stdout.starts_with(r###"{"imprint":[".#","##"],"###),
            "{run:?}"
        );
    }
    let shape = folder.run("export washer - --format txt").stdout;
    folder.write("P.txt", shape.as_bytes());
    folder.write("w.npz", b"PK\x03\x04");
    refused(
        &folder.run("describe w.npz"),
        1,
        "w.npz: not an imprint: expected rows of '#' and '.', a table of 0 and 1 (CSV), PBM or NPY; if this is a recording, use taxel frames",
    );
}

/// A drawing is in the mm of the flag, or else in those of the shape's own sensor.
#[test]
fn a_stored_pitch_is_used() {
    let folder = Folder::new();
    let line = format!("{RING} --pitch 2.5 --save pit --library .");
    assert_eq!(folder.run(&line).status, Some(0));
    let drawn = folder.run("export pit - --format svg --library .").stdout;
    assert!(drawn.contains(">x / mm</text>") && drawn.contains("(in cells)</text>"));
    let told = folder.run("describe pit --library .").stdout;
    assert!(
        told.contains("of 2.5 mm") && told.contains("in mm²"),
        "{told}"
    );
    let drawn = folder.run("export washer - --format svg").stdout;
    assert!(drawn.contains(">x / cells</text>"));
    let tiny = folder
        .run("export washer - --format svg --pitch 5e-324")
        .stdout;
    assert!(tiny.contains("<svg") && !tiny.contains("NaN"));
}
