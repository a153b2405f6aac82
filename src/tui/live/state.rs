//! The state of the live page: how the shown frame is processed, and its description.

use std::sync::Arc;

use taxel_core::frame::{Frame, FrameError, Label, Rule, RuleOrigin, SetRule};
use taxel_files::acquire::FrameSource;
use taxel_files::formats::recording::{FrameMark, RecordingMetadata};

use crate::frames::{Pipeline, Taring};
use crate::tui::live::history::FrameHistory;
use crate::tui::live::names::ShapeNames;
use crate::tui::live::trend::Trend;
use crate::tui::live::{
    FeedStatus, FrameBatch, HeatLayer, LiveReading, ShadeRange, SourceGaps, SourceState,
    WatchRequest, other_unit, progress_text, stepped_rule,
};

/// The most frames that a tare by key is made of.
const TARED: usize = 30;

/// The most frames that range and plot are computed from again after a change of the tare or the threshold, because a
/// key waits for it.
const RANGED: usize = 1000;

#[derive(Clone, Debug)]
pub struct Live {
    pub request: Arc<WatchRequest>,
    /// The number of the work that watches the source; late reports of earlier work are dropped by it.
    pub number: u64,
    /// How a frame is processed before it is shown.
    pub pipeline: Pipeline,
    pub history: FrameHistory,
    pub status: FeedStatus,
    seen_gaps: SourceGaps,
    seen_notes: u64,
    /// Whether the page was left, and its source with it.
    pub stopped: bool,
    pub layer: HeatLayer,
    pub numbers: bool,
    pub only_panel: bool,
    /// The taxel that stays in sight if not all taxels are visible; None keeps the contact in sight.
    pub looked_at: Option<(u8, u8)>,
    pub range: ShadeRange,
    /// The number of frames that were never drawn, because others came before the screen was drawn again.
    pub(crate) not_drawn: u64,
    pub recording: RecordingState,
    /// The frames marked by key, in order: the number in the history, and what identifies the frame in its source.
    pub(crate) marks: Vec<(u64, FrameMark)>,
    pub trend: Trend,
    /// What is plotted over the history: force, 0, or contact, 1.
    pub plotted: usize,
    pub names: ShapeNames,
    /// The shown frame, processed; None before the first frame, and for a frame that cannot be processed.
    pub reading: Option<LiveReading>,
    /// Why the shown frame cannot be processed, or why it has no imprint.
    error: Option<FrameError>,
    /// Why a requested tare is missing.
    tare_error: Option<FrameError>,
}

impl Live {
    pub fn new(request: Arc<WatchRequest>, number: u64) -> Self {
        Self {
            pipeline: request.pipeline.clone(),
            history: FrameHistory::new(request.history_bytes),
            status: FeedStatus::default(),
            seen_gaps: SourceGaps::default(),
            seen_notes: 0,
            stopped: false,
            layer: HeatLayer::Tared,
            numbers: false,
            only_panel: false,
            looked_at: None,
            range: ShadeRange::default(),
            not_drawn: 0,
            recording: RecordingState::default(),
            marks: Vec::new(),
            trend: Trend::default(),
            plotted: 0,
            names: ShapeNames::new(&request),
            reading: None,
            error: None,
            tare_error: None,
            request,
            number,
        }
    }

    /// Returns why a requested tare is missing; otherwise why the shown frame cannot be processed, or why it has no
    /// imprint.
    pub fn error(&self) -> Option<&FrameError> {
        self.tare_error.as_ref().or(self.error.as_ref())
    }

    /// Returns why there is no imprint.
    pub fn no_imprint(&self) -> String {
        match (&self.error, self.pipeline.progress()) {
            _ if self.reading.is_some() && self.pipeline.processing.rule.is_none() => {
                "no threshold, so no imprint".to_owned()
            }
            (Some(error), _) => format!("no imprint: {error}"),
            (None, Some(progress)) if self.reading.is_some() => {
                format!("no imprint before the tare: {}", progress_text(progress))
            }
            (None, _) => NO_FRAME.to_owned(),
        }
    }

    pub fn rule(&self) -> Option<SetRule> {
        self.pipeline.rule()
    }

    /// Notes that the user has seen the gaps and the note so far.
    pub fn see_notices(&mut self) {
        self.seen_gaps = self.status.gaps;
        self.seen_notes = self.status.notes;
    }

    pub fn unseen_note(&self) -> Option<&str> {
        let is_new = self.status.notes > self.seen_notes;
        self.status.note.as_deref().filter(|_| is_new)
    }

    /// Returns why a requested recording is missing or leaves out frames, why no frames come, and which gaps the user
    /// has not seen yet; None if all is well.
    pub fn trouble(&self) -> Option<String> {
        let mut troubles: Vec<String> = self.recording.refusal.iter().cloned().collect();
        if self.recording.name.is_some() && self.status.recorded.is_some_and(|own| own.left_out > 0)
        {
            troubles.push("frames of another size are not recorded".to_owned());
        }
        if let SourceState::Silent(why) | SourceState::Failed(why) = &self.status.state {
            troubles.push(why.clone());
        }
        troubles.extend(self.status.gaps.sentence_since(self.seen_gaps));
        (!troubles.is_empty()).then(|| troubles.join("; "))
    }

    /// Returns threshold, tare and the marks of recorded frames, if frames are recorded and any of these has changed.
    /// They count as written afterwards.
    pub(super) fn take_changed_view(&mut self) -> Option<RecordingMetadata> {
        self.recording.name.as_ref()?;
        let own = self.marks.iter();
        let own = own.filter(|(number, _)| *number >= self.recording.from);
        std::mem::take(&mut self.recording.is_view_changed).then(|| RecordingMetadata {
            rule: self.rule(),
            tare: self.pipeline.processing.tare.clone(),
            marks: own.map(|(_, mark)| *mark).collect(),
            ..RecordingMetadata::default()
        })
    }

    pub fn is_marked(&self) -> bool {
        self.history.shown().is_some_and(|(number, frame)| {
            let label = frame.label.as_ref().and_then(Label::number);
            let mut recorded = self.status.channel.marks.iter();
            self.marks.iter().any(|(own, _)| *own == number)
                || recorded.any(|mark| label.is_some() && i64::try_from(mark.number).ok() == label)
        })
    }

    /// Marks the shown frame, or takes its mark off. Returns the number of the frame, and whether it is marked now;
    /// None before the first frame.
    pub fn mark(&mut self) -> Option<(u64, bool)> {
        let (number, frame) = self.history.shown()?;
        self.recording.is_view_changed = true;
        let index = self.marks.binary_search_by_key(&number, |own| own.0);
        match index {
            Ok(index) => drop(self.marks.remove(index)),
            Err(index) => {
                let (own, time) = (frame.number, frame.time);
                self.marks
                    .insert(index, (number, FrameMark { number: own, time }));
            }
        }
        Some((frame.number, index.is_err()))
    }

    pub fn name(&mut self) {
        let reading = self.reading.as_ref();
        let dead = self.request.pipeline.processing.view.mask;
        let imprint = reading.and_then(|reading| reading.imprint.as_ref());
        self.names.name(imprint, dead.as_ref());
    }

    /// Returns the unit of the values, with a space before it; empty if it is not known.
    pub fn unit(&self) -> String {
        crate::frames::unit(&self.status.channel)
    }

    /// Returns the values at both ends of the shades.
    pub fn ends(&self) -> (f64, f64) {
        let is_tared = self.pipeline.origin.is_some();
        self.range.ends(self.layer, self.reading.as_ref(), is_tared)
    }

    /// Returns the frames per second, computed from the times of the last frames or, if they have no times, as stated
    /// in the recording. None while the source is silent.
    pub fn rate(&self) -> Option<f64> {
        if matches!(self.status.state, SourceState::Silent(_)) {
            return None;
        }
        let step = self.status.channel.seconds_per_frame;
        let stated = step.filter(|step| *step > 0.0).map(f64::recip);
        self.history.rate().or(stated)
    }

    pub fn take(&mut self, batch: &FrameBatch) {
        let before = std::mem::replace(&mut self.status, batch.status.clone()).channel;
        if let Some(error) = self.status.record_error.clone() {
            self.fail_recording(error);
        }
        let channel = Arc::clone(&self.status.channel);
        if !Arc::ptr_eq(&before, &channel) {
            self.repipe(|pipeline| pipeline.begin(&channel));
        }
        for frame in &batch.frames {
            self.measure(frame);
            self.history.push(frame);
            let numbers = self.history.numbers();
            self.trend.keep(numbers.end - numbers.start);
            self.tare_error = match self.repipe(|pipeline| pipeline.add_to_tare(frame)) {
                Ok(Taring::LeftOut(error)) | Err(error) => Some(error),
                Ok(Taring::Done) => self.tare_error.take(),
                Ok(_) => None,
            };
        }
        if self.history.follows() {
            self.not_drawn += batch.frames.len().saturating_sub(1) as u64;
        }
        if self.status.state.is_final() {
            self.tare_error = self.pipeline.end().or(self.tare_error.take());
        }
        self.read();
    }

    /// Adds the values of a frame to the range, and its force and contact to the plot.
    fn measure(&mut self, frame: &Frame) {
        if let Ok(processed) = self.pipeline.processing.run(frame) {
            self.range.add([processed.raw, processed.tared]);
            self.trend.push(Some(&processed));
            return;
        }
        // Without the tare that a threshold by noise needs there are values, but no force.
        if let Ok(values) = self.pipeline.processing.values(frame) {
            self.range.add(values);
        }
        self.trend.push(None);
    }

    /// Measures the last frames again, because the tare or the threshold has changed.
    fn measure_again(&mut self) {
        self.recording.is_view_changed = true;
        self.trend.0.clear();
        let frames: Vec<_> = self.history.newest_first().take(RANGED).cloned().collect();
        for frame in frames.iter().rev() {
            self.measure(frame);
        }
    }

    /// Changes the tare or the threshold. Afterwards range and plot are computed again from the last frames.
    fn repipe<T>(&mut self, act: impl FnOnce(&mut Pipeline) -> T) -> T {
        let before = (self.pipeline.origin, self.pipeline.rule());
        let done = act(&mut self.pipeline);
        let after = (self.pipeline.origin, self.pipeline.rule());
        if after.0 != before.0 {
            self.range.begin_anew();
        }
        if after != before {
            self.measure_again();
        }
        done
    }

    /// Makes the tare of the frames up to the shown one. Returns their number, or why it cannot be made.
    pub fn tare_now(&mut self) -> Result<u64, String> {
        let frames = self.history.up_to_shown(TARED);
        if frames.is_empty() {
            let gone = "this frame is no longer in the history";
            return Err(self.history.shown().map_or(NO_FRAME, |_| gone).to_owned());
        }
        let tared = self.repipe(|pipeline| pipeline.tare_of(frames.iter().map(Arc::as_ref)));
        tared.map_err(|error| error.to_string())?;
        self.tare_error = None;
        self.read();
        Ok(frames.len() as u64)
    }

    pub fn drop_tare(&mut self) -> bool {
        let any = self.repipe(Pipeline::drop_tare);
        self.tare_error = None;
        self.read();
        any
    }

    pub fn choose(&mut self, rule: Rule) {
        let (least, from) = (self.pipeline.processing.least, RuleOrigin::Key);
        let set = Some(SetRule { rule, least, from });
        self.repipe(|pipeline| pipeline.processing.apply_rule(set));
        self.read();
    }

    /// Moves the threshold up or down by a step that depends on the largest value so far. Without a threshold, one is
    /// set. A threshold out of range changes nothing.
    pub fn step_threshold(&mut self, direction: i8) {
        let (rule, top) = (self.pipeline.processing.rule, self.range.tared_top());
        if let Ok(rule) = stepped_rule(rule, direction, top) {
            self.choose(rule);
        }
    }

    pub fn switch_unit(&mut self) {
        // Rules apply to the tared values, whichever layer is shown.
        let largest = self.reading.as_ref().and_then(|reading| reading.tared_max);
        let largest = largest.filter(|&largest| largest > 0.0);
        let largest = largest.unwrap_or(self.range.tared_top());
        if let Ok(other) = other_unit(self.pipeline.processing.rule, largest) {
            self.choose(other);
        }
    }

    pub fn freeze(&mut self) {
        if self.history.follows() {
            self.history.freeze();
        } else {
            self.history.follow();
        }
        self.read();
    }

    /// Stays at the frame of this number or, if that is not here, at the nearest one. Returns false if that is the
    /// shown one.
    pub fn stay_at(&mut self, number: u64) -> bool {
        let before = self.history.shown().map(|(number, _)| number);
        self.history.stay_at(number);
        self.read();
        self.history.shown().map(|(number, _)| number) != before
    }

    /// Goes on or back by this number of frames; false if there is none.
    pub fn scrub(&mut self, by: i64) -> bool {
        let shown = self.history.shown();
        shown.is_some_and(|(number, _)| self.stay_at(number.saturating_add_signed(by)))
    }

    /// Goes on or back by at least a second, or by ten frames if they have no times.
    pub fn scrub_second(&mut self, by: i64) -> bool {
        let Some((shown, frame)) = self.history.shown() else {
            return false;
        };
        let Some(now) = frame.time else {
            return self.scrub(10 * by);
        };
        let is_there = |number: &u64| {
            let other = self.history.get(*number).and_then(|other| other.time);
            other.is_some_and(|other| (other - now).abs() >= 1.0)
        };
        let numbers = self.history.numbers();
        let found = if by < 0 {
            let mut before = (numbers.start..shown.min(numbers.end)).rev();
            before.find(is_there).unwrap_or(numbers.start)
        } else {
            let mut after = shown + 1..numbers.end;
            after.find(is_there).unwrap_or(numbers.end)
        };
        self.stay_at(found)
    }

    /// Goes on or back to the next frame in which a touch begins; false if there is none.
    pub fn scrub_touch(&mut self, by: i64) -> bool {
        let shown = self.history.shown().map_or(0, |(number, _)| number);
        let begins = self.trend.touches(self.history.numbers().end);
        let mut begins = begins.iter();
        let next = match by {
            ..0 => begins.rfind(|number| **number < shown),
            _ => begins.find(|number| **number > shown),
        };
        next.is_some_and(|number| self.stay_at(*number))
    }

    pub fn begin_recording(&mut self, name: Option<String>) {
        (self.recording.name, self.recording.refusal) = (name, None);
        // These belong to the recording before.
        self.status.recorded = None;
        self.status.record_error = None;
    }

    /// Notes why a recording has failed, or why it cannot be begun.
    pub fn fail_recording(&mut self, reason: String) {
        let asked = self.request.write.as_ref();
        let asked = asked.map(|(path, _)| path.to_string_lossy());
        if asked.is_some() && self.recording.name.as_deref() == asked.as_deref() {
            self.recording.write_failure = Some(reason.clone());
        }
        self.recording.name = None;
        self.recording.refusal = Some(reason);
    }

    /// Notes that the page is left. A finished recording counts as ended: it is played again only when asked for.
    pub fn stop(&mut self) {
        self.stopped = true;
        self.recording.name = None;
        if self.is_finished_recording() {
            self.status.state = SourceState::Ended;
        }
    }

    /// Returns true if the source is a recording that does not grow any more.
    fn is_finished_recording(&self) -> bool {
        self.status.channels > 0 && !self.status.follows
    }

    /// Checks that the source can be watched again: a recording at any time unless it is still being written, any
    /// other source after its end.
    pub fn check_again(&self) -> Result<(), &'static str> {
        if self.request.source == FrameSource::Standard {
            return Err(READ_ONCE);
        }
        let is_possible = self.is_finished_recording() || self.status.state.is_final();
        is_possible
            .then_some(())
            .ok_or("the source has not ended yet")
    }

    /// Takes frames again, as the work of this number; threshold, tare and marks stay. The history begins anew with a
    /// recording, because the same frames come again.
    pub fn restart(&mut self, number: u64) {
        if self.status.channels > 0 {
            self.history = FrameHistory::new(self.request.history_bytes);
            self.marks.clear();
            self.not_drawn = 0;
            self.trend.0.clear();
        }
        self.number = number;
        self.stopped = false;
        self.recording.name = None;
        self.recording.refusal = None;
        self.history.follow();
        self.pipeline.restart();
        self.tare_error = None;
        self.status.state = SourceState::Live;
        (self.status.gaps, self.seen_gaps) = (SourceGaps::default(), SourceGaps::default());
        (self.status.note, self.seen_notes) = (None, 0);
        self.read();
    }

    /// Processes the frame that is shown now.
    pub(super) fn read(&mut self) {
        (self.reading, self.error) = match self.history.shown() {
            Some((_, frame)) => self.read_frame(frame),
            None => (None, None),
        };
        self.name();
    }

    /// Processes a frame. Returns the result, and the error if there is one.
    ///
    /// A threshold by noise needs a tare. Without one, the result lacks the imprint, and the error is omitted while
    /// the tare is being made.
    fn read_frame(&mut self, frame: Arc<Frame>) -> (Option<LiveReading>, Option<FrameError>) {
        match LiveReading::of(
            Arc::clone(&frame),
            &mut self.pipeline.processing,
            self.layer,
        ) {
            Ok(reading) => (Some(reading), None),
            Err(FrameError::NoTare) => {
                let rule = self.pipeline.processing.rule.take();
                let reading = LiveReading::of(frame, &mut self.pipeline.processing, self.layer);
                self.pipeline.processing.rule = rule;
                let is_made = self.pipeline.progress().is_some();
                let error = (!is_made).then_some(FrameError::NoTare);
                (reading.ok(), error)
            }
            Err(error) => (None, Some(error)),
        }
    }
}

pub const NO_FRAME: &str = "no frame yet";

pub const READ_ONCE: &str = "standard input cannot be read twice";

#[derive(Clone, Debug, Default)]
pub struct RecordingState {
    /// The file that is written; None if nothing is recorded.
    pub name: Option<String>,
    /// The number in the history that the next frame had when the recording was requested: frames before it are not
    /// recorded.
    pub from: u64,
    /// Why nothing is recorded although it was requested.
    pub refusal: Option<String>,
    /// Why the recording that was requested together with the source has failed. Later recordings do not change that.
    pub write_failure: Option<String>,
    /// Whether threshold, tare or marks have changed since they were last written into a recording.
    is_view_changed: bool,
}
