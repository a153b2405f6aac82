//! The quiz: a random shape of the set touches the matrix, and the user names it.

use std::sync::Arc;

use rand_pcg::Pcg64;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::imprint::Imprint;
use crate::quote::quoted_character;
use crate::recognition::below;
use crate::sensor::Sensor;
use crate::touch::Plane;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot, Wheel};
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::widget::rows::{ListRows, moved};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// A shape whose name is asked for.
#[derive(Clone, Debug)]
pub struct Quiz {
    /// The model of the shape's set.
    trained: Arc<TrainedModel>,
    /// The index of the shape, which is not shown.
    shape: usize,
    /// The imprints of its touches on the matrix, the present one last.
    touches: Vec<Imprint>,
    /// The selected row of the list.
    selected: usize,
}

impl Quiz {
    /// Chooses a random shape of a set, with a probability in proportion to its weight; it has not touched yet.
    pub fn new(trained: Arc<TrainedModel>, random: &mut Pcg64) -> Self {
        let shapes = trained.model.shapes();
        let weights = shapes.iter().map(|shape| u64::from(shape.weight));
        let mut rest = below(random, weights.clone().sum());
        let shape = weights.take_while(|&weight| {
            let later = rest >= weight;
            rest = rest.saturating_sub(weight);
            later
        });
        let shape = shape.count();
        Self {
            trained,
            shape,
            touches: Vec::new(),
            selected: 0,
        }
    }

    /// Touches with the shape in a random pose of the model's grid. Returns the sensor and the imprint: on the user's
    /// sensor if it fits there, off the rim if there is room; otherwise on the model's sensor.
    pub fn touch(&mut self, sensor: Sensor, random: &mut Pcg64) -> Option<(Sensor, Imprint)> {
        let grid = self.trained.grid(self.shape)?;
        let pose = below(random, grid.poses());
        let own = *grid.sensor();
        let imprint = Plane::new(own).touch(&grid.placed(pose));
        let (sensor, imprint) = onto(&imprint, sensor, own);
        self.touches.push(imprint);
        Some((sensor, imprint))
    }

    /// Returns the index of the shape.
    pub fn shape(&self) -> usize {
        self.shape
    }

    /// Returns the name of a shape of the set.
    pub fn name(&self, shape: usize) -> &str {
        self.trained.name(shape)
    }

    /// Returns how often the shape has touched the matrix.
    pub fn touched(&self) -> usize {
        self.touches.len()
    }

    /// Returns the imprints of the touches.
    pub fn into_touches(self) -> Vec<Imprint> {
        self.touches
    }

    /// Returns the selected row, which is the index of a shape.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Returns the number of shapes of the set.
    fn count(&self) -> usize {
        self.trained.model.shapes().len()
    }

    /// Handles a message that selects a row; returns true if it names a shape at once, by its number.
    ///
    /// # Errors
    /// Returns a sentence about a character that fits no shape.
    pub fn take(&mut self, message: &Message) -> Result<bool, String> {
        if let Message::Type(character) = *message {
            return self.type_character(character);
        }
        if let Some(row) = moved(self.selected, message) {
            self.selected = row.min(self.count() - 1);
        }
        Ok(false)
    }

    /// Handles a character: a digit names one of the first nine shapes; a letter selects the next shape whose name
    /// begins with it.
    fn type_character(&mut self, character: char) -> Result<bool, String> {
        if let Some(number) = character.to_digit(10) {
            let row = (number as usize).checked_sub(1);
            let row = row.filter(|&row| row < self.count());
            let last = self.count().min(9);
            self.selected =
                row.ok_or_else(|| format!("no shape {number}, expected 1 to {last}"))?;
            return Ok(true);
        }
        let begins = |row: &usize| {
            let first = self.name(*row).chars().next();
            first.is_some_and(|first| first.to_lowercase().eq(character.to_lowercase()))
        };
        let rows = (self.selected + 1..self.count()).chain(0..=self.selected);
        let row = rows.clone().find(begins);
        let none = || format!("no shape begins with {}", quoted_character(character));
        self.selected = row.ok_or_else(none)?;
        Ok(false)
    }
}

/// Returns an imprint on the user's sensor if it fits there, otherwise on the model's sensor; and that sensor.
pub(super) fn onto(imprint: &Imprint, sensor: Sensor, own: Sensor) -> (Sensor, Imprint) {
    let moved = |sensor: Sensor| Some((sensor, moved_onto(imprint, &sensor)?));
    let moved = moved(sensor).or_else(|| moved(own));
    moved.unwrap_or((sensor, Imprint::empty(sensor.size())))
}

/// Moves an imprint onto a sensor: as near to its own place as possible, off the rim if there is room. None if it
/// does not fit.
fn moved_onto(imprint: &Imprint, sensor: &Sensor) -> Option<Imprint> {
    let mut moved = Imprint::empty(sensor.size());
    let Some(bounds) = imprint.bounds() else {
        return Some(moved);
    };
    let place = |start: u8, end: u8, side: u8| {
        let room = side.checked_sub(end - start)?;
        let margin = u8::from(room >= 2);
        Some(start.clamp(margin, room - margin))
    };
    let left = place(bounds.left, bounds.right, sensor.columns())?;
    let top = place(bounds.top, bounds.bottom, sensor.rows())?;
    for (column, row) in imprint.active() {
        moved.set(column - bounds.left + left, row - bounds.top + top, true);
    }
    Some(moved)
}

/// The number of lines above the list; the last of them shows how many rows are out of sight.
const HEAD: u16 = 3;

/// Returns the visible rows of the list.
fn rows(quiz: &Quiz, area: Rect) -> ListRows {
    ListRows::around(write::below(area, HEAD), quiz.count(), quiz.selected)
}

impl Page for Quiz {
    fn context(&self) -> Context {
        Context::Quiz
    }

    fn slot(&self) -> Slot {
        Slot::Panel
    }

    fn draw(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let title = match self.touches.len() {
            0 | 1 => "Which shape is this?".to_owned(),
            count => format!("Which shape is this? Touch {count}"),
        };
        write::text(buffer, area, theme, &title, Role::Title);
        let key = |action| keymap.label(Context::Quiz, action);
        let how = format!(
            "{} names it, {} touches it again",
            key(&action::ACCEPT),
            key(&action::QUIZ)
        );
        write::text(buffer, write::row(area, 1), theme, &how, Role::Quiet);
        let rows = rows(self, area);
        if let Some(hidden) = rows.hidden() {
            let row = write::row(area, usize::from(HEAD) - 1);
            write::text(buffer, row, theme, &hidden, Role::Quiet);
        }
        for (_, row, shape) in rows.visible(0..self.count()) {
            let (sign, role) = if shape == self.selected {
                ("> ", Role::Focus)
            } else {
                ("  ", Role::Text)
            };
            let number = match shape {
                0..9 => format!("{} ", shape + 1),
                _ => "  ".to_owned(),
            };
            let pieces = [
                (sign, Role::Key),
                (number.as_str(), Role::Key),
                (self.name(shape), role),
            ];
            write::line(buffer, row, theme, pieces);
        }
        rows.position(self.selected)
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        rows(self, area).click(at, self.selected)
    }

    fn wheel(&self) -> Wheel {
        Wheel::Rows
    }

    fn cancels_itself(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_touch_is_moved_onto_the_sensor_if_it_fits() {
        let read = |text: &str| text.parse::<Imprint>().expect("an imprint");
        let own = read("......\n......\n......\n....##\n....#.\n......");
        let sensor = |columns, rows| Sensor::new(columns, rows).expect("a sensor");
        let onto = |columns, rows| moved_onto(&own, &sensor(columns, rows));
        assert_eq!(onto(4, 4), Some(read("....\n.##.\n.#..\n....")));
        assert_eq!(onto(3, 2), Some(read(".##\n.#.")));
        assert_eq!(onto(1, 9), None);
        assert_eq!(onto(8, 8).and_then(|moved| moved.bounds()), own.bounds());
    }
}
