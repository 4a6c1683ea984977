use std::fmt;
use std::io::Write;

use super::call;
use super::messages::{Frames, raw_image};
use super::shadow::Shadow;
use super::stamp::Nanoseconds;
use super::topics::{Channel, LCD, frame, odometry_frame};
use super::values::{Put, Values};
use super::wire::Fields;
use super::writer::LogWriter;
use crate::io::{Error, Lcd, Result};

/// A robot's access to a recording: writes its calls and the messages for viewers.
pub(super) struct Port<W: Write> {
    writer: LogWriter<W>,
    track: usize,
    frame: String,
    odometry_frame: String,
    time: Option<Nanoseconds>,
    arguments: Values,
    result: Values,
    message: Vec<u8>,
    shadow: Shadow,
    /// Whether dropping it ends the robot's track.
    closes: bool,
}

impl<W: Write> fmt::Debug for Port<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Port").field("track", &self.track).field("time", &self.time).finish_non_exhaustive()
    }
}

impl<W: Write> Drop for Port<W> {
    fn drop(&mut self) {
        if self.closes {
            self.show_display();
            self.writer.close(self.track);
        }
    }
}

impl<W: Write> Port<W> {
    pub(super) fn new(writer: LogWriter<W>, track: usize) -> Self {
        Self {
            writer,
            track,
            frame: frame(track),
            odometry_frame: odometry_frame(track),
            time: None,
            arguments: Values::default(),
            result: Values::default(),
            message: Vec::new(),
            shadow: Shadow::default(),
            closes: true,
        }
    }

    /// A further access for the same robot, which may outlive the first.
    pub(super) fn beside(writer: LogWriter<W>, track: usize) -> Self {
        let mut port = Self::new(writer, track);
        port.closes = false;
        port
    }

    /// Starts a call at a time; without one the time of the previous message applies.
    pub(super) fn begin(&mut self, time: Option<Nanoseconds>) {
        self.time = time;
        self.arguments.clear();
        if time.is_some_and(|time| self.shadow.is_due(time)) {
            self.show_display();
        }
    }

    /// Repeats the robot's drawing in the current call.
    pub(super) fn draw(&mut self, drawing: impl FnOnce(&mut Lcd) -> Result<()>) {
        self.shadow.draw(self.time.unwrap_or(0), drawing);
    }

    /// Writes the display if something was drawn since the last time.
    fn show_display(&mut self) {
        let mut shadow = std::mem::take(&mut self.shadow);
        if let Some(image) = shadow.take() {
            self.show(LCD, |out, frames| raw_image(out, frames, image));
        }
        self.shadow = shadow;
    }

    pub(super) fn argument(&mut self, argument: &dyn Put) {
        argument.put(&mut self.arguments);
    }

    /// Writes the current call.
    pub(super) fn end<T: Put>(&mut self, channel: Channel, method: &str, result: &Result<T>) {
        self.end_with(channel, method, result.as_ref().map(|value| value as &dyn Put));
    }

    fn end_with(&mut self, channel: Channel, method: &str, result: std::result::Result<&dyn Put, &Error>) {
        self.result.clear();
        let result = match result {
            Ok(value) => {
                value.put(&mut self.result);
                Ok(&self.result)
            }
            Err(error) => Err(error),
        };
        self.message.clear();
        call::write(&mut self.message, method, &self.arguments, result);
        self.writer.push(self.track, self.time, channel, &self.message);
    }

    /// Writes a message for viewers.
    pub(super) fn show(&mut self, channel: Channel, fill: impl FnOnce(&mut Fields<'_>, &Frames<'_>)) {
        self.message.clear();
        let frames =
            Frames { time: self.time.unwrap_or(0), robot: &self.frame, odometry: &self.odometry_frame };
        fill(&mut Fields(&mut self.message), &frames);
        self.writer.push(self.track, self.time, channel, &self.message);
    }
}

impl<W: Write> LogWriter<W> {
    /// Opens an access to the recording for a robot that starts driving.
    pub(super) fn port(&self, index: usize) -> Port<W> {
        self.open(index);
        Port::new(self.clone(), index)
    }
}
