//! The two lines that show keys, the menu and the hints, on each page; and clicks on them.

use taxel::tui::app::{Message, Mouse, MouseKind};
use taxel::tui::script::Session;

use crate::session::{Screen, press, session, shows};

/// Returns the first and the last line of a screen.
fn lines(of: &(impl Screen + ?Sized)) -> (String, String) {
    let (screen, _) = of.screen();
    let mut lines = screen.lines();
    let menu = lines.next().unwrap_or_default().to_owned();
    (menu, lines.last().unwrap_or_default().to_owned())
}

/// Clicks on a text in the first or the last line, or in one of the lines of a page.
fn click(session: &mut Session, text: &str) {
    let screen = Session::screen(session);
    let last = screen.lines().count() - 1;
    let mut rows = [0, last].into_iter().chain(1..last);
    let found = rows.find_map(|row| {
        let line = screen.lines().nth(row)?;
        let column = line[..line.find(text)?].chars().count();
        Some((u16::try_from(row).ok()?, u16::try_from(column).ok()?))
    });
    let (row, column) = found.unwrap_or_else(|| panic!("no {text:?} in the lines of\n{screen}"));
    for kind in [MouseKind::Press, MouseKind::Release] {
        session.send(Message::Mouse(Mouse { kind, column, row }));
    }
}

#[test]
fn keys_that_can_do_nothing_at_the_moment_are_not_shown() {
    for (keys, has, lacks) in [
        ("lzzz", "/ new search", "choose"),
        // The map shows no descriptor.
        ("f<CR>:explore --angle 0<CR>4", "+ - zoom", "descriptor"),
    ] {
        let (_, last) = lines(keys);
        assert!(
            last.contains(has) && !last.contains(lacks),
            "{keys}: {last}"
        );
    }
    // On the matrix, too, and on a page beside it.
    for (keys, expected) in [
        ("", "Space toggle  r recognise"),
        (
            "<Space>",
            "Space toggle  u undo  Tab region  e explore  r recognise",
        ),
        ("<Space><Space>", "Space toggle  u undo  r recognise"),
        ("<Space>r", "Space toggle  u undo  Tab region  e explore"),
        ("r", "Space toggle"),
    ] {
        let (_, last) = lines(keys);
        assert_eq!(last, expected, "{keys}");
    }
    shows("f<CR>", &["c coverage  g hold"]);
    shows("r", &["t touch   o model   Esc close   ? help\n"]);
}

#[test]
fn clicks_on_the_lines_of_keys_do_what_the_keys_do() {
    let mut session = session("");
    click(&mut session, "Space toggle");
    shows(&session, &["NA 1 in all"]);
    click(&mut session, "undo");
    shows(&session, &["NA 0 in all"]);
    click(&mut session, "Figure");
    shows(&session, &["Radius x"]);
    click(&mut session, "< ellipse");
    shows(&session, &["< rectangle "]);
    click(&mut session, "? help");
    shows(&session, &["In a form"]);
    click(&mut session, "close");
    click(&mut session, "field");
    press(&mut session, "2");
    shows(&session, &["rectangle length 2.00 width 3.00"]);
    click(&mut session, "accept");
    shows(&session, &["Region 1 of 1", "n New"]);
    // The second of two keys, and four arrows, on which a click does nothing.
    click(&mut session, "g hold");
    click(&mut session, "arrows");
    click(&mut session, "+ -");
    shows(&session, &["held, step 0.1"]);
    click(&mut session, "- step");
    shows(&session, &["held, step 0.01"]);
    click(&mut session, "put back");
    press(&mut session, ":explore --x0 5 --y0 5 --angle 0<CR>");
    click(&mut session, "page");
    shows(&session, &["min   mean"]);
    click(&mut session, "close");
    click(&mut session, "q Quit");
    click(&mut session, "yes");
    assert!(session.app().ended());
}
