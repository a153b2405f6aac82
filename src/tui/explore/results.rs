//! The results of a sweep, and which part of them is shown: page, descriptor, order, row, cursor of the map.
//!
//! What was found never changes and is shared with workers that write it to files. All pages look at the same
//! descriptor, and the list and the map lead to each other. The file is long because each key changes what several pages
//! show.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::atlas::{AtlasEntry, AtlasFilter, Feature, features};
use crate::formats::value::{counted, grouped};
use crate::imprint::Imprint;
use crate::index::wide;
use crate::pose::{Axis, Pose, PoseIndex};
use crate::sweep::SweepResult;
use crate::touch::Plane;
use crate::tui::explore::angles::curve::{AngleCurve, zooms_of};
use crate::tui::explore::column::ListColumn;
use crate::tui::explore::map::visible::VisibleImprints;
use crate::tui::explore::message::{ExplorePage, Findings, Zoom, name_of};
use crate::tui::widget::number::around;

/// The descriptor that the scatter plot has to the right at first: the perimeter `p`, by its index.
const ACROSS: usize = 7;

/// The results, as they are looked at.
#[derive(Clone, Debug)]
pub struct Results {
    /// What was found. Workers that write it share it.
    findings: Arc<Findings>,
    /// The page that is shown.
    page: ExplorePage,
    /// The number of the chosen descriptor, and its value of each imprint.
    feature: usize,
    /// Its value for each imprint.
    values: Vec<Option<f64>>,
    /// The number of the descriptor that the scatter plot has to the right, and its values.
    across: (usize, Vec<Option<f64>>),
    /// The imprints of each angle, once the page of angles was looked at.
    angle_curve: Option<Arc<AngleCurve>>,
    /// The zooms that those were asked for last.
    angles_asked: Option<PoseIndex>,
    /// The zooms at which they could not be found last.
    angles_failed: Option<PoseIndex>,
    /// The imprints that the map shows.
    visible_imprints: VisibleImprints,
    /// How often the map was zoomed in, from its whole range on.
    closer: u8,
    /// What rows are sorted by, and whether the largest comes first.
    sort: (ListColumn, bool),
    /// The heading that is chosen to sort by.
    heading: ListColumn,
    /// What rows have to fulfil, as it was typed; empty for nothing.
    filter: String,
    /// The numbers of all imprints, sorted. A filter is typed letter by letter, and none of them changes the order.
    order: Vec<u32>,
    /// Whether it keeps each imprint, by number; empty if it keeps all.
    kept: Vec<bool>,
    /// The numbers of the imprints that it keeps, sorted.
    rows: Vec<u32>,
    /// The index of the selected row.
    selected: usize,
    /// The index of the row that came first when the list was last used.
    top: usize,
    /// The first column of statistics that is shown.
    column: usize,
    /// Where the cursor of the map is.
    pose_index: PoseIndex,
    /// The poses that were marked, by letter.
    marks: BTreeMap<char, u64>,
}

impl Results {
    /// What was found, the most frequent imprint first.
    pub fn new(findings: Arc<Findings>) -> Self {
        let mut results = Self {
            page: ExplorePage::Imprints,
            feature: 0,
            values: findings.sweep.atlas.values(0),
            across: (ACROSS, findings.sweep.atlas.values(ACROSS)),
            angle_curve: None,
            angles_asked: None,
            angles_failed: None,
            visible_imprints: VisibleImprints::default(),
            closer: 0,
            order: findings.by_poses.clone(),
            findings,
            sort: (ListColumn::Poses, true),
            heading: ListColumn::Poses,
            filter: String::new(),
            kept: Vec::new(),
            rows: Vec::new(),
            selected: 0,
            top: 0,
            column: 0,
            pose_index: PoseIndex::new([0; 5]),
            marks: BTreeMap::new(),
        };
        results.sift();
        results
    }

    /// All of it.
    pub fn findings(&self) -> &Arc<Findings> {
        &self.findings
    }

    /// The sweep.
    pub fn sweep(&self) -> &SweepResult {
        &self.findings.sweep
    }

    /// The page.
    pub fn page(&self) -> ExplorePage {
        self.page
    }

    /// Goes to a page.
    pub fn turn_to(&mut self, page: ExplorePage) {
        self.page = page;
    }

    /// Goes to another page, the first after the last.
    pub fn next_page(&mut self, by: i8) {
        let next = around(self.page as usize, by, ExplorePage::ALL.len());
        self.page = ExplorePage::ALL[next];
    }

    /// The number of the chosen descriptor.
    pub fn feature_number(&self) -> usize {
        self.feature
    }

    /// The chosen descriptor.
    pub fn feature(&self) -> &'static Feature {
        &features()[self.feature]
    }

    /// Its value of each imprint, by the imprints' numbers.
    pub fn values(&self) -> &[Option<f64>] {
        &self.values
    }

    /// Chooses another descriptor, the first after the last.
    pub fn next_feature(&mut self, by: i8) {
        self.choose_feature(around(self.feature, by, features().len()));
    }

    /// Chooses a descriptor, or the last one. The selected imprint stays selected.
    pub fn choose_feature(&mut self, number: usize) {
        self.feature = number.min(features().len() - 1);
        self.values = self.sweep().atlas.values(self.feature);
        if self.sort.0 == ListColumn::Value {
            self.arrange();
        }
    }

    /// The number of the descriptor that the scatter plot has to the right.
    pub fn across(&self) -> usize {
        self.across.0
    }

    /// Its value of each imprint, by the imprints' numbers.
    pub fn across_values(&self) -> &[Option<f64>] {
        &self.across.1
    }

    /// Chooses another descriptor for the right of the scatter plot, the first after the last.
    pub fn next_across(&mut self, by: i8) {
        let number = around(self.across.0, by, features().len());
        self.across = (number, self.sweep().atlas.values(number));
    }

    /// The imprints of each angle at the zooms of the map, None until a worker has found them.
    pub fn angle_curve(&self) -> Option<&AngleCurve> {
        let curve = self.angle_curve.as_deref();
        curve.filter(|curve| curve.is_at(self.pose_index))
    }

    /// Where the page needs imprints of each angle that nobody was asked for yet. From now on they count as asked for.
    pub fn missing_angles(&mut self) -> Option<PoseIndex> {
        let missing = self.page == ExplorePage::Angles
            && self.angle_curve().is_none()
            && self.angles_asked != Some(zooms_of(self.pose_index));
        if missing {
            self.angles_asked = Some(zooms_of(self.pose_index));
        }
        missing.then_some(self.pose_index)
    }

    /// Takes the imprints of each angle. Those of zooms that were left meanwhile are not needed.
    pub fn take_angles(&mut self, curve: Arc<AngleCurve>) {
        if curve.is_at(self.pose_index) {
            self.angle_curve = Some(curve);
        }
    }

    /// Notes that the imprints of each angle could not be found at the zooms of a place.
    pub fn fail_angles(&mut self, place: PoseIndex) {
        self.angles_failed = Some(zooms_of(place));
    }

    /// Whether that is so at the zooms of the map.
    pub fn angles_failed(&self) -> bool {
        self.angles_failed == Some(zooms_of(self.pose_index))
    }

    /// The imprints that the map showed last.
    pub(super) fn visible_imprints(&self) -> &VisibleImprints {
        &self.visible_imprints
    }

    /// How often the map was zoomed in.
    pub fn closer(&self) -> u8 {
        self.closer
    }

    /// Zooms the map in, or out if negative; `last` is the closest that there is.
    pub fn zoom_map(&mut self, by: i8, last: u8) {
        self.closer = self.closer.min(last).saturating_add_signed(by).min(last);
    }

    /// How many imprints the list has of how many there are, as people read it: `312 of 4,102`.
    pub fn kept_of_all(&self) -> String {
        let count = |count: usize| grouped(count as u64);
        let all = self.sweep().atlas.len();
        format!("{} of {}", count(self.row_count()), count(all))
    }

    /// How much there is; first of all, whether it is all. `sifted` says whether what is shown follows the filter.
    pub fn summary(&self, sifted: bool) -> String {
        let result = self.sweep();
        let all = result.grid.poses();
        let poses = if result.complete() {
            counted(result.poses, "pose")
        } else {
            let done = grouped(result.poses);
            format!("a part: {done} of {}", counted(all, "pose"))
        };
        let what = name_of(result.grid.source());
        if sifted && !self.filter.is_empty() {
            let kept = self.kept_of_all();
            return format!("{what}: {poses}, {kept} distinct imprints: {}", self.filter);
        }
        let distinct = counted(result.atlas.len() as u64, "distinct imprint");
        format!("{what}: {poses}, {distinct}")
    }

    /// What the imprints are sorted by, and whether from the largest on.
    pub fn sort_key(&self) -> (ListColumn, bool) {
        self.sort
    }

    /// Sorts by a column, which becomes the chosen heading; again, the other way. The imprint that is selected stays
    /// selected.
    pub fn sort(&mut self, by: ListColumn) {
        self.sort = if self.sort.0 == by {
            (by, !self.sort.1)
        } else {
            (by, by.largest_first())
        };
        self.heading = by;
        self.arrange();
    }

    /// The heading that is chosen to sort by.
    pub fn heading(&self) -> ListColumn {
        self.heading
    }

    /// Chooses a heading, the one `by` further on among those that are shown; at the ends it stays.
    pub fn move_heading(&mut self, by: i8, shown: &[ListColumn]) {
        let now = shown.iter().position(|&column| column == self.heading);
        let next = now.map_or(0, |now| now.saturating_add_signed(isize::from(by)));
        if let Some(&column) = shown.get(next.min(shown.len().saturating_sub(1))) {
            self.heading = column;
        }
    }

    /// What rows have to fulfil, as it was typed; empty for nothing.
    pub fn filter(&self) -> &str {
        &self.filter
    }

    /// Keeps only the rows that fulfil an expression, given as it was typed and as it was read. The selected imprint stays
    /// selected if it is kept.
    pub fn keep(&mut self, typed: &str, filter: &AtlasFilter) {
        typed.trim().clone_into(&mut self.filter);
        self.kept = if filter.is_empty() {
            Vec::new()
        } else {
            filter.keeps(&self.sweep().atlas)
        };
        self.sift();
    }

    /// Whether the filter keeps an imprint.
    pub fn keeps(&self, id: u32) -> bool {
        let kept = self.kept.get(wide(id));
        kept.is_none_or(|&kept| kept)
    }

    /// Marks the pose that is looked at with a letter; false where there is none.
    pub fn mark(&mut self, letter: char) -> bool {
        let pose = self.pose();
        self.marks.extend(pose.map(|pose| (letter, pose)));
        pose.is_some()
    }

    /// The marked poses with their letters, in the order of these.
    pub fn marks(&self) -> &BTreeMap<char, u64> {
        &self.marks
    }

    /// Sorts and sifts.
    fn arrange(&mut self) {
        let (by, descending) = self.sort;
        self.order = by.order(self.sweep(), &self.values, descending);
        self.sift();
    }

    /// Sifts, and keeps the selected imprint selected; where the filter took it, another one near the same row.
    fn sift(&mut self) {
        let selected = self.rows.get(self.selected).copied();
        let rows = self.order.iter().copied();
        self.rows = rows.filter(|&id| self.keeps(id)).collect();
        if !selected.is_some_and(|id| self.find(id)) {
            self.select(self.selected);
        }
    }

    /// How many rows the list of imprints has.
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// Some of the imprints, from a row on.
    pub fn rows_from(&self, first: usize) -> impl Iterator<Item = (usize, AtlasEntry)> + '_ {
        let rows = self.rows.iter().enumerate().skip(first);
        rows.filter_map(|(index, &id)| Some((index, self.sweep().atlas.entry(id)?)))
    }

    /// Which row is selected.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Selects a row, or the last one.
    pub fn select(&mut self, row: usize) {
        self.selected = row.min(self.rows.len().saturating_sub(1));
    }

    /// The first row of a list that shows `visible` rows. It stays the same while the selected row is visible, else the list
    /// turns by whole pages. The last page is full.
    pub fn first_row(&self, visible: usize) -> usize {
        let visible = visible.max(1);
        let last = self.rows.len().saturating_sub(visible);
        let top = self.top.min(last);
        let first = if (top..top + visible).contains(&self.selected) {
            top
        } else {
            self.selected - self.selected % visible
        };
        first.min(last)
    }

    /// Keeps the row that comes first.
    pub fn keep_first_row(&mut self, visible: usize) {
        self.top = self.first_row(visible);
    }

    /// Selects an imprint; false where the list has none of that number.
    pub fn find(&mut self, id: u32) -> bool {
        let row = self.rows.iter().position(|&row| row == id);
        self.selected = row.unwrap_or(self.selected);
        row.is_some()
    }

    /// The first column of statistics that is shown.
    pub fn column(&self) -> usize {
        self.column
    }

    /// Shows other columns, the first of them no later than the `last`.
    pub fn move_columns(&mut self, by: i8, last: usize) {
        let moved = (self.column.min(last)).saturating_add_signed(isize::from(by));
        self.column = moved.min(last);
    }

    /// Where the map's cursor is.
    pub fn pose_index(&self) -> PoseIndex {
        self.pose_index
    }

    /// Puts it at an x0 and a y0, or the last ones.
    pub fn point(&mut self, x0: u64, y0: u64) {
        let counts = self.sweep().grid.counts();
        self.pose_index[Axis::X0] = x0.min(counts[Axis::X0] - 1);
        self.pose_index[Axis::Y0] = y0.min(counts[Axis::Y0] - 1);
    }

    /// Shows another angle.
    pub fn turn(&mut self, by: i16) {
        let count = self.sweep().grid.counts()[Axis::Angle];
        let now = self.pose_index[Axis::Angle];
        // The first angle follows the last, as the angles may go all around.
        let forward = u64::from(by.unsigned_abs()) % count;
        let step = if by < 0 { count - forward } else { forward };
        self.pose_index[Axis::Angle] = (now + step) % count;
    }

    /// Shows another zoom, up to the last one.
    pub fn zoom(&mut self, zoom: Zoom, by: i8) {
        self.move_along(zoom.axis(), by.into());
    }

    /// Moves the map's cursor along an axis by a number of poses, at most to its ends.
    pub fn move_along(&mut self, axis: Axis, by: i64) {
        let last = self.sweep().grid.counts()[axis] - 1;
        self.pose_index[axis] = self.pose_index[axis].saturating_add_signed(by).min(last);
    }

    /// Puts the map's cursor where a pose is.
    pub fn go_to_pose(&mut self, number: u64) {
        self.pose_index = self.sweep().grid.index(number);
    }

    /// The pose that is looked at: of the map and the angles, or the first one of the selected imprint; its number.
    pub fn pose(&self) -> Option<u64> {
        if matches!(self.page, ExplorePage::Map | ExplorePage::Angles) {
            return Some(self.sweep().grid.number(self.pose_index));
        }
        let (_, entry) = self.rows_from(self.selected).next()?;
        Some(entry.first_pose)
    }

    /// A pose in words: the values of the axes that a sweep of this shape has.
    pub fn pose_text(&self, pose: &Pose) -> String {
        let values = self.sweep().grid.axes().map(|axis| {
            let parameter = axis.parameter();
            let text = parameter.format(pose[axis]);
            format!("{} {text}", parameter.row().short)
        });
        values.collect::<Vec<_>>().join(", ")
    }

    /// The characters that the values of an axis need, or its name.
    pub fn width_of(&self, axis: Axis) -> usize {
        let (range, parameter) = (self.sweep().grid.ranges()[axis], axis.parameter());
        let ends = [range.value(0), range.value(1), range.last()];
        let widths = ends.map(|value| parameter.format(value).len());
        widths
            .into_iter()
            .fold(parameter.row().short.len(), usize::max)
    }

    /// The number of the imprint that a pose leaves, None if the pose was not swept.
    pub fn id_at(&self, pose: u64) -> Option<u32> {
        let grid = &self.sweep().grid;
        let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(grid.pose(pose)));
        self.id(&imprint)
    }

    /// The number of an imprint in the atlas.
    pub fn id(&self, imprint: &Imprint) -> Option<u32> {
        self.sweep().atlas.find(imprint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::picture::Picture;
    use crate::pose::{Anchor, Axis, PoseGrid, Ranges};
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::sweep::Sweep;

    fn results() -> Results {
        let source = Source::Figure(Figure::default_of(FigureKind::Heptagon, &Sensor::default()));
        of(source, ranges())
    }

    /// A picture in two zooms.
    fn with_zooms() -> Results {
        let bar = "####\n####".parse().expect("an imprint");
        let zooms = "1:1.5:0.5".parse().expect("a range");
        let source = Source::Picture(Picture::at_home(bar));
        of(source, ranges().with(Axis::ZoomX, zooms))
    }

    fn ranges() -> Ranges {
        Ranges::default()
            .with(Axis::X0, "5:5.9:0.1".parse().expect("a range"))
            .with(Axis::Y0, "5:5.5:0.1".parse().expect("a range"))
            .with(Axis::Angle, "0:80:20".parse().expect("a range"))
    }

    fn of(source: Source, ranges: Ranges) -> Results {
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
        let sweep = Sweep::new(&grid.expect("in range")).run();
        Results::new(Arc::new(Findings::new(sweep)))
    }

    #[test]
    fn the_selected_imprint_stays_selected_when_the_descriptor_changes() {
        let mut results = results();
        results.sort(ListColumn::Value);
        results.select(7);
        let selected = |results: &Results| results.rows_from(results.selected()).next();
        let before = selected(&results).map(|(_, entry)| entry.id);
        results.next_feature(3);
        assert_eq!(selected(&results).map(|(_, entry)| entry.id), before);
        results.sort(ListColumn::Poses);
        assert_eq!(selected(&results).map(|(_, entry)| entry.id), before);
        let (_, most) = results.rows_from(0).next().expect("a row");
        assert!(
            results
                .rows_from(0)
                .all(|(_, entry)| entry.count <= most.count)
        );
        results.sort(ListColumn::Poses);
        assert_eq!(results.sort_key(), (ListColumn::Poses, false));
    }

    #[test]
    fn angles_of_a_zoom_that_was_left_do_not_replace_those_of_the_present_one() {
        let mut results = with_zooms();
        results.turn_to(ExplorePage::Angles);
        let curve = |place| Arc::new(AngleCurve::of(results.sweep(), place));
        let first = results.pose_index();
        let (early, late) = (curve(first), curve(first.with(Axis::ZoomX, 1)));
        assert_eq!(results.missing_angles(), Some(first));
        // The curve is that of all angles and positions.
        results.move_along(Axis::X0, 1);
        assert_eq!(results.missing_angles(), None, "asked for already");
        results.move_along(Axis::X0, -1);
        results.zoom(Zoom::X, 1);
        assert!(results.missing_angles().is_some());
        results.take_angles(late);
        results.take_angles(early);
        assert!(results.angle_curve().is_some());
        results.zoom(Zoom::X, -1);
        assert_eq!(results.missing_angles(), Some(first), "asked for again");
    }

    #[test]
    fn a_filter_and_marks_keep_to_the_imprints_they_name() {
        let mut results = results();
        let all = results.row_count();
        results.select(7);
        let ids = |results: &Results| {
            let rows = results.rows_from(0);
            rows.map(|(_, entry)| entry.id).collect::<Vec<_>>()
        };
        let before = ids(&results);
        assert!(results.mark('a'));
        let kept = before[7];
        let typed = format!("id<={kept}");
        results.keep(&typed, &typed.parse().expect("an expression"));
        assert!(results.row_count() < all && results.filter() == typed);
        assert_eq!(ids(&results)[results.selected()], kept);
        assert!(results.keeps(kept) && !results.keeps(kept + 1));
        assert!(!results.find(kept + 1));
        results.keep("id<0", &"id<0".parse().expect("an expression"));
        assert_eq!((results.row_count(), results.selected()), (0, 0));
        assert!(results.pose().is_none() && !results.mark('b'));
        results.keep("", &AtlasFilter::default());
        assert_eq!(ids(&results), before);
        let entry = results.sweep().atlas.entry(kept).expect("it is there");
        assert_eq!(results.marks().get(&'a'), Some(&entry.first_pose));
        assert_eq!(results.marks().len(), 1);
    }

    #[test]
    fn the_last_page_of_the_list_is_full_and_rows_stay_while_one_of_them_is_selected() {
        let mut results = results();
        let (all, visible) = (results.row_count(), 10);
        assert!(all > 25 && all % visible != 0, "{all}");
        let mut first = |row| {
            results.keep_first_row(visible);
            results.select(row);
            results.keep_first_row(visible);
            results.first_row(visible)
        };
        assert_eq!([first(9), first(10), first(19)], [0, 10, 10]);
        let last = all - visible;
        assert_eq!([first(usize::MAX), first(last)], [last, last]);
        assert_eq!(first(last - 1), (last - 1) / visible * visible);
        first(usize::MAX);
        results.keep("id<15", &"id<15".parse().expect("an expression"));
        assert_eq!(results.first_row(visible), 5, "no line stays empty");
        assert_eq!(results.first_row(20), 0);
    }

    #[test]
    fn rows_are_sorted_by_any_heading_that_is_shown() {
        let mut results = results();
        let shown = [
            ListColumn::FirstPose,
            ListColumn::Place(Axis::X0),
            ListColumn::Place(Axis::Angle),
        ];
        results.move_heading(1, &shown);
        assert_eq!(results.heading(), shown[0], "that of poses is not shown");
        results.move_heading(1, &shown);
        results.sort(results.heading());
        let places = |results: &Results, axis| {
            let grid = results.sweep().grid.clone();
            let rows = results.rows_from(0);
            rows.map(|(_, entry)| grid.pose(entry.first_pose)[axis])
                .collect::<Vec<f64>>()
        };
        assert!(places(&results, Axis::X0).is_sorted());
        results.move_heading(9, &shown);
        results.sort(results.heading());
        results.sort(results.heading());
        let angles = places(&results, Axis::Angle);
        assert!(angles.iter().rev().is_sorted(), "{angles:?}");
    }

    #[test]
    fn the_cursor_of_the_map_stays_on_it() {
        let mut results = results();
        results.turn_to(ExplorePage::Map);
        for (axis, by, place) in [
            (Axis::X0, -1, [0, 0, 0, 0, 0]),
            (Axis::X0, 1, [1, 0, 0, 0, 0]),
            (Axis::Y0, 1, [1, 1, 0, 0, 0]),
        ] {
            results.move_along(axis, by);
            assert_eq!(results.pose_index().into_array(), place);
        }
        results.point(u64::MAX, u64::MAX);
        results.turn(-1);
        results.zoom(Zoom::X, 1);
        assert_eq!(results.pose_index().into_array(), [9, 5, 4, 0, 0]);
        results.move_along(Axis::Y0, -3);
        results.move_along(Axis::X0, i64::MIN);
        results.turn(1);
        assert_eq!(results.pose_index().into_array(), [0, 2, 0, 0, 0]);
        assert_eq!(results.pose(), Some(20));
        results.next_page(1);
        assert_eq!(results.page(), ExplorePage::Scatter);
    }
}
