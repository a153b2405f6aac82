//! The effects of keys: each test presses keys, then checks the texts on the screen.

use taxel::tui::app::message::Message;
use taxel::tui::keys::keymap::{Context, DEFAULT_KEYS, Keymap, help};

use crate::session::{hides, session, shows, then};

#[test]
fn the_cursor_stays_on_the_matrix() {
    shows("", &["column  8, row  8  inactive"]);
    shows("<Left><Up>", &["column  7, row  7"]);
    shows("<20x:Left><20x:Down>", &["column  0, row 15"]);
    shows("<Home><PageUp>", &["column  0, row  0"]);
    shows("<End><PageDown><Right><Down>", &["column 15, row 15"]);
}

#[test]
fn taxels_are_toggled_and_toggles_are_undone() {
    shows(
        "<Space>",
        &[
            "column  8, row  8    active",
            "drawn by hand",
            "NA 1 in all",
            "Region 1 of 1",
        ],
    );
    shows("<Space><Space>", &["inactive", "empty"]);
    shows("<Space><Right><Space>u", &["NA 1 in all"]);
    shows("<Space><Right><Space>uu", &["NA 0 in all"]);
    shows("<Space><Right><Space>uuu", &["! nothing to undo"]);
    shows("<Space><Right><Space>uu", &["undone: taxel 8, 8 on"]);
    shows("f<Enter><Space>u", &["undone: taxel 8, 8 off"]);
    shows("<Space><Right><Space>uuUU", &["NA 2 in all"]);
    shows("<Space><Right><Space>uu<C-r>", &["NA 1 in all"]);
    shows(
        "<Space>u<Right><Space>U",
        &["nothing to redo", "NA 1 in all"],
    );
}

#[test]
fn a_figure_follows_the_form_and_escape_restores_the_matrix() {
    shows("f<Tab>2", &["ellipse rx 2.00 ry 4.00", "NA 28  NAE 28"]);
    shows("f<Tab>2<Esc>", &["empty", "NA 0 in all"]);
    shows(
        "f<Tab>2<Enter>",
        &["ellipse rx 2.00 ry 4.00", "Region 1 of 1"],
    );
    shows("<Space>f<Tab>2<Esc>", &["drawn by hand", "NA 1 in all"]);
    shows("f<Tab>2<C-g>", &["empty"]);
    shows("f<Tab>2<C-c>", &["empty", "n New"]);
    // A wrong field keeps the last figure on the matrix, and Enter is refused until the field is right.
    shows(
        "f<Tab>2<Tab>x<Enter>",
        &[
            "ellipse rx 2.00 ry 4.00",
            "! Radius y: \"x\" is not a number",
            "! not a number",
        ],
    );
    shows(
        "f<Tab>2<Tab>x<Enter><C-u>3<Enter>",
        &["ellipse rx 2.00 ry 3.00", "Region 1 of 1"],
    );
}

#[test]
fn the_matrix_does_not_show_the_beginning_of_a_wrong_number() {
    shows("f<Tab>1", &["ellipse rx 1.00 ry 4.00"]);
    shows(
        "f<Tab>17",
        &["ellipse rx 4.00 ry 4.00", "! expected above 0"],
    );
    shows(
        "f<Tab>2,5",
        &["ellipse rx 4.00 ry 4.00", "! not a number; write 2.5"],
    );
    shows("f<Tab>2,<BS>.5", &["ellipse rx 2.50 ry 4.00"]);
    // A value that was reached by a step, or before the field was left, is kept.
    shows("f<Tab><PageUp><PageUp>x", &["ellipse rx 4.02 ry 4.00"]);
    shows("f<Tab>2<Tab>3<S-Tab>x", &["ellipse rx 2.00 ry 3.00"]);
    shows(
        "f<Tab>2<S-Tab>r<Tab>x",
        &["rectangle length 6.00 width 3.00"],
    );
}

#[test]
fn the_step_is_shown_if_there_is_something_to_move() {
    hides("<Space>", &["step"]);
    shows("f<Enter>", &["NA 52 in all  step 0.01"]);
    shows("f<Enter>g+", &["NA 52 in all  held, step 0.1"]);
    shows("f<Enter>g++g", &["NA 52 in all  step 1"]);
    // The step is also shown if the shape is not held.
    shows("f<Enter>+", &["NA 52 in all  step 0.1"]);
    shows("f<Enter>++-", &["NA 52 in all  step 0.1"]);
    shows("f<Enter>+<S-Right>", &["at 4.10, 4.00"]);
    shows("f<Enter>-", &["0.01 is the smallest step"]);
    shows("f<Enter>+++", &["1 is the largest step"]);
    shows("+", &["! nothing to move"]);
}

#[test]
fn kinds_are_chosen_by_arrows_and_letters() {
    shows("f<Right>", &["< rectangle >", "Length", "Width"]);
    shows("f<Left>", &["< octagon "]);
    shows("f<7x:Right>", &["< ellipse "]);
    shows("fh", &["< hexagon "]);
    shows("fhh", &["< heptagon "]);
    shows("fhhh", &["< hexagon "]);
    shows("ft<Enter>", &["triangle side 4.00 at 4.00, 4.00"]);
    shows(
        "fz",
        &[
            "< ellipse ",
            "! no kind begins with 'z'; kinds: ellipse, rectangle",
        ],
    );
    // Values remain when the kind changes, and are there again when it changes back.
    shows("f<Tab><Tab><Tab>1.5<4x:S-Tab>", &["< ellipse ", "1.5 "]);
    shows("f<Tab>2<S-Tab>rp<S-Tab>", &["< pentagon "]);
    shows("f<Tab>2<S-Tab>re", &["ellipse rx 2.00"]);
}

#[test]
fn fields_are_edited_and_changed_in_steps() {
    shows("f<Tab><PageUp>", &["rx 4.01"]);
    shows("f<Tab><PageDown><PageDown>", &["rx 3.98"]);
    shows("f<Tab>9.99<PageUp>", &["rx 10.0"]);
    shows("f<Tab>9.99<PageUp><PageUp>", &["rx 10.1"]);
    shows("f<Tab>10.0<PageDown>", &["rx 9.99"]);
    shows("f<Tab>0.01<PageDown>", &["rx 0.01"]);
    shows("f<Tab>16<PageUp>", &["rx 16.0"]);
    shows("f<4x:Tab><Tab><PageDown>", &["359°"]);
    shows("f<4x:Tab><Tab>359<PageUp>", &["at 4.00, 4.00, 0°"]);
    shows("f<6x:Tab><PageUp>", &["wall 1.00"]);
    shows("f<Tab><Left><BS>5", &["rx 4.50"]);
    shows("f<Tab><Home><Del>5", &["rx 5.00"]);
    shows("f<Tab>12.5<BS><BS><BS><BS>3", &["rx 3.00"]);
    shows("fr<Tab><Up>t", &["< triangle "]);
}

/// A form accepts the values that files, flags and commands accept, and a minus is an ordinary character.
#[test]
fn a_form_accepts_the_values_that_a_command_accepts() {
    let typed = |x0: &str, angle: &str| {
        session(&format!("fh<Tab><Tab>{x0}<Tab><Tab>{angle}<Enter>")).screen()
    };
    let commanded = |x0: &str, angle: &str| {
        session(&format!(":figure hexagon --x0 {x0} --angle {angle}<Enter>")).screen()
    };
    for (x0, angle) in [
        ("-2", "0"),
        ("-16", "30.5"),
        ("1.005", "359.999"),
        ("16", "0.25"),
    ] {
        let (typed, commanded) = (typed(x0, angle), commanded(x0, angle));
        let line = |screen: &str| {
            let line = screen.lines().find(|line| line.starts_with("hexagon"));
            line.expect("the shape is on the matrix")
                .trim_end()
                .to_owned()
        };
        assert_eq!(line(&typed), line(&commanded), "{x0} {angle}");
    }
    shows("fh<Tab><Tab>-17", &["! expected -16 to 16"]);
    shows("fh<4x:Tab>-1", &["! expected 0 to below 360"]);
    shows("fh<4x:Tab>360", &["! expected 0 to below 360"]);
    shows("S<Tab><Tab>0.3333", &["0.3333"]);
    // A position beyond the sensor is shown in its field, and steps continue from there.
    shows(
        "fr<Enter><C-u>:move -8 0<Enter>f<3x:Tab>",
        &["-4.00", "-16 to 16", "PageUp/Down step"],
    );
    shows("fr<Enter>:move -8 0<Enter>f<3x:Tab><PageDown>", &["-4.01"]);
}

#[test]
fn pasted_text_only_goes_into_fields() {
    let mut form = session("f<Tab>");
    form.send(Message::Paste(" 2.5\n".to_owned()));
    shows(&form, &["rx 2.50"]);
    // Also on the row of kinds: a name, or a number for the first field.
    let mut form = session("f");
    form.send(Message::Paste("Hexagon\n".to_owned()));
    shows(&form, &["< hexagon   >"]);
    form.send(Message::Paste("nut".to_owned()));
    shows(&form, &["no kind named \"nut\"; kinds: ellipse, rectangle"]);
    form.send(Message::Paste("2.5".to_owned()));
    shows(&form, &["side 2.50"]);
    for page in [
        "",
        "f<Enter>g",
        "?",
        "<Space>H",
        "lkey<Enter><Space>=",
        ":watch tests/scripts/touch.csv<Enter>",
        "f<Enter>:explore --x0 5:5.9:0.1 --y0 5 --angle 0<Enter>",
    ] {
        let mut session = session(page);
        session.send(Message::Paste("qqq f".to_owned()));
        assert!(!session.app().ended());
        shows(&session, &["! pasted text goes into fields only"]);
    }
}

#[test]
fn a_shape_is_moved_and_turned() {
    shows("f<Enter>g", &["held, step 0.01", "let go"]);
    shows("f<Enter>g<Right><Down><Down>", &["at 4.01, 4.02, 0°"]);
    shows("f<Enter>g<Right><Down>uu", &["at 4.00, 4.00, 0°"]);
    shows("f<Enter>g+<Left>", &["at 3.90, 4.00", "step 0.1"]);
    shows("f<Enter>g+++<Left>", &["at 3.00, 4.00", "step 1"]);
    shows("f<Enter>g++--<Left>", &["at 3.99, 4.00"]);
    shows("f<Enter>gg<Left>", &["column  7", "at 4.00, 4.00"]);
    shows("f<Enter>g<Enter><Left>", &["column  7"]);
    shows("f<Enter>g<Esc><Left>", &["column  7"]);
    shows(
        "f<Enter><S-Right><S-Up>",
        &["at 4.01, 3.99", "column  8, row  8"],
    );
    shows("f<Enter>><lt><lt>", &["359°"]);
    shows("f<Enter>))>(", &["11°"]);
    shows(
        "f<Enter>g<500x:Left>",
        &["at -1.00, 4.00", "reaches beyond the sensor"],
    );
    shows("f<Enter>g++<9x:Left>", &["at -5.00, 4.00"]);
    shows(
        "f<Enter>g++<40x:Left>",
        &[
            "at -16.0, 4.00",
            "! x0: -17 is below -16 (allowed: -16 to 16)",
        ],
    );
    shows("g", &["nothing to move"]);
    shows("<Space>>", &["a drawing has no position"]);
    for keys in ["<lt>", "g", "+", "z", "<S-Right>", ":turn 30<Enter>"] {
        let stored = format!("lkey<Enter>{keys}");
        shows(
            &stored,
            &["a drawing has no position; p places a saved one"],
        );
    }
    for key in ["c", "o"] {
        let stored = format!("lkey<Enter>{key}");
        shows(&stored, &["a stored imprint has none; p places it"]);
        shows(&format!("<Space>{key}"), &["a drawing has none; f places"]);
    }
    // A hundred steps of 0.01 are exactly 1.
    shows("f<Enter>g<100x:Right>", &["at 5.00, 4.00"]);
}

#[test]
fn only_taxels_set_by_hand_are_counted_as_dropped() {
    let dropped = "set by hand";
    // A stored imprint, a frame of a sensor, a random touch.
    let frame = ":watch examples/recording.csv --at-least 10<Enter>";
    let mut live = session(frame);
    live.frames(4);
    then(&mut live, "<Enter>f<Enter>", &["\nellipse"]);
    hides(&live, &[dropped]);
    for keys in [
        "lkey<Enter>p<Enter>",
        "lkey<Enter>f<Enter>",
        "lkey<Enter><Space>p<Enter>",
        "<Space>sdot<Enter>p<Enter>",
        "rt<Esc>f<Enter>",
        "lkey<Enter>S12<Tab>12<Enter>",
    ] {
        hides(keys, &[dropped]);
    }
    let one = "1 taxel set by hand was dropped; u restores it";
    for keys in ["lkey<Enter><Space>f<Enter>", "rt<Esc><Space>f<Enter>"] {
        shows(keys, &[one]);
    }
    then(&mut live, "u<Space>f<Enter>", &[one]);
}

#[test]
fn undo_and_redo_select_the_region_that_was_selected_there() {
    let ring = "f<6x:Tab>2<Enter>";
    for keys in ["<Tab>nu", "<Tab>u<C-r>", ":move 1 0<Enter><Tab>u"] {
        shows(&format!("{ring}{keys}"), &["Region 2 of 2: hole"]);
    }
    shows(
        &format!("{ring}<Tab><Tab>:move 1 0<Enter><Tab>u"),
        &["Region 1 of 2: exterior"],
    );
}

#[test]
fn tab_selects_the_next_region() {
    let ring = "f<6x:Tab>2<Enter>";
    shows(ring, &["Region 1 of 2: exterior"]);
    shows(&format!("{ring}<Tab>"), &["Region 2 of 2: hole"]);
    shows(&format!("{ring}<Tab><Tab>"), &["Region 1 of 2: exterior"]);
    shows(&format!("{ring}<S-Tab>"), &["Region 2 of 2: hole"]);
    shows("<Tab>", &["no region: the matrix is empty"]);
    // The largest piece is described first, not the one that comes first.
    shows(
        "<Space><Right><Right><Space><Right><Space>",
        &["Region 2 of 2: exterior"],
    );
}

#[test]
fn quitting_asks_if_work_would_be_lost() {
    assert!(session("q").app().ended());
    assert!(session("<C-c>").app().ended());
    let asked = session("f<Enter>q");
    assert!(
        !asked.app().ended()
            && asked
                .screen()
                .contains("not saved. Quit anyway? (y: lose it, n: stay, s: save first)")
    );
    assert!(session("f<Enter>qy").app().ended());
    assert!(
        !session("f<Enter>q<Enter>").app().ended(),
        "Enter by habit answers nothing"
    );
    for no in ["n", "q", "<Esc>", "<C-c>", "<C-g>"] {
        assert!(!session(&format!("f<Enter>q{no}")).app().ended(), "{no}");
    }
    // A drawing that was left for something else would be lost, too: only undo has it.
    let earlier = "An earlier drawing is not saved; the history (H) has it.";
    for left in ["<Space>nq", "<Space><Right><Space>lwasher<Enter>q"] {
        shows(left, &[earlier, "Quit anyway?"]);
    }
    let rectangle = "An earlier rectangle is not saved; the history (H) has it.";
    shows("fr<Enter>lgear<Enter>q", &[rectangle, "n: stay)"]);
    shows(
        "<Space>n<Space>n<Right><Space>q",
        &["The imprint and 2 earlier shapes are not saved; the history (H) has them."],
    );
    // Both may be unsaved, and saving one does not discard the other.
    let both = "<Space>n<Right><Space>q";
    shows(
        both,
        &[
            "The imprint and 1 earlier shape are not saved; the history (H) has them.",
            "s: save first)",
        ],
    );
    let saved = session(&format!("{both}sa name<Enter>"));
    assert!(!saved.app().ended());
    shows(&saved, &[earlier]);
    assert!(session("<Space>qsa name<Enter>").app().ended());
    // A figure that is too thin to leave an imprint may be missed, but cannot be saved.
    shows(
        ":figure ellipse --thickness 0.1<Enter>q",
        &["not saved. Quit anyway? (y: lose it, n: stay)"],
    );
    for nothing_lost in [
        "<Space><Space>nq",
        "<Space>saa<Enter>nq",
        "<Space><Space>nuuq",
        // What was undone was given up.
        "<Space><Right><Space>uuq",
        "<Space>H<Home><Enter>q",
        "<Space>ulwasher<Enter>q",
        // What is undone on a shape that stays is given up, as in an editor.
        "lwasher<Enter><Space>uq",
        // An empty matrix is not worth a question, however it became empty, and on whatever sensor.
        "<Space>saa<Enter><Space>q",
        "f<Enter>saa<Enter>uq",
        "S<Tab>9<Enter>q",
        "<Space>saa<Enter><Space>lwasher<Enter>q",
    ] {
        assert!(session(nothing_lost).app().ended(), "{nothing_lost}");
    }
}

#[test]
fn nearly_empty_and_full_matrices_have_no_impossible_numbers() {
    for keys in [
        "",
        "<Space>",
        "fr<Tab>16<Tab>16<Tab>0<Tab>0<Enter>",
        "<Space><Right><Right><Space>",
    ] {
        hides(keys, &["NaN", "inf"]);
    }
    let counts = ["NA     0 ", "NumX   0 ", "Area   0 "];
    shows("", &counts);
    shows("", &["CG     –", "P      –", "F      –"]);
    shows(
        "<Space>",
        &["P      0 ", "F      0 ", "Round  –", "dir    –"],
    );
    shows(
        "fr<Tab>16<Tab>16<Tab>0<Tab>0<Enter>",
        &["NA     256", "Fill   100 %"],
    );
}

/// Every row of the table of keys is in help, fits on its line, and works in its context.
#[test]
fn every_key_is_in_help() {
    let pages = help(Context::Matrix, &Keymap::default()).len().div_ceil(10);
    let help: String = (0..pages)
        .map(|page| session(&format!("?<{page}x:PageDown>")).screen())
        .collect();
    for binding in DEFAULT_KEYS.iter() {
        assert!(
            help.contains(&format!("{:23} {}", binding.labels(), binding.help)),
            "{binding:?}"
        );
        assert!(
            binding.labels().chars().count() <= 23 && binding.help.chars().count() <= 54,
            "{binding:?}"
        );
    }
    for context in Context::all() {
        assert!(help.contains(context.title()), "{context:?}");
    }
}

/// No key is bound twice in one context: the second row could never be reached.
#[test]
fn no_key_has_two_meanings_in_one_context() {
    for context in Context::all() {
        let rows = DEFAULT_KEYS
            .iter()
            .filter(|binding| binding.context == context);
        let keys: Vec<_> = rows
            .flat_map(|binding| binding.keys.iter().map(|(key, _)| *key))
            .collect();
        for (index, key) in keys.iter().enumerate() {
            assert!(!keys[..index].contains(key), "{key} in {context:?}");
        }
    }
}

/// The shape may be held for any number of keys, and any page may be opened meanwhile.
#[test]
fn a_shape_that_is_put_back_leaves_no_step_to_undo() {
    for look in ["?<Esc>", "c", "+", ":coverage<Enter>", ""] {
        let moved = format!("f<Enter>g<Right>{look}<Right>");
        shows(&format!("{moved}<Esc>"), &["put back", "at 4.00, 4.00"]);
        shows(&format!("{moved}<Esc>u"), &["NA 0 in all"]);
        shows(&format!("{moved}u"), &["at 4.00, 4.00"]);
    }
}

#[test]
fn putting_back_overwrites_no_step_but_that_of_the_last_move() {
    let put_back = "f<Enter>g<Right><Space><Right><Esc>";
    shows(put_back, &["put back", "at 4.00, 4.00"]);
    shows(&format!("{put_back}u"), &["at 4.02, 4.00"]);
    shows(&format!("{put_back}uu"), &["at 4.01, 4.00", "by hand"]);
    let drawn = "f<Enter>g<Right><Space><Esc>";
    let dropped = "1 taxel set by hand was dropped; u restores it";
    shows(drawn, &[dropped, "at 4.00, 4.00"]);
    shows(&format!("{drawn}u"), &["at 4.01, 4.00", "by hand"]);
}

/// The list of steps leaves out a move that came to nothing; a further move is a step of its own.
#[test]
fn moves_after_a_move_that_came_to_nothing_can_be_undone() {
    let moved = "f<Enter>g<Right><Left>H<Esc><Right>";
    shows(moved, &["at 4.01, 4.00"]);
    shows(&format!("{moved}u"), &["at 4.00, 4.00"]);
}

/// The held shape is of the document that undo leaves: put back there, it would be stored under the other's name.
#[test]
fn undo_redo_and_the_history_let_the_shape_go() {
    let ring = "f<Enter>sring1<Enter>";
    for back in ["u", "H<Up><Enter>"] {
        let moved = format!("{ring}f<2x:Right><Enter>g{back}");
        shows(&moved, &["ring1", "ellipse"]);
        hides(&moved, &["held"]);
        shows(&format!("{moved}<Esc>"), &["ring1", "ellipse"]);
    }
    hides("f<Enter><Space>ugU", &["held"]);
}

#[test]
fn a_figure_that_a_smaller_sensor_does_not_allow_becomes_a_drawing() {
    let smaller = ":figure rectangle --length 10<Enter>:sensor --columns 4 --rows 4<Enter>";
    shows(
        smaller,
        &["the rectangle does not fit this sensor and became a drawing; u undoes it"],
    );
    shows(&format!("{smaller}u"), &["rectangle length 10.0"]);
}

/// Nothing moves, so taxels that were set by hand remain.
#[test]
fn a_move_by_zero_changes_nothing() {
    for nothing in [":move 0 0", ":turn 0", ":turn 360"] {
        shows(
            &format!("f<Enter><Space>{nothing}<Enter>"),
            &["+ 1 by hand"],
        );
    }
}

#[test]
fn another_shape_is_not_held() {
    for other in [
        ":load washer<Enter>",
        ":figure hexagon<Enter>",
        ":picture washer<Enter><Enter>",
        "n",
    ] {
        hides(&format!("f<Enter>g{other}"), &["held"]);
    }
}

/// A page that is closed again has changed nothing, so the shape can still be put back.
#[test]
fn a_page_that_is_closed_leaves_a_held_shape_held() {
    for page in ["l", "p", "d", "f", "S", "e", "s", "H", ":", "q"] {
        let back = format!("f<Enter>g<3x:Right>{page}<Esc>");
        shows(&back, &["at 4.03, 4.00", "held, step"]);
        shows(&format!("{back}<Esc>"), &["put back", "at 4.00, 4.00"]);
    }
    for accepted in ["f<Enter>", "S<Enter>", "e<2x:Tab><C-u>0<Enter><Enter>"] {
        hides(&format!("f<Enter>g<Right>{accepted}"), &["held"]);
    }
    for key in ["<C-g>", "<C-c>"] {
        shows(&format!("f<Enter>g<Right>{key}"), &["put back"]);
    }
}

#[test]
fn recognise_steps_through_sets_and_accepts_a_name() {
    shows(
        "ro",
        &["model figures-30", "with 'taxel model train' in a shell"],
    );
    shows("roO", &["certain 100.0 %"]);
    shows(":recognise figures-30<Enter>", &["model figures-30"]);
    shows(":reco<Tab>figures-<Tab><Enter>", &["model figures-30"]);
    // The current set is kept, with the kept touches and their answer.
    let hexagon = ":figure hexagon --side 3.4 --x0 4.31 --y0 4.52 --angle 17<Enter>";
    shows(
        &format!(":recognise figures-30<Enter>{hexagon}a:recognise nothing<Enter>"),
        &[
            "no model or file named \"nothing\"; models: figures, figures-30, shapes",
            "Recognise: model figures-30",
            "likely: hexagon",
            "1 touch kept",
        ],
    );
    // Another set answers about the same touches.
    shows(
        &format!(":recognise figures-30<Enter>{hexagon}ao"),
        &["model shapes", "1 touch kept; x forgets"],
    );
    shows("rP", &["no pose to show: nothing is touched"]);
    shows(":seed x<Enter>", &["! invalid value 'x' for '<NUMBER>'"]);
    shows(":random-touch<Enter>", &["a random touch of "]);
    shows("r<Enter>", &["the model is ready: nothing was stopped"]);
}

#[test]
fn touches_are_kept_combined_and_forgotten() {
    let hexagon = ":figure hexagon --side 3.4 --x0 4.31 --y0 4.52 --angle 17<Enter>";
    let one = format!(":recognise figures-30<Enter>{hexagon}");
    shows(&one, &["likely: hexagon", "45.3 %"]);
    // A touch that was kept counts once, however long it remains on the matrix.
    shows(&format!("{one}a"), &["1 touch kept", "45.3 %"]);
    shows(
        &format!("{one}aa"),
        &["this touch is already kept", "45.3 %"],
    );
    // Another pose is another touch, even if it leaves the same imprint.
    let same = ":recognise figures-30<Enter>f<Enter>a:move 0.02 0<Enter>";
    shows(&format!("{same}a"), &["2 touches kept"]);
    shows(&format!("{same}aa"), &["this touch is already kept"]);
    shows(
        &format!("{same}a<Space><Space>a"),
        &["this touch is already kept"],
    );
    shows(
        &format!("{one}a><gt>"),
        &["likely: octagon", "1 touch kept; x forgets"],
    );
    hides(&format!("{one}a<gt><gt><gt><gt>"), &["45.3 %"]);
    shows(
        &format!("{one}ax"),
        &["the kept touches are forgotten", "45.3 %"],
    );
    shows(":recognise figures-30<Enter>a", &["nothing is touched"]);
    // The touch on the matrix is kept, although it was made while the page was closed.
    let closed = format!(":recognise figures-30<Enter><Esc>{hexagon}ra");
    shows(&closed, &["1 touch kept", "45.3 %"]);
    shows(&format!("{closed}<Esc>nra"), &["nothing is touched"]);
    shows(":recognise figures-30<Enter>x", &["no touches are kept"]);
}

#[test]
fn the_confusion_matrix_starts_at_the_worst_pair() {
    let open = ":recognise figures-30<Enter>v";
    shows(
        open,
        &[
            "Confusion:",
            "octagon named ellipse: 2,184,280 of 3,600,000 touches",
        ],
    );
    shows(&format!("{open}<Home>"), &["ellipse named ellipse"]);
    shows(
        &format!("{open}<Up><Right>"),
        &["heptagon named rectangle: 0 of"],
    );
    shows(
        &format!("{open}<Up><Right><Enter>"),
        &["no imprint in this cell"],
    );
    shows(
        &format!("{open}<Enter>"),
        &["likely: ellipse", "\nimprint of octagon, named ellipse\n"],
    );
    shows(&format!("{open}<Esc>"), &["Recognise:"]);
}

#[test]
fn a_turn_beyond_360_degrees_shows_no_rounding_error() {
    shows(
        ":figure hexagon --angle 350<Enter>:turn 15.3<Enter>",
        &["5.3°"],
    );
}

/// A smaller sensor that is undone leaves the cursor where it was.
#[test]
fn the_cursor_is_back_when_the_sensor_is_as_large_as_before() {
    let smaller = "S4<Tab>4<Enter>";
    shows(smaller, &["column 3, row 3"]);
    shows(&format!("{smaller}u"), &["column  8, row  8"]);
    shows(&format!("{smaller}<Left>u"), &["column  2, row  3"]);
    shows(
        &format!("{smaller}<Space><Home>"),
        &["column 0, row 3", "NA 1 in all"],
    );
}

#[test]
fn the_key_of_narrow_screens_says_that_nothing_is_hidden() {
    let text = "both sides of the screen are visible";
    for keys in ["i", "f<Enter>ri"] {
        shows(keys, &[text]);
    }
}

/// Home and End reach its ends as in other lists, and an unknown key is answered with the keys of help.
#[test]
fn home_and_end_reach_the_ends_of_help() {
    let first = session("?").screen();
    shows("?<End>", &["; the end", "redraw the screen"]);
    assert_eq!(session("?<End><Home>").screen(), first);
    shows(
        "?g",
        &["! g does nothing here; Up Down PageUp PageDown scroll, / searches"],
    );
}

#[test]
fn a_difference_of_directions_is_a_turn_and_every_difference_has_its_sign() {
    // Three taxels around a corner, which is then another one.
    let corner = "<Space><Right><Space><Down><Space>";
    let keys = format!("{corner}<Left><Space><Up><Space>H<Up><Up>=");
    let screen = session(&keys).screen();
    let row = |symbol: &str| {
        let line = screen.lines().find(|line| line.contains(symbol));
        let line = line.unwrap_or_else(|| panic!("no {symbol} on\n{screen}"));
        line.split("  ").last().map(str::trim).map(str::to_owned)
    };
    assert_eq!(row("  dir ").as_deref(), Some("-90°"), "{screen}");
    assert_eq!(row("  CG  ").as_deref(), Some("0, +0.3333"), "{screen}");
    assert_eq!(row("  NumY ").as_deref(), Some("+1"), "{screen}");
}
