use std::collections::BTreeMap;
use std::io::{Seek, Write};

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};

use super::cdr::encoded;
use super::definitions::definition;
use super::messages::Message;

/// Writes a bag of ROS 2 as an MCAP file.
pub(super) struct Bag<W: Write + Seek> {
    file: Writer<W>,
    /// Number of each topic's channel, and of its messages.
    topics: BTreeMap<String, (u16, u32)>,
}

/// The quality of service of topics that keep their last message for those who come later, as bags write it.
const LATCHED: &str = "\
- history: 1
  depth: 1
  reliability: 1
  durability: 1
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: 1
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false
";

impl<W: Write + Seek> Bag<W> {
    pub(super) fn new(sink: W) -> Result<Self, McapError> {
        let options = WriteOptions::new().profile("ros2").library("roverlab").compression(None);
        Ok(Self { file: options.create(sink)?, topics: BTreeMap::new() })
    }

    /// Writes a message.
    pub(super) fn write<M: Message>(&mut self, time: u64, topic: &str, message: &M) -> Result<(), McapError> {
        self.put(time, topic, message, false)
    }

    /// Writes a message that those who come later get as well.
    pub(super) fn latch<M: Message>(&mut self, time: u64, topic: &str, message: &M) -> Result<(), McapError> {
        self.put(time, topic, message, true)
    }

    fn put<M: Message>(
        &mut self,
        time: u64,
        topic: &str,
        message: &M,
        latched: bool,
    ) -> Result<(), McapError> {
        if !self.topics.contains_key(topic) {
            let qos = if latched { LATCHED } else { "" };
            let schema = self.file.add_schema(M::NAME, "ros2msg", definition(M::NAME).as_bytes())?;
            let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), qos.to_owned())]);
            let id = self.file.add_channel(schema, topic, "cdr", &metadata)?;
            self.topics.insert(topic.to_owned(), (id, 0));
        }
        let Some((channel_id, count)) = self.topics.get_mut(topic) else { return Ok(()) };
        let header =
            MessageHeader { channel_id: *channel_id, sequence: *count, log_time: time, publish_time: time };
        *count += 1;
        self.file.write_to_known_channel(&header, &encoded(message))
    }

    /// Ends the bag. Returns the sink, and the number of messages on each topic.
    pub(super) fn finish(mut self) -> Result<(W, BTreeMap<String, u32>), McapError> {
        self.file.finish()?;
        let counts = std::mem::take(&mut self.topics).into_iter().map(|(topic, (_, count))| (topic, count));
        Ok((self.file.into_inner(), counts.collect()))
    }
}
