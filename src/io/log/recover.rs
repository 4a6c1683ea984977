use std::borrow::Cow;

use mcap::records::{Record, op};
use mcap::write::NoSeek;
use mcap::{McapError, Writer};

use super::header::METADATA;
use super::reader::{self, Framed};
use super::writer::write_options;
use super::{Compression, Header, LogError};

/// What could be saved of a damaged recording.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recovery {
    /// The bytes of a whole recording with what was saved.
    pub bytes: Vec<u8>,
    /// Chunks that were saved.
    pub chunks: usize,
    /// Messages that were saved.
    pub messages: u64,
    /// Whether the header was saved. Without it what is left can be looked at, but not replayed.
    pub header: bool,
    /// Bytes of the damaged file that hold nothing of use: the incomplete last chunk, say.
    pub lost: usize,
}

/// Gives back every complete and intact chunk of a recording that was cut off or damaged.
///
/// Of a file without damage comes the same file, byte for byte. Takes time in proportion to the file's length.
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
    if !bytes.starts_with(mcap::MAGIC) {
        return Err(LogError::NoMcap);
    }
    let mut saving: Option<Saving> = None;
    let mut lost = 0;
    let mut at = mcap::MAGIC.len();
    while at < bytes.len() {
        let Some(record) = reader::record_at(bytes, at).filter(is_sound) else {
            let next = next_chunk(bytes, at + 1);
            lost += next - at;
            at = next;
            continue;
        };
        at = record.end();
        match (record.opcode, &mut saving) {
            (op::DATA_END, _) => break,
            (op::HEADER, None) => {
                if let Record::Header(header) = record.parse()? {
                    saving = Some(Saving::new(&header.profile, &header.library, compression(bytes, at))?);
                }
            }
            (_, Some(saving)) => saving.add(&record)?,
            // Without the header at its place, this is not a file of ours.
            (_, None) => return Err(LogError::damaged("the file does not begin with a header")),
        }
    }
    let saving = saving.ok_or(LogError::Truncated { at: bytes.len() as u64 })?;
    saving.finish(lost)
}

/// How the first chunk from a place on is compressed.
fn compression(bytes: &[u8], start: usize) -> Compression {
    let records = reader::records(bytes, start).map_while(|record| record);
    let chunks = records.filter(|record| record.opcode == op::CHUNK);
    let named = chunks.filter_map(|chunk| match chunk.parse() {
        Ok(Record::Chunk { header, .. }) => Some(Compression::named(&header.compression)),
        _ => None,
    });
    named.flatten().next().unwrap_or_default()
}

/// Whether a record can be read, a chunk with all that it holds.
fn is_sound(record: &Framed<'_>) -> bool {
    match record.opcode {
        op::CHUNK => {
            let contents = reader::contents(record);
            let inner = contents.as_deref().map(reader::inner);
            inner
                .is_ok_and(|inner| inner.is_ok_and(|inner| inner.iter().all(|record| record.parse().is_ok())))
        }
        op::HEADER..=op::DATA_END => record.parse().is_ok(),
        // Kinds that future formats or other programs add.
        _ => record.opcode >= 0x80,
    }
}

/// Where the next intact chunk begins; the end of the file if there is none.
fn next_chunk(bytes: &[u8], start: usize) -> usize {
    let candidates = (start..bytes.len()).filter(|&at| bytes[at] == op::CHUNK);
    let mut intact = candidates.filter(|&at| {
        reader::record_at(bytes, at).is_some_and(|record| reader::has_checksum(&record) && is_sound(&record))
    });
    intact.next().unwrap_or(bytes.len())
}

/// A recording that is put together from what is intact.
struct Saving {
    file: Writer<NoSeek<Vec<u8>>>,
    chunks: usize,
    messages: u64,
    header: bool,
}

impl Saving {
    fn new(profile: &str, library: &str, compression: Compression) -> Result<Self, LogError> {
        let options = write_options(compression)?.profile(profile).library(library);
        let file = options.create(NoSeek::new(Vec::new())).map_err(|error| damaged(&error))?;
        Ok(Self { file, chunks: 0, messages: 0, header: false })
    }

    fn add(&mut self, record: &Framed<'_>) -> Result<(), LogError> {
        let written = match record.parse()? {
            Record::Metadata(metadata) => {
                self.header |= metadata.name == METADATA && Header::read(&metadata.metadata).is_some();
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
                self.chunks += 1;
                let contents = reader::contents(record)?;
                reader::inner(&contents)?.iter().try_for_each(|inner| self.add_inner(inner))?;
                self.file.flush()
            }
            _ => Ok(()),
        };
        written.map_err(|error| damaged(&error))
    }

    fn add_inner(&mut self, record: &Framed<'_>) -> Result<(), LogError> {
        let written = match record.parse()? {
            Record::Schema { header, data } => {
                self.file.add_schema_with_id(header.id, &header.name, &header.encoding, &data).map(drop)
            }
            Record::Channel(channel) => {
                let (topic, encoding) = (&channel.topic, &channel.message_encoding);
                self.file
                    .add_channel_with_id(channel.id, channel.schema_id, topic, encoding, &channel.metadata)
                    .map(drop)
            }
            Record::Message { header, data } => {
                let data: Cow<'_, [u8]> = data;
                let written = self.file.write_to_known_channel(&header, &data);
                self.messages += u64::from(written.is_ok());
                written
            }
            _ => Ok(()),
        };
        match written {
            // The chunk that declared it is lost.
            Err(McapError::UnknownChannel(..) | McapError::UnknownSchema(..)) => Ok(()),
            other => other.map_err(|error| damaged(&error)),
        }
    }

    fn finish(mut self, lost: usize) -> Result<Recovery, LogError> {
        self.file.finish().map_err(|error| damaged(&error))?;
        let Self { file, chunks, messages, header } = self;
        Ok(Recovery { bytes: file.into_inner().into_inner(), chunks, messages, header, lost })
    }
}

fn damaged(error: &McapError) -> LogError {
    LogError::damaged(error.to_string())
}
