use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use mcap::records::{Record, op};

use super::header::METADATA;
use super::reader::{self, Framed};
use super::writer::Nanoseconds;
use super::{Attachment, Header, LogError, SCHEMA_VERSION};

/// A recording in memory, checked.
///
/// It is cheap to clone: the copies share the memory.
#[derive(Clone)]
pub struct Log {
    contents: Arc<Contents>,
}

struct Contents {
    bytes: Vec<u8>,
    header: Header,
    /// What each robot recorded, in the order in which it did.
    tracks: Vec<Vec<Event>>,
}

/// What a message of a robot is to a replay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A call of the robot.
    Call,
    /// A question about the truth.
    Truth,
    /// The ranges or the pixels that the next call answers with.
    Bulk,
}

/// A message of a robot and where it is in the file.
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
    /// Reads a recording from the bytes of its file. Takes time in proportion to them, and a few bytes of memory for
    /// each message besides.
    pub fn read(bytes: Vec<u8>) -> Result<Self, LogError> {
        let (header, tracks) = Contents::read(&bytes)?;
        Ok(Self { contents: Arc::new(Contents { bytes, header, tracks }) })
    }

    /// What the recording says about its run.
    pub fn header(&self) -> &Header {
        &self.contents.header
    }

    /// How many robots were recorded.
    pub fn robots(&self) -> usize {
        self.contents.tracks.len()
    }

    /// The bytes of the file.
    pub fn bytes(&self) -> &[u8] {
        &self.contents.bytes
    }

    pub(super) fn event(&self, robot: usize, index: usize) -> Option<&Event> {
        self.contents.tracks.get(robot)?.get(index)
    }

    /// What a message holds.
    pub(super) fn data(&self, event: &Event) -> &[u8] {
        &self.contents.bytes[event.place.clone()]
    }
}

impl Contents {
    fn read(bytes: &[u8]) -> Result<(Header, Vec<Vec<Event>>), LogError> {
        let records = reader::whole(bytes)?;
        let mut reading = Reading {
            bytes,
            library: String::new(),
            headers: Vec::new(),
            attachments: Vec::new(),
            channels: BTreeMap::new(),
            tracks: Vec::new(),
        };
        // The header decides whether the rest can be understood.
        for record in records.iter().filter(|record| record.opcode != op::CHUNK) {
            reading.add(record)?;
        }
        let header = reading.header()?;
        for record in records.iter().filter(|record| record.opcode == op::CHUNK) {
            for inner in reader::chunk(record)? {
                reading.add(&inner)?;
            }
        }
        Ok((header, reading.tracks))
    }
}

/// A file while it is read.
struct Reading<'a> {
    bytes: &'a [u8],
    library: String,
    headers: Vec<(Header, u32)>,
    attachments: Vec<Attachment>,
    /// What is known about the channels that a replay needs: their robots, and what their messages are.
    channels: BTreeMap<u16, (usize, Kind)>,
    tracks: Vec<Vec<Event>>,
}

impl Reading<'_> {
    fn add(&mut self, record: &Framed<'_>) -> Result<(), LogError> {
        if record.opcode == op::MESSAGE {
            return self.add_message(record);
        }
        match record.parse()? {
            Record::Header(header) => self.library = header.library,
            Record::Metadata(metadata) if metadata.name == METADATA => {
                let header = Header::read(&metadata.metadata);
                self.headers.push(header.ok_or_else(|| LogError::damaged("the header lacks its schema"))?);
            }
            Record::Attachment { header, data, .. } => self.attachments.push(Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            }),
            Record::Channel(channel) => {
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
        let Some(&(robot, kind)) = self.channels.get(&message.header.channel_id) else { return Ok(()) };
        if self.tracks.len() <= robot {
            self.tracks.resize(robot + 1, Vec::new());
        }
        // The data is a part of the file, so its place is found by its address.
        let start = message.data.as_ptr().addr() - self.bytes.as_ptr().addr();
        let place = start..start + message.data.len();
        self.tracks[robot].push(Event { kind, time: message.header.log_time, place });
        Ok(())
    }

    /// The one header of a recording that this version understands.
    fn header(&mut self) -> Result<Header, LogError> {
        if self.headers.len() > 1 {
            return Err(LogError::SeveralRuns { runs: self.headers.len() });
        }
        let Some((mut header, schema)) = self.headers.pop() else {
            return Err(LogError::Foreign { library: std::mem::take(&mut self.library) });
        };
        if schema > SCHEMA_VERSION {
            return Err(LogError::Newer { found: schema, supported: SCHEMA_VERSION });
        }
        header.attachments = std::mem::take(&mut self.attachments);
        Ok(header)
    }
}

/// The robot and the kind of a topic; `None` if a replay does without it.
fn channel_of(topic: &str) -> Option<(usize, Kind)> {
    /// More robots than this are no recording of ours.
    const MOST: usize = 100_000;
    let (robot, name) = topic.strip_prefix("/robot")?.split_once('/')?;
    let robot = robot.parse::<usize>().ok()?.checked_sub(1).filter(|&robot| robot < MOST)?;
    let kind = match name {
        "calls" => Kind::Call,
        "truth" => Kind::Truth,
        "lidar" | "camera" => Kind::Bulk,
        _ => return None,
    };
    Some((robot, kind))
}
