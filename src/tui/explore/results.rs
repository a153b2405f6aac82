//! The results of a sweep: a page of four tabs.
//!
//! ```text
//!  1 imprints   2 statistics   3 histogram   4 map     the tabs
//! hexagon: 1,000 poses, 87 distinct imprints           what was swept, and how much was found
//!                                                      the open tab
//! ```
//! The tabs that show a descriptor show the same one, and the list and the map lead to each other. Results of a
//! stopped sweep say that they are only a part. Nothing here changes the document, so there is nothing to undo, until
//! Enter puts a pose onto the matrix.

use std::sync::Arc;

use ratatui::layout::{Position, Rect};
use taxel_core::atlas::{AtlasEntry, Feature, features};
use taxel_core::index::wide;
use taxel_core::pose::{Axis, PoseIndex};
use taxel_core::sweep::SweepResult;
use taxel_core::touch::Plane;
use taxel_files::formats::value::{counted, grouped};

use crate::tui::app::{
    App, Canvas, Document, Flow, Message, Page, Place, Placed, Reading, Wheel, change,
    compare_with, inform, refuse,
};
use crate::tui::explore::imprints::{self, ImprintList, SortColumn};
use crate::tui::explore::map::{self, MapState};
use crate::tui::explore::statistics::{HISTOGRAM, STATISTICS};
use crate::tui::explore::work::{ExportDialog, open_ranges};
use crate::tui::explore::{ExploreMessage, Findings, name_of};
use crate::tui::keys::{Context, action};
use crate::tui::widget::write::{self, around, narrow};
use crate::tui::widget::{Role, Theme, moved};

/// A tab. Its functions get the area below the summary.
pub(super) struct Tab {
    pub(super) title: &'static str,
    pub(super) context: Context,
    pub(super) wheel: Wheel,
    pub(super) draw: fn(&Results, Canvas<'_>, Rect) -> Option<Position>,
    pub(super) click: fn(&Results, Rect, Position) -> Option<Message>,
    pub(super) on: fn(&mut Results, &mut App, &Message, Rect),
}

static TABS: [&Tab; 4] = [&imprints::TAB, &STATISTICS, &HISTOGRAM, &map::TAB];
const IMPRINTS: usize = 0;
const MAP: usize = 3;

pub(crate) struct Results {
    pub(super) findings: Arc<Findings>,
    tab: usize,
    /// The descriptor of all tabs but the map.
    pub(crate) chosen: Chosen,
    pub(super) list: ImprintList,
    /// The pose at the cursor of the map.
    pub(super) place: PoseIndex,
    pub(super) map: MapState,
}

/// A descriptor, and its value for each imprint.
pub(crate) struct Chosen {
    pub(super) number: usize,
    pub(super) values: Vec<Option<f64>>,
}

impl Chosen {
    pub(super) fn new(findings: &Findings, number: usize) -> Self {
        let number = number.min(features().len() - 1);
        Self {
            number,
            values: findings.sweep.atlas.values(number),
        }
    }

    pub(crate) fn feature(&self) -> &'static Feature {
        &features()[self.number]
    }

    pub(super) fn value(&self, id: u32) -> Option<f64> {
        self.values.get(wide(id)).copied().flatten()
    }

    pub(super) fn text(&self, theme: &Theme, id: u32, width: usize) -> String {
        theme.number(self.value(id), width)
    }
}

/// Symbol and key of a descriptor: `Ratio (side_ratio)`.
pub(super) fn named(feature: &Feature) -> String {
    format!("{} ({})", feature.descriptor.symbol, feature.key)
}

/// The same with what it is: `NA (na): active taxels`.
pub(super) fn described(feature: &Feature) -> String {
    format!("{}: {}", named(feature), feature.descriptor.name)
}

pub(super) fn choose_descriptor(results: &mut Results, _: &mut App, message: &Message, _: Rect) {
    if let Some(row) = moved(results.chosen.number, message) {
        results.choose(row);
    }
}

/// Returns the sign and the role of a row.
pub(super) fn row_style(is_selected: bool) -> (&'static str, Role) {
    if is_selected {
        ("> ", Role::Focus)
    } else {
        ("  ", Role::Text)
    }
}

impl Results {
    pub(crate) fn new(findings: Arc<Findings>) -> Self {
        Self {
            tab: 0,
            chosen: Chosen::new(&findings, 0),
            list: ImprintList::new(&findings),
            place: PoseIndex::new([0; 5]),
            map: MapState::default(),
            findings,
        }
    }

    pub(super) fn sweep(&self) -> &SweepResult {
        &self.findings.sweep
    }

    pub(super) fn tab(&self) -> &'static Tab {
        TABS[self.tab]
    }

    /// Its present pose is that at its cursor, not that of the selected imprint.
    fn is_map(&self) -> bool {
        self.tab == MAP
    }

    fn choose(&mut self, number: usize) {
        self.chosen = Chosen::new(&self.findings, number);
        if self.list.sort.0 == SortColumn::Value {
            self.list.arrange(&self.findings, &self.chosen);
        }
    }

    fn summary(&self) -> String {
        let sweep = self.sweep();
        let mut poses = counted(sweep.grid.poses(), "pose");
        if !sweep.complete() {
            poses = format!("a part: {} of {poses}", grouped(sweep.poses));
        }
        let what = name_of(sweep.grid.source());
        let distinct = counted(sweep.atlas.len() as u64, "distinct imprint");
        format!("{what}: {poses}, {distinct}")
    }

    pub(super) fn rows_from(&self, first: usize) -> impl Iterator<Item = (usize, AtlasEntry)> + '_ {
        let rows = self.list.rows.iter().enumerate().skip(first);
        rows.filter_map(|(index, &id)| Some((index, self.sweep().atlas.entry(id)?)))
    }

    pub(super) fn selected(&self) -> Option<AtlasEntry> {
        let (_, entry) = self.rows_from(self.list.selected).next()?;
        Some(entry)
    }

    fn pose(&self) -> Option<u64> {
        if self.is_map() {
            return Some(self.sweep().grid.number(self.place));
        }
        Some(self.selected()?.first_pose)
    }

    pub(super) fn pose_text(&self, number: u64) -> String {
        let grid = &self.sweep().grid;
        let pose = grid.pose(number);
        let values = grid.axes().map(|axis| {
            let parameter = axis.parameter();
            format!("{} {}", parameter.row().short, parameter.format(pose[axis]))
        });
        values.collect::<Vec<_>>().join(", ")
    }

    pub(super) fn width_of(&self, axis: Axis) -> usize {
        let (range, parameter) = (self.sweep().grid.ranges()[axis], axis.parameter());
        let ends = [range.value(0), range.value(1), range.last()];
        let widths = ends.map(|value| parameter.format(value).len()).into_iter();
        widths.fold(parameter.row().short.len(), usize::max)
    }

    /// Goes from the list to the map, or back.
    fn follow(&mut self) -> Result<(), String> {
        let pose = self.pose().ok_or(NOTHING_SELECTED)?;
        let grid = &self.sweep().grid;
        if !self.is_map() {
            (self.place, self.tab) = (grid.index(pose), MAP);
            return Ok(());
        }
        let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(pose));
        let id = self.sweep().atlas.find(&imprint);
        self.list
            .find(id.ok_or("this pose was not swept: the sweep was stopped")?);
        self.tab = IMPRINTS;
        Ok(())
    }

    /// Puts the shape onto the matrix in the present pose, with just the imprint that the sweep found. The user may
    /// have another sensor by now: taxels that it reads differently are set by hand.
    fn put_onto_matrix(&self, app: &mut App) -> Result<(), String> {
        let grid = &self.sweep().grid;
        let pose = self.pose().ok_or(NOTHING_SELECTED)?;
        let source = grid.source_at(grid.pose(pose));
        let source = source.map_err(|error| error.to_string())?;
        let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(pose));
        let mut document = Document::touched(app.history.present().sensor, source);
        document.edits = Reading::of(&document).imprint.differing(&imprint);
        app.held = None;
        change(app, document);
        app.history.choose(None);
        let id = self.sweep().atlas.find(&imprint);
        let mut text = id.map_or(String::new(), |id| format!("imprint {id} "));
        let [undo, explore] = [&action::UNDO, &action::EXPLORE].map(|action| app.key_of(action));
        text += &format!("on the matrix; {undo} takes it back, {explore} returns to Explore");
        inform(app, text);
        Ok(())
    }

    fn handle(&mut self, app: &mut App, message: &Message) -> Result<Flow, String> {
        match *message {
            Message::Cancel | Message::Quit => return Ok(Flow::Close),
            Message::Accept => {
                self.put_onto_matrix(app)?;
                return Ok(Flow::Close);
            }
            Message::Compare => {
                let entry = self.selected().ok_or(NOTHING_SELECTED)?;
                compare_with(app, &format!("imprint {}", entry.id), &entry.imprint);
            }
            Message::Explore(ExploreMessage::Export) => {
                return Ok(Flow::push(ExportDialog::new(self)));
            }
            Message::Explore(ExploreMessage::Ranges) => open_ranges(app, Some(&self.sweep().grid)),
            Message::Explore(ExploreMessage::Tab(tab)) => self.tab = tab,
            Message::Explore(ExploreMessage::NextTab(by)) => {
                self.tab = around(self.tab, by, TABS.len());
            }
            Message::Explore(ExploreMessage::Feature(_)) if self.is_map() => {
                return Err("the map shows no descriptor".to_owned());
            }
            Message::Explore(ExploreMessage::Feature(by)) => {
                self.choose(around(self.chosen.number, by, features().len()));
            }
            Message::Explore(ExploreMessage::Follow) => self.follow()?,
            _ => (self.tab().on)(self, app, message, tab_area(app, self)),
        }
        Ok(Flow::Stay)
    }
}

const NOTHING_SELECTED: &str = "nothing is selected here";

pub(super) fn tab_area(app: &App, results: &Results) -> Rect {
    let area = app.panes().map(|panes| panes.area(results.place()));
    area.map_or(Rect::default(), |area| write::below(area, 2))
}

impl Page for Results {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        self.handle(app, message).unwrap_or_else(|reason| {
            refuse(app, reason);
            Flow::Stay
        })
    }

    /// Explore opens them again for the same shape.
    fn closed(self: Box<Self>, app: &mut App) {
        app.results = Some(self);
    }

    fn placed(&self) -> Placed {
        (self.tab().context, Place::Screen, self.tab().wheel)
    }

    fn draw(&self, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        for (tab, title, place) in titles(area) {
            let is_open = tab == self.tab;
            canvas.text(place, &title, if is_open { Role::Focus } else { Role::Key });
        }
        canvas.text(write::row(area, 1), &self.summary(), Role::Text);
        (self.tab().draw)(self, canvas, write::below(area, 2))
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let mut titles = titles(area);
        match titles.find(|(.., place)| place.contains(at)) {
            Some((tab, ..)) => Some(Message::Explore(ExploreMessage::Tab(tab))),
            None => (self.tab().click)(self, write::below(area, 2), at),
        }
    }

    fn has_use_for(&self, message: &Message, area: Rect) -> bool {
        let grid = &self.sweep().grid;
        match message {
            Message::Accept | Message::Compare | Message::Explore(ExploreMessage::Follow) => {
                self.pose().is_some()
            }
            Message::Explore(ExploreMessage::Angle(_)) => grid.counts()[Axis::Angle] > 1,
            Message::Explore(ExploreMessage::Feature(_)) => !self.is_map(),
            Message::Zoom(_) => self.is_map() && map::closest(self, write::below(area, 2)) > 0,
            _ => true,
        }
    }

    fn cancels_itself(&self) -> bool {
        true
    }
}

fn titles(area: Rect) -> impl Iterator<Item = (usize, String, Rect)> {
    let mut rest = write::row(area, 0);
    TABS.iter().enumerate().map(move |(tab, row)| {
        let text = format!(" {} {} ", tab + 1, row.title);
        let end = rest.x.saturating_add(narrow(text.len()));
        let place = write::left_of(rest, end);
        rest = write::right_of(rest, end.saturating_add(1));
        (tab, text, place)
    })
}

#[cfg(test)]
pub(super) mod tests {
    use taxel_core::figure::{Figure, FigureKind};
    use taxel_core::pose::{Anchor, PoseGrid, Ranges};
    use taxel_core::sensor::Sensor;
    use taxel_core::source::Source;
    use taxel_core::sweep::Sweep;

    use super::*;

    pub(in crate::tui::explore) fn sweep(kind: FigureKind, ranges: [&str; 3]) -> SweepResult {
        let [x0, y0, angle] = ranges.map(|text| text.parse().expect("a range"));
        let ranges = Ranges::default()
            .with(Axis::X0, x0)
            .with(Axis::Y0, y0)
            .with(Axis::Angle, angle);
        let sensor = Sensor::default();
        let source = Source::Figure(Figure::default_of(kind, &sensor));
        let grid = PoseGrid::new(source, sensor, Anchor::Corner, ranges);
        Sweep::new(&grid.expect("in range")).run()
    }

    pub(in crate::tui::explore) fn results() -> ImprintList {
        let ranges = ["5:5.9:0.1", "5:5.5:0.1", "0:80:20"];
        ImprintList::new(&Findings::new(sweep(FigureKind::Heptagon, ranges)))
    }
}
