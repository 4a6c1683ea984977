use std::ops::ControlFlow;

use super::{LaneObservation, LaneOutcome};
use crate::ParameterError;
use crate::geometry::{Pose, Twist, angle_difference, math};
use crate::io::control::{Behaviour, Decision, Senses};
use crate::io::{self, Camera, Odometry, Resolution};
use crate::parameter::require_positive;
use crate::vision::lane_markings::{LaneEstimate, LaneMarkingFinder, RoadCamera, RoadModel};
use crate::vision::{GrayView, GrayViewMut, GrayWeights, ImageError, RgbView, gray_into};

/// Parameters of a [`LaneKeeper`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneKeeperParameters {
    /// Control period, one image each (s).
    pub period: f64,
    /// Maximum speed (m/s).
    pub speed: f64,
    /// Maximum lateral acceleration in bends (m/s²).
    pub across: f64,
    /// Deceleration before bends (m/s²).
    pub brake: f64,
    /// Distance in which an offset is corrected: at standstill (m), and in addition per speed (m per m/s).
    pub settling: [f64; 2],
    /// Time from a command to its effect (s).
    pub delay: f64,
    /// Maximum distance of the road ahead that counts (m).
    pub sight: f64,
}

impl Default for LaneKeeperParameters {
    /// For a model car at a scale of 1:10 with a camera of 30 images per second.
    fn default() -> Self {
        Self {
            period: 1.0 / 30.0,
            speed: 2.6,
            across: 3.6,
            brake: 2.0,
            settling: [0.25, 0.16],
            delay: 0.06,
            sight: 1.8,
        }
    }
}

impl LaneKeeperParameters {
    fn validate(&self) -> Result<(), ParameterError> {
        require_positive("control period", self.period)?;
        require_positive("speed", self.speed)?;
        require_positive("acceleration across", self.across)?;
        require_positive("brake", self.brake)?;
        require_positive("settling", self.settling[0])?;
        crate::parameter::require_not_negative("settling by speed", self.settling[1])?;
        crate::parameter::require_not_negative("delay", self.delay)?;
        require_positive("sight", self.sight)
    }
}

/// Path and speed that a planner asks of a [`LaneKeeper`].
#[derive(Debug, Clone, Copy)]
pub(in crate::drive) struct Guide {
    /// Distance to the left of the lane's centre (m), its slope, and its second derivative (1/m) where the
    /// car is when the command takes effect.
    pub(in crate::drive) path: [f64; 3],
    /// Maximum speed (m/s).
    pub(in crate::drive) speed: f64,
}

/// Keeps a car, or a two-wheeled robot, in the centre of its lane by camera and odometry. If the lane is
/// lost, it stops and continues to look.
#[derive(Debug, Clone)]
pub struct LaneKeeper {
    parameters: LaneKeeperParameters,
    finder: LaneMarkingFinder,
    gray: Vec<u8>,
    /// Odometry at the last image, and the distance driven to it since the one before (m).
    before: Option<Pose>,
    driven: f64,
    lane: Option<LaneEstimate>,
}

/// Spacing of the places ahead at which curvature is examined (m).
const STRIDE: f64 = 0.1;
/// Speed where hardly anything of the road is known (m/s).
const CREEP: f64 = 0.3;

impl LaneKeeper {
    /// Creates a keeper for a camera and a road. Fails for parameters out of range.
    pub fn new(
        camera: RoadCamera,
        road: RoadModel,
        parameters: LaneKeeperParameters,
    ) -> Result<Self, ParameterError> {
        parameters.validate()?;
        let finder = LaneMarkingFinder::new(camera, road)?;
        Ok(Self { parameters, finder, gray: Vec::new(), before: None, driven: 0.0, lane: None })
    }

    /// The lane as estimated in the last step.
    pub fn lane(&self) -> Option<&LaneEstimate> {
        self.lane.as_ref()
    }

    /// The finder, with the points of the last image.
    pub fn finder(&self) -> &LaneMarkingFinder {
        &self.finder
    }

    /// Discards the road, for a car that has been moved.
    pub fn forget(&mut self) {
        self.finder.forget();
        self.before = None;
    }

    /// Expects a straight lane where odometry says that it is, with the car at a pose relative to its centre
    /// at the last image, on a road with its edge lines at a distance from its centre line (m).
    pub(in crate::drive) fn expect(&mut self, pose: &Pose, edge: f64) {
        self.finder.expect(pose.y, pose.heading, edge);
    }

    /// Odometry at the last image.
    pub(in crate::drive) fn odometry(&self) -> Option<Pose> {
        self.before
    }

    /// Processes an image taken at an odometry pose.
    ///
    /// # Errors
    ///
    /// If the image is empty.
    pub fn see(&mut self, image: &image::RgbImage, odometry: Pose) -> Result<&LaneEstimate, ImageError> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        self.gray.resize(width * height, 0);
        let rgb = RgbView::new(image.as_raw(), width, height)?;
        gray_into(rgb, GrayViewMut::new(&mut self.gray, width, height)?, GrayWeights::default())?;
        let driven = self.before.map_or((0.0, 0.0), |before| {
            let turn = angle_difference(odometry.heading, before.heading);
            (before.to_local(odometry.position()).x, turn)
        });
        self.before = Some(odometry);
        self.driven = driven.0;
        let lane = self.finder.see(GrayView::new(&self.gray, width, height)?, driven);
        Ok(self.lane.insert(lane))
    }

    /// Distance driven between the last two images (m).
    pub(in crate::drive) fn driven(&self) -> f64 {
        self.driven
    }

    /// The last image, of a width (pixels), in grey.
    pub(in crate::drive) fn gray(&self, width: u32) -> Result<GrayView<'_>, ImageError> {
        let width = width as usize;
        GrayView::new(&self.gray, width, self.gray.len() / width.max(1))
    }

    /// The command for the estimated lane at a speed.
    fn steer(&self, lane: &LaneEstimate, speed: f64) -> Twist {
        self.steer_by(lane, speed, &Guide { path: [0.0; 3], speed: self.parameters.speed })
    }

    /// The command that follows a path beside the lane's centre.
    pub(in crate::drive) fn steer_by(&self, lane: &LaneEstimate, speed: f64, guide: &Guide) -> Twist {
        let p = &self.parameters;
        if lane.lost {
            return Twist::STOP;
        }
        let wanted = self.fastest(lane, speed, guide.speed);
        // Pose of the car when the command takes effect.
        let ahead = (p.delay * speed).max(0.0);
        let settling = p.settling[0] + p.settling[1] * speed.max(0.0);
        let [beside, slope, bend] = guide.path;
        let offset = lane.offset + ahead * math::sin(lane.heading) - beside;
        let heading = lane.heading - math::atan(slope);
        let back = offset.clamp(-0.3, 0.3) / (settling * settling) + 2.0 * math::sin(heading) / settling;
        let bend = lane.curvature_at(ahead) + bend - back;
        Twist::new(wanted, wanted * bend)
    }

    /// Maximum speed up to a limit for the bends ahead and the visible distance.
    fn fastest(&self, lane: &LaneEstimate, speed: f64, limit: f64) -> f64 {
        let p = &self.parameters;
        let mut most = limit;
        for i in 0..(p.sight / STRIDE) as u32 {
            let ahead = STRIDE * f64::from(i);
            let bend = lane.curvature_at(ahead).abs().max(1e-6);
            let free = (ahead - p.delay * speed).max(0.0);
            most = most.min((p.across / bend + 2.0 * p.brake * free).sqrt());
        }
        // Drive slowly where the lane is extrapolated.
        let doubt = lane.sigmas[0] / 0.03 + lane.sigmas[1] / 0.08;
        (most / (1.0 + doubt * doubt)).max(CREEP.min(limit))
    }
}

impl Behaviour for LaneKeeper {
    type Observation = LaneObservation;
    type Command = Twist;
    type Outcome = LaneOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &LaneObservation) -> Decision<Self> {
        seen.check()?;
        let lane = self.see(&seen.image, seen.odometry).map_err(io::Error::caused_by)?.clone();
        Ok(ControlFlow::Continue(self.steer(&lane, seen.speed)))
    }
}

impl<R: Camera + Odometry + ?Sized> Senses<R> for LaneKeeper {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(Resolution::Qvga)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LaneObservation) -> io::Result<()> {
        seen.read(robot)
    }
}
