//! Screens of every size and every character set.

use taxel::sensor::Sensor;
use taxel::tui::app::Options;
use taxel::tui::effect::World;
use taxel::tui::script::Session;
use taxel::tui::theme::{ColorDepth, Palette, Theme};

fn world() -> World {
    World::scratch().expect("there is a folder for temporary files")
}

fn session(size: (u16, u16), ascii: bool, keys: &str) -> Session {
    let options = Options {
        sensor: Sensor::default(),
        theme: Theme::plain(ascii),
    };
    let mut session = Session::new(&options, world(), size.0, size.1);
    session.keys(keys).expect("the keys of a test are right");
    session
}

/// No size is too small for any screen, and none panics.
#[test]
fn every_size_of_every_screen_is_drawn() {
    let screens = [
        "",
        "f",
        "fh<Tab>x",
        "f<Enter>c",
        "f<Enter>cc",
        "f<Enter>gq",
        "?",
        "?<PageDown>",
        "f<Enter>i",
        "<Space>q",
    ];
    for keys in screens {
        for side in [1.0, 16.0, 64.0] {
            let sensor = Sensor::new(side, 65.0 - side).expect("sides from 1 to 64");
            let options = Options {
                sensor,
                theme: Theme {
                    ascii: false,
                    depth: ColorDepth::TwoFiftySix,
                    palette: Palette::Dark,
                },
            };
            let mut session = Session::new(&options, world(), 80, 24);
            session.keys(keys).expect("the keys of a test are right");
            for width in (0..=120).step_by(7).chain(17..=24).chain(58..70) {
                for height in (0..=50).step_by(3) {
                    session.resize(width, height);
                }
            }
            assert!(
                session.screen().lines().count() <= 51,
                "keys {keys}, side {side}"
            );
        }
    }
}

/// A locale without Unicode gets nothing but ASCII, on every screen.
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
    ] {
        let screen = session((80, 24), true, keys).screen();
        assert!(screen.is_ascii(), "{keys}\n{screen}");
    }
}
