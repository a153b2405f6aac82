//! Tests of `taxel library`, `--save` and `--library`: every command, every refusal.

use std::path::PathBuf;

use tempfile::TempDir;

use super::Run;
use super::misused;
use super::refused;
use super::run_in;

/// A library in a temporary folder.
pub(super) struct Shelf {
    outside: TempDir,
    pub(super) folder: PathBuf,
}

impl Shelf {
    pub(super) fn new() -> Self {
        let outside = tempfile::tempdir().expect("there is a folder for temporary files");
        let folder = outside.path().join("library");
        Self { outside, folder }
    }

    /// Runs a command line, split at `|`, on this library.
    pub(super) fn run(&self, line: &str, input: &str) -> Run {
        let folder = self.folder.to_str().expect("text");
        let mut arguments: Vec<&str> = line.split('|').collect();
        arguments.extend(["--library", folder]);
        run_in("C.UTF-8", &arguments, input.as_bytes())
    }

    /// Runs a line that must succeed, and returns its output.
    pub(super) fn does(&self, line: &str, input: &str) -> String {
        let run = self.run(line, input);
        assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""), "{line}");
        run.stdout
    }

    /// Writes a file outside the library.
    pub(super) fn file(&self, name: &str, content: &str) -> String {
        let path = self.outside.path().join(name);
        std::fs::write(&path, content).expect("written");
        path.to_str().expect("text").to_owned()
    }

    /// Runs a line that must fail with this message, in which the library is written as FOLDER.
    pub(super) fn refuses(&self, line: &str, message: &str) {
        let run = self.run(line, "");
        let folder = self.folder.display().to_string();
        let stderr = run.stderr.replace(&folder, "FOLDER");
        refused(&Run { stderr, ..run }, 1, message);
    }
}

const RING: &str = ".##.\n#..#\n.##.\n";

#[test]
fn a_shape_is_saved_listed_shown_deleted_and_restored() {
    let shelf = Shelf::new();
    assert_eq!(
        shelf.does("library|save|my ring|-", RING),
        "saved as my ring\n"
    );
    let list = shelf.does("library|list", "");
    let mut lines = list.lines();
    assert_eq!(
        lines.next(),
        Some("name           origin      size   NA  pieces  holes")
    );
    assert_eq!(
        lines.next(),
        Some("my ring        own        4 × 3    6       1      1")
    );
    assert_eq!(
        lines.next(),
        Some("arrow          shipped  16 × 16   74       1      0")
    );
    assert!(list.contains("\nsmile          shipped  16 × 16  102       4      1\n"));
    let shown = shelf.does("describe|MY RING", "");
    assert!(shown.contains("\nmy ring\n4 × 3 taxels, threshold 0.5, NA 6 in all\n"));
    let json = shelf.does("describe|my ring|--json", "");
    assert!(json.starts_with(r##"{"imprint":[".##.","#..#",".##."],"na":6,"##));
    assert!(
        shelf
            .does("describe|my ring|--pitch|2", "")
            .contains("in mm²")
    );
    let deleted = shelf.does("library|delete|My Ring", "");
    let restores = "deleted my ring; 'taxel library restore' brings it back\n";
    assert_eq!(deleted, restores);
    let none = "no shape named \"my ring\"; 'taxel library list' shows all";
    shelf.refuses("library|delete|my ring", none);
    let typo = "no stored shape or file named \"wahser\"; did you mean \"washer\"?";
    shelf.refuses("describe|wahser", typo);
    assert_eq!(
        shelf.does("library|restore|MY RING", ""),
        "restored my ring\n"
    );
    shelf.refuses(
        "library|restore|my ring",
        "no shape named \"my ring\" in the trash",
    );
    let path = shelf.does("library|path", "");
    assert_eq!(path, format!("{}\n", shelf.folder.display()));
}

#[test]
fn an_existing_shape_is_only_replaced_with_force() {
    let shelf = Shelf::new();
    shelf.does("library|save|one|-", RING);
    let taken = "\"one\" already exists; --force replaces it";
    let other = shelf.file("other.txt", "#");
    shelf.refuses(&format!("library|save|ONE|{other}"), taken);
    shelf.refuses("figure|hexagon|--save|one", taken);
    shelf.refuses("picture|washer|--save|one", taken);
    assert!(shelf.does("describe|one", "").contains("NA 6 in all"));
    shelf.does(&format!("library|save|ONE|{other}|--force"), "");
    assert!(shelf.does("describe|one", "").contains("NA 1 in all"));
    let shipped = "\"washer\" comes with taxel and cannot be replaced; choose another name";
    shelf.refuses("library|save|washer|key|--force", shipped);
    shelf.refuses("figure|hexagon|--save|washer|--force", shipped);
    let undeletable = "\"washer\" comes with taxel and cannot be deleted";
    shelf.refuses("library|delete|washer", undeletable);
    shelf.refuses(
        "library|restore|washer",
        "no shape named \"washer\" in the trash",
    );
}

#[test]
fn figures_are_saved_with_their_sensor_and_source() {
    let shelf = Shelf::new();
    let touched = shelf.does(
        "figure|hexagon|--angle|7.25|--columns|20|--pitch|2.5|--save|mine",
        "",
    );
    assert!(
        touched.contains("\n20 × 16 taxels of 2.5 mm, threshold 0.5, NA ")
            && touched.contains(" in all\nsaved as mine\n"),
        "{touched}"
    );
    let shown = shelf.does("describe|mine", "");
    assert!(
        shown.contains("\nmine\nhexagon side ") && shown.contains("\n20 × 16 taxels of 2.5 mm"),
        "{shown}"
    );
    let run = shelf.run("figure|hexagon|--json|--save|json", "");
    assert_eq!(
        (run.status, run.stderr.as_str()),
        (Some(0), "saved as json\n")
    );
    assert_eq!(run.stdout.lines().count(), 1, "nothing but the answer");
    assert_eq!(run.stdout, shelf.does("describe|json|--json", ""));
    // A copy has everything of the original; a file of the library can be read like any other file.
    let file = shelf.folder.join("mine.json").display().to_string();
    shelf.does(&format!("library|save|copy|{file}"), "");
    let copied = shelf.does("describe|copy", "");
    assert_eq!(copied.replace("\ncopy\n", "\nmine\n"), shown);
    shelf.does("library|save|other washer|washer", "");
    assert!(
        shelf
            .does("describe|other washer", "")
            .contains("\nellipse rx 4.00 ry 4.00 at 1.99")
    );
}

#[test]
fn a_list_of_a_folder_that_does_not_exist_warns() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("shapes_missing").display().to_string();
    let said = format!("{missing} does not exist; it is made when a shape is saved\n");
    for (form, start) in [("", "name"), (" --json", "[{")] {
        let run = super::taxel(&format!("library list{form} --library {missing}"), "");
        assert_eq!(
            (run.status, run.stderr),
            (Some(0), format!("warning: {said}"))
        );
        assert!(run.stdout.starts_with(start), "{}", run.stdout);
    }
}

#[test]
fn broken_shapes_are_listed_with_the_reason() {
    let shelf = Shelf::new();
    shelf.does("library|save|good|-", RING);
    let file = |name: &str| shelf.folder.join(name);
    std::fs::write(file("bad\u{e9}.json"), "{\"format\":\"taxel-shape/9\"}").expect("written");
    std::fs::copy(file("good.json"), file("MASS.json")).expect("copied");
    // The screen's own files belong to the library; the others are foreign.
    for name in [".commands", "notes.txt"] {
        std::fs::write(file(name), "").expect("written");
    }
    let folder = shelf.folder.display().to_string();
    let reason = "FOLDER/bad\u{e9}.json: line 1, column 25: unknown value `taxel-shape/9`, expected `taxel-shape/1`";
    let list = shelf.does("library|list", "").replace(&folder, "FOLDER");
    let lines: Vec<&str> = list.lines().skip(1).take(3).collect();
    assert_eq!(
        lines,
        [
            &format!("bad\u{e9}           broken   {reason}"),
            "good           own        4 × 3    6       1      1",
            "MASS           own        4 × 3    6       1      1",
        ]
    );
    let json = shelf.does("library|list|--json", "");
    assert!(json.is_ascii(), "{json}");
    let parsed: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let shipped = taxel_files::storage::shipped::names().count();
    assert_eq!(parsed.as_array().map(Vec::len), Some(shipped + 3));
    assert_eq!(
        (&parsed[0]["name"], &parsed[0]["origin"]),
        (&"bad\u{e9}".into(), &"broken".into())
    );
    assert_eq!(
        parsed[1],
        serde_json::json!({"name": "good", "origin": "own", "columns": 4, "rows": 3, "na": 6, "pieces": 1, "holes": 1})
    );
    // The library has this name, so no file is looked for.
    let run = shelf.run("picture|bad\u{e9}", "");
    assert_eq!(run.status, Some(1));
    assert!(run.stderr.contains("taxel-shape/9"), "{}", run.stderr);
}

#[test]
fn the_library_flag_may_stand_anywhere() {
    let shelf = Shelf::new();
    let folder = shelf.folder.to_str().expect("text");
    for line in [
        ["--library", folder, "library", "path"],
        ["library", "--library", folder, "path"],
        ["library", "path", "--library", folder],
    ] {
        let run = run_in("C", &line, b"");
        assert_eq!(run.stdout, format!("{folder}\n"));
    }
    assert!(!shelf.folder.exists(), "nothing is made by looking");
}

#[test]
fn wrong_usage_exits_with_status_2() {
    misused("library", "'taxel library' requires a subcommand");
    misused(
        "library delete ../x",
        "invalid value '../x' for '<NAME>': '/' cannot be in a name, only letters, digits, space, - _ .\n",
    );
    misused(
        "figure hexagon --force",
        "the following required arguments were not provided:\n  <--save <NAME>|--export <FILE>>\n",
    );
}

/// If the library's folder would be below a file, shipped shapes can be read, but none can be saved.
#[test]
fn a_library_path_below_a_file_still_has_the_shipped_shapes() {
    let shelf = Shelf::new();
    let below = shelf.file("file", "") + "/library";
    let run = |line: &str| super::taxel(&format!("{line} --library {below}"), "");
    assert_eq!(run("describe washer").status, Some(0));
    let saved = run("library save mine washer");
    let message = format!("error: {below}: cannot make the folder: ");
    assert_eq!(saved.status, Some(1));
    assert!(saved.stderr.starts_with(&message), "{}", saved.stderr);
}
