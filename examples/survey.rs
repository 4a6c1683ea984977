//! A survey (book, section 8.5): Mako drives lanes over the floor of a pool, knows its place by the walls,
//! its Doppler log and its compass, and makes a map of depths, each with its uncertainty.
//!
//! `cargo run --release --example survey`

use roverlab::drive::marine::{DepthMap, Survey, SurveyOutcome, SurveyParameters};
use roverlab::geometry::{Aabb, Point, Pose, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Mark, Picture};
use roverlab::world::{HeightField, RobotSpec, Scene, Terrain, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A floor that rises by half a metre in eight.
    let area = Aabb::new(Point::origin(), Point::new(8.0, 6.0));
    let floor = HeightField::from_fn(81, 61, area, |at| 0.5 * at.x / 8.0)?;
    let mut pool = World {
        terrain: Some(Terrain::new("floor", floor)),
        water_level: Some(2.0),
        ..World::walled(8.0, 6.0)
    };
    for wall in &mut pool.walls {
        wall.height = 3.0;
    }
    let mako = RobotSpec { dvl: Some(10.0), ..RobotSpec::mako() };
    let start = Pose::new(2.0, 2.0, 0.0);
    let scene = Scene::with_robot(pool, mako.clone(), start);
    let simulation =
        Simulation::new(&scene, SimOptions { trail_interval: Some(0.2), ..SimOptions::with_noise(1.0, 1) })?;

    let mut survey = Survey::new(&mako, start, area, true, SurveyParameters::default())?;
    let mut map = DepthMap::new(area.inflated(-0.5), 1.0)?;
    let outcome = run(&mut simulation.robot(0)?, &mut survey, 600.0, |_, survey, _| {
        survey.sounding().into_iter().for_each(|sounding| map.add(sounding));
    })?;
    assert_eq!((outcome, simulation.truth().robot(0)?.contacts), (SurveyOutcome::Covered, 0));

    let mut worst = 0.0_f64;
    for row in 0..map.rows() {
        for column in 0..map.columns() {
            let cell = map.cell(column, row).ok_or("a cell was not measured")?;
            print!("{:5.0}", units::to_mm(cell.depth));
            let depth = 2.0 - 0.5 * map.centre(column, row).x / 8.0;
            worst = worst.max((cell.depth - depth).abs());
        }
        println!();
    }
    println!("no depth is more than {:.0} mm off", units::to_mm(worst));
    assert!(worst < 0.03);

    let (end, mut picture) = (simulation.truth().robot(0)?, Picture::new(&scene.world));
    picture.title("Lanes over the floor of a pool").mark(Mark::Start, start.position());
    picture.true_path(end.trail.iter().map(|point| point.pose.position()));
    picture.robot(end.pose, &mako.footprint).save("target/pictures/survey.svg")?;
    Ok(())
}
