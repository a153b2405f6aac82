//! The list of stored shapes, for Load, Delete and Picture.
//!
//! ```text
//! state    entries, filter, selected row, shapes read      layout   list and preview
//! view     impl Page for ListDialog                        update   keys, and the answers of the library
//! ```

pub mod state;

pub mod view;

pub mod update;
