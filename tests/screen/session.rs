//! The program on a screen in memory, with its own library.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use taxel::tui::app::Options;
use taxel::tui::jobs::Jobs;
use taxel::tui::script::Session;
use taxel_files::storage::ModelCache;

/// Makes an empty library in a temporary folder, which is deleted with the session. A set that any of these tests has
/// trained is not trained again.
pub(crate) fn world() -> Jobs {
    untrained().with_model_cache(Some(models()))
}

/// Like [`world`], but every set has to be trained.
pub(crate) fn untrained() -> Jobs {
    Jobs::scratch().expect("a temporary folder can be made")
}

/// Returns the models of these tests. The first call deletes those of an earlier build.
pub(crate) fn models() -> ModelCache {
    static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("screen-models");
        // In a new checkout there are none.
        let _ = std::fs::remove_dir_all(&folder);
        folder
    });
    ModelCache::in_folder(&*FOLDER)
}

/// Starts with 16 × 16 taxels on a screen of 80 × 24, and presses keys.
pub(crate) fn session(keys: &str) -> Session {
    started(world(), keys)
}

/// Like [`session`], with another library or with workers.
pub(crate) fn started(world: Jobs, keys: &str) -> Session {
    on(world, &Options::plain(false), (80, 24), keys)
}

/// Like [`session`], on a screen of another size, perhaps in ASCII only.
pub(crate) fn sized(size: (u16, u16), ascii: bool, keys: &str) -> Session {
    on(world(), &Options::plain(ascii), size, keys)
}

/// Like [`session`], with everything given.
pub(crate) fn on(world: Jobs, options: &Options, size: (u16, u16), keys: &str) -> Session {
    let mut session = Session::new(options, world, size.0, size.1);
    press(&mut session, keys);
    session
}

/// Presses keys in notation.
pub(crate) fn press(session: &mut Session, keys: &str) {
    session.keys(keys).expect("the keys of a test are right");
}

/// The subject of a check: a session, or the keys that lead to one.
pub(crate) trait Screen {
    /// Returns the screen, and the keys if they are known.
    fn screen(&self) -> (String, &str);
}

impl Screen for Session {
    fn screen(&self) -> (String, &str) {
        (Session::screen(self), "")
    }
}

impl Screen for str {
    fn screen(&self) -> (String, &str) {
        (Session::screen(&session(self)), self)
    }
}

impl Screen for String {
    fn screen(&self) -> (String, &str) {
        Screen::screen(self.as_str())
    }
}

/// Checks that every text is on the screen.
pub(crate) fn shows(of: &(impl Screen + ?Sized), texts: &[&str]) {
    let (screen, keys) = of.screen();
    for text in texts {
        assert!(screen.contains(text), "{keys}: no {text:?} on\n{screen}");
    }
}

/// Checks that none of the texts is on the screen.
pub(crate) fn hides(of: &(impl Screen + ?Sized), texts: &[&str]) {
    let (screen, keys) = of.screen();
    for text in texts {
        assert!(!screen.contains(text), "{keys}: {text:?} on\n{screen}");
    }
}

/// Presses keys, then checks that every text is on the screen.
pub(crate) fn then(session: &mut Session, keys: &str, texts: &[&str]) {
    press(session, keys);
    shows(session, texts);
}
