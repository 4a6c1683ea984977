//! The way from a program's library to its world: within the process, or through a socket.

use std::fmt;
use std::os::unix::net::UnixStream;

use roverlab::geometry::Pose;
use roverlab::io::sim::Simulation;
use roverlab::io::{Error, ErrorKind, Result};

use crate::ask::{Reply, Request, Seat};
use crate::plan::Plan;
use crate::wire::{Answer, LONGEST, Question, receive, send};

/// Somebody who answers requests.
pub trait Link: fmt::Debug + Send {
    /// Lets `debt` seconds pass that calls without the world have taken, and answers.
    fn ask(&mut self, debt: f64, request: &Request) -> Result<Reply>;

    /// The robot's own time at the last answer.
    fn now(&mut self) -> f64;

    /// What is true about the robot, where the library itself can know it.
    fn truth(&mut self) -> Option<Truth>;
}

/// What is true about a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Seconds that the world has run.
    pub time: f64,
    /// Where it is.
    pub pose: Pose,
    /// Where it believes to be.
    pub odometry: Pose,
    /// Metres that it has moved.
    pub path_length: f64,
    /// Its contacts.
    pub contacts: u32,
}

impl Link for Seat {
    fn ask(&mut self, debt: f64, request: &Request) -> Result<Reply> {
        Seat::ask(self, debt, request)
    }

    fn now(&mut self) -> f64 {
        Seat::now(self)
    }

    fn truth(&mut self) -> Option<Truth> {
        let robot = Seat::truth(self).robot(self.index()).ok()?;
        Some(Truth {
            time: Seat::truth(self).time(),
            pose: robot.pose,
            odometry: robot.odometry,
            path_length: robot.path_length,
            contacts: robot.contacts,
        })
    }
}

/// A world of the program's own.
pub fn own_world(plan: &Plan) -> std::result::Result<Seat, String> {
    let (scene, _) = plan.scene()?;
    let options = plan.options();
    let times = (options.call_duration, options.time_limit);
    let simulation = Simulation::new(&scene, options).map_err(|error| error.to_string())?;
    Seat::take(&simulation, &scene, plan.index, times).map_err(|error| error.to_string())
}

/// A world in another process.
#[derive(Debug)]
pub struct Remote {
    stream: UnixStream,
    frame: Vec<u8>,
    now: f64,
}

impl Remote {
    /// The world at the other end of a socket.
    pub fn new(stream: UnixStream) -> Self {
        Self { stream, frame: Vec::new(), now: 0.0 }
    }

    fn answer(&mut self, question: &Question) -> std::io::Result<Option<Answer>> {
        send(&mut self.stream, question.encode())?;
        let found = receive(&mut self.stream, LONGEST, &mut self.frame)?;
        Ok(if found { Answer::decode(&self.frame) } else { None })
    }
}

impl Link for Remote {
    fn ask(&mut self, debt: f64, request: &Request) -> Result<Reply> {
        let question = Question { debt, request: request.clone() };
        match self.answer(&question) {
            Ok(Some(answer)) => {
                self.now = answer.now;
                answer.reply
            }
            Ok(None) => Err(Error::new(ErrorKind::Disconnected, "the world has ended")),
            Err(error) => {
                Err(Error::new(ErrorKind::Disconnected, "the world cannot be reached").with_source(error))
            }
        }
    }

    fn now(&mut self) -> f64 {
        self.now
    }

    fn truth(&mut self) -> Option<Truth> {
        None
    }
}
