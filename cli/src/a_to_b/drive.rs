use roverlab::drive::{AToB, AToBOutcome, AToBParameters, Goal, Method, Path};
use roverlab::geometry::Point;
use roverlab::io::{self, Clock, Drive, Lidar, LidarScan, Manoeuvres, Odometry, StallDetector, control};
use roverlab::kinematics::{Differential, OdometryErrors, OdometryUncertainty};
use roverlab::scan::{Landmark, LandmarkFilter};

/// Goal and method, in the odometry frame.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    pub(crate) method: Method,
    pub(crate) goal: Goal,
    /// Waypoints.
    pub(crate) via: Vec<Point>,
    pub(crate) parameters: AToBParameters,
    /// Time limit (s).
    pub(crate) time_limit: f64,
    pub(crate) drive: Differential,
    pub(crate) errors: OdometryErrors,
    /// Poles that correct odometry, if any.
    pub(crate) landmarks: Vec<Landmark>,
    /// Standard deviation of a lidar beam (m).
    pub(crate) range_error: f64,
}

impl Options {
    pub(crate) fn behaviour(&self) -> io::Result<AToB> {
        AToB::new(self.method, self.goal, self.parameters)?.via(self.via.clone())
    }
}

/// Outcome of a drive from the robot's perspective.
#[derive(Debug, Clone)]
pub(crate) struct Arrival {
    pub(crate) outcome: AToBOutcome,
    /// The planned path; `None` for a dog curve.
    pub(crate) plan: Option<Path>,
    /// Odometry at the end, with its uncertainty.
    pub(crate) odometry: OdometryUncertainty,
    /// Number of scans that showed a landmark.
    pub(crate) sightings: u32,
}

/// Drives a robot to a goal. `watch` is called after each step.
pub(crate) fn drive<R: Clock + Drive + Odometry + Manoeuvres + StallDetector + Lidar + ?Sized>(
    robot: &mut R,
    options: &Options,
    mut watch: impl FnMut(),
) -> io::Result<Arrival> {
    let mut behaviour = options.behaviour()?;
    let start = robot.pose()?;
    let plan = behaviour.plan(start)?;
    let mut odometry = OdometryUncertainty::new(start, options.drive, options.errors);
    let mut filter = LandmarkFilter::new(
        start,
        start,
        options.landmarks.clone(),
        options.drive,
        options.errors,
        options.range_error,
    )?;
    let (mut scan, mut sightings) = (LidarScan::default(), 0);
    let estimate = |robot: &mut R| {
        let pose = robot.pose()?;
        odometry.advance_to(pose);
        if options.landmarks.is_empty() {
            return Ok(pose);
        }
        filter.predict(pose);
        robot.scan_into(&mut scan)?;
        sightings += u32::from(filter.correct(&scan) > 0);
        Ok(filter.pose())
    };
    let outcome = control::run(robot, &mut behaviour.by(estimate), options.time_limit, |_, _, _| watch())?;
    Ok(Arrival { outcome, plan, odometry, sightings })
}
