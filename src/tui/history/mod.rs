//! The steps of the history as a list: what each step did, with the present state marked. Enter goes to the state
//! after a step. `/` searches: [`crate::tui::search`].
//!
//! ```text
//! History   4 steps
//!   0  the start
//!   1  ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0°
//! * 2  x0 4.00 → 4.31                                 the present state
//! > 3  taxel 8, 8 off                                 the selected row is reversed
//! ```

pub mod page;

pub mod update;
