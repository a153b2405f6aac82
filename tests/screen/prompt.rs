//! The command line at the foot of the screen, and help everywhere.

use taxel::tui::keys::action::Action;
use taxel::tui::keys::default_keys::DEFAULT_KEYS;
use taxel::tui::keys::keymap::Context;
use taxel::tui::prompt::commands::{commands, find};

use crate::session::{hides, press, session, shows, then};

/// Users who have no such key, or cannot press it, can use a word.
#[test]
fn every_action_has_a_command_word() {
    let listed = commands();
    let said: Vec<&Action> = listed
        .iter()
        .flat_map(|command| command.words.iter().map(|(_, action)| *action))
        .collect();
    let places = [Context::Matrix, Context::Hold, Context::Everywhere];
    let bound = DEFAULT_KEYS
        .iter()
        .filter(|binding| places.contains(&binding.context))
        .flat_map(|binding| binding.keys.iter());
    // `:` is there already.
    for (key, action) in bound.filter(|(_, action)| action.name != "command") {
        assert!(said.contains(action), "{key}: {action:?}");
        let found = find(action.name).expect("its name is a command");
        assert!(found.words.contains(&("", *action)), "{}", action.name);
    }
}

/// All names differ, and none is the short form of another.
#[test]
fn commands_are_found_by_their_names() {
    for command in commands() {
        let found = find(command.name).expect("it is there");
        assert_eq!(format!("{found:?}"), format!("{command:?}"));
    }
}

#[test]
fn the_cursor_and_the_shape_are_moved_by_commands() {
    for (line, shown) in [
        ("cursor left", "column  7, row  8"),
        ("cursor start", "column  0, row  8"),
        ("cursor bottom", "column  8, row 15"),
        ("cursor 3 12", "column  3, row 12"),
        (
            "cursor 16 0",
            "! column 16 is not on the sensor (allowed: 0 to 15)",
        ),
        (
            "cursor -1 0",
            "! column -1 is not on the sensor (allowed: 0 to 15)",
        ),
        (
            "cursor 12345678901234567890 0",
            "! column 12345678901234567890 is not on the sensor (allowed: 0 to 15)",
        ),
        (
            "cursor 0 16",
            "! row 16 is not on the sensor (allowed: 0 to 15)",
        ),
        (
            "cursor far",
            "! cursor takes left, right, up, down, start, end, top, bottom or COLUMN ROW",
        ),
        ("nudge right", "at 4.01, 4.00"),
        ("move 0.5 -1.25", "at 4.50, 2.75"),
        ("move 0 -100", "! y0: -96 is below -16"),
        (
            "move 1",
            "! move takes DX DY in cells (like 0.5 -1), found \"1\"",
        ),
        ("move far away", "(like 0.5 -1), found \"far away\""),
        ("move", "! move takes DX DY in cells (like 0.5 -1)"),
        ("turn", "! turn takes DEGREES (like 30.5)"),
        ("step larger", "step 0.1"),
        ("region previous", "there is no other region"),
        ("help", "On the matrix"),
        ("sensor --rows 8 --rows 9", "! --rows is given twice"),
        (
            "figure hexagon --side 3 --angle 5 --side 4",
            "! --side is given twice",
        ),
        ("figure hexagon ----side 3", "! ----side is unknown"),
    ] {
        let session = session(&format!("f<Enter>:{line}<Enter>"));
        shows(&session, &[shown]);
    }
    let session = session("f<Enter>:step larger<Enter>:nudge up<Enter>:hold<Enter>");
    shows(&session, &["at 4.00, 3.90", "held, step 0.1"]);
}

#[test]
fn restore_says_if_there_is_nothing_to_restore() {
    let mut session = session("<Space>:restore<Enter>");
    // An earlier version undid the toggle instead.
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
fn names_and_flags_are_completed() {
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
    then(
        &mut session,
        ":figure rect<Tab>--l<Tab>2 --w<Tab>3<Enter>",
        &["rectangle length 2.00 width 3.00"],
    );
}

#[test]
fn up_and_down_recall_earlier_lines() {
    let mut session = session(":new<Enter>:hold<Enter>:new<Enter>:new<Enter>:z<Up>");
    for (keys, shown) in [
        ("", ":new"),
        ("<Up>", ":hold"),
        ("<Up>", ":new"),
        ("<Up>", ":new"),
        ("<Down>", ":hold"),
        ("<Down><Down>", ":z"),
        // Below the typed line are the offers.
        ("<Down>", ":zoom"),
        ("<Up>", ":z"),
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
        ("?/<F1>", "a word of what it does", "Searching"),
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
fn commands_do_what_keys_do() {
    let mut session = session(":");
    shows(&session, &["Enter run"]);
    then(
        &mut session,
        "figure hexagon --side 3 --x0 2.1 --angle 17 --thickness 1<Enter>",
        &["hexagon side 3.00 at 2.10, 4.00, 17°, wall 1.00"],
    );
    then(
        &mut session,
        ":figure hexagon --side=3.5 --x0=-1<Enter>",
        &["hexagon side 3.50 at -1.00, 4.00"],
    );
    then(&mut session, ":undo<Enter>", &["hexagon side 3.00"]);
    then(
        &mut session,
        ":turn -20<Enter>:undo<Enter>:save mine<Enter>:new<Enter>:load mine<Enter>",
        &["mine loaded", "hexagon side 3.00"],
    );
    then(&mut session, ":picture mine<Enter>", &["Picture: mine"]);
    then(
        &mut session,
        "<Esc>:delete mine<Enter>",
        &["Delete \"mine\"? (y/n)"],
    );
    then(&mut session, "y:restore mine<Enter>", &["mine is back"]);
    then(
        &mut session,
        ":sensor --columns 8 --pitch 2.5<Enter>:undo<Enter>:redo<Enter>",
        &["column 7,"],
    );
    then(
        &mut session,
        ":copy descriptors<Enter>",
        &["descriptors sent to your terminal's clipboard ("],
    );
    for (line, message) in [
        ("fly", "! no command named \"fly\"; Tab shows all"),
        (
            "explroe",
            "! no command named \"explroe\"; Tab shows all; did you mean \"explore\"?",
        ),
        (
            "figure blob",
            "! figure \"blob\" is unknown, expected one of ellipse,",
        ),
        (
            "figure \"hexagon\"",
            "! leave out the quotes: figure hexagon",
        ),
        ("figure hexagon --side", "! --side needs a value"),
        ("figure hexagon --side=", "! --side needs a value"),
        (
            "figure hexagon --side=3 --side 4",
            "! --side is given twice",
        ),
        ("explore --x0=5 --x0=6", "! --x0 is given twice"),
        (
            "figure hexagon --side 99",
            "! Side: 99 is above 16 (allowed: above 0, up to 16)",
        ),
        (
            "figure hexagon --length 2",
            "! --length: the hexagon has none",
        ),
        (
            "figure hexagon side 2",
            "! expected a flag like --side, found side",
        ),
        ("undo now", "! undo takes nothing, found \"now\""),
        (
            "cursor left 5",
            "! cursor takes a column and a row like 3 4, or a direction alone, found \"left\"",
        ),
        (
            "turn round",
            "! turn takes degrees like 30.5, found \"round\"",
        ),
        ("zoom", "! zoom takes in or out"),
        ("save a/b", "! '/' cannot be in a name"),
        ("load nowhere", "! no shape named \"nowhere\""),
    ] {
        then(&mut session, &format!(":{line}<Enter>"), &[message]);
        press(&mut session, "<Esc>");
    }
    press(&mut session, ":quit!<Enter>");
    assert!(session.app().ended());
}

#[test]
fn the_shape_is_turned_and_zoomed_by_commands() {
    let mut session = session("f<Enter>:turn -20<Enter>");
    shows(&session, &["340°"]);
    then(&mut session, ":turn 50.5<Enter>", &["30.5°"]);
    then(&mut session, ":turn 720.25<Enter>", &["30.75°"]);
    then(
        &mut session,
        ":turn far<Enter>",
        &["! turn takes degrees like 30.5, found \"far\"", ":turn far"],
    );
    press(&mut session, "<Esc>");
    then(
        &mut session,
        ":picture washer<Enter><Enter>:zoom in<Enter>:zoom in<Enter>:zoom out<Enter>",
        &["zoom 1.01 × 1.01"],
    );
}

/// The next keys belong to the prompt, not to the matrix.
#[test]
fn a_refused_prompt_stays_open() {
    for (line, refusal) in [
        ("load nope", "! no shape named \"nope\""),
        ("picture nope", "! no shape named \"nope\""),
        (
            "picture wahser",
            "! no shape named \"wahser\"; did you mean \"washer\"?",
        ),
        ("delete nope", "! no shape named \"nope\""),
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
        &[
            "! arrow is the name of a shipped shape; choose another",
            "Save as: arrow",
        ],
    );
    then(&mut saved, " 2<Enter>", &["saved as arrow 2"]);
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

#[test]
fn an_unknown_flag_is_answered_with_the_flags_of_the_command() {
    shows(
        ":sensor --cols 3<Enter>",
        &["! --cols is unknown, expected one of --columns, --rows, --threshold, --pitch"],
    );
    shows(
        ":figure hexagon --sid 3<Enter>",
        &["expected one of --side, --x0,", "did you mean \"--side\"?"],
    );
}
