use roverlab::geometry::{Point, direction};
use roverlab::io::sim::starman::{Starman, StarmanPosture};
use roverlab::io::{Clock, Odometry, Result, Servos};
use roverlab::picture::{Picture, Style};
use roverlab::world::{Colour, Wall, World};

use super::evolution::Trials;
use super::options::Args;

/// A gait as walked.
#[derive(Debug, Clone)]
pub(crate) struct Walk {
    /// Time between two postures (s).
    pub(crate) interval: f64,
    /// Distance along the floor from the resting position (m).
    pub(crate) way: f64,
    pub(crate) postures: Vec<StarmanPosture>,
    /// Half the length of the body, and its radius (m).
    pub(crate) outline: (f64, f64),
}

impl Walk {
    /// Walks a gait and records its postures.
    pub(crate) fn of(trials: &Trials, bytes: &[u8]) -> Result<Self> {
        let mut watched = Watched { robot: trials.robot(bytes)?, postures: Vec::new() };
        let way = trials.walk(bytes, &mut watched, |watched| Ok(watched.robot.pose()?.x))?;
        watched.look();
        Ok(Self {
            interval: Watched::INTERVAL,
            way,
            postures: watched.postures,
            outline: trials.figure.outline(),
        })
    }
}

/// A Starman whose postures are recorded while it waits.
struct Watched {
    robot: Starman,
    postures: Vec<StarmanPosture>,
}

impl Watched {
    const INTERVAL: f64 = 0.05;

    fn look(&mut self) {
        self.postures.push(self.robot.truth().posture);
    }
}

impl Clock for Watched {
    fn now(&mut self) -> Result<f64> {
        self.robot.now()
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let mut left = seconds;
        while left > 0.0 {
            self.look();
            self.robot.wait(left.min(Self::INTERVAL))?;
            left -= Self::INTERVAL;
        }
        Ok(())
    }
}

impl Servos for Watched {
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        self.robot.set_servo(servo, position)
    }
}

/// Number of postures in the strip.
const FIGURES: usize = 5;
/// Distance between two figures of the strip, and between its floor and that of the walk (m).
const GAP: f64 = 0.42;
const ROW: f64 = 0.42;

/// The walk, and above it some of its postures side by side, each on its own floor.
pub(crate) fn picture(args: &Args, walk: &Walk) -> Picture {
    let width = GAP * FIGURES as f64;
    let mut world = World::empty(width, 2.0 * ROW);
    for floor in [FLOOR, FLOOR + ROW] {
        world.walls.push(Wall::new(Point::new(0.0, floor), Point::new(width, floor)));
    }
    let mut picture = Picture::new(&world);
    let last = walk.postures.len().saturating_sub(1);
    picture.title("Starman's evolved gait").caption(format!(
        "{} generations of {}: {:.0} mm in {} s",
        args.generations,
        args.population,
        1000.0 * walk.way,
        args.seconds
    ));
    let start = |picture: &mut Picture, place| {
        picture.disc(place, 0.01, Style::new(Colour::from_hex(0x2e_8b_57)).filled(1.0).labelled("start"));
    };
    for figure in 0..FIGURES {
        let index = last * figure / (FIGURES - 1);
        let Some(posture) = walk.postures.get(index) else { continue };
        let (middle, time) = (GAP * (figure as f64 + 0.5), index as f64 * walk.interval);
        picture.during(time..);
        start(&mut picture, Point::new(middle, FLOOR + ROW));
        draw(&mut picture, walk, [(time, posture)], Point::new(middle, FLOOR + ROW));
        picture.text(Point::new(middle, ROW + 0.02), format!("{time:.1} s"));
    }
    picture.during(..);
    let middle = Point::new(0.5 * (width - walk.way), FLOOR);
    start(&mut picture, middle);
    let times = (0..).map(|i| f64::from(i) * walk.interval);
    draw(&mut picture, walk, times.zip(&walk.postures), middle);
    picture
}

/// Height of the floor in the picture (m).
const FLOOR: f64 = 0.05;

/// A moving body and its limbs.
fn draw<'a>(
    picture: &mut Picture,
    walk: &Walk,
    postures: impl IntoIterator<Item = (f64, &'a StarmanPosture)>,
    origin: Point,
) {
    let postures: Vec<_> = postures.into_iter().collect();
    let at = |(x, y): (f64, f64)| Point::new(x, y) + origin.coords;
    let part = |colour| Style::new(Colour::from_hex(colour)).width(4.0);
    let (half, radius) = walk.outline;
    let rim = |posture: &StarmanPosture| {
        let along = direction(posture.roll) * half;
        let point = |i: i32| {
            let angle = posture.roll + f64::from(i) * std::f64::consts::TAU / 16.0;
            let end = if (-4..=4).contains(&i) { along } else { -along };
            // Both ends of the body have a point at the sides.
            at(posture.body) + end + direction(angle) * radius
        };
        (-4..=12).map(point).chain([point(-4)]).collect()
    };
    let bodies = postures.iter().map(|(time, posture)| (*time, rim(posture)));
    picture.moving_line(bodies, part(0x26_2d_3a).width(2.5).labelled("body"));
    for limb in 0..postures.first().map_or(0, |(_, posture)| posture.segments.len()) {
        let shapes = postures.iter().map(|(time, posture)| (*time, posture.segments[limb].map(at).to_vec()));
        // The first limb shows how far the body has rolled.
        let style = if limb == 0 {
            part(0xc0_39_2b).labelled("first limb")
        } else {
            part(0x1f_6f_b4).labelled("limb")
        };
        picture.moving_line(shapes, style);
    }
}
