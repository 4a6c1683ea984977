//! Localisation (book, section 4.3): a robot has a map of an office, but is not told where it stands. It
//! drives about, compares its scans with the map, and stops when one place alone explains all that it has
//! seen.
//!
//! `cargo run --release --example localise`

use roverlab::drive::{RandomDrive, RandomDriveParameters};
use roverlab::geometry::{Point, Pose, angle_difference, units};
use roverlab::io::control::{run, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Lidar, Odometry, Result};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::random::Stream;
use roverlab::scan::{Localisation, LocalisationMap, Localiser, LocaliserParameters};
use roverlab::world::{LidarSpec, RobotSpec, Scene, Wall, World};

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let mut world = World::walled(5.0, 4.0);
    for (a, b) in [
        ((0.0, 1.8), (1.2, 1.8)),
        ((2.0, 1.8), (2.6, 1.8)),
        ((2.6, 0.0), (2.6, 0.9)),
        ((2.6, 1.8), (2.6, 2.6)),
        ((2.6, 3.4), (2.6, 4.0)),
        ((3.6, 2.2), (5.0, 2.2)),
    ] {
        world.walls.push(Wall::new(Point::new(a.0, a.1), Point::new(b.0, b.1)));
    }
    // A lidar that sees no farther than 0.8 m: from one place alone, much of the office looks the same.
    let lidar = LidarSpec { max_range: 0.8, ..LidarSpec::default() };
    let spec = RobotSpec { lidar: Some(lidar), ..RobotSpec::s4() };
    let start = Pose::new(4.4, 0.6, 2.0);
    let scene = Scene::with_robot(world.clone(), spec, start);
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let mut robot = simulation.robot(0)?;

    // Nothing below knows the start.
    let mut localiser = Localiser::new(LocalisationMap::new(&world)?, LocaliserParameters::default())?;
    let parameters = RandomDriveParameters { period: 0.2, ..RandomDriveParameters::default() };
    let mut wander = RandomDrive::new(parameters, Stream::new(1))?;
    let (mut sure, mut hypotheses) = (0, Vec::new());
    run(&mut robot, &mut wander, 120.0, |_, _, step| {
        localiser.update(step.seen.pose, &step.seen.scan)?;
        let found = localiser.localisation();
        if hypotheses.last() != Some(&found.count()) {
            println!("{:5.1} s: places that explain what was seen: {}", step.time, found.count());
            hypotheses.push(found.count());
        }
        sure = if matches!(found, Localisation::One(_)) { sure + 1 } else { 0 };
        Result::Ok(until(sure == 12))
    })?;

    let place = localiser.place(robot.pose()?).ok_or("the robot knows of no place")?;
    let truth = simulation.truth().robot(0)?;
    let off = units::to_mm(place.distance_to(truth.pose.position()));
    let turned = units::to_deg(angle_difference(place.heading, truth.pose.heading));
    println!(
        "The robot takes itself to be at ({:.2}, {:.2}) m, {off:.0} mm from the truth.",
        place.x, place.y
    );
    assert!(hypotheses[0] != 1 && sure == 12 && truth.contacts == 0);
    assert!(off < 50.0 && turned.abs() < 3.0);

    let mut picture = Picture::new(&world);
    picture.title("Where am I?").mark(Mark::Start, start.position());
    // Seen from the found place, the scan lies on the walls.
    picture.points(robot.scan()?.points().map(|point| place.to_world(point)), Style::lidar());
    picture.true_path(truth.trail.iter().map(|point| point.pose.position()));
    picture.robot(truth.pose, &RobotSpec::s4().footprint);
    picture.save("target/pictures/localise.svg")?;
    Ok(())
}
