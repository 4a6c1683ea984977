use std::f64::consts::TAU;
use std::sync::Arc;

use roverlab::geometry::{Aabb, Point, Pose, units};
use roverlab::world::formats::{FormatError, Parsed};
use roverlab::world::space::{Solid, Span};
use roverlab::world::{DriveSpec, RobotPlacement, RobotSpec, Scene};

use super::free_floor::space_with;
use super::{CommonArgs, Failure};

/// A robot in a scene with a place to go: the first robot is the one that drives, the others stand.
#[derive(Debug, Clone)]
pub(crate) struct Trip {
    pub(crate) scene: Scene,
    /// The goal, in the world.
    pub(crate) goal: Point,
}

/// Distance from the robot's start within which a marker marks that start (m).
const AT_START: f64 = 0.05;
/// Distance below which a robot is in contact (m).
const TOUCHING: f64 = 1e-3;

impl Trip {
    /// The driving robot.
    pub(crate) fn spec(&self) -> &RobotSpec {
        &self.scene.robots[0].spec
    }

    /// Its start, in the world.
    pub(crate) fn start(&self) -> Pose {
        self.scene.robots[0].pose
    }

    /// Straight distance from start to goal (m).
    pub(crate) fn distance(&self) -> f64 {
        self.start().distance_to(self.goal)
    }

    /// A generous time limit for finding the goal, or the lack of a way (s): time for several rounds along
    /// both sides of every wall and for the way itself, at least ten minutes.
    pub(crate) fn generous_time_limit(&self) -> f64 {
        let walls: f64 = self.scene.world.walls.iter().map(|wall| wall.line.length()).sum();
        let objects: f64 =
            self.scene.world.objects.iter().map(|object| 4.0 * object.kind.shape.bounding_radius()).sum();
        (40.0 * (walls + objects) + 20.0 * self.distance()).ceil().clamp(600.0, 1e6)
    }
}

/// Distance from the goal up to which a robot that relies on odometry and says that it is there is right (m);
/// larger with noise.
pub(crate) fn at_goal(noise: f64) -> f64 {
    if noise == 0.0 { 0.050 } else { 0.250 }
}

/// Field of view from which a lidar counts as all-round (rad).
const ALL_ROUND: f64 = 0.999 * TAU;

/// Default robot, for a world without one or with an unsuitable one.
#[derive(Debug, Clone)]
pub(crate) struct StandIn {
    pub(crate) spec: Arc<RobotSpec>,
    /// Whether a robot suits the command.
    pub(crate) suits: fn(&RobotSpec) -> bool,
}

impl Default for StandIn {
    /// An S4; every robot is suitable.
    fn default() -> Self {
        Self { spec: Arc::new(RobotSpec::s4()), suits: |_| true }
    }
}

impl CommonArgs {
    /// The trip of the options: `--world`, otherwise `own`, with robot, start and goal from the options,
    /// otherwise from the world.
    ///
    /// A `.sim` provides its first robot, and its first marker away from the start; a `.maz` the letters S
    /// and G; a `.wld` its `position`.
    pub(crate) fn trip(&self, own: impl FnOnce() -> Scene) -> Result<Trip, Failure> {
        if self.goal.is_some_and(|goal| goal.heading.is_some()) {
            return Err(Failure::input(
                "--goal: found a heading; expected X,Y: here any heading at the goal is right",
            ));
        }
        self.trip_to_pose(own)
    }

    /// The same for a command that takes a heading at the goal, in `self.goal`.
    pub(crate) fn trip_to_pose(&self, own: impl FnOnce() -> Scene) -> Result<Trip, Failure> {
        self.trip_to_pose_of(&StandIn::default(), own)
    }

    /// The same for a command with requirements on the robot.
    pub(crate) fn trip_to_pose_of(
        &self,
        stand_in: &StandIn,
        own: impl FnOnce() -> Scene,
    ) -> Result<Trip, Failure> {
        let scene = self.placed_of(stand_in, own)?;
        let goal = self.destination(&scene)?;
        Ok(Trip { scene, goal })
    }

    /// The scene of the options, for a command without a goal: `--world`, otherwise `own`, with robot and
    /// start from the options, otherwise from the world.
    pub(crate) fn placed(&self, own: impl FnOnce() -> Scene) -> Result<Scene, Failure> {
        self.placed_of(&StandIn::default(), own)
    }

    /// The same for a command with requirements on the robot.
    pub(crate) fn placed_of(
        &self,
        stand_in: &StandIn,
        own: impl FnOnce() -> Scene,
    ) -> Result<Scene, Failure> {
        let scene = self.scene_or(own)?;
        self.placed_in(scene, stand_in)
    }

    /// The scene of the options, or the command's own, without what options say about its robot.
    pub(crate) fn scene_or(&self, own: impl FnOnce() -> Scene) -> Result<Scene, Failure> {
        match &self.world {
            Some(file) => self.load_scene("world", file).map_err(Failure::input),
            None => Ok(own()),
        }
    }

    /// A scene with robot and start from the options, otherwise from the scene.
    pub(crate) fn placed_in(&self, mut scene: Scene, stand_in: &StandIn) -> Result<Scene, Failure> {
        let mut robot = self.driver(&scene, stand_in)?;
        if let Some(file) = &self.robot {
            robot.spec = Arc::new(self.parsed(self.load_robot("robot", file))?);
        } else if !(stand_in.suits)(&robot.spec) {
            let (world, found, other) = (self.world_name(), &robot.spec.name, &stand_in.spec.name);
            self.warn(format_args!(
                "{world}: found robot {found}; expected another drive: {other} takes its place"
            ));
            robot.spec = Arc::clone(&stand_in.spec);
        }
        match scene.robots.first_mut() {
            Some(first) => *first = robot,
            None => scene.robots.push(robot),
        }
        self.check_start(&scene)?;
        Ok(scene)
    }

    /// The same; fails with a reason if the options give a goal.
    pub(crate) fn placed_without_goal(
        &self,
        why: &str,
        own: impl FnOnce() -> Scene,
    ) -> Result<Scene, Failure> {
        match self.goal {
            Some(_) => Err(Failure::input(format!("--goal: {why}; expected a command line without --goal"))),
            None => self.placed(own),
        }
    }

    /// Rejects a robot that cannot turn on the spot, or lacks an all-round lidar.
    pub(crate) fn check_turning_with_lidar(&self, spec: &RobotSpec) -> Result<(), Failure> {
        let found = match spec.lidar {
            _ if matches!(spec.drive, DriveSpec::Ackermann { .. }) => {
                ", a car; expected one that turns on the spot".to_owned()
            }
            None => " without a lidar; expected one with a lidar of 360 degrees".to_owned(),
            Some(lidar) if lidar.field_of_view < ALL_ROUND => format!(
                " with a lidar of {:.0} degrees; expected one of 360 degrees",
                units::to_deg(lidar.field_of_view)
            ),
            Some(_) => return Ok(()),
        };
        let file = self.robot.as_ref().or(self.world.as_ref());
        let place = file.map_or(String::new(), |file| format!("{}: ", file.display()));
        Err(Failure::input(format!("{place}found robot {}{found}", spec.name)))
    }

    /// Name of the world in messages.
    fn world_name(&self) -> String {
        self.world.as_deref().map_or("the command's own world".into(), |file| file.display().to_string())
    }

    /// The content of a file; records its warnings.
    fn parsed<T>(&self, parsed: Result<Parsed<T>, FormatError>) -> Result<T, Failure> {
        let parsed = parsed.map_err(Failure::input)?;
        for warning in &parsed.warnings {
            self.warn(warning);
        }
        Ok(parsed.value)
    }

    /// The driving robot, at its start.
    fn driver(&self, scene: &Scene, stand_in: &StandIn) -> Result<RobotPlacement, Failure> {
        let mut robot = match (scene.robots.first(), scene.world.start, self.start) {
            (Some(robot), ..) => robot.clone(),
            (None, Some(pose), _) | (None, None, Some(pose)) => {
                RobotPlacement::new(Arc::clone(&stand_in.spec), pose)
            }
            (None, None, None) => {
                return Err(Failure::input(format!(
                    "{}: found no start; expected --start X,Y,DEG, a robot in a .sim, `position` in a .wld or the \
                     letter S in a .maz",
                    self.world_name()
                )));
            }
        };
        robot.pose = self.start.unwrap_or(robot.pose);
        Ok(robot)
    }

    fn destination(&self, scene: &Scene) -> Result<Point, Failure> {
        // Scripts may also mark the start, before or after the goal.
        let start = scene.robots[0].pose;
        let places = || scene.world.markers.iter().map(|marker| marker.position);
        let marker = places().find(|&place| start.distance_to(place) > AT_START).or_else(|| places().next());
        let letter = scene.world.places.iter().find(|place| place.letter.eq_ignore_ascii_case(&'g'));
        self.goal.map(|goal| goal.position).or(marker).or(letter.map(|place| place.position)).ok_or_else(
            || {
                Failure::input(format!(
                    "{}: found no goal; expected --goal X,Y, a `marker` in a .sim or the letter G in a .maz",
                    self.world_name()
                ))
            },
        )
    }

    /// Where the start is from, in messages.
    fn start_name(&self) -> String {
        if self.start.is_some() { "--start".into() } else { self.world_name() }
    }

    fn check_start(&self, scene: &Scene) -> Result<(), Failure> {
        let (start, from) = (scene.robots[0].pose, self.start_name());
        let place = in_mm(start.position());
        if !scene.world.bounds().contains(start.position()) {
            return Err(Failure::input(format!(
                "{from}: found a start at {place} mm, outside of the world; expected one {}",
                within(&scene.world.bounds())
            )));
        }
        if scene.world.is_inside_walls(start.position()) || clearance(scene) <= TOUCHING {
            let radius = units::to_mm(scene.robots[0].spec.footprint.bounding_radius());
            return Err(Failure::input(format!(
                "{from}: found a start at {place} mm, in a wall, an object or another robot; expected free floor \
                 around it for a robot of {radius:.0} mm radius"
            )));
        }
        Ok(())
    }
}

fn in_mm(point: Point) -> String {
    let [x, y] = [point.x, point.y].map(|metres| units::to_mm(metres).round() + 0.0);
    format!("{x}, {y}")
}

pub(super) fn within(bounds: &Aabb) -> String {
    format!("from {} to {} mm", in_mm(bounds.min), in_mm(bounds.max))
}

/// Distance from the first robot's outline to the nearest wall, object or other robot (m); 0 in contact.
fn clearance(scene: &Scene) -> f64 {
    const NEAR: f64 = 0.1;
    let space = space_with(scene, &scene.robots[1..]);
    let solid = Solid::from(&scene.robots[0]);
    let span = Span { bottom: solid.bottom, top: solid.top };
    space.clearance(&solid.outline, &solid.pose, span, NEAR, None)
}
