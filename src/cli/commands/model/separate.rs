//! `taxel model separate`: how the error of a set depends on the size of its shapes and on the threshold of the
//! sensor.
//!
//! For each threshold, sizes are tried from the smallest on. Each is a training of its own, on the smallest sensor that
//! holds all shapes. With `--want ERROR`, the first size that reaches the error is then refined: sizes between it and
//! the last one that does not are tried. Sizes at which no sensor holds the shapes are left out, and standard error
//! names them. Errors are reported before the first training where possible.

use std::ffi::{OsStr, OsString};

use clap::ArgGroup;
use serde::Serialize;
use taxel_core::parameter::number::short as shortest;
use taxel_core::pose::{Axis, DecimalRange};
use taxel_core::quote::shortened_message;
use taxel_core::recognition::{
    CellPositions, GridSteps, Model, Separation, SeparationPoint, SizeAxis, SmallestSize,
    TrainingError,
};
use taxel_core::sensor::Sensor;
use taxel_files::formats::file::has_ending;
use taxel_files::formats::value::{counted, decimal, grouped, percent};
use taxel_files::formats::{Plot, json};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::ModelChoice;

use crate::cli::Context;
use crate::cli::arguments::flags::{parse_probability, whole};
use crate::cli::arguments::parameters::parse_range;
use crate::cli::commands::model::{
    SetFlags, Table, TableFlags, find, models, parse_positions, ready, trained,
};
use crate::cli::failure::{Failure, Named};
use crate::cli::input::shapes;
use crate::cli::output::charset::Charset;
use crate::cli::output::evaluation::Count;
use crate::cli::output::plot;
use crate::cli::output::table::{row, table};

/// The sizes that a search for the wanted error tries.
const REFINED: u64 = 9;

const EXAMPLES: &str = "\
Trains the set once for each scale, pitch and threshold, and prints the error:
the share of touches that even the best classifier names wrong. A scale
multiplies all lengths. With --pitch, lengths are in mm, and a taxel of a stored
shape is 1 mm; the shape's own pitch and threshold are ignored. Sizes at which
the shapes do not fit on 64 x 64 taxels are left out; standard error lists them.

'imprints' counts the distinct imprints up to shifts, and 'sensor' is the
smallest that holds the shapes, at least 16 x 16. With --csv and --json they are
called 'keys' and 'side'.

--want tries every scale from the smallest up, or every pitch from the coarsest
down, and then tenths of a step before the first one that reaches the error. A
larger shape is not always easier to name, so --want also prints how many of the
larger scales, or finer pitches, miss the error again. With --csv, its answer
goes to standard error.

Examples:
  taxel model separate parts --scale 0.5:2:0.1 --positions 20
  taxel model separate parts.jsonl --pitch 1:4:0.5 --want 0.05 --positions 10
  taxel model separate parts --threshold 0.3:0.7:0.1 --positions 10 --json
  taxel model separate parts --scale 1:2:0.2 --positions 10 --export sizes.svg";

/// Find how fine a sensor must be to tell the shapes apart
#[derive(Debug, clap::Args)]
#[command(
    after_help = EXAMPLES,
    override_usage = "taxel model separate [OPTIONS] <--scale|--pitch|--threshold> [MODEL]...",
    group = ArgGroup::new("axes")
        .args(["range_scale", "range_pitch", "range_threshold"])
        .multiple(true)
        .required(true),
    mut_arg("set", |set| {
        set.value_name("MODEL|FILE.jsonl|NAME")
            .help("A model, or shapes as for 'taxel model train'")
    }),
)]
pub(super) struct Separate {
    #[command(flatten)]
    set: SetFlags,
    /// Multiply all lengths by this; one of --scale, --pitch and --threshold is required
    #[arg(id = "range_scale", long = "scale", value_name = "RANGE", value_parser = parse_range)]
    scale: Option<DecimalRange>,
    /// Pitch in mm; lengths are in mm, too
    #[arg(
        id = "range_pitch",
        long = "pitch",
        value_name = "RANGE",
        value_parser = parse_range,
        conflicts_with = "range_scale"
    )]
    pitch: Option<DecimalRange>,
    /// Threshold; default the model's, or 0.5
    #[arg(
        id = "range_threshold",
        long = "threshold",
        value_name = "RANGE",
        value_parser = parse_range
    )]
    threshold: Option<DecimalRange>,
    /// Angle, in degrees; default that of the model, or 0:359:1
    #[arg(
        id = "range_angle",
        long = "angle",
        value_name = "START:END:STEP",
        value_parser = parse_range,
        allow_hyphen_values = true,
        help_heading = "Grid"
    )]
    angle: Option<DecimalRange>,
    /// Positions per cell along x and y; default those of the model, or 100
    #[arg(long, value_name = "N", value_parser = parse_positions, help_heading = "Grid")]
    positions: Option<CellPositions>,
    /// Find the smallest scale, or the coarsest pitch, with at most this error (0 to 1)
    #[arg(long, value_name = "ERROR", value_parser = parse_probability)]
    want: Option<f64>,
    /// Threads; default all cores
    #[arg(long, value_name = "N", value_parser = whole::<u16>(1..=1024))]
    jobs: Option<u16>,
    #[command(flatten)]
    table: TableFlags,
}

impl Separate {
    pub(super) fn run(self, cx: &Context) -> Result<(), Failure> {
        self.check()?;
        let (separation, usual) = self.separation(cx)?;
        let thresholds: Vec<f64> = match &self.threshold {
            Some(range) => range.values().collect(),
            None => vec![usual],
        };
        let (axis, range) = self.axis();
        let all = axis.smallest_first(&range);
        let sizes = fitting(axis, &all, &separation, &thresholds)?;
        self.table.check()?;
        let left_out: Vec<String> = (all.iter().filter(|size| !sizes.contains(size)))
            .map(f64::to_string)
            .collect();
        let left_out = match &left_out[..] {
            [] => None,
            [only] => Some(only.clone()),
            [first, .., last] => Some(format!("{first} to {last}")),
        };
        // An answer without all its sizes says so, even with --quiet.
        if let Some(left_out) = left_out {
            let (name, reason) = (axis.name(), TrainingError::Large);
            cx.note(&format!("left out: {name} {left_out}: {reason}"));
        }
        let more = self.want.map_or(0, |_| REFINED);
        let points = (sizes.len() as u64 + more) * thresholds.len() as u64;
        let memory = MemoryGuard::new(None, "take fewer shapes, smaller sizes or coarser steps");
        let by = (self.jobs, memory, self.table.quiet);
        let curves = trained(separation.touches() * points, by, cx, |progress| {
            let curve = |&threshold: &f64| {
                let at = |&size: &f64| separation.at(axis, size, threshold, progress);
                let points = sizes.iter().map(at).collect::<Result<Vec<_>, _>>()?;
                let smallest = match self.want {
                    Some(error) => separation.smallest(axis, &points, error, progress)?,
                    None => None,
                };
                Ok(Curve {
                    threshold,
                    points,
                    smallest,
                })
            };
            thresholds.iter().map(curve).collect()
        })?;
        let curves = Curves {
            axis,
            step: range.step(),
            curves,
            wanted: self.want,
        };
        if self.table.csv {
            // The table has no place for the result of --want. It is an answer, not a note, so --quiet does not
            // suppress it.
            curves.found().lines().for_each(|line| cx.note(line));
        }
        self.table.give(&curves, cx)
    }

    fn check(&self) -> Result<(), Failure> {
        for (range, flag, most, allowed) in [
            (self.scale, "scale", f64::MAX, "above 0"),
            (self.pitch, "pitch", 1000.0, "above 0, up to 1000"),
            (self.threshold, "threshold", 1.0, "above 0, up to 1"),
        ] {
            let mut ends = range
                .iter()
                .flat_map(|range| [range.value(0), range.last()]);
            if let Some(value) = ends.find(|&value| value <= 0.0 || value > most) {
                let value = shortest(value);
                let text = format!("--{flag} {value} is out of range (allowed: {allowed})");
                return Err(Failure::new(text));
            }
        }
        Ok(())
    }

    /// The sizes; a scale of 1 if none are given.
    fn axis(&self) -> (SizeAxis, DecimalRange) {
        let scale = self.scale.unwrap_or(DecimalRange::whole(1));
        self.pitch
            .map_or((SizeAxis::Scale, scale), |pitch| (SizeAxis::Pitch, pitch))
    }

    /// The set, and the threshold that it has been touched with.
    fn separation(&self, cx: &Context) -> Result<(Separation, f64), Failure> {
        let what = &self.set.what;
        if let ([model], false) = (&what[..], self.set.library_all)
            && is_model(model, cx)
        {
            let model = ready(find(model, &cx.shelf)?, self.table.quiet, cx.charset)?;
            if !self.table.quiet {
                self.departures(&model).for_each(|text| cx.note(text));
            }
            let positions = self.positions.or_else(|| positions_of(&model));
            let mut separation = Separation::new(model.shapes().to_vec())?;
            separation.steps = GridSteps {
                positions: positions.unwrap_or(CellPositions::FINE),
                angles: self.angle.unwrap_or(model.ranges()[Axis::Angle]),
            };
            return Ok((separation, model.sensor().threshold()));
        }
        let no_shape = |name: &str| cx.shelf.imprint(name).is_err();
        let is_only_model =
            |what: &&OsString| is_model(what, cx) && what.to_str().is_none_or(no_shape);
        if let Some(model) = what.iter().find(is_only_model) {
            let name = shortened_message(&model.to_string_lossy());
            let text = "a model; give one model or several shapes, not both";
            return Err(Failure::new(format!("{name}: {text}")));
        }
        let mut separation = Separation::new(shapes::read_set(&self.set, &cx.shelf)?)?;
        let steps = &mut separation.steps;
        steps.angles = self.angle.unwrap_or(steps.angles);
        steps.positions = self.positions.unwrap_or(steps.positions);
        Ok((separation, Sensor::default().threshold()))
    }

    /// What of a model is not kept.
    fn departures(&self, model: &Model) -> impl Iterator<Item = &'static str> {
        let is_zoomed = |axis| model.ranges()[axis] != DecimalRange::whole(1);
        let notes = [
            (
                is_zoomed(Axis::ZoomX) || is_zoomed(Axis::ZoomY),
                "the zooms of the model are left out",
            ),
            (
                model.cut().iter().any(|&cut| cut > 0),
                "the model's sensor cuts poses off; each size here has a sensor that does not",
            ),
            (
                self.positions.is_none() && positions_of(model).is_none(),
                "the positions of the model are not one cell; here they are 100 × 100 in a cell",
            ),
        ];
        notes
            .into_iter()
            .filter_map(|(differs, text)| differs.then_some(text))
    }
}

/// Whether an argument is a model, rather than a shape or a file of shapes. A kept model takes precedence over a shape
/// of the library of the same name, and the shape over a built-in set; a file is a model if it ends in `.npz`.
fn is_model(what: &OsStr, cx: &Context) -> bool {
    match models(&cx.shelf).locate(ModelChoice::from_text(what)) {
        Ok(ModelChoice::Stored(_)) => true,
        Ok(ModelChoice::File(_)) | Err(_) => has_ending(what, "npz"),
        Ok(built_in) => cx.shelf.imprint(built_in.name()).is_err(),
    }
}

fn positions_of(model: &Model) -> Option<CellPositions> {
    let of = |axis| {
        let range = model.ranges()[axis];
        let count = u8::try_from(range.count()).ok()?;
        let is_cell = (range.step() * f64::from(count) - 1.0).abs() < 1e-9;
        CellPositions::new(count).filter(|_| is_cell)
    };
    let (x, y) = (of(Axis::X0)?, of(Axis::Y0)?);
    (x == y).then_some(x)
}

/// The sizes at which a sensor holds the shapes. It is an error if there is none.
fn fitting(
    axis: SizeAxis,
    sizes: &[f64],
    separation: &Separation,
    thresholds: &[f64],
) -> Result<Vec<f64>, Failure> {
    let (mut fitting, mut too_large) = (Vec::new(), None);
    for &size in sizes {
        let at = |threshold: f64| (separation.training(axis.scale(size), threshold), threshold);
        let refused = thresholds.iter().map(|&threshold| at(threshold));
        let refused =
            refused.filter_map(|(training, threshold)| Some((training.err()?, threshold)));
        match refused.into_iter().next() {
            None => fitting.push(size),
            Some((error, threshold)) => {
                let is_large = error == TrainingError::Large;
                let place = format!("{} {size}, threshold {threshold}", axis.name());
                let refused = Err(error).named(place);
                if !is_large {
                    return refused;
                }
                too_large.get_or_insert(refused);
            }
        }
    }
    too_large
        .filter(|_| fitting.is_empty())
        .unwrap_or(Ok(fitting))
}

/// The limit of one touch at each size, for one threshold.
struct Curve {
    threshold: f64,
    points: Vec<SeparationPoint>,
    /// The smallest size that reaches the wanted error; None if none does, or none is wanted.
    smallest: Option<SmallestSize>,
}

struct Curves {
    axis: SizeAxis,
    /// The distance of the sizes.
    step: f64,
    curves: Vec<Curve>,
    wanted: Option<f64>,
}

fn short(value: f64) -> String {
    decimal(value, 6)
}

impl Curves {
    fn points(&self) -> impl Iterator<Item = &SeparationPoint> {
        self.curves.iter().flat_map(|curve| &curve.points)
    }

    /// The name of the horizontal axis of a plot, and its curves: over the sizes, or over the thresholds if there is
    /// only one size.
    fn plotted(&self) -> (&'static str, Vec<(String, Vec<(f64, f64)>)>) {
        let name = self.axis.name();
        if self.curves.iter().all(|curve| curve.points.len() == 1) && self.curves.len() > 1 {
            let points = self.points().map(|point| (point.threshold, point.error()));
            let size = self.points().next().map_or(0.0, |point| point.value);
            return (
                "threshold",
                vec![(format!("{name} {}", short(size)), points.collect())],
            );
        }
        let curves = self.curves.iter().map(|curve| {
            let points = curve
                .points
                .iter()
                .map(|point| (point.value, point.error()));
            (
                format!("threshold {}", short(curve.threshold)),
                points.collect(),
            )
        });
        (name, curves.collect())
    }

    /// What the search found for each threshold, and how it searched. The steps are named because the error is not
    /// monotonic in the size: a size between two that were tried may reach the wanted error as well.
    fn found(&self) -> String {
        let Some(wanted) = self.wanted.map(short) else {
            return String::new();
        };
        // A coarser pitch makes the shapes smaller in cells.
        let [noun, extreme, smaller, larger, unit] = match self.axis {
            SizeAxis::Scale => ["scale", "smallest", "smaller", "larger", ""],
            SizeAxis::Pitch => ["pitch", "coarsest", "coarser", "finer", " mm"],
        };
        let mut text = String::new();
        for curve in &self.curves {
            if self.curves.len() > 1 {
                text += &format!("threshold {}: ", short(curve.threshold));
            }
            let Some(SmallestSize {
                point,
                step,
                missed_again,
            }) = &curve.smallest
            else {
                text += &format!("no {noun} that was tried has an error of at most {wanted}\n");
                continue;
            };
            let (size, error) = (short(point.value), percent(point.error()));
            text += &format!(
                "the {extreme} {noun} with an error of at most {wanted} is {size}{unit}: {error}\n"
            );
            if curve.points.len() == 1 {
                text += &format!("  no other {noun} was tried\n");
                continue;
            }
            text += &if *step > 0.0 {
                let (coarse, fine) = (short(self.step), short(*step));
                format!(
                    "  tried from the {extreme} on in steps of {coarse}{unit}, then in steps of {fine}{unit} just before the first that reaches it\n"
                )
            } else {
                format!("  no {smaller} {noun} was tried; one may reach the error as well\n")
            };
            text += &match missed_again {
                0 => format!("  every {larger} {noun} that was tried reaches it, too\n"),
                &count => {
                    let sizes = counted(count as u64, &format!("{larger} {noun}"));
                    format!("  the error is not monotonic: it is too large again at {sizes}\n")
                }
            };
        }
        text
    }

    fn point(&self, point: &SeparationPoint) -> PointJson {
        PointJson {
            pitch_mm: (self.axis == SizeAxis::Pitch).then_some(point.value),
            scale: point.scale,
            threshold: point.threshold,
            error: point.error(),
            touches: Count(point.touches),
            right: Count(point.right),
            certain: Count(point.certain),
            keys: point.keys,
            side: point.side,
        }
    }
}

#[derive(Serialize)]
struct CurvesJson {
    axis: &'static str,
    points: Vec<PointJson>,
    #[serde(skip_serializing_if = "Option::is_none")]
    want: Option<Vec<FoundJson>>,
}

#[derive(Serialize)]
struct PointJson {
    #[serde(skip_serializing_if = "Option::is_none")]
    pitch_mm: Option<f64>,
    scale: f64,
    threshold: f64,
    error: f64,
    touches: Count,
    right: Count,
    certain: Count,
    keys: usize,
    side: u8,
}

/// The result of a search; `smallest`, `step` and `missed_again` are null if no size reaches the error.
#[derive(Serialize)]
struct FoundJson {
    threshold: f64,
    error: f64,
    smallest: Option<PointJson>,
    step: Option<f64>,
    missed_again: Option<usize>,
}

impl Table for Curves {
    fn text(&self, charset: Charset) -> String {
        let name = self.axis.name();
        let mut rows = vec![row([
            name,
            "threshold",
            "error",
            "certain",
            "imprints",
            "sensor",
        ])];
        rows.extend(self.points().map(|point| {
            let (side, keys) = (point.side, grouped(point.keys as u64));
            let (error, certain) = (percent(point.error()), percent(point.certain_share()));
            let (size, threshold) = (short(point.value), short(point.threshold));
            vec![
                size,
                threshold,
                error,
                certain,
                keys,
                format!("{side} × {side}"),
            ]
        }));
        let mut text = table(&rows, &[0], charset);
        let (name, curves) = self.plotted();
        for (title, points) in &curves {
            let curve = plot::lines("error", name, points, charset);
            if !curve.is_empty() {
                let title = if curves.len() > 1 {
                    format!("{title}\n")
                } else {
                    String::new()
                };
                text += &format!("\n{title}{curve}");
            }
        }
        let found = self.found();
        let gap = if found.is_empty() { "" } else { "\n" };
        text + gap + &charset.lines(&found)
    }

    fn csv(&self) -> String {
        let name = self.axis.name();
        let mut text = format!("{name},threshold,error,touches,right,certain,keys,side\n");
        for point in self.points() {
            let (size, threshold, error) =
                (short(point.value), short(point.threshold), point.error());
            let SeparationPoint {
                touches,
                right,
                certain,
                keys,
                side,
                ..
            } = point;
            text +=
                &format!("{size},{threshold},{error},{touches},{right},{certain},{keys},{side}\n");
        }
        text
    }

    fn json(&self) -> String {
        let found = |error: f64, curve: &Curve| FoundJson {
            threshold: curve.threshold,
            error,
            smallest: curve.smallest.as_ref().map(|own| self.point(&own.point)),
            step: curve.smallest.as_ref().map(|own| own.step),
            missed_again: curve.smallest.as_ref().map(|own| own.missed_again),
        };
        let found = |error| {
            self.curves
                .iter()
                .map(|curve| found(error, curve))
                .collect()
        };
        let answer = CurvesJson {
            axis: self.axis.name(),
            points: self.points().map(|point| self.point(point)).collect(),
            want: self.wanted.map(found),
        };
        json::text(&answer) + "\n"
    }

    /// The wanted error is a line as long as the curves.
    fn svg(&self) -> Option<String> {
        let (name, curves) = self.plotted();
        let name = if name == "pitch_mm" {
            "pitch / mm"
        } else {
            name
        };
        let mut plot = Plot::from_zero(name, "error");
        let (mut first, mut last) = (f64::INFINITY, 0.0_f64);
        for (title, points) in &curves {
            plot = plot.with_curve(title, points);
            for &(x, _) in points {
                (first, last) = (first.min(x), last.max(x));
            }
        }
        if let Some(wanted) = self.wanted {
            let line = [(first, wanted), (last, wanted)];
            plot = plot.with_curve(&format!("wanted {}", short(wanted)), &line);
        }
        Some(plot.svg())
    }
}
