//! `taxel model separate`: how the error of a set depends on the size of its shapes in cells.
//!
//! Sizes are tried from the smallest on. Each is a training of its own, on the smallest sensor that holds all shapes. With `--want ERROR`, the first size that reaches the error is then refined: sizes between it and
//! the last one that does not are tried. Errors are reported before the first training where possible.

use std::ffi::{OsStr, OsString};

use clap::ArgGroup;
use serde::Serialize;
use serde_json::{Value, json};
use taxel_core::parameter::number::{self, share};
use taxel_core::pose::{Axis, DecimalRange};
use taxel_core::recognition::{
    CellPositions, Separation, SeparationPoint, SizeAxis, SmallestSize, TrainingError,
};
use taxel_core::sensor::Sensor;
use taxel_files::formats::file::has_ending;
use taxel_files::formats::value::{counted, decimal, grouped, percent};
use taxel_files::formats::{Plot, json};
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::ModelChoice;

use crate::cli::Context;
use crate::cli::arguments::flags::{parse_probability, whole};
use crate::cli::arguments::parameters::{ThresholdFlag, parse_range};
use crate::cli::commands::model::{
    SetFlags, Table, TableFlags, find, models, positions, ready, trained,
};
use crate::cli::failure::{Failure, Named};
use crate::cli::input::shapes;
use crate::cli::output::evaluation::count;
use crate::cli::output::table::{Record, row, table};
use crate::cli::settings::Pitch;

/// The most sizes that a search for the wanted error tries.
const REFINED: u64 = 9;

const EXAMPLES: &str = "\
Trains the set once for each scale or pitch, and prints the error:
the share of touches that even the best classifier names wrong. A scale
multiplies all lengths. With --pitch, lengths are in mm, whatever their unit,
and a taxel of a stored shape is 1 mm; its own pitch and threshold are ignored. Sizes at which
the shapes do not fit on 64 x 64 taxels are left out; standard error lists them.
Of a model, the shapes, the angles, the threshold and, if they fill one cell,
the positions are taken; its zooms and its sensor are not.

'imprints' counts the distinct imprints up to shifts, and 'sensor' is the
smallest that holds the shapes, at least 16 x 16. With --json they are called
'keys' and 'side'.

--want tries every scale from the smallest up, or every pitch from the coarsest
down, and then tenths of a step before the first one that reaches the error. A
larger shape is not always easier to name, so it also says how many of the
larger scales, or finer pitches, miss the error again.

Examples:
  taxel model separate parts/*.svg --pitch 1:5:0.5 --want 0.02 --positions 10
  taxel model separate parts --scale 0.5:2:0.1 --positions 20
  taxel model separate parts.jsonl --pitch 1:4:0.5 --want 0.05 --positions 10
  taxel model separate parts --scale 1 --threshold 0.3 --positions 10 --json
  taxel model separate parts --scale 1:2:0.2 --positions 10 --export sizes.svg";

/// Find how fine a sensor must be to tell the shapes apart
#[derive(Debug, clap::Args)]
#[command(
    after_help = EXAMPLES,
    override_usage = "taxel model separate [OPTIONS] <--scale|--pitch> [MODEL]...",
    group = ArgGroup::new("axes").args(AXES).required(true),
    mut_arg("set", |set| set.value_name("MODEL|FILE|NAME").help(SET)),
)]
pub(crate) struct Separate {
    #[command(flatten)]
    set: SetFlags,
    /// Multiply all lengths by this; --scale or --pitch is required
    #[arg(id = AXES[0], long = "scale", value_name = "RANGE", value_parser = parse_range)]
    scale: Option<DecimalRange>,
    /// Pitch in mm; lengths are in mm, too
    #[arg(id = AXES[1], long = "pitch", value_name = "RANGE", value_parser = parse_range)]
    pitch: Option<DecimalRange>,
    #[command(flatten)]
    threshold: ThresholdFlag,
    /// Rotation about the centre, in degrees; default that of the model, or 0:359:1
    #[arg(id = "range_angle", long = "angle", value_name = "START:END:STEP")]
    #[arg(value_parser = parse_range, allow_hyphen_values = true, help_heading = "Grid")]
    angle: Option<DecimalRange>,
    /// Positions per cell along x and y: 1, 2, 4, 5, 10, 20, 25, 50 or 100; default those of the model, or 100
    #[arg(long, value_name = "N", value_parser = positions, help_heading = "Grid")]
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

const SET: &str = "A model, or shapes as for 'taxel model train'";

/// The ids of the flags of sizes. Those of a sensor's own flags, which take a number, are other ones.
const AXES: [&str; 2] = ["range_scale", "range_pitch"];

impl Separate {
    pub(super) fn run(self, cx: &Context) -> Result<(), Failure> {
        self.check()?;
        let (separation, threshold) = self.separation(cx)?;
        let scale = self.scale.unwrap_or(DecimalRange::whole(1));
        let (axis, range) = match self.pitch {
            Some(pitch) => (SizeAxis::Pitch, pitch),
            None => (SizeAxis::Scale, scale),
        };
        let (mut sizes, mut left_out) = (Vec::new(), Vec::new());
        for size in axis.smallest_first(&range) {
            match separation.training(axis.scale(size), threshold) {
                Err(TrainingError::Large) => left_out.push(size),
                tried => {
                    tried.map(drop).named(format!("{} {size}", axis.name()))?;
                    sizes.push(size);
                }
            }
        }
        self.table.check()?;
        if let (Some(first), Some(last)) = (left_out.first(), left_out.last()) {
            let mut text = format!("{} {first}", axis.name());
            if first != last {
                text += &format!(" to {last}");
            }
            text += &format!(": {}", TrainingError::Large);
            if sizes.is_empty() {
                return Err(Failure::new(text));
            }
            // An answer without all its sizes says so, even with --quiet.
            cx.note(&format!("left out: {text}"));
        }
        let more = self.want.map_or(0, |_| REFINED);
        let points = sizes.len() as u64 + more;
        let memory = MemoryGuard::new("take fewer shapes, smaller sizes or coarser steps");
        let by = (self.jobs, memory, self.table.quiet);
        let separated = trained(separation.touches() * points, by, |progress| {
            let at = |&size: &f64| separation.at(axis, size, threshold, progress);
            let points = sizes.iter().map(at).collect::<Result<Vec<_>, _>>()?;
            let smallest = match self.want {
                Some(error) => separation.smallest(axis, &points, error, progress)?,
                None => None,
            };
            Ok(Separated {
                axis,
                threshold,
                points,
                wanted: self.want,
                smallest,
            })
        })?;
        self.table.give(&separated, false, cx)
    }

    fn check(&self) -> Result<(), Failure> {
        for (range, flag, most, allowed) in [
            (self.scale, "scale", f64::MAX, "above 0"),
            (self.pitch, "pitch", 1000.0, "above 0, up to 1000"),
        ] {
            let ends = range.map(|range| [range.value(0), range.last()]);
            let wrong = |value: &f64| *value <= 0.0 || *value > most;
            if let Some(value) = ends.iter().flatten().copied().find(wrong) {
                let value = number::short(value);
                let text = format!("--{flag} {value} is out of range (allowed: {allowed})");
                return Err(Failure::new(text));
            }
        }
        Ok(())
    }

    /// The set, and the threshold.
    fn separation(&self, cx: &Context) -> Result<(Separation, f64), Failure> {
        let what = &self.set.what;
        let (mut separation, sensor) = match &what[..] {
            [model] if !self.set.library_all && is_model(model, cx) => {
                self.set.outlines.refuse()?;
                let model = ready(find(model, &cx.shelf)?, self.table.quiet)?;
                let mut separation = Separation::new(model.shapes().to_vec())?;
                separation.steps.angles = model.ranges()[Axis::Angle];
                separation.steps.positions =
                    CellPositions::of(model.ranges()).unwrap_or(CellPositions::FINE);
                (separation, *model.sensor())
            }
            _ => {
                let no_shape = |name: &str| cx.shelf.source(name).is_err();
                let is_only_model =
                    |what: &&OsString| is_model(what, cx) && what.to_str().is_none_or(no_shape);
                if let Some(model) = what.iter().find(is_only_model) {
                    let text = "a model; give one model or several shapes, not both";
                    return Err(Failure::new(text)).named(model.display());
                }
                // With --pitch, what is in mm is read at 1 mm, and each pitch is then a scale of it.
                let (given, usual) = (self.pitch.map(|_| 1.0), cx.settings.sensor.pitch);
                let pitch = Pitch { given, usual };
                let shapes = shapes::read_set(&self.set, pitch, &cx.shelf)?;
                (Separation::new(shapes)?, Sensor::default())
            }
        };
        let steps = &mut separation.steps;
        steps.angles = self.angle.unwrap_or(steps.angles);
        steps.positions = self.positions.unwrap_or(steps.positions);
        Ok((separation, self.threshold.sensor(sensor)?.threshold()))
    }
}

/// Whether an argument is a model, rather than a shape or a file of shapes. A kept model takes precedence over a shape
/// of the library of the same name, and the shape over a built-in set; a file is a model if it ends in `.npz`.
fn is_model(what: &OsStr, cx: &Context) -> bool {
    match models(&cx.shelf).locate(ModelChoice::from_text(what)) {
        Ok(ModelChoice::Stored(_)) => true,
        Ok(ModelChoice::File(_)) | Err(_) => has_ending(what, "npz"),
        Ok(built_in) => cx.shelf.source(built_in.name()).is_err(),
    }
}

/// The limit of one touch at each size, and the smallest size that reaches the wanted error, if any does.
struct Separated {
    axis: SizeAxis,
    threshold: f64,
    points: Vec<SeparationPoint>,
    wanted: Option<f64>,
    smallest: Option<SmallestSize>,
}

fn certain(point: &SeparationPoint) -> u128 {
    point.limit.certainty.unwrap_or_default().touches
}

fn short(value: f64) -> String {
    decimal(value, 6)
}

impl Separated {
    fn record(&self, point: &SeparationPoint) -> Record<'static> {
        let scale = (self.axis == SizeAxis::Pitch).then(|| ("scale", json!(point.scale)));
        let size = [(self.axis.name(), json!(point.value))].into_iter();
        let others = [
            ("threshold", json!(point.threshold)),
            ("error", json!(point.limit.error())),
            ("touches", count(point.limit.touches)),
            ("right", count(point.limit.right)),
            ("certain", count(certain(point))),
            ("keys", json!(point.limit.keys)),
            ("side", json!(point.side)),
        ];
        Record(size.chain(scale).chain(others).collect())
    }

    /// What the search found.
    fn found(&self) -> String {
        let Some(wanted) = self.wanted.map(short) else {
            return String::new();
        };
        // A coarser pitch makes the shapes smaller in cells.
        let [noun, extreme, smaller, larger, unit] = match self.axis {
            SizeAxis::Scale => ["scale", "smallest", "smaller", "larger", ""],
            SizeAxis::Pitch => ["pitch", "coarsest", "coarser", "finer", " mm"],
        };
        let Some(found) = &self.smallest else {
            return format!("no {noun} that was tried has an error of at most {wanted}\n");
        };
        let (size, error) = (short(found.point.value), percent(found.point.limit.error()));
        let mut text = format!(
            "the {extreme} {noun} with an error of at most {wanted} is {size}{unit}: {error}\n"
        );
        if found.step == 0.0 {
            text += &format!("  no {smaller} {noun} was tried; one may reach the error as well\n");
        }
        if found.missed_again > 0 {
            let sizes = counted(found.missed_again as u64, &format!("{larger} {noun}"));
            text += &format!("  the error is not monotonic: it is too large again at {sizes}\n");
        }
        text
    }
}

impl Table for Separated {
    fn text(&self) -> String {
        let name = self.axis.name();
        let titles = [name, "threshold", "error", "certain", "imprints", "sensor"];
        let mut rows = vec![row(titles)];
        for point in &self.points {
            let (side, keys) = (point.side, grouped(point.limit.keys as u64));
            let (error, certain) = (
                percent(point.limit.error()),
                percent(share(certain(point), point.limit.touches)),
            );
            let (size, threshold) = (short(point.value), short(point.threshold));
            let side = format!("{side} × {side}");
            rows.push(row([&size, &threshold, &error, &certain, &keys, &side]));
        }
        table(&rows, &[0]) + &self.found()
    }

    /// With `--want`, `smallest`, `step` and `missed_again` are null if no size reaches the error.
    fn json(&self) -> String {
        #[derive(Serialize)]
        struct Answer {
            axis: &'static str,
            points: Vec<Record<'static>>,
            #[serde(skip_serializing_if = "Option::is_none")]
            want: Option<[Value; 1]>,
        }
        let found = self.smallest.as_ref();
        let want = self.wanted.map(|error| {
            [json!({
                "threshold": self.threshold,
                "error": error,
                "smallest": found.map(|own| self.record(&own.point)),
                "step": found.map(|own| own.step),
                "missed_again": found.map(|own| own.missed_again),
            })]
        });
        let points = self.points.iter().map(|point| self.record(point));
        let (axis, points) = (self.axis.name(), points.collect());
        json::text(&Answer { axis, points, want }) + "\n"
    }

    /// The wanted error is a line as long as the curve.
    fn svg(&self) -> Option<String> {
        let name = self.axis.name().replace("_mm", " / mm");
        let points = self.points.iter();
        let points: Vec<_> = points.map(|own| (own.value, own.limit.error())).collect();
        let title = format!("threshold {}", short(self.threshold));
        let mut plot = Plot::new(&name, "error").with_curve(&title, &points);
        if let (Some(wanted), [(first, _), .., (last, _)]) = (self.wanted, &points[..]) {
            let line = [(*first, wanted), (*last, wanted)];
            plot = plot.with_curve(&format!("wanted {}", short(wanted)), &line);
        }
        Some(plot.svg())
    }
}
