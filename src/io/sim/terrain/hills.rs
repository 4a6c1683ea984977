use std::sync::Arc;

use super::{RigidBody, Undercarriage, Watch};
use crate::geometry::{Aabb, Point, Point3, Pose, Pose3, Vector, angle_difference};
use crate::io::sim::TICK;
use crate::io::sim::body::Body;
use crate::io::sim::drive_mechanics::Drift;
use crate::io::sim::machine::Machine;
use crate::io::sim::marine::{Swimmer, Waters};
use crate::io::sim::movable::Movable;
use crate::io::{Mishap, Result};
use crate::kinematics::{PlanarMotion, PlanarTwist};
use crate::world::space::Space;
use crate::world::{DriveSpec, HeightField, RobotPlacement, World};

/// The ground of a world with hills, the water above it, and the robots on the ground and in the water.
#[derive(Debug)]
pub(in crate::io::sim) struct Hills {
    ground: Arc<HeightField>,
    waters: Waters,
    movers: Vec<Mover>,
}

/// A robot on hills, or in water.
#[derive(Debug)]
enum Mover {
    Riding(Box<Rider>),
    Swimming(Box<Swimmer>),
}

/// A robot on hills.
#[derive(Debug)]
struct Rider {
    carriage: Undercarriage,
    body: RigidBody,
    watch: Watch,
}

/// Displacement of an outline above which an obstacle was in its way (m or rad).
const MOVED_ASIDE: f64 = 1e-9;
/// Motion that counts as rest (m or rad).
const STILL: f64 = 1e-11;
/// Height above the ground up to which a robot counts as standing (m).
const STANDING: f64 = 2e-3;

impl Hills {
    /// The hills of a world, if it has any. A level floor counts as well for craft, under water, where other
    /// robots drown, and below robots that drop onto it.
    pub(in crate::io::sim) fn of(
        world: &World,
        robots: &[RobotPlacement],
        machines: &mut [Machine],
        seed: u64,
    ) -> Result<Option<Box<Self>>> {
        world.water.validate()?;
        let surface = world.terrain.as_ref().and_then(|terrain| terrain.surface.clone());
        let craft = machines.iter_mut().any(|machine| machine.drive.craft_mut().is_some());
        let is_wet = world.water_level.is_some_and(|level| level > 0.0);
        let drops = robots.iter().any(|robot| robot.elevation > 0.0);
        let ground = match surface {
            Some(surface) => surface,
            None if craft || is_wet || drops => Arc::new(level_floor(world)?),
            None => return Ok(None),
        };
        let waters = Waters::of(world, seed);
        let mut hills = Self { ground, waters, movers: Vec::new() };
        for (robot, machine) in robots.iter().zip(machines) {
            hills.movers.push(hills.mover(robot, machine, world.water_level));
        }
        Ok(Some(Box::new(hills)))
    }

    fn mover(&self, robot: &RobotPlacement, machine: &mut Machine, water_level: Option<f64>) -> Mover {
        if let (DriveSpec::Craft(spec), Some(drive)) = (&robot.spec.drive, machine.drive.craft_mut()) {
            let mut swimmer = Swimmer::new(drive.craft().clone(), spec.windage());
            swimmer.place(&self.ground, &self.waters, robot.pose, robot.elevation);
            return Mover::Swimming(Box::new(swimmer));
        }
        let carriage = Undercarriage::of(&robot.spec);
        let body = standing(&self.ground, &carriage, robot.pose, robot.elevation);
        let watch = Watch::new(robot.spec.height, water_level);
        Mover::Riding(Box::new(Rider { carriage, body, watch }))
    }

    /// Surface of the ground.
    pub(in crate::io::sim) fn ground(&self) -> &HeightField {
        &self.ground
    }

    /// Pose of a robot in space.
    pub(in crate::io::sim) fn pose(&self, robot: usize) -> Pose3 {
        self.movers[robot].pose()
    }

    /// Depth of the water above a point that is a given height above a robot's origin (m).
    pub(in crate::io::sim) fn depth(&self, robot: usize, up: f64, time: f64) -> f64 {
        let place = self.pose(robot).to_world(Point3::new(0.0, 0.0, up));
        (self.waters.surface(place.xy(), time) - place.z).max(0.0)
    }

    /// Mishap of a robot that can no longer drive.
    pub(in crate::io::sim) fn mishap(&self, robot: usize) -> Option<Mishap> {
        match &self.movers[robot] {
            Mover::Riding(rider) => rider.watch.mishap(),
            Mover::Swimming(swimmer) => swimmer.is_broken().then_some(Mishap::Broken),
        }
    }

    /// Elevation of the ground under a point (m); beyond the hills, that of the floor.
    pub(in crate::io::sim) fn ground_level(&self, point: Point) -> f64 {
        self.ground.height(point).unwrap_or(0.0)
    }

    /// Elevation on which an object stands at a point (m): the ground, or the water if it floats.
    pub(in crate::io::sim) fn level(&self, point: Point, object: &Movable) -> f64 {
        let ground = self.ground_level(point);
        let draught = object.draught(self.waters.density());
        draught.map_or(ground, |draught| ground.max(self.waters.level() - draught))
    }

    /// Places a robot on the ground, in the water, or at a height above the ground (m).
    pub(in crate::io::sim) fn place(&mut self, robot: usize, pose: Pose, elevation: f64) {
        match &mut self.movers[robot] {
            Mover::Riding(rider) => {
                rider.body = standing(&self.ground, &rider.carriage, pose, elevation);
                rider.watch.forget();
            }
            Mover::Swimming(swimmer) => swimmer.place(&self.ground, &self.waters, pose, elevation),
        }
    }

    /// Moves all robots for one tick, and replaces the motion of their wheels by that of their frames in the
    /// plane.
    pub(in crate::io::sim) fn ride(
        &mut self,
        bodies: &mut [Body],
        machines: &mut [Machine],
        drifts: &mut [Drift],
        time: f64,
    ) {
        let robots = self.movers.iter_mut().zip(bodies).zip(machines);
        for (((mover, body), machine), Drift { motion, reach, .. }) in robots.zip(drifts) {
            match mover {
                Mover::Riding(rider) => {
                    let drive = if rider.watch.is_over() { PlanarTwist::STOP } else { speed(*motion) };
                    rider.step(&self.ground, &drive);
                }
                Mover::Swimming(swimmer) => {
                    let Some(drive) = machine.drive.craft_mut() else { continue };
                    if let Some(place) = swimmer.step(&self.ground, &self.waters, drive, time) {
                        body.touch.count(place);
                    }
                }
            }
            let there = mover.pose().pose();
            let motionless = body.pose().distance_to(there.position()) < STILL;
            let turned = angle_difference(there.heading, body.pose().heading).abs();
            *motion = if motionless && turned < STILL {
                PlanarMotion::default()
            } else {
                PlanarMotion::between(body.pose(), there)
            };
            *reach = body.reach(*motion);
        }
    }

    /// Takes obstacles in the robots' way into account, and updates the robots' solids.
    pub(in crate::io::sim) fn yield_to(
        &mut self,
        bodies: &mut [Body],
        machines: &[Machine],
        space: &mut Space,
    ) {
        for ((mover, body), machine) in self.movers.iter_mut().zip(bodies).zip(machines) {
            let pose = mover.pose();
            let (there, moved) = (body.pose(), pose.pose());
            let aside = there.position() - moved.position();
            let turned = angle_difference(there.heading, moved.heading);
            if aside.norm().max(turned.abs()) > MOVED_ASIDE {
                match mover {
                    Mover::Riding(rider) => rider.body.shove(aside, turned, TICK),
                    Mover::Swimming(swimmer) => swimmer.shove(aside, turned),
                }
            }
            let above = pose.position.z - self.ground.height(there.position()).unwrap_or(0.0);
            let above = if above > STANDING { above } else { 0.0 };
            body.span.bottom = above;
            body.span.top = above + machine.spec.height;
            let level = pose.position.z - space.solid(body.solid).bottom;
            space.set_level(body.solid, level);
        }
    }

    /// Lets the drives of craft measure how these have moved in a tick.
    pub(in crate::io::sim) fn measure(&self, machines: &mut [Machine]) {
        for (mover, machine) in self.movers.iter().zip(machines) {
            if let (Mover::Swimming(swimmer), Some(drive)) = (mover, machine.drive.craft_mut()) {
                swimmer.measure(&self.ground, drive);
            }
        }
    }
}

impl Mover {
    fn pose(&self) -> Pose3 {
        match self {
            Self::Riding(rider) => rider.body.pose(&rider.carriage),
            Self::Swimming(swimmer) => swimmer.pose(),
        }
    }
}

/// The floor of a world as hills, as far as the robots can get and a little around it.
fn level_floor(world: &World) -> Result<HeightField> {
    let (bounds, margin) = (world.site(), Vector::repeat(1.0));
    let area = Aabb::new(bounds.min - margin, bounds.max + margin);
    Ok(HeightField::from_fn(2, 2, area, |_| 0.0)?)
}

impl Rider {
    fn step(&mut self, ground: &HeightField, drive: &PlanarTwist) {
        if self.watch.is_gone() || (*drive == PlanarTwist::STOP && self.body.is_asleep()) {
            return;
        }
        self.body.step(ground, &self.carriage, drive, TICK);
        self.watch.look(&self.body, &self.body.pose(&self.carriage), ground, drive);
    }
}

/// A body at rest on the ground or above it.
fn standing(ground: &HeightField, carriage: &Undercarriage, pose: Pose, elevation: f64) -> RigidBody {
    if elevation <= 0.0 && ground.height(pose.position()).is_some() {
        return RigidBody::resting(ground, carriage, pose, TICK);
    }
    let level = ground.height(pose.position()).unwrap_or(0.0);
    RigidBody::above(ground, carriage, &Pose3::level(pose, level + elevation.max(0.0)))
}

fn speed(motion: PlanarMotion) -> PlanarTwist {
    PlanarTwist::new(motion.forward / TICK, motion.left / TICK, motion.angle / TICK)
}
