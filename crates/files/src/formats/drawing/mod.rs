//! A drawing of a touch for papers and reports: the matrix, the true outline, the circumscribed rectangle, CG and CD.
//!
//! It is black, white and grey, and no information depends on a shade alone, so it survives any printer. Both axes
//! are labelled, in cell sides, or in mm if a pitch is given; a legend gives the values. Coordinates on the page are
//! points of 1/72 inch; a matrix is at most four inches wide. In SVG, text stays text; in PNG, the page has 288 dots
//! per inch.
//!
//! ```
//! use taxel_files::formats::Drawing;
//! use taxel_core::prelude::*;
//! let figure = Figure::default_of(FigureKind::Ellipse, &Sensor::default());
//! let imprint = Plane::new(Sensor::default()).touch(&figure);
//! let drawing = Drawing::new(&imprint).with_outline(&figure).with_pitch(2.5);
//! assert!(drawing.svg().contains(">x / mm</text>"));
//! ```
//!
//! The same pages show a confusion matrix ([`ConfusionMap`]), curves ([`LinePlot`]), points ([`PointPlot`]) and maps of
//! positions ([`PoseMap`]).

mod scene;

mod axis;

mod heat;

mod page;

mod outline;

mod confusion_map;

mod line_plot;

mod plane;

mod point_plot;

mod pose_map;

mod format;

mod svg;

mod ink;

mod glyph;

mod png;

use crate::description::{Description, Region, main_region, regions};
use crate::geometry::Solid;
use crate::imprint::Imprint;
use crate::matrix::Matrix;
use crate::parameter::Parameter;
use crate::sensor::Sensor;
pub use axis::{axis_ends, axis_marks};
pub use confusion_map::ConfusionMap;
pub use format::DrawingFormat;
use format::written;
pub use line_plot::LinePlot;
use page::Subject;
pub use point_plot::PointPlot;
pub use pose_map::PoseMap;
use scene::{DrawingPage, Segment, cut};

written!(Drawing, ConfusionMap, LinePlot, PointPlot, PoseMap);

/// The least pitch in mm: smaller than any atom.
const LEAST_PITCH: f64 = 1e-9;

/// A drawing of an imprint. One region is described: the main one, unless another is chosen.
#[derive(Clone, Debug)]
pub struct Drawing {
    imprint: Imprint,
    regions: Vec<Region<'static>>,
    chosen: Option<usize>,
    /// The outline of the shape, in cell sides.
    outline: Vec<Segment>,
    pitch_mm: Option<f64>,
    title: Option<String>,
    heat: Option<Matrix<f64>>,
}

impl Drawing {
    /// Makes a drawing of the matrix with the rectangle, CG and CD of its main region, in cell sides.
    pub fn new(imprint: &Imprint) -> Self {
        let regions = regions(imprint);
        Self {
            imprint: *imprint,
            chosen: main_region(&regions),
            regions,
            outline: Vec::new(),
            pitch_mm: None,
            title: None,
            heat: None,
        }
    }

    /// Adds the outline of the solid that touched; parts beyond the sensor are cut off. Curves are drawn as cubic
    /// ones that differ from the true ellipse by less than a hundred-thousandth of its size.
    #[must_use]
    pub fn with_outline(mut self, solid: &impl Solid) -> Self {
        self.outline = outline::steps(solid);
        self
    }

    /// Draws axes and values in mm, for cells of this side. A value that a sensor cannot have as its pitch changes
    /// nothing, nor does one below a picometre (1e-9 mm), whose axis could not be labelled.
    #[must_use]
    pub fn with_pitch(mut self, mm: f64) -> Self {
        if let Ok(mm) = Sensor::LARGEST.check(Parameter::Pitch, mm)
            && mm >= LEAST_PITCH
        {
            self.pitch_mm = Some(mm);
        }
        self
    }

    /// Adds the values of all cells as shades, white for 0 and less, black for the largest, and a bold edge around
    /// active taxels. A NaN means that there is no cell. A matrix of another size changes nothing.
    #[must_use]
    pub fn with_heat(mut self, values: &Matrix<f64>) -> Self {
        if values.size() == self.imprint.size() {
            self.heat = Some(values.clone());
        }
        self
    }

    /// Adds a title above; only its first 100 characters are kept.
    #[must_use]
    pub fn with_title(mut self, title: &str) -> Self {
        self.title = Some(cut(title));
        self
    }

    /// Describes another region, given by its index in [`regions`]; an index beyond them changes nothing.
    #[must_use]
    pub fn with_region(mut self, index: usize) -> Self {
        if index < self.regions.len() {
            self.chosen = Some(index);
        }
        self
    }

    fn page(&self) -> DrawingPage {
        let region = self.chosen.and_then(|index| self.regions.get(index));
        let described = region.map(|region| (region.taxels(), Description::of(region)));
        DrawingPage::of(&Subject {
            imprint: &self.imprint,
            described,
            outline: &self.outline,
            pitch_mm: self.pitch_mm,
            title: self.title.as_deref(),
            heat: self.heat.as_ref(),
        })
    }
}
