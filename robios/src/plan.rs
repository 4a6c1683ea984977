//! A program's world, read from the runner's options or from the environment set by it.

use std::env;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use roverlab::geometry::{Pose, units};
use roverlab::io::sim::SimOptions;
use roverlab::world::formats::{self, DiskFiles, FileSource};
use roverlab::world::{DriveSpec, RobotPlacement, RobotSpec, Scene, World};

use crate::costs::{Costs, Frames};
use crate::files;
use crate::walker::is_walker;

/// The world of a run, and the robot driven by the program.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// A `.sim`, `.wld`, `.maz` or ROS map; by default the one in the folder, or a square of 4 m.
    pub world: Option<PathBuf>,
    /// Folder of the program.
    pub folder: PathBuf,
    /// A robot's description, or the name of a built-in one; by default the world's robot, or an S4.
    pub robot: Option<String>,
    /// Start pose of the robot.
    pub start: Option<Pose>,
    /// Index of the robot driven by the program.
    pub index: usize,
    /// Seed of all random streams.
    pub seed: u64,
    /// Noise level: 0 ideal, 1 as on the real robot.
    pub noise: f64,
    /// Simulated time limit (s).
    pub time_limit: f64,
    /// Cost model of calls.
    pub costs: Costs,
    /// Simulated seconds per second of computing.
    pub cpu_time: f64,
}

impl Default for Plan {
    /// An hour in an ideal world, with EyeSim's call costs.
    fn default() -> Self {
        Self {
            world: None,
            folder: PathBuf::from("."),
            robot: None,
            start: None,
            index: 0,
            seed: 1,
            noise: 0.0,
            time_limit: 3600.0,
            costs: Costs::Frames(Frames::new(FRAME_RATE)),
            cpu_time: 0.0,
        }
    }
}

/// Identifies this build of library and runner: a digest of their source texts.
pub const BUILD: &str = env!("EYESIM_BUILD");

/// Names of the environment variables.
pub mod names {
    /// World file.
    pub const WORLD: &str = "ROBIOS_WORLD";
    /// Robot.
    pub const ROBOT: &str = "ROBIOS_ROBOT";
    /// Start pose.
    pub const START: &str = "ROBIOS_START";
    /// Index of the robot.
    pub const INDEX: &str = "ROBIOS_INDEX";
    /// Seed.
    pub const SEED: &str = "ROBIOS_SEED";
    /// Noise level.
    pub const NOISE: &str = "ROBIOS_NOISE";
    /// Time limit.
    pub const TIME_LIMIT: &str = "ROBIOS_TIME_LIMIT";
    /// Key plan.
    pub const KEYS: &str = "ROBIOS_KEYS";
    /// Call costs: `eyesim`, `free`, or a file.
    pub const COSTS: &str = "ROBIOS_CALL_COSTS";
    /// Frame rate.
    pub const FRAME_RATE: &str = "ROBIOS_FRAME_RATE";
    /// Simulated seconds per second of computing.
    pub const CPU_TIME: &str = "ROBIOS_CPU_TIME";
    /// File descriptor of the memory shared with the runner.
    pub const MEMORY: &str = "ROBIOS_MEMORY";
    /// File for the picture of the display.
    pub const LCD: &str = "ROBIOS_LCD";
    /// Set if the world lives in the runner: real seconds after which it stops waiting for a silent program.
    pub const SHARED: &str = "ROBIOS_SHARED";
    /// File descriptor of the socket for typed keys.
    pub const KEYBOARD: &str = "ROBIOS_KEYBOARD";
    /// File descriptor of the socket for the display.
    pub const SCREEN: &str = "ROBIOS_SCREEN";
    /// File of the library, for `eye.py`.
    pub const LIBRARY: &str = "ROBIOS_LIBRARY";
    /// The runner's [`BUILD`](super::BUILD).
    pub const BUILD: &str = "ROBIOS_BUILD";
}

/// Default frame rate of EyeSim (Hz).
pub const FRAME_RATE: f64 = 60.0;
/// Minimum duration of a call in the simulator (s): calls are charged before.
const NO_TIME: f64 = 1e-6;

/// Side length of the default world (m).
const DEFAULT_SIZE: f64 = 4.0;

impl Plan {
    /// Reads the plan from the environment. Fails for another build's runner and for invalid variables.
    pub fn from_environment() -> Result<Self, String> {
        check_build(std::env::var(names::BUILD).ok().as_deref())?;
        let mut plan = Self::default();
        let text = |name: &str| env::var(name).ok().filter(|value| !value.is_empty());
        plan.world = text(names::WORLD).map(PathBuf::from);
        plan.robot = text(names::ROBOT);
        plan.start = text(names::START).map(|value| parse_pose(&value)).transpose()?;
        if let Some(value) = text(names::INDEX) {
            plan.index = number(names::INDEX, &value)?;
        }
        if let Some(value) = text(names::SEED) {
            plan.seed = number(names::SEED, &value)?;
        }
        if let Some(value) = text(names::NOISE) {
            plan.noise = number(names::NOISE, &value)?;
        }
        if let Some(value) = text(names::TIME_LIMIT) {
            plan.time_limit = number(names::TIME_LIMIT, &value)?;
        }
        if let Some(value) = text(names::CPU_TIME) {
            plan.cpu_time = number(names::CPU_TIME, &value)?;
        }
        let rate =
            text(names::FRAME_RATE).map_or(Ok(FRAME_RATE), |value| number(names::FRAME_RATE, &value))?;
        if let Some(value) = text(names::COSTS) {
            plan.costs = Costs::parse(&value, rate)?;
        }
        Ok(plan)
    }

    /// The plan as environment variables.
    pub fn variables(&self) -> Vec<(&'static str, String)> {
        let mut all = vec![
            (names::INDEX, self.index.to_string()),
            (names::SEED, self.seed.to_string()),
            (names::NOISE, self.noise.to_string()),
            (names::TIME_LIMIT, self.time_limit.to_string()),
        ];
        if let Some(world) = &self.world {
            all.push((names::WORLD, world.display().to_string()));
        }
        if let Some(robot) = &self.robot {
            all.push((names::ROBOT, robot.clone()));
        }
        if let Some(Pose { x, y, heading }) = self.start {
            all.push((
                names::START,
                format!("{},{},{}", units::to_mm(x), units::to_mm(y), units::to_deg(heading)),
            ));
        }
        all
    }

    /// World and robots, with at least one robot, and warnings about the files. Fails if a file cannot be
    /// read.
    pub fn scene(&self) -> Result<(Scene, Vec<String>), String> {
        let mut warnings = Vec::new();
        let found = self.world.clone().or_else(|| only_world(&self.folder, &mut warnings));
        let read = |file: &PathBuf| {
            files::require_regular(file)?;
            formats::read_file(file).map_err(|error| error.to_string())
        };
        let bytes = found.as_ref().map(read).transpose()?;
        let world = found.as_deref().zip(bytes);
        let scene = self.scene_of(world, &mut DiskFiles::new(), &mut warnings)?;
        Ok((scene, warnings))
    }

    /// The same of a world's bytes, if any, and of what reads the files that these name.
    pub fn scene_of(
        &self,
        world: Option<(&Path, Vec<u8>)>,
        files: &mut dyn FileSource,
        warnings: &mut Vec<String>,
    ) -> Result<Scene, String> {
        let mut scene = match world {
            Some((file, bytes)) => {
                let parsed = formats::parse_scene_tolerantly(bytes, &file.display().to_string(), files);
                let parsed = parsed.map_err(|error| error.to_string())?;
                warnings.extend(parsed.warnings.iter().map(ToString::to_string));
                let mut names: Vec<_> =
                    parsed.value.robots.iter().map(|robot| robot.spec.name.as_str()).collect();
                names.sort_unstable();
                names.dedup();
                for name in names.into_iter().filter(|name| is_walker(name)) {
                    warnings.push(format!(
                        "{name} is the walking robot that is built in, whatever its file says"
                    ));
                }
                parsed.value
            }
            None => Scene::new(World::walled(DEFAULT_SIZE, DEFAULT_SIZE)),
        };
        let spec = self.robot.as_deref().map(|name| robot(name, warnings)).transpose()?;
        if scene.robots.is_empty() {
            let pose = start_in(&scene.world);
            let objects_before = scene.world.objects.len();
            let robot = RobotPlacement::new(Arc::new(RobotSpec::s4()), pose);
            scene.robots.push(RobotPlacement { objects_before, ..robot });
        }
        let robots = scene.robots.len();
        let placed = scene.robots.get_mut(self.index).ok_or_else(|| {
            format!("robot {}; expected an index below {robots}, the number of robots", self.index)
        })?;
        if let Some(spec) = spec {
            placed.spec = Arc::new(spec);
        }
        if let Some(start) = self.start {
            placed.pose = start;
        }
        warnings.extend(scene.misplacements().into_iter().map(|(robot, place)| {
            let Pose { x, y, .. } = scene.robots[robot].pose;
            let (x, y, number) = (units::to_mm(x), units::to_mm(y), robot + 1);
            format!("robot {number} starts at {x:.0}, {y:.0} mm, {place}; expected free floor")
        }));
        warnings.extend(without_water(&scene));
        Ok(scene)
    }

    /// Options of the simulation. Robots push loose objects, as in EyeSim.
    pub fn options(&self) -> SimOptions {
        let options = SimOptions::with_noise(self.noise, self.seed);
        SimOptions { call_duration: NO_TIME, time_limit: Some(self.time_limit), pushing: true, ..options }
    }
}

/// Rejects a runner of another build, whose protocol may differ.
fn check_build(runner: Option<&str>) -> Result<(), String> {
    match runner {
        Some(build) if build != BUILD => Err(format!(
            "this library is of another build ({BUILD}) than the runner ({build}); expected both from one \
             `cargo build -p robios`"
        )),
        _ => Ok(()),
    }
}

fn number<T: std::str::FromStr>(name: &str, value: &str) -> Result<T, String> {
    value.trim().parse().map_err(|_| format!("{name} is {value:?}; expected a number"))
}

/// Parses `X,Y,DEG` in millimetres and degrees.
pub fn parse_pose(text: &str) -> Result<Pose, String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|n: &f64| n.abs() <= 1e9)).collect();
    match numbers.as_deref() {
        Some(&[x, y, heading]) => Ok(Pose::from_mm_deg(x, y, heading)),
        _ => Err(format!("{text:?}; expected X,Y,DEG: three finite numbers (mm, mm, degrees)")),
    }
}

/// A robot from a file or by a built-in name.
fn robot(name: &str, warnings: &mut Vec<String>) -> Result<RobotSpec, String> {
    if let Some(spec) = RobotSpec::predefined(name) {
        return Ok(spec);
    }
    if !Path::new(name).exists() && !name.to_ascii_lowercase().ends_with(".robi") {
        return Err(format!(
            "robot {name:?}; expected {}, or the file of a description, .robi",
            RobotSpec::PREDEFINED.join(", ")
        ));
    }
    let parsed = formats::load_robot_tolerantly(name).map_err(|error| error.to_string())?;
    warnings.extend(parsed.warnings.iter().map(ToString::to_string));
    Ok(parsed.value)
}

/// Endings of worlds that are taken from a program's folder, in the order of preference.
const ENDINGS: [&str; 3] = ["sim", "maz", "wld"];

/// The single world in a folder: the only `.sim`, or else the only `.maz` or `.wld`. Warns of what is taken,
/// and of several among which there is no choice.
fn only_world(folder: &Path, warnings: &mut Vec<String>) -> Option<PathBuf> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).ok()?.filter_map(Result::ok).map(|entry| entry.path()).collect();
    files.sort();
    let ends_in = |file: &Path, ending: &str| {
        file.extension().is_some_and(|found| found.to_string_lossy().eq_ignore_ascii_case(ending))
    };
    let of = |ending: &&str| files.iter().filter(|file| ends_in(file, ending)).collect::<Vec<_>>();
    let kinds: Vec<_> = ENDINGS.iter().map(of).collect();
    if let Some(only) = kinds.iter().find(|files| files.len() == 1) {
        let name = only[0].file_name().unwrap_or_default().to_string_lossy();
        warnings
            .push(format!("{name}, the only one beside the program, is the world; --world names another"));
        return Some(only[0].clone());
    }
    if let Some((ending, several)) = ENDINGS.iter().zip(&kinds).find(|(_, files)| !files.is_empty()) {
        let count = several.len();
        warnings.push(format!(
            "{count} files .{ending} lie beside the program, and none of them is taken as the world; \
             expected \
             --world FILE"
        ));
    }
    None
}

/// Warns of craft on dry ground, where no thruster moves them.
fn without_water(scene: &Scene) -> Option<String> {
    let is_craft = |robot: &RobotPlacement| matches!(robot.spec.drive, DriveSpec::Craft(_));
    let first = scene.robots.iter().position(is_craft).filter(|_| scene.world.water_level.is_none())?;
    let (number, name) = (first + 1, &scene.robots[first].spec.name);
    Some(format!(
        "robot {number}, {name}, lies on the floor of a world without water; expected a line `water_level MM`"
    ))
}

/// Default start of a robot: the world's start place, or its middle.
fn start_in(world: &World) -> Pose {
    let letter = world.places.iter().find(|place| place.heading.is_some());
    let letter =
        letter.map(|place| Pose::new(place.position.x, place.position.y, place.heading.unwrap_or(0.0)));
    let middle = world.floor.min + 0.5 * world.floor.size();
    world.start.or(letter).unwrap_or(Pose::new(middle.x, middle.y, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_an_s4_in_the_middle_of_a_square() {
        let plan = Plan { world: None, ..Plan::default() };
        let (scene, warnings) = plan.scene().unwrap();
        assert!(warnings.is_empty());
        assert_eq!(scene.robots[0].spec.name, "S4");
        assert_eq!(scene.robots[0].pose, Pose::new(2.0, 2.0, 0.0));
    }

    #[test]
    fn robots_in_walls_and_outside_are_warned_of() {
        let warnings = |x: f64| {
            let plan = Plan { start: Some(Pose::new(x, 2.0, 0.0)), ..Plan::default() };
            plan.scene().unwrap().1
        };
        assert_eq!(warnings(4.0), ["robot 1 starts at 4000, 2000 mm, in a wall; expected free floor"]);
        assert_eq!(
            warnings(9.0),
            ["robot 1 starts at 9000, 2000 mm, outside the world; expected free floor"]
        );
    }

    #[test]
    fn a_craft_in_a_dry_world_is_warned_of_once() {
        let plan = Plan { robot: Some("Mako".into()), ..Plan::default() };
        assert_eq!(
            plan.scene().unwrap().1,
            ["robot 1, Mako, lies on the floor of a world without water; expected a line `water_level MM`"]
        );
    }

    #[test]
    fn wrong_plans_say_what_is_wrong() {
        let wrong = Plan { robot: Some("R2D2".into()), ..Plan::default() }.scene().unwrap_err();
        assert!(wrong.contains("R2D2") && wrong.contains("LabBot"), "{wrong}");
        let wrong = Plan { index: 3, ..Plan::default() }.scene().unwrap_err();
        assert!(wrong.contains("below 1"), "{wrong}");
        let wrong = Plan { world: Some("missing.wld".into()), ..Plan::default() }.scene().unwrap_err();
        assert!(wrong.contains("missing.wld"), "{wrong}");
        assert!(parse_pose("1,2").is_err() && parse_pose("1,2,nan").is_err());
    }
}
