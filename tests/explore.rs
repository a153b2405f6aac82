//! Exploring with workers beside the program: what is shown while they run, stopping, files, and any keys at any time.

use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use proptest::prelude::*;
use taxel::library::store::Library;
use taxel::tui::app::Options;
use taxel::tui::effect::World;
use taxel::tui::exploring::Told;
use taxel::tui::message::Message;
use taxel::tui::script::Session;

#[path = "common/screen.rs"]
mod screen;
use screen::{press, session, shows};

/// Hundreds of seconds of work, on any machine.
const LONG: &str = ":explore --x0 0:9.999:0.001 --y0 0:9.999:0.001<Enter>";
/// Next to none.
const SHORT: &str = ":explore --x0 5:5.9:0.1 --y0 5:5.9:0.1 --angle 0:50:10<Enter>";

/// Nothing takes so long, on the busiest machine.
const DEADLINE: Duration = Duration::from_secs(60);

/// A program whose workers run beside it, and what they tell.
struct Beside {
    session: Session,
    told: Receiver<Told>,
}

impl Beside {
    fn new(keys: &str) -> Self {
        let world = World::scratch().expect("there is a folder for temporary files");
        Self::within(world, keys)
    }

    fn within(world: World, keys: &str) -> Self {
        let (post, told) = channel();
        let world = world.with_workers(Arc::new(move |told| {
            // The test may be over.
            let _ = post.send(told);
        }));
        let options = Options::plain(false);
        let mut session = Session::new(&options, world, 80, 24);
        press(&mut session, keys);
        Self { session, told }
    }

    /// Passes on what workers tell until something is on the screen.
    fn until(&mut self, text: &str) {
        while !self.session.screen().contains(text) {
            let told = self.told.recv_timeout(DEADLINE);
            let told = told.unwrap_or_else(|_| panic!("no {text:?} on\n{}", self.session.screen()));
            self.session.send(Message::Told(told));
        }
    }

    fn press(&mut self, keys: &str) {
        press(&mut self.session, keys);
    }
}

#[test]
fn work_is_shown_and_stopped_and_what_is_complete_is_kept() {
    let mut program = Beside::new("fr<Enter>");
    program.press(LONG);
    shows(
        &program.session,
        &[
            "0 of 36,000,000,000 poses, 0 %",
            "stop keeps what is complete",
            "Esc stop",
        ],
    );
    program.until("poses a second, about");
    // Nothing on the matrix changes meanwhile, and nothing else is begun.
    program.press("n<Space>e<Enter>");
    shows(
        &program.session,
        &["of 36,000,000,000 poses", "rectangle length 6.00"],
    );
    program.session.resize(30, 8);
    program.session.resize(80, 24);
    program.press("s");
    shows(&program.session, &["stopping"]);
    program.until("distinct imprints");
    shows(
        &program.session,
        &["a part: ", " of 36,000,000,000 poses", "stopped: a part"],
    );
    program.press("xposes.npy<Enter>");
    shows(&program.session, &[".npy needs all poses: only "]);
    program.press("<Esc>4))");
    shows(&program.session, &["not gone through"]);
    program.press("g");
    shows(&program.session, &["this pose was not gone through"]);
}

#[test]
fn escape_stops_too_and_the_end_does_not_wait() {
    let mut program = Beside::new("fr<Enter>");
    program.press(LONG);
    program.until("poses a second");
    program.press("<Esc>");
    program.until("a part: ");
    // Other ranges from there; the program ends while they are gone through.
    program.press("e<C-u>");
    program.press("0:9.999:0.001<Enter>");
    program.until("poses a second");
    program.press("<C-c>");
    assert!(program.session.app().ended());
}

/// Ctrl-C asks nothing; the work on the matrix is offered by the next program.
#[test]
fn ctrl_c_while_a_sweep_runs_keeps_unsaved_work() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let world = || World::new(Library::open(folder.path().to_owned()));
    let mut program = Beside::within(world(), "fr<Enter>");
    program.press(LONG);
    program.until("poses a second");
    program.press("<C-c>");
    assert!(program.session.app().ended());
    drop(program);
    let next = Beside::within(world(), "");
    shows(&next.session, &["Unsaved work of 18 taxels"]);
}

#[test]
fn the_time_is_told_while_ranges_are_typed() {
    let mut program = Beside::new("fh<Enter>e");
    shows(&program.session, &["3,600,000 poses"]);
    program.until("3,600,000 poses, ");
    program.press("0:9.99:0.001<Tab>0:9.99:0.001<Tab>0:359.9:0.1");
    shows(&program.session, &["359,352,291,600 poses"]);
    program.until("359,352,291,600 poses, about ");
    // What was measured before is not taken for another grid's.
    program.press("<BS>5");
    assert!(
        !program.session.screen().contains("about"),
        "{}",
        program.session.screen()
    );
}

#[test]
fn results_wait_where_they_were() {
    let mut program = Beside::new("fp<Enter>");
    program.press(SHORT);
    program.until("pentagon: 600 poses");
    program.press("3ddq");
    shows(&program.session, &["pentagon side 4.00"]);
    // Moved it is the same shape, larger it is not.
    program.press("<S-Right>e");
    shows(
        &program.session,
        &["pentagon: 600 poses", "ce: outline taxels"],
    );
    program.press("qf<Tab>5<Enter>e");
    shows(&program.session, &["Explore: pentagon"]);
    program.press("<Esc>ue");
    shows(&program.session, &["pentagon: 600 poses"]);
    // Another sensor is another matter.
    program.press("qS20<Enter>e");
    shows(&program.session, &["Explore: pentagon"]);
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
                let at = session.app().seen().imprint;
                shows(&session, &["on the matrix; u takes it back"]);
                press(&mut session, "ej");
                assert!(
                    !session.screen().contains("none of these"),
                    "{}",
                    session.screen()
                );
                press(&mut session, "<Enter>");
                assert_eq!(
                    session.app().seen().imprint,
                    at,
                    "{start} {anchor}, row {row}"
                );
                press(&mut session, "e");
            }
        }
    }
}

fn type_in(session: &mut Session, text: &str) {
    session.send(Message::Paste(text.to_owned()));
}

fn export(session: &mut Session, path: &Path) {
    press(session, "x");
    type_in(session, path.to_str().expect("a name"));
    press(session, "<Enter>");
}

/// The same bytes as the command line writes, each of them whole.
#[test]
fn files_are_those_of_the_command_line() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut session = session("fp<Enter>");
    press(&mut session, SHORT);
    for name in ["a.csv", "a.jsonl", "a.npz", "a.npy"] {
        let (own, other) = (
            folder.path().join(name),
            folder.path().join(format!("cli-{name}")),
        );
        export(&mut session, &own);
        shows(&session, &["written: "]);
        let flag = if name == "a.npy" {
            "--poses"
        } else {
            "--atlas"
        };
        let status = Command::new(env!("CARGO_BIN_EXE_taxel"))
            .args("sweep pentagon --x0 5:5.9:0.1 --y0 5:5.9:0.1 --angle 0:50:10 --quiet".split(' '))
            .arg(flag)
            .arg(&other)
            .output()
            .expect("it runs");
        assert!(status.status.success(), "{status:?}");
        let read = |path: &Path| std::fs::read(path).expect("it is there");
        if name == "a.npz" {
            // The header holds where the shape was.
            assert_eq!(read(&own).len(), read(&other).len());
        } else {
            assert!(read(&own) == read(&other), "{name}");
        }
    }
}

#[test]
fn a_file_that_is_there_is_asked_about() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let path = folder.path().join("mine.csv");
    std::fs::write(&path, "mine").expect("written");
    let mut program = Beside::new("fp<Enter>");
    program.press(SHORT);
    program.until("pentagon: 600 poses");
    export(&mut program.session, &path);
    program.until("is there already. Replace it?");
    program.press("n");
    assert_eq!(std::fs::read(&path).ok().as_deref(), Some(&b"mine"[..]));
    export(&mut program.session, &path);
    program.until("is there already. Replace it?");
    program.press("y");
    program.until("written: ");
    let text = std::fs::read_to_string(&path).expect("it is there");
    assert!(text.starts_with("id,count,share"), "{text:.50}");
    let names = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(names, 1, "nothing else is left there");
}

/// What is under way when the program ends is given up, and no part of a file stays.
#[test]
fn no_part_of_a_file_is_left_at_the_end() {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let mut program = Beside::new("fh<Enter>");
    program.press(":explore --x0 5:5.999:0.001 --y0 5:5.999:0.001 --angle 0:59:1<Enter>");
    program.until("60,000,000 poses, ");
    program.until("distinct imprints");
    export(&mut program.session, &folder.path().join("poses.npy"));
    shows(&program.session, &["stop leaves nothing behind"]);
    drop(program);
    let names = std::fs::read_dir(folder.path()).expect("a folder").count();
    assert_eq!(names, 0);
}

fn any_keys() -> impl Strategy<Value = Vec<&'static str>> {
    let key = prop::sample::select(vec![
        "e",
        "e<Enter>",
        "<Enter>",
        "<Esc>",
        "1",
        "2",
        "3",
        "4",
        "<Tab>",
        "<S-Tab>",
        "d",
        "D",
        "n",
        "f",
        "v",
        "c",
        "h",
        "j",
        "g",
        "<Up>",
        "<Down>",
        "<Left>",
        "<Right>",
        "<Home>",
        "<End>",
        "<PageUp>",
        "<PageDown>",
        "<lt>",
        ">",
        "(",
        ")",
        "z",
        "Z",
        "w",
        "W",
        "?",
        "s",
        "q",
        "y",
        "x",
        "a.txt",
        "<BS>",
        "<C-u>",
        "5:6:0.5",
        "0:350:10",
        "-3",
        "fr<Enter>",
        "fe<Tab>3<Enter>",
        "<Space>",
        "u",
        "U",
        "S8<Enter>",
        "<Space><Right><Space>",
        SHORT,
        ":explore --x0 -9:9:0.7 --y0 -9:15:1.1 --anchor centre<Enter>",
        ":explore --zoom-x 1:3:0.5<Enter>",
    ]);
    prop::collection::vec(key, 0..60)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    /// Whatever is pressed, on whatever size, whenever workers tell something: no panic, nothing impossible on the
    /// screen, and every key is answered.
    #[test]
    fn any_keys_at_any_time(
        keys in any_keys(),
        sizes in prop::collection::vec((1_u16..=120, 1_u16..=50), 60),
        clicks in prop::collection::vec((0_u16..120, 0_u16..50), 60),
    ) {
        use taxel::tui::message::{Mouse, MouseKind};
        let mut program = Beside::new("fr<Enter>");
        program.press(SHORT);
        program.until("rectangle: 600 poses");
        for ((key, (width, height)), (column, row)) in keys.into_iter().zip(sizes).zip(clicks) {
            if program.session.app().ended() {
                break;
            }
            program.press(key);
            // Some of what is told, at some time.
            if width % 3 != 0 {
                while let Ok(told) = program.told.try_recv() {
                    program.session.send(Message::Told(told));
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
