//! Exploring with workers beside the program: the display while they run, stopping, files, and any keys at any time.

mod files;

use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use proptest::prelude::*;
use taxel::tui::app::{Message, Mouse, MouseKind};
use taxel::tui::jobs::Jobs;
use taxel::tui::script::Session;

use crate::property::config;
use crate::session::{hides, press, session, shows, started, then, world};

/// A sweep of several hundred seconds on any machine.
const LONG: &str = ":explore --x0 0:9.999:0.001 --y0 0:9.999:0.001<Enter>";
/// A sweep that is done almost at once.
const SHORT: &str = ":explore --x0 5:5.9:0.1 --y0 5:5.9:0.1 --angle 0:50:10<Enter>";

/// The longest wait, even on the busiest machine.
const DEADLINE: Duration = Duration::from_secs(60);

/// A program whose workers run beside it, and the events that they report.
pub(crate) struct Beside {
    pub(crate) session: Session,
    told: Receiver<()>,
}

impl Beside {
    fn new(keys: &str) -> Self {
        Self::within(world(), keys)
    }

    pub(crate) fn within(world: Jobs, keys: &str) -> Self {
        let (post, told) = channel();
        let world = world.with_threads(Arc::new(move || {
            // The test may have ended.
            let _ = post.send(());
        }));
        let session = started(world, keys);
        Self { session, told }
    }

    /// Passes on the events of workers until a text is on the screen.
    pub(crate) fn until(&mut self, text: &str) {
        while !self.session.screen().contains(text) {
            let told = self.told.recv_timeout(DEADLINE);
            told.unwrap_or_else(|_| panic!("no {text:?} on\n{}", self.session.screen()));
            self.session.send(Message::Answered);
        }
    }

    /// Begins a long sweep and stops it, until a part of it is complete. On a busy machine, that takes longer than the
    /// first sign of progress.
    fn sweeps_a_part(&mut self, stops: &str, texts: &[&str]) {
        for _ in 0..20 {
            self.press(LONG);
            self.until("poses a second");
            self.then(stops, texts);
            loop {
                let screen = self.session.screen();
                if screen.contains("a part: ") {
                    return;
                }
                if screen.contains("stopped before anything was complete") {
                    break;
                }
                self.told.recv_timeout(DEADLINE).expect("it stops");
                self.session.send(Message::Answered);
            }
            self.press("<Esc>");
        }
        panic!("no part is complete:\n{}", self.session.screen());
    }

    fn press(&mut self, keys: &str) {
        press(&mut self.session, keys);
    }

    /// Presses keys, then checks that every text is on the screen.
    fn then(&mut self, keys: &str, texts: &[&str]) {
        then(&mut self.session, keys, texts);
    }
}

#[test]
fn a_picture_is_explored_at_its_zoom() {
    let placed = ":picture button<Enter><3x:Tab>0.5<Tab>0.25<Enter>";
    shows(
        &session(&format!("{placed}e")),
        &["Zoom x  0.5 ", "Zoom y  0.25 "],
    );
    let swept = session(&format!("{placed}:explore --x0 5 --y0 5 --angle 0<Enter>"));
    shows(&swept, &["zoom x 0.50", "zoom y 0.25"]);
}

#[test]
fn a_stopped_sweep_keeps_its_complete_part() {
    let mut program = Beside::new("fr<Enter>");
    program.then(
        LONG,
        &[
            "0 of 36,000,000,000 poses, 0 %",
            "stopping keeps what is complete",
            "Esc stop",
        ],
    );
    program.press("s");
    program.until("stopped");
    program.press("<Esc>");
    // Meanwhile nothing on the matrix changes, and nothing else can be started.
    program.sweeps_a_part("n<Space>e<Enter>s", &["stopping", "rectangle length 6.00"]);
    shows(
        &program.session,
        &["a part: ", " of 36,000,000,000 poses", "stopped after "],
    );
    program.then("4<lt><End><PageDown>", &["not swept"]);
    program.then("g", &["this pose was not swept"]);
}

#[test]
fn escape_stops_a_sweep_and_quitting_does_not_wait_for_it() {
    let mut program = Beside::new("fr<Enter>");
    program.sweeps_a_part("<Esc>", &["stopping; Ctrl-C quits at once"]);
    // Another sweep from there; the program ends while it runs.
    program.press("e<C-u>0:9.999:0.001<Enter>");
    program.until("poses a second");
    program.press("<C-c>");
    assert!(!program.session.app().ended());
    program.press("<C-c>");
    assert!(program.session.app().ended());
}

#[test]
fn results_are_kept_when_the_page_is_left() {
    let mut program = Beside::new("fp<Enter>");
    program.press(SHORT);
    program.until("pentagon: 600 poses");
    program.then("3ddq", &["pentagon side 4.00"]);
    // When moved, it is the same shape; when enlarged, it is not.
    program.then(
        "<S-Right>e",
        &["pentagon: 600 poses", "CE (ce): outline taxels"],
    );
    program.then("qf<Tab>5<Enter>e", &["Explore: pentagon"]);
    program.then("<Esc>ue", &["pentagon: 600 poses"]);
    // On another sensor, the results no longer apply.
    program.then("qS20<Enter>e", &["Explore: pentagon"]);
}

#[test]
fn the_imprint_of_a_row_is_the_one_on_the_matrix() {
    for start in [
        "fr<Enter>",
        "fe<Tab>3<Tab>2<Enter>",
        "<Space><Right><Space><Down><Space>",
    ] {
        for anchor in ["corner", "centre"] {
            let mut session = session(start);
            let command = format!(
                ":explore --x0 5:5.9:0.1 --y0 5:5.9:0.1 --angle 0:50:10 --anchor {anchor}<Enter>"
            );
            press(&mut session, &command);
            shows(&session, &["600 poses"]);
            for row in 0..12 {
                press(&mut session, &format!("<Home><{row}x:Down><Enter>"));
                let at = session.app().reading().imprint;
                shows(&session, &["on the matrix; u takes it back"]);
                press(&mut session, "e<Enter>");
                assert_eq!(
                    session.app().reading().imprint,
                    at,
                    "{start} {anchor}, row {row}"
                );
                press(&mut session, "e");
            }
        }
    }
}

/// A key is shown among the hints if it can do something; otherwise it says why it cannot.
#[test]
fn keys_of_explore_that_can_do_nothing_say_so() {
    let swept = format!("fr<Enter>{SHORT}");
    shows(&session(&format!("{swept}4z")), &["! a figure has no zoom"]);
    let one = "lkey<Enter>p<Enter>:explore --x0 5:5.9:0.1 --y0 5 --angle 0<Enter>4";
    hides(&session(one), &["angle  Enter", "zoom  "]);
    shows(
        &session(&format!("{one}z")),
        &["! only one zoom was swept; e explores other ranges"],
    );
    shows(
        &session(&format!("{one}>")),
        &["! only one angle was swept; e explores other ranges"],
    );
    shows(&session(&format!("{one}+")), &["every pose has its letter"]);
    shows(&session(&format!("{one}-")), &["this is the whole range"]);
    shows(
        &session(&format!("{one}d")),
        &["! the map shows no descriptor"],
    );
}

fn any_keys() -> impl Strategy<Value = Vec<&'static str>> {
    let keys = "e|e<Enter>|<Enter>|<Esc>|1|2|3|4|+|-|s|<Tab>|\
        <S-Tab>|d|D|n|f|g|<Up>|<Down>|<Left>|<Right>|<Home>|<End>|<PageUp>|<PageDown>|<lt>|>|z|?|s|q|\
        y|x<C-u>|a.txt|<BS>|<C-u>|5:6:0.5|0:350:10|-3|fr<Enter>|fe<Tab>3<Enter>|<Space>|u|U|S8<Enter>|\
        <Space><Right><Space>|:explore --x0 -9:9:0.7 --y0 -9:15:1.1 --anchor centre<Enter>|\
        :explore --zoom-x 1:3:0.5<Enter>|";
    let keys = keys.split_terminator('|').chain([SHORT]);
    let key = prop::sample::select(keys.collect::<Vec<_>>());
    prop::collection::vec(key, 0..60)
}

proptest! {
    #![proptest_config(config(150))]

    /// For any keys, on any size, with events of workers at any time: nothing panics, nothing impossible is on the
    /// screen, and every key is answered.
    #[test]
    fn any_keys_at_any_time_are_answered(
        keys in any_keys(),
        sizes in prop::collection::vec((1_u16..=120, 1_u16..=50), 60),
        clicks in prop::collection::vec((0_u16..120, 0_u16..50), 60),
    ) {
        // These keys may also export something: not into the folder of the sources.
        let folder = tempfile::tempdir().expect("there is a folder for temporary files");
        let world = world().confined_to(folder.path().to_owned());
        let mut program = Beside::within(world, "fr<Enter>");
        program.press(SHORT);
        program.until("rectangle: 600 poses");
        for ((key, (width, height)), (column, row)) in keys.into_iter().zip(sizes).zip(clicks) {
            if program.session.app().ended() {
                break;
            }
            program.press(key);
            // Some of the events, at some time.
            if width % 3 != 0 {
                while let Ok(()) = program.told.try_recv() {
                    program.session.send(Message::Answered);
                }
            }
            if height % 2 == 0 {
                program.session.resize(width, height);
            }
            let kind = [MouseKind::Press, MouseKind::ScrollUp, MouseKind::ScrollDown][usize::from(width % 3)];
            if !program.session.app().ended() && height % 5 == 0 {
                program.session.send(Message::Mouse(Mouse { kind, column, row }));
            }
            let screen = program.session.screen();
            prop_assert!(!screen.contains("NaN") && !screen.contains("inf "), "{key}\n{screen}");
        }
    }
}
