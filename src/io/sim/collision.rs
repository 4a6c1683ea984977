//! Motion of robots among walls, objects and each other.
//!
//! Bodies are rigid: a robot is pushed out of the obstacle into which its wheels drove it. Therefore it
//! slides along a slanted wall and stops before a perpendicular one. Robots move in sequence within a tick.

use super::course::Course;
use super::drive_mechanics::Drift;
use super::engine::Engine;
use crate::geometry::{Pose, Vector};
use crate::kinematics::PlanarMotion;
use crate::world::Footprint;
use crate::world::space::Contact;

/// Distance of a check for obstacles (m). Longer checks are more expensive but less frequent.
const LOOK_AHEAD: f64 = 0.25;
/// Distance within which an existing contact persists (m).
const TOUCH_MARGIN: f64 = 5e-4;
/// Attempts to push a robot out of an obstacle before it stays in place.
const PUSH_ATTEMPTS: usize = 4;
/// The largest depth, in metres, that counts as pushed out.
pub(super) const PUSH_TOLERANCE: f64 = 1e-6;

impl Engine {
    /// Moves all robots by their motions of this tick.
    pub(super) fn move_bodies(&mut self, drifts: &[Drift]) {
        let moves = |drift: &Drift| drift.motion != PlanarMotion::default();
        let (farthest, moving) = drifts.iter().fold((0.0, false), |(farthest, moving), drift| {
            (drift.reach.max(farthest), moving | moves(drift))
        });
        if !moving {
            self.bodies.iter_mut().for_each(|body| body.touch.held_ticks = 0);
            return;
        }
        // Upper bound of a robot's motion in this tick.
        let farthest = farthest + 2.0 * PUSH_TOLERANCE;
        for (index, drift) in drifts.iter().enumerate() {
            let body = &mut self.bodies[index];
            body.solid_budget -= farthest;
            if !moves(drift) {
                self.stand(index);
                continue;
            }
            body.wall_budget -= drift.reach;
            body.solid_budget -= drift.reach;
            let start = body.pose();
            let free = if body.wall_budget <= 0.0 || body.solid_budget <= 0.0 {
                self.move_among_things(index, drift)
            } else {
                body.course.advance(drift.motion);
                body.path_length += drift.motion.length();
                body.touch.held_ticks = 0;
                true
            };
            let body = &self.bodies[index];
            self.space.set_pose(body.solid, body.pose());
            if !self.independent {
                let moved = if free { drift.motion } else { PlanarMotion::between(start, body.pose()) };
                self.machines[index].drive.settle(moved);
            }
        }
    }

    /// A robot at rest may have been touched by another one that has left again.
    fn stand(&mut self, index: usize) {
        let body = &mut self.bodies[index];
        body.touch.held_ticks = 0;
        if body.touch.touching {
            let limit = 2.0 * TOUCH_MARGIN;
            let (outline, me) = (&body.outline, Some(body.solid));
            let clearance = self.space.clearance(outline, &body.pose(), body.span, limit, me);
            body.touch.touching = clearance <= TOUCH_MARGIN;
        }
    }

    /// Moves a robot near obstacles, in strides that cannot skip any. Returns whether nothing was in the way.
    fn move_among_things(&mut self, index: usize, drift: &Drift) -> bool {
        let Drift { motion, reach, is_driving } = *drift;
        let body = &self.bodies[index];
        let start = body.pose();
        let strides = (reach / body.stride).ceil().max(1.0);
        let part = PlanarMotion {
            forward: motion.forward / strides,
            left: motion.left / strides,
            angle: motion.angle / strides,
        };
        let mut free = true;
        for _ in 0..strides as u32 {
            free &= self.stride(index, part, reach / strides);
        }
        let body = &mut self.bodies[index];
        let end = body.pose();
        let moved = (end.position() - start.position()).norm();
        body.path_length += moved;
        let turned = crate::geometry::angle_difference(end.heading, start.heading).abs();
        body.note_motion(reach, moved + body.spin_radius * turned, is_driving);
        free
    }

    /// Moves a robot by a part of its motion. Returns whether nothing was in the way.
    fn stride(&mut self, index: usize, motion: PlanarMotion, reach: f64) -> bool {
        let body = &mut self.bodies[index];
        let before = body.course;
        body.course.advance(motion);
        let wished = body.course;
        let (outline, span, me) = (body.outline, body.span, Some(body.solid));
        (body.wall_budget, body.solid_budget) =
            self.space.clearances(&outline, &wished.pose(), span, LOOK_AHEAD, me);
        if body.solid_budget <= 0.0 && self.topple(index, &wished.pose()) {
            let clearance = self.space.solids_clearance(&outline, &wished.pose(), span, LOOK_AHEAD, me);
            self.bodies[index].solid_budget = clearance;
        }
        let body = &self.bodies[index];
        let mut nearest = body.wall_budget.min(body.solid_budget);
        if nearest <= 0.0 && self.options.pushing && self.push(index, &wished.pose()) {
            let body = &mut self.bodies[index];
            body.solid_budget = self.space.solids_clearance(&outline, &wished.pose(), span, LOOK_AHEAD, me);
            nearest = body.wall_budget.min(body.solid_budget);
            // Pushed objects lie at the rim and are no contacts; their neighbours are checked again soon.
            body.solid_budget = 0.0;
            if nearest > 0.0 {
                return true;
            }
        }
        let body = &mut self.bodies[index];
        if nearest > TOUCH_MARGIN {
            body.touch.touching = false;
        } else if nearest <= 0.0 {
            self.free(index, before, wished, reach);
            return false;
        }
        true
    }

    /// Moves a robot out of the obstacles at its desired pose. Usually it ends within `reach` of its previous
    /// position.
    fn free(&mut self, index: usize, before: Course, wished: Course, reach: f64) {
        let pushed = self.pushed_out(index, wished);
        let way = |course: &Course| (course.pose().position() - before.pose().position()).norm();
        let within_reach = pushed.as_ref().is_some_and(|course| way(course) <= reach + 2.0 * PUSH_TOLERANCE);
        let end = match pushed {
            Some(course) if within_reach => course,
            // A robot that was placed in an obstacle leaves it at once.
            Some(course) if self.depth_at(index, &before.pose()) > 2.0 * PUSH_TOLERANCE => {
                self.look_around_again();
                course
            }
            _ => stay(&self.bodies[index].outline, before, wished),
        };
        let body = &mut self.bodies[index];
        body.course = end;
        // The checks were made from the desired pose.
        let aside = (end.pose().position() - wished.pose().position()).norm() + reach;
        body.wall_budget -= aside;
        body.solid_budget -= aside;
    }

    /// Pose of a robot after it is pushed out of all obstacles; `None` if that fails.
    fn pushed_out(&mut self, index: usize, mut course: Course) -> Option<Course> {
        for _ in 0..PUSH_ATTEMPTS {
            if self.depth_at(index, &course.pose()) <= PUSH_TOLERANCE {
                return Some(course);
            }
            self.note_touch(index, &course.pose());
            course.move_to(course.pose().position() + push_out(&self.contacts));
        }
        None
    }

    /// Depth of a robot at a pose in obstacles. Leaves the contacts in `self.contacts`.
    pub(super) fn depth_at(&mut self, index: usize, pose: &Pose) -> f64 {
        let body = &self.bodies[index];
        self.space.contacts(&body.outline, pose, body.span, Some(body.solid), &mut self.contacts);
        self.contacts.iter().map(|contact| contact.depth).fold(0.0, f64::max)
    }

    /// Counts the present contacts for a robot at a pose and for the robots that it touches.
    fn note_touch(&mut self, index: usize, pose: &Pose) {
        let normal = self.contacts.first().map_or_else(Vector::zeros, |contact| contact.normal);
        let body = &mut self.bodies[index];
        let place = pose.position() - normal * body.radius;
        body.touch.begin(place);
        // Objects precede robots in the space.
        let objects = self.space.solids() - self.bodies.len();
        for contact in &self.contacts {
            let other = contact.with.and_then(|solid| solid.index().checked_sub(objects));
            if let Some(other) = other {
                self.bodies[other].touch.begin(place);
                self.bodies[other].solid_budget = 0.0;
            }
        }
    }

    /// Places a robot at a pose; on hills it drops from `z` metres above the floor, unless the ground is
    /// higher.
    pub(super) fn place(&mut self, index: usize, pose: Pose, z: f64) {
        let body = &mut self.bodies[index];
        body.course = Course::new(pose);
        body.wall_budget = 0.0;
        body.touch.leave();
        self.space.set_pose(body.solid, pose);
        if let Some(hills) = &mut self.hills {
            hills.place(index, pose, z - hills.ground_level(pose.position()));
        }
        self.begin_inertial(index);
        self.look_around_again();
    }

    /// Places an existing object at a pose.
    pub(super) fn place_object(&mut self, object: usize, pose: Pose) {
        self.movables[object].velocity = Vector::zeros();
        let movable = self.movables[object];
        self.put(&movable, pose);
        // A hand puts it upright.
        self.space.set_top(movable.solid, movable.top);
        self.look_around_again();
    }

    /// Makes every robot check for solids before it moves, because one of them may have come from afar.
    fn look_around_again(&mut self) {
        for body in &mut self.bodies {
            body.solid_budget = 0.0;
        }
    }
}

/// Pose of a robot that cannot be pushed out: in place, but a disc still turns.
fn stay(footprint: &Footprint, before: Course, wished: Course) -> Course {
    match footprint {
        Footprint::Disc { .. } => {
            let mut turned = wished;
            turned.move_to(before.pose().position());
            turned
        }
        Footprint::Rectangle(_) => before,
    }
}

/// Sum of the pushes that free an outline from its contacts: the deepest push along each direction.
fn push_out(contacts: &[Contact]) -> Vector {
    let mut push = Vector::zeros();
    for contact in contacts {
        // Only the part that earlier pushes do not already achieve along this normal.
        let missing = contact.depth - push.dot(&contact.normal);
        if missing > 0.0 {
            push += contact.normal * missing;
        }
    }
    push
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_push_frees_from_two_faces_of_a_corner(
            angle in -3.0..3.0f64, between in 0.0..1.5f64, depths in (0.0..0.1f64, 0.0..0.1f64),
        ) {
            let contact = |angle, depth| Contact { normal: direction(angle), depth, with: None };
            let contacts = [contact(angle, depths.0), contact(angle + between, depths.1)];
            let push = push_out(&contacts);
            for contact in contacts {
                prop_assert!(push.dot(&contact.normal) >= contact.depth - 1e-12);
            }
            prop_assert!(push.norm() <= depths.0 + depths.1);
        }
    }

    #[test]
    fn a_face_that_is_met_twice_pushes_once() {
        let contact = Contact { normal: Vector::y(), depth: 0.01, with: None };
        assert_eq!(push_out(&[contact, contact]), Vector::new(0.0, 0.01));
    }
}
