use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use mcap::records::{Record, op};

use super::header::LIBRARY;
use super::header::{METADATA, Written};
use super::reader::{self, Budget, Framed};
use super::stamp::Nanoseconds;
use super::stamp::seconds;
use super::topics::WORLD;
use super::wire::{self, Field};
use super::{Attachment, Header, LogError, SCHEMA_VERSION};
use crate::geometry::{Pose, math};

/// A verified recording in memory.
///
/// Cheap to clone: copies share the memory.
#[derive(Clone)]
pub struct Log {
    contents: Arc<Contents>,
}

struct Contents {
    bytes: Vec<u8>,
    /// Concatenated content of the chunks if some are compressed; otherwise it is used in place.
    unpacked: Option<Vec<u8>>,
    header: Header,
    /// Events of each robot, in order.
    tracks: Vec<Vec<Event>>,
    facts: Facts,
}

/// Facts about a recording as a whole.
#[derive(Debug, Clone, Default)]
struct Facts {
    /// Number of messages on each topic.
    topics: BTreeMap<String, u64>,
    chunks: usize,
    /// Times of the first and the last message.
    span: Option<(Nanoseconds, Nanoseconds)>,
    /// Start pose of each robot in the world.
    starts: BTreeMap<usize, Pose>,
    /// Whether attachments differ from those of the original recording.
    attachments_lost: bool,
}

/// Role of a robot's message in a replay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A call to the robot.
    Call,
    /// A query of the ground truth.
    Truth,
    /// Ranges or pixels of the next call's answer.
    Bulk,
    /// Origin of odometry: the first transform of a topic.
    Start,
}

/// A message of a robot and its position in the file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Event {
    pub(super) kind: Kind,
    pub(super) time: Nanoseconds,
    place: Range<usize>,
}

impl fmt::Debug for Log {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Log")
            .field("header", self.header())
            .field("robots", &self.robots())
            .finish_non_exhaustive()
    }
}

impl Log {
    /// Reads a recording from the bytes of its file. Time is proportional to its size; memory is a few bytes
    /// per message in addition. Fails for a file that is not an intact recording.
    pub fn read(bytes: Vec<u8>) -> Result<Self, LogError> {
        let (header, tracks, facts, unpacked) = Contents::read(&bytes)?;
        Ok(Self { contents: Arc::new(Contents { bytes, unpacked, header, tracks, facts }) })
    }

    /// Header of the recording.
    pub fn header(&self) -> &Header {
        &self.contents.header
    }

    /// Number of recorded robots.
    pub fn robots(&self) -> usize {
        self.contents.tracks.len()
    }

    /// Number of messages on each topic.
    pub fn topics(&self) -> &BTreeMap<String, u64> {
        &self.contents.facts.topics
    }

    /// Number of chunks of the file.
    pub fn chunks(&self) -> usize {
        self.contents.facts.chunks
    }

    /// Times of the first and the last message (s); `None` without messages.
    pub fn span(&self) -> Option<(f64, f64)> {
        self.contents.facts.span.map(|(first, last)| (seconds(first), seconds(last)))
    }

    /// Start pose of a robot in the world, if recorded.
    pub fn start(&self, robot: usize) -> Option<Pose> {
        self.contents.facts.starts.get(&robot).copied()
    }

    /// Whether attachments of the original recording are missing, as may happen after
    /// [`recover`](super::recover).
    pub fn lacks_attachments(&self) -> bool {
        self.contents.facts.attachments_lost
    }

    /// Bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        &self.contents.bytes
    }

    pub(super) fn event(&self, robot: usize, index: usize) -> Option<&Event> {
        self.contents.tracks.get(robot)?.get(index)
    }

    /// Content of a message.
    pub(super) fn data(&self, event: &Event) -> &[u8] {
        let contents = &*self.contents;
        &contents.unpacked.as_ref().unwrap_or(&contents.bytes)[event.place.clone()]
    }
}

/// Header, tracks and facts of a recording, and its chunks unpacked if some are compressed.
type Parts = (Header, Vec<Vec<Event>>, Facts, Option<Vec<u8>>);

impl Contents {
    fn read(bytes: &[u8]) -> Result<Parts, LogError> {
        let records = reader::whole(bytes).map_err(|error| match reader::runs(bytes) {
            0 | 1 => error,
            runs => LogError::SeveralRuns { runs },
        })?;
        let mut reading = Reading {
            start: bytes.as_ptr().addr(),
            library: String::new(),
            headers: Vec::new(),
            attachments: Vec::new(),
            channels: BTreeMap::new(),
            topics: BTreeMap::new(),
            messages: BTreeMap::new(),
            facts: Facts::default(),
            tracks: Vec::new(),
        };
        // The header determines whether the rest can be read.
        for record in records.iter().filter(|record| !matches!(record.opcode, op::CHUNK | op::MESSAGE)) {
            reading.add(record)?;
        }
        let header = reading.header()?;
        if let Some(message) = records.iter().find(|record| record.opcode == op::MESSAGE) {
            return Err(LogError::damaged(format!("a message outside of chunks at byte {}", message.start)));
        }
        let chunks = || records.iter().filter(|record| record.opcode == op::CHUNK);
        reading.facts.chunks = chunks().count();
        let unpacked = unpacked(bytes, chunks())?;
        if let Some(all) = &unpacked {
            reading.start = all.as_ptr().addr();
            reading.add_all(all)?;
        } else {
            let mut budget = Budget::of(bytes);
            for chunk in chunks() {
                let Cow::Borrowed(contents) = reader::contents(chunk, &mut budget)? else { continue };
                reading.add_all(contents)?;
            }
        }
        let topics = std::mem::take(&mut reading.messages).into_iter();
        reading.facts.topics = topics.map(|(id, count)| (reading.topic(id), count)).collect();
        Ok((header, reading.tracks, reading.facts, unpacked))
    }
}

/// The content of all chunks, one after the other, if some of them are compressed.
fn unpacked<'a>(
    bytes: &[u8],
    chunks: impl Iterator<Item = &'a Framed<'a>> + Clone,
) -> Result<Option<Vec<u8>>, LogError> {
    let mut size = 0_u64;
    let mut packed = false;
    for chunk in chunks.clone() {
        if let Record::Chunk { header, .. } = chunk.parse()? {
            packed |= !header.compression.is_empty();
            size = size.saturating_add(header.uncompressed_size);
        }
    }
    if !packed {
        return Ok(None);
    }
    let mut budget = Budget::of(bytes);
    budget.allows(size)?;
    let mut all = reader::room(size)?;
    for chunk in chunks {
        all.extend_from_slice(&reader::contents(chunk, &mut budget)?);
    }
    Ok(Some(all))
}

/// State while reading a file.
struct Reading {
    /// Address of the bytes that contain the messages.
    start: usize,
    library: String,
    headers: Vec<Written>,
    attachments: Vec<Attachment>,
    /// Robot and kind of message of each channel needed for a replay.
    channels: BTreeMap<u16, (usize, Kind)>,
    topics: BTreeMap<u16, String>,
    /// Number of messages on each channel.
    messages: BTreeMap<u16, u64>,
    facts: Facts,
    tracks: Vec<Vec<Event>>,
}

impl Reading {
    /// Adds the content of chunks.
    fn add_all(&mut self, contents: &[u8]) -> Result<(), LogError> {
        reader::inner(contents).try_for_each(|inner| self.add(&inner?))
    }

    fn add(&mut self, record: &Framed<'_>) -> Result<(), LogError> {
        if record.opcode == op::MESSAGE {
            return self.add_message(record);
        }
        match record.parse()? {
            Record::Header(header) => self.library = header.library,
            Record::Metadata(metadata) if metadata.name == METADATA => {
                let header = Header::read(&metadata.metadata);
                self.headers
                    .push(header.ok_or_else(|| LogError::damaged("the header is not as it was written"))?);
            }
            Record::Attachment { header, data, .. } => self.attachments.push(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            }),
            Record::Channel(channel) => {
                self.topics.insert(channel.id, channel.topic.clone());
                if let Some(known) = channel_of(&channel.topic) {
                    self.channels.insert(channel.id, known);
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn add_message(&mut self, record: &Framed<'_>) -> Result<(), LogError> {
        let message = reader::message(record.body)
            .ok_or_else(|| LogError::damaged(format!("the message at byte {} is too short", record.start)))?;
        let (id, time) = (message.header.channel_id, message.header.log_time);
        *self.messages.entry(id).or_insert(0) += 1;
        let (first, last) = self.facts.span.unwrap_or((time, time));
        self.facts.span = Some((first.min(time), last.max(time)));
        let Some(&(robot, kind)) = self.channels.get(&message.header.channel_id) else { return Ok(()) };
        if kind == Kind::Start {
            if let Some(start) = start_of(message.data) {
                self.facts.starts.entry(robot).or_insert(start);
            }
            return Ok(());
        }
        if self.tracks.len() <= robot {
            self.tracks.resize(robot + 1, Vec::new());
        }
        // The data is a slice of those bytes, so its address gives its position.
        let start = message.data.as_ptr().addr() - self.start;
        let place = start..start + message.data.len();
        self.tracks[robot].push(Event { kind, time: message.header.log_time, place });
        Ok(())
    }

    fn topic(&self, id: u16) -> String {
        self.topics.get(&id).cloned().unwrap_or_else(|| format!("channel {id}"))
    }

    /// The single header of a recording supported by this version.
    fn header(&mut self) -> Result<Header, LogError> {
        if self.headers.len() > 1 {
            return Err(LogError::SeveralRuns { runs: self.headers.len() });
        }
        let Some(Written { mut header, schema, digest }) = self.headers.pop() else {
            let library = std::mem::take(&mut self.library);
            let ours = library.starts_with(LIBRARY);
            return Err(if ours { LogError::NoHeader } else { LogError::Foreign { library } });
        };
        if schema > SCHEMA_VERSION {
            return Err(LogError::Newer { found: schema, supported: SCHEMA_VERSION });
        }
        header.attachments = std::mem::take(&mut self.attachments);
        self.facts.attachments_lost = header.digest() != digest;
        Ok(header)
    }
}

/// Robot and kind of a topic; `None` if a replay does not need it.
fn channel_of(topic: &str) -> Option<(usize, Kind)> {
    /// Upper limit of the number of robots in a recording.
    const MOST: usize = 100_000;
    let (robot, name) = topic.strip_prefix("/robot")?.split_once('/')?;
    let robot = robot.parse::<usize>().ok()?.checked_sub(1).filter(|&robot| robot < MOST)?;
    let kind = match name {
        "calls" => Kind::Call,
        "truth" => Kind::Truth,
        "lidar" | "camera" => Kind::Bulk,
        "transforms" => Kind::Start,
        _ => return None,
    };
    Some((robot, kind))
}

/// Start of odometry, if a transform contains it.
fn start_of(transform: &[u8]) -> Option<Pose> {
    let number = |field: u32, part: u32| {
        wire::Reading::new(wire::bytes_of(transform, field)?).find_map(|(number, value)| match value {
            Field::Fixed64(bits) if number == part => Some(f64::from_bits(bits)),
            _ => None,
        })
    };
    if wire::bytes_of(transform, 2)? != WORLD.as_bytes() {
        return None;
    }
    let heading = 2.0 * math::atan2(number(5, 3)?, number(5, 4)?);
    Some(Pose::new(number(4, 1)?, number(4, 2)?, heading))
}
