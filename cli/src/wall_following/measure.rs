use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::ControlFlow;

use roverlab::drive::WallSide;
use roverlab::geometry::{Pose, angle_difference};
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
    /// Whether the robot has left the start of the lap, and how far it has turned since (rad).
    away: bool,
    turned: f64,
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
/// been farther away and has turned round.
const LAP: (f64, f64) = (0.2, 0.8);

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
            away: false,
            turned: 0.0,
            laps: 0,
            lap_length: None,
            away_from_corners: Errors::default(),
            everywhere: Errors::default(),
            worst_place: None,
        }
    }

    /// Records the robot's pose. Breaks after the last lap.
    pub(crate) fn see(&mut self, pose: Pose, beside: Beside) -> ControlFlow<()> {
        let beside_wall = beside.wall;
        self.side = beside.side.or(self.side);
        self.driven += pose.distance_to(self.last.position());
        self.turned += angle_difference(pose.heading, self.last.heading);
        self.last = pose;
        let Some((begin, since)) = self.begin else {
            if beside_wall {
                self.begin = Some((pose, self.driven));
            }
            return ControlFlow::Continue(());
        };
        let way = self.driven - since;
        if way < SETTLING {
            // The lap begins once the robot has been beside the wall for a while.
            self.begin = beside_wall.then_some((pose, since));
            (self.away, self.turned) = (false, 0.0);
            return ControlFlow::Continue(());
        }
        self.measure(pose);
        let (near, alike) = LAP;
        let is_near = pose.distance_to(begin.position()) < near;
        self.away |= !is_near;
        let back = is_near && angle_difference(pose.heading, begin.heading).abs() < alike;
        if back && self.away && self.turned.abs() > PI {
            (self.away, self.turned) = (false, 0.0);
            self.laps += 1;
            self.lap_length.get_or_insert(way - SETTLING);
            self.begin = Some((begin, self.driven - SETTLING));
        }
        if self.laps >= self.wanted { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn measure(&mut self, pose: Pose) {
        let turn = if self.side == Some(WallSide::Right) { -FRAC_PI_2 } else { FRAC_PI_2 };
        let eye = Pose { heading: pose.heading + turn, ..pose };
        self.space.scan(&mut self.scanner, &eye, None, &mut self.ranges);
        let nearest = self.ranges.iter().copied().fold(FARTHEST * self.distance, f64::min);
        let error = nearest - self.distance;
        self.everywhere.add(error);
        if self.corners.iter().any(|corner| pose.distance_to(corner.place) < corner.reach) {
            return;
        }
        if error.abs() > self.away_from_corners.worst {
            self.worst_place = Some(pose);
        }
        self.away_from_corners.add(error);
    }
}
