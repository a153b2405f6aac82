//! What a model says about the touches: the shapes they may be of, and for the touch on the matrix the nearest imprint
//! and the poses that leave it, which a job searches for.

use std::sync::Arc;

use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::differing;
use taxel_core::recognition::{Answer, AnswerState, Nearest, PlacedSource, PoseEstimate};
use taxel_files::formats::value::{self, counted, decimal};
use taxel_files::memory::MemoryGuard;

use crate::tui::jobs::JobProgress;
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::widget::theme::Role;

/// The largest number of poses whose outlines are drawn; more cannot be told apart over a matrix.
const POSES: usize = 13;

#[derive(Clone)]
pub(super) struct PoseSearch {
    pub(super) trained: Arc<TrainedModel>,
    pub(super) imprint: Imprint,
    /// The shape that the answer names.
    pub(super) named: Option<usize>,
}

impl PartialEq for PoseSearch {
    fn eq(&self, other: &Self) -> bool {
        let same_model = Arc::ptr_eq(&self.trained, &other.trained);
        same_model && (self.imprint, self.named) == (other.imprint, other.named)
    }
}

pub(super) struct Found {
    pub(super) nearest: Option<Nearest>,
    /// The named shape, or that of the nearest imprint if none is named, and the poses in which it leaves the nearest
    /// imprint.
    pub(super) pose: Option<(usize, PoseEstimate)>,
    pub(super) poses: Vec<PlacedSource>,
    pub(super) refused: Option<String>,
}

impl PoseSearch {
    pub(super) fn run(&self, progress: &JobProgress) -> Found {
        let model = &self.trained.model;
        let nearest = model.nearest(&self.imprint);
        let memory = MemoryGuard::new(None, "train the model in coarser steps to see poses");
        let found = memory.limit(progress, |progress| {
            let nearest = nearest.as_ref()?;
            let shape = self.named.unwrap_or(nearest.shape);
            let (pose, poses) = model.poses_of(shape, &nearest.imprint, POSES, progress)?;
            Some(((shape, pose), poses))
        });
        let refused = found.as_ref().err().cloned();
        let (pose, poses) = found.ok().flatten().unzip();
        Found {
            nearest,
            pose,
            poses: poses.unwrap_or_default(),
            refused,
        }
    }
}

/// Returns the answer in a word, and the shapes that it names.
pub(super) fn verdict(answer: &Answer, touches: usize, trained: &TrainedModel) -> String {
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
    let rim = if answer.at_rim {
        " (at the rim, perhaps cut off)"
    } else {
        ""
    };
    format!("{}: {what}{rim}", answer.state.name())
}

/// Returns the lines about the touch on the matrix.
pub(super) fn details(
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
        let centre = format!("centre {} cells", value::pose_centre(pose, 1.0));
        // If shapes are tied, the pose is that of the first.
        let is_named = answer.state != AnswerState::Tied && answer.shape == Some(*shape);
        let centre = if is_named {
            centre
        } else {
            format!("{} {centre}", trained.name(*shape))
        };
        lines.push((centre, Role::Text));
        lines.extend(angle(pose).map(|line| (line, Role::Text)));
    }
    lines
}

fn legend(present: &Imprint, nearest: &Nearest) -> String {
    let differing = present.differing(&nearest.imprint);
    let surplus = differing.active();
    let surplus = surplus.filter(|&(column, row)| present.get(column, row));
    let surplus = surplus.count();
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
