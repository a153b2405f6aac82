//! Drawings as SVG.
//!
//! `INSTA_UPDATE=always cargo test --test files drawing` rewrites the SVG files; then look at them.

use std::path::Path;

use taxel_core::description::regions;
use taxel_core::figure::Figure;
use taxel_core::imprint::Imprint;
use taxel_core::picture::Picture;
use taxel_core::sensor::Sensor;
use taxel_core::touch::Plane;
use taxel_files::formats::{ConfusionMap, Drawing, Plot};

use crate::common::size;

/// Returns the ring of the paper's Fig. 1 and its imprint.
fn ring() -> (Figure, Imprint) {
    let sensor = Sensor::default();
    let figure = Figure::ellipse(4.0, 4.0)
        .at(1.99, 1.47)
        .thickness(2.0)
        .on(&sensor)
        .expect("in range");
    let imprint = Plane::new(sensor).touch(&figure);
    (figure, imprint)
}

fn golden(name: &str, svg: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/drawing"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, svg));
}

#[test]
fn the_papers_ring_is_drawn_in_millimetres() {
    let (figure, imprint) = ring();
    let mut drawing = Drawing::new(&imprint).with_outline(&figure);
    drawing.pitch_mm = Some(2.5);
    drawing.title = "Fig. 1 <of the paper>".to_owned();
    golden("ring", &drawing.svg());
}

#[test]
fn pieces_a_hole_and_a_picture_are_drawn_in_cells() {
    let imprint: Imprint = "#####..\n#...#..\n#.#.#.#\n#...#.#\n#####.."
        .parse()
        .expect("rows");
    let picture = Picture::at_home(imprint);
    golden(
        "pieces",
        &Drawing::new(&imprint).with_outline(&picture).svg(),
    );
    let hole = regions(&imprint).len() - 1;
    let mut drawing = Drawing::new(&imprint);
    drawing.region = Some(hole);
    golden("hole", &drawing.svg());
}

#[test]
fn absent_parts_are_not_drawn() {
    let empty = Drawing::new(&Imprint::empty(size(1, 2))).svg();
    golden("empty", &empty);
    for absent in ["rectangle", "CG", "CD", "outline", "cg"] {
        assert!(!empty.contains(absent), "{absent} in\n{empty}");
    }
    let imprint = Imprint::empty(size(3, 3));
    let plain = Drawing::new(&imprint).svg();
    let mut odd = Drawing::new(&imprint);
    odd.region = Some(7);
    for mm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        odd.pitch_mm = Some(mm);
        assert_eq!(odd.svg(), plain, "{mm} is no pitch");
    }
}

#[test]
fn every_size_and_title_has_a_page_of_bounded_size() {
    let long = "é<&>\"\u{1b}".repeat(1000);
    for (columns, rows) in [(1, 1), (1, 64), (64, 1), (64, 64), (3, 2)] {
        let imprint = Imprint::empty(size(columns, rows));
        let mut drawing = Drawing::new(&imprint);
        drawing.title.clone_from(&long);
        drawing.pitch_mm = Some(0.001);
        let svg = drawing.svg();
        let open = svg.matches('<').count();
        assert_eq!(open, svg.matches('>').count());
        assert!(
            svg.chars()
                .all(|character| character == '\n' || !character.is_control())
        );
        let head = svg.lines().next().expect("a first line");
        let size = head.split("viewBox=\"0 0 ").nth(1).expect("a view box");
        let sides: Vec<f64> = size
            .trim_end_matches("\">")
            .split(' ')
            .map(|side| side.parse().expect("a number"))
            .collect();
        assert!(
            sides.iter().all(|side| (40.0..700.0).contains(side)),
            "{head}"
        );
    }
}

#[test]
fn a_confusion_matrix_has_its_numbers_and_shades() {
    let labels = ["disc", "a long name <&>", "bar"].map(str::to_owned);
    let counts = [vec![90, 10, 0], vec![3, 9996, 1], vec![0, 0, 1_234_567]];
    let mut map = ConfusionMap::new(&labels, counts).expect("few shapes");
    map.title = "error 1 %".to_owned();
    let svg = map.svg();
    golden("confusion", &svg);
    for text in [
        ">90 %<",
        ">&lt;0.1 %<",
        ">&gt;99.9 %<",
        ">1234567<",
        ">100 %<",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    assert_eq!(map.svg().matches(">·</text>").count(), 3);
    // A missing count is 0, and an excess row or column is ignored.
    let odd = ConfusionMap::new(&labels, [vec![1; 9]]).expect("few shapes");
    assert_eq!(odd.svg().matches(">·</text>").count(), 6);
    let many = vec!["x".to_owned(); 65];
    assert!(ConfusionMap::new(&many, []).is_none() && ConfusionMap::new(&[], []).is_none());
}

#[test]
fn curves_have_axes_and_a_legend() {
    let plot = Plot::new("scale", "error")
        .with_curve("threshold 0.5", &[(0.5, 0.7), (1.0, 0.33), (2.0, 0.02)])
        .with_curve(
            "threshold 0.3",
            &[(0.5, 0.8), (1.0, 0.7), (f64::NAN, 1.0), (2.0, 0.1)],
        );
    golden("curves", &plot.svg());
    assert_eq!(plot.svg().matches("class=\"curve\"").count(), 2);
    // There is a page even without points.
    let empty = Plot::new(&"x".repeat(500), "y").with_curve("", &[]);
    assert!(empty.svg().contains("viewBox") && !empty.svg().contains("NaN"));
}

/// The place of a text and what surrounds it on the page are in points; its width follows from the font.
#[test]
fn the_page_holds_all_texts() {
    let long = "long ".repeat(30);
    let far = Plot::new(&long, &long).with_curve(&long, &[(1e12, 0.0)]);
    let mut pages = vec![far.svg()];
    let mut fine = Drawing::new(&Imprint::empty(size(1, 64)));
    fine.pitch_mm = Some(0.001);
    pages.push(fine.svg());
    for page in pages {
        let numbers = |text: &str, key: &str| -> Vec<f64> {
            let value = text.split_once(key).expect(key).1;
            let value = value.split(['"', ')']).next().expect("a value");
            value
                .split(' ')
                .map(|number| number.parse().expect(value))
                .collect()
        };
        let (size, moved) = (
            numbers(&page, "viewBox=\"0 0 "),
            numbers(&page, "translate("),
        );
        for line in page.lines().filter(|line| line.starts_with("<text")) {
            let text = line.split(['<', '>']).nth(2).expect("a text");
            let length = u16::try_from(text.chars().count()).expect("short");
            let length = f64::from(length) * 8.0 * 0.6;
            let [x, y] = [
                numbers(line, "x=\"")[0] + moved[0],
                numbers(line, "y=\"")[0] + moved[1],
            ];
            let before = match line {
                _ if line.contains("\"start") => 0.0,
                _ if line.contains("\"middle") => length / 2.0,
                _ => length,
            };
            let (low, high, size) = if line.contains("rotate") {
                (y + before - length, y + before, size[1])
            } else {
                (x - before, x - before + length, size[0])
            };
            assert!(low >= 0.0 && high <= size + 0.01, "{line}");
        }
    }
}
