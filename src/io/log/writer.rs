use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};
use std::fmt;
use std::io::{self, Write};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{McapError, WriteOptions, Writer};

use super::header::{LIBRARY, METADATA};
use super::stamp::Nanoseconds;
use super::topics::{Channel, full_topic};
use super::{Compression, Header};

/// A recording being written: an MCAP file, into any byte sink.
///
/// One or several robots write into it through [`recorder`](LogWriter::recorder). Their messages are merged
/// by time, so the file does not depend on the scheduling of their threads. A chunk ends with each second of
/// the robots' time, or when it is full, and is flushed; [`Header::compression`] selects its compression.
///
/// A failing sink does not disturb the run: the rest is not recorded, and [`finish`](LogWriter::finish)
/// returns the first error. A file should be buffered.
///
/// ```
/// use roverlab::io::log::{Header, Log, LogWriter, Replay};
/// use roverlab::io::{Clock, DistanceSensors, MockRobot, Psd, Result};
///
/// fn look(robot: &mut (impl Clock + DistanceSensors)) -> Result<f64> {
///     robot.wait(0.5)?;
///     robot.distance(Psd::FRONT)
/// }
///
/// # fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
/// let writer = LogWriter::new(Vec::new(), &Header::new("look", ["--seed", "7"]))?;
/// let mut robot = writer.recorder(MockRobot::new().with_distance(Psd::FRONT, 1.5), 0);
/// look(&mut robot)?;
/// drop(robot);
///
/// let log = Log::read(writer.finish()?)?;
/// assert_eq!(log.header().program, "look");
/// assert_eq!(look(&mut Replay::new(&log, 0)?)?, 1.5);
/// # Ok(())
/// # }
/// ```
pub struct LogWriter<W: Write> {
    shared: Arc<Mutex<Shared<W>>>,
    /// Wakes robots far ahead of the others after a write.
    written: Arc<Condvar>,
}

impl<W: Write> Clone for LogWriter<W> {
    fn clone(&self) -> Self {
        Self { shared: Arc::clone(&self.shared), written: Arc::clone(&self.written) }
    }
}

impl<W: Write> fmt::Debug for LogWriter<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shared = self.lock();
        f.debug_struct("LogWriter").field("robots", &shared.tracks.len()).finish_non_exhaustive()
    }
}

struct Shared<W: Write> {
    /// `None` once the recording is finished.
    file: Option<Writer<NoSeek<W>>>,
    failure: Option<io::Error>,
    tracks: BTreeMap<usize, Track>,
    /// Maximum number of bytes by which a robot may be ahead of the others.
    most_ahead: Option<usize>,
    /// Time for which it then waits for others that record nothing.
    patience: Duration,
    /// Number of each channel in the file and of its next message, by robot and topic.
    channels: BTreeMap<(usize, &'static str), (u16, u32)>,
    /// Second of the open chunk, and number of bytes in it.
    second: u64,
    bytes: usize,
}

/// Messages of one robot that are not yet in the file.
#[derive(Debug, Default)]
struct Track {
    /// Whether the robot is still driving, so that the others' messages wait for its.
    open: bool,
    /// Time of its last message.
    last: Nanoseconds,
    queue: VecDeque<Message>,
    /// Number of bytes in the queue.
    waiting: usize,
}

#[derive(Debug)]
struct Message {
    time: Nanoseconds,
    channel: Channel,
    data: Vec<u8>,
}

/// Maximum size of a chunk (bytes).
const CHUNK_BYTES: usize = 1 << 20;
/// Bytes that wait for robots that record nothing, at most.
const MOST_WAITING: usize = 64 << 20;
/// Time for which a robot far ahead waits for others that record nothing: their programs may hang.
const PATIENCE: Duration = Duration::from_secs(60);
/// Maximum duration of a chunk (ns): one second.
const SECOND: u64 = 1_000_000_000;

/// Options of the MCAP writer: sinks that cannot seek, one thread, and chunks that end where this writer
/// decides.
pub(super) fn write_options(compression: Compression) -> io::Result<WriteOptions> {
    let options = WriteOptions::new().compression(compression.method()?);
    #[cfg(feature = "zstd")]
    let options = options.compression_threads(0);
    Ok(options.disable_seeking(true).chunk_size(None).profile(""))
}

impl<W: Write> LogWriter<W> {
    /// Starts a recording with its header. Fails if the sink does or this build lacks the compression.
    pub fn new(sink: W, header: &Header) -> io::Result<Self> {
        // The version is in the header, which a replay copies.
        let options = write_options(header.compression)?.library(LIBRARY);
        let mut file = options.create(NoSeek::new(sink)).map_err(as_io)?;
        let metadata = Metadata { name: METADATA.into(), metadata: header.metadata() };
        file.write_metadata(&metadata).map_err(as_io)?;
        for attachment in &header.attachments {
            let attachment = mcap::Attachment {
                log_time: 0,
                create_time: 0,
                name: attachment.name.clone(),
                media_type: attachment.media_type.clone(),
                data: attachment.data.as_slice().into(),
            };
            file.attach(&attachment).map_err(as_io)?;
        }
        file.flush().map_err(as_io)?;
        let shared = Shared {
            file: Some(file),
            failure: None,
            tracks: BTreeMap::new(),
            most_ahead: None,
            patience: PATIENCE,
            channels: BTreeMap::new(),
            second: 0,
            bytes: 0,
        };
        Ok(Self { shared: Arc::new(Mutex::new(shared)), written: Arc::default() })
    }

    /// Makes a robot more than `bytes` bytes ahead of the others wait for them, which bounds the buffered
    /// bytes per robot. For robots that drive in their own threads without other synchronisation. If the
    /// others record nothing for a minute of real time, the robot goes on.
    pub fn hold_at_most(&self, bytes: usize) {
        self.lock().most_ahead = Some(bytes);
    }

    /// Ends the recording and returns the sink, or its first error. Later calls of remaining recorders are
    /// not recorded.
    pub fn finish(self) -> io::Result<W> {
        let mut shared = self.lock();
        shared.tracks.values_mut().for_each(|track| track.open = false);
        shared.drain();
        let file = shared.file.take();
        if let Some(failure) = shared.failure.take() {
            return Err(failure);
        }
        let Some(mut file) = file else {
            return Err(io::Error::other("the recording has been finished before"));
        };
        file.finish().map_err(as_io)?;
        Ok(file.into_inner().into_inner())
    }

    fn lock(&self) -> MutexGuard<'_, Shared<W>> {
        // A panic elsewhere leaves only whole messages behind.
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes a message of a robot. Without a time, or with one before the previous message, it takes that
    /// message's time. A robot's messages keep their order.
    pub(super) fn push(&self, track: usize, time: Option<Nanoseconds>, channel: Channel, data: &[u8]) {
        let mut shared = self.lock();
        if !shared.is_recording() {
            self.written.notify_all();
            return;
        }
        let last = &mut shared.track(track).last;
        let time = time.unwrap_or(*last).max(*last);
        *last = time;
        let alone = shared
            .tracks
            .iter()
            .all(|(other, state)| state.queue.is_empty() && (*other == track || !state.open));
        if alone {
            shared.write(track, time, channel, data);
            return;
        }
        let state = shared.track(track);
        state.queue.push_back(Message { time, channel, data: data.to_vec() });
        state.waiting += data.len();
        shared.let_go();
        shared.drain();
        self.written.notify_all();
        while shared.is_recording() && shared.is_far_ahead(track) {
            let patience = shared.patience;
            let waited = self.written.wait_timeout(shared, patience);
            let (lock, wait) = waited.unwrap_or_else(PoisonError::into_inner);
            shared = lock;
            if wait.timed_out() {
                return;
            }
        }
    }

    /// Marks a robot as driving: the others' messages wait for its.
    pub(super) fn open(&self, track: usize) {
        self.lock().track(track).open = true;
    }

    /// Marks a robot as finished: the others need not wait for it.
    pub(super) fn close(&self, track: usize) {
        let mut shared = self.lock();
        shared.track(track).open = false;
        shared.drain();
        self.written.notify_all();
    }
}

impl<W: Write> Shared<W> {
    /// Track of a robot; closed unless the robot drives.
    fn track(&mut self, index: usize) -> &mut Track {
        self.tracks.entry(index).or_default()
    }

    fn is_recording(&self) -> bool {
        self.file.is_some() && self.failure.is_none()
    }

    fn is_far_ahead(&self, track: usize) -> bool {
        self.most_ahead.is_some_and(|most| self.tracks.get(&track).is_some_and(|track| track.waiting > most))
    }

    /// Where too much waits for robots that record nothing, nothing waits for them any more: a recorder that
    /// is taken and never driven must not fill the memory. Their messages, if there are any, then come late
    /// in the file.
    fn let_go(&mut self) {
        if self.tracks.values().map(|track| track.waiting).sum::<usize>() > MOST_WAITING {
            let silent = self.tracks.values_mut().filter(|track| track.queue.is_empty());
            silent.for_each(|track| track.open = false);
        }
    }

    /// Writes the messages whose order is certain: the earliest one, once every driving robot has one
    /// waiting.
    fn drain(&mut self) {
        while !self.tracks.values().any(|track| track.open && track.queue.is_empty()) {
            let next = self
                .tracks
                .iter()
                .filter_map(|(index, track)| track.queue.front().map(|message| (message.time, *index)))
                .min();
            let Some((_, index)) = next else { return };
            let track = self.track(index);
            if let Some(message) = track.queue.pop_front() {
                track.waiting -= message.data.len();
                self.write(index, message.time, message.channel, &message.data);
            }
        }
    }

    fn write(&mut self, track: usize, time: Nanoseconds, channel: Channel, data: &[u8]) {
        if self.failure.is_none() {
            self.failure = self.try_write(track, time, channel, data).err().map(as_io);
        }
    }

    fn try_write(
        &mut self,
        track: usize,
        time: u64,
        (topic, schema): Channel,
        data: &[u8],
    ) -> Result<(), McapError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        if time / SECOND > self.second || self.bytes > CHUNK_BYTES {
            file.flush()?;
            (self.second, self.bytes) = (self.second.max(time / SECOND), 0);
        }
        let (id, sequence) = match self.channels.entry((track, topic)) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let schema = file.add_schema(schema.name(), "protobuf", &schema.descriptor())?;
                let name = full_topic(track, topic);
                new.insert((file.add_channel(schema, &name, "protobuf", &BTreeMap::new())?, 0))
            }
        };
        let header =
            MessageHeader { channel_id: *id, sequence: *sequence, log_time: time, publish_time: time };
        *sequence = sequence.wrapping_add(1);
        self.bytes += data.len();
        file.write_to_known_channel(&header, data)
    }
}

fn as_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::super::topics::CALLS;
    use super::*;

    const MOST: usize = 100;
    const MESSAGE: [u8; 50] = [7; 50];

    #[test]
    fn a_robot_far_ahead_waits_for_the_others() {
        let writer = LogWriter::new(Vec::new(), &Header::new("ahead", [""; 0])).unwrap();
        writer.hold_at_most(MOST);
        let robots = [writer.port(0), writer.port(1)];
        let waiting = || writer.lock().track(0).waiting;
        thread::scope(|scope| {
            let fast = scope.spawn(|| (0..200).for_each(|time| writer.push(0, Some(time), CALLS, &MESSAGE)));
            while waiting() <= MOST {
                thread::yield_now();
            }
            for time in 0..200 {
                assert!(time > 150 || !fast.is_finished(), "at {time}");
                assert!(waiting() <= MOST + MESSAGE.len());
                writer.push(1, Some(time), CALLS, &MESSAGE);
            }
            writer.close(1);
        });
        drop(robots);
        assert!(writer.finish().unwrap().len() > 400 * MESSAGE.len());
    }

    #[test]
    fn a_robot_far_ahead_waits_for_a_program_that_hangs_no_longer_than_its_patience() {
        let writer = LogWriter::new(Vec::new(), &Header::new("hangs", [""; 0])).unwrap();
        writer.hold_at_most(MOST);
        assert_eq!(writer.lock().patience, PATIENCE);
        writer.lock().patience = Duration::from_millis(20);
        let (_hangs, _driven) = (writer.port(1), writer.port(0));
        (0..10).for_each(|time| writer.push(0, Some(time), CALLS, &MESSAGE));
        assert_eq!(writer.lock().track(0).waiting, 10 * MESSAGE.len());
        assert!(writer.finish().unwrap().len() > 10 * MESSAGE.len());
    }

    #[test]
    fn a_recorder_that_is_never_driven_holds_up_a_bounded_number_of_bytes() {
        let writer = LogWriter::new(std::io::sink(), &Header::new("silent", [""; 0])).unwrap();
        // However large its index.
        let (_silent, _driven) = (writer.port(1_000_000_000), writer.port(0));
        let message = vec![7; 1 << 20];
        for time in 0..200 {
            writer.push(0, Some(time), CALLS, &message);
            assert!(writer.lock().track(0).waiting <= MOST_WAITING + message.len());
        }
        assert_eq!(writer.lock().track(0).waiting, 0);
    }
}
