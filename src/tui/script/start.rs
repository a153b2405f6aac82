//! The start of a script: the settings before its first other command, and the shapes that it finds.

use std::path::PathBuf;

use crate::formats::StoredShape;
use crate::storage::{Library, location};
use crate::tui::app::state::Options;
use crate::tui::keys::keymap::Keymap;
use crate::tui::runtime::World;
use crate::tui::script::command::{ScriptCommand, ScriptError};
use crate::tui::script::setting::ScriptSetting;

#[derive(Clone, Debug)]
pub struct ScriptOptions {
    pub options: Options,
    /// Columns and rows of the screen, unless the script sets them.
    pub size: (u16, u16),
    pub styles: bool,
    pub json: bool,
    pub keymap: Keymap,
    /// The only folder below which the script may write; None if it may write anywhere and use any library.
    pub folder: Option<PathBuf>,
}

#[derive(Debug)]
pub(super) struct ScriptStart<'a> {
    /// The options, changed by the script's settings.
    pub(super) settings: ScriptOptions,
    pub(super) lines: usize,
    library: Option<(usize, Library)>,
    /// The shapes of the user's library; only the last of those with the same name.
    shapes: Vec<&'a StoredShape>,
    leftovers: Vec<&'a StoredShape>,
}

impl<'a> ScriptStart<'a> {
    /// Reads the start from the commands of a script, each with its line. `settings` apply where the script sets
    /// nothing.
    ///
    /// `Set shape` may also come later in a script, because a recorder learns only then which shapes are used. These
    /// shapes, too, exist from the start.
    pub(super) fn of(
        commands: &'a [(usize, ScriptCommand)],
        settings: &ScriptOptions,
    ) -> Result<Self, ScriptError> {
        let is_setting = |command: &ScriptCommand| matches!(command, ScriptCommand::Set(_));
        let lines = commands
            .iter()
            .take_while(|(_, command)| is_setting(command));
        let mut start = Self {
            settings: settings.clone(),
            lines: lines.count(),
            library: None,
            shapes: Vec::new(),
            leftovers: Vec::new(),
        };
        for (index, (line, command)) in commands.iter().enumerate() {
            match command {
                ScriptCommand::Set(ScriptSetting::Shape(shape)) => start.put(shape),
                ScriptCommand::Set(setting) if index < start.lines => {
                    let set = start.set(*line, setting);
                    set.map_err(|message| ScriptError {
                        line: *line,
                        message,
                    })?;
                }
                _ => {}
            }
        }
        match start.library {
            Some((line, _)) if !start.shapes.is_empty() || !start.leftovers.is_empty() => {
                let message = "Set library cannot be used with Set shape or Set leftover";
                Err(ScriptError {
                    line,
                    message: message.to_owned(),
                })
            }
            _ => Ok(start),
        }
    }

    fn put(&mut self, shape: &'a StoredShape) {
        let same = |own: &&StoredShape| own.name.same(shape.name.as_str());
        match self.shapes.iter().position(same) {
            Some(index) => self.shapes[index] = shape,
            None => self.shapes.push(shape),
        }
    }

    fn set(&mut self, line: usize, setting: &'a ScriptSetting) -> Result<(), String> {
        let options = &mut self.settings.options;
        match setting {
            ScriptSetting::Size(columns, rows) => self.settings.size = (*columns, *rows),
            ScriptSetting::Seed(seed) => options.seed = *seed,
            ScriptSetting::Ascii(ascii) => options.theme.ascii = *ascii,
            ScriptSetting::Color(depth) => options.theme.depth = *depth,
            ScriptSetting::Theme(palette) => options.theme.palette = *palette,
            ScriptSetting::Sensor(parameter, value) => {
                let sensor = options.sensor.with(*parameter, *value);
                options.sensor = sensor.map_err(|error| error.to_string())?;
            }
            ScriptSetting::Library(_) if self.settings.folder.is_some() => {
                return Err("Set library needs --allow-outside; without that line, the script has its own library"
                    .to_owned());
            }
            ScriptSetting::Library(folder) => {
                let folder = location::below_home(&folder.to_string_lossy())
                    .ok_or("no home folder, so ~ cannot be used")?;
                self.library = Some((line, Library::open(folder)));
            }
            ScriptSetting::Shape(_) => {}
            ScriptSetting::Leftover(shape) => self.leftovers.push(shape),
        }
        Ok(())
    }

    /// Returns the world for the script: `own`, unless the script sets a library or its shapes.
    pub(super) fn world(&self, own: World) -> Result<World, String> {
        let world = match &self.library {
            Some((_, library)) => World::for_script(library.clone()),
            None if self.shapes.is_empty() && self.leftovers.is_empty() => own,
            None => World::with_contents(&self.shapes, &self.leftovers)?,
        };
        Ok(match &self.settings.folder {
            Some(folder) => world.confined_to(folder.clone()),
            None => world,
        })
    }
}
