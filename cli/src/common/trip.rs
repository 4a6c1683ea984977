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
    /// Where the robot is to go, in the world.
    pub(crate) goal: Point,
}

/// A marker within so many metres of the robot is that of its start.
const AT_START: f64 = 0.05;
/// A robot nearer to something than this many metres touches it.
const TOUCHING: f64 = 1e-3;

impl Trip {
    /// What drives.
    pub(crate) fn spec(&self) -> &RobotSpec {
        &self.scene.robots[0].spec
    }

    /// Where it starts, in the world.
    pub(crate) fn start(&self) -> Pose {
        self.scene.robots[0].pose
    }

    /// Metres from start to goal, as the crow flies.
    pub(crate) fn distance(&self) -> f64 {
        self.start().distance_to(self.goal)
    }

    /// Simulated seconds that are generous for finding the goal, or that there is no way to it: the time for several
    /// rounds along both sides of every wall and for the way itself, and ten minutes at least.
    pub(crate) fn generous_time_limit(&self) -> f64 {
        let walls: f64 = self.scene.world.walls.iter().map(|wall| wall.line.length()).sum();
        let objects: f64 =
            self.scene.world.objects.iter().map(|object| 4.0 * object.kind.shape.bounding_radius()).sum();
        (40.0 * (walls + objects) + 20.0 * self.distance()).ceil().clamp(600.0, 1e6)
    }
}

/// A lidar that looks this far round, in radians, looks all round.
const ALL_ROUND: f64 = 0.999 * TAU;

/// The robot that drives where a world has none, or one that a command has no use for.
#[derive(Debug, Clone)]
pub(crate) struct StandIn {
    pub(crate) spec: Arc<RobotSpec>,
    /// Whether the command has a use for a robot.
    pub(crate) suits: fn(&RobotSpec) -> bool,
}

impl Default for StandIn {
    /// An S4, and any robot will do.
    fn default() -> Self {
        Self { spec: Arc::new(RobotSpec::s4()), suits: |_| true }
    }
}

impl CommonArgs {
    /// The trip that the options describe: `--world`, or `own` without it, with the robot, the start and the goal
    /// that the options give, or else the world.
    ///
    /// A `.sim` gives its first robot and its first marker that is not where this starts; a `.maz` the letters S and G; a `.wld` its `position`.
    pub(crate) fn trip(&self, own: impl FnOnce() -> Scene) -> Result<Trip, Failure> {
        if self.goal.is_some_and(|goal| goal.heading.is_some()) {
            return Err(Failure::input(
                "--goal: found a heading; expected X,Y: here any heading at the goal is right",
            ));
        }
        self.trip_to_pose(own)
    }

    /// The same for a command that takes a heading at the goal, which is in `self.goal`.
    pub(crate) fn trip_to_pose(&self, own: impl FnOnce() -> Scene) -> Result<Trip, Failure> {
        self.trip_to_pose_of(&StandIn::default(), own)
    }

    /// The same for a command that not every robot can drive in.
    pub(crate) fn trip_to_pose_of(
        &self,
        stand_in: &StandIn,
        own: impl FnOnce() -> Scene,
    ) -> Result<Trip, Failure> {
        let scene = self.placed_of(stand_in, own)?;
        let goal = self.destination(&scene)?;
        Ok(Trip { scene, goal })
    }

    /// The scene that the options describe, for a command without a goal: `--world`, or `own` without it,
    /// with the robot and the start that the options give, or else the world.
    pub(crate) fn placed(&self, own: impl FnOnce() -> Scene) -> Result<Scene, Failure> {
        self.placed_of(&StandIn::default(), own)
    }

    /// The same for a command that not every robot can drive in.
    pub(crate) fn placed_of(
        &self,
        stand_in: &StandIn,
        own: impl FnOnce() -> Scene,
    ) -> Result<Scene, Failure> {
        let scene = match &self.world {
            Some(file) => self.parsed(self.load_scene("world", file))?,
            None => own(),
        };
        self.warn_of_strays(&scene);
        self.placed_in(scene, stand_in)
    }

    /// Tells of what stands so far from all else that maps and pictures leave it out.
    fn warn_of_strays(&self, scene: &Scene) {
        let strays = scene.world.strays();
        if strays > 0 {
            self.warn(format_args!(
                "{}: walls and objects that reach far out of the rest, which is {}: {strays}; maps and pictures leave them out",
                self.world_name(),
                within(&scene.world.site())
            ));
        }
    }

    /// A scene with the robot and the start that the options give, or else the scene.
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

    /// The same, and whoever gives a goal is told why there is none.
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

    /// Refuses a robot that cannot turn on the spot, or has no lidar that looks all round.
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

    /// The world's name in messages.
    fn world_name(&self) -> String {
        self.world.as_deref().map_or("the command's own world".into(), |file| file.display().to_string())
    }

    /// What a file says. Notes its warnings.
    fn parsed<T>(&self, parsed: Result<Parsed<T>, FormatError>) -> Result<T, Failure> {
        let parsed = parsed.map_err(Failure::input)?;
        for warning in &parsed.warnings {
            self.warn(warning);
        }
        Ok(parsed.value)
    }

    /// The robot that drives, at its start.
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
        // Scripts mark the start as well, before the goal or behind it.
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

    fn check_start(&self, scene: &Scene) -> Result<(), Failure> {
        let start = scene.robots[0].pose;
        let from = if self.start.is_some() { "--start".into() } else { self.world_name() };
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

fn within(bounds: &Aabb) -> String {
    format!("from {} to {} mm", in_mm(bounds.min), in_mm(bounds.max))
}

/// Metres from the first robot's outline to the nearest wall, object or other robot; 0 in contact.
fn clearance(scene: &Scene) -> f64 {
    const NEAR: f64 = 0.1;
    let space = space_with(scene, &scene.robots[1..]);
    let solid = Solid::from(&scene.robots[0]);
    let span = Span { bottom: solid.bottom, top: solid.top };
    space.clearance(&solid.outline, &solid.pose, span, NEAR, None)
}
