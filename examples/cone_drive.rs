//! Driving between cones as the book does it (section 14.5): the car steers for the middle of the nearest gap
//! between cones in one scan. It has no map and no plan.
//!
//! `cargo run --release --example cone_drive`

use roverlab::geometry::Point;
use roverlab::io::control::{run, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Lidar, LidarSettings, Result};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::race::{GapDriver, Referee, TrackOptions, generate};
use roverlab::world::{Colour, RobotSpec, World};

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    // A legal track of Formula Student, from a seed.
    let generated = generate(1, &TrackOptions::drawn(1))?;
    let start = generated.track.start_pose().ok_or("the track has no start")?;
    let cones = &generated.track.cones;
    let scene = generated.track.scene(&[start]);
    let simulation = Simulation::new(&scene, SimOptions::default())?;
    let (mut car, race) = (simulation.robot(0)?, simulation.truth());

    // The referee looks at the wheels, in the car's frame from the middle of the rear axle.
    let wheels = [(0.0, 0.6), (0.0, -0.6), (1.55, 0.6), (1.55, -0.6)].map(|(x, y)| Point::new(x, y));
    let mut referee = Referee::new(generated.corridor.clone(), wheels);
    // As the book sets it: 180 beams over 180 degrees.
    car.configure_lidar(LidarSettings { field_of_view: std::f64::consts::PI, tilt: 0.0, points: 180 })?;
    let mut driver = GapDriver::with_speed(3.0 / RobotSpec::race_car().drive.top_speed())?;
    let mut path = Vec::new();
    // Ten times a second the driver decides and the referee looks.
    run(&mut car, &mut driver, 200.0, |_, _, _| {
        let truth = race.robot(0)?;
        referee.see(race.time(), truth.pose, truth.contacts as usize);
        path.push(truth.pose.position());
        Result::Ok(until(!referee.verdict().lap_times.is_empty()))
    })?;

    let verdict = referee.verdict();
    let lap = verdict.lap_times.first().ok_or("no lap was driven")?;
    println!("a lap of {:.0} m in {lap:.1} s at 3 m/s", generated.corridor.length());
    println!("{} cones knocked over, {} times off the course", verdict.cones_hit, verdict.off_course);
    assert_eq!((verdict.cones_hit, verdict.off_course), (0, 0));

    let mut picture = Picture::new(&World { objects: Vec::new(), ..scene.world });
    picture.title("For the nearest gap").true_path(path).mark(Mark::Start, start.position());
    picture
        .points(cones.iter().map(|cone| cone.position), Style::new(Colour::BLUE).width(5.0).labelled("cone"));
    picture.save("target/pictures/cone_drive.svg")?;
    Ok(())
}
