use super::Result;

/// A received message.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RadioMessage {
    /// Number of the sender.
    pub from: u32,
    /// Content.
    pub data: Vec<u8>,
}

/// Messages between robots, which are numbered from 1 in the order of their placement.
///
/// # For implementers
///
/// Deliver the messages between two robots in order and whole, or not at all. `send` fails for an
/// unknown receiver; `receive` must not block.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Radio {
    /// Number of this robot.
    fn radio_id(&mut self) -> Result<u32>;

    /// Numbers of all robots, including this one.
    fn radio_peers(&mut self) -> Result<Vec<u32>>;

    /// Sends a message to a robot. Messages between two robots arrive in order.
    fn send(&mut self, to: u32, data: &[u8]) -> Result<()>;

    /// The oldest unread message, if any; does not block.
    fn receive(&mut self) -> Result<Option<RadioMessage>>;
}
