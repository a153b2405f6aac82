//! Figures and pictures whose sweeps are measured and compared with single touches, and the comparison.

use std::ops::ControlFlow;

use taxel_core::figure::{Figure, FigureKind};
use taxel_core::outline::{EllipseRing, Outline, Ring};
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::pose::{Anchor, Axis, PoseGrid, Ranges};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::{Sweep, SweepResult};
use taxel_core::touch::{Plane, reaches_beyond};

/// A source to sweep, with its sensor and ranges.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) source: Source,
    pub(crate) sensor: Sensor,
    pub(crate) anchor: Anchor,
    /// The range of x0 and y0; empty for the one of the paper's grid.
    pub(crate) place: &'static str,
    pub(crate) zoom: &'static str,
}

/// Returns a figure with a first and a second size (regular polygons ignore the second) and a wall, 0 for none.
pub(crate) fn figure(kind: FigureKind, first: f64, second: f64, wall: f64) -> Source {
    let figure = Figure::new(kind, &Sensor::LARGEST, |parameter| match parameter {
        Parameter::RadiusX | Parameter::Length | Parameter::Side => Some(first),
        Parameter::RadiusY | Parameter::Width => Some(second),
        Parameter::Thickness => (wall > 0.0).then_some(wall),
        _ => Some(0.0),
    });
    Source::Figure(figure.expect("sizes are in range"))
}

pub(crate) fn picture(rows: &str) -> Source {
    let imprint = rows.replace(' ', "\n").parse().expect("rows of an imprint");
    Source::Picture(Picture::at_home(imprint))
}

/// Returns an outline of polygons and ellipses (centre, radii, angle).
pub(crate) fn outline(polygons: &[&[[f64; 2]]], ellipses: &[[f64; 5]]) -> Source {
    let polygons = polygons.iter().map(|points| Ring::Polygon(points.to_vec()));
    let ellipses = ellipses.iter().map(|&[cx, cy, rx, ry, angle]| {
        Ring::Ellipse(EllipseRing {
            centre: [cx, cy],
            radii: [rx, ry],
            angle,
        })
    });
    let outline = Outline::new(polygons.chain(ellipses).collect(), None);
    Source::Outline(outline.expect("rings that do not cross"))
}

/// Returns a wheel of 20 teeth. Its points are rounded to thousandths, so it has no symmetry.
fn gear() -> Source {
    let points = (0..40).map(|point| {
        let radius = if point % 2 == 0 { 3.0 } else { 2.4 };
        let (sin, cos) = libm::sincos(f64::from(9 * point).to_radians());
        [cos, sin].map(|part| (1000.0 * (3.01 + radius * part)).round() / 1000.0)
    });
    outline(&[&points.collect::<Vec<_>>()], &[])
}

pub(crate) fn sensor(columns: u8, rows: u8, threshold: f64) -> Sensor {
    let sensor = Sensor::new(columns, rows).expect("sides are in range");
    sensor
        .with(Parameter::Threshold, threshold)
        .expect("a threshold in range")
}

/// Returns all kinds, solid and with a hole: sizes that cause ties, figures beyond the sensor, other sensors,
/// thresholds and anchors.
pub(crate) fn cases() -> Vec<Case> {
    let case = |name, source| Case {
        name,
        source,
        sensor: Sensor::default(),
        anchor: Anchor::Corner,
        place: "",
        zoom: "1",
    };
    let mut all = vec![
        case(
            "rectangle 6 x 3",
            figure(FigureKind::Rectangle, 6.0, 3.0, 0.0),
        ),
        case("square 4", figure(FigureKind::Rectangle, 4.0, 4.0, 0.0)),
        case("square 0.7", figure(FigureKind::Rectangle, 0.7, 0.7, 0.0)),
        case(
            "rectangle 5.5 x 2.5 wall 1",
            figure(FigureKind::Rectangle, 5.5, 2.5, 1.0),
        ),
        // At 5 its corners would be beyond the sensor.
        Case {
            place: "2.5:3.49:0.01",
            ..case(
                "rectangle 10 x 8 wall 0.7",
                figure(FigureKind::Rectangle, 10.0, 8.0, 0.7),
            )
        },
        case(
            "rectangle 10 x 8 wall 0.7 beyond",
            figure(FigureKind::Rectangle, 10.0, 8.0, 0.7),
        ),
        case(
            "rectangle 9 x 0.5",
            figure(FigureKind::Rectangle, 9.0, 0.5, 0.0),
        ),
        case(
            "rectangle 7 x 7 wall 0.25",
            figure(FigureKind::Rectangle, 7.0, 7.0, 0.25),
        ),
        case("triangle 6", figure(FigureKind::Triangle, 6.0, 0.0, 0.0)),
        case(
            "triangle 8 wall 1",
            figure(FigureKind::Triangle, 8.0, 0.0, 1.0),
        ),
        case("pentagon 4", figure(FigureKind::Pentagon, 4.0, 0.0, 0.0)),
        case(
            "pentagon 3.5 wall 0.8",
            figure(FigureKind::Pentagon, 3.5, 0.0, 0.8),
        ),
        case(
            "hexagon 3 wall 1",
            figure(FigureKind::Hexagon, 3.0, 0.0, 1.0),
        ),
        case("hexagon 4", figure(FigureKind::Hexagon, 4.0, 0.0, 0.0)),
        case("heptagon 3", figure(FigureKind::Heptagon, 3.0, 0.0, 0.0)),
        case(
            "heptagon 3 wall 1",
            figure(FigureKind::Heptagon, 3.0, 0.0, 1.0),
        ),
        case(
            "octagon 3 wall 1.5",
            figure(FigureKind::Octagon, 3.0, 0.0, 1.5),
        ),
        case("octagon 2", figure(FigureKind::Octagon, 2.0, 0.0, 0.0)),
        case(
            "outline with holes and a second piece",
            outline(
                &[
                    &[[0.0, 0.0], [7.0, 0.0], [7.0, 2.5], [3.5, 6.0], [0.0, 5.0]],
                    &[[1.0, 1.0], [1.0, 2.0], [2.5, 2.0], [2.5, 1.0]],
                    &[[6.0, 4.5], [7.5, 4.5], [7.5, 6.0]],
                ],
                &[],
            ),
        ),
        case("outline of 40 edges", gear()),
        case(
            "drilled plate",
            outline(
                &[&[[0.0, 0.0], [8.0, 0.0], [8.0, 4.0], [4.0, 5.5], [0.0, 4.0]]],
                &[[2.0, 2.0, 1.0, 1.0, 0.0], [5.5, 2.5, 1.5, 0.75, 30.0]],
            ),
        ),
        case(
            "flange of circles",
            outline(
                &[],
                &[
                    [4.0, 4.0, 4.0, 4.0, 0.0],
                    [1.5, 4.0, 0.75, 0.75, 0.0],
                    [6.5, 4.0, 0.75, 0.75, 0.0],
                ],
            ),
        ),
        case("ellipse 5 x 3", figure(FigureKind::Ellipse, 5.0, 3.0, 0.0)),
        case(
            "ellipse 5 x 3 wall 1",
            figure(FigureKind::Ellipse, 5.0, 3.0, 1.0),
        ),
        case(
            "ellipse 4.5 x 1.5 wall 0.4",
            figure(FigureKind::Ellipse, 4.5, 1.5, 0.4),
        ),
        case(
            "ellipse 6 x 0.3",
            figure(FigureKind::Ellipse, 6.0, 0.3, 0.0),
        ),
        case(
            "circle 4 wall 2",
            figure(FigureKind::Ellipse, 4.0, 4.0, 2.0),
        ),
        case("circle 0.5", figure(FigureKind::Ellipse, 0.5, 0.5, 0.0)),
    ];
    let beyond = |case| Case {
        place: "-1:0.99:0.01",
        ..case
    };
    all.extend([
        beyond(case(
            "hexagon 3 wall 1 beyond",
            figure(FigureKind::Hexagon, 3.0, 0.0, 1.0),
        )),
        beyond(case(
            "ellipse 5 x 3 wall 1 beyond",
            figure(FigureKind::Ellipse, 5.0, 3.0, 1.0),
        )),
        Case {
            sensor: sensor(8, 8, 0.5),
            place: "0:1.99:0.01",
            ..case(
                "rectangle 8 x 8 wall 2 on 8 x 8",
                figure(FigureKind::Rectangle, 8.0, 8.0, 2.0),
            )
        },
        Case {
            sensor: sensor(33, 20, 0.5),
            ..case(
                "octagon 6 wall 2 on 33 x 20",
                figure(FigureKind::Octagon, 6.0, 0.0, 2.0),
            )
        },
        Case {
            sensor: sensor(16, 16, 1.0),
            ..case(
                "rectangle 6 x 3, threshold 1",
                figure(FigureKind::Rectangle, 6.0, 3.0, 0.0),
            )
        },
        Case {
            sensor: sensor(16, 16, 1.0),
            ..case(
                "circle 4 wall 2, threshold 1",
                figure(FigureKind::Ellipse, 4.0, 4.0, 2.0),
            )
        },
        Case {
            sensor: sensor(16, 16, 0.25),
            ..case(
                "triangle 6 wall 1, threshold 0.25",
                figure(FigureKind::Triangle, 6.0, 0.0, 1.0),
            )
        },
        Case {
            anchor: Anchor::Centre,
            place: "7.5:8.49:0.01",
            ..case(
                "triangle 6, centre",
                figure(FigureKind::Triangle, 6.0, 0.0, 0.0),
            )
        },
        Case {
            anchor: Anchor::Centre,
            place: "7.5:8.49:0.01",
            ..case(
                "pentagon 4 wall 1, centre",
                figure(FigureKind::Pentagon, 4.0, 0.0, 1.0),
            )
        },
        Case {
            anchor: Anchor::Centre,
            place: "7.5:8.49:0.01",
            ..case(
                "ellipse 4 x 2, centre",
                figure(FigureKind::Ellipse, 4.0, 2.0, 0.0),
            )
        },
        Case {
            place: "5:5.99:0.03",
            ..case(
                "hexagon 3, steps of 0.03",
                figure(FigureKind::Hexagon, 3.0, 0.0, 0.0),
            )
        },
        case("picture: one taxel", picture("#")),
        case("picture: ring", picture("#### #..# #..# ####")),
        case("picture: scattered", picture("##.# .### ##.. #..#")),
        case("picture: half turn", picture("##.# .##. #.##")),
        case("picture: cross", picture(".#. ### .#.")),
        case(
            "picture: letter",
            picture("..###.. .#..... .#..... .####.. .....#. #....#. .####.."),
        ),
        Case {
            place: "4:4.99:0.01",
            zoom: "0.75:1.25:0.25",
            ..case("picture: zoomed", picture("###. #..# ####"))
        },
        Case {
            anchor: Anchor::Centre,
            place: "7.5:8.49:0.01",
            zoom: "1.1",
            ..case("picture: zoomed, centre", picture("###. #..# ####"))
        },
        case("picture: empty", picture("... ...")),
    ]);
    all
}

impl Case {
    /// Returns the grid of the case at the given angles, with only every `stride`-th step of x0 and y0.
    pub(crate) fn grid(&self, angles: &str, stride: u32) -> PoseGrid {
        let place = if self.place.is_empty() {
            "5:5.99:0.01"
        } else {
            self.place
        };
        let parts: Vec<f64> = place
            .split(':')
            .map(|part| part.parse().expect("a number"))
            .collect();
        let [start, end, step] = parts[..] else {
            panic!("a range")
        };
        let place = format!(
            "{start}:{end}:{}",
            (step * f64::from(stride) * 1e6).round() / 1e6
        );
        let read = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, read(&place))
            .with(Axis::Y0, read(&place))
            .with(Axis::Angle, read(angles))
            .with(Axis::ZoomX, read(self.zoom))
            .with(Axis::ZoomY, read(self.zoom));
        PoseGrid::new(self.source.clone(), self.sensor, self.anchor, ranges).expect("a grid")
    }
}

/// Sweeps the grid and touches it pose by pose. Returns the number of poses that differ, or a message about another
/// difference. A sweep that does not report rows uses other code, which must give the same result.
pub(crate) fn differences(grid: &PoseGrid) -> Result<u64, String> {
    let poses = usize::try_from(grid.poses()).expect("a small grid");
    let width = usize::try_from(grid.row_length()).expect("a small grid");
    let mut ids = vec![u32::MAX; poses];
    let mut take = |row: u64, numbers: &[u32]| {
        let start = usize::try_from(row).expect("a small grid") * width;
        assert!(ids[start..start + width].iter().all(|&id| id == u32::MAX));
        ids[start..start + width].copy_from_slice(numbers);
        ControlFlow::Continue(())
    };
    let result = Sweep::new(grid).run_with_rows(&mut take);
    let imprints: Vec<_> = result.atlas.entries().collect();
    let free = Sweep::new(grid).run();
    let told = |result: &SweepResult| format!("{:?}", result.statistics);
    if free != result || told(&free) != told(&result) {
        return Err("without rows the result is another one".to_owned());
    }
    let mut plane = Plane::new(*grid.sensor());
    let (mut differing, mut partly_off, mut empty) = (0, 0, 0);
    let mut known = 0;
    let mut counts = vec![0_u64; imprints.len()];
    for (number, &id) in (0..).zip(&ids) {
        let placed = grid.placed(number);
        let touched = plane.touch(&placed);
        let entry = imprints
            .get(id as usize)
            .ok_or_else(|| format!("pose {number} has no imprint"))?;
        differing += u64::from(touched != entry.imprint);
        partly_off += u64::from(reaches_beyond(&placed, grid.sensor()));
        empty += u64::from(touched.is_empty());
        counts[id as usize] += 1;
        if id == known {
            if entry.first_pose != number {
                return Err(format!(
                    "{id} is first said to occur at {}",
                    entry.first_pose
                ));
            }
            known += 1;
        } else if id > known {
            return Err(format!("{id} occurs before {known}"));
        }
    }
    let claimed = (result.poses, result.partly_off, result.atlas.empty_poses());
    if claimed != (grid.poses(), partly_off, empty) {
        return Err(format!(
            "{claimed:?} instead of {partly_off} partly off, {empty} empty"
        ));
    }
    if imprints
        .iter()
        .zip(&counts)
        .any(|(entry, &count)| entry.count != count)
    {
        return Err("an imprint is counted wrongly".to_owned());
    }
    Ok(differing)
}
