use std::sync::Arc;

use roverlab::geometry::{Point, Pose, direction, units};
use roverlab::scan::Landmark;
use roverlab::world::{Colour, Marker, Object, ObjectKind, RobotSpec, Scene, Shape, World};

use crate::common::GoalOption;

/// The heading at the goal of the command's own scene.
const HEADING: f64 = 0.0;
/// Distance of the pole from the goal, and its radius (m).
const POLE_DISTANCE: f64 = 0.4;
const POLE_RADIUS: f64 = 0.04;

/// The command's default scene: an empty floor of 4 m x 4 m, with a marker at the goal. The default goal is
/// the book's, 1450 mm ahead and 650 mm to the left.
pub(crate) fn scene(goal: Option<GoalOption>) -> Scene {
    let mut world = World::empty(4.0, 4.0);
    let start = Pose::from_mm_deg(1000.0, 1000.0, 0.0);
    let own = start.to_world(Point::new(units::from_mm(1450.0), units::from_mm(650.0)));
    let position = goal.map_or(own, |goal| goal.position);
    world.markers.push(Marker { position, colour: Colour::GREEN, alpha: 255 });
    Scene::with_robot(world, RobotSpec::s4(), start)
}

/// Heading on arrival: the requested one, or that of the default goal.
pub(crate) fn heading(goal: Option<GoalOption>, own_goal: bool) -> Option<f64> {
    goal.map_or(own_goal.then_some(HEADING), |goal| goal.heading)
}

/// Adds a pole beside a goal, as far as possible from the way there.
pub(crate) fn add_pole(scene: &mut Scene, goal: Point, way: &[Point]) {
    let clearance =
        |place: &Point| way.iter().map(|point| (point - place).norm()).fold(f64::INFINITY, f64::min);
    let places = (0..8).map(|i| goal + direction(f64::from(i) * std::f64::consts::FRAC_PI_4) * POLE_DISTANCE);
    let best = places.max_by(|a, b| clearance(a).total_cmp(&clearance(b))).expect("eight places");
    let shape = Shape::Cylinder { radius: POLE_RADIUS, height: 0.3 };
    let kind = ObjectKind { fixed: true, ..ObjectKind::new("pole", shape, Colour::RED) };
    scene.world.objects.push(Object::new(Arc::new(kind), Pose::new(best.x, best.y, 0.0)));
}

/// The world's poles in the frame of a robot's start pose.
pub(crate) fn poles(scene: &Scene, start: Pose) -> Vec<Landmark> {
    let objects = scene.world.objects.iter();
    let poles = objects.filter_map(|object| match object.kind.shape {
        Shape::Cylinder { radius, .. } => {
            Some(Landmark { position: start.to_local(object.pose.position()), radius })
        }
        _ => None,
    });
    poles.collect()
}
