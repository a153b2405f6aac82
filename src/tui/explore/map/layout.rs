//! The places of the map's cells, of its rulers and of the pose at its cursor.
//!
//! If letters for all poses do not fit, the map begins as a picture of its whole range, in which each half of a
//! character is a pose: every n-th one along both axes. Zooming in halves n, down to every pose, and then changes to
//! letters. A map that is larger than its tab scrolls with its cursor. A letter is two columns wide if the whole map
//! fits that way.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use ratatui::layout::{Position, Rect};
use taxel_core::pose::{Axis, PoseIndex};

use crate::tui::explore::results::Results;
use crate::tui::widget::write::{below, narrow};

#[derive(Clone, Copy, Debug)]
pub struct MapPane {
    pub head: Rect,
    pub ruler: Rect,
    pub cells: Rect,
    pub cell: u16,
    /// The number of poses in a line of the screen, one above the other: two in a picture, otherwise one.
    pub lines: u16,
    pub stride: u64,
    pub closest: u8,
    pub first: (u64, u64),
    pub count: (u64, u64),
    pub side: Option<Rect>,
    pub detail: Rect,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MapScale {
    Letters,
    Picture(u64),
}

fn scales((width, height): (u64, u64), (columns, lines): (u16, u16)) -> Vec<MapScale> {
    let (columns, lines) = (u64::from(columns.max(1)), u64::from(lines.max(1)));
    let mut scales = Vec::new();
    if width > columns || height > lines {
        let mut stride = width.div_ceil(columns).max(height.div_ceil(2 * lines));
        scales.push(MapScale::Picture(stride));
        while stride > 1 {
            stride = stride.div_ceil(2);
            scales.push(MapScale::Picture(stride));
        }
    }
    scales.push(MapScale::Letters);
    scales
}

impl MapPane {
    pub fn of(area: Rect, results: &Results) -> Self {
        let grid = &results.sweep().grid;
        let [width, height, ..] = grid.counts().into_array();
        let label = narrow(results.width_of(Axis::Y0) + 1);
        let side = u16::from(grid.sensor().columns()).clamp(22, 32);
        let with_side = area.width >= label + side + 22;
        let room = area.width - if with_side { side + 2 } else { 0 };
        let body = below(area, 2);
        let body = Rect {
            height: body.height.saturating_sub(1),
            ..body
        };
        let across = room.saturating_sub(label);
        let scales = scales((width, height), (across, body.height));
        // There are at most as many scales as a number has bits, plus two.
        let closest = scales.len() - 1;
        let scale = scales[usize::from(results.map_zoom).min(closest)];
        let (stride, lines) = match scale {
            MapScale::Letters => (1, 1),
            MapScale::Picture(stride) => (stride, 2),
        };
        let double = scale == MapScale::Letters && 2 * width <= u64::from(across);
        let cell = if double { 2 } else { 1 };
        let [x0, y0, ..] = results.pose_index.into_array();
        let (from_x, seen_x) = seen(x0, width, stride, u64::from(across / cell), 1);
        let rows = u64::from(body.height) * u64::from(lines);
        let (from_y, seen_y) = seen(y0, height, stride, rows, lines.into());
        let cells = Rect {
            x: area.x + label.min(area.width),
            width: narrow(seen_x) * cell,
            height: narrow(seen_y.div_ceil(lines.into())),
            ..body
        };
        let line = |index: u16| Rect {
            height: u16::from(index < area.height),
            width: room,
            ..below(area, index)
        };
        Self {
            head: line(0),
            ruler: line(1),
            cells,
            cell,
            lines,
            stride,
            closest: u8::try_from(closest).unwrap_or(u8::MAX),
            first: (from_x, from_y),
            count: (seen_x, seen_y),
            side: with_side.then_some(Rect {
                x: area.x + room + 2,
                width: side,
                ..area
            }),
            detail: Rect {
                height: u16::from(area.height > 2),
                ..below(area, area.height.saturating_sub(1))
            },
        }
    }

    pub fn pose(&self, place: Position) -> Option<(u64, u64)> {
        self.cells.contains(place).then(|| {
            let x = u64::from((place.x - self.cells.x) / self.cell);
            let y = u64::from(place.y - self.cells.y) * u64::from(self.lines);
            (
                self.first.0 + x * self.stride,
                self.first.1 + y * self.stride,
            )
        })
    }

    pub fn position(&self, (x0, y0): (u64, u64)) -> Option<(Position, bool)> {
        let x = x0.checked_sub(self.first.0)? / self.stride;
        let y = y0.checked_sub(self.first.1)? / self.stride;
        let inside = x < self.count.0 && y < self.count.1;
        let line = narrow(y / u64::from(self.lines));
        let lower = !y.is_multiple_of(self.lines.into());
        inside.then(|| {
            let place = Position::new(self.cells.x + narrow(x) * self.cell, self.cells.y + line);
            (place, lower)
        })
    }

    pub fn is_picture(&self) -> bool {
        self.lines > 1
    }
}

/// Returns the first visible pose along an axis, and the number of visible ones. One in `stride` of `all` poses is
/// shown, at most `room` of these are visible, and the pose `at` is as near to the middle as the ends allow. `block`
/// of them share a line.
fn seen(at: u64, all: u64, stride: u64, room: u64, block: u64) -> (u64, u64) {
    let shown = all.div_ceil(stride);
    let seen = shown.min(room);
    // Rounded up to whole blocks, because otherwise the last pose could not be reached if its block is not full.
    let last = (shown - seen).next_multiple_of(block);
    let first = (at / stride).saturating_sub(seen / 2).min(last);
    let first = first - first % block;
    (first * stride, seen.min(shown.saturating_sub(first)))
}

pub const LETTERS: u8 = 62;

/// Returns the sign of each cell of a map as a number below `count`, or None where there is no imprint. `width` is the
/// number of cells in a row. Different imprints have different signs until all are used; then signs are repeated, but
/// not for cells that touch, also across corners. Only around an imprint that touches `count` others can they run out.
/// By default the imprint's number decides, so that most signs stay when the map moves.
pub fn signs(ids: &[Option<u32>], width: usize, count: u8) -> Vec<Option<u8>> {
    let width = width.max(1);
    let mut neighbours: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
    let mut touch = |one: u32, other: usize| {
        let own = neighbours.entry(one).or_default();
        if let Some(&Some(other)) = ids.get(other)
            && other != one
        {
            own.insert(other);
            neighbours.entry(other).or_default().insert(one);
        }
    };
    for (index, id) in ids.iter().enumerate() {
        let Some(id) = *id else { continue };
        let column = index % width;
        touch(id, index + width);
        if column + 1 < width {
            touch(id, index + 1);
            touch(id, index + width + 1);
        }
        if column > 0 {
            touch(id, index + width - 1);
        }
    }
    // Imprints with the most neighbours come first: an imprint with fewer neighbours than there are letters always
    // finds one.
    let mut order: Vec<u32> = neighbours.keys().copied().collect();
    order.sort_by_key(|id| std::cmp::Reverse(neighbours[id].len()));
    let mut chosen: BTreeMap<u32, u8> = BTreeMap::new();
    let mut used: BTreeSet<u8> = BTreeSet::new();
    for id in order {
        let taken = |letter: &u8| {
            let mut around = neighbours[&id].iter();
            around.any(|other| chosen.get(other) == Some(letter))
        };
        // The remainder has one byte.
        let [own, ..] = (id % u32::from(count)).to_le_bytes();
        let others = || (0..count).map(|step| (own + step) % count);
        let unused = |letter: &u8| !used.contains(letter);
        let letter = others()
            .find(unused)
            .or_else(|| others().find(|letter| !taken(letter)));
        let letter = letter.unwrap_or(own);
        used.insert(letter);
        chosen.insert(id, letter);
    }
    ids.iter()
        .map(|id| chosen.get(id.as_ref()?).copied())
        .collect()
}

pub fn letter(number: u8) -> char {
    let (first, number) = match number {
        0..26 => (b'a', number),
        26..52 => (b'A', number - 26),
        _ => (b'0', (number - 52).min(9)),
    };
    char::from(first + number)
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct VisiblePoses {
    pub(super) first: PoseIndex,
    pub(super) count: (u64, u64),
    pub(super) stride: u64,
}

#[derive(Clone, Debug, Default)]
pub struct VisibleImprints(RefCell<Option<PosesAndImprints>>);

type PosesAndImprints = (VisiblePoses, Arc<[Option<u32>]>);

impl VisibleImprints {
    /// Calls `find` if other poses were visible last.
    pub(super) fn of(
        &self,
        poses: VisiblePoses,
        find: impl FnOnce() -> Vec<Option<u32>>,
    ) -> Arc<[Option<u32>]> {
        let mut last = self.0.borrow_mut();
        if let Some((_, ids)) = last.as_ref().filter(|(known, _)| *known == poses) {
            return Arc::clone(ids);
        }
        let ids: Arc<[_]> = find().into();
        *last = Some((poses, Arc::clone(&ids)));
        ids
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_is_shown_whole_first_and_the_closest_zoom_has_letters() {
        let strides = |map, room| {
            let scales = scales(map, room).into_iter();
            let strides = scales.map(|scale| match scale {
                MapScale::Picture(stride) => stride,
                MapScale::Letters => 0,
            });
            strides.collect::<Vec<_>>()
        };
        assert_eq!(strides((40, 17), (40, 17)), [0], "letters fit at once");
        assert_eq!(strides((41, 17), (40, 17)), [2, 1, 0]);
        assert_eq!(strides((40, 34), (40, 17)), [1, 0]);
        assert_eq!(strides((100, 100), (52, 17)), [3, 2, 1, 0]);
        assert_eq!(strides((1_000_000, 1), (0, 0)).last(), Some(&0));
    }

    #[test]
    fn the_visible_poses_include_the_cursor_and_begin_at_a_block() {
        for (all, stride, room, block) in [
            (100, 3, 20, 2),
            (101, 2, 34, 2),
            (101, 1, 34, 2),
            (7, 2, 9, 2),
            (50, 1, 4, 1),
            (5, 5, 0, 2),
        ] {
            for at in 0..all {
                let (first, count) = seen(at, all, stride, room, block);
                assert!(first.is_multiple_of(stride * block) && count <= room);
                assert!((first + count * stride).saturating_sub(all) < stride * block.max(2));
                let here = first <= at && at < first + count * stride;
                assert!(here || room == 0, "{at} of {all}: {first}, {count}");
            }
        }
    }

    #[test]
    fn neighbours_differ_and_an_imprint_has_one_letter() {
        // These numbers would all have the same letter.
        for (width, height) in [(1, 9), (9, 1), (7, 8), (40, 30)] {
            let id = |x: usize, y: usize| {
                let block = (x / 3 * 7 + y / 2 * 5) % 23;
                (block % 6 != 5).then(|| u32::try_from(block * 62).expect("small"))
            };
            let places = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let ids: Vec<_> = places().map(|(x, y)| id(x, y)).collect();
            let found = signs(&ids, width, LETTERS);
            let at = |x: usize, y: usize| (ids[y * width + x], found[y * width + x]);
            for (x, y) in places() {
                let (own, letter) = at(x, y);
                assert_eq!(own.is_some(), letter.is_some());
                for (other_x, other_y) in places() {
                    let (other, other_letter) = at(other_x, other_y);
                    let near = x.abs_diff(other_x) <= 1 && y.abs_diff(other_y) <= 1;
                    if own.is_some() && own == other {
                        assert_eq!(letter, other_letter);
                    } else if near && own.is_some() && other.is_some() {
                        assert_ne!(letter, other_letter, "{x},{y} and {other_x},{other_y}");
                    }
                }
            }
        }
        // 62 would have the letter of 0.
        let found = signs(&[Some(0), Some(62), None, Some(3)], 2, LETTERS);
        assert_eq!(found, [Some(0), Some(1), None, Some(3)]);
        assert_eq!(signs(&[], 0, LETTERS), []);
        let all: String = (0..LETTERS).map(letter).collect();
        assert!(
            all.starts_with("abc") && all.ends_with("XYZ0123456789"),
            "{all}"
        );
        // As many imprints as there are letters: no letter twice, whatever their numbers.
        let ids: Vec<_> = (0..u32::from(LETTERS)).map(|id| Some(id * 31)).collect();
        let different: BTreeSet<_> = signs(&ids, 8, LETTERS).into_iter().flatten().collect();
        assert_eq!(different.len(), ids.len());
    }

    #[test]
    fn poses_are_swept_once_while_they_stay_visible() {
        let visible = VisibleImprints::default();
        let at = |first: u64| VisiblePoses {
            first: PoseIndex::new([first, 0, 0, 0, 0]),
            count: (1, 1),
            stride: 1,
        };
        assert_eq!(*visible.of(at(3), || vec![Some(7)]), [Some(7)]);
        assert_eq!(*visible.of(at(3), || panic!("it is known")), [Some(7)]);
        assert_eq!(*visible.of(at(4), || vec![None]), [None]);
        assert_eq!(*visible.of(at(3), || vec![Some(7)]), [Some(7)]);
    }
}
