//! The keys of the live page, on a recording with a clock that stands still.

use std::path::Path;
use std::sync::Arc;

use taxel::frames::Pipeline;
use taxel::tui::app::Message;
use taxel::tui::live::{LiveMessage, WatchRequest};
use taxel::tui::script::Session;
use taxel_core::frame::{Rule, RuleOrigin, SetRule};
use taxel_core::imprint::Imprint;
use taxel_core::matrix::Matrix;
use taxel_core::sensor::MatrixSize;

use crate::array::{self, array};
use crate::session::{hides, session, shows, sized, started, then, world};

/// Opens the page, and presses keys after this number of frames.
fn watched(frames: usize, keys: &str) -> Session {
    let mut session = session(":watch tests/scripts/touch.csv<Enter>");
    session.frames(frames);
    then(&mut session, keys, &[]);
    session
}

/// Opens the page with settings of the command line, before the first frame.
fn set(change: impl FnOnce(&mut WatchRequest)) -> Session {
    let mut request = WatchRequest::new("tests/scripts/touch.csv");
    change(&mut request);
    let mut session = session("");
    session.send(Message::Live(LiveMessage::Watch(Arc::new(request))));
    session
}

/// Sets a threshold like a flag does.
fn ruled(request: &mut WatchRequest, rule: Rule) {
    let (least, from) = (0, RuleOrigin::Flag);
    let rule = Some(SetRule { rule, least, from });
    request.pipeline.processing.apply_rule(rule);
}

fn tared(request: &mut WatchRequest, frames: u64) {
    let processing = request.pipeline.processing.clone();
    request.pipeline = Pipeline::new(processing, Some(frames), RuleOrigin::Flag);
}

/// Sets a threshold by noise, with a tare of the first frames.
fn by_noise(request: &mut WatchRequest, tare: u64) {
    ruled(request, Rule::noise(4.0).expect("in range"));
    tared(request, tare);
}

#[test]
fn an_empty_imprint_has_0_taxels_and_a_missing_one_has_no_count() {
    let mut page = set(|request| ruled(request, Rule::at_least(999.0).expect("in range")));
    page.frames(1);
    shows(&page, &["NA         0\n", "NAE        0\n", "P          –"]);
    shows(&watched(1, ""), &["NA         –", "NAE        –"]);
}

#[test]
fn a_source_is_shown_frame_by_frame() {
    shows(&watched(0, ""), &["touch.csv", "no frame yet"]);
    shows(
        &watched(6, ""),
        &["frame 5  0.5 s", "rate       10/s", "none; + sets one"],
    );
    shows(
        &watched(20, ""),
        &["frame 7  0.7 s", "ended", "Home: the first one, w: again"],
    );
}

#[test]
fn a_recording_that_has_ended_stays_at_its_frame_and_plays_again_by_key() {
    let mut page = watched(20, "+o<Left><Left>");
    let chosen = ["frame 5  0.5 s", "frozen, 2 frames behind", "ended"];
    shows(&page, &chosen);
    then(&mut page, "<Enter>w", &chosen);
    then(&mut page, "<Esc>w", &chosen);
    hides(&page, &["…", "training or"]);
    // Not twice in the same history.
    then(&mut page, "w", &["no frame yet", "threshold  50"]);
    page.frames(6);
    then(&mut page, "<Home>", &["frame 0", "frozen, 5 frames behind"]);
    // Also before its end.
    then(&mut page, "w", &["no frame yet"]);
    page.frames(2);
    then(&mut page, "<Home>", &["frame 0", "frozen, 1 frame behind"]);
}

#[test]
fn an_unreadable_source_opens_no_page() {
    let keys = ":watch nowhere.csv<Enter>";
    shows(
        keys,
        &["! nowhere.csv: cannot open: no such", ":watch nowhere"],
    );
    hides(keys, &["no frame yet"]);
    // The open page remains.
    let mut page = watched(2, "");
    let refused = page.watch("nowhere.csv");
    assert!(refused.is_err_and(|reason| reason.contains("nowhere.csv")));
    shows(&page, &["touch.csv", "frame 1"]);
}

#[test]
fn keys_raise_and_lower_the_threshold_and_change_its_unit() {
    // The first one is half of the range.
    shows(&watched(6, "+"), &["threshold  50", "NA         37"]);
    shows(&watched(6, "++"), &["threshold  51"]);
    shows(&watched(6, "+-"), &["threshold  49"]);
    shows(&watched(6, "+%"), &["threshold  63 % of max"]);
    shows(&watched(6, "+%+"), &["threshold  68 % of max"]);
}

#[test]
fn a_command_sets_the_threshold() {
    let mut page = watched(6, ":at-least 12.5<Enter>");
    shows(
        &page,
        &["frame 5", "touch.csv: threshold 12.5", "threshold  12.5"],
    );
    // A command that acts on the matrix sets the page aside; the source stays open, and the threshold can be set
    // from there as well.
    then(&mut page, ":figure hexagon<Enter>", &["hexagon"]);
    then(
        &mut page,
        ":at-least 20<Enter>",
        &["touch.csv: threshold 20"],
    );
    then(&mut page, "w", &["frame 5", "threshold  20"]);
    for value in ["1e301", "x"] {
        then(&mut page, &format!(":at-least {value}<Enter>"), &["! "]);
        then(&mut page, "<Esc>", &["threshold  20"]);
    }
    shows(":at-least 3<Enter>", &["! no source yet"]);
}

#[test]
fn a_tare_is_set_and_given_up() {
    shows(
        &watched(6, "t"),
        &["tare of the last 6 frames", "tare       6 frames"],
    );
    shows(&watched(6, "tT"), &["tare       none", "tare removed"]);
    shows(&watched(6, "T"), &["! there is no tare"]);
    shows(&watched(0, "t"), &["! no frame yet"]);
}

#[test]
fn the_progress_of_a_tare_is_shown() {
    let mut page = set(|request| tared(request, 4));
    shows(&page, &["tare: 0 of 4 frames"]);
    page.frames(3);
    shows(
        &page,
        &[
            "frame 2",
            "raw  tare: 3 of 4 frames",
            "tare       3 of 4 frames",
        ],
    );
    page.frames(1);
    shows(&page, &["frame 3", "tared", "tare       4 frames"]);
    hides(&page, &["tare:"]);
    // If the source is watched again before the tare is made, the tare starts again.
    let mut page = set(|request| tared(request, 4));
    page.frames(3);
    then(&mut page, "<Esc>ww", &["tare: 0 of 4 frames"]);
    // A key makes the tare from the frames so far, or gives it up.
    page.frames(2);
    then(&mut page, "T", &["tare       none", "tare removed"]);
    hides(&page, &["tare:"]);
    then(&mut page, "T", &["there is no tare"]);
}

#[test]
fn a_recording_of_too_few_frames_for_the_tare_is_an_error() {
    let mut page = set(|request| tared(request, 9));
    page.frames(20);
    let lacking = "! the tare needs 9 frames, but there are only 8";
    shows(&page, &["frame 7", "ended", "tare       none", lacking]);
    then(&mut page, "<Left>", &["frame 6", lacking]);
    then(&mut page, "<End>t", &["tare of the last 8 frames"]);
    hides(&page, &["expected 9"]);
}

#[test]
fn frames_are_shown_while_a_threshold_by_noise_has_no_tare() {
    let mut page = set(|request| by_noise(request, 6));
    page.frames(3);
    shows(
        &page,
        &["frame 2", "4 × noise", "tare: 3 of 6 frames", "raw   "],
    );
    hides(&page, &["no frame yet", "needs a tare"]);
    let not_yet = "! no imprint before the tare: 3 of 6 frames";
    then(&mut page, "<Enter>", &[not_yet]);
    page.frames(3);
    shows(&page, &["frame 5", "tare       6 frames"]);
    let needed = "! a threshold from noise needs a tare of at least two frames";
    then(&mut page, "T<Left>", &["frame 4", "raw   ", needed]);
    let refused = "! no imprint: a threshold from noise needs a tare";
    then(&mut page, "<Enter>", &[refused]);
    then(&mut page, "m", &["frame 4: marked"]);
    then(&mut page, "t", &["tare of the 5 frames up to frame 4"]);
    hides(&page, &["needs a tare"]);
    // The recording ends before the tare is made.
    let mut page = set(|request| by_noise(request, 9));
    page.frames(20);
    shows(&page, &["frame 7", "! the tare needs 9 frames"]);
    then(&mut page, "<Enter>", &[refused]);
}

/// Returns a matrix with the same gain for every cell.
fn gain_of(columns: u8, rows: u8, gain: f64) -> Matrix<f64> {
    Matrix::filled(MatrixSize::new(columns, rows).expect("1 to 64"), gain)
}

#[test]
fn a_frame_that_cannot_be_processed_is_still_shown() {
    let mut page = set(|request| {
        request.pipeline.processing.gain = Some(gain_of(2, 2, 1.0));
    });
    page.frames(2);
    shows(&page, &["frame 1  0.1 s", "! the gain has 2 columns"]);
    hides(&page, &["no frame yet"]);
    then(
        &mut page,
        "<Enter>",
        &["! no imprint: the gain has 2 columns"],
    );
}

#[test]
fn the_history_can_be_viewed_while_frames_arrive() {
    shows(
        &watched(6, "<Left><Left>"),
        &["frame 3", "frozen, 2 frames behind"],
    );
    shows(
        &watched(6, "<Home>"),
        &["frame 0", "frozen, 5 frames behind"],
    );
    let mut page = watched(4, "<Space>");
    page.frames(2);
    shows(&page, &["frame 3", "frozen, 2 frames behind"]);
    then(&mut page, "<Space>", &["frame 5"]);
    hides(&page, &["frozen"]);
    then(&mut page, "<Left><End>", &["frame 5"]);
    // Esc goes back to the source first. A page that was left shows what it showed, with its marks.
    then(
        &mut page,
        "<Left>m<Esc>",
        &["frame 5", "marked     frame 4"],
    );
    hides(&page, &["frozen"]);
    then(&mut page, "<Esc>", &["Figure"]);
    then(&mut page, "w<Left>", &["frame 4", "marked     frame 4"]);
}

#[test]
fn the_history_is_searched_by_seconds_and_by_touches() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    let value = |frame: u32| if frame % 10 < 5 { 0 } else { 9 };
    let line = |frame| format!("{},{}\n", f64::from(frame) / 4.0, value(frame));
    let frames: String = (0..40).map(line).collect();
    std::fs::write(&path, format!("time,r0c0\n{frames}")).expect("written");
    let mut page = session(&format!(":watch {}<Enter>", path.display()));
    page.frames(40);
    then(&mut page, ":at-least<Space>5<Enter>", &["frame 39"]);
    then(
        &mut page,
        "<PageUp>",
        &["frame 35  8.75 s", "4 frames behind"],
    );
    then(&mut page, "<PageUp><PageDown><PageDown>", &["frame 39"]);
    then(&mut page, "[[[", &["frame 15  3.75 s"]);
    then(&mut page, "]", &["frame 25"]);
    then(&mut page, "[[[", &["! no earlier touch", "frame 5"]);
}

#[test]
fn sum_and_maximum_are_those_before_the_tare_as_taxel_frames_prints_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    std::fs::write(&path, "time,r0c0,r0c1\n0.0,5,6\n0.1,7,9\n").expect("written");
    let mut page = session(&format!(":watch {}<Enter>", path.display()));
    page.frames(1);
    then(&mut page, "t", &["tare of 1 frame"]);
    page.frames(1);
    shows(
        &page,
        &[
            "tared",
            "force      5 on 2 taxels",
            "raw        sum 16, max 9 at 1, 0",
        ],
    );
    then(
        &mut page,
        "vv",
        &["raw", "raw        sum 16, max 9 at 1, 0"],
    );
}

#[test]
fn force_and_contact_are_plotted_over_the_history_and_follow_the_threshold() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    let frames: String = (0..8).map(|own| format!("{own},{}\n", 10 - own)).collect();
    std::fs::write(&path, format!("r0c0,r0c1\n{frames}")).expect("written");
    let mut page = session(&format!(":watch {}<Enter>", path.display()));
    page.frames(8);
    let full = "\n████████";
    shows(
        &page,
        &["force  0 to 10", "force      10 on 2 taxels", full],
    );
    // One value in each frame reaches 5, and both in frame 5.
    then(
        &mut page,
        "f:at-least<Space>5<Enter>",
        &["contact  0 to 2 taxels"],
    );
    shows(&page, &["force      7 on 1 taxel", "\n▄▄▄▄▄█▄▄  "]);
    then(&mut page, "<Left><Left>f", &["frame 5", "force  0 to 10"]);
}

#[test]
fn the_imprint_is_put_on_the_matrix_and_the_source_stays_open() {
    shows(
        &watched(6, "<Enter>"),
        &["! no threshold, so no imprint; + sets one"],
    );
    shows(&watched(0, "<Enter>"), &["! no frame yet"]);
    let mut page = watched(6, "+<Enter>");
    shows(
        &page,
        &[
            "the imprint of frame 5; w goes back",
            "\nimprint of frame 5, touch.csv\n",
        ],
    );
    // The undo history names the frame, not the sensor that came with it.
    then(&mut page, "u", &["undone: imprint of frame 5"]);
    then(&mut page, "<C-r>", &["redone: imprint of frame 5"]);
    then(&mut page, "w", &["frame 5", "threshold  5"]);
    then(&mut page, "<Esc>w", &["frame 5"]);
    shows("w", &["! no source yet: ':watch SOURCE'"]);
}

#[test]
fn an_imprint_of_cells_that_are_not_square_has_no_lengths_in_mm() {
    let samples = "tests/files/frames/samples";
    let mut page = session(&format!(":watch {samples}/xsensor.csv<Enter>"));
    page.frames(1);
    then(&mut page, "+<Enter>", &["cells of 2.5 × 3 mm are not"]);
    hides(&page, &["pitch"]);
    let mut page = session(&format!(":watch {samples}/tekscan.asf<Enter>"));
    page.frames(1);
    then(&mut page, "+<Enter>", &["pitch 2.5 mm"]);
    hides(&page, &["not square"]);
}

#[test]
fn an_imprint_from_a_frame_is_unsaved_work() {
    let mut page = watched(6, "+<Enter>");
    then(&mut page, "q", &["The imprint is not saved. Quit anyway?"]);
    then(&mut page, "<Esc>s", &["frame 5 of touch"]);
    then(&mut page, "<Esc>stouched<Enter>", &["saved as touched"]);
    then(&mut page, "q", &[]);
    hides(&page, &["not saved"]);
    let mut page = watched(6, "+<Enter>nq");
    shows(&page, &["1 earlier shape is not saved; u goes back."]);
    // Back on the page, nothing has been taken yet.
    then(&mut page, "<Esc>uq", &["The imprint is not saved"]);
}

#[test]
fn a_frame_is_marked_and_unmarked() {
    shows(&watched(0, "m"), &["! no frame yet"]);
    let mut page = watched(6, "m");
    shows(&page, &["frame 5: marked", "marked", "marked     frame 5"]);
    then(&mut page, "<Left>m", &["marked     frame 5, 4"]);
    then(
        &mut page,
        "m",
        &["frame 4: mark removed", "marked     frame 5"],
    );
    then(&mut page, "<End>", &["frame 5", "marked"]);
}

/// Opens the page, and records three frames in a folder after the first two.
fn recording_in(folder: &Path) -> Session {
    let world = world().confined_to(folder.to_owned());
    let mut page = started(world, ":watch tests/scripts/touch.csv<Enter>");
    page.frames(2);
    then(&mut page, "r", &["recording in touch-1.npy"]);
    page.frames(3);
    page
}

#[test]
fn a_script_records_each_frame_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut page = recording_in(folder.path());
    shows(&page, &["frame 4", "recording  touch-1.npy, 3 frames"]);
    page.frames(1);
    shows(&page, &["frame 5", "recording  touch-1.npy, 4 frames"]);
    then(&mut page, "m", &["frame 5: marked"]);
    for _ in 0..2 {
        page.frames(20);
        shows(
            &page,
            &[
                "  recording  source ended",
                "recording  touch-1.npy, 6 frames",
            ],
        );
    }
    then(&mut page, "r", &["touch-1.npy: 6 frames recorded"]);
    let recording = std::fs::read(folder.path().join("touch-1.npy")).expect("written");
    assert_eq!(array::records(&recording), Some(6));
    assert_eq!(
        recording[256 + 8..256 + 16],
        2_u64.to_le_bytes(),
        "the third frame"
    );
    let beside = std::fs::read_to_string(folder.path().join("touch-1.json"));
    let beside: serde_json::Value = serde_json::from_str(&beside.expect("written")).expect("JSON");
    assert_eq!(beside["marks"][0]["number"], 5, "{beside}");
}

#[test]
fn the_marks_of_a_recording_are_shown_when_it_is_played() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut page = recording_in(folder.path());
    then(&mut page, "mr", &["touch-1.npy: 3 frames recorded"]);
    let again = format!(":watch {}/touch-1.npy<Enter>", folder.path().display());
    then(&mut page, &format!("<Esc>{again}"), &[]);
    page.frames(1);
    shows(&page, &["frame 0 (label 2)", "marked     label 4"]);
    page.frames(2);
    shows(&page, &["frame 2 (label 4)", "  marked\n"]);
}

#[test]
fn a_recording_stores_the_threshold_and_tare_at_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut page = recording_in(folder.path());
    let beside = || {
        let text = std::fs::read_to_string(folder.path().join("touch-1.json"));
        let beside: serde_json::Value =
            serde_json::from_str(&text.expect("written")).expect("JSON");
        (beside["rule"].clone(), beside["tare_frames"].clone())
    };
    assert!(beside().0.is_null() && beside().1.is_null());
    then(&mut page, "+", &["threshold  50"]);
    assert_eq!(beside().0["at_least"], 50);
    then(&mut page, "+t", &["threshold  51", "tare       5 frames"]);
    assert_eq!(
        (&beside().0["at_least"], &beside().1),
        (&51.into(), &5.into())
    );
    then(&mut page, "Tr", &["touch-1.npy: 3 frames recorded"]);
    assert!(beside().1.is_null());
}

/// The error of a source names flags that can be appended to the command.
#[test]
fn watch_accepts_the_flags_of_the_command_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("two by three.csv");
    std::fs::write(&file, "1,2,3,4,5,9\n1,2,3,4,5,8\n1,2,3,4,5,7\n").expect("written");
    let line =
        |flags: &str| format!(":watch {}{flags}<Enter>", file.display()).replace(' ', "<Space>");
    let mut page = session(&line(""));
    page.frames(1);
    shows(&page, &["rows and columns", ":size COLUMNSxROWS"]);
    then(
        &mut page,
        ":size<Space>3x<Enter>",
        &["! invalid value '3x'"],
    );
    then(&mut page, "<Esc>:size<Space>3x2<Enter>", &["no frame yet"]);
    page.frames(3);
    shows(&page, &["frame 2", "size       3 × 2"]);
    then(&mut page, "<Esc>", &[]);
    then(&mut page, &line(" --rows 2 --columns 3 --at-least 4"), &[]);
    page.frames(3);
    shows(
        &page,
        &[
            "two by three.csv",
            "frame 2",
            "threshold  4",
            "max 7 at 2, 1",
        ],
    );
}

#[test]
fn a_saved_shape_is_named_at_once() {
    let mut page = watched(6, "o+++++++");
    shows(&page, &["shape      none of these: ", "model      library"]);
    then(
        &mut page,
        "<Space><Enter>:save ring<Enter>",
        &["saved as ring"],
    );
    then(&mut page, "ww", &["model      library"]);
    page.frames(6);
    shows(&page, &["shape      ring  ", "fits exactly"]);
}

#[test]
fn a_reopened_page_uses_the_model_that_it_shows() {
    let mut page = watched(6, "o+++++++");
    shows(&page, &["shape      none of these: ", "model      library"]);
    then(&mut page, "<Esc>ww", &["model      library"]);
    page.frames(5);
    shows(&page, &["frame 4", "shape      ", "taxels differ"]);
    hides(&page, &["…", "training or"]);
    // The page does not name shapes with a model that was given up, either.
    then(&mut page, "oooo<Esc>ww", &[]);
    page.frames(6);
    hides(&page, &["differ"]);
}

#[test]
fn values_far_below_1_have_shades_and_fine_steps() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.csv");
    std::fs::write(&path, "time,r0c0,r0c1\n0.0,0.001,0.004\n").expect("written");
    let mut page = session(&format!(":watch {}<Enter>", path.display()));
    page.frames(1);
    shows(&page, &["frame 0", "0.005"]);
    then(&mut page, "++", &["threshold  0.00255"]);
    // The smallest number with four decimals is still far too large for these values.
    std::fs::write(&path, "time,r0c0,r0c1\n0.0,0.000001,0.0000042\n").expect("written");
    let mut page = session(&format!(":watch {}<Enter>", path.display()));
    page.frames(1);
    shows(&page, &["5e-6", "max 0.0000042", "force  0 to 0.00001"]);
    then(&mut page, "+", &["threshold  2.5e-6"]);
}

#[test]
fn a_sensor_larger_than_the_screen_is_seen_in_parts() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tall.npy");
    // The contact is in the middle, and each row has its own value.
    let value = |row: u16| if row == 30 { 900 } else { row };
    let values = (0..60 * 21).map(|cell| f64::from(value(cell / 21)));
    let values: Vec<f64> = values.collect();
    std::fs::write(&path, array("(1, 60, 21)", false, &values)).expect("written");
    let mut page = sized(
        (80, 24),
        false,
        &format!(":watch {}<Enter>", path.display()),
    );
    page.frames(1);
    let rows = |page: &Session| {
        let screen = page.screen();
        let title = screen.lines().nth(1).expect("a title").to_owned();
        title.split("rows ").nth(1).map(str::to_owned)
    };
    let all = ["20-59", "0-39"].map(|rows| Some(rows.to_owned()));
    let no_more = "no more taxels in this direction";
    then(&mut page, "<S-Down><S-Down>", &[no_more]);
    assert_eq!(rows(&page), all[0]);
    shows(&page, &["Shift-arrows other taxels"]);
    then(&mut page, "c<S-Up>", &[]);
    assert_eq!(rows(&page), all[1]);
    then(&mut page, "<S-Right>", &[no_more]);
    then(&mut page, "#", &["rows 5-23"]);
    then(&mut page, "<S-Down>", &["rows 14-32"]);
    then(&mut page, "c", &["the view follows the contact", "\n30 "]);
    // If all taxels are visible, there are no others to scroll to.
    hides(&watched(1, ""), &["other taxels"]);
}

#[test]
fn the_range_and_the_first_threshold_depend_on_the_values_shown() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("offset.npy");
    // One cell is stuck; another rests at 1000 and is touched in the last frames.
    let frames = [1000.0, 1000.0, 1000.0, 1040.0, 1040.0, 1040.0];
    let values: Vec<f64> = frames.iter().flat_map(|&value| [4095.0, value]).collect();
    std::fs::write(&path, array("(6, 1, 2)", false, &values)).expect("written");
    let opened = |change: &dyn Fn(&mut WatchRequest)| {
        let mut request = WatchRequest::new(path.to_str().expect("UTF-8"));
        change(&mut request);
        let mut page = session("");
        page.send(Message::Live(LiveMessage::Watch(Arc::new(request))));
        page.frames(3);
        page
    };
    let mut page = opened(&|_| {});
    shows(&page, &["range      0 ░▒▓█ 5000"]);
    then(&mut page, "t", &["range      0 ░▒▓█ 1"]);
    page.frames(3);
    shows(&page, &["range      0 ░▒▓█ 50"]);
    then(&mut page, "+", &["threshold  25\n", "NA         1"]);
    then(&mut page, "vv", &["range      0 ░▒▓█ 5000"]);
    then(&mut page, "vT", &["range      0 ░▒▓█ 5000"]);
    // A masked cell is ignored, whatever it sends.
    let mask: Imprint = "#.".parse().expect("an imprint");
    let mut page = opened(&|request| request.pipeline.processing.view.mask = Some(mask));
    shows(&page, &["range      0 ░▒▓█ 1000"]);
    page.frames(3);
    shows(&page, &["range      0 ░▒▓█ 2000"]);
    let mut page = opened(&|request| {
        request.pipeline.processing.gain = Some(gain_of(2, 1, 0.01));
    });
    shows(&page, &["range      0 ░▒▓█ 50\n"]);
    then(&mut page, "+", &["threshold  25\n"]);
}
