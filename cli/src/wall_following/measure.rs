use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::ControlFlow;

use roverlab::drive::WallSide;
use roverlab::geometry::{Point, Pose, angle_difference, direction};
use roverlab::world::Scene;
use roverlab::world::space::{Scanner, Solid, Space};

use super::corners::{Corner, corners};
use super::drive::Beside;

/// Errors of many distances.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Errors {
    sum_of_squares: f64,
    count: u64,
    /// Largest error (m).
    pub(crate) worst: f64,
}

crate::common::portable!(struct Errors { sum_of_squares, count, worst });

impl Errors {
    fn add(&mut self, error: f64) {
        self.sum_of_squares += error * error;
        self.count += 1;
        self.worst = self.worst.max(error.abs());
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        self.sum_of_squares += other.sum_of_squares;
        self.count += other.count;
        self.worst = self.worst.max(other.worst);
    }

    /// Root mean square error (m); `None` without any.
    pub(crate) fn rms(&self) -> Option<f64> {
        (self.count > 0).then(|| (self.sum_of_squares / self.count as f64).sqrt())
    }
}

/// Extent of some points in several directions.
#[derive(Debug, Clone, Copy, Default)]
struct Extent([Option<(f64, f64)>; 8]);

impl Extent {
    fn add(&mut self, point: Point) {
        let directions = self.0.len() as f64;
        for (k, span) in self.0.iter_mut().enumerate() {
            let along = direction(PI * k as f64 / directions).dot(&point.coords);
            let (low, high) = span.unwrap_or((along, along));
            *span = Some((low.min(along), high.max(along)));
        }
    }

    /// Distance of the two points farthest from each other, to within 2 % (m).
    fn width(&self) -> f64 {
        self.0.iter().flatten().map(|(low, high)| high - low).fold(0.0, f64::max)
    }
}

/// Observes a robot on its way round.
#[derive(Debug)]
pub(crate) struct Watch {
    space: Space,
    /// Scans towards the left, or the right, where distances are measured.
    scanner: Scanner,
    ranges: Vec<f64>,
    side: Option<WallSide>,
    corners: Vec<Corner>,
    distance: f64,
    wanted: u32,
    last: Pose,
    driven: f64,
    /// Pose where the wall was found, and distance driven by then (m).
    begin: Option<(Pose, f64)>,
    /// Whether the lap has begun there.
    settled: bool,
    /// Distance driven beside walls (m) and turn (rad) since the first one, until the lap begins.
    beside: f64,
    round: f64,
    /// Where the robot has been since the start of the lap, and how far it has turned (rad).
    extent: Extent,
    turned: f64,
    /// Distance driven far from walls in the lap (m).
    apart: f64,
    pub(crate) laps: u32,
    pub(crate) lap_length: Option<f64>,
    pub(crate) away_from_corners: Errors,
    pub(crate) everywhere: Errors,
    /// Position of the largest error.
    pub(crate) worst_place: Option<Pose>,
}

/// Half width of the search sector on the robot's left or right, and its angular step (rad): the shortest
/// beam is at most 0.02 % longer than the distance.
const HALF: f64 = 80.0 * STEP;
const STEP: f64 = PI / 180.0;
const BEAMS: usize = 161;
/// Limit of measured distances, as a multiple of the wished one.
const FARTHEST: f64 = 4.0;
/// Distance driven after finding the wall from which errors count (m).
const SETTLING: f64 = 0.3;
/// Maximum distance (m) and heading difference (rad) from the start of a lap at its end, once the robot has
/// turned round.
const LAP: (f64, f64) = (0.2, 0.8);
/// Width of a lap (m). Smaller rounds end the drive as blocked.
const LEAST_WIDTH: f64 = 0.18;
/// Distance beyond which a robot does not follow a wall, as a multiple of the wished one, and the greatest
/// share of the way at such distances of a robot that follows walls.
const FAR: f64 = 1.5;
const APART: f64 = 0.1;

impl Watch {
    pub(crate) fn new(scene: &Scene, distance: f64, laps: u32) -> Self {
        let mut space = Space::new(&scene.world.walls);
        for object in &scene.world.objects {
            space.add(Solid::from(object));
        }
        let robot = Solid::from(&scene.robots[0]);
        Self {
            space,
            scanner: Scanner::new(
                -HALF,
                STEP,
                BEAMS,
                0.5 * (robot.bottom + robot.top),
                0.0,
                FARTHEST * distance,
            ),
            ranges: vec![0.0; BEAMS],
            side: None,
            corners: corners(&scene.world, distance),
            distance,
            wanted: laps,
            last: scene.robots[0].pose,
            driven: 0.0,
            begin: None,
            settled: false,
            beside: 0.0,
            round: 0.0,
            extent: Extent::default(),
            turned: 0.0,
            apart: 0.0,
            laps: 0,
            lap_length: None,
            away_from_corners: Errors::default(),
            everywhere: Errors::default(),
            worst_place: None,
        }
    }

    /// Records the robot's pose. Breaks after the last lap.
    pub(crate) fn see(&mut self, pose: Pose, beside: Beside) -> ControlFlow<()> {
        let (step, turn) =
            (pose.distance_to(self.last.position()), angle_difference(pose.heading, self.last.heading));
        self.side = beside.side.or(self.side);
        self.driven += step;
        self.turned += turn;
        self.last = pose;
        if !self.settled {
            self.settle(pose, beside.wall, step, turn);
        }
        let Some((begin, since)) = self.begin.filter(|_| self.settled) else {
            return ControlFlow::Continue(());
        };
        let gap = self.measure(pose);
        self.apart += if gap > FAR * self.distance { step } else { 0.0 };
        self.extent.add(pose.position());
        let (near, alike) = LAP;
        let back = pose.distance_to(begin.position()) < near
            && angle_difference(pose.heading, begin.heading).abs() < alike;
        if back && self.turned.abs() > PI {
            if self.extent.width() > LEAST_WIDTH {
                self.laps += 1;
                self.lap_length.get_or_insert(self.driven - since - SETTLING);
            }
            self.start_lap(begin);
        } else if self.turned.abs() > 2.0 * TAU && self.apart < APART * (self.driven - since - SETTLING) {
            // The robot follows walls, but has left the one at which the lap began.
            self.start_lap(pose);
        }
        if self.laps >= self.wanted { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn start_lap(&mut self, begin: Pose) {
        (self.extent, self.turned, self.apart) = (Extent::default(), 0.0, 0.0);
        self.begin = Some((begin, self.driven - SETTLING));
    }

    /// The lap begins once the robot has been beside a wall for a while, or, where all walls are short, once
    /// it has turned round beside them.
    fn settle(&mut self, pose: Pose, beside_wall: bool, step: f64, turn: f64) {
        if beside_wall {
            self.beside += step;
        }
        self.round += if self.beside > 0.0 { turn } else { 0.0 };
        match self.begin {
            Some((_, since)) if self.driven - since >= SETTLING => self.settled = true,
            begin => {
                self.begin = beside_wall.then(|| (pose, begin.map_or(self.driven, |(_, since)| since)));
                self.turned = 0.0;
            }
        }
        if !self.settled && beside_wall && self.beside >= SETTLING && self.round.abs() > TAU {
            self.start_lap(pose);
            self.settled = true;
        }
    }

    /// Measures the distance to the nearest wall on the followed side (m).
    fn measure(&mut self, pose: Pose) -> f64 {
        let turn = if self.side == Some(WallSide::Right) { -FRAC_PI_2 } else { FRAC_PI_2 };
        let eye = Pose { heading: pose.heading + turn, ..pose };
        self.space.scan(&mut self.scanner, &eye, None, &mut self.ranges);
        let nearest = self.ranges.iter().copied().fold(FARTHEST * self.distance, f64::min);
        let error = nearest - self.distance;
        self.everywhere.add(error);
        if self.corners.iter().any(|corner| pose.distance_to(corner.place) < corner.reach) {
            return nearest;
        }
        if error.abs() > self.away_from_corners.worst {
            self.worst_place = Some(pose);
        }
        self.away_from_corners.add(error);
        nearest
    }
}
