use super::Result;

/// A message that a robot received.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RadioMessage {
    /// The number of the robot that sent it.
    pub from: u32,
    /// What it sent.
    pub data: Vec<u8>,
}

/// Messages between robots. Robots are numbered from 1 in the order in which they were placed.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Radio {
    /// This robot's number.
    fn radio_id(&mut self) -> Result<u32>;

    /// The numbers of all robots, this one included.
    fn radio_peers(&mut self) -> Result<Vec<u32>>;

    /// Sends a message to a robot. Messages between two robots arrive in the order in which they were sent.
    fn send(&mut self, to: u32, data: &[u8]) -> Result<()>;

    /// The oldest message that has not been received, if any; does not wait.
    fn receive(&mut self) -> Result<Option<RadioMessage>>;
}
