//! Recognise: names the shape on the matrix from one or several touches, and shows how far the name can be trusted.
//!
//! ```text
//! trained        a model, how well it tells its shapes apart, examples, a random touch
//! state          the set, its model, the touches, the answer
//! view           the panel beside the matrix: shapes with bars, the nearest imprint, the pose
//! update         what messages do; the answer follows the matrix
//! confusion      which shapes are taken for which, with an imprint that two share
//! ```

pub mod trained;

pub mod state;

pub mod view;

pub mod confusion;

pub mod update;
