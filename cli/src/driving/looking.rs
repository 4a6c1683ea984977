use std::ops::ControlFlow;

use image::RgbImage;
use roverlab::geometry::Twist;
use roverlab::io::control::{Behaviour, Decision, Halt, Senses};
use roverlab::io::{self, Camera, Resolution};

/// Takes images at a constant velocity, until the observer has seen enough.
pub(crate) struct Looking {
    pub(crate) resolution: Resolution,
    /// Time between two images (s).
    pub(crate) period: f64,
    pub(crate) velocity: Twist,
}

impl Behaviour for Looking {
    type Observation = RgbImage;
    type Command = Twist;
    type Outcome = Halt;

    fn period(&self) -> f64 {
        self.period
    }

    fn step(&mut self, _time: f64, _seen: &RgbImage) -> Decision<Self> {
        Ok(ControlFlow::Continue(self.velocity))
    }
}

impl<R: Camera + ?Sized> Senses<R> for Looking {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(self.resolution)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut RgbImage) -> io::Result<()> {
        robot.image_into(seen)
    }
}

/// Fails if the time limit came before the observer's end.
pub(crate) fn in_time(halt: Halt) -> io::Result<()> {
    match halt {
        Halt::Stopped => Ok(()),
        Halt::TimedOut => Err(io::Error::new(io::ErrorKind::TimedOut, "the time limit of the run is over")),
    }
}
