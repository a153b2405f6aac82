//! What the panes are made of: text fields, styles by role, text cut to columns.

pub mod text_field;

pub mod number;

pub mod columns;

pub mod theme;

pub mod write;

pub mod thumbnail;
