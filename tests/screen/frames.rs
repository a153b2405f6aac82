//! The bytes of the most common frames. The numbers are printed: `cargo test --test screen frames -- --nocapture`.

use taxel::tui::app::view::draw;
use taxel::tui::terminal::screen::{Abilities, Screen};

use crate::session::session;

/// Keys that lead to the results of the paper's grid.
const SWEPT: &str = "f<CR>:explore --x0 5:5.99:0.01 --y0 5:5.99:0.01<CR>";

/// What one packet of a network holds, and so what a key may take.
const PACKET: usize = 1448;

/// A name, the keys before the frame, the keys of the frame (empty for the first frame), and the highest number of
/// bytes.
const SCENES: [(&str, &str, &str, usize); 7] = [
    ("first frame", "", "", 4500),
    ("cursor move", "", "<Right>", 80),
    ("first toggle", "", "<Space>", PACKET),
    ("a form opens", "f<CR>", "f", PACKET),
    ("a field is edited", "f<CR>f<Tab>", "3", PACKET),
    ("a row of Explore", SWEPT, "<Down>", PACKET),
    ("nothing has changed", "f<CR>", "<Right><Left>", 0),
];

#[test]
fn every_frame_fits_its_budget() {
    let mut over = Vec::new();
    for (name, before, keys, most) in SCENES {
        let abilities = Abilities {
            styles: true,
            synchronized: true,
        };
        let mut screen = Screen::new((80, 24), abilities);
        let (first, then) = (session(before), session(&format!("{before}{keys}")));
        let then = (!keys.is_empty()).then_some(&then);
        let mut bytes = 0;
        for session in [Some(&first), then].into_iter().flatten() {
            bytes = screen.frame(|buffer| draw(session.app(), buffer)).len();
        }
        println!("{name:26} {bytes:6}");
        if bytes > most {
            over.push(format!("{name}: {bytes} of at most {most}"));
        }
    }
    assert!(over.is_empty(), "{over:#?}");
}
