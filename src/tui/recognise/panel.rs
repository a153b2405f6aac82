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

use ratatui::layout::{Position, Rect};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::{differing, share, short};
use taxel_core::pose::Axis;
use taxel_core::recognition::{Answer, AnswerState, Nearest, PoseEstimate};
use taxel_files::formats::value::{self, counted, decimal, grouped, percent};

use crate::tui::app::message::Message;
use crate::tui::app::page::{Canvas, Flow, Page, Place, PoseLayer};
use crate::tui::app::state::App;
use crate::tui::explore::work::gauge;
use crate::tui::keys::action;
use crate::tui::keys::keymap::Context;
use crate::tui::recognise::RecogniseMessage;
use crate::tui::recognise::page::{Preparation, Recognition};
use crate::tui::recognise::trained::{Found, TrainedModel};
use crate::tui::widget::theme::Role;
use crate::tui::widget::write::{self, narrow};

const PERCENT: usize = 9;
const NAME: usize = 14;

/// The lines below the list of shapes that are always left free, so that the list has the same length for nearly all
/// touches.
const BELOW: usize = 6;

impl Page for Recognition {
    fn on(&mut self, _: &mut App, _: &Message) -> Flow {
        Flow::Stay
    }

    fn context(&self) -> Context {
        Context::Recognise
    }

    fn place(&self) -> Place {
        Place::Panel
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let line = 0;
        let mut panel = Panel { canvas, area, line };
        panel.text(&format!("Recognise: {}", self.choice()), Role::Title);
        match (&self.preparing, self.model()) {
            (Some(preparing), _) => panel.preparation(preparing),
            (None, None) => {
                let again = panel.key(&action::ACCEPT);
                let text = if self.choice().is_read() {
                    format!("not read; {again} reads it")
                } else {
                    format!("not prepared; {again} prepares it")
                };
                panel.text(&text, Role::Text);
            }
            (None, Some(trained)) => {
                panel.model(trained);
                if let Some(threshold) = self.other_threshold() {
                    let [own, here] = [trained.model.sensor().threshold(), threshold].map(short);
                    let text = format!("trained at threshold {own}; here it is {here}");
                    panel.text(&text, Role::Text);
                }
                panel.gap();
                panel.answer(self, trained);
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
            shown: self.outlines,
        }
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        match message {
            Message::Recognise(RecogniseMessage::Keep) => self.is_new_touch(),
            Message::Recognise(RecogniseMessage::Forget) => !self.kept.is_empty(),
            Message::Recognise(RecogniseMessage::Touch | RecogniseMessage::Confusion) => {
                self.preparing.is_some() || self.model().is_some()
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

    fn lines_of(&self, text: &str) -> usize {
        write::broken(&self.canvas.theme.text(text), self.area.width.into()).len()
    }

    fn gap(&mut self) {
        self.line += self.gap_lines();
    }

    /// On a low screen, a line is worth more than a gap.
    fn gap_lines(&self) -> usize {
        usize::from(self.area.height >= 16)
    }

    fn key(&self, action: &'static action::Action) -> String {
        self.canvas.keymap.label(Context::Recognise, action)
    }

    fn preparation(&mut self, preparing: &Preparation) {
        if preparing.choice.is_read() {
            return self.text("being read", Role::Text);
        }
        let Some(poses) = preparing.poses else {
            return self.text("being prepared", Role::Text);
        };
        let percent = u128::from(preparing.done) * 100 / u128::from(poses.max(1));
        let text = format!("training: {}, {percent} %", counted(poses, "pose"));
        self.text(&text, Role::Text);
        let row = write::row(self.area, self.line);
        gauge(&mut self.canvas, preparing.done, poses, row);
        self.line += 1;
        let text = if preparing.stopping {
            "stopping".to_owned()
        } else {
            format!("{} stops", self.key(&action::CANCEL))
        };
        self.text(&text, Role::Quiet);
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
        if let Some((unknown, tried)) = trained.unknown_between {
            let text = format!(
                "between the trained poses, {} of {} touches are unknown",
                percent(share(unknown.into(), tried.into())),
                grouped(tried)
            );
            self.text(&text, Role::Quiet);
        }
    }

    /// Lines about the touch take precedence over the list of shapes.
    fn answer(&mut self, page: &Recognition, trained: &TrainedModel) {
        let mut below = Vec::new();
        if let Some(answer) = &page.answer {
            let verdict = verdict(answer, page.touches().len(), trained);
            self.text(&verdict, Role::Title);
            if let Some(found) = page.found() {
                below = details(&page.present, found, answer, trained);
            }
        } else {
            let touch = self.key(&action::RANDOM_TOUCH);
            let text = format!(
                "The matrix is empty. Draw or place a shape, or press {touch} for a random touch."
            );
            self.text(&text, Role::Text);
        }
        let kept = (!page.kept.is_empty()).then(|| {
            let touches = counted(page.kept.len() as u64, "touch");
            format!("{touches} kept; {} forgets", self.key(&action::FORGET))
        });
        let texts = below.iter().map(|(text, _)| text).chain(&kept);
        let lines: usize = texts.map(|text| self.lines_of(text)).sum();
        let lines = lines + (1 + usize::from(kept.is_some())) * self.gap_lines();
        let room = usize::from(self.area.height).saturating_sub(self.line + lines.max(BELOW));
        if let Some(answer) = &page.answer {
            self.ranking(&answer.ranking, trained, room.max(1));
        }
        if !below.is_empty() {
            self.gap();
        }
        for (text, role) in below {
            self.text(&text, role);
        }
        if let Some(kept) = kept {
            self.gap();
            self.text(&kept, Role::Text);
        }
    }

    fn ranking(&mut self, ranking: &[(usize, f64)], trained: &TrainedModel, room: usize) {
        let names = ranking.iter().map(|&(shape, _)| trained.name(shape));
        let width = names.map(write::width).fold(0, usize::max).min(NAME);
        // If shapes are left out, the last line shows how many.
        let room = (room - usize::from(ranking.len() > room)).max(1);
        for &(shape, probability) in ranking.iter().take(room) {
            self.shape(trained.name(shape), width, probability);
        }
        let rest = ranking.len().saturating_sub(room);
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
        let full = full_columns(probability, room);
        let [filled, _, _] = self.canvas.theme.bar();
        let bar = filled.to_string().repeat(full) + &" ".repeat(room - full);
        let percent = format!("{:>PERCENT$}", percent(probability));
        let [label, percent] = [&label, &percent].map(|text| (&**text, Role::Text));
        self.canvas
            .line(row, [label, (&bar, Role::Chosen), percent]);
    }
}

/// Returns the answer in a word, and the shapes that it names.
fn verdict(answer: &Answer, touches: usize, trained: &TrainedModel) -> String {
    let named = match answer.state {
        AnswerState::Tied => &answer.tied[..],
        _ => answer.shape.as_slice(),
    };
    let names: Vec<&str> = named.iter().map(|&shape| trained.name(shape)).collect();
    let what = match (names.is_empty(), touches) {
        (false, _) => names.join(", "),
        (true, ..=1) => "no shape leaves this imprint".to_owned(),
        (true, _) => "no shape leaves all of these".to_owned(),
    };
    let mut text = format!("{}: {what}", answer.state.name());
    if answer.at_rim {
        text += " (at the rim, perhaps cut off)";
    }
    text
}

/// Returns the lines about the touch on the matrix.
fn details(
    present: &Imprint,
    found: &Found,
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
        let mut centre = format!("centre {} cells", value::pose_centre(pose, 1.0));
        // If shapes are tied, the pose is that of the first.
        if answer.state == AnswerState::Tied || answer.shape != Some(*shape) {
            centre = format!("{} {centre}", trained.name(*shape));
        }
        lines.push((centre, Role::Text));
        lines.extend(angle(pose).map(|line| (line, Role::Text)));
    }
    lines
}

fn legend(present: &Imprint, nearest: &Nearest) -> String {
    let differing = present.differing(&nearest.imprint);
    let is_surplus = |&(column, row): &(u8, u8)| present.get(column, row);
    let surplus = differing.active().filter(is_surplus).count();
    let missing = differing.count() as usize - surplus;
    match (surplus, missing) {
        (_, 0) => format!("+ {surplus} surplus"),
        (0, _) => format!("- {missing} missing"),
        _ => format!("+ {surplus} surplus, - {missing} missing"),
    }
}

/// Returns mean and spread of the angle, and how many poses leave the imprint.
fn angle(pose: &PoseEstimate) -> [String; 2] {
    let known = pose.angle.as_ref();
    let known = known.and_then(|angle| Some((angle, angle.known()?)));
    let Some((angle, (mean, spread))) = known else {
        return ["any angle".to_owned(), counted(pose.poses, "pose")];
    };
    // A half is rounded up: symmetric shapes often have such a mean, and formatting alone rounds to even.
    let (mean, spread) = (
        decimal((mean + 0.5).floor(), 0),
        value::pose_spread(spread, 1),
    );
    let repeats = value::pose_repeats(angle);
    [
        format!("angle {mean}° ± {spread}°{repeats}"),
        value::pose_arc(angle, pose.poses),
    ]
}

/// Returns the full columns of a bar; a value above 0 has at least one.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_precision_loss,
    reason = "up to the columns of a screen"
)]
fn full_columns(share: f64, width: usize) -> usize {
    let full = (share * width as f64).round() as usize;
    full.clamp(usize::from(share > 0.0).min(width), width)
}
