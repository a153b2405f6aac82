//! Outlines beside shapely, which clips polygons by GEOS: coverages of polygons with holes, and the union of the paths of
//! an SVG. `examples/outlines.py` made the data. Random unions are compared with the fill rules, point by point.

use proptest::prelude::*;
use serde::Deserialize;
use taxel_core::outline::{Outline, Ring};
use taxel_core::parameter::Parameter;
use taxel_core::source::Source;
use taxel_core::touch::Plane;
use taxel_files::formats::{OutlineOptions, OutlineUnit, read_outline};

use crate::common::sensor;
use crate::property::config;

const DATA: &str = include_str!("../data/outlines.json");

#[derive(Deserialize)]
struct Data {
    coverages: Vec<Case>,
    drawing: Drawing,
}

#[derive(Deserialize)]
struct Case {
    rings: Vec<Vec<[f64; 2]>>,
    coverage: Vec<f64>,
    #[serde(flatten)]
    touch: Touch,
}

#[derive(Deserialize)]
struct Drawing {
    svg: String,
    pitch_mm: f64,
    area: f64,
    touches: Vec<Touch>,
}

#[derive(Deserialize)]
struct Touch {
    x0: f64,
    y0: f64,
    angle: f64,
    imprint: Vec<String>,
}

impl Touch {
    /// Touches with the outline here, and checks the imprint.
    fn check(&self, outline: &Outline, plane: &mut Plane) {
        let place = |parameter: Parameter| match parameter {
            Parameter::X0 => Some(self.x0),
            Parameter::Y0 => Some(self.y0),
            Parameter::Angle => Some(self.angle),
            _ => Some(1.0),
        };
        let placed = Source::from(outline.clone())
            .placed(plane.sensor(), place)
            .expect("in range");
        assert_eq!(
            plane.touch(&placed).to_string(),
            self.imprint.join("\n"),
            "{placed}"
        );
    }
}

fn data() -> Data {
    serde_json::from_str(DATA).expect("the data of examples/outlines.py")
}

#[test]
fn polygons_with_holes_cover_what_they_cover_in_shapely() {
    let mut plane = Plane::new(sensor(12, 12, 0.5));
    let mut ties = 0;
    for case in data().coverages {
        let rings = case.rings.into_iter().map(Ring::Polygon).collect();
        let outline = Outline::new(rings, None).expect("rings that do not cross");
        case.touch.check(&outline, &mut plane);
        for (own, other) in plane.coverages().values().iter().zip(&case.coverage) {
            assert!((own - other).abs() < 1e-9, "{own} and {other}");
            ties += usize::from(*other == 0.5);
        }
    }
    assert!(ties > 100, "{ties} ties");
}

#[test]
fn the_paths_of_an_svg_are_united_as_by_shapely() {
    let drawing = data().drawing;
    let options = OutlineOptions {
        pitch_mm: drawing.pitch_mm,
        ..OutlineOptions::default()
    };
    let read = read_outline(drawing.svg.as_bytes(), &options).expect("an SVG");
    assert_eq!(
        (read.unit, &read.left_out[..]),
        (OutlineUnit::Mm, &["1 stroke".to_owned()][..])
    );
    let area: f64 = read
        .rings
        .iter()
        .map(|ring| twice_area(points(ring)))
        .sum::<f64>()
        / 2.0;
    assert!(
        (area.abs() - drawing.area).abs() < 1e-6,
        "{area} and {}",
        drawing.area
    );
    let outline =
        Outline::new(read.rings, Some(drawing.pitch_mm)).expect("rings that do not cross");
    let mut plane = Plane::new(sensor(12, 12, 0.5));
    for touch in drawing.touches {
        touch.check(&outline, &mut plane);
    }
}

fn points(ring: &Ring) -> &[[f64; 2]] {
    match ring {
        Ring::Polygon(points) => points,
        Ring::Ellipse(_) => &[],
    }
}

fn edges(ring: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    ring.iter()
        .copied()
        .zip(ring.iter().copied().cycle().skip(1))
}

fn twice_area(ring: &[[f64; 2]]) -> f64 {
    edges(ring).map(|([a, b], [c, d])| a * d - b * c).sum()
}

/// How often a ring runs around a point.
fn winding(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> i32 {
    let passed = edges(ring).filter(|(from, to)| (from[1] <= y) != (to[1] <= y));
    let left = passed.filter(|(from, to)| {
        let part = (y - from[1]) / (to[1] - from[1]);
        from[0] + part * (to[0] - from[0]) < x
    });
    left.map(|(from, to)| if from[1] < to[1] { 1 } else { -1 })
        .sum()
}

/// A path on half cells, where edges touch and overlap: its rings, its fill rule, and by how much it is turned.
type Path = (Vec<Vec<(i32, i32)>>, bool, i32);

fn paths() -> impl Strategy<Value = Vec<Path>> {
    let ring = proptest::collection::vec((0..12, 0..12), 3..9);
    let path = (proptest::collection::vec(ring, 1..3), any::<bool>(), -1..2);
    proptest::collection::vec(path, 1..6)
}

proptest! {
    #![proptest_config(config(3000))]

    #[test]
    fn a_union_is_an_outline_of_what_any_path_fills(paths in paths()) {
        let mut svg = "<svg>".to_owned();
        let mut drawn = Vec::new();
        for (rings, even_odd, turns) in &paths {
            let angle = 17 * turns;
            let rule = if *even_odd { "evenodd" } else { "nonzero" };
            svg += &format!("<path transform='rotate({angle})' fill-rule='{rule}' d='");
            let (sin, cos) = f64::from(angle).to_radians().sin_cos();
            let mut turned = Vec::new();
            for ring in rings {
                let half = ring.iter().map(|&(x, y)| [f64::from(x) / 2.0, f64::from(y) / 2.0]);
                let corners: Vec<String> = half.clone().map(|[x, y]| format!("{x},{y}")).collect();
                svg += &format!("M{}z", corners.join(" "));
                turned.push(half.map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]).collect::<Vec<_>>());
            }
            svg += "'/>";
            drawn.push((turned, *even_odd));
        }
        svg += "</svg>";
        let rings = match read_outline(svg.as_bytes(), &OutlineOptions::default()) {
            Ok(read) => read.rings,
            Err(error) => {
                prop_assert_eq!(error.to_string(), "no filled shape");
                Vec::new()
            }
        };
        prop_assert!(rings.is_empty() || Outline::new(rings.clone(), None).is_ok());
        // Nowhere near an edge of the lattice, and few are near a turned one.
        for (x, y) in (0..20).flat_map(|x| (0..20).map(move |y| (x, y))) {
            let place = [f64::from(x) * 0.473_137_9 - 2.017_331_7, f64::from(y) * 0.411_731_3 - 2.023_713_1];
            let fills = |(rings, even_odd): &(Vec<Vec<[f64; 2]>>, bool)| {
                let turns: i32 = rings.iter().map(|ring| winding(ring, place)).sum();
                if *even_odd { turns % 2 != 0 } else { turns != 0 }
            };
            let turns: i32 = rings.iter().map(|ring| winding(points(ring), place)).sum();
            prop_assert_eq!(turns % 2 != 0, drawn.iter().any(fills), "{:?} of {}", place, svg);
        }
    }
}
