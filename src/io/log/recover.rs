use std::borrow::Cow;

use mcap::records::{Record, op};
use mcap::write::NoSeek;
use mcap::{McapError, Writer};

use super::header::LIBRARY;
use super::header::METADATA;
use super::reader::{self, Budget, Framed};
use super::writer::write_options;
use super::{Compression, Header, LogError};

/// Result of recovering a damaged recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recovery {
    /// Bytes of a valid recording with the recovered content.
    pub bytes: Vec<u8>,
    /// Number of recovered chunks.
    pub chunks: usize,
    /// Number of recovered messages.
    pub messages: u64,
    /// Whether the header was recovered. Without it the result can be viewed, but not replayed. That of a
    /// newer schema is recovered too; [`Log::read`](super::Log::read) refuses it.
    pub header: bool,
    /// Number of unusable bytes in the damaged file, such as an incomplete last chunk.
    pub lost: usize,
}

/// Recovers every complete and intact chunk of a truncated or damaged recording.
///
/// Channels are declared in the first chunk and in the summary at the end. Where both are lost, so are the
/// messages of all chunks.
///
/// An undamaged file is returned unchanged, byte for byte. Time is proportional to the file's size. Fails for
/// several recordings in one file and for other kinds of files.
///
/// ```
/// use roverlab::io::log::{Header, Log, LogWriter, recover};
/// use roverlab::io::{Clock, MockRobot};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let writer = LogWriter::new(Vec::new(), &Header::new("clock", [""; 0]))?;
/// let mut robot = writer.recorder(MockRobot::new(), 0);
/// (0..10).try_for_each(|_| robot.wait(0.5))?;
/// drop(robot);
/// let bytes = writer.finish()?;
///
/// let cut_off = &bytes[..bytes.len() / 2];
/// assert!(Log::read(cut_off.to_vec()).is_err());
/// let saved = recover(cut_off)?;
/// assert!(Log::read(saved.bytes).is_ok() && saved.chunks > 0);
/// # Ok(())
/// # }
/// ```
pub fn recover(bytes: &[u8]) -> Result<Recovery, LogError> {
    let runs = reader::runs(bytes);
    if runs > 1 {
        return Err(LogError::SeveralRuns { runs });
    }
    let mut saving = begin(bytes)?;
    let mut at = mcap::MAGIC.len();
    let mut patience = PATIENCE * bytes.len();
    while at < bytes.len() {
        let here = reader::record_at(bytes, at).and_then(|record| saving.limits.sound(record));
        let found = here.or_else(|| next_guarded(bytes, at + 1, &mut patience, &mut saving.limits));
        let Some(found) = found else {
            saving.lost += bytes.len() - at;
            break;
        };
        saving.lost += found.record.start - at;
        at = found.record.end();
        if found.record.opcode == op::DATA_END {
            break;
        }
        saving.add(&found)?;
    }
    saving.finish()
}

/// A record that can be parsed, with the uncompressed content of a chunk.
struct Sound<'a> {
    record: Framed<'a>,
    contents: Cow<'a, [u8]>,
}

/// Limits of unpacking: what sound chunks have left, and what is left for others, so that damage costs no
/// sound ones.
struct Limits {
    sound: Budget,
    unsound: Budget,
}

impl Limits {
    /// Checks a record, and unpacks it if it is a chunk.
    fn sound<'a>(&mut self, record: Framed<'a>) -> Option<Sound<'a>> {
        if record.opcode != op::CHUNK {
            return is_sound(&record).then_some(Sound { record, contents: Cow::Borrowed(&[]) });
        }
        if self.unsound.is_spent() {
            return None;
        }
        let before = self.sound;
        let contents = reader::contents(&record, &mut self.sound).ok();
        let are_sound = |contents: &Cow<'_, [u8]>| {
            reader::inner(contents).all(|record| record.is_ok_and(|record| record.parse().is_ok()))
        };
        let contents = contents.filter(are_sound);
        if contents.is_none() {
            self.unsound.spend_as(before, self.sound);
            self.sound = before;
        }
        contents.map(|contents| Sound { record, contents })
    }
}

/// An empty recording like a damaged one. Fails if the file begins neither as an MCAP file nor with a record
/// of one.
fn begin(bytes: &[u8]) -> Result<Saving<'_>, LogError> {
    let first = mcap::MAGIC.len();
    let named = reader::record_at(bytes, first).filter(|record| record.opcode == op::HEADER);
    let named = named.and_then(|record| record.parse().ok());
    let (profile, library) = match named {
        Some(Record::Header(header)) => (header.profile, header.library),
        _ if !bytes.starts_with(mcap::MAGIC) => return Err(LogError::NoMcap),
        _ if bytes.len() == first => return Err(LogError::Truncated { at: bytes.len() as u64 }),
        _ => (String::new(), LIBRARY.to_owned()),
    };
    let limits = Limits { sound: Budget::of(bytes), unsound: Budget::of(bytes) };
    let mut saving = Saving::new(&profile, &library, compression(bytes, first), limits)?;
    saving.declarations = reader::declarations(bytes);
    Ok(saving)
}

/// Compression of the first chunk from a position on.
fn compression(bytes: &[u8], start: usize) -> Compression {
    let records = reader::records(bytes, start).map_while(|record| record);
    let chunks = records.filter(|record| record.opcode == op::CHUNK);
    let named = chunks.filter_map(|chunk| match chunk.parse() {
        Ok(Record::Chunk { header, .. }) => Some(Compression::named(&header.compression)),
        _ => None,
    });
    named.flatten().next().unwrap_or_default()
}

/// Whether a record that is no chunk can be parsed, and its length matches the content: a wrong length would
/// swallow the following records.
fn is_sound(record: &Framed<'_>) -> bool {
    // Kinds added by future formats or other programs.
    if record.opcode >= 0x80 {
        return true;
    }
    let Ok(parsed) = record.parse() else { return false };
    let length = match &parsed {
        Record::Header(header) => 4 + header.profile.len() + 4 + header.library.len(),
        Record::Metadata(metadata) => {
            if metadata.name == METADATA && Header::read(&metadata.metadata).is_none() {
                return false;
            }
            let fields = metadata.metadata.iter().map(|(name, value)| 4 + name.len() + 4 + value.len());
            4 + metadata.name.len() + 4 + fields.sum::<usize>()
        }
        Record::Attachment { header, data, .. } => {
            16 + 4 + header.name.len() + 4 + header.media_type.len() + 8 + data.len() + 4
        }
        Record::MessageIndex(index) => 2 + 4 + 16 * index.records.len(),
        Record::DataEnd(_) => 4,
        _ => return matches!(record.opcode, op::HEADER..=op::DATA_END),
    };
    length == record.body.len()
}

/// Maximum number of passes over the bytes of a file: in a malicious file, every position seems to start a
/// record that reaches to the end.
const PATIENCE: usize = 100;

/// The next record with a valid checksum, unless the limit on passes is exceeded.
fn next_guarded<'a>(
    bytes: &'a [u8],
    start: usize,
    patience: &mut usize,
    limits: &mut Limits,
) -> Option<Sound<'a>> {
    let mut guarded = (start..bytes.len()).filter_map(|at| reader::record_at(bytes, at).filter(is_guarded));
    guarded.find_map(|record| match patience.checked_sub(record.body.len()) {
        None => Some(None),
        Some(rest) => {
            *patience = rest;
            limits.sound(record).map(Some)
        }
    })?
}

/// Whether a record that is sound cannot be so by chance.
fn is_guarded(record: &Framed<'_>) -> bool {
    match record.opcode {
        op::CHUNK => reader::has_checksum(record),
        op::ATTACHMENT => !record.body.ends_with(&[0; 4]),
        op::METADATA => {
            matches!(record.parse(), Ok(Record::Metadata(metadata)) if metadata.name == METADATA)
        }
        _ => false,
    }
}

/// A recording assembled from the intact parts.
struct Saving<'a> {
    file: Writer<NoSeek<Vec<u8>>>,
    /// Schemas and channels from the file's summary, for messages whose own declaration is lost.
    declarations: Vec<Framed<'a>>,
    limits: Limits,
    chunks: usize,
    messages: u64,
    header: bool,
    lost: usize,
}

impl Saving<'_> {
    fn new(profile: &str, library: &str, compression: Compression, limits: Limits) -> Result<Self, LogError> {
        let options = write_options(compression)?.profile(profile).library(library);
        let file = options.create(NoSeek::new(Vec::new())).map_err(|error| damaged(&error))?;
        Ok(Self { file, declarations: Vec::new(), limits, chunks: 0, messages: 0, header: false, lost: 0 })
    }

    fn add(&mut self, Sound { record, contents }: &Sound<'_>) -> Result<(), LogError> {
        let written = match record.parse()? {
            Record::Metadata(metadata) => {
                let is_header = metadata.name == METADATA;
                if is_header && self.header {
                    // The beginning of another recording in the file is damaged, and it was not counted.
                    return Err(LogError::SeveralRuns { runs: 2 });
                }
                self.header |= is_header;
                self.file.write_metadata(&metadata)
            }
            Record::Attachment { header, data, .. } => self.file.attach(&mcap::Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            }),
            Record::Chunk { .. } => {
                let lost_before = self.lost;
                reader::inner(contents).try_for_each(|inner| self.add_inner(&inner?))?;
                self.chunks += usize::from(self.lost == lost_before);
                self.file.flush()
            }
            Record::Message { data, .. } => {
                // This project's messages are in chunks.
                self.lost += data.len();
                Ok(())
            }
            _ => Ok(()),
        };
        written.map_err(|error| damaged(&error))
    }

    fn add_inner(&mut self, record: &Framed<'_>) -> Result<(), LogError> {
        match record.parse()? {
            Record::Message { header, data } => {
                let mut written = self.file.write_to_known_channel(&header, &data);
                // The chunk with its declaration is lost.
                if matches!(written, Err(McapError::UnknownChannel(..))) && self.declare(header.channel_id)? {
                    written = self.file.write_to_known_channel(&header, &data);
                }
                if matches!(written, Err(McapError::UnknownChannel(..))) {
                    self.lost += record.body.len();
                    return Ok(());
                }
                self.messages += 1;
                written.map_err(|error| damaged(&error))
            }
            declaration => self.add_declaration(&declaration),
        }
    }

    /// Writes a channel and its schema from the summary. Returns whether the summary contains the channel.
    fn declare(&mut self, id: u16) -> Result<bool, LogError> {
        let declared: Vec<_> = self.declarations.iter().filter_map(|record| record.parse().ok()).collect();
        let channel =
            declared.iter().find(|record| matches!(record, Record::Channel(channel) if channel.id == id));
        let Some(Record::Channel(channel)) = channel else { return Ok(false) };
        let schema = declared
            .iter()
            .find(|record| matches!(record, Record::Schema { header, .. } if header.id == channel.schema_id));
        schema.into_iter().try_for_each(|schema| self.add_declaration(schema))?;
        self.add_declaration(&Record::Channel(channel.clone())).map(|()| true)
    }

    fn add_declaration(&mut self, record: &Record<'_>) -> Result<(), LogError> {
        let written = match record {
            Record::Schema { header, data } => {
                self.file.add_schema_with_id(header.id, &header.name, &header.encoding, data).map(drop)
            }
            Record::Channel(channel) => {
                let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                self.file
                    .add_channel_with_id(channel.id, channel.schema_id, topic, encoding, &channel.metadata)
                    .map(drop)
            }
            _ => Ok(()),
        };
        match written {
            // The chunk with the channel's schema is lost, and therefore its messages.
            Err(McapError::UnknownSchema(..)) => Ok(()),
            other => other.map_err(|error| damaged(&error)),
        }
    }

    fn finish(mut self) -> Result<Recovery, LogError> {
        self.file.finish().map_err(|error| damaged(&error))?;
        let Self { file, chunks, messages, header, lost, .. } = self;
        Ok(Recovery { bytes: file.into_inner().into_inner(), chunks, messages, header, lost })
    }
}

fn damaged(error: &McapError) -> LogError {
    LogError::damaged(error.to_string())
}
