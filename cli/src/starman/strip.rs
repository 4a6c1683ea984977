use roverlab::geometry::Point;
use roverlab::io::sim::starman::{Starman, StarmanPosture};
use roverlab::io::{Clock, Odometry, Result, Servos};
use roverlab::picture::{Picture, Style};
use roverlab::world::{Colour, Wall, World};

use super::evolution::Trials;
use super::options::Args;

/// A gait as it was walked.
#[derive(Debug, Clone)]
pub(crate) struct Walk {
    /// Seconds between two postures.
    pub(crate) interval: f64,
    /// Metres along the floor from where it had come to rest.
    pub(crate) way: f64,
    pub(crate) postures: Vec<StarmanPosture>,
    pub(crate) body_radius: f64,
    pub(crate) limb_radius: f64,
}

impl Walk {
    /// Walks a gait and looks on.
    pub(crate) fn of(trials: &Trials, bytes: &[u8]) -> Result<Self> {
        let spec = trials.spec();
        let mut watched = Watched { robot: Starman::new(&spec)?, postures: Vec::new() };
        let way = trials.walk(bytes, &mut watched, |watched| Ok(watched.robot.pose()?.x))?;
        watched.look();
        let (body_radius, limb_radius) = (spec.body_radius, spec.limb_radius);
        Ok(Self { interval: Watched::INTERVAL, way, postures: watched.postures, body_radius, limb_radius })
    }
}

/// A Starman of which pictures are taken while it waits.
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

/// Postures of the strip.
const FIGURES: usize = 8;
/// Between two figures of the strip, in metres.
const GAP: f64 = 0.42;

/// The walk as a strip: figures side by side, each on its own piece of floor with a mark where it started.
pub(crate) fn picture(args: &Args, walk: &Walk) -> Picture {
    let mut world = World::empty(GAP * FIGURES as f64, 0.40);
    world.walls.push(Wall::new(Point::new(0.0, FLOOR), Point::new(GAP * FIGURES as f64, FLOOR)));
    let mut picture = Picture::new(&world);
    picture.title("Starman's evolved gait");
    let last = walk.postures.len().saturating_sub(1);
    picture.caption(format!(
        "{} generations of {}: {:.0} mm in {} s; green where it started",
        args.generations,
        args.population,
        1000.0 * walk.way,
        args.seconds
    ));
    for figure in 0..FIGURES {
        let index = last * figure / (FIGURES - 1);
        let Some(posture) = walk.postures.get(index) else { continue };
        let middle = GAP * (figure as f64 + 0.5);
        let start = Point::new(middle, FLOOR);
        picture.disc(start, 0.008, Style::new(Colour::GREEN).filled(1.0).labelled("start"));
        draw(&mut picture, walk, posture, middle);
        picture.text(Point::new(middle, 0.02), format!("{:.1} s", index as f64 * walk.interval));
    }
    picture
}

/// The height of the floor in the picture, in metres.
const FLOOR: f64 = 0.05;

fn draw(picture: &mut Picture, walk: &Walk, posture: &StarmanPosture, shift: f64) {
    let at = |(x, y): (f64, f64)| Point::new(x + shift, y + FLOOR);
    let part = |colour| Style::new(colour).width(4.0);
    let (blue, red) = (Colour::from_hex(0x001f_6fb4), Colour::from_hex(0x00c0_392b));
    picture.disc(at(posture.body), walk.body_radius, part(blue).filled(0.25).labelled("body"));
    for (limb, [hinge, tip]) in posture.segments.into_iter().enumerate() {
        // The first limb shows how far the body has rolled.
        let style = if limb == 0 { part(red).labelled("first limb") } else { part(blue).labelled("limb") };
        picture.line([at(hinge), at(tip)], style);
    }
}
