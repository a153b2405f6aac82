//! One touch with all descriptors of all regions, compared with code that one would write without taxel ([`peer`]).
//!
//! Measures three figures with both, and each stage of taxel by itself: figure to imprint, imprint to regions, regions
//! to every value of [`DESCRIPTORS`]. Also measures the time from a key press to the drawn screen. An argument after
//! `--` selects figures and keys by a part of their names.

use std::hint::black_box;

use taxel::tui::app::Options;
use taxel::tui::jobs::Jobs;
use taxel::tui::script::Session;
use taxel_core::description::{DESCRIPTORS, Description, Region, RegionKind, each_region, regions};
use taxel_core::figure::{Figure, FigureKind};
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;
use taxel_core::touch::Plane;

use peer::{Outline, Peer};
use timing::{Work, in_turn, selected};

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
mod peer;
mod timing;

/// Enough for both to run undisturbed at least once.
const ROUNDS: usize = 300;

fn figure(kind: FigureKind, values: &[(Parameter, f64)]) -> Figure {
    let value = |parameter| {
        let given = values.iter().find(|(of, _)| *of == parameter);
        given.map(|&(_, value)| value)
    };
    Figure::new(kind, &Sensor::default(), value).expect("a figure of the paper's range")
}

fn rectangle() -> Figure {
    use Parameter::{Angle, Length, Width, X0, Y0};
    let values = [
        (Length, 6.0),
        (Width, 3.0),
        (X0, 5.3),
        (Y0, 6.1),
        (Angle, 30.0),
    ];
    figure(FigureKind::Rectangle, &values)
}

fn hexagon() -> Figure {
    use Parameter::{Angle, Side, Thickness, X0, Y0};
    let values = [
        (Side, 3.0),
        (X0, 5.3),
        (Y0, 4.1),
        (Angle, 17.0),
        (Thickness, 1.0),
    ];
    figure(FigureKind::Hexagon, &values)
}

fn circle() -> Figure {
    use Parameter::{Angle, RadiusX, RadiusY, Thickness, X0, Y0};
    let values = [
        (RadiusX, 4.0),
        (RadiusY, 4.0),
        (X0, 4.37),
        (Y0, 4.21),
        (Angle, 0.0),
        (Thickness, 2.0),
    ];
    figure(FigureKind::Ellipse, &values)
}

/// Computes every value of the table of descriptors.
fn describe(region: &Region) {
    let description = Description::of(region);
    for descriptor in DESCRIPTORS {
        black_box((descriptor.measure)(&description));
    }
}

fn peer_rectangle(peer: &mut Peer) -> &[peer::Region] {
    let (size, corner, degrees) = black_box(((6.0, 3.0), (5.3, 6.1), 30.0));
    let (exterior, hole) = peer::rectangle(size, corner, degrees, None);
    let hole = hole.as_ref().map(|hole| Outline::Polygon(hole));
    peer.touch(&Outline::Polygon(&exterior), hole.as_ref())
}

fn peer_hexagon(peer: &mut Peer) -> &[peer::Region] {
    let (side, corner, degrees, wall) = black_box((3.0, (5.3, 4.1), 17.0, Some(1.0)));
    let (exterior, hole) = peer::regular::<6>(side, corner, degrees, wall);
    let hole = hole.as_ref().map(|hole| Outline::Polygon(hole));
    peer.touch(&Outline::Polygon(&exterior), hole.as_ref())
}

fn peer_circle(peer: &mut Peer) -> &[peer::Region] {
    let (radii, corner, degrees, wall) = black_box(((4.0, 4.0), (4.37, 4.21), 0.0, Some(2.0)));
    let (exterior, hole) = peer::ellipse(radii, corner, degrees, wall);
    peer.touch(&exterior, hole.as_ref())
}

type PeerTouch = fn(&mut Peer) -> &[peer::Region];
type Case = (&'static str, fn() -> Figure, PeerTouch);
const FIGURES: [Case; 3] = [
    ("rectangle", rectangle, peer_rectangle),
    ("hexagon", hexagon, peer_hexagon),
    ("circle", circle, peer_circle),
];

/// Checks that the imprint and every number are equal. The comparison is only fair if both do the same work.
fn assert_alike(name: &str, plane: &mut Plane, figure: &Figure, peer: &mut Peer, touch: PeerTouch) {
    let imprint = plane.touch(figure);
    let theirs = touch(peer).to_vec();
    let active = peer.image().enumerate_pixels();
    let pixels = active.filter(|(_, _, pixel)| pixel.0[0] != 0);
    assert!(
        pixels
            .map(|(x, y, _)| (x, y))
            .eq(imprint.active().map(|(x, y)| (u32::from(x), u32::from(y)))),
        "{name}: the imprints differ"
    );
    let ours = regions(&imprint);
    assert_eq!(ours.len(), theirs.len(), "{name}: the regions differ");
    for (region, theirs) in ours.iter().zip(&theirs) {
        let own = Description::of(region);
        let counts = (own.na, own.nae, own.ce, own.kind == RegionKind::Hole);
        assert_eq!(
            counts,
            (theirs.na, theirs.nae, theirs.ce, theirs.hole),
            "{name}: the counts differ"
        );
        let numbers = [
            (own.num_x, theirs.num.0),
            (own.num_y, theirs.num.1),
            (own.steps.length(), theirs.p),
            (own.cg().x, theirs.cg.0),
            (own.cd().y, theirs.cd.1),
        ];
        assert!(
            numbers.iter().all(|(a, b)| (a - b).abs() < 1e-9),
            "{name}: the numbers differ"
        );
    }
}

/// Measures a touch with all descriptors, and the same by the peer.
fn touch(name: &str, figure: &Figure, peer_touch: PeerTouch) {
    let mut plane = Plane::new(Sensor::default());
    let mut peer = Peer::new(16, 16);
    assert_alike(name, &mut plane, figure, &mut peer, peer_touch);
    let own = Work::new(|| each_region(plane.touched(black_box(figure)), describe));
    let theirs = Work::new(|| {
        black_box(peer_touch(&mut peer));
    });
    let [own, theirs] = in_turn(ROUNDS, [own, theirs]).map(|least| least.nanoseconds());
    println!("{name:<10} {own:>7.0} {theirs:>8.0} {:>13.2}", theirs / own);
}

/// Measures the stages of a touch, each by itself.
fn stages(name: &str, figure: &Figure) {
    let mut plane = Plane::new(Sensor::default());
    let imprint = plane.touch(figure);
    let found = regions(&imprint);
    let touch = Work::new(|| {
        black_box(plane.touched(black_box(figure)));
    });
    let regions = Work::new(|| {
        each_region(black_box(&imprint), |region| {
            black_box(region);
        });
    });
    let descriptors = Work::new(|| black_box(&found).iter().for_each(describe));
    let stages = in_turn(ROUNDS, [touch, regions, descriptors]);
    let [touch, regions, descriptors] = stages.map(|least| least.nanoseconds());
    println!("{name:<10} {touch:>7.0} {regions:>8.0} {descriptors:>13.0}");
}

/// Measures the time from a key press to a finished frame of 80 × 24 in a test buffer. Two keys and two frames restore
/// the first state.
fn frame(name: &str, keys: [&str; 2]) {
    let world = Jobs::scratch().expect("a folder for the time being");
    let mut session = Session::new(&Options::plain(false), world, 80, 24);
    session.keys("f<Enter>").expect("keys that exist");
    let both = Work::new(|| {
        for key in keys {
            session.keys(black_box(key)).expect("keys that exist");
            // The screen is drawn when its cursor is asked for.
            black_box(session.cursor());
        }
    });
    let [both] = in_turn(ROUNDS, [both]);
    println!("{name:<10} {:>7.0}", both.nanoseconds() / 2e3);
}

fn main() {
    let selected = selected();
    let figures = FIGURES.iter().filter(|(name, ..)| name.contains(&selected));
    println!("touch        taxel     peer  peer / taxel    ns, all descriptors of all regions");
    for (name, figure, peer_touch) in figures.clone() {
        touch(name, &figure(), *peer_touch);
    }
    println!("\nstage      imprint  regions   descriptors    ns");
    for (name, figure, _) in figures {
        stages(name, &figure());
    }
    println!("\nkey          frame    µs");
    // `u` undoes, so that the history does not grow.
    let keys = [
        ("move", ["<Right>", "<Left>"]),
        ("toggle", ["<Space>", "u"]),
    ];
    for (name, keys) in keys.iter().filter(|(name, _)| name.contains(&selected)) {
        frame(name, *keys);
    }
}
