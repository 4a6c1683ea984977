//! What a program's world is: read from the options of the runner, or from the environment that it sets.

use std::env;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use roverlab::geometry::{Pose, units};
use roverlab::io::sim::SimOptions;
use roverlab::world::formats::{self, DiskFiles};
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};

use crate::costs::{Costs, Frames};
use crate::walker::is_walker;

/// The world of a run, and which robot of it a program drives.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// A `.sim`, `.wld`, `.maz` or ROS map; without it, what stands in the folder, or a square of 4 m.
    pub world: Option<PathBuf>,
    /// The program's folder.
    pub folder: PathBuf,
    /// A robot's description, or the name of one that is built in; without it, the one in the world's file, or an S4.
    pub robot: Option<String>,
    /// Where the robot starts.
    pub start: Option<Pose>,
    /// Which of the world's robots the program drives.
    pub index: usize,
    /// The seed of every random stream.
    pub seed: u64,
    /// The noise: 0 ideal, 1 as on the real robot.
    pub noise: f64,
    /// Simulated seconds after which a program is ended.
    pub time_limit: f64,
    /// What calls take.
    pub costs: Costs,
    /// Simulated seconds for a second that a program computes.
    pub cpu_time: f64,
}

impl Default for Plan {
    /// An hour in an ideal world, in EyeSim's time.
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

/// What tells this build of library and runner from others: a digest of their source texts.
pub const BUILD: &str = env!("EYESIM_BUILD");

/// The names of the environment's variables.
pub mod names {
    /// The file of the world.
    pub const WORLD: &str = "ROBIOS_WORLD";
    /// The robot.
    pub const ROBOT: &str = "ROBIOS_ROBOT";
    /// The start pose.
    pub const START: &str = "ROBIOS_START";
    /// The index of the robot.
    pub const INDEX: &str = "ROBIOS_INDEX";
    /// The seed.
    pub const SEED: &str = "ROBIOS_SEED";
    /// The noise.
    pub const NOISE: &str = "ROBIOS_NOISE";
    /// The time limit.
    pub const TIME_LIMIT: &str = "ROBIOS_TIME_LIMIT";
    /// The keys.
    pub const KEYS: &str = "ROBIOS_KEYS";
    /// What calls take: `eyesim`, `free`, or a file.
    pub const COSTS: &str = "ROBIOS_CALL_COSTS";
    /// Frames in a second.
    pub const FRAME_RATE: &str = "ROBIOS_FRAME_RATE";
    /// Simulated seconds for a second that a program computes.
    pub const CPU_TIME: &str = "ROBIOS_CPU_TIME";
    /// The number of the open file of the memory that is shared with the runner.
    pub const MEMORY: &str = "ROBIOS_MEMORY";
    /// The file for the picture of the display.
    pub const LCD: &str = "ROBIOS_LCD";
    /// Set if the world lives in the runner.
    pub const SHARED: &str = "ROBIOS_SHARED";
    /// The number of the open socket through which somebody types.
    pub const KEYBOARD: &str = "ROBIOS_KEYBOARD";
    /// The library's file, for `eye.py`.
    pub const LIBRARY: &str = "ROBIOS_LIBRARY";
    /// The runner's [`BUILD`](super::BUILD).
    pub const BUILD: &str = "ROBIOS_BUILD";
}

/// Frames that EyeSim renders in a second, unless somebody says otherwise.
pub const FRAME_RATE: f64 = 60.0;
/// Seconds of a call in the simulator, the least that it takes: calls are charged before they come there.
const NO_TIME: f64 = 1e-6;

/// Metres from wall to wall of the world that there is when nobody says anything.
const DEFAULT_SIZE: f64 = 4.0;

impl Plan {
    /// The plan in the environment.
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

    /// The plan as variables of the environment.
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

    /// World and robots, with at least one robot, and what was odd about the files.
    pub fn scene(&self) -> Result<(Scene, Vec<String>), String> {
        let mut warnings = Vec::new();
        let found = self.world.clone().or_else(|| only_world(&self.folder));
        let mut scene = match found {
            Some(file) => {
                let bytes = formats::read_file(&file).map_err(|error| error.to_string())?;
                let mut files = DiskFiles::new();
                let parsed = formats::parse_scene_tolerantly(bytes, &file.display().to_string(), &mut files);
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
        let spec = self.robot.as_deref().map(|name| robot(name, &mut warnings)).transpose()?;
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
        Ok((scene, warnings))
    }

    /// How the simulation runs. Robots push what is loose, as EyeSim's do.
    pub fn options(&self) -> SimOptions {
        let options = SimOptions::with_noise(self.noise, self.seed);
        SimOptions { call_duration: NO_TIME, time_limit: Some(self.time_limit), pushing: true, ..options }
    }
}

/// Refuses a runner of another build, which may say things in another way.
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

/// `X,Y,DEG` in millimetres and degrees.
pub fn parse_pose(text: &str) -> Result<Pose, String> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|n: &f64| n.abs() <= 1e9)).collect();
    match numbers.as_deref() {
        Some(&[x, y, heading]) => Ok(Pose::from_mm_deg(x, y, heading)),
        _ => Err(format!("{text:?}; expected X,Y,DEG: three finite numbers (mm, mm, degrees)")),
    }
}

/// A robot by the name of a file or of one that is built in.
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

/// The world that stands in a folder: the only `.sim`, or else the only `.maz` or `.wld`.
fn only_world(folder: &Path) -> Option<PathBuf> {
    let files: Vec<PathBuf> =
        std::fs::read_dir(folder).ok()?.filter_map(Result::ok).map(|entry| entry.path()).collect();
    ["sim", "maz", "wld"].iter().find_map(|ending| {
        let mut fitting = files.iter().filter(|file| {
            file.extension().is_some_and(|found| found.to_string_lossy().eq_ignore_ascii_case(ending))
        });
        let first = fitting.next()?;
        fitting.next().is_none().then(|| first.clone())
    })
}

/// Where a robot starts that nobody has placed: where the world says, or in its middle.
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
