//! Screens in every size and character set.

use taxel::tui::app::{Message, Mouse, MouseKind, Options};
use taxel::tui::widget::{ColorDepth, Palette, Theme};
use taxel_core::sensor::Sensor;

use crate::session::{hides, on, press, shows, sized, world};

/// Keys that open the screens.
const SCREENS: [&str; 19] = [
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
        "fr<Enter>e<Enter>x",
    ] {
        let screen = sized((80, 24), true, keys).screen();
        assert!(screen.is_ascii(), "{keys}\n{screen}");
    }
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
    wide.resize(60, 20);
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

/// If there is too little room for a question, what it is about is cut, never its answers.
#[test]
fn the_answers_to_a_question_are_visible_on_small_screens() {
    let long = "a".repeat(64);
    let delete = format!("<Space>s{long}<Enter>da<Enter>");
    for size in [(40, 12), (60, 20)] {
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
