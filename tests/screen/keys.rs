//! The effects of keys: each test presses keys, then checks the texts on the screen.

use taxel::tui::app::Message;
use taxel::tui::keys::{Context, DEFAULT_KEYS, Keymap, help};

use crate::session::{hides, session, shows, then};

/// Each line of keys shows a text.
fn each(rows: &[(&str, &str)]) {
    for (keys, shown) in rows {
        shows(*keys, &[shown]);
    }
}

#[test]
fn the_cursor_stays_on_the_matrix() {
    each(&[
        ("", "column  8, row  8  inactive"),
        ("<Left><Up>", "column  7, row  7"),
        ("<20x:Left><20x:Down>", "column  0, row 15"),
        ("<Home><PageUp>", "column  0, row  0"),
        ("<End><PageDown><Right><Down>", "column 15, row 15"),
        ("S4<Tab>4<Enter>", "column 3, row 3"),
        ("S4<Tab>4<Enter>u", "column  8, row  8"),
        ("S4<Tab>4<Enter><Left>u", "column  2, row  3"),
    ]);
}

#[test]
fn taxels_are_toggled_and_toggles_are_undone() {
    each(&[
        ("<Space>", "column  8, row  8    active"),
        ("<Space><Space>", "inactive"),
        ("<Space><Right><Space>u", "NA 1 in all"),
        ("<Space><Right><Space>uu", "undone: taxel 8, 8 on"),
        ("<Space><Right><Space>uuu", "! nothing to undo"),
        ("f<Enter><Space>u", "undone: taxel 8, 8 off"),
        ("<Space><Right><Space>uuUU", "NA 2 in all"),
        ("<Space><Right><Space>uu<C-r>", "NA 1 in all"),
        ("<Space>u<Right><Space>U", "nothing to redo"),
        ("v<Right><Left>u", "NA 0 in all"),
        ("vf<Enter><Right>", "NA 52 in all"),
    ]);
}

/// A wrong field keeps the figure before it on the matrix, not the beginning of a wrong number; Enter is refused.
#[test]
fn a_figure_follows_the_form_and_escape_restores_the_matrix() {
    each(&[
        ("f<Tab>2", "ellipse rx 2.00 ry 4.00"),
        ("f<Tab>2", "NA 28  NAE 28"),
        ("f<Tab>2<Esc>", "NA 0 in all"),
        ("f<Tab>2<Enter>", "ellipse rx 2.00 ry 4.00"),
        ("<Space>f<Tab>2<Esc>", "NA 1 in all"),
        ("f<Tab>2<C-g>", "empty"),
        ("f<Tab>2<C-c>", "n New"),
        ("f<Tab>2<Tab>x<Enter>", "! Radius y: \"x\" is not a number"),
        (
            "f<Tab>2<Tab>x<Enter><C-u>3<Enter>",
            "ellipse rx 2.00 ry 3.00",
        ),
        ("f<Tab>1", "ellipse rx 1.00 ry 4.00"),
        ("f<Tab>17", "ellipse rx 4.00 ry 4.00"),
        ("f<Tab>2,5", "! not a number; write 2.5"),
        ("f<Tab>2,<BS>.5", "ellipse rx 2.50 ry 4.00"),
        ("f<Tab><PageUp><PageUp>x", "ellipse rx 4.02 ry 4.00"),
        ("f<Tab>2<Tab>3<S-Tab>x", "ellipse rx 2.00 ry 3.00"),
        ("f<Tab>2<S-Tab>r<Tab>x", "rectangle length 6.00 width 3.00"),
    ]);
}

#[test]
fn the_step_is_shown_if_there_is_something_to_move() {
    each(&[
        ("f<Enter>", "NA 52 in all  step 0.01"),
        ("f<Enter>g+", "NA 52 in all  held, step 0.1"),
        ("f<Enter>g++g", "NA 52 in all  step 1"),
        ("f<Enter>++-", "NA 52 in all  step 0.1"),
        ("f<Enter>+<S-Right>", "at 4.10, 4.00"),
        ("f<Enter>-", "0.01 is the smallest step"),
        ("f<Enter>+++", "1 is the largest step"),
        ("+", "! nothing to move"),
    ]);
}

/// Values remain when the kind changes, and are there again when it changes back.
#[test]
fn kinds_are_chosen_by_arrows_and_letters() {
    each(&[
        ("f<Right>", "< rectangle >"),
        ("f<Left>", "< octagon "),
        ("f<7x:Right>", "< ellipse "),
        ("fhh", "< heptagon "),
        ("fhhh", "< hexagon "),
        ("ft<Enter>", "triangle side 4.00 at 4.00, 4.00"),
        ("fz", "! no kind begins with 'z'; kinds: ellipse, rectangle"),
        ("f<Tab><Tab><Tab>1.5<4x:S-Tab>", "1.5 "),
        ("f<Tab>2<S-Tab>rp<S-Tab>", "< pentagon "),
        ("f<Tab>2<S-Tab>re", "ellipse rx 2.00"),
    ]);
}

#[test]
fn fields_are_edited_and_changed_in_steps() {
    each(&[
        ("f<Tab><PageUp>", "rx 4.01"),
        ("f<Tab><PageDown><PageDown>", "rx 3.98"),
        ("f<Tab>9.99<PageUp>", "rx 10.0"),
        ("f<Tab>9.99<PageUp><PageUp>", "rx 10.1"),
        ("f<Tab>10.0<PageDown>", "rx 9.99"),
        ("f<Tab>0.01<PageDown>", "rx 0.01"),
        ("f<Tab>16<PageUp>", "rx 16.0"),
        ("f<4x:Tab><Tab><PageDown>", "359°"),
        ("f<4x:Tab><Tab>359<PageUp>", "at 4.00, 4.00, 0°"),
        ("f<6x:Tab><PageUp>", "thickness 1.00"),
        ("f<Tab><Left><BS>5", "rx 4.50"),
        ("f<Tab><Home><Del>5", "rx 5.00"),
        ("f<Tab>12.5<BS><BS><BS><BS>3", "rx 3.00"),
        ("fr<Tab><Up>t", "< triangle "),
        ("fh<Tab><Tab>-17", "! expected -16 to 16"),
        ("fh<4x:Tab>-1", "! expected 0 to below 360"),
        ("fh<4x:Tab>360", "! expected 0 to below 360"),
        ("S<Tab><Tab>0.3333", "0.3333"),
        ("fr<Enter>:move -8 0<Enter>f<3x:Tab><PageDown>", "-4.01"),
        ("f<Tab>3.00000000000000000001", "3.00000000000000000001"),
    ]);
}

#[test]
fn pasted_text_only_goes_into_fields() {
    let mut form = session("f<Tab>");
    form.send(Message::Paste(" 2.5\n".to_owned()));
    shows(&form, &["rx 2.50"]);
    // On the row of kinds, for the first field.
    let mut form = session("fh");
    form.send(Message::Paste("2.5".to_owned()));
    shows(&form, &["side 2.50"]);
    for page in [
        "",
        "f<Enter>g",
        "?",
        ":watch tests/scripts/touch.csv<Enter>",
    ] {
        let mut session = session(page);
        session.send(Message::Paste("qqq f".to_owned()));
        assert!(!session.app().ended());
        shows(&session, &["! pasted text goes into fields only"]);
    }
}

/// A hundred steps of 0.01 are exactly 1, and a turn beyond 360 degrees shows no rounding error.
#[test]
fn a_shape_is_moved_and_turned() {
    each(&[
        ("f<Enter>g<Right><Down><Down>", "at 4.01, 4.02, 0°"),
        ("f<Enter>g<Right><Down>uu", "at 4.00, 4.00, 0°"),
        ("f<Enter>g+<Left>", "at 3.90, 4.00"),
        ("f<Enter>g+++<Left>", "at 3.00, 4.00"),
        ("f<Enter>g++--<Left>", "at 3.99, 4.00"),
        ("f<Enter>gg<Left>", "column  7"),
        ("f<Enter>g<Enter><Left>", "column  7"),
        ("f<Enter>g<Esc><Left>", "column  7"),
        ("f<Enter><S-Right><S-Up>", "at 4.01, 3.99"),
        ("f<Enter>><lt><lt>", "359°"),
        ("f<Enter>))>(", "11°"),
        ("f<Enter>g<500x:Left>", "reaches beyond the sensor"),
        (
            "f<Enter>g++<40x:Left>",
            "! x0: -17 is below -16 (allowed: -16 to 16)",
        ),
        ("f<Enter>g++<40x:Left>", "at -16.0, 4.00"),
        ("g", "nothing to move"),
        (
            "<Space>>",
            "a drawing has no position; p places a saved one",
        ),
        (
            "lkey<Enter>g",
            "a drawing has no position; p places a saved one",
        ),
        ("lkey<Enter>c", "a stored imprint has none; p places it"),
        ("<Space>o", "a drawing has none; f places"),
        ("f<Enter>g<100x:Right>", "at 5.00, 4.00"),
        (
            ":figure hexagon --angle 350<Enter>:turn 15.3<Enter>",
            "5.3°",
        ),
        ("f<Enter><Space>:move 0 0<Enter>", "+ 1 by hand"),
        ("f<Enter><Space>:turn 360<Enter>", "+ 1 by hand"),
        ("i", "both sides of the screen are visible"),
    ]);
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

/// The largest piece is described first; undo and redo choose the region that was chosen there.
#[test]
fn tab_selects_the_next_region() {
    each(&[
        ("f<6x:Tab>2<Enter>", "Region 1 of 2: exterior"),
        ("f<6x:Tab>2<Enter><Tab>", "Region 2 of 2: hole"),
        ("f<6x:Tab>2<Enter><Tab><Tab>", "Region 1 of 2: exterior"),
        ("f<6x:Tab>2<Enter><S-Tab>", "Region 2 of 2: hole"),
        ("<Tab>", "no region: the matrix is empty"),
        (
            "<Space><Right><Right><Space><Right><Space>",
            "Region 2 of 2: exterior",
        ),
        ("f<6x:Tab>2<Enter><Tab>nu", "Region 2 of 2: hole"),
        ("f<6x:Tab>2<Enter><Tab>u<C-r>", "Region 2 of 2: hole"),
        (
            "f<6x:Tab>2<Enter>:move 1 0<Enter><Tab>u",
            "Region 2 of 2: hole",
        ),
        (
            "f<6x:Tab>2<Enter><Tab><Tab>:move 1 0<Enter><Tab>u",
            "Region 1 of 2: exterior",
        ),
    ]);
}

#[test]
fn quitting_asks_if_work_would_be_lost() {
    for ends in ["q", "<C-c>", "f<Enter>qy", "<Space>qsa name<Enter>"] {
        assert!(session(ends).app().ended(), "{ends}");
    }
    for no in ["", "<Enter>", "n", "q", "<Esc>", "<C-c>", "<C-g>"] {
        let asked = session(&format!("f<Enter>q{no}"));
        assert!(!asked.app().ended(), "{no}");
    }
    let earlier = "1 earlier shape is not saved; u goes back.";
    each(&[
        (
            "f<Enter>q",
            "not saved. Quit anyway? (y: lose it, n: stay, s: save first)",
        ),
        // A drawing that was left for something else would be lost, too: only undo has it.
        ("<Space>nq", earlier),
        ("<Space><Right><Space>lwasher<Enter>q", earlier),
        // Saving one does not discard the other.
        (
            "<Space>n<Right><Space>q",
            "The imprint and 1 earlier shape are not saved",
        ),
        ("<Space>n<Right><Space>qsa name<Enter>", earlier),
        // A figure that is too thin to leave an imprint may be missed, but cannot be saved.
        (
            ":figure ellipse --thickness 0.1<Enter>q",
            "Quit anyway? (y: lose it, n: stay)",
        ),
    ]);
    for nothing_lost in [
        "<Space><Space>nq",
        "<Space>saa<Enter>nq",
        // What was undone was given up.
        "<Space><Right><Space>uuq",
        "<Space>ulwasher<Enter>q",
        "lwasher<Enter><Space>uq",
        // An empty matrix is not worth a question, however it became empty, and on whatever sensor.
        "<Space>saa<Enter><Space>q",
        "S<Tab>9<Enter>q",
    ] {
        assert!(session(nothing_lost).app().ended(), "{nothing_lost}");
    }
}

#[test]
fn nearly_empty_and_full_matrices_have_no_impossible_numbers() {
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

/// Every row of the table of keys is in the help of its place, and fits on its line.
#[test]
fn every_key_is_in_help() {
    for binding in DEFAULT_KEYS.iter() {
        let lines = help(binding.context, &Keymap::default());
        let is_there = lines.iter().any(|line| line.text == binding.help);
        assert!(is_there, "{binding:?}");
        assert!(
            binding.labels().chars().count() <= 23 && binding.help.chars().count() <= 54,
            "{binding:?}"
        );
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

/// Any page may be opened while the shape is held.
#[test]
fn a_shape_that_is_put_back_leaves_no_step_to_undo() {
    each(&[
        ("f<Enter>g<Right>?<Esc><Right><Esc>", "put back"),
        ("f<Enter>g<Right>c<Right><Esc>u", "NA 0 in all"),
        ("f<Enter>g<Right><Right>u", "at 4.00, 4.00"),
        ("f<Enter>g<Right><Space><Right><Esc>u", "at 4.02, 4.00"),
        ("f<Enter>g<Right><Space><Right><Esc>uu", "at 4.01, 4.00"),
        (
            "f<Enter>g<Right><Space><Esc>",
            "1 taxel set by hand was dropped; u restores it",
        ),
        ("f<Enter>g<Right><Space><Esc>u", "at 4.01, 4.00"),
        ("f<Enter>g<Right><Left>l<Esc><Right>u", "at 4.00, 4.00"),
        ("f<Enter>g<3x:Right>l<Esc>", "held, step"),
        ("f<Enter>g<3x:Right>f<Esc><Esc>", "at 4.00, 4.00"),
    ]);
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

/// The held shape is of the document that undo leaves: put back there, it would be stored under the other's name.
#[test]
fn another_shape_is_not_held() {
    for other in [
        ":load washer<Enter>",
        ":figure hexagon<Enter>",
        "n",
        "f<Enter>",
        "S<Enter>",
        "u",
    ] {
        hides(&format!("f<Enter><Space>g<Right>{other}"), &["held"]);
    }
}

/// The current set is kept with its touches and their answer if another one cannot be found.
#[test]
fn recognise_accepts_the_name_of_a_set() {
    let hexagon = ":figure hexagon --side 3.4 --x0 4.31 --y0 4.52 --angle 17<Enter>";
    let kept = format!(":recognise figures-30<Enter>{hexagon}a");
    shows(
        &format!("{kept}:recognise nothing<Enter>"),
        &[
            "no model or file named \"nothing\"",
            "hexagon  43.2 %  fits exactly",
            "1 touch kept",
        ],
    );
    // Another set answers about the same touches.
    shows(
        &format!("{kept}:recognise shapes<Enter>"),
        &["model shapes", "1 touch kept; x forgets"],
    );
    each(&[
        ("r", "certain 99.8 %"),
        (":reco<Tab>figures-<Tab><Enter>", "model figures-30"),
        (
            "rP",
            "with the outline of the fitted shape, once there is one",
        ),
        (":random-touch<Enter>", "a random touch of "),
        ("r<Enter>", "the model is ready"),
    ]);
}

/// A touch that was kept counts once, however long it remains on the matrix.
#[test]
fn touches_are_kept_combined_and_forgotten() {
    let model = ":recognise figures-30<Enter>";
    let hexagon = ":figure hexagon --side 3.4 --x0 4.31 --y0 4.52 --angle 17<Enter>";
    for (keys, shown) in [
        (hexagon.to_owned(), "43.2 %"),
        (format!("{hexagon}a"), "43.2 %"),
        (format!("{hexagon}aa"), "this touch is already kept"),
        (format!("{hexagon}aa"), "43.2 %"),
        (
            format!("{hexagon}a:figure rectangle<Enter>a"),
            "2 touches kept",
        ),
        (format!("{hexagon}a<gt><gt>"), "octagon  "),
        (format!("{hexagon}ax"), "the kept touches are forgotten"),
        (format!("{hexagon}ax"), "43.2 %"),
        ("a".to_owned(), "nothing is touched"),
        ("x".to_owned(), "no touches are kept"),
        (format!("<Esc>{hexagon}ra"), "1 touch kept"),
    ] {
        shows(&format!("{model}{keys}"), &[shown]);
    }
    hides(&format!("{model}{hexagon}a<gt><gt><gt><gt>"), &["43.2 %"]);
}

/// Home and End reach its ends as in other lists, and an unknown key is answered with the keys of help.
#[test]
fn home_and_end_reach_the_ends_of_help() {
    let first = session("?").screen();
    shows("?<End>", &["; the end", "back to the descriptors"]);
    assert_eq!(session("?<End><Home>").screen(), first);
    shows("?g", &["! g does nothing here\n"]);
}

#[test]
fn a_difference_of_directions_is_a_turn_and_every_difference_has_its_sign() {
    // Three taxels around a corner, which is then another one.
    let corner = "<Space><Right><Space><Down><Space>";
    let keys = format!("{corner}:save a<Enter><Left><Space><Up><Space>:compare a<Enter>");
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
