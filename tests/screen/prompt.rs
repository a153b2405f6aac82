//! The command line at the foot of the screen, and help everywhere.

use taxel::tui::keys::Context;
use taxel::tui::prompt::commands::{complete, offers};

use crate::session::{hides, press, session, shows, then};

#[test]
fn lines_are_completed_as_far_as_all_candidates_agree() {
    let names = ["washer", "Wasp", "my shape"].map(str::to_owned);
    for (line, expected, candidates) in [
        ("fi", "figure ", 1),
        ("res", "restore ", 1),
        ("figure h", "figure he", 2),
        ("figure hexagon --s", "figure hexagon --side ", 1),
        ("figure hexagon --side ", "figure hexagon --side ", 0),
        (
            "figure hexagon --side=3 --s",
            "figure hexagon --side=3 --s",
            0,
        ),
        (
            "figure hexagon --side 3 --an",
            "figure hexagon --side 3 --angle ",
            1,
        ),
        ("sensor --p", "sensor --pitch ", 1),
        ("explore --an", "explore --an", 2),
        ("load w", "load w", 2),
        ("load WASP", "load Wasp", 1),
        ("load my s", "load my shape", 1),
        ("watch a b.csv --ba", "watch a b.csv --baud ", 1),
        ("watch a --baud 9600 --ba", "watch a --baud 9600 --ba", 0),
        ("nothing x", "nothing x", 0),
    ] {
        let (now, found) = complete(line, &names, Context::Matrix);
        assert_eq!(
            (now.as_str(), found.len()),
            (expected, candidates),
            "{line}"
        );
    }
}

/// A command is offered where it means something, with a help of its own that fits on a line of 80 columns.
#[test]
fn commands_of_the_page_are_offered() {
    let listed = |page| {
        let offers = offers("", &[], page);
        let widest = offers
            .iter()
            .map(|offer| offer.line.len())
            .max()
            .expect("commands");
        for offer in &offers {
            let help = offer.help.as_deref().expect("a help");
            assert!(
                !help.is_empty() && help.chars().count() <= 80 - 4 - widest,
                "{offer:?}"
            );
        }
        offers
            .into_iter()
            .map(|offer| offer.line)
            .collect::<Vec<_>>()
    };
    let (matrix, live) = (listed(Context::Matrix), listed(Context::Live));
    let is_on = |page: &[String], name: &str| page.iter().any(|own| own == name);
    for name in ["figure", "cursor", "write", "watch", "quit!"] {
        assert!(is_on(&matrix, name), "{name}");
    }
    for name in ["at-least", "size", "watch", "quit"] {
        assert!(is_on(&live, name), "{name}");
    }
    assert!(!is_on(&matrix, "at-least") && !is_on(&live, "figure"));
}

#[test]
fn commands_change_the_matrix() {
    for (line, shown) in [
        ("cursor 3 12", "column  3, row 12"),
        (
            "cursor 16 0",
            "! column 16, row 0 is not on the sensor (16 × 16)",
        ),
        ("move 0.5 -1.25", "at 4.50, 2.75"),
        ("move 0 -100", "! y0: -96 is below -16"),
        ("turn -20", "340°"),
        ("turn 720.25", "0.25°"),
        ("help", "On the matrix"),
        (
            "figure hexagon --side=3.5 --x0=-1",
            "hexagon side 3.50 at -1.00, 4.00",
        ),
        ("figure", "Kind"),
        ("sensor --columns 8 --pitch 2.5", "column 7,"),
        ("load washer", "washer loaded"),
        ("picture washer", "Picture: washer"),
        (
            "w",
            "! the following required arguments were not provided: <FILE>...",
        ),
    ] {
        shows(&session(&format!("f<Enter>:{line}<Enter>")), &[shown]);
    }
}

/// The next keys belong to the prompt, not to the matrix.
#[test]
fn a_refused_prompt_stays_open() {
    for (line, refusal) in [
        ("fly", "! unrecognized subcommand 'fly'"),
        ("explroe", "a similar subcommand exists: 'explore'"),
        (
            "figure blob",
            "! invalid value 'blob' for '[KIND]' [possible values: ellipse,",
        ),
        (
            "figure hexagon --side",
            "! a value is required for '--side <CELLS>'",
        ),
        (
            "figure hexagon --side 3 --side 4",
            "cannot be used multiple times",
        ),
        ("figure hexagon --side 99", "! --side 99 is above 16"),
        (
            "figure hexagon --length 2",
            "! '--length' does not belong to 'hexagon'",
        ),
        ("sensor --cols 3", "! unexpected argument '--cols' found"),
        ("new now", "! unexpected argument 'now' found"),
        ("cursor far", "! invalid value 'far' for '<COLUMN>'"),
        ("turn round", "! invalid value 'round' for '<DEGREES>'"),
        ("save a/b", "! '/' cannot be in a name"),
        ("load nope", "! no shape named \"nope\""),
        (
            "picture wahser",
            "! no shape named \"wahser\"; did you mean \"washer\"?",
        ),
        (
            "delete arrow",
            "! \"arrow\" comes with taxel and cannot be deleted",
        ),
        ("move 0 -100", "! y0: -96 is below -16"),
        (
            "save arrow",
            "! arrow is the name of a shipped shape; choose another",
        ),
        ("recognise nope", "! "),
        ("open nope.txt", "! nope.txt"),
    ] {
        let mut session = session(&format!("f<Enter>:{line}<Enter>"));
        shows(&session, &[refusal, &format!("\n:{line}")]);
        then(&mut session, " x", &[&format!(":{line} x")]);
        // A prompt that was closed stays closed.
        press(&mut session, "<Esc><Right>");
        hides(&session, &[&format!(":{line}")]);
    }
    let mut saved = session("f<Enter>sarrow<Enter>");
    shows(
        &saved,
        &["! arrow is the name of a shipped", "Save as: arrow"],
    );
    then(&mut saved, " 2<Enter>", &["saved as arrow 2"]);
}

#[test]
fn restore_says_if_there_is_nothing_to_restore() {
    let mut session = session("<Space>:restore<Enter>");
    shows(&session, &["! the trash is empty", "drawn by hand"]);
    press(
        &mut session,
        "<Esc>sone<Enter>:save two<Enter>:delete one<Enter>y:delete two<Enter>y",
    );
    then(&mut session, ":restore <Tab>", &[":restore    two  one"]);
    then(&mut session, "o<Tab><Enter>", &["one is back"]);
    then(
        &mut session,
        ":delete one<Enter>y:restore<Enter>",
        &["one is back"],
    );
    // This shape was deleted before another action, perhaps in an earlier run.
    then(&mut session, "<Space>:restore<Enter>", &["two is back"]);
}

#[test]
fn names_are_completed() {
    let mut session = session("<Space>:save mine<Enter>:load mi<Tab>");
    shows(&session, &[":load mine"]);
    then(&mut session, "<Enter>", &["mine loaded"]);
    // Only the user's own shapes can be deleted.
    then(&mut session, ":delete <Tab>", &[":delete mine"]);
    then(
        &mut session,
        "<C-u>load wash<Tab><Enter>",
        &["washer loaded"],
    );
}

#[test]
fn up_and_down_recall_earlier_lines() {
    let mut session = session(":new<Enter>:seed 1<Enter>:new<Enter>:new<Enter>:res<Up>");
    for (keys, shown) in [
        ("", ":new"),
        ("<Up>", ":seed 1"),
        ("<Up>", ":new"),
        ("<Up>", ":new"),
        ("<Down>", ":seed 1"),
        ("<Down><Down>", ":res"),
        // Below the typed line are the offers.
        ("<Down>", ":restore"),
        ("<Up>", ":res"),
    ] {
        press(&mut session, keys);
        let screen = session.screen();
        let line = screen.lines().find(|line| line.starts_with(':'));
        assert_eq!(line, Some(shown), "{keys}");
    }
}

/// Help shows the keys of the place where it is opened, and returns to it.
#[test]
fn help_is_available_everywhere() {
    for (keys, back, title) in [
        ("f<Tab>2?", "rx 2.00", "In a form"),
        ("l?", "filter:", "In the list of shapes"),
        ("<Space>s<F1>", "Save as:", "Saving"),
        (":<F1>", "Enter run", "In the command line"),
        ("<Space>q?", "y: lose it", "At a question"),
        ("f<Enter>g?", "held, step", "While a shape is held"),
        ("<F1>", "? Help", "On the matrix"),
    ] {
        let mut session = session(keys);
        shows(&session, &[&format!("{title}\n")]);
        press(&mut session, "<Esc>");
        shows(&session, &[back]);
    }
    // In a text field, ? is a character.
    shows(&session("<Space>sa?"), &["'?' cannot be in a name"]);
    shows(&session(":a?"), &[":a?"]);
}

#[test]
fn commands_have_short_forms() {
    let folder = tempfile::tempdir().expect("a folder");
    let world = crate::session::world().confined_to(folder.path().to_owned());
    let mut session = crate::session::started(world, "<Space>:w one.txt<Enter>");
    shows(&session, &["written: ", "one.txt"]);
    press(&mut session, ":q!<Enter>");
    assert!(session.app().ended());
}
