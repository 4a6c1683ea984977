//! Pushing and knocking over objects.

use super::collision::PUSH_TOLERANCE;
use super::engine::Engine;
use super::movable::Movable;
use crate::geometry::{Pose, Vector};
use crate::world::space::{Contact, SolidId};

/// Maximum overlap of two things after a push (m).
const TOLERANCE: f64 = 1e-5;

impl Engine {
    /// Pushes the objects that a robot at a pose would overlap, as far as possible. Returns whether anything
    /// moved.
    pub(super) fn push(&mut self, index: usize, pose: &Pose) -> bool {
        self.depth_at(index, pose);
        let strength = self.machines[index].spec.mass;
        let contacts = std::mem::take(&mut self.contacts);
        let mut moved = false;
        for contact in &contacts {
            let Some(solid) = contact.with else { continue };
            let light = self.movable(solid).is_some_and(|movable| movable.mass <= strength);
            if light {
                moved |= self.shift(solid, -contact.normal * (contact.depth + PUSH_TOLERANCE), index);
            }
        }
        self.contacts = contacts;
        moved
    }

    /// Knocks over the falling objects that a robot at a pose would overlap; each is a contact. Returns
    /// whether anything fell.
    pub(super) fn topple(&mut self, index: usize, pose: &Pose) -> bool {
        if self.movables.is_empty() {
            return false;
        }
        self.depth_at(index, pose);
        let strength = self.machines[index].spec.mass;
        let contacts = std::mem::take(&mut self.contacts);
        let mut fell = false;
        for solid in contacts.iter().filter_map(|contact| contact.with) {
            if self.movable(solid).is_some_and(|movable| movable.falls && movable.mass <= strength) {
                let thing = *self.space.solid(solid);
                self.space.set_top(solid, thing.bottom);
                self.bodies[index].touch.count(thing.pose.position());
                fell = true;
            }
        }
        self.contacts = contacts;
        fell
    }

    /// The object of a solid; `None` for robots.
    fn movable(&self, solid: SolidId) -> Option<&Movable> {
        self.movables.get(solid.index())
    }

    /// Moves an object, unless it would hit a wall, another object or a robot other than the pusher.
    fn shift(&mut self, solid: SolidId, way: Vector, pusher: usize) -> bool {
        let thing = *self.space.solid(solid);
        let place = thing.pose.position() + way;
        let there = Pose::new(place.x, place.y, thing.pose.heading);
        let mut contacts: Vec<Contact> = Vec::new();
        self.space.contacts(&thing.outline, &there, thing.span(), Some(solid), &mut contacts);
        let me = self.bodies[pusher].solid;
        let blocked = contacts.iter().any(|contact| contact.with != Some(me) && contact.depth > TOLERANCE);
        if !blocked {
            if let Some(&object) = self.movable(solid) {
                self.put(&object, there);
            }
            // It may have come near to robots that did not look for it.
            for body in &mut self.bodies {
                body.solid_budget = body.solid_budget.min(0.0);
            }
        }
        !blocked
    }
}
