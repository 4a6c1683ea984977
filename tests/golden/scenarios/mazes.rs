//! Mazes: files, floods, routes, exploration, time-optimal plans, and robots that drive in them.

use roverlab::geometry::Pose;
use roverlab::io::control::{run, until};
use roverlab::io::sim::NoiseModel;
use roverlab::io::{Error, ErrorKind, Result};
use roverlab::kinematics::OdometryErrors;
use roverlab::maze::files::{MazeFormat, parse, print};
use roverlab::maze::mms::{MmsMouse, MmsReferee, Move};
use roverlab::maze::{
    CellDriveParameters, Direction, ExplorationStep, Explorer, FastPlanner, Goals, IncrementalFlood,
    LeftHand, LeftHandParameters, LidarLeft, LidarLeftParameters, Maze, MazeRunner, MazeRunnerParameters,
    Passages, Preference, RecursiveExplorer, Rig, RunLimits, Scale, Straight, Trajectory, TwoPhaseExplorer,
    Unknown, distances_from_start, distances_to_goal, mouse, shortest_route,
};
use roverlab::world::{RobotSpec, Scene};

use super::{Scenario, noise, note, other, ride};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("maze-files", files),
    Scenario::new("maze-flood", flood),
    Scenario::new("maze-routes", routes),
    Scenario::new("maze-exploration", exploration),
    Scenario::new("maze-fast-run", fast_run),
    Scenario::new("maze-left-hand", left_hand),
    Scenario::new("maze-lidar", lidar),
    Scenario::new("micromouse", micromouse),
    Scenario::new("mms", mms),
    Scenario::new("maze-generators", generators),
];

const MAZE: &str = "\
o---o---o---o---o---o---o
|           |           |
o   o---o   o   o---o   o
|   |   |       |       |
o   o   o---o   o---o   o
|   |       | G |       |
o   o---o   o---o   o   o
|       |           |   |
o   o---o   o---o---o   o
|                   |   |
o   o   o---o   o   o   o
| S |       |   |       |
o---o---o---o---o---o---o
";

fn maze() -> Result<Maze> {
    Ok(parse(MAZE.as_bytes(), "golden").map_err(other)?.maze)
}

/// What a robot knows of a maze at first.
fn unexplored(truth: &Maze) -> Result<Maze> {
    let mut known = Maze::unexplored(truth.width(), truth.height()).map_err(other)?;
    known.set_start(truth.start(), truth.heading());
    known.set_goals(truth.goals());
    Ok(known)
}

/// A maze printed in each format and read again.
fn files() -> Result<String> {
    const FORMATS: [MazeFormat; 5] =
        [MazeFormat::Text, MazeFormat::Maze, MazeFormat::Map, MazeFormat::Num, MazeFormat::EyeSim];
    let mut log = String::new();
    for maze in [maze()?, unexplored(&maze()?)?] {
        for format in FORMATS {
            match print(&maze, format) {
                Ok(text) => {
                    log += &text;
                    note(&mut log, "again", &parse(text.as_bytes(), "again").map_err(other)?.defects);
                }
                Err(error) => note(&mut log, "refused", &error.to_string()),
            }
        }
    }
    for broken in [MAZE.replace("|   |   |       |       |", "|   |?"), "no maze".repeat(9)] {
        let parsed = parse(broken.as_bytes(), "broken").map(|file| file.defects);
        note(&mut log, "broken", &parsed.map_err(|error| error.to_string()));
    }
    Ok(log)
}

/// Distances from the start and to the goal, and how they change as walls are found.
fn flood() -> Result<String> {
    let maze = maze()?;
    let mut log = String::new();
    note(&mut log, "to the goal", &distances_to_goal(&maze, Unknown::Closed).as_slice());
    note(&mut log, "from the start", &distances_from_start(&maze, Unknown::Open).as_slice());
    let known = unexplored(&maze)?;
    let mut flood = IncrementalFlood::new(Passages::new(&known, Unknown::Open), maze.goals());
    for cell in maze.cells() {
        for side in Direction::ALL {
            let changed = flood.set(cell, side, maze.passage(cell, side, Unknown::Closed).is_some());
            note(&mut log, "wall", &(cell, side, changed, flood.distances().get(maze.start())));
        }
    }
    note(&mut log, "in the end", &flood.distances().as_slice());
    Ok(log)
}

fn routes() -> Result<String> {
    let maze = maze()?;
    let mut log = String::new();
    for preference in [Preference::Steps, Preference::Turns, Preference::StepsAndTurns] {
        let route = shortest_route(&maze, Unknown::Closed, preference);
        note(&mut log, "route", &route.map(|route| (route.steps(), route.turns(), route.moves().to_vec())));
    }
    Ok(log)
}

fn planner() -> Result<FastPlanner> {
    FastPlanner::new(Scale::MICROMOUSE, RunLimits::MICROMOUSE).map_err(other)
}

/// Which cells each explorer goes to, and what it knows in the end.
fn exploration() -> Result<String> {
    let truth = maze()?;
    let explorers: [Box<dyn Explorer>; 4] = [
        Box::new(RecursiveExplorer::new()),
        Box::new(RecursiveExplorer::without_early_marking()),
        Box::new(TwoPhaseExplorer::new(Goals::Steps)),
        Box::new(TwoPhaseExplorer::new(Goals::StepsAndTime(Box::new(planner()?)))),
    ];
    let mut log = String::new();
    for mut explorer in explorers {
        let (mut known, mut at) = (unexplored(&truth)?, (truth.start(), truth.heading()));
        loop {
            for side in Direction::ALL {
                known.set_wall(at.0, side, truth.wall(at.0, side));
            }
            let step = explorer.next(&known, at);
            note(&mut log, "step", &step);
            let ExplorationStep::Go(next) = step else { break };
            let side = Direction::ALL.into_iter().find(|&side| known.neighbour(at.0, side) == Some(next));
            at = (next, side.unwrap_or(at.1));
        }
        note(&mut log, "unknown walls", &known.unknown_walls());
    }
    Ok(log)
}

/// The time-optimal plan and its trajectory for a mouse and for an EyeBot.
fn fast_run() -> Result<String> {
    let maze = maze()?;
    let mut log = String::new();
    for (scale, limits) in
        [(Scale::MICROMOUSE, RunLimits::MICROMOUSE), (Scale::DOUBLED, MazeRunnerParameters::EYEBOT.racing)]
    {
        let plan = FastPlanner::new(scale, limits).map_err(other)?.plan(&maze, Unknown::Closed);
        let Some(plan) = plan else { return Err(Error::new(ErrorKind::Other, "the maze has a way")) };
        note(&mut log, "plan", &(plan.time, plan.start, plan.route.moves(), &plan.pieces));
        let trajectory = Trajectory::new(&plan, scale, limits).map_err(other)?;
        note(&mut log, "trajectory", &(trajectory.duration(), trajectory.length(), trajectory.end()));
        let share = |k: u32| trajectory.at(0.02 * f64::from(k) * trajectory.duration());
        (0..=50).for_each(|k| note(&mut log, "at", &(share(k).pose, share(k).twist)));
    }
    Ok(log)
}

/// A robot at the start of the maze.
fn scene(scale: Scale, spec: RobotSpec) -> Result<Scene> {
    let maze = maze()?;
    let start = scale.pose(maze.start(), maze.heading());
    Ok(Scene::with_robot(scale.world(&maze), spec, start))
}

/// The robot as the runner knows it.
fn rig(spec: &RobotSpec) -> Result<Rig> {
    let NoiseModel { wheel_scale, wheel_mismatch, track, slip, range, .. } = NoiseModel::real();
    Rig::new(spec, OdometryErrors { wheel_scale, wheel_mismatch, track, slip }, range)
}

/// The left hand on the wall: by odometry alone, in the middle by a proportional controller, and by a PID
/// controller.
fn left_hand() -> Result<String> {
    let (scale, spec) = (Scale::DOUBLED, RobotSpec::s4());
    let rig = rig(&spec)?;
    let speed = 0.5 * scale.cell;
    let open = Straight::OpenLoop { length: scale.cell, speed };
    let mut log = String::new();
    for parameters in [
        LeftHandParameters {
            straight: open,
            threshold: scale.cell / 0.9,
            ..LeftHandParameters::as_printed()
        },
        LeftHandParameters::controlled(CellDriveParameters::proportional(&rig, scale, speed)),
        LeftHandParameters::controlled(CellDriveParameters::pid(&rig, scale, speed)),
    ] {
        let mut cells = Vec::new();
        let mut rule = LeftHand::new(parameters, Direction::North)?;
        log += &ride(&scene(scale, spec.clone())?, noise(0.5, 71), |robot| {
            run(robot, &mut rule, 600.0, |_, rule, _| {
                if rule.cells() > cells.len() {
                    cells.push((rule.at(), rule.heading()));
                }
                until(cells.len() > 9)
            })?;
            Ok(())
        })?;
        note(&mut log, "cells", &cells);
    }
    Ok(log)
}

/// Along the left wall by lidar, for 400 steps.
fn lidar() -> Result<String> {
    let mut seen = String::new();
    let scale = Scale::DOUBLED;
    let log = ride(&scene(scale, RobotSpec::s4())?, noise(1.0, 72), |robot| {
        let mut follower = LidarLeft::new(LidarLeftParameters::for_corridor(scale.cell))?;
        let mut steps = 0;
        run(robot, &mut follower, 60.0, |_, _, step| {
            steps += 1;
            note(&mut seen, "seen", &(step.seen.pose, step.seen.points().count()));
            until(steps > 400)
        })
        .map(|_| ())
    })?;
    Ok(log + &seen)
}

/// A mouse that explores until the best route is proved, and races it.
fn micromouse() -> Result<String> {
    let mut told = String::new();
    let (scale, spec) = (Scale::MICROMOUSE, mouse());
    let log = ride(&scene(scale, spec.clone())?, noise(1.0, 73), |robot| {
        let known = unexplored(&maze()?)?;
        let parameters = MazeRunnerParameters::MICROMOUSE;
        let mut runner = MazeRunner::new(robot, rig(&spec)?, known, scale, parameters, f64::INFINITY)?;
        let mut explorer = TwoPhaseExplorer::new(Goals::StepsAndTime(Box::new(runner.planner())));
        let mut watch = |pose: Pose| note(&mut told, "at", &pose);
        let exploration = runner.explore(&mut explorer, &mut watch)?;
        let plan = runner.plan_fast_run();
        let race = plan.as_ref().map(|plan| runner.race(plan, &mut watch)).transpose()?;
        note(&mut told, "exploration", &(exploration.verdict, exploration.visited, exploration.looks));
        note(&mut told, "times", &(exploration.time, plan.map(|plan| plan.time), race));
        let calibration = runner.calibration();
        note(&mut told, "calibration", &(calibration.distance, calibration.angle, calibration.bend));
        note(&mut told, "pose", &(runner.pose(), runner.maze().unknown_walls()));
        Ok(())
    })?;
    Ok(log + &told)
}

/// What a mouse and the referee of the simulator `mms` say to each other.
fn mms() -> Result<String> {
    let mut referee = MmsReferee::new(maze()?);
    let mut mouse = MmsMouse::new();
    let (mut log, mut answer) = (String::new(), None);
    loop {
        let step = mouse.step(answer.as_deref()).map_err(other)?;
        note(&mut log, "mouse", &step);
        let Move::Say(line) = step else { break };
        answer = referee.answer(&line);
        note(&mut log, "referee", &answer);
    }
    let score = referee.score();
    note(&mut log, "score", &(score.value(), score.total_distance, score.total_turns, score.total_effective));
    Ok(log)
}

fn generators() -> Result<String> {
    use roverlab::maze::generate::{braided, competition, perfect};

    let mut log = String::new();
    for maze in [perfect(9, 7, 74), braided(12, 12, 0.3, 75), competition(16, 76)] {
        let maze = maze.map_err(other)?;
        log += &print(&maze, MazeFormat::Text).map_err(other)?;
        note(&mut log, "goals", &maze.goals().collect::<Vec<_>>());
    }
    Ok(log)
}
