use super::body::Body;
use super::engine::Engine;
use super::fleet::FleetRobot;
use super::lockstep::check_duration;
use super::options::ticks_in;
use super::truth::robot_truth;
use super::{SimOptions, Watcher};
use crate::geometry::Pose;
use crate::io::{Key, Result, RobotTruth, TruthInSpace};
use crate::world::Scene;

/// A world that its caller steps: commands to any of its robots, then time, then readings.
///
/// It is a [`Fleet`](super::Fleet) without behaviours, for callers with a loop of their own, such as learning
/// environments and other languages. It can be sent to another thread. A run in which the same commands come
/// at the same times is the same in both.
///
/// ```
/// use roverlab::geometry::{Pose, Twist};
/// use roverlab::io::sim::{SimOptions, Stepped};
/// use roverlab::io::{DistanceSensors, Drive, Psd};
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// # fn main() -> Result<(), roverlab::io::Error> {
/// let scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.0));
/// let mut world = Stepped::new(&scene, SimOptions::ideal())?;
/// for _ in 0..200 {
///     let free = world.robot(0)?.distance(Psd::FRONT)?;
///     world.robot(0)?.set_speed(Twist::new(0.5 * (free - 0.2), 0.0))?;
///     world.run_for(0.1)?;
/// }
/// let truth = world.truth(0)?;
/// assert!((truth.pose.x - 1.735).abs() < 0.02 && truth.contacts == 0);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Stepped {
    engine: Engine,
}

impl Stepped {
    /// A world with all robots of a scene, at its start. Fails as [`Simulation::new`](super::Simulation::new)
    /// does.
    pub fn new(scene: &Scene, options: SimOptions) -> Result<Self> {
        Ok(Self { engine: Engine::new(scene, options)? })
    }

    /// Adds a watcher from now on.
    pub fn watch(&mut self, watcher: Box<dyn Watcher>) {
        self.engine.watch(watcher);
    }

    /// Number of robots.
    pub fn robots(&self) -> usize {
        self.engine.bodies.len()
    }

    /// A robot by its index in the scene. It cannot wait: time passes in [`run_for`](Self::run_for) only.
    /// Fails if there is no such robot.
    pub fn robot(&mut self, index: usize) -> Result<FleetRobot<'_>> {
        self.engine.body(index)?;
        Ok(FleetRobot::new(&mut self.engine, index))
    }

    /// Runs the world for `seconds`, rounded to whole ticks; not at all for a number below 0. Fails for a
    /// number that is not finite, and for more than 1e6 s.
    pub fn run_for(&mut self, seconds: f64) -> Result<()> {
        check_duration("duration", seconds)?;
        self.engine.run(ticks_in(seconds.max(0.0)));
        Ok(())
    }

    /// Schedules a key press on a robot, in seconds since the start; a past time means at once.
    pub fn press_key(&mut self, robot: usize, time: f64, key: Key) -> Result<()> {
        self.engine.press_key(robot, time, key)
    }

    /// Time since the start (s).
    pub fn time(&self) -> f64 {
        self.engine.time()
    }

    /// A robot's true pose in the world.
    pub fn pose(&self, robot: usize) -> Result<Pose> {
        self.engine.body(robot).map(Body::pose)
    }

    /// Number of a robot's contacts with walls, objects and robots so far.
    pub fn contacts(&self, robot: usize) -> Result<u32> {
        Ok(self.engine.body(robot)?.touch.contacts)
    }

    /// Pose of a robot in space, and its mishap, if any. Fails if there is no such robot.
    pub fn in_space(&self, robot: usize) -> Result<TruthInSpace> {
        let hills = self.engine.hills.as_ref();
        let mishap = hills.and_then(|hills| hills.mishap(robot));
        Ok(TruthInSpace { pose: self.engine.pose_in_space(robot)?, mishap })
    }

    /// Complete ground truth of a robot.
    pub fn truth(&self, robot: usize) -> Result<RobotTruth> {
        robot_truth(&self.engine, robot)
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::super::Fleet;
    use super::*;
    use crate::geometry::Twist;
    use crate::io::{Clock, Drive, Lidar, LidarScan, Manoeuvres, StallDetector};
    use crate::world::{RobotPlacement, RobotSpec, World};

    fn two_robots() -> Scene {
        let mut scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
        scene.robots.push(RobotPlacement::new(RobotSpec::s4().into(), Pose::new(1.5, 1.5, 2.0)));
        scene
    }

    /// A velocity that depends on what the lidar sees.
    fn decide(scan: &LidarScan) -> Twist {
        Twist::new(0.3, scan.ranges[10].min(2.0) - scan.ranges[350].min(2.0))
    }

    #[test]
    fn a_stepped_world_runs_as_a_fleet_does() {
        let (scene, options) = (two_robots(), SimOptions::with_noise(1.0, 7));
        let mut fleet = Fleet::new(&scene, options.clone()).unwrap();
        for robot in 0..2 {
            fleet
                .control(robot, 0.1, |robot| {
                    let twist = decide(&robot.scan()?);
                    robot.set_speed(twist)?;
                    Ok(ControlFlow::Continue(()))
                })
                .unwrap();
        }
        fleet.run_for(20.0).unwrap();
        let mut world = Stepped::new(&scene, options).unwrap();
        for _ in 0..200 {
            for robot in 0..2 {
                let mut robot = world.robot(robot).unwrap();
                let twist = decide(&robot.scan().unwrap());
                robot.set_speed(twist).unwrap();
            }
            world.run_for(0.1).unwrap();
        }
        assert_eq!(world.time(), fleet.time());
        for robot in 0..2 {
            let truth = world.truth(robot).unwrap();
            assert_eq!(truth, fleet.truth(robot).unwrap());
            assert_eq!(
                (truth.pose, truth.contacts),
                (world.pose(robot).unwrap(), world.contacts(robot).unwrap())
            );
            assert!(truth.path_length > 1.0);
        }
    }

    /// Drives run ahead of their robots; that must not show, whatever they do and whatever is in the way.
    #[test]
    fn many_ticks_at_once_are_as_many_ticks() {
        let mut scene = Scene::new(World::walled(1.2, 0.8));
        let specs = [RobotSpec::s4(), RobotSpec::s4(), RobotSpec::omni(), RobotSpec::s4()];
        for (index, spec) in specs.into_iter().enumerate() {
            let pose = Pose::new(0.2 + 0.25 * index as f64, 0.4, index as f64);
            scene.robots.push(RobotPlacement::new(spec.into(), pose));
        }
        let options = SimOptions { trail_interval: Some(0.07), ..SimOptions::with_noise(2.0, 3) };
        let mut worlds = [(); 2].map(|()| Stepped::new(&scene, options.clone()).unwrap());
        for step in 0..60 {
            for world in &mut worlds {
                let turn = 0.3 * f64::from(step % 5) - 0.6;
                world.robot(0).unwrap().set_speed(Twist::new(0.3, turn)).unwrap();
                world.robot(2).unwrap().set_speed(Twist::new(-0.2, turn)).unwrap();
                if step % 20 == 0 {
                    world.robot(1).unwrap().curve(0.15, turn, 0.3).unwrap();
                }
            }
            worlds[0].run_for(0.37).unwrap();
            (0..37).for_each(|_| worlds[1].run_for(0.01).unwrap());
            for robot in 0..4 {
                assert_eq!(worlds[0].truth(robot).unwrap(), worlds[1].truth(robot).unwrap(), "step {step}");
                let stalled = |world: &mut Stepped| world.robot(robot).unwrap().is_stalled().unwrap();
                assert_eq!(stalled(&mut worlds[0]), stalled(&mut worlds[1]));
            }
        }
        assert!((0..3).all(|robot| worlds[0].contacts(robot).unwrap() > 0));
    }

    #[test]
    fn only_its_caller_lets_time_pass() {
        let mut world = Stepped::new(&two_robots(), SimOptions::ideal()).unwrap();
        world.robot(0).unwrap().straight(0.5, 0.2).unwrap();
        assert!(world.robot(0).unwrap().wait(1.0).is_err() && world.robot(0).unwrap().wait_done().is_err());
        world.run_for(-1.0).unwrap();
        assert_eq!(world.time(), 0.0);
        world.run_for(4.0).unwrap();
        assert!(world.robot(0).unwrap().is_done().unwrap());
        assert!(world.run_for(f64::NAN).is_err() && world.run_for(2e6).is_err());
        assert!(world.robot(2).is_err() && world.pose(2).is_err() && world.contacts(2).is_err());
    }

    #[test]
    fn it_may_move_to_another_thread() {
        fn moves<T: Send>() {}
        moves::<Stepped>();
    }
}
