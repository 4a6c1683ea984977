use std::f64::consts::TAU;
use std::sync::Arc;

use roverlab::geometry::{Point, Pose, direction};
use roverlab::nav::Reachability;
use roverlab::world::space::{Solid, Space, Span};
use roverlab::world::{RobotPlacement, RobotSpec, Scene};

/// Free places for more robots in a scene, on floor connected to its first robot.
pub(crate) struct FreeFloor {
    /// `None` in a world that is too large for the grid.
    ways: Option<Reachability>,
    from: Point,
}

/// Distance between circles of candidate places (m), number of circles, and places per circle.
const STEP: f64 = 0.1;
const CIRCLES: u32 = 20;
const PLACES: u32 = 16;
/// Free space required around a robot (m).
const ROOM: f64 = 0.05;

impl FreeFloor {
    /// The floor around the first robot of a scene, for one type of robot.
    pub(crate) fn new(scene: &Scene, spec: &RobotSpec) -> Self {
        /// Number of cells along the longer side of the floor, and minimum cell size (m).
        const CELLS: f64 = 800.0;
        const FINEST: f64 = 0.01;
        let size = scene.world.site().size();
        let resolution = (size.x.max(size.y) / CELLS).max(FINEST);
        let ways = Reachability::new(&scene.world, spec.footprint.bounding_radius(), resolution).ok();
        Self { ways, from: scene.robots[0].pose.position() }
    }

    /// A free place for one more robot, as near as possible to the wished one. `None` if there is none within
    /// two metres.
    pub(crate) fn place(&self, scene: &Scene, spec: &Arc<RobotSpec>, wished: Pose) -> Option<Pose> {
        let space = space_with(scene, &scene.robots);
        let bounds = scene.world.site();
        let is_free = |pose: &Pose| {
            let solid = Solid::from(&RobotPlacement::new(Arc::clone(spec), *pose));
            let span = Span { bottom: solid.bottom, top: solid.top };
            bounds.contains(pose.position())
                && self.ways.as_ref().is_none_or(|ways| ways.connected(self.from, pose.position()))
                && space.clearance(&solid.outline, &solid.pose, span, 2.0 * ROOM, None) > ROOM
        };
        let around = (0..CIRCLES).flat_map(|circle| (0..PLACES).map(move |place| (circle, place)));
        let mut places = around.map(|(circle, place)| {
            let away = direction(TAU * f64::from(place) / f64::from(PLACES)) * (STEP * f64::from(circle));
            Pose { x: wished.x + away.x, y: wished.y + away.y, ..wished }
        });
        places.find(is_free)
    }
}

/// The space with a world's walls and objects, and some robots.
pub(super) fn space_with(scene: &Scene, robots: &[RobotPlacement]) -> Space {
    let mut space = Space::new(&scene.world.walls);
    for solid in scene.world.objects.iter().map(Solid::from).chain(robots.iter().map(Solid::from)) {
        space.add(solid);
    }
    space
}
