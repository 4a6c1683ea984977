//! Objects that slide and roll down hills.

use super::TICK;
use super::engine::Engine;
use super::terrain::{GRAVITY, Hills};
use crate::geometry::{Pose, Vector};

/// Coefficient of friction between objects and ground: wood on earth.
const FRICTION: f64 = 0.5;
/// Coefficient of rolling resistance of balls.
const ROLLING: f64 = 0.02;
/// Acceleration of a solid ball that rolls, relative to one that slides without friction.
const OF_A_BALL: f64 = 5.0 / 7.0;
/// Maximum penetration of another solid (m).
const TOLERANCE: f64 = 1e-5;

impl Engine {
    /// Moves all objects on hills for a tick, except fixed ones and those that topple when hit.
    pub(super) fn slide_things(&mut self) {
        for thing in 0..self.movables.len() {
            let movable = self.movables[thing];
            let Some(hills) = &self.hills else { return };
            if movable.mass.is_infinite() || movable.falls {
                continue;
            }
            let place = self.space.solid(movable.solid).pose.position();
            let floats = hills.level(place, &movable) > hills.ground_level(place);
            let Some(slope) = hills.ground().gradient(place).filter(|_| !floats) else { continue };
            let velocity = slide(movable.velocity, slope, movable.rolls);
            if velocity != Vector::zeros() || movable.velocity != velocity {
                self.movables[thing].velocity = self.advance(thing, velocity);
            }
        }
    }

    /// Moves an object and returns its remaining velocity. Obstacles take the part towards them; the edge of
    /// the hills stops it.
    fn advance(&mut self, thing: usize, velocity: Vector) -> Vector {
        let solid = self.movables[thing].solid;
        let before = *self.space.solid(solid);
        let place = before.pose.position() + velocity * TICK;
        if !self.hills.as_deref().map(Hills::ground).is_some_and(|hills| hills.area().contains(place)) {
            return Vector::zeros();
        }
        let there = Pose::new(place.x, place.y, before.pose.heading);
        let mut contacts = std::mem::take(&mut self.contacts);
        self.space.contacts(&before.outline, &there, before.span(), Some(solid), &mut contacts);
        let mut left = velocity;
        for contact in contacts.iter().filter(|contact| contact.depth > TOLERANCE) {
            left -= contact.normal * left.dot(&contact.normal).min(0.0);
        }
        self.contacts = contacts;
        if left == velocity {
            let movable = self.movables[thing];
            self.put(&movable, there);
            // It may have come near to robots that did not look for it.
            self.bodies.iter_mut().for_each(|body| body.solid_budget = body.solid_budget.min(0.0));
        }
        left
    }
}

/// Horizontal velocity of an object on a slope after a tick.
fn slide(velocity: Vector, slope: Vector, rolls: bool) -> Vector {
    let steep = 1.0 + slope.norm_squared();
    let (friction, share) = if rolls { (ROLLING, OF_A_BALL) } else { (FRICTION, 1.0) };
    let wished = velocity - slope * (share * GRAVITY / steep * TICK);
    let speed = wished.norm();
    if speed == 0.0 {
        return wished;
    }
    // A metre on the plane is longer on the slope.
    let along = slope.dot(&wished) / speed;
    let braked = friction * share * GRAVITY / (steep * (1.0 + along * along)).sqrt() * TICK;
    wished * (1.0 - braked / speed).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// What rests holds on up to the angle of friction, in whatever direction the slope is.
        #[test]
        fn things_hold_on_up_to_the_angle_of_friction(heading in -3.0..3.0f64, share in 0.0..2.0f64, rolls in any::<bool>()) {
            let friction = if rolls { ROLLING } else { FRICTION };
            let slope = crate::geometry::direction(heading) * (friction * share);
            let moves = slide(Vector::zeros(), slope, rolls) != Vector::zeros();
            prop_assert!(moves == (share > 1.0) || (share - 1.0).abs() < 1e-6);
        }

        /// On one slope, motion and height together lose energy.
        #[test]
        fn energy_never_rises((x, y) in (-1.0..1.0f64, -1.0..1.0f64), (vx, vy) in (-2.0..2.0f64, -2.0..2.0f64), rolls in any::<bool>()) {
            let (slope, before) = (Vector::new(x, y), Vector::new(vx, vy));
            let share = if rolls { OF_A_BALL } else { 1.0 };
            let energy = |v: Vector| 0.5 * (v.norm_squared() + slope.dot(&v) * slope.dot(&v)) / share;
            let after = slide(before, slope, rolls);
            let climbed = GRAVITY * slope.dot(&after) * TICK;
            prop_assert!(energy(after) + climbed <= energy(before) + 1e-12);
        }
    }
}
