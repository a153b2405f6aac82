//! The filled shapes of an SVG document.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Display;

use i_overlay::core::fill_rule::FillRule;
use kurbo::{Affine, Point, SvgArc, Vec2};
use roxmltree::{Document, Node, ParsingOptions};
use simplecss::{AttributeOperator, DeclarationTokenizer, PseudoClass, StyleSheet};
use svgtypes::{Length, LengthUnit, Paint, PathParser, PathSegment, Transform, ViewBox};
use taxel_core::quote::{shortened, shortened_message};

use super::curves::Chords;
use super::unite::{Path, unite};
use super::{OutlineOptions, OutlineUnit, ReadOutline};
use crate::error::ReadError;

/// The side of the unit px in mm.
const PIXEL: f64 = 25.4 / 96.0;

/// How deep elements may be nested; a `use` counts, too.
const DEEPEST: usize = 100;

/// Limits the work for all elements together, in bytes looked at: a `use` may repeat others over and over.
const MOST_WORK: usize = 1 << 28;

/// Reads a document.
pub(super) fn read(text: &str, options: &OutlineOptions) -> Result<ReadOutline, ReadError> {
    check_entities(text)?;
    let parsing = ParsingOptions {
        allow_dtd: true,
        nodes_limit: 1 << 20,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text, parsing).map_err(|error| {
        let (place, message) = (error.pos(), error.to_string());
        // Without the place, which stands at the end, too.
        let message = message
            .rsplit_once(" at ")
            .map_or(&*message, |(own, _)| own);
        let error = ReadError::new(format!("malformed XML: {}", shortened_message(message)));
        error.in_line(place.row.into()).in_column(place.col.into())
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let found = shortened(root.tag_name().name());
        return Err(ReadError::new(format!("found <{found}>, expected <svg>")));
    }
    let (scale, unit) = scale(root, options)?;
    let cell = match unit {
        OutlineUnit::Mm => options.pitch_mm,
        OutlineUnit::Cells => 1.0,
    };
    let flatness = options.flatness * cell;
    let ids = document.descendants().rev();
    let mut reader = Reader {
        ids: ids
            .filter_map(|node| Some((node.attribute("id")?, node)))
            .collect(),
        styles: styles(&document)?,
        chords: Chords::new(flatness),
        paths: Vec::new(),
        left_out: BTreeMap::new(),
        work: 0,
    };
    let look = Look {
        map: Affine::scale(scale),
        depth: 0,
        fill: true,
        stroke: false,
        is_visible: true,
        rule: FillRule::NonZero,
    };
    reader.element(root, look)?;
    let rings = unite(&reader.paths, flatness)?;
    let ending = |count: usize| if count == 1 { "" } else { "s" };
    let left_out = reader.left_out.into_iter();
    let left_out: Vec<String> = left_out
        .map(|(what, count)| format!("{count} {what}{}", ending(count)))
        .collect();
    if rings.is_empty() {
        let others = match &*left_out.join(", ") {
            "" => String::new(),
            others => format!("; left out: {others}"),
        };
        return Err(ReadError::new(format!("no filled shape{others}")));
    }
    Ok(ReadOutline {
        rings,
        unit,
        left_out,
    })
}

/// Checks that entities cannot expand to much. Each may refer to others 255 times.
fn check_entities(text: &str) -> Result<(), ReadError> {
    let Some(first) = text.find("<!ENTITY") else {
        return Ok(());
    };
    let end = text.rfind("<svg").unwrap_or(text.len()).max(first);
    if 255 * (end - first) * text.matches('&').count() > 1 << 26 {
        let message = "its entities may expand to more than 64 MiB";
        return Err(ReadError::new(message));
    }
    Ok(())
}

/// Returns the length of a unit of the document, and in what.
fn scale(root: Node, options: &OutlineOptions) -> Result<(f64, OutlineUnit), ReadError> {
    if let Some(scale) = options.mm_per_unit {
        return Ok((scale, OutlineUnit::Mm));
    }
    let seen = root
        .attribute("viewBox")
        .map(str::parse::<ViewBox>)
        .transpose();
    let seen = seen.map_err(|error| wrong(root, "viewBox", &error))?;
    let mut scale: Option<f64> = None;
    for (name, side) in [
        ("width", seen.map(|own| own.w)),
        ("height", seen.map(|own| own.h)),
    ] {
        let Some(text) = root.attribute(name).filter(|text| *text != "auto") else {
            continue;
        };
        let length = text.trim().parse::<Length>().ok().and_then(millimetres);
        let Some((mm, unit)) = length.filter(|(mm, _)| *mm > 0.0) else {
            let found = shortened(text);
            let message = format!("found {found:?}, no clear size; --mm-per-unit gives one");
            return Err(wrong(root, name, &message));
        };
        if !matches!(unit, LengthUnit::None | LengthUnit::Px) {
            let own = side.map_or(PIXEL, |side| mm / side);
            scale = Some(scale.map_or(own, |scale| scale.min(own)));
        }
    }
    Ok(scale.map_or((1.0, OutlineUnit::Cells), |scale| (scale, OutlineUnit::Mm)))
}

/// Returns a length in mm, if its unit is one of length.
fn millimetres(length: Length) -> Option<(f64, LengthUnit)> {
    let unit = match length.unit {
        LengthUnit::Mm => 1.0,
        LengthUnit::Cm => 10.0,
        LengthUnit::In => 25.4,
        LengthUnit::Pt => 25.4 / 72.0,
        LengthUnit::Pc => 25.4 / 6.0,
        LengthUnit::Px | LengthUnit::None => PIXEL,
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => return None,
    };
    Some((length.number * unit, length.unit))
}

/// Returns the style sheets of a document.
fn styles<'a>(document: &'a Document) -> Result<StyleSheet<'a>, ReadError> {
    let mut styles = StyleSheet::new();
    for node in document
        .descendants()
        .filter(|node| node.tag_name().name() == "style")
    {
        styles.parse_more(node.text().unwrap_or_default());
    }
    for rule in &styles.rules {
        let selector = rule.selector.to_string();
        if selector.contains([' ', '>', '+']) {
            let found = shortened(&selector);
            let message = format!("style of {found:?}: expected a selector of one element");
            return Err(ReadError::new(message));
        }
    }
    Ok(styles)
}

fn wrong(node: Node, name: &str, message: &impl Display) -> ReadError {
    let element = shortened(node.tag_name().name());
    let message = shortened_message(&message.to_string());
    placed(
        node,
        ReadError::new(format!("<{element}> {name}: {message}")),
    )
}

/// The same error, at this element.
fn placed(node: Node, error: ReadError) -> ReadError {
    let place = node.document().text_pos_at(node.range().start);
    error.in_line(place.row.into()).in_column(place.col.into())
}

/// What an element inherits from those around it.
#[derive(Clone, Copy)]
struct Look {
    map: Affine,
    depth: usize,
    fill: bool,
    stroke: bool,
    is_visible: bool,
    rule: FillRule,
}

/// An element with the values of its attributes and its style; later ones win.
struct Element<'a>(Node<'a, 'a>, Vec<(&'a str, &'a str)>);

impl<'a> Element<'a> {
    fn get(&self, name: &str) -> Option<&'a str> {
        let (_, value) = self.1.iter().rev().find(|(own, _)| *own == name)?;
        Some(value.trim())
    }

    /// Returns a length in user units.
    fn length(&self, name: &str) -> Result<Option<f64>, ReadError> {
        let Some(text) = self.get(name).filter(|text| *text != "auto") else {
            return Ok(None);
        };
        let length: Length = text.parse().map_err(|error| wrong(self.0, name, &error))?;
        match millimetres(length) {
            Some((_, LengthUnit::None | LengthUnit::Px)) => Ok(Some(length.number)),
            Some((mm, _)) => Ok(Some(mm / PIXEL)),
            None => Err(wrong(
                self.0,
                name,
                &format!("found {text:?}, expected a length"),
            )),
        }
    }

    /// Returns two lengths, each 0 unless it is given.
    fn pair(&self, x: &str, y: &str) -> Result<[f64; 2], ReadError> {
        let [x, y] = [self.length(x)?, self.length(y)?];
        Ok([x.unwrap_or(0.0), y.unwrap_or(0.0)])
    }

    /// Whether an element is filled or stroked.
    fn paints(&self, name: &str, inherited: bool) -> Result<bool, ReadError> {
        let Some(text) = self.get(name) else {
            return Ok(inherited);
        };
        let paint = Paint::from_str(text).map_err(|error| wrong(self.0, name, &error))?;
        Ok(match paint {
            Paint::None => false,
            Paint::Inherit => inherited,
            Paint::Color(color) => color.alpha > 0,
            _ => true,
        })
    }

    /// Returns the shape as the data of a path.
    fn path_data(&self) -> Result<String, ReadError> {
        let text = |name: &str| self.get(name).unwrap_or_default().to_owned();
        let [rx, ry] = [self.length("rx")?, self.length("ry")?];
        let [rx, ry] = [rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0)];
        Ok(match self.0.tag_name().name() {
            "path" => text("d"),
            "rect" => {
                let [x, y] = self.pair("x", "y")?;
                let [width, height] = self.pair("width", "height")?;
                if width <= 0.0 || height <= 0.0 {
                    return Ok(String::new());
                }
                let [rx, ry] = [rx.clamp(0.0, width / 2.0), ry.clamp(0.0, height / 2.0)];
                let arc = format!("A{rx} {ry} 0 0 1 ");
                let [right, bottom] = [x + width, y + height];
                let [low, high] = [y + ry, bottom - ry];
                let [near, far] = [x + rx, right - rx];
                format!(
                    "M{near} {y}H{far}{arc}{right} {low}V{high}{arc}{far} {bottom}\
                     H{near}{arc}{x} {high}V{low}{arc}{near} {y}z"
                )
            }
            "circle" | "ellipse" => {
                let [cx, cy] = self.pair("cx", "cy")?;
                let r = self.length("r")?;
                let [rx, ry] = [r.unwrap_or(rx), r.unwrap_or(ry)];
                let (left, right) = (cx - rx, cx + rx);
                let arc = format!("A{rx} {ry} 0 0 1 ");
                format!("M{right} {cy}{arc}{left} {cy}{arc}{right} {cy}z")
            }
            "line" => String::new(),
            _ => format!("M{}z", text("points")),
        })
    }

    fn is_transparent(&self, name: &str) -> bool {
        let number = self
            .get(name)
            .map(|text| text.trim_end_matches('%').parse::<f64>());
        matches!(number, Some(Ok(opacity)) if opacity <= 0.0)
    }
}

impl simplecss::Element for &Element<'_> {
    fn parent_element(&self) -> Option<Self> {
        None
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        None
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
        self.0
            .attribute(name)
            .is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, _: PseudoClass<'_>) -> bool {
        false
    }
}

struct Reader<'a> {
    ids: HashMap<&'a str, Node<'a, 'a>>,
    styles: StyleSheet<'a>,
    chords: Chords,
    paths: Vec<Path>,
    left_out: BTreeMap<&'static str, usize>,
    work: usize,
}

impl<'a> Reader<'a> {
    /// Collects what the attributes of an element, the style sheets and its own style say.
    fn styled(&mut self, node: Node<'a, 'a>) -> Result<Element<'a>, ReadError> {
        let attributes = node.attributes().filter(|own| own.namespace().is_none());
        let attributes = attributes.map(|own| (own.name(), own.value()));
        let mut element = Element(node, attributes.collect());
        let length: usize = element.1.iter().map(|(_, value)| value.len() + 20).sum();
        let class = node.attribute("class").unwrap_or_default().len();
        self.work += 100 + length + self.styles.rules.len() * (20 + class);
        if self.work > MOST_WORK {
            let message = "too many elements, with those that are used again";
            return Err(ReadError::new(message));
        }
        let rules = self.styles.rules.iter();
        let rules = rules.filter(|rule| rule.selector.matches(&&element));
        let rules = rules.flat_map(|rule| rule.declarations.iter().copied());
        let own = DeclarationTokenizer::from(node.attribute("style").unwrap_or_default());
        let all: Vec<_> = rules.chain(own).map(|own| (own.name, own.value)).collect();
        element.1.extend(all);
        Ok(element)
    }

    fn leave_out(&mut self, what: &'static str) {
        *self.left_out.entry(what).or_default() += 1;
    }

    /// Reads an element and those in it.
    fn element(&mut self, node: Node<'a, 'a>, mut look: Look) -> Result<(), ReadError> {
        let element = self.styled(node)?;
        look.depth += 1;
        if look.depth > DEEPEST {
            let message = format!("elements nested more than {DEEPEST} deep");
            return Err(placed(node, ReadError::new(message)));
        }
        if element.get("display") == Some("none") || element.is_transparent("opacity") {
            return Ok(());
        }
        look.is_visible = match element.get("visibility") {
            None | Some("inherit") => look.is_visible,
            Some(other) => other == "visible",
        };
        look.rule = match element.get("fill-rule") {
            Some("evenodd") => FillRule::EvenOdd,
            Some("nonzero") => FillRule::NonZero,
            _ => look.rule,
        };
        look.fill = element.paints("fill", look.fill)?;
        look.stroke = element.paints("stroke", look.stroke)?;
        if let Some(text) = element.get("transform").filter(|text| *text != "none") {
            let own: Transform = text
                .parse()
                .map_err(|error| wrong(node, "transform", &error))?;
            look.map *= Affine::new([own.a, own.b, own.c, own.d, own.e, own.f]);
        }
        for (name, what) in [("clip-path", "clip path"), ("mask", "mask")] {
            if element.get(name).is_some_and(|value| value != "none") {
                self.leave_out(what);
            }
        }
        match node.tag_name().name() {
            _ if look.depth > 1 && node.has_attribute("viewBox") => self.leave_out("nested view"),
            "g" | "a" | "svg" | "switch" | "symbol" => {
                for child in node.children() {
                    // What a symbol holds is seen only where it is used.
                    if child.tag_name().name() != "symbol" {
                        self.element(child, look)?;
                    }
                }
            }
            "use" => {
                let mut links = node.attributes().filter(|own| own.name() == "href");
                let Some(id) = links
                    .next_back()
                    .and_then(|own| own.value().strip_prefix('#'))
                else {
                    self.leave_out("link");
                    return Ok(());
                };
                let used = self.ids.get(id).copied();
                let missing = || format!("there is no element {:?}", shortened(id));
                let used = used.ok_or_else(|| wrong(node, "href", &missing()))?;
                let [x, y] = element.pair("x", "y")?;
                look.map *= Affine::translate((x, y));
                self.element(used, look)?;
            }
            _ if !look.is_visible => {}
            "text" => self.leave_out("text"),
            "image" => self.leave_out("image"),
            "path" | "rect" | "circle" | "ellipse" | "polygon" | "polyline" | "line" => {
                if look.stroke {
                    self.leave_out("stroke");
                }
                if look.fill && !element.is_transparent("fill-opacity") {
                    self.chords.begin(look.map);
                    let data = element.path_data()?;
                    self.path(node, &data)
                        .map_err(|error| placed(node, error))?;
                    let rings = self.chords.finish();
                    self.paths.push(Path {
                        rings,
                        rule: look.rule,
                    });
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Draws a path.
    fn path(&mut self, node: Node, data: &str) -> Result<(), ReadError> {
        // The control points that a smooth curve mirrors, if one of its kind was before.
        let (mut cubic, mut quadratic) = (None, None);
        for segment in PathParser::from(data) {
            let segment = segment.map_err(|error| wrong(node, "shape", &error))?;
            let chords = &mut self.chords;
            let end = chords.end;
            let base = if segment.is_abs() {
                Vec2::ZERO
            } else {
                end.to_vec2()
            };
            let at = |x: f64, y: f64| Point::new(x, y) + base;
            let mirrored = |control: Option<Point>| end + (end - control.unwrap_or(end));
            let (last_cubic, last_quadratic) = (cubic.take(), quadratic.take());
            match segment {
                PathSegment::MoveTo { x, y, .. } => chords.move_to(at(x, y)),
                PathSegment::ClosePath { .. } => chords.close(),
                PathSegment::LineTo { x, y, .. } => chords.line_to(at(x, y))?,
                PathSegment::HorizontalLineTo { x, .. } => {
                    chords.line_to(Point::new(base.x + x, end.y))?;
                }
                PathSegment::VerticalLineTo { y, .. } => {
                    chords.line_to(Point::new(end.x, base.y + y))?;
                }
                PathSegment::CurveTo {
                    x1,
                    y1,
                    x2,
                    y2,
                    x,
                    y,
                    ..
                } => {
                    cubic = Some(at(x2, y2));
                    chords.cubic_to([at(x1, y1), at(x2, y2), at(x, y)])?;
                }
                PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => {
                    cubic = Some(at(x2, y2));
                    chords.cubic_to([mirrored(last_cubic), at(x2, y2), at(x, y)])?;
                }
                PathSegment::Quadratic { x1, y1, x, y, .. } => {
                    quadratic = Some(at(x1, y1));
                    chords.quadratic_to(at(x1, y1), at(x, y))?;
                }
                PathSegment::SmoothQuadratic { x, y, .. } => {
                    let control = mirrored(last_quadratic);
                    quadratic = Some(control);
                    chords.quadratic_to(control, at(x, y))?;
                }
                PathSegment::EllipticalArc {
                    rx,
                    ry,
                    x_axis_rotation,
                    large_arc,
                    sweep,
                    x,
                    y,
                    ..
                } => chords.arc_to(&SvgArc {
                    from: end,
                    to: at(x, y),
                    radii: Vec2::new(rx, ry),
                    x_rotation: x_axis_rotation.to_radians(),
                    large_arc,
                    sweep,
                })?,
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::outline::{EllipseRing, Ring};

    use super::*;

    fn document(attributes: &str, content: &str) -> String {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{content}</svg>"#)
    }

    fn read_plain(svg: &str) -> Result<ReadOutline, ReadError> {
        read(svg, &OutlineOptions::default())
    }

    fn rings(content: &str) -> Vec<Ring> {
        read_plain(&document("", content)).expect(content).rings
    }

    /// The points of the only ring, from its lowest one.
    fn points(content: &str) -> Vec<[f64; 2]> {
        let [Ring::Polygon(points)] = &rings(content)[..] else {
            panic!("expected one polygon in {content}");
        };
        let mut points = points.clone();
        let lowest =
            (0..points.len()).min_by(|&a, &b| points[a].partial_cmp(&points[b]).expect("finite"));
        points.rotate_left(lowest.expect("points"));
        points
    }

    fn ellipse(centre: [f64; 2], radii: [f64; 2], angle: f64) -> Vec<Ring> {
        vec![Ring::Ellipse(EllipseRing {
            centre,
            radii,
            angle,
        })]
    }

    #[test]
    fn what_is_filled_is_read_through_all_transformations() {
        let square = points(r#"<rect x="1" y="2" width="3" height="3"/>"#);
        assert_eq!(square.len(), 4);
        for content in [
            r#"<polygon points="1,2 4,2 4,5 1,5"/>"#,
            r#"<polyline points="1 2 4 2 4 5 1 5 1 2"/>"#,
            r#"<path d="M1 2h3v3h-3z"/>"#,
            r#"<path d="m1,2 3,0 0,3H1"/>"#,
            r#"<path d="M1 2L4 2L4 5L1 5Z" style="fill: #07f"/>"#,
            r#"<g transform="translate(0.7 2.3)"><rect x="0.3" y="-0.3" width="3" height="3"/></g>"#,
            r#"<rect transform="rotate(90 1 2)" x="1" y="-1" width="3" height="3"/>"#,
            r#"<g transform="scale(.5)"><rect transform="matrix(2 0 0 3 0 0)" x="1" y="1.333333333333" width="3" height="2"/></g>"#,
            r##"<defs><rect id="a" width="3" height="3"/></defs><use href="#a" x="1" y="2"/>"##,
            r##"<symbol id="a"><rect width="3" height="3"/></symbol><use href="#a" transform="translate(1 2)"/>"##,
            r#"<rect x="1" y="2" width="2" height="3"/><rect x="2" y="2" width="2" height="3" fill="white"/>"#,
            r#"<g fill="none"><rect width="9" height="9"/><rect x="1" y="2" width="3" height="3" fill="red"/></g>"#,
            r#"<g display="none"><rect width="9" height="9"/></g><rect x="1" y="2" width="3" height="3"/>"#,
            r#"<rect width="9" height="9" opacity="0"/><rect x="1" y="2" width="3" height="3"/>"#,
            r#"<style>.n{fill:none}</style><rect width="9" height="9" class="a n"/><rect x="1" y="2" width="3" height="3"/>"#,
            r#"<rect width="9" height="9" fill="white" style="fill:none"/><rect x="1" y="2" width="3" height="3"/>"#,
            r#"<clipPath><rect width="9" height="9"/></clipPath><rect x="1" y="2" width="3" height="3"/>"#,
        ] {
            assert_eq!(points(content), square, "{content}");
        }
        let window = "M0 0h6v6h-6zM1 1h4v4h-4z";
        assert_eq!(rings(&format!(r#"<path d="{window}"/>"#)).len(), 1);
        assert_eq!(
            rings(&format!(r#"<path fill-rule="evenodd" d="{window}"/>"#)).len(),
            2
        );
    }

    #[test]
    fn ellipses_stay_ellipses_where_nothing_touches_them() {
        for (content, expected) in [
            (
                r#"<circle cx="3" cy="4" r="2.5"/>"#,
                ellipse([3.0, 4.0], [2.5, 2.5], 0.0),
            ),
            (
                r#"<ellipse cx="3" cy="4" rx="2" ry="1"/>"#,
                ellipse([3.0, 4.0], [2.0, 1.0], 0.0),
            ),
            (
                r#"<g transform="translate(1 0) rotate(30) scale(2)"><ellipse rx="2" ry="1"/></g>"#,
                ellipse([1.0, 0.0], [4.0, 2.0], 30.0),
            ),
            (
                r#"<path d="M 8,5 a 3,3 0 1 0 -6,0 a 3,3 0 1 0 6,0 z"/>"#,
                ellipse([5.0, 5.0], [3.0, 3.0], 0.0),
            ),
            (
                r#"<circle r="2"/><circle r="1.9"/>"#,
                ellipse([0.0, 0.0], [2.0, 2.0], 0.0),
            ),
        ] {
            assert_eq!(rings(content), expected, "{content}");
        }
        let skewed = rings(r#"<circle r="2" transform="skewX(40)"/>"#);
        let [Ring::Ellipse(own)] = &skewed[..] else {
            panic!("expected an ellipse, got {skewed:?}");
        };
        assert!(
            (own.radii[0] * own.radii[1] - 4.0).abs() < 1e-8,
            "the area stays: {own:?}"
        );
        let drilled =
            r#"<path fill-rule="evenodd" d="M0 0h9v9h-9zM6 4a2 2 0 0 1-4 0a2 2 0 0 1 4 0"/>"#;
        assert_eq!(rings(drilled)[1..], ellipse([4.0, 4.0], [2.0, 2.0], 0.0));
        // A bar across a disc, and a block whose side it touches.
        for other in ["-3 -1h6v2h-6z", "2 -3h6v6h-6z"] {
            let touched = rings(&format!(r#"<circle r="2"/><path d="M{other}"/>"#));
            assert!(
                touched.iter().all(|ring| matches!(ring, Ring::Polygon(_))),
                "{other}"
            );
        }
    }

    #[test]
    fn chords_are_as_near_to_their_curve_as_they_should_be() {
        let curve = |t: f64| {
            let s = 1.0 - t;
            let [b, c, d] = [3.0 * s * s * t, 3.0 * s * t * t, t * t * t];
            [b * 4.0 + c * 8.0 + d * 9.0, b * 9.0 + c * -7.0]
        };
        for flatness in [0.1, 1e-3, 1e-5] {
            let options = OutlineOptions {
                flatness,
                ..OutlineOptions::default()
            };
            let svg = document("", r#"<path d="M0 0C4 9 8-7 9 0V20H0z"/>"#);
            let read = read(&svg, &options).expect("a path");
            let Ring::Polygon(points) = &read.rings[0] else {
                panic!("expected a polygon");
            };
            let farthest = (0..=1000).map(|step| {
                let [x, y] = curve(f64::from(step) / 1000.0);
                let next = points.iter().cycle().skip(1);
                let distances = points.iter().zip(next).map(|(from, to)| {
                    let (way, own) = (
                        [to[0] - from[0], to[1] - from[1]],
                        [x - from[0], y - from[1]],
                    );
                    let square = way[0] * way[0] + way[1] * way[1];
                    let part = ((own[0] * way[0] + own[1] * way[1]) / square).clamp(0.0, 1.0);
                    libm::hypot(own[0] - part * way[0], own[1] - part * way[1])
                });
                distances.fold(f64::MAX, f64::min)
            });
            let farthest = farthest.fold(0.0, f64::max);
            assert!(
                farthest < flatness && farthest > flatness / 20.0,
                "{farthest}"
            );
        }
        // What a smooth curve, an arc and a quadratic curve enclose.
        for (d, area) in [
            ("M0 0C0 2 2 2 2 0S4-2 4 0z", 0.0),
            ("M0 0A3 2 0 0 1 6 0z", 3.0 * std::f64::consts::PI),
            ("M0 0Q3 6 6 0T12 0z", 0.0),
            ("M0 0q3 6 6 0z", 12.0),
        ] {
            let rings = rings(&format!(r#"<path d="{d}"/>"#));
            let sum: f64 = rings
                .iter()
                .map(|ring| match ring {
                    Ring::Polygon(points) => {
                        let next = points.iter().cycle().skip(1);
                        points
                            .iter()
                            .zip(next)
                            .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
                            .sum::<f64>()
                            / 2.0
                    }
                    Ring::Ellipse(_) => f64::NAN,
                })
                .sum();
            let expected = if area == 0.0 {
                rings.len() == 2
            } else {
                (sum.abs() - area).abs() < 0.01
            };
            assert!(expected, "{d}: {sum} of {}", rings.len());
        }
    }

    #[test]
    fn the_size_is_that_of_the_document() {
        let width = |attributes: &str, options: &OutlineOptions| {
            let svg = document(attributes, r#"<rect width="48" height="24"/>"#);
            read(&svg, options).map(|read| {
                let Ring::Polygon(points) = &read.rings[0] else {
                    panic!("expected a polygon");
                };
                (
                    points.iter().map(|point| point[0]).fold(0.0, f64::max),
                    read.unit,
                )
            })
        };
        for (attributes, expected) in [
            ("", (48.0, OutlineUnit::Cells)),
            (r#"width="96" height="96px""#, (48.0, OutlineUnit::Cells)),
            (
                r#"width="96" viewBox="0 0 10 10""#,
                (48.0, OutlineUnit::Cells),
            ),
            (
                r#"width="96mm" viewBox="0 0 48 48""#,
                (96.0, OutlineUnit::Mm),
            ),
            (
                r#"width="9.6cm" height="9cm" viewBox="0 0 96 90""#,
                (48.0, OutlineUnit::Mm),
            ),
            (
                r#"height="1in" viewBox="0 0 9 25.4""#,
                (48.0, OutlineUnit::Mm),
            ),
            (
                r#"width="72pt" viewBox="0 0 25.4 9""#,
                (48.0, OutlineUnit::Mm),
            ),
            (r#"width="100mm""#, (12.7, OutlineUnit::Mm)),
        ] {
            assert_eq!(
                width(attributes, &OutlineOptions::default()),
                Ok(expected),
                "{attributes}"
            );
        }
        let options = OutlineOptions {
            mm_per_unit: Some(0.5),
            ..OutlineOptions::default()
        };
        assert_eq!(
            width(r#"width="100%""#, &options),
            Ok((24.0, OutlineUnit::Mm))
        );
    }

    #[test]
    fn what_is_left_out_is_named() {
        let content = r#"<rect width="4" height="4" stroke="red" clip-path="url(#c)"/><text>A</text>
            <g stroke="black"><line x2="3" y2="4"/><path fill="none" d="M0 0h9"/></g><image href="a.png"/>
            <use href="other.svg#part"/><svg viewBox="0 0 1 1"><rect width="1" height="1"/></svg>"#;
        let left_out = read_plain(&document("", content))
            .expect("a rectangle")
            .left_out;
        let expected = [
            "1 clip path",
            "1 image",
            "1 link",
            "1 nested view",
            "3 strokes",
            "1 text",
        ];
        assert_eq!(left_out, expected);
    }

    #[test]
    fn errors_say_what_and_where() {
        let many = "l1 1".repeat(20_001);
        for (svg, message) in [
            (
                document(
                    "",
                    r#"<line x2="3" stroke="red"/><text>A</text><text>B</text>"#,
                ),
                "no filled shape; left out: 1 stroke, 2 texts",
            ),
            (document("", ""), "no filled shape"),
            (
                "<svg><g></svg>".to_owned(),
                "line 1, column 9: malformed XML: expected 'g' tag, not 'svg'",
            ),
            ("<html/>".to_owned(), "found <html>, expected <svg>"),
            (
                "<svg width='100%'/>".to_owned(),
                "line 1, column 1: <svg> width: found \"100%\", no clear size; --mm-per-unit gives one",
            ),
            (
                "<svg height='9 furlongs'/>".to_owned(),
                "line 1, column 1: <svg> height: found \"9 furlongs\", no clear size; --mm-per-unit gives one",
            ),
            (
                "<svg>\n  <path d='M0 0L1 x'/></svg>".to_owned(),
                "line 2, column 3: <path> shape: invalid number at position 8",
            ),
            (
                "<svg><rect width='3em' height='1'/></svg>".to_owned(),
                "line 1, column 6: <rect> width: found \"3em\", expected a length",
            ),
            (
                "<svg><use href='#a'/></svg>".to_owned(),
                "line 1, column 6: <use> href: there is no element \"a\"",
            ),
            (
                format!("<svg><path d='M0 0{many}'/></svg>"),
                "line 1, column 6: more than 20000 points; a larger --flatness makes fewer of curves",
            ),
            (
                "<svg><circle r='1e7'/></svg>".to_owned(),
                "line 1, column 6: a number is not finite, or a point beyond ±1,000,000",
            ),
            (
                "<svg><style>g path{fill:none}</style></svg>".to_owned(),
                "style of \"g path\": expected a selector of one element",
            ),
        ] {
            let error = read_plain(&svg).expect_err(message);
            assert_eq!(error.to_string(), message);
        }
    }

    #[test]
    fn bombs_give_one_error_soon() {
        let entities: String = ('b'..'k')
            .map(|name| {
                let before = char::from(name as u8 - 1);
                format!("<!ENTITY {name} '{}'>", format!("&{before};").repeat(200))
            })
            .collect();
        let links: String = (1..60)
            .map(|number| {
                let before = format!("<use href='#a{}'/>", number - 1).repeat(10);
                format!("<g id='a{number}'>{before}</g>")
            })
            .collect();
        let zigzag: String = (0..9_000)
            .map(|step| format!(" {},{}", step % 100, 99 * (step % 2)))
            .collect();
        for (svg, message) in [
            (
                format!("<!DOCTYPE svg [<!ENTITY a 'a'>{entities}]><svg>&j;</svg>"),
                "its entities may expand to more than 64 MiB",
            ),
            (
                "<svg>".to_owned() + &"<g>".repeat(100_000) + &"</g>".repeat(100_000) + "</svg>",
                "nested more than",
            ),
            (format!("<svg><g id='a0'/>{links}</svg>"), "used again"),
            (
                "<svg><g id='a'><use href='#a'/></g></svg>".to_owned(),
                "nested more than",
            ),
            (
                format!("<svg><polygon points='{zigzag}'/></svg>"),
                "paths cross more than",
            ),
        ] {
            let error = read_plain(&svg).expect_err(message).to_string();
            assert!(error.contains(message), "{error}");
        }
    }
}
