//! Recognition on the screen: stored models, the cache, and stopping work.

use std::fs;
use std::path::Path;

use taxel::tui::jobs::Jobs;
use taxel_core::figure::Figure;
use taxel_core::pose::{Anchor, Axis, Ranges};
use taxel_core::recognition::{NamedShape, Training};
use taxel_core::sensor::Sensor;
use taxel_files::formats::Name;
use taxel_files::storage::{Existing, Library, ModelFolder};

use crate::explore::Beside;
use crate::session::{hides, models, press, session, shows, started, untrained, world};

/// Makes a library with a stored model: a bar, and one shape under two names.
fn with_model(folder: &Path) -> Library {
    let library = Library::open(folder.join("library"));
    let shapes = [("bar", 6.0, 2.0), ("one", 4.0, 4.0), ("other", 4.0, 4.0)];
    save_model(&library, &shapes);
    library
}

/// Trains the stored model with rectangles, each with its name, length and width.
fn save_model(library: &Library, shapes: &[(&str, f64, f64)]) {
    let sensor = Sensor::default();
    let bar = |length: f64, width: f64| Figure::rectangle(length, width).on(&sensor);
    let named = |&(name, length, width): &(&str, f64, f64)| {
        NamedShape::new(name, bar(length, width).expect("in range"))
    };
    let shapes = shapes.iter().map(named);
    let ranges = Ranges::default().with(Axis::Angle, "0:80:10".parse().expect("a range"));
    // The poses that are found are those of the centre all the same.
    let training = Training::new(shapes, sensor, Anchor::Corner, ranges).expect("a set");
    let model = training.run().expect("not stopped");
    let name = Name::new("my parts").expect("a name");
    let models = ModelFolder::of(library.folder());
    let saved = models.save(&model, &name, Existing::Replaced);
    saved.expect("written");
}

#[test]
fn a_stored_model_that_was_trained_anew_is_read_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let library = with_model(folder.path());
    let square = ":figure rectangle --length 4 --width 4 --x0 5 --y0 5<Enter>";
    let keys = format!("{square}:recognise my parts<Enter>");
    let mut session = started(Jobs::new(library.clone()), &keys);
    shows(&session, &["one or other: tied"]);
    save_model(&library, &[("bar", 6.0, 2.0), ("block", 4.0, 4.0)]);
    press(&mut session, "<Esc>r");
    shows(
        &session,
        &["model my parts", "block  >99.9 %  fits exactly", "certain"],
    );
    save_model(&library, &[("bar", 6.0, 2.0), ("square", 4.0, 4.0)]);
    press(&mut session, ":recognise my parts<Enter>");
    shows(
        &session,
        &["model my parts", "square  >99.9 %  fits exactly", "certain"],
    );
    let name = Name::new("my parts").expect("a name");
    let deleted = ModelFolder::of(library.folder()).delete(&name);
    deleted.expect("deleted");
    press(&mut session, ":recognise my parts<Enter>");
    shows(
        &session,
        &["no model or file named \"my parts\"", "not read"],
    );
}

#[test]
fn a_model_that_cannot_be_read_does_not_block_the_next_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let library = with_model(folder.path());
    let broken = library.folder().join("models/broken.npz");
    fs::write(broken, "junk").expect("written");
    let world = Jobs::new(library).with_model_cache(Some(models()));
    let mut session = started(world, ":recognise shapes<Enter>:recognise broken<Enter>");
    shows(&session, &["broken.npz: ", "Recognise: model shapes"]);
    press(&mut session, "<Esc>:recognise my parts<Enter>");
    shows(&session, &["Recognise: model my parts"]);
}

fn beside(keys: &str) -> Beside {
    Beside::within(untrained(), keys)
}

#[test]
fn a_stored_model_is_completed_and_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let library = with_model(folder.path());
    let world = || Jobs::new(library.clone()).with_model_cache(Some(models()));
    let begin = |keys: &str| started(world(), keys);
    let mut session = begin(":recognise my<Tab><Enter>");
    shows(&session, &["Recognise: model my parts"]);
    press(
        &mut session,
        ":figure rectangle --length 4 --width 4 --x0 5 --y0 5<Enter>",
    );
    shows(
        &session,
        &["one or other: tied; one: fits exactly", "50.0 %"],
    );
    // Two taxels that no shape of the model leaves.
    press(&mut session, "n<Space><Right><Right><Space>");
    shows(&session, &["none of these: nearest ", "if it were one"]);
    shows(&begin(":recognise <Tab>"), &["figures-30", "my parts"]);
    let models = ModelFolder::of(library.folder());
    let file = folder.path().join("parts of today.npz");
    let stored = models.find(&Name::new("my parts").expect("a name"));
    fs::copy(stored.expect("it is there"), &file).expect("copied");
    let by_path = format!(":recognise {}<Enter>", file.display());
    shows(&begin(&by_path), &["Recognise: model parts of today.npz"]);
    let missing = ":recognise ./nowhere.npz<Enter>";
    shows(
        &begin(missing),
        &["no model or file named \"./nowhere.npz\"; models: "],
    );
    let in_folder = format!(":recognise {}<Enter>", folder.path().display());
    shows(&begin(&in_folder), &["not a regular file"]);
    shows(
        &begin(":recognise ./Cargo.t<Tab>"),
        &[":recognise ./Cargo.toml"],
    );
    // A file in the working folder is named without a path; this one contains no model.
    shows(&begin(":recognise Cargo.toml<Enter>"), &["Cargo.toml: "]);
    // A model that does not exist is refused with a list of the others.
    let all = "no model or file named \"nonsense\"; models: library, figures, figures-30,";
    shows(
        &begin(":recognise nonsense<Enter>"),
        &[all, "shapes, my parts"],
    );
}

#[test]
fn a_random_touch_tells_its_shape_and_can_be_undone() {
    let figures = "ellipse rectangle triangle pentagon hexagon heptagon octagon";
    let mut touched = std::collections::BTreeSet::new();
    let mut session = started(world(), ":seed 1<Enter>:recognise figures<Enter>ta");
    for _ in 0..20 {
        press(&mut session, "t");
        let screen = session.screen();
        let name = figures
            .split(' ')
            .find(|name| screen.contains(&format!("a random touch of {name}; u undoes it")));
        let name = name.unwrap_or_else(|| panic!("no name on\n{screen}"));
        assert!(screen.contains(&format!("  {name}  ")), "{screen}");
        assert!(screen.contains("fits exactly"), "{screen}");
        assert!(!screen.contains("kept"), "{screen}");
        touched.insert(name);
    }
    assert!(touched.len() > 4, "{touched:?}");
    press(&mut session, "n<Space>t");
    shows(&session, &["random touch"]);
    press(&mut session, "u");
    shows(&session, &["NA 1 in all"]);
}

#[test]
fn the_fit_is_to_the_touch_on_the_matrix() {
    // Touches that contradict each other name no shape; the one on the matrix is compared with the shape that is nearest.
    let contradicts = ":recognise figures<Enter>\
        :figure rectangle --length 4 --width 6 --x0 5 --y0 5<Enter>a\
        :figure triangle --side 6 --x0 5 --y0 5<Enter>";
    let mut session = session(contradicts);
    shows(&session, &["none of these: nearest ", " surplus"]);
    press(&mut session, "n");
    shows(&session, &["1 touch kept", "rectangle  "]);
    hides(&session, &[" surplus"]);
}

/// A hexagon at another threshold leaves the imprint of an ellipse at that of the model.
#[test]
fn a_threshold_that_differs_from_that_of_the_model_is_pointed_out() {
    let note = "trained at threshold 0.5; here it is 0.2";
    let mut session = session("r:sensor --threshold 0.2<Enter>");
    hides(&session, &[note]);
    press(
        &mut session,
        ":figure hexagon --side 4 --x0 4 --y0 4<Enter>",
    );
    shows(&session, &[note]);
    press(&mut session, ":sensor --threshold 0.5<Enter>");
    hides(&session, &[note]);
    // What is drawn was not made by a threshold.
    press(&mut session, ":sensor --threshold 0.2<Enter>n<Space>");
    hides(&session, &["trained at"]);
}

#[test]
fn escape_stops_a_training() {
    let mut program = beside(":recognise shapes<Enter>");
    shows(&program.session, &["being trained; Esc stops"]);
    press(&mut program.session, "<Enter>");
    shows(&program.session, &["! the model is not ready yet"]);
    press(&mut program.session, "<Esc>");
    hides(&program.session, &["Recognise:"]);
    press(&mut program.session, "r");
    program.until("certain 99.8 %");
}

#[test]
fn a_random_touch_waits_for_its_model() {
    let mut program = beside("f<Enter>rt");
    shows(&program.session, &["a model is prepared first"]);
    program.until("a random touch of ");
    hides(&program.session, &["prepared first"]);
    // The user does something else by then.
    let mut program = beside("rt:");
    program.until("certain 99.8 %");
    hides(&program.session, &["a random touch of "]);
}
