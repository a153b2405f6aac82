//! What the state wishes of the world outside.

use std::sync::Arc;

use crate::formats::StoredShape;
use crate::pose::PoseGrid;
use crate::storage::{Existing, Expected};
use crate::tui::explore::message::Findings;
use crate::tui::shapes::purpose::Purpose;

/// What the world outside shall do.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Ask the library; what it answers is the next message.
    Library(LibraryRequest),
    /// Have a worker do something.
    Work(Work),
    /// Have the terminal do something.
    Terminal(TerminalEffect),
}

/// What the terminal shall do.
#[derive(Clone, Debug, PartialEq)]
pub enum TerminalEffect {
    /// Forget what is on the screen and draw all of it.
    Redraw,
    /// Give the terminal back to the shell until it calls again.
    Suspend,
    /// Have the mouse reported, or leave it to the terminal, which then can select text.
    Mouse(bool),
    /// Put a text into the clipboard of the user's terminal.
    Copy(String),
}

/// What a worker does. Each piece of work has a number.
#[derive(Clone, Debug, PartialEq)]
pub enum Work {
    /// To find out how long a grid will take, about.
    Measure(Box<PoseGrid>),
    /// To go through a grid.
    Sweep(u64, Box<PoseGrid>),
    /// To write what was found into a file of that name.
    Write(u64, Arc<Findings>, String, Existing),
    /// To stop.
    Stop,
}

/// What is asked of the library.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryRequest {
    /// Its list.
    List,
    /// The names of its shapes that were deleted.
    Trash,
    /// Some of its shapes, by their place in the list and their name.
    Read(Vec<(usize, String)>),
    /// A shape by its name, and what for.
    Named(Purpose, String),
    /// To store a shape in place of what is expected there.
    Store(Box<StoredShape>, Expected),
    /// To remove a shape.
    Remove(String),
    /// To bring back the shape of that name that was removed last.
    Restore(String),
    /// To bring back work that a program left when it died.
    Recover,
    /// To throw such work away.
    GiveUp,
}
