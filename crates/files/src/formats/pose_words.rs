//! The parts of a pose that the screen and the command line write the same way: `3.00 ± 0.13, 2.50 ± 0.08`, and
//! `95 % of 66 poses: 27°..32°`.

use crate::formats::value::{counted, decimal, deviation};
use crate::recognition::{AngleEstimate, PoseEstimate};

/// Returns x and y of the centre, each with its standard deviation, multiplied by `factor`: 1 for cells, the pitch
/// for mm. Decimals are never dropped, so that lines keep their width while a shape is moved.
pub fn centre(pose: &PoseEstimate, factor: f64) -> String {
    let ([x, y], [dx, dy]) = (pose.position, pose.standard_deviation);
    format!(
        "{:.2} ± {}, {:.2} ± {}",
        x * factor,
        spread(dx * factor, 2),
        y * factor,
        spread(dy * factor, 2)
    )
}

/// Formats a standard deviation with all its decimals.
pub fn spread(number: f64, decimals: usize) -> String {
    match deviation(number, decimals) {
        little if little.starts_with('<') => little,
        _ => format!("{number:.decimals$}"),
    }
}

/// Returns after how many degrees the shape looks the same, in brackets after a space; empty for a full turn.
pub fn repeats(angle: &AngleEstimate) -> String {
    match decimal(angle.period, 2) {
        turn if turn == "360" => String::new(),
        period => format!(" (repeats every {period}°)"),
    }
}

/// Returns the fewest whole degrees that hold 95 % of the poses, as in `95 % of 66 poses: 27°..32°`: the first and the
/// last degree, or the only one.
pub fn arc(angle: &AngleEstimate, poses: u64) -> String {
    let poses = counted(poses, "pose");
    match angle.ends() {
        (first, last) if first == last => format!("95 % of {poses}: {first}°"),
        (first, last) => format!("95 % of {poses}: {first}°..{last}°"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn angle(shortest_arc: (u32, u32)) -> AngleEstimate {
        AngleEstimate {
            period: 180.0,
            mean: Some(27.0),
            standard_deviation: Some(0.0),
            shortest_arc,
        }
    }

    #[test]
    fn a_single_degree_is_written_once() {
        let arcs = [(27, 1), (27, 6), (178, 5)].map(|degrees| arc(&angle(degrees), 66));
        assert_eq!(
            arcs,
            [
                "95 % of 66 poses: 27°",
                "95 % of 66 poses: 27°..32°",
                "95 % of 66 poses: -2°..2°"
            ]
        );
    }

    #[test]
    fn each_coordinate_has_its_deviation() {
        let pose = PoseEstimate {
            poses: 2,
            position: [3.0, 2.5],
            standard_deviation: [0.125, 0.001],
            angle: None,
        };
        assert_eq!(centre(&pose, 1.0), "3.00 ± 0.12, 2.50 ± <0.01");
        assert_eq!(centre(&pose, 2.0), "6.00 ± 0.25, 5.00 ± <0.01");
    }
}
