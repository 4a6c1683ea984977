//! Global localisation with few beams, in rooms with pillars in a grid, which look nearly alike from many
//! places and exactly alike when turned.

use roverlab::drive::{RandomDrive, RandomDriveParameters};
use roverlab::geometry::{Point, Pose, angle_difference};
use roverlab::io::control::{self, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, Lidar, Odometry};
use roverlab::random::Stream;
use roverlab::scan::{Hypothesis, Localisation, LocalisationMap, Localiser, LocaliserParameters};
use roverlab::world::{LidarSpec, RobotSpec, Scene, World};

/// Pillars in a grid, in the middle of a room.
#[derive(Debug, Clone, Copy)]
struct Grid {
    columns: u32,
    rows: u32,
    /// Distance between the middles of pillars, and width of a pillar (m).
    pitch: f64,
    width: f64,
    /// Whether another pillar stands in a corner, so that nothing looks the same.
    marked: bool,
}

impl Grid {
    /// The room ends at a pitch from the middles of the outermost pillars.
    fn size(&self) -> (f64, f64) {
        (f64::from(self.columns + 1) * self.pitch, f64::from(self.rows + 1) * self.pitch)
    }

    /// Number of poses from which the room looks the same.
    fn symmetry(&self) -> usize {
        match self {
            Grid { marked: true, .. } => 1,
            Grid { columns, rows, .. } if columns == rows => 4,
            _ => 2,
        }
    }

    fn world(&self) -> World {
        let (width, height) = self.size();
        let mut world = World::walled(width, height);
        let places = (0..self.columns).flat_map(|column| (0..self.rows).map(move |row| (column, row)));
        for (column, row) in places {
            let middle = Point::new(f64::from(column + 1) * self.pitch, f64::from(row + 1) * self.pitch);
            world.add_loop(&square(middle, self.width));
        }
        if self.marked {
            world.add_loop(&square(Point::new(0.5 * self.pitch, 0.4 * self.pitch), 0.5 * self.width));
        }
        world
    }
}

/// Corners of a square.
fn square(middle: Point, width: f64) -> [Point; 4] {
    let half = 0.5 * width;
    [(-half, -half), (half, -half), (half, half), (-half, half)]
        .map(|(x, y)| Point::new(middle.x + x, middle.y + y))
}

/// An S4 with so many beams.
fn robot(beams: usize) -> RobotSpec {
    RobotSpec { lidar: Some(LidarSpec { points: beams, ..LidarSpec::default() }), ..RobotSpec::s4() }
}

/// A free pose of a room.
fn start(map: &LocalisationMap, grid: &Grid, stream: &mut Stream) -> Pose {
    let (width, height) = grid.size();
    loop {
        let place = Point::new(stream.between(0.2, width - 0.2), stream.between(0.2, height - 0.2));
        if map.is_free(place, 0.2) {
            return Pose::new(place.x, place.y, stream.between(-3.1, 3.1));
        }
    }
}

/// Time for which the robot drives about, at most (s).
const PATIENCE: f64 = 30.0;
/// Number of consecutive scans with one place after which it stops.
const CONTENT: u32 = 12;
/// Number of steps between scans that are used.
const EVERY: u32 = 4;

/// Drives about until one place explains the scans, stands, and returns the answer and the true pose.
fn localise(grid: &Grid, beams: usize, seed: u64) -> (Localisation, Vec<Hypothesis>, Pose) {
    let (world, mut stream) = (grid.world(), Stream::new(seed));
    let map = LocalisationMap::new(&world).unwrap();
    let scene = Scene::with_robot(world, robot(beams), start(&map, grid, &mut stream));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed)).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    let mut localiser = Localiser::new(map, LocaliserParameters::default()).unwrap();
    let mut wander = RandomDrive::new(RandomDriveParameters::default(), stream).unwrap();
    let (mut content, mut steps) = (0, 0_u32);
    control::run(&mut robot, &mut wander, PATIENCE, |_, _, at| {
        if steps.is_multiple_of(EVERY) {
            localiser.update(at.seen.pose, &at.seen.scan)?;
            let one = matches!(localiser.localisation(), Localisation::One(_));
            content = if one { content + 1 } else { 0 };
        }
        steps += 1;
        roverlab::io::Result::Ok(until(content >= CONTENT))
    })
    .unwrap();
    robot.wait(1.0).unwrap();
    localiser.update(robot.pose().unwrap(), &robot.scan().unwrap()).unwrap();
    let found = localiser.localisation();
    let places = localiser.hypotheses()[..found.count()].to_vec();
    (found, places, simulation.truth().pose(0).unwrap())
}

/// Whether a pose is the true one to within 100 mm, five stated deviations and 3 degrees.
fn is_true(place: &Hypothesis, truth: &Pose) -> bool {
    let off = place.pose.distance_to(truth.position());
    let turn = angle_difference(place.pose.heading, truth.heading).abs();
    off <= 0.1 && off <= 5.0 * place.deviation() && turn <= 0.05
}

/// Numbers of right answers (as many places as look alike, one of them true), of those with more places, and
/// of starts where nothing was said; and the wrong answers in words.
#[derive(Debug, Default)]
struct Answers {
    right: usize,
    several: usize,
    lost: usize,
    wrong: Vec<String>,
}

fn answers(grids: &[Grid], beams: &[usize], starts: u64) -> Answers {
    let mut answers = Answers::default();
    for (grid, &beams) in grids.iter().flat_map(|grid| beams.iter().map(move |beams| (grid, beams))) {
        for seed in 0..starts {
            let (found, places, truth) = localise(grid, beams, seed);
            let is_told = places.iter().any(|place| is_true(place, &truth));
            match (found.count(), grid.symmetry()) {
                (0, _) => answers.lost += 1,
                (count, alike) if is_told && count == alike => answers.right += 1,
                (count, alike) if is_told && count > alike => answers.several += 1,
                (count, alike) => {
                    let nearest = places
                        .iter()
                        .map(|place| place.pose.distance_to(truth.position()))
                        .fold(99.0, f64::min);
                    answers.wrong.push(format!(
                        "{beams} beams, seed {seed}, {grid:?}: {count} of {alike} places, {nearest:.3} m off"
                    ));
                }
            }
        }
    }
    answers
}

const GRIDS: [Grid; 4] = [
    Grid { columns: 6, rows: 4, pitch: 1.4, width: 0.3, marked: false },
    Grid { columns: 6, rows: 4, pitch: 1.4, width: 0.3, marked: true },
    Grid { columns: 7, rows: 7, pitch: 0.9, width: 0.15, marked: false },
    Grid { columns: 3, rows: 2, pitch: 1.2, width: 0.2, marked: true },
];

#[test]
fn few_beams_among_pillars_tell_no_wrong_place() {
    let found = answers(&GRIDS, &[12, 36, 60], 1);
    assert!(found.wrong.is_empty(), "{found:#?}");
}

mod campaigns {
    use super::*;

    #[test]
    #[ignore = "takes minutes: cargo test --release --test localisation -- --ignored --nocapture"]
    fn few_beams_among_many_pillars_tell_no_wrong_place() {
        let mut wrong = 0;
        for beams in [8, 12, 18, 24, 36, 45, 60, 90, 120, 180, 360] {
            let found = answers(&GRIDS, &[beams], 12);
            println!("{beams} beams: {found:#?}");
            wrong += found.wrong.len();
        }
        assert_eq!(wrong, 0);
    }
}
