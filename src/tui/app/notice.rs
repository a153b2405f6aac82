//! The notice at the bottom of the screen, and the area that it leaves to a page.

use ratatui::layout::Rect;

use crate::tui::app::dialog::{Dialog, Question};
use crate::tui::app::layout::Panes;
use crate::tui::app::page::{Page, Slot};
use crate::tui::app::state::{App, Notice};
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// A question stands after the notice.
pub fn notice(app: &App, panes: &Panes, top: Option<&dyn Page>) -> Option<(String, Role)> {
    if let Some(Dialog::Question(question)) = app.dialogs.last() {
        return Some((asked(app, panes, question), Role::Error));
    }
    let remark = top.and_then(|page| page.remark(app.keymap(), panes.body));
    let notice = app.notice.as_ref().map(|notice| match notice {
        Notice::Info(text) => (text.clone(), Role::Key),
        Notice::Refusal(text) | Notice::Failure(text) => (format!("! {text}"), Role::Error),
    });
    let waiting = || Some((app.waiting()?.to_owned(), Role::Key));
    let notice = notice.or_else(waiting);
    match (notice, top.and_then(Page::alarm)) {
        (Some((text, Role::Error)), Some(alarm)) => Some((format!("{text}; {alarm}"), Role::Error)),
        // The mark of an error stands before the error alone.
        (Some((text, _)), Some(alarm)) => Some((format!("{text}; ! {alarm}"), Role::Error)),
        (notice, _) => notice.or(remark),
    }
}

/// Returns a question with its answers, after the notice. Where there is too little room, the notice is left out,
/// then the sentences before the question: the answers are always there.
fn asked(app: &App, panes: &Panes, question: &Question) -> String {
    let answers = question.answers(app.keymap());
    // A question without sentences before it may be too long itself: it has a name in it.
    let (start, end) = match question.about.as_str() {
        "" => (&*question.text, answers),
        about => (about, format!("{} {answers}", question.text)),
    };
    let room = panes.notice.bottom().saturating_sub(panes.body.y);
    let fits = |text: &String| lines(app, panes, text) <= usize::from(room);
    let said = match &app.notice {
        Some(Notice::Info(said) | Notice::Refusal(said) | Notice::Failure(said)) => {
            format!("{said}. ")
        }
        None => String::new(),
    };
    let texts = [format!("{said}{start} {end}"), format!("{start} {end}")];
    texts.into_iter().find(fits).unwrap_or(end)
}

fn lines(app: &App, panes: &Panes, text: &str) -> usize {
    write::broken(&app.theme().text(text), usize::from(panes.notice.width)).len()
}

/// A prompt keeps its line, and the notice stands above it.
pub fn block(app: &App, panes: &Panes, text: &str) -> Rect {
    let is_typed = |page: &dyn Page| page.slot() == Slot::Prompt;
    let is_typed = app.top_page().is_some_and(is_typed);
    let last = Rect {
        y: panes.notice.y - u16::from(is_typed),
        ..panes.notice
    };
    let lines = lines(app, panes, text);
    let room = last.bottom().saturating_sub(panes.body.y);
    let height = u16::try_from(lines).unwrap_or(room).clamp(1, room.max(1));
    Rect {
        y: last.bottom() - height,
        height,
        ..last
    }
}

pub fn page_area(app: &App, panes: &Panes, page: &dyn Page) -> Rect {
    let area = panes.area(page.slot());
    if !page.makes_room() {
        return area;
    }
    let top = app.top_page();
    let over = top.filter(|top| matches!(top.slot(), Slot::Prompt | Slot::Question));
    let text = notice(app, panes, over.or(Some(page))).map(|(text, _)| text);
    let end = text.map_or(area.bottom(), |text| block(app, panes, &text).y);
    Rect {
        height: end.min(area.bottom()).saturating_sub(area.y),
        ..area
    }
}
