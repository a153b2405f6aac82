//! The program on a screen in memory, with a library of its own.

use taxel::tui::app::state::Options;
use taxel::tui::runtime::World;
use taxel::tui::script::Session;

/// 16 × 16 taxels at 80 × 24, an empty library that goes with the session.
pub(crate) fn session(keys: &str) -> Session {
    let world = World::scratch().expect("there is a folder for temporary files");
    started(world, keys)
}

/// The same in a world of its own.
pub(crate) fn started(world: World, keys: &str) -> Session {
    let options = Options::plain(false);
    let mut session = Session::new(&options, world, 80, 24);
    press(&mut session, keys);
    session
}

/// Presses keys in notation.
pub(crate) fn press(session: &mut Session, keys: &str) {
    session.keys(keys).expect("the keys of a test are right");
}

/// All of the texts must be on the screen.
pub(crate) fn shows(session: &Session, texts: &[&str]) {
    let screen = session.screen();
    for text in texts {
        assert!(screen.contains(text), "no {text:?} on\n{screen}");
    }
}
