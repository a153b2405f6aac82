//! The results of a sweep, and the state of their tabs: the open one, descriptor, list, cursor of the map.
//!
//! The findings never change, and are shared with workers that write them to files. The tabs that show a descriptor
//! show the same one, which the points have as their vertical axis; the list and the map lead to each other.

use std::sync::Arc;

use taxel_core::atlas::{AtlasEntry, AtlasFilter, Feature, features};
use taxel_core::imprint::Imprint;
use taxel_core::pose::{Axis, Pose, PoseIndex};
use taxel_core::sweep::SweepResult;
use taxel_core::touch::Plane;
use taxel_files::formats::value::{counted, grouped};

use crate::tui::explore::angles::{AngleCurve, AngleSearch, zooms_of};
use crate::tui::explore::imprints::ImprintList;
use crate::tui::explore::map::layout::VisibleImprints;
use crate::tui::explore::message::{ExploreTab, Findings, ListColumn, name_of};
use crate::tui::widget::write::around;

const X_FEATURE: usize = 7;

#[derive(Clone, Debug)]
pub struct Results {
    pub(super) findings: Arc<Findings>,
    pub(super) tab: ExploreTab,
    pub(super) feature: usize,
    values: Vec<Option<f64>>,
    x_feature: (usize, Vec<Option<f64>>),
    /// The zooms for which the imprints of each angle were requested last, and the search for them; None until the
    /// tab of angles was opened.
    angles: Option<(PoseIndex, AngleSearch)>,
    pub(in crate::tui::explore) visible_imprints: VisibleImprints,
    pub(in crate::tui::explore) map_zoom: u8,
    pub(super) list: ImprintList,
    pub(in crate::tui::explore) pose_index: PoseIndex,
}

impl Results {
    pub fn new(findings: Arc<Findings>) -> Self {
        Self {
            tab: ExploreTab::Imprints,
            feature: 0,
            values: findings.sweep.atlas.values(0),
            x_feature: (X_FEATURE, findings.sweep.atlas.values(X_FEATURE)),
            angles: None,
            visible_imprints: VisibleImprints::default(),
            map_zoom: 0,
            list: ImprintList::new(findings.by_poses.clone()),
            findings,
            pose_index: PoseIndex::new([0; 5]),
        }
    }

    pub fn sweep(&self) -> &SweepResult {
        &self.findings.sweep
    }

    pub fn open_tab(&mut self, tab: ExploreTab) {
        self.tab = tab;
    }

    pub fn next_tab(&mut self, by: i8) {
        let next = around(self.tab as usize, by, ExploreTab::ALL.len());
        self.tab = ExploreTab::ALL[next];
    }

    pub fn feature(&self) -> &'static Feature {
        &features()[self.feature]
    }

    pub fn values(&self) -> &[Option<f64>] {
        &self.values
    }

    pub fn next_feature(&mut self, by: i8) {
        self.choose_feature(around(self.feature, by, features().len()));
    }

    /// The selected imprint stays selected.
    pub fn choose_feature(&mut self, number: usize) {
        self.feature = number.min(features().len() - 1);
        self.values = self.sweep().atlas.values(self.feature);
        if self.list.sort.0 == ListColumn::Value {
            self.list.arrange(&self.findings.sweep, &self.values);
        }
    }

    pub fn x_feature(&self) -> usize {
        self.x_feature.0
    }

    pub fn x_values(&self) -> &[Option<f64>] {
        &self.x_feature.1
    }

    pub fn next_x_feature(&mut self, by: i8) {
        let number = around(self.x_feature.0, by, features().len());
        self.x_feature = (number, self.sweep().atlas.values(number));
    }

    pub fn angles(&self) -> Option<&AngleSearch> {
        let own = |(zooms, _): &&_| *zooms == zooms_of(self.pose_index);
        Some(&self.angles.as_ref().filter(own)?.1)
    }

    /// Returns the imprints of each angle at the zooms of the map; None until a worker has found them.
    pub fn angle_curve(&self) -> Option<&AngleCurve> {
        match self.angles()? {
            AngleSearch::Found(curve) => Some(curve),
            _ => None,
        }
    }

    /// Returns the place at whose zooms the tab needs the imprints of each angle, if they were not requested yet.
    /// They count as requested afterwards.
    pub fn missing_angles(&mut self) -> Option<PoseIndex> {
        let missing = self.tab == ExploreTab::Angles && self.angles().is_none();
        if missing {
            self.angles = Some((zooms_of(self.pose_index), AngleSearch::Running));
        }
        missing.then_some(self.pose_index)
    }

    /// Dropped if other zooms were requested meanwhile.
    pub fn take_angles(&mut self, place: PoseIndex, curve: Option<Arc<AngleCurve>>) {
        if let Some((zooms, search)) = &mut self.angles
            && *zooms == zooms_of(place)
        {
            *search = curve.map_or(AngleSearch::Failed, AngleSearch::Found);
        }
    }

    /// Zooms the map in, or out if `by` is negative; `last` is the closest zoom.
    pub fn zoom_map(&mut self, by: i8, last: u8) {
        self.map_zoom = self.map_zoom.min(last).saturating_add_signed(by).min(last);
    }

    pub fn kept_of_all(&self) -> String {
        let count = |count: usize| grouped(count as u64);
        let all = self.sweep().atlas.len();
        format!("{} of {}", count(self.list.row_count()), count(all))
    }

    /// `filtered` is whether the open tab follows the filter.
    pub fn summary(&self, filtered: bool) -> String {
        let result = self.sweep();
        let all = result.grid.poses();
        let poses = if result.complete() {
            counted(result.poses, "pose")
        } else {
            let done = grouped(result.poses);
            format!("a part: {done} of {}", counted(all, "pose"))
        };
        let what = name_of(result.grid.source());
        let filter = self.list.filter();
        if filtered && !filter.is_empty() {
            let kept = self.kept_of_all();
            return format!("{what}: {poses}, {kept} distinct imprints: {filter}");
        }
        let distinct = counted(result.atlas.len() as u64, "distinct imprint");
        format!("{what}: {poses}, {distinct}")
    }

    /// The selected imprint stays selected.
    pub fn sort(&mut self, by: ListColumn) {
        self.list.sort(by, &self.findings.sweep, &self.values);
    }

    /// The selected imprint stays selected if it is kept.
    pub fn keep(&mut self, typed: &str, filter: &AtlasFilter) {
        self.list.keep(typed, filter, &self.findings.sweep.atlas);
    }

    pub fn rows_from(&self, first: usize) -> impl Iterator<Item = (usize, AtlasEntry)> + '_ {
        let rows = self.list.rows().enumerate().skip(first);
        rows.filter_map(|(index, id)| Some((index, self.sweep().atlas.entry(id)?)))
    }

    pub fn go_to_imprint(&mut self, id: u32) -> Result<(), String> {
        if self.list.find(id) {
            return Ok(());
        }
        Err(format!(
            "the filter hides imprint {id}: {}",
            self.list.filter()
        ))
    }

    pub fn go_to_imprint_at(&mut self, pose: u64) -> Result<(), String> {
        let id = self.id_at(pose);
        self.go_to_imprint(id.ok_or("this pose was not swept: the sweep was stopped")?)
    }

    pub fn point(&mut self, x0: u64, y0: u64) {
        let counts = self.sweep().grid.counts();
        self.pose_index[Axis::X0] = x0.min(counts[Axis::X0] - 1);
        self.pose_index[Axis::Y0] = y0.min(counts[Axis::Y0] - 1);
    }

    pub fn turn(&mut self, by: i16) {
        let count = self.sweep().grid.counts()[Axis::Angle];
        let now = self.pose_index[Axis::Angle];
        // The first angle follows the last one, as the angles may go all around.
        let forward = u64::from(by.unsigned_abs()) % count;
        let step = if by < 0 { count - forward } else { forward };
        self.pose_index[Axis::Angle] = (now + step) % count;
    }

    pub fn to_angle(&mut self, index: u64) {
        self.pose_index[Axis::Angle] = index.min(self.sweep().grid.counts()[Axis::Angle] - 1);
    }

    pub fn move_along(&mut self, axis: Axis, by: i64) {
        let last = self.sweep().grid.counts()[axis] - 1;
        self.pose_index[axis] = self.pose_index[axis].saturating_add_signed(by).min(last);
    }

    pub fn go_to_pose(&mut self, number: u64) {
        self.pose_index = self.sweep().grid.index(number);
    }

    /// Returns the number of the present pose: at the map's cursor on the tabs of map and angles, otherwise the
    /// first pose of the selected imprint.
    pub fn pose(&self) -> Option<u64> {
        if matches!(self.tab, ExploreTab::Map | ExploreTab::Angles) {
            return Some(self.sweep().grid.number(self.pose_index));
        }
        let (_, entry) = self.rows_from(self.list.selected()).next()?;
        Some(entry.first_pose)
    }

    pub fn pose_text(&self, pose: &Pose) -> String {
        let values = self.sweep().grid.axes().map(|axis| {
            let parameter = axis.parameter();
            let text = parameter.format(pose[axis]);
            format!("{} {text}", parameter.row().short)
        });
        values.collect::<Vec<_>>().join(", ")
    }

    pub fn width_of(&self, axis: Axis) -> usize {
        let (range, parameter) = (self.sweep().grid.ranges()[axis], axis.parameter());
        let ends = [range.value(0), range.value(1), range.last()];
        let widths = ends.map(|value| parameter.format(value).len());
        widths
            .into_iter()
            .fold(parameter.row().short.len(), usize::max)
    }

    pub fn id_at(&self, pose: u64) -> Option<u32> {
        let grid = &self.sweep().grid;
        let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(pose));
        self.id(&imprint)
    }

    pub fn id(&self, imprint: &Imprint) -> Option<u32> {
        self.sweep().atlas.find(imprint)
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::{Figure, FigureKind};
    use taxel_core::picture::Picture;
    use taxel_core::pose::{Anchor, Axis, PoseGrid, Ranges};
    use taxel_core::sensor::Sensor;
    use taxel_core::source::Source;
    use taxel_core::sweep::Sweep;

    use super::*;

    fn results() -> Results {
        let source = Source::Figure(Figure::default_of(FigureKind::Heptagon, &Sensor::default()));
        of(source, ranges())
    }

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
    fn angles_of_an_earlier_zoom_do_not_replace_the_present_ones() {
        let mut results = with_zooms();
        results.open_tab(ExploreTab::Angles);
        let curve = |place| Arc::new(AngleCurve::of(results.sweep(), place));
        let first = results.pose_index;
        let second = first.with(Axis::ZoomX, 1);
        let (early, late) = (curve(first), curve(second));
        assert_eq!(results.missing_angles(), Some(first));
        // The curve belongs to all angles and positions.
        results.move_along(Axis::X0, 1);
        results.turn(1);
        assert_eq!(results.missing_angles(), None, "asked for already");
        results.move_along(Axis::X0, -1);
        results.turn(-1);
        results.move_along(Axis::ZoomX, 1);
        assert!(results.missing_angles().is_some());
        results.take_angles(second, Some(Arc::clone(&late)));
        results.take_angles(first, Some(early));
        assert_eq!(results.angle_curve(), Some(&*late));
        results.turn(1);
        assert_eq!(results.angle_curve(), Some(&*late));
        results.turn(-1);
        results.move_along(Axis::ZoomX, -1);
        assert_eq!(results.missing_angles(), Some(first), "asked for again");
    }

    #[test]
    fn a_filter_keeps_the_right_imprints() {
        let mut results = results();
        let all = results.list.row_count();
        results.list.select(7);
        let ids = |results: &Results| {
            let rows = results.rows_from(0);
            rows.map(|(_, entry)| entry.id).collect::<Vec<_>>()
        };
        let before = ids(&results);
        let kept = before[7];
        let typed = format!("id<={kept}");
        results.keep(&typed, &typed.parse().expect("an expression"));
        assert!(results.list.row_count() < all && results.list.filter() == typed);
        assert_eq!(ids(&results)[results.list.selected()], kept);
        assert!(results.list.keeps(kept) && !results.list.keeps(kept + 1));
        assert!(!results.list.find(kept + 1));
        results.keep("id<0", &"id<0".parse().expect("an expression"));
        assert_eq!((results.list.row_count(), results.list.selected()), (0, 0));
        assert!(results.pose().is_none());
        results.keep("", &AtlasFilter::default());
        assert_eq!(ids(&results), before);
    }

    #[test]
    fn the_last_screenful_is_full_and_the_list_scrolls_only_when_needed() {
        let mut results = results();
        let (all, visible) = (results.list.row_count(), 10);
        assert!(all > 25 && all % visible != 0, "{all}");
        let mut first = |row| {
            results.list.keep_first_row(visible);
            results.list.select(row);
            results.list.keep_first_row(visible);
            results.list.first_row(visible)
        };
        assert_eq!([first(9), first(10), first(19)], [0, 10, 10]);
        let last = all - visible;
        assert_eq!([first(usize::MAX), first(last)], [last, last]);
        assert_eq!(first(last - 1), (last - 1) / visible * visible);
        first(usize::MAX);
        results.keep("id<15", &"id<15".parse().expect("an expression"));
        assert_eq!(results.list.first_row(visible), 5, "no line stays empty");
        assert_eq!(results.list.first_row(20), 0);
    }

    #[test]
    fn the_cursor_of_the_map_stays_on_it() {
        let mut results = results();
        results.open_tab(ExploreTab::Map);
        for (axis, by, place) in [
            (Axis::X0, -1, [0, 0, 0, 0, 0]),
            (Axis::X0, 1, [1, 0, 0, 0, 0]),
            (Axis::Y0, 1, [1, 1, 0, 0, 0]),
        ] {
            results.move_along(axis, by);
            assert_eq!(results.pose_index.into_array(), place);
        }
        results.point(u64::MAX, u64::MAX);
        results.turn(-1);
        results.move_along(Axis::ZoomX, 1);
        assert_eq!(results.pose_index.into_array(), [9, 5, 4, 0, 0]);
        results.move_along(Axis::Y0, -3);
        results.move_along(Axis::X0, i64::MIN);
        results.turn(1);
        assert_eq!(results.pose_index.into_array(), [0, 2, 0, 0, 0]);
        assert_eq!(results.pose(), Some(20));
        results.next_tab(1);
        assert_eq!(results.tab, ExploreTab::Scatter);
    }
}
