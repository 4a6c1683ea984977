//! Ways over hills (book, section 7.4): where a snow truck can go by its slopes, and the shortest way, the
//! cheapest one and the fastest one to the highest place that it can reach.
//!
//! `cargo run --release --example terrain_plan`

use roverlab::geometry::Point3;
use roverlab::nav::elevation::{Climber, ElevationMap, ElevationPlanner, Objective};
use roverlab::picture::{Mark, Picture, SERIES, Style};
use roverlab::random::Stream;
use roverlab::world::RobotSpec;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let range = relief(&mut Stream::new(10), &ReliefOptions::of(ReliefKind::Range))?;
    let ground = range.world.terrain.clone().and_then(|terrain| terrain.surface).ok_or("no hills")?;
    let map = ElevationMap::new(&ground, &Climber::of(&RobotSpec::blizzard()))?;
    let start = range.start.position();
    let top = map.highest_reachable(start).ok_or("the start is too steep")?;

    let mut picture = Picture::new(&range.world);
    picture.title("To the top by length, energy and time");
    picture.mark(Mark::Start, start).mark(Mark::Goal, top.xy());
    let objectives = [
        ("length", Objective::Length),
        ("energy", Objective::Energy { resistance: 0.1 }),
        ("time", Objective::Time { speed: 0.3, climb: 0.05 }),
    ];
    let mut lengths = Vec::new();
    for ((name, objective), colour) in objectives.into_iter().zip(SERIES) {
        let mut planner = ElevationPlanner::astar(&map, objective)?;
        let path = planner.plan_any_angle(start, top.xy())?;
        let length: f64 = path.points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let cells = planner.plan(start, top.xy())?;
        println!("{name}: cost {:.2} ({:.2} from cell to cell), {length:.2} m", path.cost, cells.cost);
        assert!(path.cost <= cells.cost + 1e-9, "a way in any direction is no dearer");
        lengths.push(length);
        let style = Style::new(colour).width(2.0).labelled(name);
        picture.line(path.points.iter().map(Point3::xy), style);
    }
    assert!(lengths[0] <= lengths[1] + 1e-9 && lengths[0] <= lengths[2] + 1e-9, "{lengths:?}");
    picture.save("target/pictures/terrain_plan.svg")?;
    Ok(())
}
