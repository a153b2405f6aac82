//! Reads arrays of numpy: [`array`] reads a single one (`.npy`), [`archive`] several with their times (`.npz`).

pub(super) mod array;

pub(super) mod archive;
