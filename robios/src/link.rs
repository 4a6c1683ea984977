//! Connection of a program's library to its world.

use std::fmt;

use roverlab::geometry::Pose;
use roverlab::io::Result;
use roverlab::io::sim::Simulation;

use crate::ask::{Reply, Request};
use crate::plan::Plan;
use crate::report::Stance;
use crate::seat::{Seat, Terms, Walked};

/// Answers requests.
pub trait Link: fmt::Debug + Send {
    /// Lets `debt` seconds pass, which local calls have taken, and answers the request. Some of the `wanted`
    /// readings may come along, in their order.
    fn ask(&mut self, debt: f64, wanted: &[Request], request: &Request) -> Result<(Reply, Vec<Reply>)>;

    /// The robot's time at the last reply (s).
    fn now(&mut self) -> f64;

    /// Ground truth of the robot, if the library has access to it.
    fn truth(&mut self) -> Option<Truth>;
}

/// Ground truth of a robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Time of the world (s).
    pub time: f64,
    /// True pose.
    pub pose: Pose,
    /// Attitude on hills.
    pub stance: Stance,
    /// Pose by odometry.
    pub odometry: Pose,
    /// Distance moved (m).
    pub path_length: f64,
    /// Number of contacts.
    pub contacts: u32,
}

impl Link for Seat {
    fn ask(&mut self, debt: f64, _wanted: &[Request], request: &Request) -> Result<(Reply, Vec<Reply>)> {
        // Further readings are cheap here and need not come along.
        Seat::ask(self, debt, request).map(|reply| (reply, Vec::new()))
    }

    fn now(&mut self) -> f64 {
        Seat::now(self)
    }

    fn truth(&mut self) -> Option<Truth> {
        let robot = Seat::truth(self).robot(self.index()).ok()?;
        let Walked { odometry, path_length, stance } = self.walked().unwrap_or_else(|| Walked {
            odometry: robot.odometry,
            path_length: robot.path_length,
            stance: Stance::of(Seat::truth(self), self.index()),
        });
        Some(Truth {
            time: Seat::truth(self).time(),
            pose: robot.pose,
            stance,
            odometry,
            path_length,
            contacts: robot.contacts,
        })
    }
}

/// Creates a world of the program's own. Fails if its files cannot be read.
pub fn own_world(plan: &Plan) -> std::result::Result<Seat, String> {
    let (scene, _) = plan.scene()?;
    let options = plan.options();
    let terms = Terms::of(&options);
    let simulation = Simulation::new(&scene, options).map_err(|error| error.to_string())?;
    Seat::take(&simulation, &scene, plan.index, terms).map_err(|error| error.to_string())
}
