//! The answer of recognition in a line, the same on the screen and on the command line.

use taxel_core::parameter::Parameter;
use taxel_core::parameter::number::{differing, short};
use taxel_core::recognition::{Answer, AnswerState, Fit, Model};
use taxel_files::formats::value::percent;

/// The answer: the shape, its probability and how well it fits, or why there is no shape.
/// ```text
/// washer  99.8 %  fits exactly at 8.00, 8.13, 29.3°
/// none of these: nearest washer, 9 taxels differ
/// ```
/// The position is x0 and y0, in as many decimals as the fit has.
pub(crate) fn verdict(answer: &Answer, model: &Model) -> String {
    let name = |shape: usize| model.shapes()[shape].name.as_str();
    let probability = |shape: usize| {
        let found = answer.ranking.iter().find(|&&(own, _)| own == shape);
        percent(found.map_or(0.0, |&(_, probability)| probability))
    };
    match (answer.state, answer.shape, &answer.fit) {
        (AnswerState::Tied, ..) => {
            let tied: Vec<&str> = answer.tied.iter().map(|&shape| name(shape)).collect();
            let fit = answer.fit.as_ref().map(fit_in_words).unwrap_or_default();
            format!("{}: tied{fit}", tied.join(" or "))
        }
        (AnswerState::Rejected, _, Some(fit)) => {
            let (name, probability) = (name(fit.shape), probability(fit.shape));
            format!(
                "rejected: {name} reaches {probability} only{}",
                fit_in_words(fit)
            )
        }
        (AnswerState::Rejected, ..) => "rejected: no shape is likely enough".to_owned(),
        (state, Some(shape), fit) => {
            let fit = fit.as_ref().map(fit_in_words).unwrap_or_default();
            let certain = if state == AnswerState::Certain {
                "  certain"
            } else {
                ""
            };
            format!("{}  {}{fit}{certain}", name(shape), probability(shape))
        }
        (_, None, Some(fit)) => {
            let (name, differ) = (name(fit.shape), differing(fit.differs));
            format!("none of these: nearest {name}, {differ}")
        }
        (_, None, None) if answer.nearest.is_none() => {
            "unknown: no imprint of the model fits on these taxels".to_owned()
        }
        (_, None, None) => "unknown: no trained pose leaves this imprint".to_owned(),
    }
}

fn fit_in_words(fit: &Fit) -> String {
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
    format!("  {fits} at {x0}, {y0}, {angle}°")
}
