//! Screens in every size and character set.

use taxel::sensor::Sensor;
use taxel::tui::app::message::{Message, Mouse, MouseKind};
use taxel::tui::app::state::Options;
use taxel::tui::widget::theme::{ColorDepth, Palette, Theme};

use crate::session::{hides, on, press, shows, sized, then, world};

/// Keys that open the screens.
const SCREENS: [&str; 23] = [
    "",
    "f",
    "fh<Tab>x",
    "f<Enter>c",
    "f<Enter>cc",
    "f<Enter>gq",
    "?",
    "?<PageDown>",
    "f<Enter>i",
    "f<Enter><Space>=",
    "<Space>q",
    "fr<Enter>e",
    "fr<Enter>e9<Enter>",
    "<Space>:explore --x0 5:6:0.1 --y0 5 --angle 0<Enter>",
    "fr<Enter>:explore --x0 5:6:0.1 --y0 0:16:0.1 --angle 0<Enter>2",
    "fr<Enter>:explore --x0 5:6:0.1 --y0 5 --angle 0:90:30<Enter>3",
    "fr<Enter>:explore --x0 0:16:0.1 --y0 0:16:0.1 --angle 0<Enter>4<99x:Right>",
    "fr<Enter>:explore --x0 0:16:0.1 --y0 0:16:0.1 --angle 0<Enter>4+",
    "fr<Enter>:explore --x0 5:6:0.1 --y0 5 --angle 0:90:30<Enter>5",
    "fr<Enter>:explore --x0 5:6:0.1 --y0 5 --angle 0:90:30<Enter>6",
    "fr<Enter>:explore --x0 5:6:0.1 --y0 5 --angle 0:90:30<Enter>/na>18 x",
    "fr<Enter>:explore --x0 5:6:0.1 --y0 5 --angle 0:90:30<Enter>ma'",
    "fr<Enter>:explore --x0 5 --y0 5 --angle 0<Enter>x/tmp",
];

/// Draws every screen in many sizes; no size is too small, and none causes a panic.
fn draw_in_every_size(columns: u8, rows: u8) {
    for keys in SCREENS {
        let options = Options {
            sensor: Sensor::new(columns, rows).expect("sides from 1 to 64"),
            theme: Theme {
                ascii: false,
                console: false,
                depth: ColorDepth::TwoFiftySix,
                palette: Palette::Dark,
            },
            seed: 0,
        };
        let mut session = on(world(), &options, (80, 24), keys);
        for width in (0..=120).step_by(7).chain(17..=24).chain(58..70) {
            for height in (0..=50).step_by(3) {
                session.resize(width, height);
                // Asking for the cursor draws the screen.
                let _ = session.cursor();
            }
        }
        let lines = session.screen().lines().count();
        assert!(lines <= 51, "{keys} with {columns} x {rows}");
    }
}

// One test for each sensor, so that they run at the same time.

#[test]
fn every_size_of_every_screen_is_drawn_with_one_column() {
    draw_in_every_size(1, 64);
}

#[test]
fn every_size_of_every_screen_is_drawn() {
    draw_in_every_size(16, 49);
}

#[test]
fn every_size_of_every_screen_is_drawn_with_one_row() {
    draw_in_every_size(64, 1);
}

/// On a matrix that is too large for the screen, the described region scrolls into view, wherever the cursor is, and a
/// move of the cursor scrolls back to it.
#[test]
fn the_described_region_and_a_moving_cursor_scroll_into_view() {
    let options = Options {
        sensor: Sensor::new(64, 64).expect("in range"),
        ..Options::plain(false)
    };
    let mut page = on(world(), &options, (80, 24), "<Home><PageUp>");
    let region = "█";
    hides(&page, &[region]);
    for (keys, seen) in [
        ("f<4x:Tab>50", true),
        ("<Esc>", false),
        ("f<4x:Tab>50<Enter>", true),
        ("<Right>", false),
        ("c", false),
        ("cc<Tab>", true),
        ("<Left>", false),
        ("e", true),
        ("<Esc><Right>", false),
        ("<S-Up>", true),
        ("<Space>", false),
        ("uu", true),
        ("<Right>:move 20 0<Enter>", true),
    ] {
        press(&mut page, keys);
        let screen = page.screen();
        assert_eq!(screen.contains(region), seen, "{keys}\n{screen}");
    }
}

/// In a locale without Unicode, every screen is pure ASCII.
#[test]
fn ascii_screens_are_ascii() {
    for keys in [
        "",
        "f",
        "f<Tab>x",
        "f<Enter>",
        "f<Enter><Tab>c",
        "f<Enter>cc",
        "?",
        "?<9x:PageDown>",
        "f<Enter>q",
        "g",
        "fr<Enter>e",
        "fr<Enter>e5:<Enter>",
        "fr<Enter>e<Enter>",
        "fr<Enter>e<Enter>2",
        "fr<Enter>e<Enter>3<End>",
        "fr<Enter>e<Enter>4>",
        "fr<Enter>e<Enter>4+++>",
        "fr<Enter>e<Enter>5",
        "fr<Enter>e<Enter>6",
        "fr<Enter>e<Enter>/na=9 x",
        "fr<Enter>e<Enter>ma'",
        "fr<Enter>e<Enter>x",
    ] {
        let screen = sized((80, 24), true, keys).screen();
        assert!(screen.is_ascii(), "{keys}\n{screen}");
    }
}

/// Returns the lines of a screen as one text, joining lines that were broken.
fn joined(screen: &str) -> String {
    let lines: Vec<&str> = screen.lines().map(str::trim).collect();
    lines.join(" ")
}

#[test]
fn questions_and_notices_are_complete_on_narrow_screens() {
    for (keys, text) in [
        (
            "<Space>q",
            "The imprint is not saved. Quit anyway? (y: lose it, n: stay, s: save first)",
        ),
        (
            "g",
            "! nothing to move: press f for a figure or p for a stored shape",
        ),
        (
            "<Space>s/",
            "! '/' cannot be in a name, only letters, digits, space, - _ .",
        ),
    ] {
        for size in [(80, 24), (60, 24), (40, 24), (40, 12), (24, 20)] {
            let screen = sized(size, false, keys).screen();
            assert!(joined(&screen).contains(text), "{keys} {size:?}\n{screen}");
        }
    }
}

#[test]
fn text_that_does_not_fit_ends_in_an_ellipsis() {
    let touched = "f<6x:Tab>2<Enter><Space>";
    let whole = "wall 2.00 + 1 by hand";
    shows(&sized((80, 24), false, touched), &[whole]);
    for (ascii, end) in [(false, "…"), (true, "...")] {
        let screen = sized((60, 24), ascii, touched).screen();
        let line = screen.lines().find(|line| line.starts_with("ellipse rx"));
        let line = line.expect("what made it is said");
        assert!(line.ends_with(end), "{line}");
        assert_eq!(line.chars().count(), 60, "{line}");
    }
    // The note that something is cut off is shown, whatever is before it.
    for ascii in [false, true] {
        let screen = sized((60, 24), ascii, "f<6x:Tab>2<Enter>g++<5x:Left>").screen();
        assert!(screen.contains("; reaches beyond the sensor\n"), "{screen}");
    }
    // For the taxel under the cursor, the most important information comes first, and no word is cut off.
    shows(
        &sized((40, 24), false, "f<Enter>"),
        &["\n 8,  8  1.000000    active  step 0.01\n"],
    );
    shows(
        &sized((36, 24), false, "f<Enter>g"),
        &["\n 8,  8    active  held, step 0.01\n"],
    );
}

#[test]
fn a_held_shape_has_its_place_on_a_low_screen() {
    shows(
        &sized((60, 20), false, "f<Enter>g<Right>"),
        &["\nat 4.01, 4.00, 0°  held, step 0.01  NA 52 in all\n"],
    );
    shows(
        &sized((40, 12), true, "f<Enter>g<Right>"),
        &["\nat 4.01, 4.00, 0 deg  held, step 0.01\n"],
    );
    // A picture is also zoomed.
    shows(
        &sized((60, 20), false, "pwasher<Enter><Enter>g<Right>"),
        &["\nat 2.01, 2.00, 0°, zoom 1.00 × 1.00  held, step 0.01\n"],
    );
    // The step is shown on any screen, since + and - change it.
    shows(
        &sized((50, 15), false, "pwasher<Enter><Enter>g<Right>"),
        &["\nat 2.01, 2.00  held, step 0.01\n"],
    );
    shows(
        &sized((30, 10), false, "pwasher<Enter><Enter>g<Right>+"),
        &["\nat 2.01, 2.00  held, step 0.1\n"],
    );
    // Otherwise the number keeps its label as long as possible.
    shows(
        &sized((60, 20), false, "f<Enter>"),
        &["\n 8,  8  covered 1.000000    active  step 0.01  NA 52 in all\n"],
    );
}

#[test]
fn a_long_name_can_be_typed_and_is_shown_completely() {
    let name = format!("{}end", "abcdefgh".repeat(8));
    for (size, seen) in [((80, 24), 67), ((40, 24), 29), ((30, 8), 19)] {
        let screen = sized(size, false, &format!("<Space>s{name}")).screen();
        // The hidden beginning is marked, and there is a column for the text cursor after the end.
        let (hidden, end) = name.split_at(name.len() - seen);
        let mark = if hidden.is_empty() { "" } else { "…" };
        assert!(
            screen.contains(&format!("Save as: {mark}{end}\n")),
            "{screen}"
        );
        let error = "! a name has at most 64 characters, this has 67";
        assert!(joined(&screen).contains(error), "{size:?}\n{screen}");
    }
}

#[test]
fn a_list_shows_how_many_rows_are_out_of_view() {
    let name = "a name of more than twenty-four characters";
    let mut session = sized((80, 24), false, &format!("<Space>s{name}<Enter>l"));
    let screen = session.screen();
    assert!(screen.contains("\n  0 above, 12 below"), "{screen}");
    assert!(
        screen.contains("> a name of more than twe… 16 × 16"),
        "{screen}"
    );
    assert!(joined(&screen).contains(" a name of more than twenty-four"));
    press(&mut session, "<End>");
    shows(&session, &["\n  12 above, 0 below"]);
    press(&mut session, "<C-u>washer");
    let screen = session.screen();
    assert!(
        !screen.contains(" above, "),
        "all of it is in sight\n{screen}"
    );
    // The source is longer than the preview is wide, so it is wrapped.
    let whole = "ellipse rx 4.00 ry 4.00 at 1.99,";
    assert!(screen.contains(whole), "{screen}");
    assert!(screen.contains("1.47, 0°, wall 2.00"), "{screen}");
    session.resize(40, 24);
    press(&mut session, "<C-u>");
    let screen = session.screen();
    assert!(
        screen.lines().all(|line| !line.contains("shippe…")),
        "{screen}"
    );
    assert!(screen.contains(" shipped\n"), "{screen}");
}

#[test]
fn matrix_and_descriptors_are_swapped_only_if_one_is_visible() {
    let mut wide = sized((80, 24), false, "i");
    assert!(
        wide.screen()
            .contains("both sides of the screen are visible"),
        "{}",
        wide.screen()
    );
    wide.resize(40, 24);
    assert!(!wide.screen().contains("NA     –"), "{}", wide.screen());
    // The hint names what the key will show.
    let hints = |keys: &str| {
        let screen = sized((60, 20), false, keys).screen();
        screen.lines().last().map(str::to_owned)
    };
    let named = |keys: &str, name: &str| {
        let hints = hints(keys).expect("a last line");
        assert!(hints.starts_with(name), "{keys}: {hints}");
    };
    named("f<Enter>", "i descriptors");
    named("f<Enter>i", "i matrix");
    named(":recognise figures-30<Enter>t", "Tab matrix");
    named(":recognise figures-30<Enter>t<Tab>", "Tab list");
    // A click on the descriptors does not draw on the matrix that they hide.
    press(&mut wide, "f<Enter>i");
    let before = wide.app().shown().clone();
    for kind in [MouseKind::Press, MouseKind::Release] {
        wide.send(Message::Mouse(Mouse {
            kind,
            column: 6,
            row: 5,
        }));
    }
    assert_eq!(wide.app().shown(), &before);
}

/// A number of the ruler is omitted if it would touch the text beside the matrix.
#[test]
fn rulers_do_not_touch_the_descriptors() {
    let ruler = |keys: &str| {
        let screen = sized((60, 19), false, keys).screen();
        let line = screen
            .lines()
            .find(|line| line.starts_with("   0    5    10"));
        line.map(str::to_owned)
    };
    for keys in ["f<Enter>", "f<Enter>="] {
        let line = ruler(keys).expect("a ruler");
        assert!(line.starts_with("   0    5    10    "), "{keys}: {line}");
    }
}

/// Help explains all keys completely, wrapped on narrow screens, and lists only keys that work where it was opened.
#[test]
fn help_is_complete_and_fits_its_context() {
    for size in [(80, 24), (60, 20), (46, 20), (40, 24), (24, 20)] {
        let help = joined(&sized(size, false, "?").screen());
        let text = "New: empty the matrix, to draw by hand";
        assert!(help.contains(text), "{size:?}\n{help}");
        let end = joined(&sized(size, false, "?<99x:PageDown>").screen());
        assert!(end.contains("the keys that work here"), "{end}");
    }
    let held = sized((80, 60), false, "f<Enter>g?");
    // If an outer context has other keys for the same action, these are still listed.
    shows(&held, &["move the shape by a step", "  Ctrl-L   "]);
    hides(&held, &["move the cursor"]);
    shows("f<Enter>e?", &["Ranges of a sweep"]);
}

/// The title has the sensor, the pitch if one is set, and the name; on a low screen, the name is beside the source.
#[test]
fn the_title_names_sensor_and_shape() {
    let title = |screen: String| screen.lines().nth(1).unwrap_or_default().to_owned();
    let at = |keys: &str| title(sized((80, 24), false, keys).screen());
    assert_eq!(at(""), "16 × 16 · threshold 0.50");
    let set = ":sensor --columns 32 --rows 9 --threshold 0.305 --pitch 2.5<Enter>";
    assert_eq!(at(set), "32 × 9 · threshold 0.305 · pitch 2.5 mm");
    let loaded = at("lwasher<Enter>");
    assert_eq!(loaded, "16 × 16 · threshold 0.50 · washer");
    let changed = at("lwasher<Enter><Space>");
    assert_eq!(changed, "16 × 16 · threshold 0.50 · washer*");
    // The title follows a form, and a full page covers it.
    assert_eq!(at("S<Tab><Tab><C-u>0.3"), "16 × 16 · threshold 0.30");
    assert!(!at("?").contains("threshold"));
    let low = sized((60, 22), false, "lwasher<Enter><Space>").screen();
    assert!(!low.contains("threshold 0.50"), "{low}");
    assert!(low.contains("\nwasher*: "), "{low}");
    let ascii = title(sized((80, 24), true, "").screen());
    assert_eq!(ascii, "16 x 16, threshold 0.50");
}

/// A low and narrow screen shows every value completely.
#[test]
fn no_descriptor_is_cut_off_on_a_small_screen() {
    for keys in ["f<Enter>i", "fr<Enter>i"] {
        let screen = sized((40, 12), false, keys).screen();
        assert!(!screen.contains('…'), "{keys}\n{screen}");
        let symbols = ["NumX ", "P ", "Round ", "Diag ", "Fill ", "CG-CD ", "dir "];
        for symbol in symbols {
            assert!(screen.contains(symbol), "{keys}: no {symbol}\n{screen}");
        }
    }
    // Beside a small sensor there is room for both, but perhaps not for all values.
    let figure = ":figure rectangle --length 2 --width 3 --x0 1.3 --y0 0.7 --angle 17<Enter>";
    for (size, sensor) in [
        ((52, 14), (8, 8)),
        ((50, 14), (6, 6)),
        ((40, 12), (3, 12)),
        ((80, 20), (16, 16)),
    ] {
        let (columns, rows) = sensor;
        let keys = format!(":sensor --columns {columns} --rows {rows}<Enter>{figure}");
        let both = sized(size, false, &keys);
        let screen = both.screen();
        assert!(screen.contains("\n   0 "), "{size:?} {sensor:?}\n{screen}");
        let hints = screen.lines().last();
        let named = hints.is_some_and(|hints| hints.starts_with("i descriptors"));
        assert!(named, "{size:?} {sensor:?}\n{screen}");
        let mut alone = sized(size, false, &format!("{keys}i"));
        let screen = alone.screen();
        assert!(!screen.contains('…'), "{size:?} {sensor:?}\n{screen}");
        assert!(screen.contains("Diag "), "{size:?} {sensor:?}\n{screen}");
        press(&mut alone, "i");
        assert_eq!(alone.screen(), both.screen());
    }
}

/// If there is no room for all descriptors, those that are shown are complete, and the number of the others is given.
#[test]
fn the_number_of_descriptors_without_room_is_shown() {
    for ascii in [false, true] {
        let panel = sized((30, 10), ascii, "f<Enter>i");
        shows(
            &panel,
            &["P     23.3137\n", "4..12", "and 7 more on a larger screen"],
        );
        hides(&panel, &["…", "CD "]);
        let smallest = sized((20, 6), ascii, "f<Enter>i");
        shows(&smallest, &["NA 52 NAE 52 CE 20\n", "and 14 more\n"]);
    }
    hides(&sized((40, 12), false, "f<Enter>i"), &["more"]);
}

#[test]
fn the_smallest_screen_shows_an_imprint_of_the_list() {
    let sweep = "fr<Enter>:explore --x0 5:6:0.1 --y0 5 --angle 0<Enter>";
    shows(&sized((20, 6), false, sweep), &["\n>  0 "]);
    shows(&sized((20, 7), false, sweep), &["poses", "\n>  0 "]);
}

/// If there is too little room for a question, what it is about is cut, never its answers.
#[test]
fn the_answers_to_a_question_are_visible_on_small_screens() {
    let long = "a".repeat(64);
    let delete = format!("<Space>s{long}<Enter>da<Enter>");
    for size in [(20, 6), (40, 12)] {
        for (keys, begins, answers) in [
            (
                "f<Enter>q",
                "The imprint",
                "Quit anyway? (y: lose it, n: stay, s: save first)",
            ),
            (
                "<Space>nf<Enter>q",
                "The imprint",
                "Quit anyway? (y: lose them, n: stay, s: save first)",
            ),
            (
                "<Space>sone<Enter>n<Space>sone<Enter>",
                "\"one\" already",
                "Replace it? (y/n)",
            ),
            (&delete, "Delete", " (y/n)"),
        ] {
            let screen = sized(size, false, keys).screen();
            let text = screen.split_whitespace().collect::<Vec<_>>().join(" ");
            for piece in [begins, answers] {
                assert!(text.contains(piece), "{piece:?} in {size:?}:\n{screen}");
            }
        }
    }
}

#[test]
fn a_narrow_form_shows_the_limits_that_a_value_misses() {
    for size in [(80, 24), (60, 20), (40, 12)] {
        shows(&sized(size, false, "fe<Tab>-3"), &["above 0, up to 16"]);
    }
}

#[test]
fn the_smallest_screen_shows_a_row_of_compared_imprints() {
    let smallest = sized((20, 6), false, "lkey<Enter><Space>=");
    shows(&smallest, &["1 taxel differs", "a: A, b: B", "\n 0 ·"]);
}

/// A form leaves enough room for the matrix to show something, or takes that room as well.
#[test]
fn no_ruler_is_shown_above_a_form_without_the_matrix() {
    for keys in ["f", "S", "f<Enter>e"] {
        hides(&sized((40, 12), false, keys), &["   0    5    10"]);
    }
    shows(
        &sized((40, 16), false, "f"),
        &["   0    5    10", " 4 ·····▄████▄"],
    );
}

#[test]
fn the_comparison_scrolls_if_it_does_not_fit() {
    let whole = sized((80, 24), false, "f<Enter>=");
    hides(&whole, &["scroll", "↓"]);
    shows(
        &sized((80, 24), false, "f<Enter>=<Down>"),
        &["all of it is visible"],
    );
    let mut low = sized((40, 12), false, "f<Enter>=");
    shows(
        &low,
        &["arrows scroll", "only B  ↓", " 0 · · ·", "\n 5 · · ·"],
    );
    hides(&low, &["\n 7 "]);
    then(
        &mut low,
        "<Down><Down>",
        &["only B  ↑↓", "\n 2 · · ·", "\n 7 · · ·"],
    );
    then(
        &mut low,
        "<End>",
        &["only B  ↑\n", "\n10 · · ·", "\n15 · · ·"],
    );
    then(&mut low, "<PageUp>", &["only B  ↓\n", "\n 0 · · ·"]);
    // The descriptors scroll the same way, and a large sensor also scrolls sideways.
    then(&mut low, "<Tab><Tab><Tab><End>", &["dir "]);
    let mut wide = sized((40, 24), false, ":sensor --columns 64<Enter>f<Enter>=");
    shows(&wide, &["only B  →", "   0    5    10"]);
    then(&mut wide, "<3x:Right>", &["only B  ←→", "\n     5    10"]);
    then(&mut wide, "<60x:Right>", &["only B  ←\n"]);
}

#[test]
fn a_pitch_of_1_means_none() {
    shows(
        "S",
        &["Pitch     1.000     above 0, up to 1000 mm", "1: not set"],
    );
    shows(
        &sized((30, 10), false, "S"),
        &["Pitch     1.000     1: not set"],
    );
    hides("f<Enter>", &["mm"]);
}

/// Lines, CG and CD share the large taxels with numbers of two digits.
#[test]
fn a_number_of_two_digits_is_never_shown_in_part() {
    for (size, columns) in [((130, 45), 64), ((200, 60), 96)] {
        let shown = sized(size, false, "f<Enter>cc");
        shows(&shown, &["coverage in percent\n", "93", "69"]);
        let screen = shown.screen();
        for line in screen.lines().skip(3).take(2 * columns / 4) {
            // Beside the ruler of the rows.
            let line: String = line.chars().skip(3).take(columns).collect();
            let mut numbers = line.split(|c: char| !c.is_ascii_digit());
            assert!(
                numbers.all(|digits| matches!(digits.len(), 0 | 2)),
                "{screen}"
            );
        }
    }
    shows("f<Enter>cc", &["one digit stands for tens"]);
}

#[test]
fn help_keeps_its_place_on_a_screen_of_another_width() {
    let mut session = sized((60, 20), false, "?/zoom<Enter>n<Esc>");
    let row = |screen: &str| {
        let mut lines = screen.lines();
        lines.position(|line| line.contains("Shift-arrows"))
    };
    for (columns, rows) in [(60, 20), (200, 60), (60, 20)] {
        session.resize(columns, rows);
        let screen = session.screen();
        assert!(row(&screen).is_some_and(|row| row < 4), "{screen}");
    }
}

#[test]
fn a_narrow_comparison_names_both_imprints() {
    let keys = "f<Enter>:move 1 0<Enter>=".replace(' ', "<Space>");
    shows(
        &sized((40, 12), false, &keys),
        &["16 taxels differ   A: the s…   B: the m…"],
    );
    shows(
        &sized((60, 20), false, &keys),
        &["A: the state before   B: the matrix"],
    );
}

/// Beside a large matrix the panel is narrow; the values leave room for most lengths in mm all the same.
#[test]
fn lengths_in_mm_are_shown_beside_a_large_matrix() {
    let keys = ":sensor --columns 64 --rows 64 --pitch 2.5<Enter>f<Enter>".replace(' ', "<Space>");
    let page = sized((80, 24), false, &keys);
    shows(
        &page,
        &[
            "NumX   416             1040 mm\n",
            "Area   64              400 mm²\n",
        ],
    );
}

#[test]
fn a_narrow_title_of_the_angles_leaves_out_the_name_of_the_descriptor() {
    let keys = "f<Enter>:explore --x0 5 --y0 5 --angle 0:80:10<Enter>6".replace(' ', "<Space>");
    shows(
        &sized((40, 20), false, &keys),
        &["\nna  line: mean, dashes: min, max\n"],
    );
    let narrow = sized((30, 20), false, &keys);
    shows(&narrow, &["\nna against the angle\n"]);
}
