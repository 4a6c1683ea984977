use std::fmt;

use super::Scene;
use super::space::{Contact, Solid, SolidId, Space};

/// Overlaps up to this depth are contacts (m): files give whole millimetres.
const TOUCH: f64 = 1e-3;

/// Why a robot cannot stand where a scene places it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Misplacement {
    /// Beyond the floor and everything on it.
    Outside,
    /// In a wall.
    InWall,
    /// In the object of this index.
    InObject(usize),
    /// In the robot of this index.
    InRobot(usize),
}

impl fmt::Display for Misplacement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outside => f.write_str("outside the world"),
            Self::InWall => f.write_str("in a wall"),
            Self::InObject(index) => write!(f, "in object {}", index + 1),
            Self::InRobot(index) => write!(f, "in robot {}", index + 1),
        }
    }
}

impl Scene {
    /// The robots that overlap a wall, an object or another robot, or stand outside, with the first reason
    /// each. A pair of robots is named once, by the later one.
    ///
    /// ```
    /// use roverlab::geometry::Pose;
    /// use roverlab::world::{Misplacement, RobotSpec, Scene, World};
    ///
    /// let at = |x, y| Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(x, y, 0.0));
    /// assert_eq!(at(1.0, 1.0).misplacements(), []);
    /// assert_eq!(at(2.0, 1.0).misplacements(), [(0, Misplacement::InWall)]);
    /// assert_eq!(at(9.0, 1.0).misplacements(), [(0, Misplacement::Outside)]);
    /// ```
    pub fn misplacements(&self) -> Vec<(usize, Misplacement)> {
        let mut space = self.objects_alone();
        let mut found = Vec::new();
        for (index, robot) in self.robots.iter().enumerate() {
            let solid = Solid::from(robot);
            found.extend(self.misplaced(&space, &solid, None).map(|place| (index, place)));
            space.add(solid);
        }
        found
    }

    /// Why a robot cannot stand where it is, among all objects and the other robots; `None` if it can, or if
    /// there is no such robot.
    pub fn robot_misplacement(&self, robot: usize) -> Option<Misplacement> {
        self.misplacement_of(self.world.objects.len() + robot)
    }

    /// Like [`robot_misplacement`](Scene::robot_misplacement), for an object: never [`Misplacement::Outside`], as the
    /// world's bounds include its objects.
    pub fn object_misplacement(&self, object: usize) -> Option<Misplacement> {
        let is_there = object < self.world.objects.len();
        is_there.then(|| self.misplacement_of(object)).flatten()
    }

    /// Objects come before robots.
    fn misplacement_of(&self, number: usize) -> Option<Misplacement> {
        let mut space = Space::new(&self.world.walls);
        let objects = self.world.objects.iter().map(Solid::from);
        let solids: Vec<Solid> = objects.chain(self.robots.iter().map(Solid::from)).collect();
        let ids: Vec<SolidId> = solids.iter().map(|&solid| space.add(solid)).collect();
        self.misplaced(&space, solids.get(number)?, ids.get(number).copied())
    }

    /// Walls and objects.
    fn objects_alone(&self) -> Space {
        let mut space = Space::new(&self.world.walls);
        for object in &self.world.objects {
            space.add(Solid::from(object));
        }
        space
    }

    /// Why a solid cannot stand where it is in a space, of which it may be a part.
    fn misplaced(&self, space: &Space, solid: &Solid, itself: Option<SolidId>) -> Option<Misplacement> {
        let mut contacts = Vec::new();
        space.contacts(&solid.outline, &solid.pose, solid.span(), itself, &mut contacts);
        let first = contacts.iter().find(|contact| contact.depth > TOUCH);
        let is_outside = || !self.world.bounds().contains(solid.pose.position());
        first.map(|contact| self.overlap(contact)).or_else(|| is_outside().then_some(Misplacement::Outside))
    }

    fn overlap(&self, contact: &Contact) -> Misplacement {
        let objects = self.world.objects.len();
        match contact.with {
            None => Misplacement::InWall,
            Some(id) if id.index() < objects => Misplacement::InObject(id.index()),
            Some(id) => Misplacement::InRobot(id.index() - objects),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::world::{Object, ObjectKind, RobotPlacement, RobotSpec, World};

    #[test]
    fn single_things_are_checked_among_all_others() {
        let mut scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
        let placed = |x| RobotPlacement::new(RobotSpec::labbot().into(), Pose::new(x, 0.5, 1.0));
        scene.robots.push(placed(0.5));
        let kind = std::sync::Arc::new(ObjectKind::predefined("can").unwrap());
        let can = |x| Object::new(kind.clone(), Pose::new(x, 1.5, 0.0));
        scene.world.objects.extend([can(0.5), can(0.501), can(2.0), can(1.0)]);
        assert_eq!(scene.robot_misplacement(0), Some(Misplacement::InRobot(1)));
        assert_eq!(scene.robot_misplacement(1), Some(Misplacement::InRobot(0)));
        let of = |object| scene.object_misplacement(object);
        assert_eq!((of(0), of(1)), (Some(Misplacement::InObject(1)), Some(Misplacement::InObject(0))));
        assert_eq!((of(2), of(3)), (Some(Misplacement::InWall), None));
        assert_eq!((of(9), scene.robot_misplacement(9)), (None, None));
    }

    #[test]
    fn the_later_of_two_robots_in_one_place_is_named() {
        let mut scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
        let placed = |x| RobotPlacement::new(RobotSpec::labbot().into(), Pose::new(x, 0.5, 1.0));
        scene.robots.extend([placed(1.5), placed(0.5)]);
        assert_eq!(scene.misplacements(), [(2, Misplacement::InRobot(0))]);
        assert_eq!(Misplacement::InRobot(0).to_string(), "in robot 1");
    }

    #[test]
    fn a_robot_in_the_air_is_over_what_stands_below() {
        let mut scene = Scene::with_robot(World::walled(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
        let can = ObjectKind::predefined("can").unwrap();
        scene.world.objects.push(Object::new(can.into(), Pose::new(0.5, 0.5, 0.0)));
        assert_eq!(scene.misplacements(), [(0, Misplacement::InObject(0))]);
        scene.robots[0].elevation = 1.0;
        assert_eq!(scene.misplacements(), []);
    }
}
