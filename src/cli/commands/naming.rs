//! Names the shape that left the imprint of a frame, for `taxel frames` and `taxel watch` with `--model`.

use crate::cli::arguments::frames::NamingArguments;
use crate::cli::commands::model::{self, FoundModel};
use crate::cli::error::CliError;
use crate::cli::input::shapes::Shelf;
use crate::cli::output::answer::{AnswerJson, AnswerText};
use crate::cli::output::charset::Charset;
use crate::formats::json;
use crate::imprint::Imprint;
use crate::recognition::{Evidence, Model, Noise};

impl NamingArguments {
    pub(crate) fn find(&self, shelf: &Shelf) -> Result<Option<FoundModel>, CliError> {
        let model = self.model.as_ref();
        model.map(|model| model::find(model, shelf)).transpose()
    }
}

#[derive(Debug)]
pub(crate) struct FrameNamer<'a> {
    model: &'a Model,
    noise: Option<Noise>,
}

impl<'a> FrameNamer<'a> {
    pub(crate) fn new(model: &'a Model, noise: Option<&Noise>) -> Self {
        Self {
            model,
            noise: noise.copied(),
        }
    }

    fn evidence<'b>(&'b self, touches: &'b [Imprint]) -> Evidence<'b> {
        Evidence::of(touches).under(self.noise.as_ref())
    }

    /// Adds the key `recognition` to the end of a frame's line of JSON: the answer of `taxel recognise` to the
    /// imprint, or null if no taxel is active.
    pub(crate) fn extend(&self, line: &mut Vec<u8>, imprint: Option<&Imprint>) {
        let Some(end) = line.iter().rposition(|&byte| byte == b'}') else {
            return;
        };
        line.truncate(end);
        line.extend(b",\"recognition\":");
        match imprint.filter(|imprint| !imprint.is_empty()) {
            None => line.extend(b"null"),
            Some(imprint) => {
                let touches = [*imprint];
                let evidence = self.evidence(&touches);
                let answer = AnswerJson {
                    model: self.model,
                    answer: &self.model.recognise(evidence),
                    noise: self.noise,
                    nearest: self.model.nearest_of(evidence),
                    top: None,
                    asks_pose: false,
                    pose: None,
                    copied: Vec::new(),
                };
                json::extend_ascii(line, &answer);
            }
        }
        line.extend(b"}\n");
    }

    pub(crate) fn text(&self, imprint: &Imprint, charset: Charset) -> String {
        if imprint.is_empty() {
            return String::new();
        }
        let touches = [*imprint];
        let answer = self.model.recognise(self.evidence(&touches));
        let text = AnswerText {
            model: self.model,
            touch: imprint,
            answer: &answer,
            top: None,
            noise: self.noise,
        };
        text.text(charset)
    }
}
