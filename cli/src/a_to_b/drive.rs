use roverlab::drive::{AToB, AToBOutcome, AToBParameters, Goal, Method, Path};
use roverlab::geometry::Point;
use roverlab::io::{self, Clock, Drive, Lidar, LidarScan, Manoeuvres, Odometry, StallDetector, control};
use roverlab::kinematics::{Differential, OdometryErrors, OdometryUncertainty};
use roverlab::scan::{Landmark, LandmarkFilter};

/// Where to drive, and how. All places are in the frame of odometry.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    pub(crate) method: Method,
    pub(crate) goal: Goal,
    /// Places to pass on the way.
    pub(crate) via: Vec<Point>,
    pub(crate) parameters: AToBParameters,
    /// Seconds.
    pub(crate) time_limit: f64,
    pub(crate) drive: Differential,
    pub(crate) errors: OdometryErrors,
    /// Poles that correct odometry; none for odometry alone.
    pub(crate) landmarks: Vec<Landmark>,
    /// The standard deviation of a lidar's beam, in metres.
    pub(crate) range_error: f64,
}

impl Options {
    pub(crate) fn behaviour(&self) -> io::Result<AToB> {
        AToB::new(self.method, self.goal, self.parameters)?.via(self.via.clone())
    }
}

/// How a drive ended, as the robot takes it.
#[derive(Debug, Clone)]
pub(crate) struct Arrival {
    pub(crate) outcome: AToBOutcome,
    /// The path that was planned; a dog curve has none.
    pub(crate) plan: Option<Path>,
    /// Odometry at the end, with what may be wrong about it.
    pub(crate) odometry: OdometryUncertainty,
    /// Scans that showed a landmark.
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
