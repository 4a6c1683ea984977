use roverlab::geometry::{Pose, math};
use roverlab::random::Stream;
use roverlab::world::{RobotSpec, Scene, World};

/// Sides of a room (m).
const LENGTH: [f64; 2] = [2.4, 4.0];
const WIDTH: [f64; 2] = [1.8, 3.0];
/// Distance between the walls and the centre of the circle that the robot can drive (m), and its radius.
const MARGIN: f64 = 0.75;
const RADIUS: f64 = 0.5;
/// Distance of that centre from the wall behind the robot, at most (m).
const BEHIND: f64 = 1.2;
/// Angle between the robot and the room, either way (rad).
const AWRY: f64 = 0.2;

/// The room of a seed, in which both tasks have room.
pub(super) fn scene(seed: u64) -> Scene {
    let mut stream = Stream::new(seed).child("first steps", 0);
    let [length, width] = [LENGTH, WIDTH].map(|[least, most]| stream.between(least, most));
    let (x, y) = (stream.between(MARGIN, BEHIND), stream.between(MARGIN, width - MARGIN));
    let heading = stream.between(-AWRY, AWRY);
    let (sin, cos) = math::sin_cos(heading);
    // The circle is to the left of the robot.
    let start = Pose::new(x + RADIUS * sin, y - RADIUS * cos, heading);
    Scene::with_robot(World::walled(length, width), RobotSpec::s4(), start)
}
