//! The imprints of the visible poses, kept from one drawing to the next: while only the cursor moves, the same poses
//! stay visible, and finding their imprints takes a sweep.

use std::cell::RefCell;
use std::sync::Arc;

use crate::pose::PoseIndex;

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
