//! Frames of real sensors: the values that cells measure, and how they become an imprint.
//!
//! A [`Frame`] holds up to 512 × 512 values as the sensor or a recording gives them. [`Processing`] then does the
//! following, in this order, without allocating anything per frame:
//!
//! 1. [`View`]: crop, flip, turn by quarters, and mask dead cells. At most 64 × 64 cells may be left.
//! 2. [`Tare`]: subtract the median of each cell over the first frames.
//! 3. Gain: multiply each cell by its own factor, if there are factors.
//! 4. [`Rule`]: decide which values make a taxel active, then drop pieces that are too small.
//!
//! [`Processed`] then has the imprint, and the force, the contact and the centre of pressure of the touch.
//!
//! Nothing is interpolated, smoothed or normalised. A cell without a value is NaN in memory and never active.
//!
//! ```
//! use taxel_core::frame::{Frame, FrameSize, Processing, Rule};
//! let size = FrameSize::new(3, 2)?;
//! let frame = Frame::from_values(size, &[0.0, 12.0, f64::NAN, 3.0, 10.0, 0.0])?;
//! let mut processing = Processing::default();
//! processing.rule = Some(Rule::at_least(10.0)?);
//! let processed = processing.run(&frame)?;
//! assert_eq!((processed.sum, processed.max), (25.0, Some(12.0)));
//! assert_eq!(processed.imprint.map(|imprint| imprint.to_string()).as_deref(), Some(".#.\n.#."));
//! assert_eq!((processed.force, processed.contact, processed.cop), (22.0, 2, Some([1.5, 21.0 / 22.0])));
//! # Ok::<(), taxel_core::frame::FrameError>(())
//! ```

mod recorded;

mod view;

mod tare;

mod rule;

mod processing;

mod flips;

pub use flips::{FlipCounter, FlipReport};
pub use processing::{Peak, Processed, Processing};
pub use recorded::{
    Frame, FrameError, FrameSize, LARGEST_VALUE, Label, MAX_FRAME_CELLS, MAX_FRAME_SIDE,
};
pub use rule::{Rule, RuleOrigin, SetRule};
pub use tare::{Tare, TareFrames};
pub use view::{Crop, View};
