//! Every imprint of a shape: a form of ranges, the sweep in progress, the pages of its results, and their export.

pub mod message;

pub mod lines;

pub mod ranges;

pub mod running;

pub mod results;

pub mod export;

pub mod imprints;

pub mod statistics;

pub mod histogram;

pub mod map;

pub mod panes;

pub mod point;

pub mod start;

pub mod update;

pub mod worker_event;

pub mod view;
