//! Coverage (book, sections 3.1 and 6.3): a robot drives over the whole floor in lanes, as a lawn mower does.
//! It knows the room and where it starts; scans keep its position true.
//!
//! `cargo run --release --example coverage`

use std::sync::Arc;

use roverlab::drive::{CoverageMap, CoverageMapParameters, CoveragePlan, Tour, TourOutcome, TourParameters};
use roverlab::geometry::{Point, Pose};
use roverlab::io::control::{SensedBy, run};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
use roverlab::io::{Lidar, Odometry};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::scan::{LocalisationMap, Localiser, LocaliserParameters};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Wall, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut world = World::walled(2.2, 1.6);
    world.walls.push(Wall::new(Point::new(1.5, 0.0), Point::new(1.5, 0.7)));
    let crates = Arc::new(ObjectKind::predefined("crate").ok_or("no such object")?);
    world.objects.push(Object::new(crates, Pose::new(0.8, 0.8, 0.3)));

    // The plan covers what the robot's disc can reach from its start.
    let start = Pose::new(0.2, 0.2, 0.0);
    let mut map = CoverageMap::new(&world, start.position(), CoverageMapParameters::default())?;
    let plan = CoveragePlan::new(&map, start.position())?;
    println!("{:.1} m2 of floor, a plan {:.0} m long", map.area(), plan.length());

    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
    let simulation = Simulation::new(&scene, options)?;
    let mut robot = simulation.robot(0)?;
    let mut localiser = Localiser::new(LocalisationMap::new(&world)?, LocaliserParameters::default())?;
    localiser.start_at(start);
    let mut tour = Tour::new(plan.points(), TourParameters::default())?;
    let mut steps = 0_u32;
    let locate = |robot: &mut SimRobot, _, place: &mut Option<Pose>| {
        // Odometry serves between scans; every third step a scan corrects it.
        let odometry = robot.pose()?;
        if steps.is_multiple_of(3) {
            localiser.update(odometry, &robot.scan()?)?;
        }
        steps += 1;
        *place = localiser.place(odometry);
        Ok(())
    };
    let outcome = run(&mut robot, &mut SensedBy::new(&mut tour, locate), 3600.0, |_, _, _| {})?;
    assert_eq!(outcome, TourOutcome::Finished);

    let truth = simulation.truth().robot(0)?;
    truth
        .trail
        .windows(2)
        .for_each(|two| map.cover_line(two[0].pose.position(), two[1].pose.position(), 0.0));
    let (percent, time) = (100.0 * map.share(), simulation.truth().time());
    println!("{percent:.1} % of the floor covered in {:.0} m and {time:.0} s", truth.path_length);
    assert!(map.share() > 0.98 && truth.contacts == 0);

    let mut picture = Picture::new(&world);
    picture
        .title(format!("Coverage: {percent:.1} % of the floor"))
        .line(plan.points().to_vec(), Style::plan());
    picture
        .true_path(truth.trail.iter().map(|point| point.pose.position()))
        .mark(Mark::Start, start.position());
    picture.points(map.cells(false), Style::new(Colour::RED).labelled("left out"));
    picture.robot(truth.pose, &RobotSpec::s4().footprint);
    picture.save("target/pictures/coverage.svg")?;
    Ok(())
}
