//! What a descriptor says: its formula, unit, sense and zero, with a drawing. The texts are those of
//! `docs/glossary.md`.

use ratatui::layout::{Position, Rect};
use taxel_core::description::{DESCRIPTORS, Descriptor};
use taxel_files::formats::value;

use crate::tui::app::{App, Canvas, Endpoint, Flow, Message, Page, Place, Placed, Wheel};
use crate::tui::explore::results::Results;
use crate::tui::keys::{Arrow, Context};
use crate::tui::widget::Role;
use crate::tui::widget::write::{self, around, broken, narrow};

const GLOSSARY: &str = include_str!("../../docs/glossary.md");

pub(crate) struct Explain {
    descriptor: usize,
    top: usize,
    /// The value of each descriptor for the chosen region.
    values: Vec<String>,
}

impl Explain {
    pub(crate) fn new(app: &App) -> Self {
        let region = app.reading().description(app.chosen());
        let pitch_mm = app.shown().sensor.pitch_mm();
        let value = |descriptor: &Descriptor| {
            let measured = (descriptor.measure)(region.as_ref()?);
            let text = value::text(measured, descriptor.dimension)?;
            let scaled = value::in_millimetres(measured, descriptor.dimension, pitch_mm);
            let scaled = scaled.filter(|_| pitch_mm != 1.0);
            Some(scaled.map_or(format!("  {text}"), |scaled| {
                format!("  {text}  ({scaled})")
            }))
        };
        let chosen = app
            .page::<Results>()
            .map(|results| results.chosen.feature().descriptor.key);
        let is_chosen = |own: &Descriptor| Some(own.key) == chosen;
        Self {
            descriptor: DESCRIPTORS.iter().position(is_chosen).unwrap_or(0),
            top: 0,
            values: DESCRIPTORS
                .iter()
                .map(|own| value(own).unwrap_or_default())
                .collect(),
        }
    }

    fn lines(&self, width: u16) -> Vec<String> {
        let own = &DESCRIPTORS[self.descriptor];
        let anchor = format!("id=\"{}\"></a>", own.key);
        let symbol = format!("**{}**", own.symbol);
        let mut sections = GLOSSARY.split("\n<a ");
        let section = sections.find(|section| section.contains(&anchor));
        let text = section.unwrap_or_default();
        let (mut lines, mut paragraph, mut is_drawing) = (Vec::new(), String::new(), false);
        // After the anchors and the heading.
        for line in text.lines().skip(2).chain([""]) {
            if line.starts_with("```") {
                is_drawing = !is_drawing;
            } else if is_drawing {
                lines.push(line.to_owned());
            } else if line.is_empty() {
                // Other descriptors of the section have paragraphs of their own.
                if !paragraph.starts_with("**") || paragraph.contains(&symbol) {
                    let plain = paragraph.replace(['`', '*'], "");
                    let broken = broken(&plain, width.into()).into_iter();
                    lines.extend(broken.map(str::to_owned));
                }
                paragraph.clear();
                if lines.last().is_some_and(|last| !last.is_empty()) {
                    lines.push(String::new());
                }
            } else if !line.starts_with("<!--") {
                paragraph += line;
                paragraph.push(' ');
            }
        }
        lines.pop();
        lines
    }
}

impl Page for Explain {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let count = DESCRIPTORS.len();
        let now = self.descriptor;
        match message {
            Message::Choose(Arrow::Left) => self.descriptor = around(now, -1, count),
            Message::Choose(_) => self.descriptor = around(now, 1, count),
            Message::ScrollTo(Endpoint::First) => self.descriptor = 0,
            Message::ScrollTo(Endpoint::Last) => self.descriptor = count - 1,
            Message::Scroll(by) => {
                let (columns, rows) = app.body_size();
                let last = narrow(self.lines(columns).len()).saturating_sub(rows.saturating_sub(2));
                let top = narrow(self.top).saturating_add_signed(*by);
                self.top = top.min(last).into();
            }
            _ => {}
        }
        if self.descriptor != now {
            self.top = 0;
        }
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Explain, Place::Body, Wheel::Rows)
    }

    fn draw(&self, Canvas { theme, buffer, .. }: Canvas<'_>, area: Rect) -> Option<Position> {
        let own = &DESCRIPTORS[self.descriptor];
        let title = format!("{} ({}): {}", own.symbol, own.key, own.name);
        let pieces = [
            (title.as_str(), Role::Title),
            (&self.values[self.descriptor], Role::Text),
        ];
        write::line(buffer, area, theme, pieces);
        let below = write::below(area, 2);
        for (index, line) in self.lines(below.width).iter().skip(self.top).enumerate() {
            write::text(buffer, write::row(below, index), theme, line, Role::Text);
        }
        None
    }
}
