//! Explore: every imprint of a shape. Here are the form of ranges, the sweep in progress, the tabs of its results,
//! and their export.
//!
//! ```text
//! message    requests by keys and commands, and findings of a sweep
//! ranges     the form                                     running: work in progress
//! results    the findings, and what is shown of them
//! prompts    handles messages in filter and mark
//! imprints  statistics  histogram  map  scatter  angles   the tabs
//! work       from the form to the results                 update: what keys do over the results
//! view       tabs, summary, and the tab
//! ```

pub mod message;

pub mod ranges;

pub mod results;

pub mod imprints;

pub mod statistics;

pub mod histogram;

pub mod map;

pub mod scatter;

pub mod angles;

pub mod view;

pub mod work;

pub mod prompts;

pub mod update;
