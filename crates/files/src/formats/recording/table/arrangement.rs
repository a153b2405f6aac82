//! The arrangement of a table: what each line and each field is.

use crate::formats::recording::event::RecordingNote;
use crate::formats::recording::table::clock::TimeFields;
use crate::formats::recording::text::lines::text;
use crate::formats::recording::text::separator::Separator;
use crate::formats::recording::time::moment;
use crate::frame::FrameSize;

/// The arrangement of a table.
#[derive(Clone, Debug)]
pub(super) struct TableLayout {
    /// The separator between fields, in all lines.
    pub(super) separator: Separator,
    /// The size of a frame.
    pub(super) size: FrameSize,
    /// The content of a line.
    pub(super) lines: LineLayout,
    /// The assumption that was made, if any.
    pub(super) note: Option<RecordingNote>,
    /// The unit of the cells, if a line below their names gives it.
    pub(super) unit: Option<String>,
    /// The timestamp of the first frame as it is written, if lines have a timestamp.
    pub(super) start: Option<String>,
}

/// The content of a line of a table.
#[derive(Clone, Debug)]
pub(super) enum LineLayout {
    /// A frame.
    Frame(FrameFields),
    /// A row of a frame.
    Row {
        /// Whether an empty line ends a frame; if not, the next frame begins after the number of rows in a frame.
        parted: bool,
    },
}

/// The fields of a line that is a frame.
#[derive(Clone, Debug)]
pub(super) struct FrameFields {
    /// The number of fields in a line.
    pub(super) count: usize,
    /// The last line of the header, if there is one.
    pub(super) header: Option<u64>,
    /// The field of each cell, row by row.
    pub(super) cells: Vec<usize>,
    /// The field with the frame's label.
    pub(super) label: Option<usize>,
    /// The fields with the time.
    pub(super) time: Option<TimeFields>,
}

/// The arrangement of the table that a followed file held before it was truncated or replaced; empty at first. The
/// program that writes it may continue without a header, in the middle of a line.
#[derive(Debug, Default)]
pub struct EarlierLayout(pub(super) Option<TableLayout>);

impl TableLayout {
    /// Returns the arrangement of the lines that continue the table without a header.
    pub(super) fn continued(&self) -> Self {
        let mut continued = self.clone();
        continued.note = None;
        if let LineLayout::Frame(fields) = &mut continued.lines {
            fields.header = None;
        }
        continued
    }
}

impl LineLayout {
    /// Returns the timestamp in the fields of the first frame, as it is written.
    pub(super) fn start(&self, fields: &[&[u8]]) -> Option<String> {
        let Self::Frame(FrameFields { time, .. }) = self else {
            return None;
        };
        let field = *fields.get((*time)?.field)?;
        moment::read(field).map(|_| text(field))
    }
}

impl FrameFields {
    /// Adds a timestamp beside the cells as the time, unless a number gives the time; `fields` are those of the first
    /// line.
    pub(super) fn with_moment(mut self, separator: Separator, fields: &[&[u8]]) -> Self {
        let is_moment =
            |&field: &usize| fields.get(field).copied().and_then(moment::read).is_some();
        let is_time = |field: usize| {
            let own = fields.get(field);
            own.is_some_and(|own| separator.is_numeric(own)) || is_moment(&field)
        };
        // A column with the name of a time may hold anything, such as a date without a time of day.
        if !self.time.is_some_and(|time| is_time(time.field)) {
            let moment = (0..fields.len()).find(is_moment);
            // An index of timestamps, which pandas writes without a name, is not a label.
            self.label = self.label.filter(|&label| moment != Some(label));
            let moment = moment.map(|field| TimeFields::new(field, None));
            self.time = moment.or(self.time);
        }
        self
    }
}
