use std::collections::BTreeMap;
use std::sync::Arc;

use mcap::records::{Record, op};

use super::LogError;
use super::reader::{self, Budget, Framed};

/// A channel of any MCAP file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct McapChannel {
    /// Its topic.
    pub topic: String,
    /// Encoding of its messages, such as `cdr` or `protobuf`.
    pub encoding: String,
    /// Name of their schema; empty if there is none.
    pub schema: String,
}

/// Visits the messages of any MCAP file, such as a bag of ROS 2, in the order of the file: with their channel
/// and time (ns). One chunk at a time is unpacked. Fails for a file that is damaged or cut off, and with the
/// first error of `visit`.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::io::log::{Header, LogError, LogWriter, visit_messages};
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::io::Odometry;
/// use roverlab::world::{RobotSpec, Scene, World};
/// let scene = Scene::with_robot(World::empty(2.0, 2.0), RobotSpec::s4(), Pose::default());
/// let simulation = Simulation::new(&scene, SimOptions::ideal())?;
/// let writer = LogWriter::new(Vec::new(), &Header::new("still", ["--seed 1"]))?;
/// writer.recorder(simulation.robot(0)?, 0).pose()?;
/// let mut topics = Vec::new();
/// visit_messages(&writer.finish()?, |channel, _, _| {
///     topics.push(channel.topic.clone());
///     Ok::<(), LogError>(())
/// })?;
/// assert!(topics.contains(&"/robot1/odometry".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn visit_messages<E: From<LogError>>(
    bytes: &[u8],
    visit: impl FnMut(&McapChannel, u64, &[u8]) -> Result<(), E>,
) -> Result<(), E> {
    let mut visitor = Visitor { schemas: BTreeMap::new(), channels: BTreeMap::new(), visit };
    let mut budget = Budget::of(bytes);
    for record in reader::whole(bytes)? {
        if record.opcode != op::CHUNK {
            visitor.add(&record)?;
            continue;
        }
        for inner in reader::inner(&reader::contents(&record, &mut budget)?) {
            visitor.add(&inner?)?;
        }
    }
    Ok(())
}

/// What has been declared so far, and who is shown the messages.
struct Visitor<F> {
    /// Names of the schemas.
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Arc<McapChannel>>,
    visit: F,
}

impl<E: From<LogError>, F: FnMut(&McapChannel, u64, &[u8]) -> Result<(), E>> Visitor<F> {
    fn add(&mut self, record: &Framed<'_>) -> Result<(), E> {
        match record.opcode {
            op::MESSAGE => return self.message(record),
            op::SCHEMA | op::CHANNEL => {}
            _ => return Ok(()),
        }
        match record.parse()? {
            Record::Schema { header, .. } => {
                self.schemas.insert(header.id, header.name);
            }
            Record::Channel(channel) => {
                let schema = match channel.schema_id {
                    0 => String::new(),
                    id => self.schemas.get(&id).cloned().ok_or_else(|| {
                        let topic = &channel.topic;
                        LogError::damaged(format!(
                            "the channel {topic} has schema {id}, which is not declared"
                        ))
                    })?,
                };
                let (topic, encoding) = (channel.topic, channel.message_encoding);
                self.channels.insert(channel.id, Arc::new(McapChannel { topic, encoding, schema }));
            }
            _ => {}
        }
        Ok(())
    }

    fn message(&mut self, record: &Framed<'_>) -> Result<(), E> {
        let damaged = |what: &str| LogError::damaged(format!("the message at byte {} {what}", record.start));
        let message = reader::message(record.body).ok_or_else(|| damaged("is too short"))?;
        let channel = self.channels.get(&message.header.channel_id);
        let channel = channel.ok_or_else(|| damaged("is on a channel that is not declared"))?;
        (self.visit)(channel, message.header.log_time, message.data)
    }
}
