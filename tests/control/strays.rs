//! A wall far from all the rest, as by a mistyped coordinate: every behaviour does what it does without it.

use roverlab::geometry::Point;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::wrappers::Faulty;
use roverlab::world::{Scene, Wall};

use super::cases::{CASES, Case, START, room};

/// Where a robot is after a second of its behaviour, in a room with some more walls.
fn after_a_second((name, spec, run): &Case, strays: &[Wall]) -> String {
    let mut world = room();
    world.walls.extend_from_slice(strays);
    let options = SimOptions { time_limit: Some(60.0), ..SimOptions::ideal() };
    let simulation = Simulation::new(&Scene::with_robot(world, spec(), START), options).unwrap();
    let mut robot = Faulty::new(simulation.robot(0).unwrap(), Vec::new());
    let outcome = run(&mut robot, 1.0, f64::INFINITY).map_err(|error| error.to_string());
    let truth = simulation.truth();
    format!("{name}: {outcome:?} {:?} {:?}", truth.pose(0).unwrap(), truth.pose_in_space(0).unwrap())
}

#[test]
fn a_stray_wall_changes_nothing_for_any_behaviour() {
    for case in CASES {
        let without = after_a_second(case, &[]);
        for far in [1e3, -1e6] {
            let stray = Wall::new(Point::new(far, 0.0), Point::new(far, 1.0));
            assert_eq!(after_a_second(case, &[stray]), without, "{far} m");
        }
    }
}
