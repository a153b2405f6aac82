//! What programs of vendors write in some versions or settings, made up here.

use taxel::frame::Frame;

use super::{Recorded, recorded};

fn error(found: &Recorded) -> Option<String> {
    found.error.as_ref().map(ToString::to_string)
}

#[test]
fn the_last_unit_of_tekscan_counts_and_metres_are_a_length() {
    let text = "DATA_TYPE MOVIE\nROWS 1\nCOLS 2\nROW_SPACING 1.27e-003 meters\nCOL_SPACING 1.27 mm\n\
                COMMENTS the pad\nUNITS kPa\nROWS 9\nUNITS raw\nASCII_DATA @@\nFrame 1\n1,2\n\n@@\n";
    let found = recorded(text.as_bytes(), None);
    assert_eq!((error(&found), found.frames.len()), (None, 1));
    let info = &found.channels[0];
    assert_eq!(info.unit.as_deref(), Some("raw"));
    assert_eq!(
        (info.pitch_mm, info.shape),
        (Some([1.27, 1.27]), Some((1, 2)))
    );
}
