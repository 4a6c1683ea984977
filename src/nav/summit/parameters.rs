use crate::ParameterError;
use crate::geometry::{Aabb, Point, Pose, Pose3};
use crate::kinematics::Tracked;
use crate::nav::elevation::Climber;
use crate::parameter::{require, require_finite, require_not_negative, require_positive};
use crate::world::{DriveSpec, RobotSpec};

/// Parameters of a [`SummitSearch`](super::SummitSearch).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SummitParameters {
    /// Slopes and steps that the robot can drive over.
    pub climber: Climber,
    /// Mounting pose of the lidar.
    pub lidar: Pose3,
    /// Downhill slip in a turn on the spot, per radian and per unit of slope (m); 0 for wheels.
    pub slide: f64,
    /// Half the distance between the wheels of the differential drive that belts are like (m); 0 for wheels,
    /// which do not slip in turns.
    pub half_track: f64,
    /// Driving speed (m/s).
    pub speed: f64,
    /// Maximum turn rate (rad/s).
    pub turn_rate: f64,
    /// Distance between two looks around (m).
    pub stride: f64,
    /// Cell size of the map (m).
    pub resolution: f64,
    /// Reach of the map and of the search from the start, along both axes (m).
    pub extent: f64,
    /// Minimum gain in height that is worth a drive (m).
    pub tolerance: f64,
    /// Elevation relative to the start below which the robot does not drive, such as a water level (m).
    pub lowest: Option<f64>,
    /// Area that the robot does not leave, if any.
    pub fence: Option<Fence>,
    /// Control period (s).
    pub period: f64,
}

/// Axis-aligned area of a world, and the robot's start in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fence {
    /// The area in world coordinates.
    pub area: Aabb,
    /// The robot's start in world coordinates.
    pub start: Pose,
}

impl Fence {
    /// Whether a place, as the robot counts, is inside.
    pub fn holds(&self, place: Point) -> bool {
        self.area.contains(self.start.to_world(place))
    }
}

/// Distance that the robot keeps from drops and faces, beside its own size (m).
pub(super) const CAUTION: f64 = 0.05;
/// The most cells of a map along an axis.
const MOST_CELLS: f64 = 2000.0;

impl SummitParameters {
    /// Parameters for a robot; `None` without a lidar.
    pub fn of(spec: &RobotSpec) -> Option<Self> {
        let mount = spec.lidar?.mount;
        let (slide, half_track) = match spec.drive {
            DriveSpec::Tracked { track, length, width, .. } => {
                let belts = Tracked { track, length, width };
                (belts.downhill_drift() / spec.friction.max(0.1), 0.5 * belts.equivalent().track)
            }
            _ => (0.0, 0.0),
        };
        Some(Self {
            climber: Climber::of(spec),
            lidar: mount.frame(),
            slide,
            half_track,
            speed: 0.15_f64.min(0.5 * spec.drive.top_speed()),
            turn_rate: 0.8,
            stride: 0.8,
            resolution: 0.05,
            extent: 7.0,
            tolerance: 0.004,
            lowest: None,
            fence: None,
            period: 0.05,
        })
    }

    /// Whether a robot that knows its place to within a doubt (m), and drives to within half a cell, keeps
    /// away from the fence there.
    pub(super) fn holds(&self, place: Point, doubt: f64) -> bool {
        let margin = self.climber.radius + doubt.max(0.5 * self.resolution);
        let inside = |fence: Fence| Fence { area: fence.area.inflated(-margin), ..fence }.holds(place);
        self.fence.is_none_or(inside)
    }

    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.climber.validate()?;
        let slope = self.climber.slope;
        require("slope", slope, slope < 1.4, "less than 1.4 rad")?;
        let at = self.lidar.position;
        require("lidar height", at.z, self.lidar.is_finite() && at.z > 0.0, "more than 0")?;
        require_not_negative("slide", self.slide)?;
        require_not_negative("half track", self.half_track)?;
        require_positive("speed", self.speed)?;
        require_positive("turn rate", self.turn_rate)?;
        require_positive("stride", self.stride)?;
        require_positive("resolution", self.resolution)?;
        require_positive("tolerance", self.tolerance)?;
        require_positive("control period", self.period)?;
        require_positive("extent", self.extent)?;
        let cells = 2.0 * self.extent / self.resolution;
        let good = (8.0..=MOST_CELLS).contains(&cells);
        require("extent", self.extent, good, "4 to 1000 times the resolution")?;
        if let Some(Fence { area, start }) = self.fence {
            let size = area.size();
            for (name, side) in [("fence along x", size.x), ("fence along y", size.y)] {
                require_positive(name, side)?;
            }
            require("start in the fence", start.x, start.is_finite(), "a finite pose")?;
        }
        require_finite("lowest elevation", self.lowest.unwrap_or(0.0))
    }
}
