//! Shared by the commands on hills: the world with a robot, and the ground truth of a run.

use std::sync::Arc;

use roverlab::geometry::{Point, Pose, units};
use roverlab::io::{Mishap, TruthInSpace};
use roverlab::nav::elevation::{Climber, ElevationMap};
use roverlab::world::generate::Relief;
use roverlab::world::{DriveSpec, HeightField, RobotSpec, Scene, World};

use crate::common::{CommonArgs, Failure, StandIn, rounded};
use crate::driving::Run;

/// A robot on hills.
#[derive(Debug, Clone)]
pub(crate) struct Hike {
    pub(crate) scene: Scene,
    pub(crate) ground: Arc<HeightField>,
}

impl Hike {
    /// The scene of the options, or the command's own. If the world has no robot, one of this kind drives.
    pub(crate) fn of(
        common: &CommonArgs,
        spec: &RobotSpec,
        own: impl FnOnce() -> Scene,
    ) -> Result<Self, Failure> {
        let stand_in = StandIn { spec: Arc::new(spec.clone()), suits: |_| true };
        let scene = common.placed_of(&stand_in, own)?;
        if matches!(scene.robots[0].spec.drive, DriveSpec::Craft(_)) {
            let robot = &scene.robots[0].spec.name;
            return Err(Failure::input(format!(
                "found `{robot}`, a craft; expected a robot that drives on land"
            )));
        }
        let surface = scene.world.terrain.as_ref().and_then(|terrain| terrain.surface.clone());
        let name = common.world.as_ref().map_or(String::new(), |file| format!("{}: ", file.display()));
        let Some(ground) = surface else {
            let line = "`terrain WIDTH HEIGHT TOP FILE`";
            return Err(Failure::input(format!("{name}found a world without hills; expected a line {line}")));
        };
        if ground.height(scene.robots[0].pose.position()).is_none() {
            return Err(Failure::input(format!(
                "{name}found a start beyond the hills; expected one on them"
            )));
        }
        Ok(Self { scene, ground })
    }

    /// Generated hills with a robot on them.
    pub(crate) fn generated(made: Relief, spec: RobotSpec) -> Self {
        let scene = Scene::with_robot(made.world, spec, made.start);
        let surface = scene.world.terrain.as_ref().and_then(|terrain| terrain.surface.clone());
        Self { ground: surface.expect("generated hills have a surface"), scene }
    }

    pub(crate) fn spec(&self) -> &RobotSpec {
        &self.scene.robots[0].spec
    }

    pub(crate) fn start(&self) -> Pose {
        self.scene.robots[0].pose
    }

    /// The elevation of the start.
    pub(crate) fn start_height(&self) -> f64 {
        self.ground.height(self.start().position()).unwrap_or(0.0)
    }

    /// Refuses a start in water or over the border.
    pub(crate) fn require_dry_ground(&self) -> Result<(), Failure> {
        let start = self.start().position();
        let inside = self.ground.area().inflated(-self.spec().footprint.bounding_radius());
        let is_wet = shore(&self.scene.world).is_some_and(|shore| self.start_height() < shore);
        if is_wet || !inside.contains(start) { Err(unfit(start)) } else { Ok(()) }
    }

    /// The map for a climber.
    pub(crate) fn map(&self, climber: &Climber) -> Result<ElevationMap, Failure> {
        elevation_map(&self.scene.world, &self.ground, climber)
    }
}

/// Refuses a robot that does not know how it is turned.
pub(crate) fn require_attitude(spec: &RobotSpec) -> Result<(), Failure> {
    let has_attitude = spec.inertial.attitude.is_some();
    let name = &spec.name;
    has_attitude.then_some(()).ok_or_else(|| {
        Failure::input(format!(
            "found `{name}`, without an inertial unit; expected a robot with a line `inertial`"
        ))
    })
}

/// Elevation above the water that robots keep (m).
const SHORE: f64 = 0.02;

/// The elevation below which robots do not drive (m), in a world with water.
pub(crate) fn shore(world: &World) -> Option<f64> {
    world.water_level.map(|water| water + SHORE)
}

/// The map of a world's ground for a climber; what is under water or at a wall is closed.
pub(crate) fn elevation_map(
    world: &World,
    ground: &HeightField,
    climber: &Climber,
) -> Result<ElevationMap, Failure> {
    let map = ElevationMap::new(ground, climber);
    map.and_then(|map| map.above(shore(world).unwrap_or(f64::NEG_INFINITY)))
        .and_then(|map| map.clear_of(world))
        .map_err(Failure::input)
}

/// The failure for a start on which a robot cannot stand.
pub(crate) fn unfit(start: Point) -> Failure {
    let [x, y] = [start.x, start.y].map(|metres| rounded(1000.0 * metres));
    Failure::input(format!(
        "found a start at {x}, {y} mm: too steep, in water, or too near to a wall or the border; \
         expected gentle ground"
    ))
}

/// Ground truth of a run on hills.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ride {
    pub(crate) end: TruthInSpace,
    /// Angle (rad).
    pub(crate) max_tilt: f64,
    /// Slip: motion of the robot that its wheels did not report (fraction of the distance by the wheels);
    /// `None` if they hardly moved.
    pub(crate) slip: Option<f64>,
}

/// Distance by the wheels from which slip is told (m).
const MOVED: f64 = 0.05;

impl Ride {
    pub(crate) fn of<T>(run: &Run<T>) -> Option<Self> {
        let end = *run.in_space.last()?;
        let max_tilt = run.in_space.iter().map(|space| space.pose.tilt()).fold(0.0, f64::max);
        let wheels: Vec<_> = run.odometry_path.iter().skip(1).map(|(_, place)| *place).collect();
        let (mut slid, mut driven) = (0.0, 0.0);
        for (true_pair, wheel_pair) in run.in_space.windows(2).zip(wheels.windows(2)) {
            let moved = (true_pair[1].pose.position - true_pair[0].pose.position).norm();
            let turned = (wheel_pair[1] - wheel_pair[0]).norm();
            slid += (moved - turned).abs();
            driven += turned;
        }
        Some(Self { end, max_tilt, slip: (driven > MOVED).then(|| slid / driven) })
    }

    pub(crate) fn height(&self) -> f64 {
        self.end.pose.position.z
    }
}

/// A mishap's name in outcomes.
pub(crate) fn word(mishap: Mishap) -> &'static str {
    match mishap {
        Mishap::Tipped => "tipped",
        Mishap::Fell => "fell",
        Mishap::Drowned => "drowned",
        _ => "stuck",
    }
}

/// An angle in fields.
pub(crate) fn degrees(radians: f64) -> f64 {
    (units::to_deg(radians) * 100.0).round() / 100.0
}

/// A fraction in fields.
pub(crate) fn percent(share: f64) -> f64 {
    rounded((share * 10_000.0).round() / 100.0)
}

/// Median; 0 of no numbers.
pub(crate) fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(0.0)
}
