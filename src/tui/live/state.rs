//! The state of the live page: how the shown frame is processed, and its description.

use std::sync::Arc;

use taxel_core::frame::{Frame, FrameError, Rule, RuleOrigin, SetRule};
use taxel_core::imprint::Imprint;
use taxel_core::recognition::Noise;
use taxel_files::acquire::FrameSource;
use taxel_files::formats::recording::{ChannelInfo, FrameMark, RecordedView};
use taxel_files::storage::ModelChoice;

use crate::frames::{Pipeline, Taring};
use crate::tui::live::history::{FrameCursor, FrameMarks, ProvisionalOutcome};
use crate::tui::live::message::{
    FeedStatus, FrameBatch, NamedImprint, Naming, NamingRequest, SourceGaps, SourceState,
    WatchRequest,
};
use crate::tui::live::reading::{HeatLayer, LiveDisplay, LiveReading, ShadeRange};
use crate::tui::live::threshold;
use crate::tui::live::trend::{Plotted, Trend};
use crate::tui::live::update::LiveRefusal;
use crate::tui::widget::write::other;

const TARED: usize = 30;

/// The maximum number of frames that range and plot are computed from after a change of the tare or, for the plot, of the
/// threshold. It is limited because a key waits for
/// it.
const RANGED: usize = 1000;

#[derive(Clone, Debug)]
pub struct Live {
    request: Arc<WatchRequest>,
    number: u64,
    /// How a frame is processed before it is shown.
    pub(in crate::tui) pipeline: Pipeline,
    tare_error: Option<FrameError>,
    converted: Option<(Rule, Rule)>,
    /// Whether the threshold or the tare has changed since they were last written into a recording.
    is_viewed_anew: bool,
    pub(super) cursor: FrameCursor,
    status: FeedStatus,
    seen_gaps: SourceGaps,
    seen_notes: u64,
    stopped: bool,
    pub(super) layer: HeatLayer,
    pub display: LiveDisplay,
    range: ShadeRange,
    /// The number of frames that were never drawn, because others came before the screen was drawn again.
    not_drawn: u64,
    pub(in crate::tui) recording: RecordingState,
    pub(super) marks: FrameMarks,
    pub(super) trend: Trend,
    pub(super) plotted: Plotted,
    pub names: ShapeNames,
    /// The shown frame, processed; None before the first frame, and for a frame that cannot be processed.
    reading: Option<LiveReading>,
    /// Why the shown frame cannot be processed, or why it has no imprint.
    error: Option<FrameError>,
}

impl Live {
    pub fn new(request: Arc<WatchRequest>, number: u64) -> Self {
        Self {
            pipeline: request.pipeline.clone(),
            tare_error: None,
            converted: None,
            is_viewed_anew: false,
            cursor: FrameCursor::new(request.history_bytes),
            status: FeedStatus::default(),
            seen_gaps: SourceGaps::default(),
            seen_notes: 0,
            stopped: false,
            layer: HeatLayer::Tared,
            display: LiveDisplay::default(),
            range: ShadeRange::default(),
            not_drawn: 0,
            recording: RecordingState::default(),
            marks: FrameMarks::default(),
            trend: Trend::default(),
            plotted: Plotted::default(),
            names: ShapeNames::new(&request, number),
            reading: None,
            error: None,
            request,
            number,
        }
    }

    pub fn request(&self) -> &Arc<WatchRequest> {
        &self.request
    }

    pub fn number(&self) -> u64 {
        self.number
    }

    pub fn status(&self) -> &FeedStatus {
        &self.status
    }

    pub fn stopped(&self) -> bool {
        self.stopped
    }

    /// Returns the shown frame; None before the first one.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        let processed = self.reading.as_ref().map(|reading| &reading.frame);
        processed
            .cloned()
            .or_else(|| Some(self.cursor.shown()?.frame))
    }

    /// Returns the processed frame that is shown; None before the first one, and for a frame that cannot be
    /// processed.
    pub fn reading(&self) -> Option<&LiveReading> {
        self.reading.as_ref()
    }

    /// Returns why a requested tare is missing; otherwise why the shown frame cannot be processed, or why it has no
    /// imprint.
    pub fn error(&self) -> Option<&FrameError> {
        self.tare_error.as_ref().or(self.error.as_ref())
    }

    pub fn no_imprint(&self) -> LiveRefusal {
        match (&self.error, self.pipeline.progress()) {
            _ if self.reading.is_some() && self.pipeline.processing.rule.is_none() => {
                LiveRefusal::NoThreshold
            }
            (Some(error), _) => LiveRefusal::NoImprint(error.clone()),
            (None, Some((taken, wanted))) if self.reading.is_some() => {
                LiveRefusal::TareIsMade { taken, wanted }
            }
            (None, _) => LiveRefusal::NoFrame,
        }
    }

    pub fn rule(&self) -> Option<SetRule> {
        self.pipeline.rule()
    }

    pub fn not_drawn(&self) -> u64 {
        self.not_drawn + self.status.overflowed
    }

    pub fn recording(&self) -> &RecordingState {
        &self.recording
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
        let source = match &self.status.state {
            SourceState::Silent(why) | SourceState::Lost(why) | SourceState::Failed(why) => {
                Some(why.as_str())
            }
            SourceState::Waiting | SourceState::Live | SourceState::Ended => None,
        };
        let gaps = self.status.gaps.since(self.seen_gaps).sentence();
        let recorded = self.recording.name().and(self.status.recorded);
        let left_out = recorded.filter(|recorded| recorded.left_out > 0);
        let left_out = left_out.map(|_| "frames of another size are not recorded");
        let recording = self.recording.refusal().or(left_out);
        let troubles = recording.into_iter().chain(source);
        let troubles: Vec<&str> = troubles.chain(gaps.as_deref()).collect();
        (!troubles.is_empty()).then(|| troubles.join("; "))
    }

    /// Returns the frames that were marked since the source was last watched anew, in the order in which they came.
    pub fn marks(&self) -> Vec<FrameMark> {
        self.marks.own()
    }

    /// Returns threshold, tare and the marks of recorded frames, if frames are recorded and any of these has changed.
    /// They count as written afterwards.
    pub fn take_changed_view(&mut self) -> Option<RecordedView> {
        self.recording.name()?;
        let is_changed = std::mem::take(&mut self.is_viewed_anew) | self.marks.take_change();
        is_changed.then(|| RecordedView {
            rule: self.rule(),
            tare: self.pipeline.processing.tare.clone(),
            marks: self.marks.own_from(self.recording.from()),
        })
    }

    pub fn is_marked(&self) -> bool {
        let shown = self.cursor.shown();
        shown.is_some_and(|shown| self.marks.has(shown.number, &shown.frame))
    }

    pub fn mark(&mut self) -> Result<(u64, bool), LiveRefusal> {
        let shown = self.cursor.of_this_watch()?;
        let marked = self.marks.switch(shown.number, &shown.frame);
        Ok((shown.frame.number, marked))
    }

    /// Returns the imprint to name now, and notes that it was asked for. Returns None if an answer is still expected
    /// or already known, or if no taxel is active.
    pub fn ask_name(&mut self) -> Option<Imprint> {
        let imprint = self.reading.as_ref()?.imprint?;
        self.names.ask(&imprint).then_some(imprint)
    }

    /// Returns the unit of the values, with a space before it; empty if it is not known.
    pub fn unit(&self) -> String {
        let channel = self.status.channel.as_deref();
        let unit = channel.and_then(|channel| channel.unit.as_deref());
        unit.map_or(String::new(), |unit| format!(" {unit}"))
    }

    pub fn range(&self) -> (f64, f64) {
        self.range.ends(self.layer, self.reading.as_ref())
    }

    /// Returns the frames per second, computed from the times of the last frames or, if they have no times, as stated
    /// in the recording. None while the source is silent or lost.
    pub fn rate(&self) -> Option<f64> {
        if matches!(
            self.status.state,
            SourceState::Silent(_) | SourceState::Lost(_)
        ) {
            return None;
        }
        let stated = || {
            let step = self.status.channel.as_deref()?.seconds_per_frame?;
            (step > 0.0).then(|| 1.0 / step)
        };
        self.cursor.rate().or_else(stated)
    }

    pub(super) fn follow_recording(&mut self, status: &FeedStatus) -> Option<String> {
        let before = self.recording.name()?.to_owned();
        let name = status.recorded_in.clone().filter(|name| *name != before)?;
        let sentence = format!("recording in {name}, because {before} exists by now");
        self.recording.set(Some(name));
        Some(sentence)
    }

    pub fn take(&mut self, batch: &FrameBatch) {
        let had_channel = self.status.channel.is_some();
        self.status = batch.status.clone();
        if let Some(error) = self.status.record_error.clone() {
            self.fail_recording(error);
        }
        if !had_channel && let Some(channel) = self.status.channel.clone() {
            self.take_channel(&channel);
        }
        let next_number = self.cursor.next_number();
        for frame in &batch.frames {
            self.add(frame);
        }
        let tare_fails = self.status.state.is_final() && self.end_tare();
        if self.cursor.follows() {
            let unseen = batch.frames.len().saturating_sub(1);
            self.not_drawn += unseen as u64;
        }
        let outcome = self
            .cursor
            .take_provisional(&batch.provisional, next_number);
        if outcome == ProvisionalOutcome::Withdrawn {
            self.marks.take_off(next_number);
        }
        if !batch.frames.is_empty() || outcome != ProvisionalOutcome::Same || tare_fails {
            self.read();
        }
    }

    fn take_channel(&mut self, channel: &ChannelInfo) {
        self.marks.recorded.clone_from(&channel.marks);
        self.repipe(|pipeline| pipeline.begin(channel));
    }

    fn end_tare(&mut self) -> bool {
        let was = self.pipeline.progress().is_some();
        self.tare_error = self.pipeline.end().or(self.tare_error.take());
        was
    }

    fn add(&mut self, frame: &Arc<Frame>) {
        self.measure(frame);
        self.cursor.push(frame);
        self.trend.keep(self.cursor.frames());
        self.tare_error = match self.repipe(|pipeline| pipeline.add_to_tare(frame)) {
            Ok(Taring::LeftOut(error)) | Err(error) => Some(error),
            Ok(Taring::Done) => self.tare_error.take(),
            Ok(_) => None,
        };
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
        self.trend.clear();
        let frames: Vec<_> = self.cursor.newest(RANGED).cloned().collect();
        for frame in frames.iter().rev() {
            self.measure(frame);
        }
    }

    /// Changes the tare or the threshold. Afterwards range and plot are computed again from the last frames.
    fn repipe<T>(&mut self, act: impl FnOnce(&mut Pipeline) -> T) -> T {
        let before = (self.pipeline.origin(), self.pipeline.rule());
        let done = act(&mut self.pipeline);
        let after = (self.pipeline.origin(), self.pipeline.rule());
        if after != before {
            self.is_viewed_anew = true;
            if after.0 != before.0 {
                self.range.begin_anew();
            }
            self.measure_again();
        }
        done
    }

    pub fn tare_now(&mut self) -> Result<u64, LiveRefusal> {
        let frames = self.cursor.up_to_shown(TARED)?;
        self.repipe(|pipeline| pipeline.tare_of(frames.iter().map(Arc::as_ref)))?;
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

    /// Returns true if neither a tare nor a gain changes the values.
    pub fn shows_raw(&self) -> bool {
        self.pipeline.origin().is_none() && self.pipeline.processing.gain.is_none()
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
        let rule = self.pipeline.processing.rule;
        if let Ok(rule) = threshold::step(rule, direction, self.range.tared_top()) {
            self.choose(rule);
        }
    }

    pub fn switch_unit(&mut self) {
        // Rules apply to the tared values, whichever layer is shown.
        let largest = self.reading.as_ref().and_then(|reading| reading.tared_max);
        let largest = largest.filter(|&largest| largest > 0.0);
        let largest = largest.unwrap_or(self.range.tared_top());
        let rule = self.pipeline.processing.rule;
        let former = self.converted.filter(|(made, _)| rule == Some(*made));
        let other = match former {
            Some((_, former)) => Ok(former),
            None => threshold::other_unit(rule, largest),
        };
        if let Ok(other) = other {
            self.choose(other);
        }
        self.converted = other.ok().zip(rule);
    }

    pub fn freeze(&mut self) {
        self.cursor.freeze();
        self.read();
    }

    pub fn scrub(&mut self, by: i64) -> bool {
        let before = self.cursor.shown().map(|shown| shown.number);
        if self.cursor.scrub(by) {
            self.read();
        }
        self.cursor.shown().map(|shown| shown.number) != before
    }

    pub fn to_oldest(&mut self) {
        self.cursor.stay_at_oldest();
        self.read();
    }

    pub fn to_newest(&mut self) {
        self.cursor.follow();
        self.read();
    }

    pub fn switch_peak(&mut self) {
        self.cursor.switch_peak();
        self.read();
    }

    /// Shows the next layer: raw values, tared values or imprint.
    pub fn next_layer(&mut self) -> HeatLayer {
        self.layer = self.layer.next();
        self.read();
        self.layer
    }

    pub fn switch_range(&mut self) -> bool {
        self.range.is_own = !self.range.is_own;
        self.range.is_own
    }

    pub fn set_recording(&mut self, name: Option<String>) {
        self.recording.set(name);
        // These belong to the recording before.
        self.status.recorded = None;
        self.status.record_error = None;
    }

    /// Notes why a recording has failed, or why it cannot be begun.
    pub fn fail_recording(&mut self, reason: String) {
        let asked = self.request.write.as_ref();
        let asked = asked.map(|(path, _)| path.to_string_lossy());
        self.recording.fail(reason, asked.as_deref());
    }

    pub fn stop(&mut self) {
        self.stopped = true;
        self.recording.stop();
    }

    pub fn has_ended(&self) -> bool {
        self.status.state == SourceState::Ended
    }

    /// Opens the page again after it was closed at the end of its source: it shows what it showed. Shapes are named by
    /// the work of this number.
    pub fn reopen(&mut self, number: u64) {
        self.stopped = false;
        self.names.restart(number);
    }

    fn is_recording(&self) -> bool {
        self.status.channels > 0
    }

    /// Checks that the source can be watched again: a recording at any time unless it is still being written, any
    /// other source after its end.
    pub fn check_again(&self) -> Result<(), LiveRefusal> {
        if self.request.source == FrameSource::Standard {
            return Err(LiveRefusal::ReadOnce);
        }
        let is_possible =
            self.is_recording() && !self.status.follows || self.status.state.is_final();
        is_possible.then_some(()).ok_or(LiveRefusal::NotEnded)
    }

    /// Takes frames again, from the work of this number. The history begins anew with a recording, because the same
    /// frames come again.
    pub fn watch_again(&mut self, number: u64) {
        // The frames that come now do not belong to what was recorded of those before.
        self.recording.stop();
        if self.is_recording() {
            self.cursor = FrameCursor::new(self.request.history_bytes);
            self.not_drawn = 0;
            self.trend.clear();
        }
        self.restart(number);
    }

    /// Takes frames again, from the work of this number; history, threshold and tare stay. The source counts its
    /// frames from 0 again, so everything that refers to its numbers is given up: marks, the held peak, the age of
    /// the tare.
    pub fn restart(&mut self, number: u64) {
        self.number = number;
        self.stopped = false;
        self.recording.refusal = None;
        self.cursor.restart();
        self.marks.clear();
        self.pipeline.restart();
        self.tare_error = None;
        self.read();
        self.status.state = SourceState::Waiting;
        self.status.gaps = SourceGaps::default();
        self.status.note = None;
        self.seen_gaps = SourceGaps::default();
        self.seen_notes = 0;
        self.names.restart(number);
    }

    fn read(&mut self) {
        (self.reading, self.error) = match self.cursor.drawn() {
            Some(frame) => self.read_frame(frame),
            None => (None, None),
        };
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

#[derive(Clone, Debug)]
pub struct ShapeNames {
    /// The set that was requested with the source; None if none was.
    asked: Option<ModelChoice>,
    /// The noise: how often a taxel flips.
    noise: Option<Noise>,
    /// The model that names imprints, and its last answer; None if imprints are not named.
    naming: Option<Naming>,
    /// The set that returns if the next one cannot be read; None if imprints were not named.
    before: Option<ModelChoice>,
    /// The set that could not be read last: the next step through the sets goes on from there.
    unreadable: Option<ModelChoice>,
    pub awaits_models: bool,
}

impl ShapeNames {
    pub fn new(request: &WatchRequest, number: u64) -> Self {
        let mut names = Self {
            asked: request.model.clone(),
            noise: request.noise(),
            naming: None,
            before: request.model.clone(),
            unreadable: None,
            awaits_models: false,
        };
        names.begin(request.model.clone(), number);
        names
    }

    /// Returns the model that names imprints, and its last answer; None if imprints are not named.
    pub fn naming(&self) -> Option<&Naming> {
        self.naming.as_ref()
    }

    /// Returns the request to name imprints; None if imprints are not named.
    pub fn request(&self) -> Option<&NamingRequest> {
        self.naming.as_ref().map(|naming| &naming.request)
    }

    pub fn is_by(&self, number: u64) -> bool {
        self.request()
            .is_some_and(|request| request.number == number)
    }

    /// Names imprints by a set, as the work of this number; None stops naming. Earlier answers are dropped.
    fn begin(&mut self, choice: Option<ModelChoice>, number: u64) {
        let noise = self.noise;
        self.naming = choice.map(|choice| {
            Naming::new(NamingRequest {
                number,
                choice,
                noise,
            })
        });
    }

    pub fn restart(&mut self, number: u64) {
        let choice = self.naming.take().map(|naming| naming.request.choice);
        self.begin(choice, number);
    }

    /// Names imprints by the next set: first the requested one, then the built-in ones, then the user's own models,
    /// then none. `number` is the number of this work.
    pub fn next(&mut self, own: impl Iterator<Item = ModelChoice>, number: u64) {
        let asked = self.asked.clone();
        let sets = ModelChoice::BUILT_IN.iter().cloned().chain(own);
        let sets = sets.filter(|set| Some(set) != asked.as_ref()).map(Some);
        let mut all: Vec<Option<ModelChoice>> = std::iter::once(None).chain(sets).collect();
        if asked.is_some() {
            all.insert(1, asked);
        }
        let chosen = self.request().map(|naming| naming.choice.clone());
        let failed = self.unreadable.take().map(Some);
        let next = other(all, &chosen, failed.as_ref(), 1);
        // A model in a file is sure to be readable only once it has named something.
        if chosen.as_ref().is_none_or(|chosen| !chosen.is_read()) {
            self.before = chosen;
        }
        self.begin(next, number);
    }

    pub fn ask(&mut self, imprint: &Imprint) -> bool {
        self.naming
            .as_mut()
            .is_some_and(|naming| naming.ask(imprint))
    }

    pub fn take(&mut self, number: u64, named: NamedImprint) {
        if self.is_by(number)
            && let Some(naming) = &mut self.naming
        {
            self.before = Some(naming.request.choice.clone());
            naming.take(named);
        }
    }

    /// Takes the reason why the model cannot be used. The set before it returns, as the work of this number; if there
    /// was no other, the reason stays visible.
    pub fn fail(&mut self, reason: &str, number: u64) {
        let Some(naming) = &mut self.naming else {
            return;
        };
        if self.before.as_ref() == Some(&naming.request.choice) {
            naming.fail(reason.to_owned());
        } else {
            self.unreadable = Some(naming.request.choice.clone());
            self.begin(self.before.clone(), number);
        }
    }
}

#[derive(Clone, Debug, Default)]
pub struct RecordingState {
    /// The file that is written; None if nothing is recorded.
    name: Option<String>,
    /// The number in the history that the next frame had when the recording was requested: frames before it are not
    /// recorded.
    from: u64,
    /// Why nothing is recorded although it was requested.
    pub(in crate::tui) refusal: Option<String>,
    write_failure: Option<String>,
    /// Whether a recording ended because its source was left, which the user has not been told yet.
    was_stopped: bool,
}

impl RecordingState {
    /// Returns the file that is written; None if nothing is recorded.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    pub(super) fn from(&self) -> u64 {
        self.from
    }

    /// Returns why nothing is recorded although it was requested; None if it is recorded, or was not requested.
    pub fn refusal(&self) -> Option<&str> {
        self.refusal.as_deref()
    }

    /// Returns why the recording that was requested together with the source has failed; None if it has not. Later
    /// recordings do not change that.
    pub fn write_failure(&self) -> Option<&str> {
        self.write_failure.as_deref()
    }

    pub(super) fn request(&mut self, next_number: u64) {
        self.from = next_number;
    }

    pub(super) fn set(&mut self, name: Option<String>) {
        self.name = name;
        self.refusal = None;
        self.was_stopped = false;
    }

    /// Notes why a recording has failed, or why it cannot be begun. `asked` is the file that was requested together
    /// with the source.
    pub(super) fn fail(&mut self, reason: String, asked: Option<&str>) {
        if asked.is_some() && self.name() == asked {
            self.write_failure = Some(reason.clone());
        }
        self.name = None;
        self.refusal = Some(reason);
    }

    /// Notes that no more frames are recorded, because the source is left.
    pub(super) fn stop(&mut self) {
        self.was_stopped |= self.name.take().is_some();
    }

    /// Returns true once if a recording ended because its source was left.
    pub(super) fn take_stopped(&mut self) -> bool {
        std::mem::take(&mut self.was_stopped)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_the_requested_one_the_built_in_ones_the_own_ones_and_none() {
        let own = ["asked", "other"].map(ModelChoice::from_text);
        let mut request = WatchRequest::new("none");
        request.model = Some(own[0].clone());
        let mut page = Live::new(Arc::new(request), 1);
        let mut sets = Vec::new();
        while let Some(naming) = page.names.request().cloned() {
            sets.push(naming.choice);
            page.names.next(own.clone().into_iter(), naming.number + 1);
        }
        let [asked, other] = own;
        let built_in = ModelChoice::BUILT_IN.to_vec();
        assert_eq!(sets, [vec![asked.clone()], built_in, vec![other]].concat());
        page.names.next(std::iter::once(asked.clone()), 9);
        assert_eq!(
            page.names.request().map(|naming| &naming.choice),
            Some(&asked)
        );
    }
}
