use super::*;
use crate::geometry::Pose;
use crate::io::sim::{NoiseModel, SimOptions, Simulation, Truth};
use crate::kinematics::OdometryErrors;
use crate::maze::generate::competition;
use crate::maze::{
    ExplorationOutcome, Explorer, Goals, Maze, RecursiveExplorer, Scale, TwoPhaseExplorer, Unknown, WallState,
};
use crate::world::{RobotSpec, Scene};

/// A robot in an unknown maze.
struct Trial {
    maze: Maze,
    scale: Scale,
    spec: RobotSpec,
    parameters: MazeRunnerParameters,
    noise: f64,
    seed: u64,
}

impl Trial {
    fn mouse(seed: u64, noise: f64) -> Self {
        let (scale, parameters) = (Scale::MICROMOUSE, MazeRunnerParameters::MICROMOUSE);
        Self { maze: competition(16, seed).unwrap(), scale, spec: mouse(), parameters, noise, seed }
    }

    fn run(&self, drive: impl FnOnce(&mut MazeRunner<'_, crate::io::sim::SimRobot>, &Truth)) -> u32 {
        let start = self.scale.pose(self.maze.start(), self.maze.heading());
        let scene = Scene::with_robot(self.scale.world(&self.maze), self.spec.clone(), start);
        let simulation = Simulation::new(&scene, SimOptions::with_noise(self.noise, self.seed)).unwrap();
        let NoiseModel { wheel_scale, wheel_mismatch, track, slip, range, .. } =
            NoiseModel::real().scaled(self.noise);
        let errors = OdometryErrors { wheel_scale, wheel_mismatch, track, slip };
        let rig = Rig::new(&self.spec, errors, range).unwrap();
        let mut known = Maze::unexplored(self.maze.width(), self.maze.height()).unwrap();
        known.set_start(self.maze.start(), self.maze.heading());
        known.set_goals(self.maze.goals());
        let mut robot = simulation.robot(0).unwrap();
        let truth = simulation.truth();
        let (scale, parameters) = (self.scale, self.parameters);
        let mut runner = MazeRunner::new(&mut robot, rig, known, scale, parameters, f64::INFINITY).unwrap();
        drive(&mut runner, &truth);
        assert_known_rightly(runner.maze(), &self.maze);
        truth.robot(0).unwrap().contacts
    }
}

fn assert_known_rightly(known: &Maze, truth: &Maze) {
    for cell in truth.cells() {
        for side in crate::maze::Direction::ALL {
            let wall = known.wall(cell, side);
            assert!(wall == WallState::Unknown || wall == truth.wall(cell, side), "{cell} to the {side}");
        }
    }
}

fn explored_and_raced(trial: &Trial, within: f64) {
    let contacts = trial.run(|runner, truth| {
        let mut explorer = TwoPhaseExplorer::new(Goals::StepsAndTime(Box::new(runner.planner())));
        let mut off: f64 = 0.0;
        let mut watch = |pose: Pose| {
            off = off.max(truth.robot(0).unwrap().pose.distance_to(pose.position()));
        };
        let exploration = runner.explore(&mut explorer, &mut watch).unwrap();
        assert_eq!(exploration.verdict, ExplorationOutcome::Optimal);
        let plan = runner.plan_fast_run().unwrap();
        let best = runner.planner().plan(&trial.maze, Unknown::Closed).unwrap();
        assert!((plan.time - best.time).abs() < 2e-3, "{} against {}", plan.time, best.time);
        let time = runner.race(&plan, &mut watch).unwrap();
        assert!((time - plan.time).abs() <= within * plan.time, "{time} instead of {}", plan.time);
        assert!(off < 0.2 * trial.scale.cell, "{off} m off");
    });
    assert_eq!(contacts, 0);
}

#[test]
fn a_perfect_mouse_drives_as_planned() {
    for seed in [1, 2] {
        explored_and_raced(&Trial::mouse(seed, 0.0), 0.01);
    }
}

#[test]
fn a_real_mouse_explores_to_the_proof_and_races() {
    for seed in 3..8 {
        explored_and_raced(&Trial::mouse(seed, 1.0), 0.02);
    }
}

#[test]
fn an_eyebot_does_it_in_the_larger_maze() {
    let (scale, parameters) = (Scale::DOUBLED, MazeRunnerParameters::EYEBOT);
    let trial = Trial { scale, spec: RobotSpec::s4(), parameters, ..Trial::mouse(1, 1.0) };
    explored_and_raced(&trial, 0.02);
}

#[test]
fn recursive_exploration_learns_the_whole_maze() {
    let trial = Trial::mouse(9, 1.0);
    let contacts = trial.run(|runner, _| {
        let mut explorer: Box<dyn Explorer> = Box::new(RecursiveExplorer::new());
        let exploration = runner.explore(explorer.as_mut(), &mut |_| ()).unwrap();
        assert_eq!((exploration.verdict, runner.maze().unknown_walls()), (ExplorationOutcome::Explored, 0));
        assert!(exploration.visited <= 256);
    });
    assert_eq!(contacts, 0);
}

#[test]
fn odometry_is_calibrated_on_the_way() {
    let trial = Trial::mouse(5, 1.0);
    trial.run(|runner, truth| {
        let mut explorer = TwoPhaseExplorer::new(Goals::Steps);
        runner.explore(&mut explorer, &mut |_| ()).unwrap();
        let robot = truth.robot(0).unwrap();
        // Odometry alone is lost by then; the runner is not.
        let odometry = trial.scale.pose(trial.maze.start(), trial.maze.heading()).compose(&robot.odometry);
        let [alone, corrected] =
            [odometry, runner.pose()].map(|pose| robot.pose.distance_to(pose.position()));
        assert!(corrected < 0.01 && corrected < 0.2 * alone, "{corrected} against {alone}");
    });
}

#[test]
fn a_robot_without_its_sensors_is_refused() {
    let errors = OdometryErrors { wheel_scale: 0.0, wheel_mismatch: 0.0, track: 0.0, slip: 0.0 };
    let blind = RobotSpec { psds: Vec::new(), ..mouse() };
    let error = Rig::new(&blind, errors, 0.0).unwrap_err().to_string();
    assert!(error.contains("front PSD"), "{error}");
    assert!(Rig::new(&RobotSpec::car(), errors, 0.0).is_err());
}
