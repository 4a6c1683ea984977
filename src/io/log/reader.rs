use std::borrow::Cow;
use std::io;

use mcap::McapError;
use mcap::records::{MessageHeader, Record, op};
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::{LogError, lengths};

/// Bytes at the beginning and the end of MCAP files.
const MAGIC: &[u8] = mcap::MAGIC;
/// Size of an opcode and a length.
const FRAME: usize = 9;
/// Size of a footer: two positions and a checksum (bytes).
const FOOTER: usize = 8 + 8 + CRC;
/// Size of a checksum (bytes).
const CRC: usize = 4;
/// Size of a chunk without the name of its compression and its compressed content (bytes).
const CHUNK_FIELDS: usize = 3 * 8 + 4 + 4 + 8;

/// A record in a file: kind, position and content.
#[derive(Debug, Clone, Copy)]
pub(super) struct Framed<'a> {
    pub(super) opcode: u8,
    pub(super) start: usize,
    pub(super) body: &'a [u8],
}

impl<'a> Framed<'a> {
    /// Position of the next record.
    pub(super) fn end(&self) -> usize {
        self.start + FRAME + self.body.len()
    }

    pub(super) fn parse(&self) -> Result<Record<'a>, LogError> {
        if !lengths::fit(self.opcode, self.body) {
            return Err(LogError::damaged(format!("the record at byte {} is too short", self.start)));
        }
        mcap::parse_record(self.opcode, self.body)
            .map_err(|error| LogError::damaged(format!("{error} at byte {}", self.start)))
    }
}

/// The records in some bytes from a position on; `None` for a truncated one.
pub(super) fn records(bytes: &[u8], start: usize) -> impl Iterator<Item = Option<Framed<'_>>> {
    let mut at = start;
    std::iter::from_fn(move || {
        if at >= bytes.len() {
            return None;
        }
        let record = record_at(bytes, at);
        at = record.as_ref().map_or(bytes.len(), Framed::end);
        Some(record)
    })
}

/// The record at a position, if it is complete.
pub(super) fn record_at(bytes: &[u8], start: usize) -> Option<Framed<'_>> {
    let head = bytes.get(start..start + FRAME)?;
    let length = u64::from_le_bytes(head[1..].try_into().ok()?);
    let body = start + FRAME;
    let end = body.checked_add(usize::try_from(length).ok()?)?;
    Some(Framed { opcode: head[0], start, body: bytes.get(body..end)? })
}

/// A message in a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct MessageAt<'a> {
    pub(super) header: MessageHeader,
    pub(super) data: &'a [u8],
}

/// Splits the body of a message record.
pub(super) fn message(body: &[u8]) -> Option<MessageAt<'_>> {
    let (head, data) = body.split_at_checked(22)?;
    let header = MessageHeader {
        channel_id: u16::from_le_bytes(head[..2].try_into().ok()?),
        sequence: u32::from_le_bytes(head[2..6].try_into().ok()?),
        log_time: u64::from_le_bytes(head[6..14].try_into().ok()?),
        publish_time: u64::from_le_bytes(head[14..].try_into().ok()?),
    };
    Some(MessageAt { header, data })
}

/// Number of concatenated files, whole or truncated.
pub(super) fn runs(bytes: &[u8]) -> usize {
    let begins = |at: usize| {
        bytes[at..].starts_with(MAGIC)
            && record_at(bytes, at + MAGIC.len())
                .is_some_and(|record| record.opcode == op::HEADER && record.parse().is_ok())
    };
    bytes.iter().enumerate().filter(|&(at, &byte)| byte == MAGIC[0] && begins(at)).count()
}

/// Schemas and channels repeated in a file's summary; none if its end is truncated or damaged.
pub(super) fn declarations(bytes: &[u8]) -> Vec<Framed<'_>> {
    let in_summary = || {
        let at = bytes.len().checked_sub(FRAME + FOOTER + MAGIC.len())?;
        let footer = record_at(bytes, at).filter(|record| record.opcode == op::FOOTER)?;
        let Ok(Record::Footer(parsed)) = footer.parse() else { return None };
        let is_intact =
            |start: &usize| (MAGIC.len()..at).contains(start) && check_end(bytes, *start, &footer).is_ok();
        let start = usize::try_from(parsed.summary_start).ok().filter(is_intact);
        let start = start.or_else(|| moved_summary(bytes, &footer, parsed.summary_crc))?;
        let found = records(&bytes[..at], start).flatten();
        Some(found.filter(|record| matches!(record.opcode, op::SCHEMA | op::CHANNEL)).collect())
    };
    in_summary().unwrap_or_default()
}

/// Start of an intact summary that bytes added or lost before it have moved: it follows the end of the data.
fn moved_summary(bytes: &[u8], footer: &Framed<'_>, checksum: u32) -> Option<usize> {
    let candidates = (MAGIC.len()..footer.start).rev().filter_map(|at| record_at(bytes, at));
    let mut ends = candidates.filter(|record| record.opcode == op::DATA_END && record.body.len() == CRC);
    let start = ends.next()?.end();
    let summary = bytes.get(start..footer.end() - CRC)?;
    // Zero means that no checksum was made.
    (checksum != 0 && checksum == crc32fast::hash(summary)).then_some(start)
}

/// The records of a whole file up to the end of its data. Fails if any byte of the file is corrupted.
pub(super) fn whole(bytes: &[u8]) -> Result<Vec<Framed<'_>>, LogError> {
    if !bytes.starts_with(MAGIC) {
        let cut_off = bytes.len() < MAGIC.len() && MAGIC.starts_with(bytes) && !bytes.is_empty();
        return Err(if cut_off { truncated(bytes) } else { LogError::NoMcap });
    }
    let mut data = Vec::new();
    let mut summary: Option<usize> = None;
    for record in records(bytes, MAGIC.len()) {
        let record = record.ok_or_else(|| truncated(bytes))?;
        match record.opcode {
            op::DATA_END if summary.is_none() => {
                let Record::DataEnd(end) = record.parse()? else { continue };
                check("data section", end.data_section_crc, &bytes[..record.start])?;
                summary = Some(record.end());
            }
            op::FOOTER => {
                let start =
                    summary.ok_or_else(|| LogError::damaged("a footer before the end of the data"))?;
                check_end(bytes, start, &record)?;
                return Ok(data);
            }
            _ if summary.is_none() => data.push(record),
            _ => {}
        }
    }
    Err(truncated(bytes))
}

fn truncated(bytes: &[u8]) -> LogError {
    LogError::Truncated { at: bytes.len() as u64 }
}

fn check(part: &str, saved: u32, bytes: &[u8]) -> Result<(), LogError> {
    // Zero means that no checksum was made.
    if saved == 0 || saved == crc32fast::hash(bytes) {
        return Ok(());
    }
    Err(LogError::damaged(format!("the checksum of the {part} differs")))
}

/// Checks the summary, the footer and the end.
fn check_end(bytes: &[u8], start: usize, footer: &Framed<'_>) -> Result<(), LogError> {
    let Record::Footer(parsed) = footer.parse()? else { return Ok(()) };
    let end = footer.end();
    if footer.body.len() != FOOTER {
        return Err(LogError::damaged("the footer has another length"));
    }
    if parsed.summary_start != 0 && parsed.summary_start != start as u64 {
        return Err(LogError::damaged("the footer points elsewhere than to the summary"));
    }
    check("summary", parsed.summary_crc, &bytes[start..end - CRC])?;
    match &bytes[end..] {
        rest if rest == MAGIC => Ok(()),
        rest if rest.len() < MAGIC.len() && MAGIC.starts_with(rest) => Err(truncated(bytes)),
        _ => Err(LogError::damaged("other bytes than the end mark of an MCAP file at its end")),
    }
}

/// Whether a chunk has a checksum.
pub(super) fn has_checksum(chunk: &Framed<'_>) -> bool {
    chunk.body.get(24..28).is_some_and(|crc| crc != [0; 4])
}

/// Upper limits of the uncompressed size of all chunks together, and of the number of their records.
///
/// A file of a few kilobytes may hold gigabytes of zeros, or of empty messages.
#[derive(Debug, Clone, Copy)]
pub(super) struct Budget {
    left: u64,
    records: u64,
}

impl Budget {
    /// The limit for a file.
    pub(super) fn of(file: &[u8]) -> Self {
        /// Bytes per byte of the file: more than a chunk of a recording can be compressed, with its index.
        const PER_BYTE: u64 = 1 << 12;
        /// The same for a long file, whose chunks are rarely all alike.
        const PER_BYTE_OF_LONG: u64 = 1 << 4;
        /// Bytes for a very short file.
        const LEAST: u64 = 1 << 26;
        /// Bytes unpacked from which on a file counts as long.
        const LONG: u64 = 1 << 32;
        let length = file.len() as u64;
        let most = LONG.max(PER_BYTE_OF_LONG.saturating_mul(length));
        let left = LEAST.saturating_add(PER_BYTE.saturating_mul(length).min(most));
        // Messages differ in their times and numbers, which takes a byte each however they are packed.
        Self { left, records: length }
    }

    /// Whether nothing is left.
    pub(super) fn is_spent(self) -> bool {
        self.left == 0 || self.records == 0
    }

    /// Spends what another budget, which has been this one, has spent.
    pub(super) fn spend_as(&mut self, other: Self, spent: Self) {
        self.left = self.left.saturating_sub(other.left - spent.left);
        self.records = self.records.saturating_sub(other.records - spent.records);
    }

    /// Fails if less than some bytes is left.
    pub(super) fn allows(self, size: u64) -> Result<(), LogError> {
        if size <= self.left {
            return Ok(());
        }
        let most = self.left;
        Err(LogError::damaged(format!(
            "{size} uncompressed bytes; expected at most {most} for a file of this length"
        )))
    }

    fn spend(&mut self, size: u64) -> Result<(), LogError> {
        self.allows(size)?;
        self.left -= size;
        Ok(())
    }
}

/// The uncompressed content of a chunk. Fails if it is corrupted, or larger than the budget.
pub(super) fn contents<'a>(record: &Framed<'a>, budget: &mut Budget) -> Result<Cow<'a, [u8]>, LogError> {
    let Record::Chunk { header, data } = record.parse()? else {
        return Err(LogError::damaged(format!("no chunk at byte {}", record.start)));
    };
    let another = || LogError::damaged(format!("the chunk at byte {} has another length", record.start));
    if CHUNK_FIELDS + header.compression.len() + data.len() != record.body.len() {
        return Err(another());
    }
    let data = match header.compression.as_str() {
        "" => data,
        name => {
            budget.spend(header.uncompressed_size)?;
            Cow::Owned(unpacked(record, (name, header.uncompressed_size), &mut budget.records)?)
        }
    };
    if header.uncompressed_size != data.len() as u64 {
        return Err(another());
    }
    check(&format!("chunk at byte {}", record.start), header.uncompressed_crc, &data)?;
    Ok(data)
}

/// Decompresses a chunk, given the name of the compression and the number of bytes of the content, and counts
/// its records down from `records`.
fn unpacked(chunk: &Framed<'_>, (name, size): (&str, u64), records: &mut u64) -> Result<Vec<u8>, LogError> {
    let damaged = |error: &dyn std::fmt::Display| {
        LogError::damaged(format!("{error} in the chunk at byte {}", chunk.start))
    };
    let mut plain = room(size)?;
    let options = LinearReaderOptions::default().with_skip_start_magic(true).with_skip_end_magic(true);
    let longest = plain.capacity().max(chunk.body.len());
    let mut reader = LinearReader::new_with_options(options.with_record_length_limit(longest));
    let length = (chunk.body.len() as u64).to_le_bytes();
    let packed = [&[chunk.opcode][..], &length, chunk.body].concat();
    let mut rest = packed.as_slice();
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(wanted)) => {
                let (next, behind) = rest.split_at(wanted.min(rest.len()));
                reader.insert(next.len()).copy_from_slice(next);
                reader.notify_read(next.len());
                rest = behind;
            }
            Ok(LinearReadEvent::Record { data, opcode }) => {
                if plain.len() + FRAME + data.len() > size as usize {
                    return Err(damaged(&"more than its length says"));
                }
                let more = || damaged(&"more records than the file has bytes");
                *records = records.checked_sub(1).ok_or_else(more)?;
                plain.push(opcode);
                plain.extend_from_slice(&(data.len() as u64).to_le_bytes());
                plain.extend_from_slice(data);
            }
            Err(McapError::UnsupportedCompression(_)) => {
                return Err(LogError::Compressed { compression: name.into() });
            }
            Err(error) => return Err(damaged(&error)),
        }
    }
    Ok(plain)
}

/// An empty list with a capacity in bytes. Fails if there is not enough memory.
pub(super) fn room(size: u64) -> Result<Vec<u8>, LogError> {
    let mut list = Vec::new();
    let size = usize::try_from(size).unwrap_or(usize::MAX);
    list.try_reserve_exact(size).map_err(|error| io::Error::new(io::ErrorKind::OutOfMemory, error))?;
    Ok(list)
}

/// The records in a chunk: its messages and their declarations.
pub(super) fn inner(contents: &[u8]) -> impl Iterator<Item = Result<Framed<'_>, LogError>> {
    let cut_off = || LogError::damaged("a record is longer than the chunk that holds it");
    records(contents, 0).map(move |record| record.ok_or_else(cut_off))
}
