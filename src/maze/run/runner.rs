use super::localiser::{Calibration, MazeLocaliser};
use super::look::{self, View};
use super::rig::Rig;
use super::tracker::{TrajectoryTracker, TrajectoryTrackerParameters};
use crate::geometry::{Pose, Twist, angle_difference};
use crate::io::control::{Stopwatch, stopping};
use crate::io::reading::{check_distances, check_pose};
use crate::io::{Clock, DistanceSensors, Drive, Error, ErrorKind, Odometry, Result, StallDetector};
use crate::maze::{
    Cell, Direction, ExplorationOutcome, ExplorationStep, Explorer, FastPlan, FastPlanner, Maze, RunLimits,
    Scale, Trajectory, Unknown, WallState,
};
use crate::parameter::require;

/// Parameters of [`MazeRunner`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MazeRunnerParameters {
    /// Limits while exploring.
    pub exploring: RunLimits,
    /// Limits on the fast run.
    pub racing: RunLimits,
    /// Gains of the trajectory tracker.
    pub tracker: TrajectoryTrackerParameters,
    /// Number of averaged readings per sensor when looking around.
    pub readings: usize,
}

impl MazeRunnerParameters {
    /// A micromouse.
    pub const MICROMOUSE: Self = Self {
        exploring: RunLimits {
            speed: 0.8,
            diagonal_speed: 0.6,
            acceleration: 3.0,
            lateral_acceleration: 2.0,
            pivot_speed: 8.0,
            angular_acceleration: 80.0,
        },
        racing: RunLimits::MICROMOUSE,
        tracker: TrajectoryTrackerParameters::MICROMOUSE,
        readings: 8,
    };

    /// An EyeBot in the book's larger maze.
    pub const EYEBOT: Self = Self {
        exploring: RunLimits {
            speed: 0.5,
            diagonal_speed: 0.4,
            acceleration: 0.6,
            lateral_acceleration: 0.4,
            pivot_speed: 3.0,
            angular_acceleration: 6.0,
        },
        racing: RunLimits::EYEBOT,
        tracker: TrajectoryTrackerParameters::EYEBOT,
        readings: 8,
    };
}

/// Result of an exploration.
#[derive(Debug, Clone, PartialEq)]
pub struct Exploration {
    /// How it ended.
    pub verdict: ExplorationOutcome,
    /// Number of visited cells.
    pub visited: usize,
    /// Number of stops to look around.
    pub looks: usize,
    /// Duration (s).
    pub time: f64,
}

impl Exploration {
    /// Fails with [`TimedOut`](ErrorKind::TimedOut) if the time limit ended it.
    pub fn in_time(&self) -> Result<()> {
        if self.verdict == ExplorationOutcome::TimedOut { Err(time_is_over()) } else { Ok(()) }
    }
}

fn time_is_over() -> Error {
    Error::new(ErrorKind::TimedOut, "the time limit of the run is over")
}

/// Drives a robot through a partly known maze: it looks around, explores and races.
///
/// The frame is that of the maze, with the origin at its lower left corner. The odometry calibration learnt
/// while exploring makes the fast run precise.
///
/// ```
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::kinematics::OdometryErrors;
/// use roverlab::maze::{
///     ExplorationOutcome, Goals, Maze, MazeRunner, MazeRunnerParameters, Rig, Scale, TwoPhaseExplorer,
///     files, mouse,
/// };
/// use roverlab::world::Scene;
/// let maze = files::parse(b"o---o---o\n|     G |\no   o---o\n| S |   |\no---o---o\n", "a maze")?.maze;
/// let (scale, spec) = (Scale::MICROMOUSE, mouse());
/// let scene = Scene::with_robot(scale.world(&maze), spec.clone(), scale.pose(maze.start(), maze.heading()));
/// let simulation = Simulation::new(&scene, SimOptions::ideal())?;
/// let mut robot = simulation.robot(0)?;
/// let rig = Rig::new(&spec, OdometryErrors::default(), 0.002)?;
/// let mut known = Maze::unexplored(maze.width(), maze.height())?;
/// known.set_start(maze.start(), maze.heading());
/// known.set_goals(maze.goals());
/// let mut runner = MazeRunner::new(&mut robot, rig, known, scale, MazeRunnerParameters::MICROMOUSE, 120.0)?;
/// let mut explorer = TwoPhaseExplorer::new(Goals::StepsAndTime(Box::new(runner.planner())));
/// let explored = runner.explore(&mut explorer, &mut |_| {})?;
/// assert_eq!(explored.verdict, ExplorationOutcome::Optimal);
/// let plan = runner.plan_fast_run().expect("a way to the goal");
/// runner.race(&plan, &mut |_| {})?;
/// assert!(simulation.truth().pose(0)?.distance_to(scale.centre(plan.route.end())) < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct MazeRunner<'r, R: ?Sized> {
    robot: &'r mut R,
    parameters: MazeRunnerParameters,
    rig: Rig,
    scale: Scale,
    localiser: MazeLocaliser,
    maze: Maze,
    at: (Cell, Direction),
    visited: Vec<bool>,
    explorer: FastPlanner,
    racer: FastPlanner,
    /// Time limit for everything (s), counted from the first reading of the clock.
    time_limit: f64,
    clock: Option<Stopwatch>,
}

impl<'r, R: Clock + Drive + Odometry + StallDetector + DistanceSensors + ?Sized> MazeRunner<'r, R> {
    /// A robot that stands in the centre of the maze's start cell, with the start heading. `maze` is its
    /// initial knowledge. After `time_limit` seconds (may be infinite), calls fail with
    /// [`TimedOut`](ErrorKind::TimedOut).
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(
        robot: &'r mut R,
        rig: Rig,
        maze: Maze,
        scale: Scale,
        parameters: MazeRunnerParameters,
        time_limit: f64,
    ) -> Result<Self> {
        Stopwatch::check_limit(time_limit)?;
        parameters.tracker.validate().map_err(|error| error.of("tracker"))?;
        require("readings", parameters.readings as f64, parameters.readings > 0, "at least 1")?;
        let explorer = FastPlanner::new(scale, parameters.exploring)?;
        let racer = FastPlanner::new(scale, parameters.racing)?;
        let at = (maze.start(), maze.heading());
        let odometry = robot.pose()?;
        let localiser = MazeLocaliser::new(rig.clone(), scale, scale.pose(at.0, at.1), odometry);
        let mut visited = vec![false; maze.cell_count()];
        visited[maze.index(at.0)] = true;
        Ok(Self {
            robot,
            parameters,
            rig,
            scale,
            localiser,
            maze,
            at,
            visited,
            explorer,
            racer,
            time_limit,
            clock: None,
        })
    }

    /// The known maze.
    pub fn maze(&self) -> &Maze {
        &self.maze
    }

    /// Estimated pose.
    pub fn pose(&self) -> Pose {
        self.localiser.pose()
    }

    /// Estimated systematic errors of odometry.
    pub fn calibration(&self) -> Calibration {
        self.localiser.calibration()
    }

    /// A planner of fast runs for this robot.
    pub fn planner(&self) -> FastPlanner {
        self.racer.clone()
    }

    /// Explores until the explorer finishes; the robot ends at the start with the start heading. `watch`
    /// receives the estimated pose at every step.
    ///
    /// # Errors
    ///
    /// If the robot reports one, gets stuck, or cannot recognise the walls around it.
    pub fn explore(
        &mut self,
        explorer: &mut dyn Explorer,
        watch: &mut dyn FnMut(Pose),
    ) -> Result<Exploration> {
        let begin = self.now()?;
        let mut looks = 0;
        let verdict = match self.explore_to_end(explorer, &mut looks, watch) {
            Err(_) if self.is_over() => ExplorationOutcome::TimedOut,
            verdict => verdict?,
        };
        let visited = self.visited.iter().filter(|&&visited| visited).count();
        Ok(Exploration { verdict, visited, looks, time: self.now()? - begin })
    }

    fn explore_to_end(
        &mut self,
        explorer: &mut dyn Explorer,
        looks: &mut usize,
        watch: &mut dyn FnMut(Pose),
    ) -> Result<ExplorationOutcome> {
        loop {
            if !self.maze.is_known(self.at.0) {
                self.look_around(watch)?;
                *looks += 1;
            }
            match explorer.next(&self.maze, self.at) {
                ExplorationStep::Go(cell) => self.go_to(cell, watch)?,
                ExplorationStep::Finished(verdict) => {
                    self.face(self.maze.heading(), watch)?;
                    return Ok(verdict);
                }
            }
        }
    }

    /// Observes the walls of the cell and of those behind its openings; turns if the wall behind is unknown.
    fn look_around(&mut self, watch: &mut dyn FnMut(Pose)) -> Result<()> {
        self.look(watch)?;
        for _ in 0..3 {
            let (cell, heading) = self.at;
            if self.maze.is_known(cell) {
                return Ok(());
            }
            let back = self.maze.wall(cell, heading.opposite()) == WallState::Unknown;
            self.face(if back { heading.left() } else { heading }, watch)?;
            self.look(watch)?;
        }
        let (cell, heading) = self.at;
        let message = format!("the walls around cell {cell} cannot be made out, facing {heading}");
        Err(Error::new(ErrorKind::Diverged, message))
    }

    fn look(&mut self, watch: &mut dyn FnMut(Pose)) -> Result<()> {
        let (cell, _) = self.at;
        let index = self.maze.index(cell);
        self.visited[index] = true;
        let mut sums = [(0.0, 0_usize); 3];
        for _ in 0..self.parameters.readings.max(1) {
            let readings = self.sense()?;
            for (sum, reading) in sums.iter_mut().zip(readings).filter(|(_, reading)| reading.is_finite()) {
                *sum = (sum.0 + reading, sum.1 + 1);
            }
            watch(self.localiser.pose());
            self.wait_for_tick()?;
        }
        for (sensor, (sum, count)) in self.rig.sensors.into_iter().zip(sums) {
            let reading =
                if 2 * count > self.parameters.readings { sum / count as f64 } else { f64::INFINITY };
            let pose = self.localiser.pose();
            let direction = Direction::nearest(pose.heading + sensor.mount.yaw);
            let (dx, dy) = direction.step();
            let along = |x: f64, y: f64| x * f64::from(dx) + y * f64::from(dy);
            let foot = pose.to_world(crate::geometry::Point::new(sensor.mount.x, sensor.mount.y));
            let offset = foot - self.scale.centre(cell);
            let ahead = along(offset.x, offset.y);
            let view = View {
                cell,
                direction,
                distance: reading + ahead,
                range: sensor.max_range + ahead,
                heading_deviation: self.localiser.deviations().1,
            };
            look::enter(&mut self.maze, self.scale, &view);
        }
        Ok(())
    }

    /// Reads odometry and sensors, updates the estimate, and returns the readings.
    fn sense(&mut self) -> Result<[f64; 3]> {
        let odometry = self.robot.pose()?;
        check_pose(&odometry)?;
        self.localiser.predict(odometry);
        let mut readings = [f64::INFINITY; 3];
        for (sensor, reading) in self.rig.sensors.iter().zip(&mut readings) {
            *reading = self.robot.distance(sensor.id)?;
            check_distances("observed distance", &[*reading])?;
            self.localiser.correct(&self.maze, sensor, *reading);
        }
        Ok(readings)
    }

    fn now(&mut self) -> Result<f64> {
        match &mut self.clock {
            Some(clock) => clock.now(self.robot),
            clock => Ok(clock.insert(Stopwatch::start(self.robot, self.time_limit)?).time()),
        }
    }

    fn is_over(&self) -> bool {
        self.clock.is_some_and(|clock| clock.is_over())
    }

    /// Time of the last tick at or before a time; steps are made at ticks.
    fn tick(&self, time: f64) -> f64 {
        let period = self.parameters.tracker.period;
        (time / period + 1e-6).floor() * period
    }

    /// Waits for the next tick or the time limit. Fails if the latter is reached.
    fn wait_for_tick(&mut self) -> Result<()> {
        let now = self.now()?;
        let left = self.clock.map_or(f64::INFINITY, |clock| clock.left());
        if self.is_over() {
            return Err(time_is_over());
        }
        let next = self.tick(now) + self.parameters.tracker.period;
        self.robot.wait((next - now).min(left))
    }

    /// Turns on the spot towards a direction.
    ///
    /// # Errors
    ///
    /// If the robot reports one, gets stuck, or runs out of time.
    pub fn face(&mut self, direction: Direction, watch: &mut dyn FnMut(Pose)) -> Result<()> {
        let (cell, heading) = self.at;
        if direction != heading {
            let angle = angle_difference(direction.heading(), heading.heading());
            let start = self.scale.pose(cell, heading);
            let trajectory = Trajectory::pivot(start, angle, &self.parameters.exploring);
            self.follow(trajectory, watch)?;
            self.at = (cell, direction);
        }
        Ok(())
    }

    /// Drives to a cell by the fastest path through walls known to be absent.
    ///
    /// # Errors
    ///
    /// If no path is known, the robot reports an error, gets stuck, or runs out of time.
    pub fn go_to(&mut self, cell: Cell, watch: &mut dyn FnMut(Pose)) -> Result<()> {
        let plan = self.explorer.plan_from(&self.maze, Unknown::Closed, self.at, |other| other == cell);
        let Some(plan) = plan else {
            let message = format!("no known way from cell {} to cell {cell}", self.at.0);
            return Err(Error::new(ErrorKind::Other, message));
        };
        self.drive(&plan, self.parameters.exploring, watch).map(|_| ())
    }

    /// The fastest run from the start to the goal through walls known to be absent; `None` if there is none.
    pub fn plan_fast_run(&mut self) -> Option<FastPlan> {
        self.racer.plan(&self.maze, Unknown::Closed)
    }

    /// Drives a plan of [`plan_fast_run`](Self::plan_fast_run) from the start. Returns its duration from rest
    /// to rest (s).
    ///
    /// # Errors
    ///
    /// If the robot reports one, gets stuck, or runs out of time.
    pub fn race(&mut self, plan: &FastPlan, watch: &mut dyn FnMut(Pose)) -> Result<f64> {
        self.drive(plan, self.parameters.racing, watch)
    }

    fn drive(&mut self, plan: &FastPlan, limits: RunLimits, watch: &mut dyn FnMut(Pose)) -> Result<f64> {
        let trajectory = Trajectory::new(plan, self.scale, limits)
            .map_err(|error| Error::new(ErrorKind::InvalidInput, error.to_string()).with_source(error))?;
        let time = self.follow(trajectory, watch)?;
        for cell in plan.route.cells() {
            let index = self.maze.index(cell);
            self.visited[index] = true;
        }
        let heading = Direction::nearest(self.localiser.pose().heading);
        self.at = (plan.route.end(), heading);
        Ok(time)
    }

    /// Follows a trajectory and stops the robot at its end. Returns the duration (s).
    fn follow(&mut self, trajectory: Trajectory, watch: &mut dyn FnMut(Pose)) -> Result<f64> {
        let followed = self.follow_to_end(trajectory, watch);
        stopping::<_, Twist, _>(self.robot, followed)
    }

    fn follow_to_end(&mut self, trajectory: Trajectory, watch: &mut dyn FnMut(Pose)) -> Result<f64> {
        let tracker = TrajectoryTracker::new(trajectory, self.parameters.tracker, self.rig.lag)?;
        let planned = tracker.trajectory().duration();
        let limit = 2.0 * planned + 5.0;
        self.wait_for_tick()?;
        // Steps are counted from the tick at which the motors first respond.
        let begin = self.now()?;
        let begin = self.tick(begin);
        loop {
            let now = match &mut self.clock {
                Some(clock) => clock.step(self.robot)?,
                None => begin,
            };
            if self.is_over() {
                return Err(time_is_over());
            }
            let now = self.tick(now) - begin;
            self.sense()?;
            let pose = self.localiser.pose();
            watch(pose);
            let speed = self.robot.speed()?;
            let Some(command) = tracker.step(now, pose, speed) else { return Ok(now) };
            self.robot.set_speed(command)?;
            if now > limit {
                let message = format!(
                    "the clock has advanced by {now:.1} s on a path of {planned:.1} s whose end the robot has not \
                     reached, at {:.3}, {:.3} m; expected at most {limit:.1} s",
                    pose.x, pose.y
                );
                return Err(Error::new(ErrorKind::Diverged, message));
            }
            if self.robot.is_stalled()? {
                let message = format!("the robot is stuck at {:.3}, {:.3} m", pose.x, pose.y);
                return Err(Error::new(ErrorKind::Diverged, message));
            }
            self.wait_for_tick()?;
        }
    }
}
