//! How touches are named on the command line and on the screen: the terms of an answer, and the answer in a line.

use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::{differing, short};
use taxel_core::recognition::{Answer, AnswerState, Evidence, Fit, Model, Noise};
use taxel_files::formats::value::percent;

/// On what terms touches are named: those of [`Evidence`]. None and the default leave all to the model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Terms {
    /// The probability that a taxel flips, from 0 to below ½ as of [`Noise`]; 0 asks for the poses of the model alone.
    pub noise: Option<f64>,
    /// A shape fits if at most this many taxels differ.
    pub tolerance: Option<u32>,
    pub reject_below: Option<f64>,
}

impl Terms {
    /// Names the shape that left some touches. The active taxels of `dead` are left out, such as the masked cells of a
    /// frame.
    pub fn answer(&self, model: &Model, touches: &[Imprint], dead: Option<&Imprint>) -> Answer {
        let noise = self.noise.and_then(|flip| Noise::new(flip).ok());
        let mut evidence = Evidence::of(touches).under(noise.as_ref()).without(dead);
        (evidence.tolerance, evidence.reject_below) = (self.tolerance, self.reject_below);
        model.recognise(evidence)
    }

    /// The probability of a flip under which shapes are ranked.
    pub(crate) fn flip(&self) -> f64 {
        self.noise.unwrap_or(Noise::default().flip())
    }

    /// The noise and the tolerance, if any is set: `noise 0.02, tolerance 3`.
    pub(crate) fn in_words(&self) -> Option<String> {
        let noise = self.noise.map(|flip| format!("noise {}", short(flip)));
        let tolerance = self.tolerance.map(|taxels| format!("tolerance {taxels}"));
        let set: Vec<String> = noise.into_iter().chain(tolerance).collect();
        (!set.is_empty()).then(|| set.join(", "))
    }
}

/// The answer: the shape, its probability and how well it fits, or why there is no shape.
/// ```text
/// washer  99.8 %  fits exactly at 8.00, 8.13, 29.3°
/// none of these: nearest washer, 9 taxels differ
/// ```
/// The position is x0 and y0, in as many decimals as the fit has; so is the angle.
pub(crate) fn verdict(answer: &Answer, model: &Model) -> String {
    let name = |shape: usize| model.shapes()[shape].name.as_str();
    let fit = answer
        .fit
        .as_ref()
        .map(|fit| format!("  {}", in_words(fit)));
    let fit = fit.unwrap_or_default();
    let likely = |shape: usize| {
        let found = answer.ranking.iter().find(|&&(own, _)| own == shape);
        percent(found.map_or(0.0, |&(_, probability)| probability))
    };
    match (answer.state, answer.shape, &answer.fit) {
        (AnswerState::Tied, ..) => {
            let tied: Vec<&str> = answer.tied.iter().map(|&shape| name(shape)).collect();
            let fit = answer.fit.as_ref();
            let fit = fit.map(|fit| format!("; {}: {}", name(fit.shape), in_words(fit)));
            format!("{}: tied{}", tied.join(" or "), fit.unwrap_or_default())
        }
        (AnswerState::Rejected, ..) => {
            let likeliest = answer.ranking.first().map(|&(shape, _)| shape);
            let shape = answer.fit.as_ref().map(|fit| fit.shape).or(likeliest);
            let (name, likely) = shape.map_or(("", String::new()), |own| (name(own), likely(own)));
            format!("rejected: {name} reaches only {likely}{fit}")
        }
        (AnswerState::Certain, Some(shape), _) => {
            format!("{}  {}{fit}  certain", name(shape), likely(shape))
        }
        (_, Some(shape), _) => format!("{}  {}{fit}", name(shape), likely(shape)),
        (_, None, Some(fit)) => {
            let (name, differ) = (name(fit.shape), differing(fit.differs));
            format!("none of these: nearest {name}, {differ}")
        }
        // Without a fit, the ranking has the shapes that leave the touches in the poses of the model.
        (_, None, None) => match &answer.nearest {
            None => "unknown: no imprint of the model fits on a matrix of this size",
            Some(_) if !answer.ranking.is_empty() => {
                "unknown: no shape could be fitted; perhaps an imprint is empty"
            }
            Some(nearest) if nearest.distance > 0 => "unknown: no trained pose leaves this imprint",
            Some(_) => "unknown: no shape leaves all of these imprints in its trained poses",
        }
        .to_owned(),
    }
}

/// The nearest imprint of the model, if it is another one and nothing was fitted: the verdict says how many taxels differ
/// from a fit.
pub(crate) fn nearest_in_words(answer: &Answer, model: &Model) -> Option<String> {
    let nearest = answer.nearest.as_ref().filter(|_| answer.fit.is_none())?;
    let name = &model.shapes()[nearest.shape].name;
    let differ = differing(nearest.distance);
    (nearest.distance > 0).then(|| format!("{name}, {differ}"))
}

fn in_words(fit: &Fit) -> String {
    let at = |parameter, decimals: usize| {
        let value = fit.source.get(parameter).unwrap_or_default();
        let rounded = format!("{value:.decimals$}");
        let is_all = rounded.parse() == Ok(value);
        if is_all { rounded } else { short(value) }
    };
    let (x0, y0) = (at(Parameter::X0, 2), at(Parameter::Y0, 2));
    let angle = at(Parameter::Angle, 1);
    let fits = match fit.differs {
        0 => "fits exactly".to_owned(),
        differs => differing(differs),
    };
    format!("{fits} at {x0}, {y0}, {angle}°")
}
