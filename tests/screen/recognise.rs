//! Recognition on the screen: stored models, the cache, stopping work, and what is remembered.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use taxel::tui::app::message::Message;
use taxel::tui::jobs::Jobs;
use taxel::tui::script::Session;
use taxel_core::figure::Figure;
use taxel_core::pose::{Anchor, Axis, Ranges};
use taxel_core::recognition::{NamedShape, Training};
use taxel_core::sensor::Sensor;
use taxel_files::formats::Name;
use taxel_files::storage::{Existing, Library, ModelCache, ModelFolder};

use crate::session::{hides, models, press, session, sized, started, then, untrained, world};

/// The longest time that work may take.
const DEADLINE: Duration = Duration::from_secs(120);

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
    shows(&session, &["tied: one, other"]);
    save_model(&library, &[("bar", 6.0, 2.0), ("block", 4.0, 4.0)]);
    press(&mut session, "<Esc>r");
    shows(&session, &["model my parts", "certain: block"]);
    save_model(&library, &[("bar", 6.0, 2.0), ("square", 4.0, 4.0)]);
    press(&mut session, ":recognise my parts<Enter>");
    shows(&session, &["model my parts", "certain: square"]);
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
    let mut session = started(world, ":recognise shapes<Enter>o");
    shows(&session, &["broken.npz: ", "Recognise: model shapes"]);
    press(&mut session, "o");
    shows(&session, &["Recognise: model my parts"]);
    // On the live page, too, the model before it returns, and the next step goes past it.
    press(
        &mut session,
        "<Esc>:watch tests/scripts/touch.csv<Enter>ooo",
    );
    session.frames(6);
    press(&mut session, "+o");
    shows(&session, &["! ", "broken.npz: ", "model      shapes"]);
    press(&mut session, "o");
    shows(
        &session,
        &["shapes are named by model my parts", "model      my parts"],
    );
}

#[test]
fn own_models_name_the_shapes_of_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let world = Jobs::new(with_model(folder.path()));
    let mut page = started(world, ":watch tests/scripts/touch.csv<Enter>oooo");
    shows(&page, &["shapes are named by model my parts"]);
    press(&mut page, "o");
    shows(&page, &["shapes are not named"]);
}

fn shows(session: &Session, texts: &[&str]) {
    let screen = session.screen();
    for text in texts {
        assert!(screen.contains(text), "no {text:?} on\n{screen}");
    }
}

#[test]
fn a_stored_model_is_completed_used_and_remembered() {
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
    shows(&session, &["tied: one, other", "50.0 %", "one centre"]);
    // Two taxels that no shape of the model leaves.
    press(&mut session, "n<Space><Right><Right><Space>");
    shows(
        &session,
        &["unknown: no shape leaves this imprint", "nearest: "],
    );
    shows(&begin("r"), &["Recognise: model my parts"]);
    // When another model is chosen, that one is remembered.
    begin("rO");
    shows(&begin("r"), &["Recognise: model shapes"]);
    shows(&begin(":recognise <Tab>"), &["figures-30", "my parts"]);
    // A file is named by its path and not remembered, because the next run may start in another folder.
    let models = ModelFolder::of(library.folder());
    let file = folder.path().join("parts of today.npz");
    let stored = models.find(&Name::new("my parts").expect("a name"));
    fs::copy(stored.expect("it is there"), &file).expect("copied");
    let by_path = format!(":recognise {}<Enter>", file.display());
    shows(&begin(&by_path), &["Recognise: model parts of today.npz"]);
    shows(&begin("r"), &["Recognise: model shapes"]);
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
    // A model that does not exist is refused with a list of the others, and not remembered.
    let all = "no model or file named \"nonsense\"; models: figures, figures-30, shapes, my";
    shows(&begin(":recognise nonsense<Enter>"), &[all, "parts"]);
    shows(&begin("r"), &["Recognise: model shapes"]);
}

#[test]
fn a_random_touch_tells_its_shape_and_can_be_undone() {
    let figures = "ellipse rectangle triangle pentagon hexagon heptagon octagon";
    let mut touched = std::collections::BTreeSet::new();
    let mut session = started(world(), ":seed 1<Enter>rta");
    for _ in 0..20 {
        press(&mut session, "t");
        let screen = session.screen();
        let name = figures
            .split(' ')
            .find(|name| screen.contains(&format!("a random touch of {name}; u undoes it")));
        let name = name.unwrap_or_else(|| panic!("no name on\n{screen}"));
        assert!(screen.contains(&format!("certain: {name}")), "{screen}");
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
fn the_pose_belongs_to_the_shape_that_all_touches_name() {
    // Touches that contradict each other name no shape, so the pose says whose it is.
    let contradicts = ":recognise figures<Enter>\
        :figure rectangle --length 4 --width 6 --x0 5 --y0 5<Enter>a\
        :figure triangle --side 6 --x0 5 --y0 5<Enter>";
    shows(
        &session(contradicts),
        &["unknown: no shape leaves all of these", "triangle centre"],
    );
}

#[test]
fn the_pose_is_shown_with_its_unit() {
    shows(
        &session("f<Enter>r"),
        &["centre 8.00 ± 0.09, 8.00 ± 0.09 cells"],
    );
    let narrow = sized((40, 12), false, "f<Enter>r");
    shows(
        &narrow,
        &["limit: error 0.0 %, certain 100.0 %\n", "0.09 cells\n"],
    );
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

/// There are few columns beside a large sensor, so long lines are wrapped.
#[test]
fn nothing_is_cut_off_beside_a_large_sensor() {
    let sensor = ":sensor --columns 64 --rows 64<Enter>:seed 4<Enter>";
    let mut session = started(world(), &format!("{sensor}:recognise figures-30<Enter>t"));
    for size in [(80, 24), (70, 24)] {
        session.resize(size.0, size.1);
        let screen = session.screen();
        assert!(!screen.contains('…'), "{size:?}\n{screen}");
        // The text of the panel alone.
        let panel = screen.lines().map(|line| {
            let columns: Vec<char> = line.chars().collect();
            let first = columns.len().min(usize::from(size.0) - 30);
            columns[first..].iter().collect::<String>()
        });
        let panel = panel.collect::<Vec<_>>().join(" ");
        let panel = panel.split_whitespace().collect::<Vec<_>>().join(" ");
        for text in [
            "grid: 0.01 cells, 1°; 25,200,000 touches",
            "error 33.0 %, certain 38.3 %",
        ] {
            assert!(panel.contains(text), "{size:?}: no {text:?}\n{screen}");
        }
    }
}

#[test]
fn a_set_that_does_not_exist_changes_nothing() {
    let refused = "no model or file named \"nope\"; models: figures, figures-30, shapes";
    let shows_no = |session: &Session, text: &str| {
        let screen = session.screen();
        assert!(!screen.contains(text), "{text:?} on\n{screen}");
    };
    let mut session = started(world(), ":recognise nope<Enter>");
    shows(
        &session,
        &[refused, ":recognise nope", "The matrix is empty"],
    );
    shows_no(&session, "Recognise: model");
    press(&mut session, "<Esc>r");
    shows(&session, &["Recognise: model figures", "t touch"]);
    shows_no(&session, "not read");
    // The open page stays open, with the set that it has.
    press(&mut session, ":recognise nope<Enter>");
    shows(&session, &[refused, "Recognise: model figures"]);
    press(&mut session, "<Esc><Esc>:recognise nope<Enter><Esc>");
    shows(&session, &["The matrix is empty"]);
}

#[test]
fn a_command_that_needs_a_model_is_carried_out_once_there_is_one() {
    shows(&session(":confusion<Enter>"), &["Confusion: model figures"]);
    let mut program = Beside::new(":confusion<Enter>");
    let first = "a model is prepared first";
    shows(&program.session, &["Recognise: model figures", first]);
    program.until("Confusion: model figures");
    // The user does something else by then.
    let mut program = Beside::new(":confusion<Enter>:");
    program.until("certain 100.0 %");
    hides(&program.session, &["Confusion"]);
}

#[test]
fn a_damaged_or_outdated_model_in_the_cache_is_trained_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let cache = folder.path().join("cache");
    let open = || {
        let world = world().with_model_cache(Some(ModelCache::in_folder(&cache)));
        let session = started(world, "r");
        shows(&session, &["Recognise: model figures", "certain 100.0 %"]);
    };
    open();
    let path = fs::read_dir(&cache)
        .expect("a folder")
        .flatten()
        .map(|file| file.path())
        .find(|path| path.extension().is_some_and(|ending| ending == "npz"));
    let path = path.expect("the model is kept");
    let whole = fs::read(&path).expect("read");
    let format: &[u8] = b"taxel-model/1";
    let place = whole.windows(format.len()).position(|own| own == format);
    let mut older = whole.clone();
    older[place.expect("the header names its form") + format.len() - 1] = b'0';
    for damaged in [&whole[..whole.len() / 2], &older[..], b""] {
        fs::write(&path, damaged).expect("written");
        open();
        assert!(fs::read(&path).expect("read") == whole, "it is made again");
    }
}

/// A program whose workers run beside it, and the events that they report.
struct Beside {
    session: Session,
    told: Receiver<()>,
}

impl Beside {
    fn new(keys: &str) -> Self {
        let (post, told) = channel();
        let world = untrained().with_threads(Arc::new(move || {
            // The test may have ended.
            let _ = post.send(());
        }));
        let session = started(world, keys);
        Self { session, told }
    }

    /// Passes on the events of workers until a text is on the screen.
    fn until(&mut self, text: &str) {
        while !self.session.screen().contains(text) {
            let told = self.told.recv_timeout(DEADLINE);
            told.unwrap_or_else(|_| panic!("no {text:?} on\n{}", self.session.screen()));
            self.session.send(Message::Answered);
        }
    }
}

#[test]
fn work_beyond_the_pose_limit_is_stopped() {
    let of_eleven = "fr<Enter>:explore --x0 5:6:0.1 --y0 5 --angle 0<Enter>";
    let stopped = "stopped before anything was complete";
    let looks = |poses| started(untrained().with_pose_limit(poses), of_eleven);
    hides(&looks(11), &[stopped]);
    shows(&looks(10), &[stopped]);
    shows(
        &started(untrained().with_pose_limit(10), "r"),
        &["training was stopped"],
    );
}

#[test]
fn another_model_is_named_also_where_the_panel_is_hidden() {
    let mut page = sized((60, 20), false, ":recognise figures-30<Enter><Tab>");
    then(
        &mut page,
        "O",
        &["model figures; train your own with 'taxel model train'"],
    );
    then(&mut page, "o", &["model figures-30; train your own with"]);
}

#[test]
fn escape_stops_a_training_and_enter_restarts_it() {
    let mut program = Beside::new(":recognise shapes<Enter>");
    program.until("training: ");
    shows(&program.session, &["Esc stops"]);
    press(&mut program.session, "<Esc>");
    program.until("training was stopped");
    shows(&program.session, &["not prepared; Enter prepares it"]);
    press(&mut program.session, "P");
    shows(&program.session, &["! the model is not prepared yet"]);
    press(&mut program.session, "<Enter>");
    program.until("training: ");
    press(&mut program.session, "<Esc>");
    program.until("not prepared");
}

#[test]
fn keys_that_need_a_model_wait_for_it() {
    for (key, text) in [
        ("v", "Confusion: "),
        ("t", "a random touch of "),
        ("P", "the poses are still being searched for"),
    ] {
        let mut program = Beside::new(&format!("f<Enter>r{key}"));
        shows(&program.session, &["a model is prepared first"]);
        program.until(text);
        hides(&program.session, &["prepared first"]);
    }
}

#[test]
fn a_notice_that_the_model_is_not_ready_goes_when_it_is() {
    let mut program = Beside::new("r<Enter>");
    shows(&program.session, &["the model is not ready yet"]);
    program.until("the model is ready");
    hides(&program.session, &["not ready"]);
}

/// A page that is closed does not follow the matrix.
#[test]
fn poses_are_those_of_the_present_touch_even_if_the_page_was_closed() {
    let screen = session("r<Esc>f<Enter>:poses<Enter>").screen();
    assert!(!screen.contains("nothing is touched"), "{screen}");
}
