//! Laps of the book's loop by the S4: its lane, its stop lines, and its crosswalk.

use super::book_loop;
use roverlab::drive::lane_keeping::LaneKeeperParameters;
use roverlab::drive::traffic::{FreeDrive, FreeDriveRules, TrafficDriver, TrafficParameters, TrafficState};
use roverlab::geometry::{Aabb, Point, units};
use roverlab::io::control::{run, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::vision::lane_markings::RoadModel;
use roverlab::world::{RobotSpec, Scene, Texture, World};

/// The lines of the book's loop at which a car stops, both at its crossing (m).
const LINES: [Point; 2] = [Point::new(0.60, 1.47), Point::new(0.88, 1.32)];
/// Distance from the middle of such a line within which it stands (m).
const BEFORE: f64 = 0.25;
/// The crosswalk of the book's loop (m).
const CROSSWALK: Aabb = Aabb { min: Point::new(1.14, 2.48), max: Point::new(1.34, 2.84) };

/// The S4 with a lens of 150 degrees.
fn wide() -> RobotSpec {
    let mut spec = RobotSpec::s4();
    let lens = spec.camera.as_mut().unwrap();
    (lens.field_of_view, lens.fisheye) = (units::from_deg(150.0), true);
    spec
}

/// Keeps its lane for some laps, stops at both lines in each, and is slow on the crosswalk.
fn drive(spec: &RobotSpec, laps: usize) {
    let image = book_loop::picture();
    let course = book_loop::course();
    let camera = spec.camera.as_ref().unwrap().into();
    let world = World {
        floor_texture: Some(Texture::new("carolo.png", image)),
        ..World::empty(book_loop::SIDE, book_loop::SIDE)
    };
    let scene = Scene::with_robot(world, spec.clone(), course.start());
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1)).unwrap();
    let (mut robot, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    let road = RoadModel { size: course.size, line_width: course.line_width, left_hand: true };
    let lane = LaneKeeperParameters {
        speed: 0.3,
        across: 0.5,
        brake: 0.5,
        settling: [0.15, 0.2],
        delay: 0.2,
        sight: 0.8,
        ..LaneKeeperParameters::default()
    };
    let parameters = TrafficParameters {
        lane,
        crosswalk: 0.15,
        gap: 0.05,
        brake: 0.5,
        body: [0.08, 0.05],
        ..TrafficParameters::default()
    };
    let mut driver = TrafficDriver::new(camera, road, parameters).unwrap();
    let distance = laps as f64 * course.line.length();
    let mut referee = FreeDrive::new(course, spec, FreeDriveRules::default()).unwrap();
    let (mut stood, mut halts) = (false, [0; 2]);
    let (mut before, mut on_crosswalk) = ((Point::origin(), 0.0), Vec::new());
    run(&mut robot, &mut driver, 1600.0, |_, driver, _| {
        let pose = truth.pose(0).unwrap();
        let stands = driver.state() == TrafficState::Wait;
        if stands && !stood {
            let place = LINES.iter().position(|line| (line - pose.position()).norm() < BEFORE);
            halts[place.expect("a halt at a line")] += 1;
        }
        stood = stands;
        let (place, time) = (pose.position(), truth.time());
        if CROSSWALK.contains(place) && CROSSWALK.contains(before.0) {
            on_crosswalk.push((place - before.0).norm() / (time - before.1));
        }
        before = (place, time);
        let astray = referee.see(truth.time(), &pose);
        until(astray || referee.score().distance >= distance)
    })
    .unwrap();
    let score = referee.score();
    println!(
        "{:.1} m, {:.1} mm, {} departures, halts {halts:?}, on the crosswalk {:.2} m/s at most",
        score.distance,
        1e3 * score.offset_rms(),
        score.departures,
        on_crosswalk.iter().copied().fold(0.0, f64::max)
    );
    assert!(score.distance >= distance && score.departures == 0, "{score:?}");
    assert!(halts == [laps; 2], "{halts:?}");
    assert!(!on_crosswalk.is_empty() && on_crosswalk.iter().all(|speed| *speed < 0.2), "{on_crosswalk:?}");
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER cargo test --all-features --test lane_keeping laps -- --ignored"]
fn two_laps_by_its_own_lens_and_a_wide_one() {
    drive(&RobotSpec::s4(), 2);
    drive(&wide(), 2);
}

mod campaigns {
    use super::*;

    #[test]
    #[ignore = "a campaign on published data: ROVERLAB_DATA=FOLDER cargo test --release --all-features --test lane_keeping campaigns -- --ignored --nocapture"]
    fn twenty_laps_by_its_own_lens() {
        drive(&RobotSpec::s4(), 20);
    }

    #[test]
    #[ignore = "a campaign on published data: ROVERLAB_DATA=FOLDER cargo test --release --all-features --test lane_keeping campaigns -- --ignored --nocapture"]
    fn twenty_laps_by_a_wide_lens() {
        drive(&wide(), 20);
    }
}
