use super::limits::{Repertoire, RunLimits};
use super::plan::{FastPlan, Piece};
use super::profile;
use super::shape::Shape;
use crate::ParameterError;
use crate::geometry::{Pose, Twist};
use crate::maze::Scale;

/// Desired pose and velocity at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrajectoryPoint {
    /// Pose.
    pub pose: Pose,
    /// Velocity.
    pub twist: Twist,
}

/// A fast run as a function of time. Position, heading, speed and curvature are continuous.
///
/// ```
/// use roverlab::maze::{FastPlanner, Maze, RunLimits, Scale, Trajectory, Unknown, files};
/// let maze: Maze = files::parse(b"o---o---o\n| S   G |\no---o---o\n", "two cells")?.maze;
/// let (scale, limits) = (Scale::MICROMOUSE, RunLimits::MICROMOUSE);
/// let plan = FastPlanner::new(scale, limits)?.plan(&maze, Unknown::Closed).expect("a way");
/// let trajectory = Trajectory::new(&plan, scale, limits)?;
/// assert!((trajectory.duration() - plan.time).abs() < 1e-9);
/// assert_eq!(trajectory.at(trajectory.duration() + 1.0).twist, Default::default(), "at rest at the end");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    segments: Vec<Segment>,
    end: Pose,
}

#[derive(Debug, Clone, PartialEq)]
struct Segment {
    /// Start time and duration (s).
    begin: f64,
    time: f64,
    start: Pose,
    motion: Motion,
}

#[derive(Debug, Clone, PartialEq)]
enum Motion {
    /// Straight ahead with constant acceleration.
    Straight { speed: f64, acceleration: f64 },
    /// On the spot with constant angular acceleration.
    Pivot { speed: f64, acceleration: f64 },
    /// Along a curve at constant speed, to the left or mirrored.
    Curve { shape: Shape, speed: f64, left: bool },
}

impl Motion {
    /// Pose relative to its start, and velocity, at a time.
    fn at(&self, time: f64) -> (Pose, Twist) {
        match self {
            &Self::Straight { speed, acceleration } => {
                let way = (speed + 0.5 * acceleration * time) * time;
                (Pose::new(way, 0.0, 0.0), Twist::new(speed + acceleration * time, 0.0))
            }
            &Self::Pivot { speed, acceleration } => {
                let angle = (speed + 0.5 * acceleration * time) * time;
                (Pose::new(0.0, 0.0, angle), Twist::new(0.0, speed + acceleration * time))
            }
            Self::Curve { shape, speed, left } => {
                let (way, side) = (speed * time, if *left { 1.0 } else { -1.0 });
                let pose = shape.pose_at(way);
                let twist = Twist::new(*speed, side * speed * shape.curvature_at(way));
                (Pose::new(pose.x, side * pose.y, side * pose.heading), twist)
            }
        }
    }
}

impl Trajectory {
    /// The trajectory of a plan. Scale and limits must be those of the planner.
    ///
    /// # Errors
    ///
    /// If a limit or the cell size is out of range.
    pub fn new(plan: &FastPlan, scale: Scale, limits: RunLimits) -> Result<Self, ParameterError> {
        let repertoire = Repertoire::new(scale, limits)?;
        let mut trajectory = Self { segments: Vec::new(), end: plan.start };
        for piece in &plan.pieces {
            trajectory.append(piece, &repertoire);
        }
        Ok(trajectory)
    }

    /// A turn on the spot from rest to rest, as fast as the limits allow.
    pub fn pivot(start: Pose, angle: f64, limits: &RunLimits) -> Self {
        let mut trajectory = Self { segments: Vec::new(), end: start };
        trajectory.append_pivot(angle, limits);
        trajectory
    }

    fn append(&mut self, piece: &Piece, repertoire: &Repertoire) {
        match *piece {
            Piece::Pivot { angle } => self.append_pivot(angle, &repertoire.limits),
            Piece::Straight { length, entry, exit, diagonal } => {
                let top = repertoire.top_speed(diagonal);
                self.append_straight(length, (entry, exit), top, repertoire.limits.acceleration);
            }
            Piece::Turn { kind, left } => {
                let turn = repertoire.turn(kind);
                let motion = Motion::Curve { shape: turn.shape.clone(), speed: turn.speed, left };
                self.push(turn.time, motion);
            }
        }
        self.straighten();
    }

    fn append_pivot(&mut self, angle: f64, limits: &RunLimits) {
        let sign = angle.signum();
        let phases = profile::phases(angle.abs(), 0.0, 0.0, limits.pivot_speed, limits.angular_acceleration);
        for phase in phases {
            let motion = Motion::Pivot { speed: sign * phase.speed, acceleration: sign * phase.acceleration };
            self.push(phase.time, motion);
        }
    }

    fn append_straight(&mut self, length: f64, (entry, exit): (f64, f64), top: f64, acceleration: f64) {
        for phase in profile::phases(length, entry, exit, top, acceleration) {
            let motion = Motion::Straight { speed: phase.speed, acceleration: phase.acceleration };
            self.push(phase.time, motion);
        }
    }

    fn push(&mut self, time: f64, motion: Motion) {
        if time > 0.0 {
            let (begin, start) = (self.duration(), self.end);
            self.end = start.compose(&motion.at(time).0);
            self.segments.push(Segment { begin, time, start, motion });
        }
    }

    /// Rounds the heading at the end of a piece to a multiple of 45 degrees, so that errors do not
    /// accumulate.
    fn straighten(&mut self) {
        let eighth = std::f64::consts::FRAC_PI_4;
        self.end.heading = (self.end.heading / eighth).round() * eighth;
    }

    /// Duration (s).
    pub fn duration(&self) -> f64 {
        self.segments.last().map_or(0.0, |last| last.begin + last.time)
    }

    /// End pose.
    pub fn end(&self) -> Pose {
        self.end
    }

    /// Desired state at a time (s); at rest before the start and after the end.
    pub fn at(&self, time: f64) -> TrajectoryPoint {
        let index = self.segments.partition_point(|segment| segment.begin + segment.time <= time);
        let rest = |pose| TrajectoryPoint { pose, twist: Twist::STOP };
        match self.segments.get(index) {
            None => rest(self.end),
            Some(segment) if time < segment.begin => rest(segment.start),
            Some(segment) => {
                let (pose, twist) = segment.motion.at(time - segment.begin);
                TrajectoryPoint { pose: segment.start.compose(&pose), twist }
            }
        }
    }

    /// Path length (m).
    pub fn length(&self) -> f64 {
        let lengths = self.segments.iter().map(|segment| match &segment.motion {
            Motion::Straight { speed, acceleration } => {
                (speed + 0.5 * acceleration * segment.time) * segment.time
            }
            Motion::Pivot { .. } => 0.0,
            Motion::Curve { shape, .. } => shape.length,
        });
        lengths.sum()
    }
}
