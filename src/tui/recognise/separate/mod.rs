//! The page that shows which sensor tells the shapes of a set apart: the limit of one touch against their size, as a
//! curve and a table.
//!
//! ```text
//! request   the set, the sizes and the steps to touch in, and what may follow `:separate`
//! state     what was found so far, the size under the cursor, the wanted error
//! view      the curve, the table, and the pair that is confused most
//! update    what messages do
//! ```

pub mod request;

pub mod state;

pub mod view;

pub mod update;
