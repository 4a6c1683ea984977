//! A search (book, section 8.5): Mako looks for something red on the floor of a pool, through turbid water
//! and in half the light, and says where it is.
//!
//! `cargo run --release --example pool_search`

use std::sync::Arc;

use roverlab::drive::marine::{PoolSearch, PoolSearchOutcome, PoolSearchParameters};
use roverlab::geometry::{Aabb, Point, Pose, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Mark, Picture};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape, Water, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let water = Water { turbidity: 0.5, ..Water::default() };
    let mut pool = World { water_level: Some(2.0), water, ..World::walled(8.0, 6.0) };
    for wall in &mut pool.walls {
        wall.height = 3.0;
    }
    let brick = Shape::Box { length: 0.25, width: 0.2, height: 0.1 };
    let places = [Point::new(3.0, 2.5), Point::new(5.5, 3.2), Point::new(2.2, 4.4)];
    let colours = [("orange", 0xe0_80_10), ("red", 0xc8_20_20), ("blue", 0x20_50_c8)];
    for (place, (name, colour)) in places.into_iter().zip(colours) {
        let kind = ObjectKind { mass: 8.0, ..ObjectKind::new(name, brick, Colour::from_hex(colour)) };
        pool.objects.push(Object::new(Arc::new(kind), Pose::new(place.x, place.y, 0.4)));
    }
    let mako = RobotSpec { dvl: Some(10.0), ..RobotSpec::mako() };
    let start = Pose::new(1.7, 1.7, 0.0);
    let scene = Scene::with_robot(pool, mako.clone(), start);
    let simulation = Simulation::new(
        &scene,
        SimOptions { light: 0.5, trail_interval: Some(0.2), ..SimOptions::with_noise(1.0, 1) },
    )?;

    let area = Aabb::new(Point::origin(), Point::new(8.0, 6.0));
    let mut search = PoolSearch::new(&mako, start, area, true, PoolSearchParameters::default())?;
    let outcome = run(&mut simulation.robot(0)?, &mut search, 600.0, |_, _, _| {})?;
    assert_eq!((outcome, simulation.truth().robot(0)?.contacts), (PoolSearchOutcome::Found, 0));

    let place = search.place().ok_or("nothing was found")?;
    let off = (place - places[1]).norm();
    let [x, y] = [place.x, place.y].map(units::to_mm);
    println!("found at ({x:.0}, {y:.0}) mm, {:.0} mm off", units::to_mm(off));
    assert!(off < 0.15);

    let (end, mut picture) = (simulation.truth().robot(0)?, Picture::new(&scene.world));
    picture.title("A search for something red").mark(Mark::Start, start.position()).mark(Mark::Goal, place);
    picture.true_path(end.trail.iter().map(|point| point.pose.position()));
    picture.robot(end.pose, &mako.footprint).save("target/pictures/pool_search.svg")?;
    Ok(())
}
