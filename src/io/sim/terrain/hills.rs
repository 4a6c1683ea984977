use std::sync::Arc;

use super::{Mishap, RigidBody, Undercarriage, Watch};
use crate::geometry::{Point, Pose, Pose3, angle_difference};
use crate::io::sim::TICK;
use crate::io::sim::body::Body;
use crate::kinematics::{PlanarMotion, PlanarTwist};
use crate::world::space::Space;
use crate::world::{HeightField, RobotPlacement, World};

/// The ground of a world with hills, and how its robots are on it.
#[derive(Debug)]
pub(in crate::io::sim) struct Hills {
    ground: Arc<HeightField>,
    riders: Vec<Rider>,
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
    /// The hills of a world, if it has any.
    pub(in crate::io::sim) fn of(world: &World, robots: &[RobotPlacement]) -> Option<Box<Self>> {
        let ground = Arc::clone(world.terrain.as_ref()?.surface.as_ref()?);
        let riders = robots.iter().map(|robot| {
            let carriage = Undercarriage::of(&robot.spec);
            let body = standing(&ground, &carriage, robot.pose, robot.elevation);
            let watch = Watch::new(robot.spec.height, world.water_level);
            Rider { carriage, body, watch }
        });
        let riders = riders.collect();
        Some(Box::new(Self { ground, riders }))
    }

    /// Their surface.
    pub(in crate::io::sim) fn ground(&self) -> &HeightField {
        &self.ground
    }

    /// Pose of a robot in space.
    pub(in crate::io::sim) fn pose(&self, robot: usize) -> Pose3 {
        let rider = &self.riders[robot];
        rider.body.pose(&rider.carriage)
    }

    /// Mishap of a robot that can no longer drive.
    pub(in crate::io::sim) fn mishap(&self, robot: usize) -> Option<Mishap> {
        self.riders[robot].watch.mishap()
    }

    /// The elevation of the ground under a point; beyond the hills, that of the floor.
    pub(in crate::io::sim) fn level(&self, point: Point) -> f64 {
        self.ground.height(point).unwrap_or(0.0)
    }

    /// Puts a robot on the ground, or so many metres above it.
    pub(in crate::io::sim) fn place(&mut self, robot: usize, pose: Pose, elevation: f64) {
        let rider = &mut self.riders[robot];
        rider.body = standing(&self.ground, &rider.carriage, pose, elevation);
        rider.watch.forget();
    }

    /// Lets all robots move for a tick, and puts how their frames move over the plane in place of how their wheels
    /// turned. Returns whether any moves.
    pub(in crate::io::sim) fn ride(&mut self, bodies: &[Body], motions: &mut [PlanarMotion]) -> bool {
        let mut moving = false;
        for ((rider, body), motion) in self.riders.iter_mut().zip(bodies).zip(motions) {
            let drive = if rider.watch.is_over() { PlanarTwist::STOP } else { speed(*motion) };
            rider.step(&self.ground, &drive);
            let there = rider.body.pose(&rider.carriage).pose();
            let motionless = body.pose().distance_to(there.position()) < STILL;
            let turned = angle_difference(there.heading, body.pose().heading).abs();
            *motion = if motionless && turned < STILL {
                PlanarMotion::default()
            } else {
                PlanarMotion::between(body.pose(), there)
            };
            moving |= *motion != PlanarMotion::default();
        }
        moving
    }

    /// Takes obstacles in the robots' way into account, and updates the robots' solids.
    pub(in crate::io::sim) fn yield_to(&mut self, bodies: &mut [Body], space: &mut Space) {
        for (rider, body) in self.riders.iter_mut().zip(bodies) {
            let pose = rider.body.pose(&rider.carriage);
            let (there, moved) = (body.pose(), pose.pose());
            let aside = there.position() - moved.position();
            let turned = angle_difference(there.heading, moved.heading);
            if aside.norm().max(turned.abs()) > MOVED_ASIDE {
                rider.body.shove(aside, turned, TICK);
            }
            let above = pose.position.z - self.ground.height(there.position()).unwrap_or(0.0);
            let above = if above > STANDING { above } else { 0.0 };
            body.span.bottom = above;
            body.span.top = above + body.spec.height;
            let level = pose.position.z - space.solid(body.solid).bottom;
            space.set_level(body.solid, level);
        }
    }
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
    RigidBody::new(carriage, &Pose3::level(pose, level + elevation.max(0.0)))
}

fn speed(motion: PlanarMotion) -> PlanarTwist {
    PlanarTwist::new(motion.forward / TICK, motion.left / TICK, motion.angle / TICK)
}
