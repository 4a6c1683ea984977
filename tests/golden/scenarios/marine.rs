//! Craft in water: their equations, a dive, and a pool with a current, waves and walls.

use roverlab::drive::marine::{Dive, DiveParameters};
use roverlab::geometry::{Point3, Pose, Pose3, Twist, Vector};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, DepthSensor, Drive, Inertial, Motors, Odometry, Result};
use roverlab::kinematics::marine::{Craft, CraftSpec, CraftState, LocalWater as Around};
use roverlab::world::{RobotSpec, Scene, Water, Waves, World};

use super::{Scenario, noise, note, note_truth};

pub(super) const SCENARIOS: &[Scenario] =
    &[Scenario::new("craft", craft), Scenario::new("dive", dive), Scenario::new("pool", pool)];

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
