use super::Log;
use super::call::Call;
use super::recording::Kind;
use super::stamp::seconds;

/// A recorded call in plain form, for tables and pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Seconds of the robot's time when the call began.
    pub time: f64,
    /// Whether it was asked of the world's truth, not of the robot.
    pub truth: bool,
    /// The call's name: `set_speed`, say.
    pub method: String,
    /// The arguments in words.
    pub arguments: String,
    /// The result in words, or the error.
    pub result: Result<String, String>,
    /// The numbers of the result: metres, radians, seconds. Of a pose x, y and heading.
    pub numbers: Vec<f64>,
}

impl Log {
    /// The calls of a robot in the order in which they were made; none for a robot that there is not.
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
