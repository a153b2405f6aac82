//! What several commands have in common: flags of figures, sensors and grids, and the parsers of values.

pub(crate) mod flags;

pub(crate) mod parameters;
