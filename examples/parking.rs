//! Parking (book, chapter 13): a model car finds a free spot between boxes beside the road, and parks in it,
//! first along the road and then across it. It keeps its lane by camera, measures the gap by a distance
//! sensor, and plans the shortest path of straights and full locks.
//!
//! `cargo run --release --example parking`

use roverlab::drive::parking::{
    ParkingDriver, ParkingKind, ParkingLot, ParkingOutcome, ParkingParameters, parking_car,
};
use roverlab::geometry::Point;
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Picture, Style};
use roverlab::vision::lane_markings::RoadModel;
use roverlab::world::World;
use roverlab::world::road::Appearance;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let car = parking_car();
    let camera = car.camera.as_ref().ok_or("a car without a camera")?.into();
    for (kind, name) in [(ParkingKind::Parallel, "parallel"), (ParkingKind::Perpendicular, "perpendicular")] {
        let lot = ParkingLot::drawn(kind, 1)?;
        let scene = lot.scene(&Appearance::default())?;
        let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
        let truth = simulation.truth();
        let mut driver =
            ParkingDriver::new(camera, RoadModel::default(), kind, ParkingParameters::default())?;
        let mut way: Vec<Point> = Vec::new();
        let outcome = run(&mut simulation.robot(0)?, &mut driver, 60.0, |_, _, _| {
            way.push(truth.pose(0)?.position());
            Ok::<_, roverlab::io::Error>(())
        })?;
        let pose = truth.pose(0)?;
        println!("{name}: {outcome} after {:.0} s, in a spot of {:.0} mm", truth.time(), {
            1000.0 * (lot.spot.1 - lot.spot.0)
        });
        assert_eq!(outcome, ParkingOutcome::Parked);
        assert!(lot.is_parked(&car, &pose) && !lot.is_touched(&car, &pose));

        let (floor, objects) = (lot.course.floor(), scene.world.objects.clone());
        let mut picture = Picture::new(&World { floor, objects, ..World::empty(1.0, 1.0) });
        picture.title("Parking").caption(name);
        for left in [lot.course.edge(), 0.0, -lot.course.edge()] {
            let line = (0..=80).map(|i| lot.course.line.beside(0.1 * f64::from(i), left));
            picture.line(line, Style::aid());
        }
        picture.true_path(way);
        picture.save(format!("target/pictures/parking_{name}.svg"))?;
    }
    Ok(())
}
