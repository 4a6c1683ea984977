//! Craft in water: their equations, a dive, a pool with a current, waves and walls, and behaviours in it.

use std::sync::Arc;

use roverlab::drive::marine::{
    Boat, BoatParameters, DepthMap, Dive, DiveParameters, PoolSearch, PoolSearchParameters, PoolWall,
    PoolWallParameters, Survey, SurveyParameters,
};
use roverlab::geometry::{Aabb, Point, Point3, Pose, Pose3, Twist, Vector};
use roverlab::io::control::{Behaviour, Senses, run};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
use roverlab::io::{Clock, DepthSensor, Drive, Inertial, Motors, Odometry, Result};
use roverlab::kinematics::marine::{Craft, CraftSpec, CraftState, LocalWater as Around};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, Water, Waves, World};

use super::{Scenario, noise, note, note_truth};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("craft", craft),
    Scenario::new("dive", dive),
    Scenario::new("pool", pool),
    Scenario::new("boat", boat),
    Scenario::new("pool-wall", pool_wall),
    Scenario::new("survey", survey),
    Scenario::new("pool-search", pool_search),
];

/// Mako and the raft from odd attitudes, in the air, at the surface and below it.
fn craft() -> Result<String> {
    let mut log = String::new();
    for spec in [CraftSpec::mako(), CraftSpec::solar_raft()] {
        let craft = Craft::new(&spec, 0.01)?;
        for (height, roll, pitch) in [(-3.0, 0.7, 0.3), (0.0, -2.0, 0.9), (0.4, 0.2, -1.2)] {
            let pose = Pose3::from_angles(Point3::new(0.0, 0.0, height), roll, pitch, 0.4);
            let mut state = CraftState::at_rest(&craft, &pose);
            for tick in 0..600 {
                let commands = if tick < 300 { &[0.7, -0.4, 0.6, -0.5][..] } else { &[] };
                craft.advance(&mut state, commands, &Around::still(0.0));
                if tick % 100 == 99 {
                    note(&mut log, "state", &state);
                }
            }
        }
    }
    Ok(log)
}

fn sea(water: Water) -> Scene {
    let world = World { water_level: Some(2.0), water, ..World::walled(6.0, 6.0) };
    Scene::with_robot(world, RobotSpec::mako(), Pose::new(3.0, 3.0, 0.3))
}

fn dive() -> Result<String> {
    let mut log = String::new();
    let simulation = Simulation::new(&sea(Water::default()), noise(1.0, 8))?;
    let parameters = DiveParameters { duration: 30.0, ..DiveParameters::default() };
    let mut behaviour = Dive::new(&CraftSpec::mako(), parameters)?;
    let outcome = run(&mut simulation.robot(0)?, &mut behaviour, 40.0, |_, _, step| {
        note(&mut log, "seen", step.seen);
    })?;
    note(&mut log, "outcome", &outcome);
    note(&mut log, "end", &simulation.truth().pose_in_space(0)?);
    note_truth(&mut log, &simulation.truth().robot(0)?);
    Ok(log)
}

fn pool() -> Result<String> {
    let mut log = String::new();
    let waves = Waves { height: 0.1, period: 2.5, direction: 0.5, irregular: true };
    let layers = vec![(0.0, Vector::new(0.1, 0.05)), (1.5, Vector::zeros())];
    let water =
        Water { current: layers, waves: Some(waves), wind: Vector::new(3.0, -1.0), ..Water::default() };
    let simulation = Simulation::new(&sea(water), SimOptions::with_noise(1.0, 3))?;
    let mut mako = simulation.robot(0)?;
    for (motor, fraction) in [(1, 0.8), (2, -1.0), (3, 1.0), (4, -0.9)] {
        mako.set_motor(motor, fraction)?;
    }
    for second in 0..20 {
        if second == 12 {
            mako.set_speed(Twist::new(-0.2, 0.3))?;
        }
        mako.wait(1.0)?;
        note(&mut log, "pose", &simulation.truth().pose_in_space(0)?);
        note(&mut log, "seen", &(mako.depth()?, mako.attitude()?, mako.pose()?));
    }
    note_truth(&mut log, &simulation.truth().robot(0)?);
    Ok(log)
}

/// Where Mako begins in a pool of 5 m x 4 m, in which a red brick lies.
const START: Pose = Pose::new(1.5, 1.5, 0.0);

fn basin() -> (Scene, Aabb) {
    let water = Water { turbidity: 0.4, ..Water::default() };
    let mut world = World { water_level: Some(2.0), water, ..World::walled(5.0, 4.0) };
    for wall in &mut world.walls {
        wall.height = 3.0;
    }
    let brick = Shape::Box { length: 0.25, width: 0.2, height: 0.1 };
    let kind = ObjectKind { mass: 8.0, ..ObjectKind::new("brick", brick, Colour::from_hex(0xc8_20_20)) };
    world.objects.push(Object::new(Arc::new(kind), Pose::new(3.2, 2.4, 0.4)));
    let mako = RobotSpec { dvl: Some(10.0), ..RobotSpec::mako() };
    (Scene::with_robot(world, mako, START), Aabb::new(Point::origin(), Point::new(5.0, 4.0)))
}

/// A behaviour's run: what it tells at each step, how it ended, and where.
fn swim<B: Behaviour + Senses<SimRobot>>(
    scene: &Scene,
    seed: u64,
    behaviour: &mut B,
    seconds: f64,
    mut tell: impl FnMut(&mut String, &B),
) -> Result<String>
where
    B::Command: roverlab::io::control::Command<SimRobot>,
    B::Outcome: std::fmt::Debug,
{
    let mut log = String::new();
    let simulation = Simulation::new(scene, noise(1.0, seed))?;
    let outcome = run(&mut simulation.robot(0)?, behaviour, seconds, |_, behaviour, _| {
        tell(&mut log, behaviour);
    })?;
    note(&mut log, "outcome", &outcome);
    note(&mut log, "end", &simulation.truth().pose_in_space(0)?);
    note_truth(&mut log, &simulation.truth().robot(0)?);
    Ok(log)
}

/// The raft in a current and wind.
fn boat() -> Result<String> {
    let water = Water {
        current: vec![(0.0, Vector::new(0.05, 0.15))],
        wind: Vector::new(-2.0, 1.0),
        ..Water::default()
    };
    let lake = World { water_level: Some(3.0), water, ..World::empty(20.0, 20.0) };
    let raft = RobotSpec { dvl: Some(10.0), ..RobotSpec::solar_raft() };
    let start = Pose::new(4.0, 4.0, 0.0);
    let course = [Point::new(9.0, 4.0), Point::new(9.0, 7.0)];
    let mut boat = Boat::new(&CraftSpec::solar_raft(), start, &course, BoatParameters::default())?;
    swim(&Scene::with_robot(lake, raft, start), 9, &mut boat, 90.0, |log, boat| note(log, "boat", boat))
}

fn pool_wall() -> Result<String> {
    let (scene, _) = basin();
    let mut wall = PoolWall::new(&scene.robots[0].spec, PoolWallParameters::default())?;
    swim(&scene, 10, &mut wall, 60.0, |log, wall| note(log, "laps", &wall.laps()))
}

fn survey() -> Result<String> {
    let (scene, area) = basin();
    let mut survey = Survey::new(&scene.robots[0].spec, START, area, true, SurveyParameters::default())?;
    let mut map = DepthMap::new(area.inflated(-0.5), 1.0)?;
    let mut log = swim(&scene, 11, &mut survey, 60.0, |log, survey| {
        let sounding = survey.sounding();
        note(log, "sounding", &sounding);
        if let Some(sounding) = sounding {
            map.add(sounding);
        }
    })?;
    note(&mut log, "map", &map);
    Ok(log)
}

fn pool_search() -> Result<String> {
    let (scene, area) = basin();
    let mut search =
        PoolSearch::new(&scene.robots[0].spec, START, area, true, PoolSearchParameters::default())?;
    swim(&scene, 12, &mut search, 60.0, |log, search| note(log, "place", &search.place()))
}
