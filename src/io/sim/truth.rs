use std::sync::Arc;

use super::engine::{Engine, Thing};
use super::lockstep::Lockstep;
use crate::geometry::{Pose, Pose3};
use crate::io::reading::pose_in_words;
use crate::io::{Error, GroundTruth, Mishap, Result, RobotTruth, TruthInSpace};
use crate::parameter::require_finite;

/// Ground truth of a simulated world. Robots have no access to it; it is for verdicts, pictures and tests.
#[derive(Debug, Clone)]
pub struct Truth {
    shared: Arc<Lockstep<Engine>>,
}

impl Truth {
    pub(super) fn new(shared: Arc<Lockstep<Engine>>) -> Self {
        Self { shared }
    }

    /// Time since the start of the world (s).
    pub fn time(&self) -> f64 {
        self.shared.lock().world.time()
    }

    /// A robot's pose in the world.
    ///
    /// # Errors
    ///
    /// If there is no robot of that number.
    pub fn pose(&self, robot: usize) -> Result<Pose> {
        Ok(self.shared.lock().world.body(robot)?.pose())
    }

    /// A robot's pose in space: on hills with elevation, roll and pitch, otherwise level.
    ///
    /// # Errors
    ///
    /// If there is no robot of that number.
    pub fn pose_in_space(&self, robot: usize) -> Result<Pose3> {
        self.shared.lock().world.pose_in_space(robot)
    }

    /// Why a robot on hills no longer drives, or drives without effect.
    ///
    /// # Errors
    ///
    /// If there is no robot of that number.
    pub fn mishap(&self, robot: usize) -> Result<Option<Mishap>> {
        let state = self.shared.lock();
        state.world.body(robot)?;
        Ok(state.world.hills.as_ref().and_then(|hills| hills.mishap(robot)))
    }

    /// Complete ground truth of a robot.
    ///
    /// # Errors
    ///
    /// If there is no robot of that number.
    pub fn robot(&self, robot: usize) -> Result<RobotTruth> {
        robot_truth(&self.shared.lock().world, robot)
    }

    /// An object's pose in the world, by its index in the scene; robots may have pushed it.
    ///
    /// # Errors
    ///
    /// If there is no object of that number.
    pub fn object(&self, object: usize) -> Result<Pose> {
        let state = self.shared.lock();
        let engine = &state.world;
        let objects = engine.space.solids() - engine.bodies.len();
        let found = engine.movables.get(object).map(|movable| engine.space.solid(movable.solid).pose);
        found.ok_or_else(|| {
            let expected = format!("an index below {objects}, the number of objects");
            Error::invalid_input("object", object, &expected)
        })
    }

    /// Height of an object's foot above the floor, by its index in the scene (m); on hills, its foot is on
    /// the ground.
    ///
    /// # Errors
    ///
    /// If there is no object of that number.
    pub fn object_elevation(&self, object: usize) -> Result<f64> {
        self.object(object)?;
        let state = self.shared.lock();
        let solid = state.world.movables[object].solid;
        Ok(state.world.space.solid(solid).bottom + state.world.space.level(solid))
    }

    /// Whether an object has been knocked over, by its index in the scene.
    ///
    /// # Errors
    ///
    /// If there is no object of that number.
    pub fn has_fallen(&self, object: usize) -> Result<bool> {
        self.object(object)?;
        let state = self.shared.lock();
        let solid = state.world.space.solid(state.world.movables[object].solid);
        Ok(solid.top <= solid.bottom)
    }

    /// Places a robot at a pose at the beginning of the next tick, on behalf of the program of the robot
    /// `by`.
    ///
    /// The effect of programs in lockstep depends on ticks only, never on their speed: within one tick,
    /// requests are executed in the order of the robots' indices.
    ///
    /// # Errors
    ///
    /// If there is no robot of the number `robot`, or the pose is not finite.
    pub fn move_robot(&self, by: usize, robot: usize, pose: Pose) -> Result<()> {
        let mut state = self.shared.lock();
        state.world.body(robot)?;
        require_finite_pose(pose)?;
        state.world.place_later(by, Thing::Robot(robot), pose, 0.0);
        Ok(())
    }

    /// Like [`move_robot`](Truth::move_robot), to `z` metres above the floor, from where the robot drops on
    /// hills. Where the ground is higher, and on a level floor, `z` has no effect.
    ///
    /// # Errors
    ///
    /// If there is no robot of the number `robot`, or the pose or `z` is not finite.
    pub fn drop_robot(&self, by: usize, robot: usize, pose: Pose, z: f64) -> Result<()> {
        let mut state = self.shared.lock();
        state.world.body(robot)?;
        require_finite_pose(pose)?;
        require_finite("elevation", z)?;
        state.world.place_later(by, Thing::Robot(robot), pose, z);
        Ok(())
    }

    /// Like [`move_robot`](Truth::move_robot), for an object.
    ///
    /// # Errors
    ///
    /// If there is no object of that number, or the pose is not finite.
    pub fn move_object(&self, by: usize, object: usize, pose: Pose) -> Result<()> {
        self.object(object)?;
        require_finite_pose(pose)?;
        self.shared.lock().world.place_later(by, Thing::Object(object), pose, 0.0);
        Ok(())
    }

    /// Places a robot at a pose, as if by hand, without a change of its odometry.
    ///
    /// # Errors
    ///
    /// If there is no robot of that number, or the pose is not finite.
    pub fn set_pose(&self, robot: usize, pose: Pose) -> Result<()> {
        let mut state = self.shared.lock();
        state.world.body(robot)?;
        require_finite_pose(pose)?;
        state.world.place(robot, pose, 0.0);
        Ok(())
    }

    /// Places an object at a pose, as if by hand, by its index in the scene.
    ///
    /// # Errors
    ///
    /// If there is no object of that number, or the pose is not finite.
    pub fn set_object(&self, object: usize, pose: Pose) -> Result<()> {
        self.object(object)?;
        require_finite_pose(pose)?;
        self.shared.lock().world.place_object(object, pose);
        Ok(())
    }
}

pub(super) fn require_finite_pose(pose: Pose) -> Result<()> {
    if pose.is_finite() {
        return Ok(());
    }
    Err(Error::invalid_input("pose", pose_in_words(&pose), "finite numbers"))
}

pub(super) fn robot_truth(engine: &Engine, robot: usize) -> Result<RobotTruth> {
    let (body, machine) = (engine.body(robot)?, &engine.machines[robot]);
    Ok(RobotTruth {
        pose: body.pose(),
        odometry: machine.drive.get().odometry(),
        contacts: body.touch.contacts,
        contact_places: body.touch.places.clone(),
        path_length: body.path_length,
        trail: machine.trail.clone(),
    })
}

impl GroundTruth for Truth {
    fn time(&mut self) -> Result<f64> {
        Ok(Truth::time(self))
    }

    fn pose(&mut self, robot: usize) -> Result<Pose> {
        Truth::pose(self, robot)
    }

    fn robot(&mut self, robot: usize) -> Result<RobotTruth> {
        Truth::robot(self, robot)
    }

    fn object(&mut self, object: usize) -> Result<Pose> {
        Truth::object(self, object)
    }

    fn in_space(&mut self, robot: usize) -> Result<TruthInSpace> {
        Ok(TruthInSpace { pose: self.pose_in_space(robot)?, mishap: self.mishap(robot)? })
    }
}
