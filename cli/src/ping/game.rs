use std::cell::RefCell;
use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::rc::Rc;
use std::sync::Arc;

use roverlab::drive::{RadioRing, RadioRingParameters};
use roverlab::geometry::{Point, Pose, Vector, direction};
use roverlab::io::control::Run;
use roverlab::io::sim::SimOptions;
use roverlab::io::{self, FleetIo, RobotIo};
use roverlab::random::Stream;
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};

use crate::common::portable;

/// Half the side of the floor, and radius of the ring of robots on it (m).
const HALF: f64 = 0.8;
const RING: f64 = 0.55;
/// Time in which robots join, and after which some leave (s).
const JOIN: f64 = 10.0;
const LEAVE: [f64; 2] = [12.0, 25.0];
/// Interval between looks at the count (s).
const LOOK: f64 = 0.1;

/// A ring of robots and how long they are in it.
#[derive(Debug, Clone)]
pub(super) struct Game {
    pub(super) scene: Scene,
    pub(super) stays: Vec<Stay>,
    pub(super) options: SimOptions,
    pub(super) messages: u32,
    /// Time limit (s).
    pub(super) limit: f64,
}

/// Times at which a robot joins, and leaves if ever (s).
#[derive(Debug, Clone, Copy)]
pub(super) struct Stay {
    pub(super) from: f64,
    pub(super) to: Option<f64>,
}

/// What came of a game.
#[derive(Debug, Clone, Default)]
pub(super) struct Played {
    /// Arrivals: time (s), robot and number.
    pub(super) arrivals: Vec<(f64, usize, u32)>,
    pub(super) repeats: u32,
    pub(super) joined: usize,
    pub(super) left: usize,
    pub(super) sim_time: f64,
}

portable!(struct Played { arrivals, repeats, joined, left, sim_time });

impl Game {
    /// The ring of a seed.
    pub(super) fn new(robots: usize, messages: u32, options: SimOptions, limit: Option<f64>) -> Self {
        let mut scene = Scene::new(World::walled(2.0 * HALF, 2.0 * HALF));
        let (spec, mut stays) = (Arc::new(RobotSpec::s4()), Vec::new());
        let mut stream = Stream::new(options.seed).child("ping", 0);
        for robot in 0..robots {
            let angle = TAU * robot as f64 / robots as f64;
            let place = Point::new(HALF, HALF) + direction(angle) * RING;
            scene.robots.push(RobotPlacement::new(Arc::clone(&spec), Pose::new(place.x, place.y, angle)));
            let (join, leave) = (stream.between(0.0, JOIN), stream.between(LEAVE[0], LEAVE[1]));
            stays.push(Stay {
                from: if robot < 2 { 0.0 } else { join },
                to: (robot >= 2 && robot % 2 == 0).then_some(leave),
            });
        }
        // Two robots that lose half of all messages need half a second for one.
        let limit = limit.unwrap_or(60.0 + 2.0 * f64::from(messages));
        Self { scene, stays, options, messages, limit }
    }

    /// Plays in a fleet. `watch` is called with the time.
    pub(super) fn play<'a>(
        &self,
        fleet: &mut (dyn FleetIo<'a> + 'a),
        mut watch: impl FnMut(f64),
    ) -> io::Result<Played> {
        let played = Rc::new(RefCell::new(Played::default()));
        for (robot, stay) in self.stays.iter().enumerate() {
            let ring = RadioRing::new(robot == 0, RadioRingParameters::default())?;
            control(fleet, robot, *stay, ring, Rc::clone(&played))?;
        }
        while fleet.time()? < self.limit && played.borrow().highest() < self.messages {
            fleet.run_for(LOOK)?;
            watch(fleet.time()?);
        }
        let mut played = played.borrow().clone();
        played.arrivals.retain(|(_, _, number)| *number <= self.messages);
        played.sim_time = fleet.time()?;
        Ok(played)
    }

    /// Place of a robot's name in a picture.
    pub(super) fn beside(&self, robot: usize) -> Point {
        let place = self.scene.robots[robot].pose.position();
        let outward: Vector = (place - Point::new(HALF, HALF)).normalize();
        place + outward * 0.12
    }
}

/// Lets a robot take part in the ring for its stay.
fn control<'a>(
    fleet: &mut (dyn FleetIo<'a> + 'a),
    robot: usize,
    stay: Stay,
    mut ring: RadioRing,
    played: Rc<RefCell<Played>>,
) -> io::Result<()> {
    let period = RadioRingParameters::default().period;
    let mut run = Run::new(&ring, f64::INFINITY)?;
    let mut is_in = false;
    let step = move |io: &mut dyn RobotIo| {
        let time = io.now()?;
        if time < stay.from {
            return Ok(ControlFlow::Continue(()));
        }
        let mut played = played.borrow_mut();
        played.joined += usize::from(!std::mem::replace(&mut is_in, true) && stay.from > 0.0);
        if stay.to.is_some_and(|to| time >= to) {
            ring.leave();
        }
        let repeats = ring.repeats();
        let flow = run.step(io, &mut ring)?;
        played.repeats += ring.repeats() - repeats;
        played.arrivals.extend(ring.take_heard().into_iter().map(|(time, number)| (time, robot, number)));
        played.left += usize::from(flow.is_break());
        Ok(flow.map_break(|_| ()))
    };
    fleet.control(robot, period, Box::new(step))
}

impl Played {
    fn highest(&self) -> u32 {
        self.arrivals.iter().map(|(_, _, number)| *number).max().unwrap_or(0)
    }

    /// Numbers that arrived more than once, and numbers that did not although a higher one did.
    pub(super) fn duplicated_and_missing(&self) -> (u32, u32) {
        let mut times = vec![0_u32; self.highest() as usize];
        for (_, _, number) in &self.arrivals {
            times[*number as usize - 1] += 1;
        }
        let count = |wanted: fn(u32) -> bool| times.iter().filter(|&&times| wanted(times)).count() as u32;
        (count(|times| times > 1), count(|times| times == 0))
    }

    /// Whether each of a number of messages arrived exactly once.
    pub(super) fn is_good(&self, messages: u32) -> bool {
        self.arrivals.len() == messages as usize && self.duplicated_and_missing() == (0, 0)
    }

    /// Mean time from one arrival to the next (s).
    pub(super) fn interval(&self) -> f64 {
        let last = self.arrivals.iter().map(|(time, ..)| *time).fold(0.0, f64::max);
        last / f64::from(self.highest().max(1))
    }
}
