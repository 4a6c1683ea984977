use roverlab::drive::{RandomDrive, RandomDriveParameters};
use roverlab::geometry::Pose;
use roverlab::io::control::{self, Halt, until};
use roverlab::io::{self, Clock, DistanceSensors, Drive, Lidar, LidarScan, Odometry};
use roverlab::random::Stream;
use roverlab::scan::{Hypothesis, Localisation, LocalisationMap, Localiser, LocaliserParameters};

/// Driving options.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    pub(crate) map: LocalisationMap,
    pub(crate) localiser: LocaliserParameters,
    pub(crate) random: RandomDriveParameters,
    pub(crate) seed: u64,
    /// Time for which it drives while there are several places (s).
    pub(crate) patience: f64,
}

/// Result of the localisation.
#[derive(Debug, Clone)]
pub(crate) struct Finding {
    pub(crate) localisation: Localisation,
    /// Whether one place explained enough scans, before the time was over.
    pub(crate) settled: bool,
    pub(crate) hypotheses: Vec<Hypothesis>,
    /// Number of scans used.
    pub(crate) scans: u32,
    /// Last scan.
    pub(crate) scan: LidarScan,
    /// Hypotheses after each scan, with their times.
    pub(crate) history: Vec<(f64, Vec<Pose>)>,
}

/// Number of consecutive scans with one place after which the robot stops.
const CONTENT: u32 = 12;
/// Number of steps between matched scans.
const EVERY: u32 = 4;
/// Time for coming to rest (s).
const REST: f64 = 1.0;

/// Drives about until one place explains all scans, or the time is over. `watch` is called after each step.
pub(crate) fn drive<R: Clock + Drive + Odometry + DistanceSensors + Lidar + ?Sized>(
    robot: &mut R,
    options: &Options,
    mut watch: impl FnMut(),
) -> io::Result<Finding> {
    let mut localiser = Localiser::new(options.map.clone(), options.localiser)?;
    let mut wander = RandomDrive::new(options.random, Stream::new(options.seed).child("random drive", 0))?;
    let (mut content, mut scans, mut steps) = (0, 0, 0_u32);
    let mut history = Vec::new();
    let poses = |localiser: &Localiser| localiser.hypotheses().iter().map(|place| place.pose).collect();
    let halt = control::run(robot, &mut wander, options.patience, |_, _, at| {
        if steps.is_multiple_of(EVERY) {
            localiser.update(at.seen.pose, &at.seen.scan)?;
            scans += 1;
            history.push((at.time, poses(&localiser)));
            let one = matches!(localiser.localisation(), Localisation::One(_));
            content = if one { content + 1 } else { 0 };
        }
        steps += 1;
        watch();
        io::Result::Ok(until(content >= CONTENT))
    })?;
    // The last scan is taken at rest, so that its pose is the robot's.
    robot.wait(REST)?;
    let scan = robot.scan()?;
    localiser.update(robot.pose()?, &scan)?;
    watch();
    Ok(Finding {
        localisation: localiser.localisation(),
        settled: halt == Halt::Stopped,
        hypotheses: localiser.hypotheses().to_vec(),
        scans: scans + 1,
        scan,
        history,
    })
}
