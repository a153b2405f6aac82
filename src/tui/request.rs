//! What the state wishes of the world outside.

use super::purpose::Purpose;
use crate::formats::shape::Shape;
use crate::library::store::Expected;

/// What the world outside shall do.
#[derive(Clone, Debug, PartialEq)]
pub enum Effect {
    /// Forget what is on the screen and draw all of it.
    Redraw,
    /// Give the terminal back to the shell until it calls again.
    Suspend,
    /// Have the mouse reported, or leave it to the terminal, which then can select text.
    Mouse(bool),
    /// Put a text into the clipboard of the user's terminal.
    Copy(String),
    /// Ask the library; what it answers is the next message.
    Library(Request),
}

/// What is asked of the library.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Its list.
    List,
    /// The names of its shapes that were deleted.
    Trash,
    /// Some of its shapes, by their place in the list and their name.
    Read(Vec<(usize, String)>),
    /// A shape by its name, and what for.
    Named(Purpose, String),
    /// To store a shape in place of what is expected there.
    Store(Box<Shape>, Expected),
    /// To remove a shape.
    Remove(String),
    /// To bring back the shape of that name that was removed last.
    Restore(String),
    /// To bring back work that a program left when it died.
    Recover,
    /// To throw such work away.
    GiveUp,
}
