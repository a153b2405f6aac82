//! The panel beside the matrix: the set, the shapes with bars, the nearest imprint, the pose, touches.
//!
//! ```text
//! the model                   +--------------------------------------------+
//! its grid, its limit         | Recognise: model figures-30                |
//!                             | grid: 0.01 cells, 1°; 25,200,000 touches   |
//!                             | limit: error 33.0 %, certain 38.3 %        |
//!                             |                                            |
//! the answer in a word        | likely: hexagon                            |
//! every shape it may be       | hexagon  ████████████████████       71.0 % |
//!                             | octagon  ███████                    29.0 % |
//!                             |                                            |
//! where a touch is not known, | nearest: hexagon, 2 taxels differ          |
//! what is most like it        | + surplus, - missing                       |
//! where the shape lies        | centre 7.51 ± 0.08, 7.48 ± 0.11 cells      |
//!                             +--------------------------------------------+
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::{differing, share, short};
use taxel_core::pose::Axis;
use taxel_core::recognition::{Answer, AnswerState, Nearest, PoseEstimate};
use taxel_files::formats::value::{self, counted, decimal, grouped, percent};

use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, Page, PoseLayer, Slot};
use crate::tui::app::state::App;
use crate::tui::explore::work::gauge;
use crate::tui::keys::action;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::recognise::state::{
    ModelState, PoseSearchResult, Preparation, RecogniseMessage, Recognition,
};
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

const PERCENT: usize = 9;

const NAME: usize = 14;

/// The lines below the list of shapes that are always left free, so that the list has the same length for nearly all
/// touches.
const BELOW: usize = 6;

impl Page for Recognition {
    /// Messages go to the page that stands for it.
    fn on(&mut self, _: &mut App, _: &Message) -> Flow {
        Flow::Stay
    }

    fn context(&self) -> Context {
        Context::Recognise
    }

    fn slot(&self) -> Slot {
        Slot::Panel
    }

    fn draw(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let mut panel = Panel {
            theme,
            keymap,
            buffer,
            area,
            line: 0,
        };
        let title = format!("Recognise: {}", self.choice());
        panel.text(&title, Role::Title);
        match self.state() {
            ModelState::Missing => {
                let again = panel.key(&action::ACCEPT);
                let text = if self.choice().is_read() {
                    format!("not read; {again} reads it")
                } else {
                    format!("not prepared; {again} prepares it")
                };
                panel.text(&text, Role::Text);
            }
            ModelState::Preparing(_) if self.choice().is_read() => {
                panel.text("being read", Role::Text);
            }
            ModelState::Preparing(preparation) => panel.preparation(preparation),
            ModelState::Ready(trained) => {
                panel.model(trained);
                if let Some(threshold) = self.other_threshold() {
                    panel.threshold(trained, threshold);
                }
                panel.gap();
                panel.answer(self, trained);
                for text in panel.touches(self) {
                    panel.gap();
                    panel.text(&text, Role::Text);
                }
            }
        }
        None
    }

    fn compared_with(&self) -> Option<&Imprint> {
        let nearest = self.found()?.nearest.as_ref()?;
        (nearest.distance > 0).then_some(&nearest.imprint)
    }

    fn poses(&self) -> PoseLayer<'_> {
        PoseLayer {
            sources: self.found().map_or(&[], |found| &found.poses),
            shown: self.outlines(),
        }
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        match message {
            Message::Recognise(RecogniseMessage::Keep) => {
                !self.present().is_empty() && !self.is_kept()
            }
            Message::Recognise(RecogniseMessage::Forget) => self.kept() > 0,
            Message::Recognise(RecogniseMessage::Touch | RecogniseMessage::Confusion) => {
                !matches!(self.state(), ModelState::Missing)
            }
            _ => true,
        }
    }

    fn leaves_matrix(&self) -> bool {
        true
    }

    fn cancels_itself(&self) -> bool {
        true
    }
}

/// The panel while it is drawn: its area, and the next line.
struct Panel<'a> {
    theme: &'a Theme,
    keymap: &'a Keymap,
    buffer: &'a mut Buffer,
    area: Rect,
    line: usize,
}

impl Panel<'_> {
    fn text(&mut self, text: &str, role: Role) {
        let rest = write::below(self.area, narrow(self.line));
        if rest.height > 0 {
            self.line += write::wrapped(self.buffer, rest, self.theme, text, role);
        }
    }

    fn lines_of(&self, text: &str) -> usize {
        write::broken(&self.theme.text(text), usize::from(self.area.width)).len()
    }

    fn gap(&mut self) {
        self.line += self.gap_lines();
    }

    fn gap_lines(&self) -> usize {
        usize::from(self.area.height >= 16)
    }

    fn key(&self, action: &'static action::Action) -> String {
        self.keymap.label(Context::Recognise, action)
    }

    fn preparation(&mut self, preparation: &Preparation) {
        let Some(poses) = preparation.poses else {
            return self.text("being prepared", Role::Text);
        };
        let percent = u128::from(preparation.done) * 100 / u128::from(poses.max(1));
        let text = format!("training: {}, {percent} %", counted(poses, "pose"));
        self.text(&text, Role::Text);
        let row = write::row(self.area, self.line);
        gauge(self.theme, preparation.done, poses, self.buffer, row);
        self.line += 1;
        let stop = self.key(&action::CANCEL);
        let text = if preparation.stopping {
            "stopping".to_owned()
        } else {
            format!("{stop} stops")
        };
        self.text(&text, Role::Quiet);
    }

    /// Writes the grid of a model, and the limit of one touch: the error that no method can go below.
    fn model(&mut self, trained: &TrainedModel) {
        let (model, evaluation) = (&trained.model, &trained.evaluation);
        let ranges = model.ranges();
        let steps = format!(
            "grid: {} cells, {}°; {}",
            decimal(ranges[Axis::X0].step(), 4),
            decimal(ranges[Axis::Angle].step(), 4),
            counted(evaluation.touches, "touch"),
        );
        self.text(&steps, Role::Quiet);
        let mut limit = format!("error {}", percent(evaluation.error()));
        if let Some(certainty) = evaluation.certainty {
            let certain = percent_of(certainty.touches, evaluation.touches);
            limit += &format!(", certain {certain}");
        }
        let [long, short] = ["limit of one touch", "limit"].map(|what| format!("{what}: {limit}"));
        // If even the shorter text needs two lines, the longer one says more.
        let limits = [&*long, &*short, &*long];
        let limit = write::first_fitting(&limits, self.area.width.into());
        self.text(limit, Role::Quiet);
        if let Some((unknown, tried)) = trained.unknown_between {
            let text = format!(
                "between the trained poses, {} of {} touches are unknown",
                percent_of(unknown.into(), tried.into()),
                grouped(tried)
            );
            self.text(&text, Role::Quiet);
        }
    }

    fn threshold(&mut self, trained: &TrainedModel, threshold: f64) {
        let [trained, here] = [trained.model.sensor().threshold(), threshold].map(short);
        let text = format!("trained at threshold {trained}; here it is {here}");
        self.text(&text, Role::Text);
    }

    fn answer(&mut self, page: &Recognition, trained: &TrainedModel) {
        let Some(answer) = page.answer() else {
            let touch = self.key(&action::RANDOM_TOUCH);
            let text = format!(
                "The matrix is empty. Draw or place a shape, or press {touch} for a random touch."
            );
            return self.text(&text, Role::Text);
        };
        let verdict = verdict(answer, page.touches().len(), trained);
        self.text(&verdict, Role::Title);
        let names = answer.ranking.iter().map(|&(shape, _)| trained.name(shape));
        let name = names.map(write::width).fold(0, usize::max).min(NAME);
        // Lines about the touch take precedence over the list.
        let found = page.found().into_iter();
        let found: Vec<_> = found
            .flat_map(|found| self.search_lines(page.present(), found, answer, trained))
            .collect();
        let kept = self.touches(page);
        let texts = found.iter().map(|(text, _)| text);
        let lines = texts.chain(&kept).map(|text| self.lines_of(text));
        let gaps = (1 + kept.len()) * self.gap_lines();
        let below = (lines.sum::<usize>() + gaps).max(BELOW);
        let room = usize::from(self.area.height)
            .saturating_sub(self.line + below)
            .max(1);
        // If shapes are left out, the last line shows how many.
        let room = if answer.ranking.len() > room {
            (room - 1).max(1)
        } else {
            room
        };
        for &(shape, probability) in answer.ranking.iter().take(room) {
            self.shape(trained.name(shape), name, probability);
        }
        let rest = answer.ranking.len().saturating_sub(room);
        if rest > 0 {
            self.text(&format!("and {rest} more"), Role::Quiet);
        }
        if !found.is_empty() {
            self.gap();
        }
        for (text, role) in found {
            self.text(&text, role);
        }
    }

    fn search_lines(
        &self,
        present: &Imprint,
        found: &PoseSearchResult,
        answer: &Answer,
        trained: &TrainedModel,
    ) -> Vec<(String, Role)> {
        let mut lines = Vec::new();
        match &found.nearest {
            None => {
                let text = "no imprint of the model fits the matrix".to_owned();
                lines.push((text, Role::Text));
            }
            Some(nearest) if nearest.distance > 0 => {
                let (name, differ) = (trained.name(nearest.shape), differing(nearest.distance));
                lines.push((format!("nearest: {name}, {differ}"), Role::Text));
                lines.push((legend(present, nearest), Role::Quiet));
            }
            Some(_) => {}
        }
        if let Some((shape, pose)) = &found.pose {
            // If shapes are tied, the pose is that of the first.
            let is_named = answer.state != AnswerState::Tied && answer.shape == Some(*shape);
            let whose = if is_named { "" } else { trained.name(*shape) };
            let mut position = position_line(whose, pose, " cells");
            // If lines are scarce, a line is worth more than the unit.
            if self.gap_lines() == 0 && self.lines_of(&position) > 1 {
                position = position_line(whose, pose, "");
            }
            let [angle, poses] = angle_lines(pose);
            lines.extend([position, angle, poses].map(|line| (line, Role::Text)));
        }
        lines
    }

    fn shape(&mut self, name: &str, width: usize, probability: f64) {
        let row = write::row(self.area, self.line);
        self.line += 1;
        let name = write::fitted(name, width, self.theme);
        let gap = " ".repeat(width.saturating_sub(write::width(&name)) + 1);
        let bar = usize::from(row.width).saturating_sub(width + 1 + PERCENT);
        let (full, empty) = bar_of(probability, bar);
        let [filled, _, _] = self.theme.bar();
        let bar = filled.to_string().repeat(full) + &" ".repeat(empty);
        let pieces = [
            (&*name, Role::Text),
            (gap.as_str(), Role::Text),
            (bar.as_str(), Role::Chosen),
            (&format!("{:>PERCENT$}", percent(probability)), Role::Text),
        ];
        write::line(self.buffer, row, self.theme, pieces);
    }

    fn touches(&self, page: &Recognition) -> Vec<String> {
        let mut lines = Vec::new();
        if page.kept() > 0 {
            let touches = counted(page.kept() as u64, "touch");
            let forget = self.key(&action::FORGET);
            lines.push(format!("{touches} kept; {forget} forgets"));
        }
        lines
    }
}

fn verdict(answer: &Answer, touches: usize, trained: &TrainedModel) -> String {
    let state = answer.state.name();
    let names: Vec<&str> = match answer.state {
        AnswerState::Tied => answer.tied.iter().map(|&tied| trained.name(tied)).collect(),
        _ => answer
            .shape
            .iter()
            .map(|&shape| trained.name(shape))
            .collect(),
    };
    let what = if names.is_empty() {
        let these = if touches > 1 {
            "all of these"
        } else {
            "this imprint"
        };
        format!(": no shape leaves {these}")
    } else {
        format!(": {}", names.join(", "))
    };
    let rim = if answer.at_rim {
        " (at the rim, perhaps cut off)"
    } else {
        ""
    };
    format!("{state}{what}{rim}")
}

fn legend(present: &Imprint, nearest: &Nearest) -> String {
    let differing = present.differing(&nearest.imprint);
    let surplus = differing.active();
    let surplus = surplus.filter(|&(column, row)| present.get(column, row));
    let surplus = surplus.count();
    let missing = differing.count() as usize - surplus;
    let [add, remove] = MARKS;
    match (surplus, missing) {
        (_, 0) => format!("{add} {surplus} surplus"),
        (0, _) => format!("{remove} {missing} missing"),
        _ => format!("{add} {surplus} surplus, {remove} {missing} missing"),
    }
}

const MARKS: [char; 2] = ['+', '-'];

/// Returns the line about the position of a shape: mean and spread over the poses that leave the imprint. `whose` is the
/// name of the shape if the answer does not name it, otherwise empty. `unit` is what follows the numbers.
fn position_line(whose: &str, pose: &PoseEstimate, unit: &str) -> String {
    let line = format!("{whose} centre {}{unit}", value::pose_centre(pose, 1.0));
    line.trim_start().to_owned()
}

/// Returns the lines about the angle of a shape: mean and spread, and the number of poses that leave the imprint.
fn angle_lines(pose: &PoseEstimate) -> [String; 2] {
    let poses = counted(pose.poses, "pose");
    let any = || ("any angle".to_owned(), poses.clone());
    let (angle, poses) = pose.angle.as_ref().map_or_else(any, |angle| {
        let Some((mean, spread)) = angle.known() else {
            return any();
        };
        let (mean, spread) = (decimal(half_up(mean), 0), value::pose_spread(spread, 1));
        (
            format!("angle {mean}° ± {spread}°{}", value::pose_repeats(angle)),
            value::pose_arc(angle, pose.poses),
        )
    });
    [angle, poses]
}

/// Rounds a number to a whole one, with a half rounded up. Formatting alone would make 22 of 22.5 and 24 of 23.5, and
/// symmetric shapes often have such a mean.
fn half_up(number: f64) -> f64 {
    (number + 0.5).floor()
}

fn percent_of(part: u128, whole: u128) -> String {
    percent(share(part, whole))
}

/// Returns the numbers of full and of empty columns of a bar; a value above 0 has at least one full column.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "up to the columns of a screen"
)]
fn bar_of(share: f64, width: usize) -> (usize, usize) {
    let full = (share * width as f64).round() as usize;
    let full = full.clamp(usize::from(share > 0.0).min(width), width);
    (full, width - full)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_probability_still_has_a_bar() {
        assert_eq!(bar_of(0.0001, 10), (1, 9));
        assert_eq!(bar_of(1.0, 0), (0, 0));
        assert_eq!(bar_of(0.5, 10), (5, 5));
    }

    #[test]
    fn half_a_degree_is_rounded_up() {
        let shown = [22.5, 23.5, 22.49, -0.5, -1.2].map(|mean| decimal(half_up(mean), 0));
        assert_eq!(shown, ["23", "24", "22", "0", "-1"]);
    }
}
