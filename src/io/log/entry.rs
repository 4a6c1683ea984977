use super::Log;
use super::call::Call;
use super::recording::Kind;
use super::stamp::seconds;

/// A recorded call in readable form, for tables and pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Start of the call by the robot's clock (s).
    pub time: f64,
    /// Whether it queried the ground truth rather than the robot.
    pub truth: bool,
    /// Name of the call, such as `set_speed`.
    pub method: String,
    /// Arguments as text.
    pub arguments: String,
    /// Result as text, or the error.
    pub result: Result<String, String>,
    /// Numbers of the result, in metres, radians and seconds; x, y and heading for a pose.
    pub numbers: Vec<f64>,
}

impl Log {
    /// The calls of a robot in order; none for an unknown robot.
    pub fn entries(&self, robot: usize) -> impl Iterator<Item = Entry> + '_ {
        let events = (0..).map_while(move |index| self.event(robot, index));
        events.filter(|event| event.kind != Kind::Bulk).filter_map(|event| {
            let call = Call::read(self.data(event))?;
            let (result, numbers) = match &call.result {
                Ok(result) => (Ok(result.shown()), result.numbers.clone()),
                Err(failure) => (Err(failure.error().to_string()), Vec::new()),
            };
            Some(Entry {
                time: seconds(event.time),
                truth: event.kind == Kind::Truth,
                method: call.method.into(),
                arguments: call.arguments.shown(),
                result,
                numbers,
            })
        })
    }
}
