//! The verdicts of the bug family and of the navigator on goals beside walls, corners and curves, at every
//! distance from touching to well clear.

use roverlab::geometry::{Point, Pose, direction};
use roverlab::io::control;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::nav::{BugKind, BugOutcome, BugParameters, Navigator, NavigatorOutcome, NavigatorParameters};
use roverlab::random::Stream;
use roverlab::world::{LidarSpec, RobotSpec, Scene, Wall, World};

/// The farthest goal from a surface in metres.
const FAR: f64 = 0.2;
/// Goals for which a few millimetres decide are left out, in metres, by the level of noise: a tenth of the
/// tolerance is kept.
const UNDECIDED: [f64; 2] = [0.004, 0.02];
/// How far from the goal the robot may truly be where it says that it is there, in metres, by the level of
/// noise.
const MISSED: [f64; 2] = [0.03, 0.1];

/// A room with a block and a round pillar.
fn room() -> World {
    let mut world = World::walled(3.0, 2.2);
    let block = [(1.0, 0.5), (1.6, 0.5), (1.6, 1.0), (1.0, 1.0)].map(|(x, y)| Point::new(x, y));
    world.add_loop(&block);
    let pillar: Vec<Point> = (0..32)
        .map(|i| Point::new(2.3, 1.2) + direction(f64::from(i) * std::f64::consts::TAU / 32.0) * 0.3)
        .collect();
    world.add_loop(&pillar);
    world
}

/// A goal beside a wall, in a corner, outside a corner, or beside the pillar.
fn goal(stream: &mut Stream) -> Point {
    let away = stream.between(0.0, FAR);
    match stream.below(4) {
        0 => Point::new(stream.between(0.5, 2.5), 2.195 - away),
        1 => Point::new(2.995 - away, 0.005 + stream.between(0.0, FAR)),
        2 => Point::new(1.605, 1.005) + direction(stream.between(0.0, std::f64::consts::FRAC_PI_2)) * away,
        _ => Point::new(2.3, 1.2) + direction(stream.between(-3.1, 3.1)) * (0.305 + away),
    }
}

/// How much larger than the disc of a robot the free space is at the best place that counts as the goal, in
/// metres.
fn room_at(world: &World, goal: Point, parameters: &BugParameters) -> f64 {
    let clearance = |place: Point| {
        let far = |wall: &Wall| wall.line.distance_to(place) - 0.5 * wall.thickness;
        world.walls.iter().map(far).fold(f64::INFINITY, f64::min)
    };
    let rings =
        (0..=10).flat_map(|ring| (0..72).map(move |turn| (f64::from(ring) / 10.0, f64::from(turn) / 72.0)));
    let places = rings.map(|(ring, turn)| {
        goal + direction(turn * std::f64::consts::TAU) * (ring * parameters.goal_tolerance)
    });
    let inside = |place: &Point| {
        (place.x - 1.3).abs() < 0.3 && (place.y - 0.75).abs() < 0.25
            || (place - Point::new(2.3, 1.2)).norm() < 0.29
            || !(0.0..3.0).contains(&place.x)
            || !(0.0..2.2).contains(&place.y)
    };
    let best = places.filter(|place| !inside(place)).map(clearance).fold(0.0, f64::max);
    best - parameters.robot_radius - parameters.least_clearance
}

/// Drives all bugs to some goals. The wrong verdicts in words, and how many runs there were.
fn wrong(goals: usize, noise: u32, seed: u64) -> (Vec<String>, usize) {
    let (world, mut stream) = (room(), Stream::new(seed));
    let level = noise as usize;
    let (mut wrong, mut runs) = (Vec::new(), 0);
    for _ in 0..goals {
        let (goal, parameters) = (goal(&mut stream), BugParameters::default());
        let room = room_at(&world, goal, &parameters);
        let start = Pose::new(0.5, stream.between(0.3, 1.9), stream.between(-3.1, 3.1));
        if room.abs() < UNDECIDED[level] {
            continue;
        }
        let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
        for kind in BugKind::ALL {
            let options = SimOptions::with_noise(f64::from(noise), seed);
            let simulation = Simulation::new(&scene, options).unwrap();
            let (truth, mut robot) = (simulation.truth(), simulation.robot(0).unwrap());
            let parameters = BugParameters { match_scans: noise > 0, ..parameters };
            let mut bug = kind.with(start.to_local(goal), parameters).unwrap();
            let outcome = control::run(&mut robot, bug.as_mut(), 600.0, |_, _, _| {}).unwrap();
            let off = truth.robot(0).unwrap().pose.distance_to(goal);
            let contacts = truth.robot(0).unwrap().contacts;
            let right = match outcome {
                BugOutcome::Reached => room > 0.0 && off <= MISSED[level],
                BugOutcome::NoRoom => room < 0.0,
                _ => false,
            };
            runs += 1;
            if !right || contacts > 0 {
                wrong.push(format!(
                    "{kind} from {start:?} to {goal}: {outcome:?} {off:.3} m off, {contacts} contacts, room {room:.4} m"
                ));
            }
        }
    }
    (wrong, runs)
}

/// Goals for which so little decides are left out for the navigator, in metres: it knows the walls.
const UNDECIDED_ON_A_MAP: f64 = 0.001_5;
/// Time in which it is at any goal of the room, in seconds: it does not hover beside one.
const IN_TIME: f64 = 40.0;

/// Drives the navigator to some goals, as `wrong` does the bugs.
fn wrong_on_a_map(goals: usize, noise: f64, seed: u64) -> (Vec<String>, usize) {
    let (world, mut stream) = (room(), Stream::new(seed));
    let (mut wrong, mut runs) = (Vec::new(), 0);
    for _ in 0..goals {
        let goal = goal(&mut stream);
        // Both keep 60 mm and 12 mm, and count what is within 25 mm.
        let room = room_at(&world, goal, &BugParameters::default());
        let start = Pose::new(0.5, stream.between(0.3, 1.9), stream.between(-3.1, 3.1));
        if room.abs() < UNDECIDED_ON_A_MAP {
            continue;
        }
        let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
        let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, seed)).unwrap();
        let (truth, mut robot) = (simulation.truth(), simulation.robot(0).unwrap());
        let mut navigator = Navigator::new(&world, start, goal, NavigatorParameters::default()).unwrap();
        let outcome = control::run(&mut robot, &mut navigator, IN_TIME, |_, _, _| {}).unwrap();
        let (pose, contacts) = (truth.robot(0).unwrap().pose, truth.robot(0).unwrap().contacts);
        let right = match outcome {
            NavigatorOutcome::Reached => room > 0.0 && pose.distance_to(goal) <= MISSED[1],
            NavigatorOutcome::NoRoom => room < 0.0,
            _ => false,
        };
        runs += 1;
        if !right || contacts > 0 {
            wrong.push(format!(
                "from {start:?} to {goal}: {outcome:?}, {contacts} contacts, room {room:.4} m"
            ));
        }
    }
    (wrong, runs)
}

#[test]
fn a_map_tells_where_the_robot_has_room() {
    let (wrong, runs) = wrong_on_a_map(60, 1.0, 1);
    assert!(wrong.is_empty() && runs > 50, "{} of {runs}: {wrong:#?}", wrong.len());
}

#[test]
fn reached_is_reached_beside_walls() {
    let (wrong, runs) = wrong(8, 0, 1);
    assert!(wrong.is_empty() && runs > 60, "{} of {runs}: {wrong:#?}", wrong.len());
}

/// How a bug ends without noise.
fn end(kind: BugKind, world: &World, start: Pose, goal: Point) -> BugOutcome {
    let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
    let simulation = Simulation::new(&scene, SimOptions::with_noise(0.0, 1)).unwrap();
    let parameters = BugParameters { match_scans: false, ..BugParameters::default() };
    let mut bug = kind.with(start.to_local(goal), parameters).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    control::run(&mut robot, bug.as_mut(), 600.0, |_, _, _| {}).unwrap()
}

/// A passage of one and a half robot widths beside the place where an obstacle is met: the boundary through
/// it and the one past it are near each other, and only one of them is the loop.
#[test]
fn a_passage_beside_the_end_of_a_lap_is_entered() {
    let mut world = World::walled(2.118, 2.378);
    for (from, to) in [(0.0, 1.25), (1.435, 2.378)] {
        world.walls.push(Wall::new(Point::new(1.059, from), Point::new(1.059, to)));
    }
    let (start, goal) = (Pose::new(0.754, 2.189, 1.27), Point::new(1.438, 0.463));
    for kind in BugKind::ALL {
        assert_eq!(end(kind, &world, start, goal), BugOutcome::Reached, "{kind}");
    }
}

/// A cell with a gap that is only just wide enough (m between the ends of its walls), beside the place where
/// it is met: behind it, and before it.
#[test]
fn a_gap_beside_the_start_of_a_lap_is_entered() {
    let point = |x: f64, y: f64| Point::new(x / 1000.0, y / 1000.0);
    let (corner, next) = (point(1677.31, 926.80), point(2073.20, 1677.31));
    let along = (next - corner).normalize();
    let middle = point(1818.1, 1193.695);
    for (gap, start, goal) in [
        (0.170_63, Pose::new(2.149_06, 0.690_39, 168.4_f64.to_radians()), point(1559.126, 1510.702)),
        (0.175, Pose::new(2.061_825, 0.766_765, 35.866_f64.to_radians()), point(1588.661, 1506.675)),
        (0.162_8, Pose::new(2.054_743, 0.727_88, -113.777_f64.to_radians()), point(1605.01, 1511.395)),
    ] {
        let mut world = World::walled(3.0, 3.0);
        let ends = [middle - along * (0.5 * gap), middle + along * (0.5 * gap)];
        let ring = [next, point(1322.69, 2073.20), point(926.80, 1322.69), corner];
        world.walls.extend(ring.windows(2).map(|two| Wall::new(two[0], two[1])));
        world.walls.extend([Wall::new(corner, ends[0]), Wall::new(ends[1], next)]);
        for kind in BugKind::ALL {
            assert_eq!(end(kind, &world, start, goal), BugOutcome::Reached, "{kind}, {gap}");
        }
    }
}

/// A ring of walls, one of whose gaps leaves few millimetres on either side. TangentBug sees a place behind
/// it for which it leaves the wall, but cannot steer so exactly; following the wall, it gets in.
#[test]
fn a_gap_too_narrow_to_steer_through_from_afar_is_entered_along_the_wall() {
    let mut world = World::walled(2.129_141, 2.379_761);
    let walls = [
        [1867.669, 1535.532, 1401.153, 1639.584],
        [1293.791, 1663.531, 620.822, 1813.631],
        [620.822, 1813.631, 481.572, 1189.305],
        [443.475, 1018.502, 342.723, 566.783],
        [342.723, 566.783, 831.786, 457.702],
        [968.428, 427.225, 1589.571, 288.685],
        [1589.571, 288.685, 1742.883, 976.056],
        [1766.829, 1083.418, 1867.669, 1535.532],
    ];
    let point = |x: f64, y: f64| Point::new(x / 1000.0, y / 1000.0);
    world.walls.extend(walls.map(|[x, y, to_x, to_y]| Wall::new(point(x, y), point(to_x, to_y))));
    let start = Pose::new(0.231_52, 1.981_56, 28.9_f64.to_radians());
    assert_eq!(end(BugKind::TangentBug, &world, start, point(603.0, 785.07)), BugOutcome::Reached);
}

/// In a corner that the robot's disc does not fill, it has room within the tolerance of the goal, but beside
/// the straight way there from most places along the walls.
#[test]
fn room_beside_the_straight_way_to_the_goal_counts() {
    let (start, goal) = (Pose::new(0.5, 0.858_831_81, -2.867_829_18), Point::new(2.936_542_37, 0.064_813_58));
    for kind in BugKind::ALL {
        assert_eq!(end(kind, &room(), start, goal), BugOutcome::Reached, "{kind}");
    }
}

/// A slit that beams from afar see as wide enough, and that is closed to the robot's disc: the bugs that
/// leave walls by free ranges came back to it for ever.
#[test]
fn a_slit_that_seems_open_does_not_mislead_for_ever() {
    for width in [0.137, 0.1386, 0.145] {
        let mut world = World::walled(2.0, 2.6);
        for (from, to) in [(0.0, 1.830_81), (1.830_81 + width, 2.6)] {
            world.walls.push(Wall::new(Point::new(1.119_32, from), Point::new(1.119_32, to)));
        }
        let (start, goal) = (Pose::new(0.3, 0.3, 0.0), Point::new(1.8471, 1.893));
        for kind in [BugKind::DistBug, BugKind::LeaveBug, BugKind::TangentBug] {
            assert_eq!(end(kind, &world, start, goal), BugOutcome::Unreachable, "{kind}, {width}");
        }
    }
}

/// Beams 6 and 10 degrees apart end farther from each other on a wall than 360 do. Scans that are not matched
/// leave the pose to odometry, and a goal that has room is taken for one in a wall.
#[test]
fn few_beams_tell_where_there_is_room() {
    let (start, goal) = (Pose::new(1.0, 1.0, 0.0), Point::new(5.92, 3.0));
    for (beams, seed) in [(36, 2), (36, 4), (60, 1), (60, 4)] {
        let lidar = Some(LidarSpec { points: beams, ..LidarSpec::default() });
        let spec = RobotSpec { lidar, ..RobotSpec::s4() };
        let scene = Scene::with_robot(World::walled(6.0, 4.0), spec, start);
        for kind in [BugKind::DistBug, BugKind::Bug1, BugKind::TangentBug] {
            let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed)).unwrap();
            let mut bug = kind.with(start.to_local(goal), BugParameters::default()).unwrap();
            let mut robot = simulation.robot(0).unwrap();
            let outcome = control::run(&mut robot, bug.as_mut(), 600.0, |_, _, _| {}).unwrap();
            let off = simulation.truth().robot(0).unwrap().pose.distance_to(goal);
            let right = outcome == BugOutcome::Reached && off <= MISSED[1];
            assert!(right, "{kind}, {beams} beams, seed {seed}: {outcome:?}, {off:.3} m off");
        }
    }
}

mod campaigns {
    use super::*;

    #[test]
    #[ignore = "takes minutes: cargo test --release --all-features --test bug_goals -- --ignored"]
    fn ten_thousand_goals_beside_walls() {
        let (wrong, runs) = wrong(1000, 0, 2);
        assert!(wrong.is_empty(), "{} of {runs}: {wrong:#?}", wrong.len());
    }

    #[test]
    #[ignore = "takes minutes: cargo test --release --all-features --test bug_goals -- --ignored"]
    fn goals_beside_walls_on_a_map() {
        for noise in [0.0, 1.0] {
            let (wrong, runs) = wrong_on_a_map(1000, noise, 4);
            assert!(wrong.is_empty() && runs > 900, "{} of {runs}: {wrong:#?}", wrong.len());
        }
    }

    /// With noise some verdicts may be wrong, but none that says that the goal is reached.
    #[test]
    #[ignore = "takes minutes: cargo test --release --all-features --test bug_goals -- --ignored"]
    fn goals_beside_walls_with_noise() {
        let (wrong, runs) = wrong(300, 1, 3);
        let beyond = wrong.iter().filter(|words| words.contains("Reached")).count();
        assert!(beyond == 0 && 100 * wrong.len() < runs, "{} of {runs}: {wrong:#?}", wrong.len());
    }
}
