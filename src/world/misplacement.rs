use std::fmt;

use super::Scene;
use super::space::{Contact, Solid, Space};

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
        let mut space = Space::new(&self.world.walls);
        for object in &self.world.objects {
            space.add(Solid::from(object));
        }
        let bounds = self.world.bounds();
        let mut found = Vec::new();
        for (index, robot) in self.robots.iter().enumerate() {
            let solid = Solid::from(robot);
            let mut contacts = Vec::new();
            space.contacts(&solid.outline, &solid.pose, solid.span(), None, &mut contacts);
            let first = contacts.iter().find(|contact| contact.depth > TOUCH);
            if let Some(contact) = first {
                found.push((index, self.overlap(contact)));
            } else if !bounds.contains(robot.pose.position()) {
                found.push((index, Misplacement::Outside));
            }
            space.add(solid);
        }
        found
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
