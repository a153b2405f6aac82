//! The paper's grid of 3.6 million poses, computed in three ways side by side in one run: as a sweep, with one touch
//! per pose, and with code that one would write without taxel ([`peer`]). Also how the time of a sweep grows with the
//! sensor, the figure and the step. All descriptors of each imprint's main region and all statistics are included.
//!
//! `cargo bench --bench sweep` prints two tables; an argument after `--` selects the rows whose names contain it. For
//! single touches, 20,000 poses spread over the grid are measured. Work on one thread is measured in processor time. Two
//! threads are compared with one by wall-clock time, with both cores awake.

use std::hint::black_box;
use std::time::{Duration, Instant};

use taxel_core::atlas::{ImprintSummary, feature_values};
use taxel_core::figure::FigureKind;
use taxel_core::parameter::Parameter;
use taxel_core::pose::{Axis, Pose, PoseGrid};
use taxel_core::source::Source;
use taxel_core::sweep::Sweep;
use taxel_core::touch::Plane;

use cases::{Case, cases, figure, sensor};
use peer::{Outline, Peer};
use timing::{Least, selected};

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "its crates count in u32 and f32; all numbers are small"
)]
#[expect(
    unreachable_pub,
    clippy::disallowed_methods,
    reason = "written as one would for oneself"
)]
#[expect(dead_code, reason = "another benchmark looks at more of it")]
mod peer;
mod timing;

#[path = "../tests/imprints/sweep/cases.rs"]
#[expect(
    dead_code,
    reason = "compares with touching, which is no matter of time"
)]
mod cases;

/// The number of poses that are touched one by one.
const SAMPLE: u64 = 20_000;
const ROUNDS: usize = 7;

/// The shapes that are measured, of all shapes for which sweeps are compared with touches.
const MEASURED: [&str; 13] = [
    "rectangle 6 x 3",
    "triangle 6",
    "hexagon 3 wall 1",
    "heptagon 3 wall 1",
    "octagon 3 wall 1.5",
    "rectangle 10 x 8 wall 0.7",
    "ellipse 5 x 3",
    "ellipse 5 x 3 wall 1",
    "circle 4 wall 2",
    "outline of 40 edges",
    "drilled plate",
    "picture: scattered",
    "picture: ring",
];

/// Hexagons with a wall of 1: the first one, and variations of it in one respect each. None of their angles repeats.
fn growing() -> Vec<Case> {
    let case = |name, side: f64, on: u8, place| Case {
        name,
        source: figure(FigureKind::Hexagon, side, 0.0, 1.0),
        sensor: sensor(on, on, 0.5),
        place,
        ..cases().swap_remove(0)
    };
    let cell = "5:5.99:0.01";
    vec![
        case("side 3, 16 x 16, step 0.01", 3.0, 16, cell),
        case("on 32 x 32", 3.0, 32, cell),
        case("on 64 x 64", 3.0, 64, cell),
        case("side 6, on 32 x 32", 6.0, 32, cell),
        case("side 12, on 64 x 64", 12.0, 64, cell),
        case("step 0.04", 3.0, 16, "5:5.96:0.04"),
        case("step 0.02", 3.0, 16, "5:5.98:0.02"),
        case("step 0.005", 3.0, 16, "5:5.995:0.005"),
        case("step 0.0025", 3.0, 16, "5:5.9975:0.0025"),
    ]
}

/// Returns poses spread over the grid.
fn sample(grid: &PoseGrid) -> impl Iterator<Item = Pose> + '_ {
    let stride = grid.poses() / SAMPLE.min(grid.poses());
    (0..SAMPLE.min(grid.poses())).map(move |index| grid.pose(index * stride))
}

/// Returns the source in each pose, made before time is measured.
fn placed(grid: &PoseGrid) -> Vec<Source> {
    let set = |source: Source, parameter, value| {
        source
            .with(parameter, value, grid.sensor())
            .expect("a value of the grid")
    };
    sample(grid)
        .map(|pose| {
            let source = set(grid.source().clone(), Parameter::X0, pose[Axis::X0]);
            let source = set(source, Parameter::Y0, pose[Axis::Y0]);
            set(source, Parameter::Angle, pose[Axis::Angle])
        })
        .collect()
}

fn touch_all(plane: &mut Plane, sources: &[Source]) {
    for source in sources {
        let summary = ImprintSummary::of(&plane.touch(source));
        if let Some(description) = &summary.description {
            feature_values(description, |_, value| {
                black_box(value);
            });
        }
    }
}

fn touch_peer(
    peer: &mut Peer,
    kind: FigureKind,
    sizes: [f32; 2],
    wall: Option<f32>,
    poses: &[Pose],
) {
    for pose in poses {
        #[expect(clippy::cast_possible_truncation, reason = "the peer computes in f32")]
        let (corner, degrees) = (
            (pose[Axis::X0] as f32, pose[Axis::Y0] as f32),
            pose[Axis::Angle] as f32,
        );
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
            FigureKind::Ellipse => {
                let (exterior, hole) = peer::ellipse(sizes, corner, degrees, wall);
                black_box(peer.touch(&exterior, hole.as_ref()));
            }
            FigureKind::Rectangle => polygon!(peer::rectangle(sizes, corner, degrees, wall)),
            FigureKind::Triangle => polygon!(peer::regular::<3>(sizes.0, corner, degrees, wall)),
            FigureKind::Pentagon => polygon!(peer::regular::<5>(sizes.0, corner, degrees, wall)),
            FigureKind::Hexagon => polygon!(peer::regular::<6>(sizes.0, corner, degrees, wall)),
            FigureKind::Heptagon => polygon!(peer::regular::<7>(sizes.0, corner, degrees, wall)),
            FigureKind::Octagon => polygon!(peer::regular::<8>(sizes.0, corner, degrees, wall)),
        }
    }
}

/// Returns the kind, sizes and wall of a figure, for the peer; None for a picture.
fn sizes(source: &Source) -> Option<(FigureKind, [f32; 2], Option<f32>)> {
    let Source::Figure(figure) = source else {
        return None;
    };
    #[expect(clippy::cast_possible_truncation, reason = "the peer computes in f32")]
    let get = |parameter| figure.get(parameter).map(|value| value as f32);
    let size = |index: usize| figure.kind().sizes().get(index).copied().and_then(get);
    let sizes = [size(0)?, size(1).unwrap_or(0.0)];
    Some((figure.kind(), sizes, get(Parameter::Thickness)))
}

/// The times of one row, and the number of distinct imprints.
#[derive(Default)]
struct Times {
    /// A sweep on one thread, and on two.
    sweeps: [Least; 2],
    /// One touch.
    touch: Least,
    /// One touch by the peer; pictures have none.
    peer: Option<Least>,
    distinct: usize,
}

/// Keeps all threads busy for a moment. A core of a virtual machine takes some milliseconds to wake up, which is half
/// of a short sweep: after 80 ms of work on one thread, a sweep took 13.4 ms on two threads, but 8.4 ms with both
/// cores awake, and 15.3 ms on one.
fn wake(pool: &rayon::ThreadPool) {
    pool.broadcast(|_| {
        let start = Instant::now();
        while start.elapsed() < Duration::from_millis(20) {
            std::hint::spin_loop();
        }
    });
}

/// A pool of one thread, and one of two.
struct Pools([rayon::ThreadPool; 2]);

impl Pools {
    fn new() -> Self {
        let pool = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("a pool of threads")
        };
        Self([pool(1), pool(2)])
    }

    /// Sweeps once on one thread and once on two.
    fn sweep(&self, grid: &PoseGrid, times: &mut Times) {
        for (pool, least) in self.0.iter().zip(&mut times.sweeps) {
            wake(pool);
            let result = least.measure(1, || pool.install(|| Sweep::new(grid).run()));
            times.distinct = result.atlas.len();
        }
    }
}

fn measure(pools: &Pools, grid: &PoseGrid) -> Times {
    let poses: Vec<Pose> = sample(grid).collect();
    let sources = placed(grid);
    let touches = u32::try_from(poses.len()).expect("a sample");
    let mut plane = Plane::new(*grid.sensor());
    let mut peer = Peer::new(grid.sensor().columns(), grid.sensor().rows());
    let mut times = Times::default();
    for _ in 0..ROUNDS {
        pools.sweep(grid, &mut times);
        let touch = || touch_all(&mut plane, &sources);
        times.touch.measure(touches, touch);
        if let Some((kind, sizes, wall)) = sizes(grid.source()) {
            let touch = || touch_peer(&mut peer, kind, sizes, wall, &poses);
            times.peer.get_or_insert_default().measure(touches, touch);
        }
    }
    times
}

/// Returns the processor time of a sweep on one thread, in nanoseconds a pose.
#[expect(clippy::cast_precision_loss, reason = "for reading")]
fn per_pose(times: &Times, grid: &PoseGrid) -> f64 {
    times.sweeps[0].nanoseconds() / grid.poses() as f64
}

/// Prints a row of the table of the paper's grid.
fn print(name: &str, grid: &PoseGrid, times: &Times) {
    let own = per_pose(times, grid);
    let [one, two] = times.sweeps;
    let touch = times.touch.nanoseconds();
    let (peer, ratio) = times.peer.map_or(("-".to_owned(), "-".to_owned()), |peer| {
        let peer = peer.nanoseconds();
        (format!("{peer:.0}"), format!("{:.0}", peer / own))
    });
    println!(
        "{name:<26} {:>8} {:>7.0} {own:>8.2} {:>7.2} {touch:>8.0} {peer:>8} {:>7.0} {ratio:>7}",
        times.distinct,
        one.processor * 1e3,
        one.wall / two.wall,
        touch / own,
    );
}

fn main() {
    let only = selected();
    let pools = Pools::new();
    println!(
        "3,600,000 poses    distinct      ms  ns/pose  2 thr.    touch     peer  touch:   peer:"
    );
    println!(
        "                                               times  ns/pose  ns/pose   sweep   sweep"
    );
    let cases = cases();
    for name in MEASURED.iter().filter(|name| name.contains(&only)) {
        let case = cases.iter().find(|case| case.name == *name);
        let grid = case.expect("it is in the list").grid("0:359:1", 1);
        print(name, &grid, &measure(&pools, &grid));
    }
    println!();
    println!("hexagon wall 1, 30 angles   poses  distinct       ms  ns/pose   times the first row");
    let mut first = None;
    for case in growing().iter().filter(|case| case.name.contains(&only)) {
        let grid = case.grid("1:59:2", 1);
        let mut times = Times::default();
        for _ in 0..ROUNDS {
            pools.sweep(&grid, &mut times);
        }
        let time = times.sweeps[0].processor;
        println!(
            "{:<26} {:>7} {:>8} {:>8.1} {:>8.1} {:>8.2}",
            case.name,
            grid.poses(),
            times.distinct,
            time * 1e3,
            per_pose(&times, &grid),
            time / *first.get_or_insert(time),
        );
    }
}
