//! How well do shapes fit touches of themselves, and touches of others? Two of three shapes that come with taxel are the
//! set; every shape is touched 100 times in random poses, and the curves count the taxels that differ from the best fit.
//!
//! `cargo run --release --example fits > docs/recognition.svg`

use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::share;
use taxel_core::picture::Picture;
use taxel_core::progress::ToTheEnd;
use taxel_core::recognition::{Evidence, GridSteps, NamedShape, RandomTouches, Tally, Training};
use taxel_files::formats::Plot;
use taxel_files::storage::shipped;

/// The number of taxels where the curves end.
const MOST: u32 = 60;

fn main() {
    print!("{}", report());
}

/// Returns the curves as SVG.
pub(crate) fn report() -> String {
    let shapes = shipped::all()
        .map(|own| NamedShape::new(own.name.to_string(), Picture::at_home(own.imprint)));
    let numbered = shapes.enumerate();
    let (set, foreign): (Vec<_>, Vec<_>) = numbered.partition(|(number, _)| number % 3 < 2);
    let [set, foreign] = [set, foreign].map(|part| part.into_iter().map(|(_, shape)| shape));
    let training = Training::fitting(set, GridSteps::COARSE).expect("they fit");
    let model = training.run().expect("not stopped");
    let touches = RandomTouches::new(&model, foreign.collect(), 100, 0).expect("they fit");
    let answer = |touch: &Imprint| model.recognise(Evidence::of(&[*touch]));
    let trial = touches.answer(&model, &answer, &ToTheEnd);
    let trial = trial.expect("not stopped");
    let curve = |plot: Plot, name: &str, tally: &Tally| {
        let points = (0..=MOST).map(|most| {
            let touches: u64 = tally.differs.range(..=most).map(|(_, count)| count).sum();
            (
                f64::from(most),
                100.0 * share(touches.into(), tally.touches()),
            )
        });
        plot.with_curve(name, &points.collect::<Vec<_>>())
    };
    let (x, y) = (
        "taxels that differ from the best fit, at most",
        "% of touches",
    );
    let plot = curve(Plot::new(x, y), "shapes of the set", &trial.known);
    curve(plot, "other shapes", &trial.foreign).svg()
}
