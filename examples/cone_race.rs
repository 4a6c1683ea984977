//! A race between cones (book, section 14.5): in the first lap the car drives between the cones that its
//! lidar sees, and makes a map of them. Then it drives the racing line of that map as fast as its tyres hold.
//!
//! `cargo run --release --example cone_race`

use roverlab::geometry::Point;
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::race::{RaceOutcome, RacePhase, Racer, RacerParameters, Referee, TrackOptions, generate};
use roverlab::world::World;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A track by the rules of Formula Student, but a short one.
    let options = TrackOptions { length: [120.0, 180.0], ..TrackOptions::default() };
    let generated = generate(1, &options)?;
    let start = generated.track.start_pose().ok_or("the track has no start")?;
    let cones = &generated.track.cones;
    let scene = generated.track.scene(&[start]);
    let simulation = Simulation::new(&scene, SimOptions::default())?;
    let race = simulation.truth();

    // The referee looks at the wheels, in the car's frame from the middle of the rear axle.
    let wheels = [(0.0, 0.6), (0.0, -0.6), (1.55, 0.6), (1.55, -0.6)].map(|(x, y)| Point::new(x, y));
    let mut referee = Referee::new(generated.corridor.clone(), wheels);
    let mut racer = Racer::new(RacerParameters { laps: 2, period: 0.08, ..RacerParameters::default() })?;
    let (mut path, mut first) = (Vec::new(), 0);
    let outcome = run(&mut simulation.robot(0)?, &mut racer, 300.0, |_, racer, step| {
        let truth = race.robot(0)?;
        referee.see(race.time(), truth.pose, truth.contacts as usize);
        path.push((truth.pose.position(), step.seen.speed.linear));
        if racer.phase() == RacePhase::Mapping {
            first = path.len();
        }
        roverlab::io::Result::Ok(())
    })?;

    let verdict = referee.verdict();
    let length = generated.corridor.length();
    println!("{outcome:?}: {} cones of {} are in the map", racer.map().cones().count(), cones.len());
    for (lap, time) in (1..).zip(&verdict.lap_times) {
        println!("lap {lap}: {time:.2} s, {:.1} m/s in the mean", length / time);
    }
    println!("{} cones knocked over, {} times off the course", verdict.cones_hit, verdict.off_course);
    assert_eq!((outcome, verdict.cones_hit, verdict.off_course), (RaceOutcome::Finished, 0, 0));
    assert!(verdict.lap_times.len() == 2 && verdict.lap_times[1] < 0.8 * verdict.lap_times[0]);

    let mut picture = Picture::new(&World { objects: Vec::new(), ..scene.world });
    picture.title("Mapped in one lap, raced in the next").mark(Mark::Start, start.position());
    for cone in cones {
        picture.points([cone.position], Style::new(cone.colour.paint()).width(5.0));
    }
    picture.line(path[..first].iter().map(|&(place, _)| place), Style::aid().labelled("first lap"));
    picture.speed_path(path[first..].iter().copied());
    picture.save("target/pictures/cone_race.svg")?;
    Ok(())
}
