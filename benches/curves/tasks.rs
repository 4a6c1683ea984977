//! The tasks: each is made in several sizes at one density of what it holds.

use std::f64::consts::TAU;
use std::hint::black_box;

use roverlab::evolve::{Evolution, Genetic, Recipe, Serial, Trial};
use roverlab::geometry::{Point, Pose, Twist, direction};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, Drive, Lidar, LidarScan};
use roverlab::maze::generate::braided;
use roverlab::maze::{FloodFill, Passages, Unknown};
use roverlab::nav::grid::{AnyAngle, GridPlanner, GridSearch, JumpPointSearch, PreparedJumps};
use roverlab::race::{
    CentreLine, CentreLineParameters, Cone, ConeTrack, GeneratedTrack, LineSolver, RacingLineParameters,
    TrackOptions, generate,
};
use roverlab::random::Stream;
use roverlab::scan::{LocalisationMap, Localiser, LocaliserParameters};
use roverlab::vision::{Canny, CannyThresholds, GrayView, GrayViewMut};
use roverlab::world::space::{Scanner, Space};
use roverlab::world::{BitGrid, RobotSpec, Scene, Wall, World};
use roverlab_bench::fleet::{PERIOD, avoiders};
use roverlab_bench::{free_poses, maps, thicket};

use crate::curve::Curve;

pub(crate) const ALL: [fn() -> Curve; 14] = [
    fleet,
    scan,
    || planner("A*", |grid| Box::new(GridSearch::astar(grid))),
    || planner("jump points", |grid| Box::new(JumpPointSearch::new(grid))),
    || planner("prepared jumps", |grid| Box::new(PreparedJumps::new(grid))),
    || planner("any angle", |grid| Box::new(AnyAngle::new(grid))),
    preparation,
    flood_fill,
    edges,
    localisation,
    way_between_cones,
    racing_line,
    laps,
    generation,
];

/// A tenth of a second of robots that avoid what their distance sensors see, one for each wall.
fn fleet() -> Curve {
    Curve::measure("fleet, 0.1 s", "robots", &[10, 100, 1000, 10_000], |robots| {
        let mut fleet = avoiders(&thicket(robots, 2), robots);
        fleet.run_for(1.0).expect("nothing fails");
        (robots, move || fleet.run_for(PERIOD).expect("nothing fails"))
    })
}

/// A scan of 360 beams up to 10 m.
fn scan() -> Curve {
    Curve::measure("scan of 360 beams", "walls", &[100, 1000, 10_000, 100_000], |walls| {
        let world = thicket(walls, 3);
        let space = Space::new(&world.walls);
        let mut scanner = Scanner::new(0.0, TAU / 360.0, 360, 0.1, 0.0, 9.999);
        let mut ranges = vec![0.0; 360];
        let mut poses = free_poses(&world, 16, 0.1, 4).into_iter().cycle();
        (walls, move || {
            space.scan(&mut scanner, &poses.next().expect("endless"), None, &mut ranges);
            black_box(&ranges);
        })
    })
}

/// Cells along the sides of maps of rooms.
const SIDES: [usize; 6] = [64, 128, 256, 512, 1024, 2048];

/// A map of rooms, with twenty queries.
fn rooms(side: usize) -> maps::Map {
    maps::own(side, 20).into_iter().next().expect("rooms come first")
}

/// Twenty queries of a planner.
fn planner(name: &'static str, make: fn(&BitGrid) -> Box<dyn GridPlanner>) -> Curve {
    Curve::measure(name, "cells, 20 queries", &SIDES, |side| {
        let map = rooms(side);
        let mut planner = make(&map.grid);
        (side * side, move || {
            for &(start, goal) in &map.queries {
                black_box(planner.plan(start, goal).expect("a way"));
            }
        })
    })
}

/// What prepared jumps need to get ready for a map.
fn preparation() -> Curve {
    Curve::measure("jumps made ready", "cells", &SIDES, |side| {
        let map = rooms(side);
        (side * side, move || {
            black_box(PreparedJumps::new(&map.grid));
        })
    })
}

/// The distances of all cells of a maze from its start.
fn flood_fill() -> Curve {
    Curve::measure("flood fill", "cells of a maze", &[8, 16, 32, 64, 128, 256], |side| {
        let maze = braided(side, side, 0.1, 1).expect("a size within limits");
        let (passages, start) = (Passages::new(&maze, Unknown::Closed), maze.start());
        let mut flood = FloodFill::default();
        (side * side, move || {
            black_box(flood.run(&passages, [start]).reached());
        })
    })
}

/// Edges of an image of bright and dark squares with noise.
fn edges() -> Curve {
    Curve::measure("Canny's edges", "pixels", &[64, 128, 256, 512, 1024, 2048], |side| {
        let mut stream = Stream::new(1);
        let pixel = |i: usize| if (i % side / 16 + i / side / 16).is_multiple_of(2) { 40 } else { 180 };
        let image: Vec<u8> = (0..side * side).map(|i| pixel(i) + stream.below(20) as u8).collect();
        let (mut found, mut canny) = (vec![0; side * side], Canny::new());
        (side * side, move || {
            let view = GrayView::new(&image, side, side).expect("as many pixels");
            let edges = GrayViewMut::new(&mut found, side, side).expect("as many pixels");
            canny.find_into(view, edges, CannyThresholds { low: 60, high: 150 }).expect("equal sizes");
        })
    })
}

/// The search for a robot anywhere in a hall by one scan, with a partition wall for each 25 square metres.
fn localisation() -> Curve {
    Curve::measure("robot sought in a hall", "square metres", &[5, 10, 20, 40], |side| {
        let extent = side as f64;
        let mut world = World::walled(extent, extent);
        let mut stream = Stream::new(5);
        for _ in 0..side * side / 25 {
            let middle = Point::new(stream.between(0.5, extent - 0.5), stream.between(0.5, extent - 0.5));
            let half = direction(stream.between(0.0, TAU)) * stream.between(0.3, 0.9);
            world.walls.push(Wall::new(middle - half, middle + half));
        }
        let pose = free_poses(&world, 1, 0.4, 6)[0];
        let localiser = Localiser::new(
            LocalisationMap::new(&world).expect("a hall of this size"),
            LocaliserParameters::default(),
        );
        let localiser = localiser.expect("default parameters");
        let scene = Scene::with_robot(world, RobotSpec::s4(), pose);
        let hall = Simulation::new(&scene, SimOptions::with_noise(1.0, 1)).expect("a good scene");
        let scan = hall.robot(0).and_then(|mut robot| robot.scan()).expect("an S4 has a lidar");
        (side * side, move || localiser.clone().update(Pose::default(), &scan).expect("a good scan"))
    })
}

/// Metres of tracks.
const LENGTHS: [usize; 5] = [120, 250, 500, 1000, 2000];

/// A track of about so many metres.
fn track(metres: usize) -> GeneratedTrack {
    let length = metres as f64;
    let options = TrackOptions { length: [0.9 * length, 1.1 * length], ..TrackOptions::default() };
    generate(1, &options).expect("options that a track can meet")
}

/// The way through all cones of a track without colours, after a lap around it.
fn way_between_cones() -> Curve {
    Curve::measure("way between cones", "cones", &LENGTHS, |metres| {
        let GeneratedTrack { track, corridor } = track(metres);
        let cones: Vec<Cone> = track.cones.iter().map(|cone| Cone::unknown(cone.position)).collect();
        let driven: Vec<Point> =
            corridor.stations().iter().step_by(2).map(|station| station.position).collect();
        let start = track.start.expect("a start");
        (cones.len(), move || {
            let way = CentreLine::along(&cones, start, &driven, &CentreLineParameters::default());
            black_box(way.expect("a way"));
        })
    })
}

/// The racing line of a track.
fn racing_line() -> Curve {
    Curve::measure("racing line", "metres", &LENGTHS, |metres| {
        let corridor = track(metres).corridor;
        let parameters = RacingLineParameters { margin: 0.95, ..RacingLineParameters::default() };
        let mut solver = LineSolver::default();
        (corridor.length() as usize, move || {
            black_box(solver.solve(&corridor, &parameters).expect("a line"));
        })
    })
}

/// Radius of a ring of cones, and speed of the car on it.
const RING: (f64, f64) = (15.0, 8.0);

/// Laps of a racing car on a ring of 120 cones, with a scan twenty times a second.
fn laps() -> Curve {
    Curve::measure("laps of a ring", "laps", &[1, 10, 100], |laps| {
        let (radius, speed) = RING;
        let cones = (0..60).flat_map(|i| {
            let outwards = direction(TAU * f64::from(i) / 60.0);
            [radius - 2.0, radius + 2.0].map(|radius| Point::new(0.0, radius) + outwards * radius)
        });
        let cones = cones.map(Cone::unknown).collect();
        let scene = ConeTrack { cones, ..ConeTrack::default() }.scene(&[Pose::default()]);
        let steps = (laps as f64 * TAU * radius / speed / 0.05).ceil() as usize;
        (laps, move || {
            let ring = Simulation::new(&scene, SimOptions::with_noise(1.0, 1)).expect("a good scene");
            let (mut car, mut scan) = (ring.robot(0).expect("the only car"), LidarScan::default());
            for _ in 0..steps {
                car.scan_into(&mut scan).expect("the car has a lidar");
                car.set_speed(Twist::new(speed, speed / radius)).expect("a speed within limits");
                car.wait(0.05).expect("nothing fails");
            }
        })
    })
}

/// A generation of the book's recipe, whose individuals are judged by counting bits.
fn generation() -> Curve {
    Curve::measure("generation", "individuals", &[10, 100, 1000, 10_000], |individuals| {
        let ones = |genome: &Vec<u8>, _: Trial| {
            Ok(genome.iter().map(|gene| f64::from(gene.count_ones())).sum::<f64>())
        };
        let mut stream = Stream::new(1);
        let population =
            (0..individuals).map(|_| (0..16).map(|_| stream.below(256) as u8).collect()).collect();
        let mut evolution = Genetic::new(population, Recipe::book(6), 1).expect("a population");
        let mut judge = Serial::new(ones);
        (individuals, move || evolution.step(&mut judge).expect("nothing fails"))
    })
}
