//! The paper's grid of 3.6 million poses: swept, touched pose by pose, and by what one would write without taxel
//! ([`peer`]), side by side in one run. All descriptors of each imprint's main region, and all statistics, included.
//!
//! `cargo bench --bench sweep` prints a table; the name of a figure after `--` restricts it. Pose by pose, 20,000 poses
//! spread over the grid are taken and the time extrapolated. The figures are gone through in turn, several
//! rounds of them, and each number is the median of its rounds: what else the machine does falls on all alike.

use std::hint::black_box;
use std::time::Instant;

use taxel::figure::{Figure, Kind};
use taxel::parameter::Parameter;
use taxel::picture::Picture;
use taxel::sensor::Sensor;
use taxel::source::Source;
use taxel::sweep::grid::{Anchor, Grid, Pose, Ranges};
use taxel::sweep::plan::Shard;
use taxel::sweep::quantity::{describe, values};
use taxel::sweep::survey::{Survey, Watch};
use taxel::touch::Plane;

use peer::{Outline, Peer};

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "its crates count in u32 and f32; all numbers are small"
)]
#[expect(unreachable_pub, reason = "written as one would for oneself")]
#[expect(dead_code, reason = "another benchmark looks at more of it")]
mod peer;

/// Poses that are taken pose by pose.
const SAMPLE: u64 = 20_000;
const ROUNDS: usize = 5;

/// A row of the table.
struct Case {
    name: &'static str,
    grid: Grid,
    /// Sizes and wall, for the peer; none of what the peer cannot do.
    peer: Option<(Kind, [f32; 2], Option<f32>)>,
}

fn grid(source: Source, sensor: Sensor, place: &str, angles: &str) -> Grid {
    let read = |text: &str| text.parse().expect("a range");
    let ranges = Ranges {
        x0: read(place),
        y0: read(place),
        angle: read(angles),
        ..Ranges::default()
    };
    Grid::new(source, sensor, Anchor::Corner, ranges).expect("a grid")
}

fn figure(kind: Kind, sizes: [f32; 2], wall: Option<f32>) -> Source {
    // Through the decimal, so that 0.7 is 0.7.
    let decimal = |number: f32| number.to_string().parse::<f64>().expect("a number");
    let figure = Figure::new(kind, 64, |parameter| match parameter {
        Parameter::RadiusX | Parameter::Length | Parameter::Side => Some(decimal(sizes[0])),
        Parameter::RadiusY | Parameter::Width => Some(decimal(sizes[1])),
        Parameter::Thickness => wall.map(decimal),
        _ => Some(0.0),
    });
    Source::Figure(figure.expect("a figure in range"))
}

#[expect(clippy::too_many_lines, reason = "a list")]
fn cases() -> Vec<Case> {
    let paper = |name, kind, sizes, wall, place| Case {
        name,
        grid: grid(
            figure(kind, sizes, wall),
            Sensor::default(),
            place,
            "0:359:1",
        ),
        peer: Some((kind, sizes, wall)),
    };
    let cell = "5:5.99:0.01";
    let picture = |name, rows: &str| Case {
        name,
        grid: grid(
            Source::Picture(Picture::at_home(rows.parse().expect("rows"))),
            Sensor::default(),
            cell,
            "0:359:1",
        ),
        peer: None,
    };
    let sized = |name, side: f64, figure_side: f32, place, angles| Case {
        name,
        grid: grid(
            figure(Kind::Hexagon, [figure_side, 0.0], Some(1.0)),
            Sensor::new(side, side).expect("a side in range"),
            place,
            angles,
        ),
        peer: None,
    };
    vec![
        paper("rectangle 6 x 3", Kind::Rectangle, [6.0, 3.0], None, cell),
        paper("triangle 6", Kind::Triangle, [6.0, 0.0], None, cell),
        paper(
            "hexagon 3 wall 1",
            Kind::Hexagon,
            [3.0, 0.0],
            Some(1.0),
            cell,
        ),
        paper(
            "heptagon 3 wall 1",
            Kind::Heptagon,
            [3.0, 0.0],
            Some(1.0),
            cell,
        ),
        paper(
            "octagon 3 wall 1.5",
            Kind::Octagon,
            [3.0, 0.0],
            Some(1.5),
            cell,
        ),
        // The peer does not cut off what lies beyond the sensor: at 5 the rectangle's corners do.
        paper(
            "rectangle 10 x 8 wall 0.7",
            Kind::Rectangle,
            [10.0, 8.0],
            Some(0.7),
            "2.5:3.49:0.01",
        ),
        paper(
            "ellipse 5 x 3",
            Kind::Ellipse,
            [5.0, 3.0],
            None,
            "2.5:3.49:0.01",
        ),
        paper(
            "ellipse 5 x 3 wall 1",
            Kind::Ellipse,
            [5.0, 3.0],
            Some(1.0),
            "2.5:3.49:0.01",
        ),
        paper(
            "circle 4 wall 2",
            Kind::Ellipse,
            [4.0, 4.0],
            Some(2.0),
            "1:1.99:0.01",
        ),
        picture("picture of 9 taxels", "##.#\n.###\n##..\n#..#"),
        picture("picture of a ring", "####\n#..#\n#..#\n####"),
        sized("hexagon 3 on 16 x 16", 16.0, 3.0, cell, "1:59:2"),
        sized("hexagon 3 on 32 x 32", 32.0, 3.0, cell, "1:59:2"),
        sized("hexagon 3 on 64 x 64", 64.0, 3.0, cell, "1:59:2"),
        sized("hexagon 6 on 32 x 32", 32.0, 6.0, cell, "1:59:2"),
        sized("hexagon 12 on 64 x 64", 64.0, 12.0, cell, "1:59:2"),
        sized(
            "hexagon 3, steps of 0.02",
            16.0,
            3.0,
            "5:5.98:0.02",
            "1:59:2",
        ),
        sized(
            "hexagon 3, steps of 0.005",
            16.0,
            3.0,
            "5:5.995:0.005",
            "1:59:2",
        ),
    ]
}

/// Seconds that something takes.
fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Poses spread over the grid.
fn sample(grid: &Grid) -> impl Iterator<Item = Pose> + '_ {
    let stride = grid.poses() / SAMPLE.min(grid.poses());
    (0..SAMPLE.min(grid.poses())).map(move |index| grid.pose(index * stride))
}

/// A source in each pose, made before the time is taken.
fn placed(grid: &Grid) -> Vec<Source> {
    let side = grid.sensor().side();
    let set = |source: Source, parameter, value| {
        source
            .with(parameter, value, side)
            .expect("a value of the grid")
    };
    sample(grid)
        .map(|pose| {
            let source = set(grid.source().clone(), Parameter::X0, pose.x0);
            let source = set(source, Parameter::Y0, pose.y0);
            set(source, Parameter::Angle, pose.angle)
        })
        .collect()
}

fn touch_all(plane: &mut Plane, sources: &[Source]) {
    for source in sources {
        let note = describe(&plane.touch(source));
        if let Some(description) = &note.description {
            values(description, |_, value| {
                black_box(value);
            });
        }
    }
}

fn touch_peer(peer: &mut Peer, kind: Kind, sizes: [f32; 2], wall: Option<f32>, poses: &[Pose]) {
    for pose in poses {
        #[expect(clippy::cast_possible_truncation, reason = "the peer computes in f32")]
        let (corner, degrees) = ((pose.x0 as f32, pose.y0 as f32), pose.angle as f32);
        let sizes = black_box((sizes[0], sizes[1]));
        let regular = |peer: &mut Peer, exterior: &[(f32, f32)], hole: Option<&[(f32, f32)]>| {
            let hole = hole.map(Outline::Polygon);
            black_box(peer.touch(&Outline::Polygon(exterior), hole.as_ref()));
        };
        macro_rules! polygon {
            ($made:expr) => {{
                let (exterior, hole) = $made;
                regular(peer, &exterior, hole.as_ref().map(|hole| &hole[..]));
            }};
        }
        match kind {
            Kind::Ellipse => {
                let (exterior, hole) = peer::ellipse(sizes, corner, degrees, wall);
                black_box(peer.touch(&exterior, hole.as_ref()));
            }
            Kind::Rectangle => polygon!(peer::rectangle(sizes, corner, degrees, wall)),
            Kind::Triangle => polygon!(peer::regular::<3>(sizes.0, corner, degrees, wall)),
            Kind::Pentagon => polygon!(peer::regular::<5>(sizes.0, corner, degrees, wall)),
            Kind::Hexagon => polygon!(peer::regular::<6>(sizes.0, corner, degrees, wall)),
            Kind::Heptagon => polygon!(peer::regular::<7>(sizes.0, corner, degrees, wall)),
            Kind::Octagon => polygon!(peer::regular::<8>(sizes.0, corner, degrees, wall)),
        }
    }
}

/// Times of one row, in seconds for the whole grid.
#[derive(Default)]
struct Times {
    one: Vec<f64>,
    two: Vec<f64>,
    touch: Vec<f64>,
    peer: Vec<f64>,
}

#[expect(clippy::cast_precision_loss, reason = "for reading")]
fn main() {
    let only = std::env::args()
        .skip(1)
        .find(|argument| !argument.starts_with('-'));
    let mut cases = cases();
    cases.retain(|case| {
        only.as_ref()
            .is_none_or(|only| case.name.contains(only.as_str()))
    });
    let pool = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool of threads")
    };
    let (one, two) = (pool(1), pool(2));
    println!(
        "{:<27} {:>9} {:>9} {:>8} {:>7} {:>8} {:>8} {:>8} {:>8}",
        "", "poses", "distinct", "sweep", "2 thr.", "touch", "peer", "touch:", "peer:"
    );
    println!(
        "{:<27} {:>9} {:>9} {:>8} {:>7} {:>8} {:>8} {:>8} {:>8}",
        "", "", "", "ns/pose", "times", "ns/pose", "ns/pose", "sweep", "sweep"
    );
    for case in &cases {
        let grid = &case.grid;
        let poses: Vec<Pose> = sample(grid).collect();
        let sources = placed(grid);
        let mut plane = Plane::new(*grid.sensor());
        let mut peer = Peer::new(grid.sensor().columns(), grid.sensor().rows());
        let scale = grid.poses() as f64 / poses.len() as f64;
        let mut times = Times::default();
        let mut distinct = 0;
        let mut sweep = |pool: &rayon::ThreadPool| {
            seconds(|| {
                let survey = pool.install(|| Survey::of(grid, Shard::WHOLE, Watch::nothing()));
                distinct = black_box(survey).atlas.len();
            })
        };
        for _ in 0..ROUNDS {
            times.one.push(sweep(&one));
            times.two.push(sweep(&two));
            times
                .touch
                .push(scale * seconds(|| touch_all(&mut plane, &sources)));
            if let Some((kind, sizes, wall)) = case.peer {
                let work = || touch_peer(&mut peer, kind, sizes, wall, &poses);
                times.peer.push(scale * seconds(work));
            }
        }
        let per_pose = |times: Vec<f64>| median(times) * 1e9 / grid.poses() as f64;
        let (own, two) = (per_pose(times.one), per_pose(times.two));
        let touch = per_pose(times.touch);
        let (peer, ratio) = if times.peer.is_empty() {
            ("-".to_owned(), "-".to_owned())
        } else {
            let peer = per_pose(times.peer);
            (format!("{peer:.0}"), format!("{:.0}", peer / own))
        };
        println!(
            "{:<27} {:>9} {:>9} {own:>8.2} {:>7.2} {touch:>8.0} {peer:>8} {:>8.0} {ratio:>8}",
            case.name,
            grid.poses(),
            distinct,
            own / two,
            touch / own,
        );
    }
}
