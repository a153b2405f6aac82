//! The panel beside the matrix: the set, the answer, the shapes with bars, touches.
//!
//! ```text
//! the model                   +--------------------------------------------+
//! its grid, its limit         | Recognise: model figures-30                |
//!                             | grid: 0.01 cells, 1°; 25,200,000 touches   |
//!                             | limit: error 33.0 %, certain 38.3 %        |
//!                             |                                            |
//! the answer                  | hexagon  71.0 %  2 taxels differ at 4.31,  |
//!                             | 4.52, 17.2°                                |
//! what differs                | + 1 surplus, - 1 missing                   |
//! every shape it may be       | hexagon  ████████████████████       71.0 % |
//!                             | octagon  ███████                    29.0 % |
//!                             |                                            |
//! other touches               | 1 touch kept; x forgets                    |
//!                             +--------------------------------------------+
//! ```

use ratatui::layout::Rect;
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::{share, short};
use taxel_core::pose::Axis;
use taxel_core::recognition::AnswerState;
use taxel_files::formats::value::{counted, decimal, percent};

use crate::naming::{nearest_in_words, verdict};
use crate::tui::app::Canvas;
use crate::tui::keys::{Context, action};
use crate::tui::recognise::page::Recognition;
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::widget::Role;
use crate::tui::widget::write::{self, narrow, whole};

const PERCENT: usize = 9;
const NAME: usize = 14;

/// The least probability of a shape in the list.
const LEAST: f64 = 0.001;

/// The lines below the list of shapes that are left free for the kept touches.
const BELOW: usize = 2;

pub(super) fn draw(page: &Recognition, canvas: Canvas<'_>, area: Rect) {
    let line = 0;
    let mut panel = Panel { canvas, area, line };
    panel.text(&format!("Recognise: {}", page.choice()), Role::Title);
    match (&page.preparing, page.model()) {
        (Some(preparing), _) => {
            let doing = if preparing.choice.is_read() {
                "being read"
            } else {
                "being trained"
            };
            let stop = panel.key(&action::CANCEL);
            panel.text(&format!("{doing}; {stop} stops"), Role::Text);
        }
        (None, None) => {
            let again = panel.key(&action::ACCEPT);
            let text = if page.choice().is_read() {
                format!("not read; {again} reads it")
            } else {
                format!("not prepared; {again} prepares it")
            };
            panel.text(&text, Role::Text);
        }
        (None, Some(trained)) => {
            panel.model(trained);
            if let Some(terms) = page.terms.in_words() {
                panel.text(&terms, Role::Text);
            }
            if let Some(threshold) = page.other_threshold() {
                let [own, here] = [trained.model.sensor().threshold(), threshold].map(short);
                let text = format!("trained at threshold {own}; here it is {here}");
                panel.text(&text, Role::Text);
            }
            panel.gap();
            panel.answer(page, trained);
        }
    }
}

/// The panel while it is drawn: its area, and the next line.
struct Panel<'a> {
    canvas: Canvas<'a>,
    area: Rect,
    line: usize,
}

impl Panel<'_> {
    fn text(&mut self, text: &str, role: Role) {
        let rest = write::below(self.area, narrow(self.line));
        if rest.height > 0 {
            let (buffer, theme) = (&mut *self.canvas.buffer, self.canvas.theme);
            self.line += write::wrapped(buffer, rest, theme, text, role);
        }
    }

    /// On a low screen, a line is worth more than a gap.
    fn gap(&mut self) {
        self.line += usize::from(self.area.height >= 16);
    }

    fn key(&self, action: &'static action::Action) -> String {
        self.canvas.keymap.label(Context::Recognise, action)
    }

    /// Writes the grid of a model, and the limit of one touch: the error that no method can go below.
    fn model(&mut self, trained: &TrainedModel) {
        let (ranges, evaluation) = (trained.model.ranges(), &trained.evaluation);
        let steps = format!(
            "grid: {} cells, {}°; {}",
            decimal(ranges[Axis::X0].step(), 4),
            decimal(ranges[Axis::Angle].step(), 4),
            counted(evaluation.touches, "touch"),
        );
        self.text(&steps, Role::Quiet);
        let mut limit = format!("limit: error {}", percent(evaluation.error()));
        if let Some(certainty) = evaluation.certainty {
            let certain = percent(share(certainty.touches, evaluation.touches));
            limit += &format!(", certain {certain}");
        }
        self.text(&limit, Role::Quiet);
    }

    fn answer(&mut self, page: &Recognition, trained: &TrainedModel) {
        if let Some(answer) = &page.answer {
            self.text(&verdict(answer, &trained.model), Role::Title);
            if answer.at_rim {
                self.text("at the rim, perhaps cut off", Role::Text);
            }
            if let Some(nearest) = nearest_in_words(answer, &trained.model) {
                self.text(&format!("nearest: {nearest}"), Role::Text);
            }
            if let Some(other) = page.compared_with() {
                self.text(&legend(&page.present, other), Role::Quiet);
            }
            if answer.state == AnswerState::Unknown && !answer.ranking.is_empty() {
                self.text("if it were one of them:", Role::Quiet);
            }
        } else {
            let touch = self.key(&action::RANDOM_TOUCH);
            let text = format!(
                "The matrix is empty. Draw or place a shape, or press {touch} for a random touch."
            );
            self.text(&text, Role::Text);
        }
        let room = usize::from(self.area.height).saturating_sub(self.line + BELOW);
        if let Some(answer) = &page.answer {
            self.ranking(&answer.ranking, trained, room.max(1));
        }
        if !page.kept.is_empty() {
            let touches = counted(page.kept.len() as u64, "touch");
            let text = format!("{touches} kept; {} forgets", self.key(&action::FORGET));
            self.gap();
            self.text(&text, Role::Text);
        }
    }

    fn ranking(&mut self, ranking: &[(usize, f64)], trained: &TrainedModel, room: usize) {
        let names = ranking.iter().map(|&(shape, _)| trained.name(shape));
        let width = names.map(write::width).fold(0, usize::max).min(NAME);
        let likely = ranking
            .iter()
            .filter(|(_, probability)| *probability >= LEAST);
        let likely = likely.count();
        // If shapes are left out, the last line shows how many.
        let shown = if likely == ranking.len() && likely <= room {
            likely
        } else {
            likely.clamp(1, room.max(2) - 1)
        };
        for &(shape, probability) in &ranking[..shown] {
            self.shape(trained.name(shape), width, probability);
        }
        let rest = ranking.len() - shown;
        if rest > 0 {
            self.text(&format!("and {rest} more"), Role::Quiet);
        }
    }

    fn shape(&mut self, name: &str, width: usize, probability: f64) {
        let row = write::row(self.area, self.line);
        self.line += 1;
        let name = write::fitted(name, width, self.canvas.theme);
        let gap = " ".repeat(width.saturating_sub(write::width(&name)) + 1);
        let label = format!("{name}{gap}");
        let room = usize::from(row.width).saturating_sub(width + 1 + PERCENT);
        // A value above 0 has at least one column.
        let full = usize::from(whole((probability * f64::from(narrow(room))).round()));
        let full = full.clamp(usize::from(probability > 0.0).min(room), room);
        let [filled, _, _] = self.canvas.theme.bar();
        let bar = filled.to_string().repeat(full) + &" ".repeat(room - full);
        let percent = format!("{:>PERCENT$}", percent(probability));
        let [label, percent] = [&label, &percent].map(|text| (&**text, Role::Text));
        self.canvas
            .line(row, [label, (&bar, Role::Chosen), percent]);
    }
}

/// Says how many taxels have each mark of a comparison.
pub(crate) fn legend(present: &Imprint, other: &Imprint) -> String {
    let surplus = present.without(other).count();
    let missing = other.without(present).count();
    match (surplus, missing) {
        (_, 0) => format!("+ {surplus} surplus"),
        (0, _) => format!("- {missing} missing"),
        _ => format!("+ {surplus} surplus, - {missing} missing"),
    }
}
