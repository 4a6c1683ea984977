//! Scenes, and the referee before cars whose behaviour is known.

use super::*;
use crate::world::RobotSpec;
use crate::world::formats::course;
use crate::world::road::{RoadCourse, RoadCourseOptions, generate};

/// An oval with marks on its first straight, which is 20 m long.
fn oval(marks: &str) -> RoadCourse {
    let rest = "arc 1500 180\nstraight 20000\narc 1500 180\n";
    course::parse(&format!("course 1\nlane 400\n{marks}{rest}"), "oval").unwrap()
}

fn scene(marks: &str, boxes: &[(f64, f64, BoxMotion)]) -> TrafficScene {
    let boxes = boxes.iter().map(|&(along, left, motion)| RoadBox { along, left, size: [0.2; 3], motion });
    TrafficScene { course: oval(marks), boxes: boxes.collect() }
}

/// What a car does at a place of its origin: its distance to the left of the lane's centre (m), its speed
/// (m/s), and for how long it stands there (s).
struct Plan<'p> {
    left: &'p dyn Fn(f64) -> f64,
    halt: Option<(f64, f64)>,
    speed: f64,
}

/// Drives along the first straight. Returns the score.
fn drive(scene: &TrafficScene, plan: &Plan<'_>) -> EvasionScore {
    let mut referee = ObstacleEvasion::new(scene.clone(), &RobotSpec::road_car(), 1);
    let mut actors = TrafficActors::new(scene.clone());
    let (mut along, mut stood) = (0.0, 0.0);
    for step in 0..6000 {
        let time = 0.02 * f64::from(step);
        let stands = plan.halt.is_some_and(|(at, long)| along >= at && stood < long);
        let speed = if stands { 0.0 } else { plan.speed };
        stood += if stands { 0.02 } else { 0.0 };
        along += 0.02 * speed;
        actors.advance(time, CarFront { along: referee.front(), speed });
        let is_over = referee.see(time, &scene.course.pose(along, (plan.left)(along)), speed, &actors);
        if is_over || along > 19.0 {
            break;
        }
    }
    referee.score().clone()
}

/// Row of an element: seen, right, neutral, negative.
fn row(score: &EvasionScore, element: EvasionElement) -> [u32; 4] {
    let index = EvasionElement::ALL.iter().position(|it| *it == element).unwrap();
    let EvasionRow { seen, right, neutral, negative } = score.rows[index];
    [seen, right, neutral, negative]
}

const RIGHT: [u32; 4] = [1, 1, 0, 0];
const NEUTRAL: [u32; 4] = [1, 0, 1, 0];
const NEGATIVE: [u32; 4] = [1, 0, 0, 1];

/// In the other lane between two places (m).
fn beside(from: f64, to: f64) -> impl Fn(f64) -> f64 {
    move |along| if (from..to).contains(&along) { 0.42 } else { 0.0 }
}

#[test]
fn lines_ask_for_their_halts() {
    // The car's front is 350 mm ahead of its origin; the line is 38 mm wide and ends at 8 m.
    for (mark, element, halt, expected) in [
        ("stop-line", EvasionElement::StopLine, Some((7.55, 3.1)), RIGHT),
        ("stop-line", EvasionElement::StopLine, Some((7.55, 2.0)), NEUTRAL),
        ("stop-line", EvasionElement::StopLine, Some((7.2, 3.1)), NEGATIVE),
        ("stop-line", EvasionElement::StopLine, None, NEGATIVE),
        ("give-way-line", EvasionElement::GiveWayLine, Some((7.55, 1.1)), RIGHT),
        ("give-way-line", EvasionElement::GiveWayLine, None, NEUTRAL),
        ("zebra", EvasionElement::EmptyCrosswalk, None, RIGHT),
        ("zebra", EvasionElement::EmptyCrosswalk, Some((7.4, 1.0)), NEUTRAL),
    ] {
        let scene = scene(&format!("straight 8000\n{mark}\nstraight 12000\n"), &[]);
        let score = drive(&scene, &Plan { left: &|_| 0.0, halt, speed: 1.0 });
        assert_eq!(row(&score, element), expected, "{mark} {halt:?}: {score:?}");
        assert_eq!((score.departures, score.collisions), (0, 0));
    }
}

#[test]
fn turns_ask_for_the_halt_and_for_the_other_part_of_the_road() {
    let eight = "course 1\nlane 400\nstraight 1900\narrow right\nstraight 1100\ncrossing 90 none give-way\n\
        straight 3000\narc 3000 270\nstraight 3000\ncrossing 90 none\nstraight 3000\narc 3000 -270\n";
    let scene = TrafficScene { course: course::parse(eight, "eight").unwrap(), boxes: Vec::new() };
    let turn = RoadTurn::of(&scene.course)[0];
    for (halt, turns, expected) in [(1.1, true, RIGHT), (0.5, true, NEUTRAL), (1.1, false, NEUTRAL)] {
        let mut referee = ObstacleEvasion::new(scene.clone(), &RobotSpec::road_car(), 1);
        let actors = TrafficActors::new(scene.clone());
        let (mut along, mut stood) = (0.0, 0.0);
        for step in 0..600 {
            let stands = along >= 2.1 && stood < halt;
            let speed = if stands { 0.0 } else { 1.0 };
            stood += if stands { 0.02 } else { 0.0 };
            along += 0.02 * speed;
            // A sharp corner from lane to lane.
            let on = if turns && along > 2.8 { along + turn.skipped() } else { along };
            referee.see(0.02 * f64::from(step), &scene.course.pose(on, 0.0), speed, &actors);
        }
        assert_eq!(row(referee.score(), EvasionElement::Turn), expected, "{halt} {turns}");
        assert_eq!((referee.score().departures, referee.possible()), (0, 15.0));
    }
}

#[test]
fn pedestrians_and_crossing_traffic_go_first() {
    let person = (8.15, -0.32, BoxMotion::Across);
    for (halt, expected) in [((7.55, 6.0), RIGHT), ((7.55, 2.0), NEUTRAL), ((7.1, 6.0), NEUTRAL)] {
        let scene = scene("straight 8000\nzebra\nstraight 12000\n", &[person]);
        let score = drive(&scene, &Plan { left: &|_| 0.0, halt: Some(halt), speed: 0.5 });
        assert_eq!(row(&score, EvasionElement::Crosswalk), expected, "{halt:?}: {score:?}");
    }
    let traffic = (8.0, -1.0, BoxMotion::Crossing(std::f64::consts::FRAC_PI_2));
    let marks = "straight 8000\ncrossing 90 both 1000 give-way\nstraight 12000\n";
    for (halt, expected) in [((7.1, 5.0), RIGHT), ((7.1, 1.5), NEUTRAL)] {
        let score = drive(&scene(marks, &[traffic]), &Plan { left: &|_| 0.0, halt: Some(halt), speed: 0.5 });
        assert_eq!(row(&score, EvasionElement::CrossTraffic), expected, "{halt:?}: {score:?}");
        assert_eq!(row(&score, EvasionElement::GiveWayLine), RIGHT, "{halt:?}");
    }
}

#[test]
fn obstacles_are_passed_touched_or_followed() {
    let free = "straight 20000\n";
    let still = (8.0, 0.0, BoxMotion::Static);
    for (left, expected) in
        [(beside(7.0, 9.0), RIGHT), (beside(7.0, 11.0), NEUTRAL), (beside(0.0, 0.0), NEGATIVE)]
    {
        let score = drive(&scene(free, &[still]), &Plan { left: &left, halt: None, speed: 1.0 });
        assert_eq!(row(&score, EvasionElement::StaticObstacle), expected, "{score:?}");
        assert_eq!((score.collisions, score.departures), (expected[3], 0), "{score:?}");
    }
    let slow = (8.0, 0.0, BoxMotion::Along(5.0));
    for (speed, expected) in [(1.4, RIGHT), (0.6, NEUTRAL)] {
        let left: &dyn Fn(f64) -> f64 = if speed > 1.0 { &beside(7.0, 10.5) } else { &|_| 0.0 };
        let score = drive(&scene(free, &[slow]), &Plan { left, halt: None, speed });
        assert_eq!(row(&score, EvasionElement::DynamicObstacle), expected, "{score:?}");
    }
    let zone = "straight 7000\ncentre double\nstraight 4000\ncentre dashed\nstraight 9000\n";
    let leader = (8.0, 0.0, BoxMotion::Along(2.5));
    for (left, expected) in [(beside(0.0, 0.0), RIGHT), (beside(7.2, 10.5), NEGATIVE)] {
        let score = drive(&scene(zone, &[leader]), &Plan { left: &left, halt: None, speed: 0.6 });
        assert_eq!(row(&score, EvasionElement::NoPassing), expected, "{score:?}");
    }
}

#[test]
fn oncoming_boxes_go_first_where_the_own_lane_is_blocked() {
    let boxes = [(8.0, 0.0, BoxMotion::Static), (10.0, 0.42, BoxMotion::Oncoming(5.0))];
    let near = |along: f64| if along < 7.2 { 0.5 * beside(6.5, 7.2)(along) } else { beside(7.2, 9.0)(along) };
    for (left, halt, expected) in [
        (&beside(7.0, 9.0) as &dyn Fn(f64) -> f64, Some((6.9, 6.0)), RIGHT),
        (&near, Some((7.0, 6.0)), NEUTRAL),
        (&beside(7.0, 9.0), None, NEGATIVE),
    ] {
        let score = drive(&scene("straight 20000\n", &boxes), &Plan { left, halt, speed: 1.0 });
        assert_eq!(row(&score, EvasionElement::OncomingObstacle), expected, "{score:?}");
        assert_eq!(score.collisions, expected[3], "{score:?}");
    }
    // Nothing is in the own lane.
    let score =
        drive(&scene("straight 20000\n", &[boxes[1]]), &Plan { left: &|_| 0.0, halt: None, speed: 1.0 });
    assert_eq!(row(&score, EvasionElement::OncomingObstacle), RIGHT, "{score:?}");
}

#[test]
fn barred_areas_are_not_entered() {
    let marks = "straight 8000\nbarred right 1200 200\nstraight 12000\n";
    for (aside, expected) in [(0.15, RIGHT), (0.02, NEUTRAL)] {
        let left = |along: f64| if (7.0..9.5).contains(&along) { aside } else { 0.0 };
        let score = drive(&scene(marks, &[]), &Plan { left: &left, halt: None, speed: 1.0 });
        assert_eq!(row(&score, EvasionElement::BarredArea), expected, "{score:?}");
    }
}

#[test]
fn cars_that_leave_their_lane_or_stand_lose_points() {
    let empty = scene("straight 20000\n", &[]);
    let score = drive(&empty, &Plan { left: &beside(3.0, 4.0), halt: None, speed: 1.0 });
    assert_eq!((score.departures, score.points()), (1, -2.0));
    let score = drive(&empty, &Plan { left: &|_| 0.0, halt: Some((3.0, 20.0)), speed: 1.0 });
    assert!(score.is_taken_over && score.points() == -5.0, "{score:?}");
}

#[test]
fn speed_zones_begin_and_end_at_their_numbers() {
    let zone = scene("straight 6000\nspeed 30\nstraight 4000\nspeed-end 30\nstraight 10000\n", &[]);
    let [(from, to, limit)] = zone.speed_zones()[..] else { panic!("{:?}", zone.speed_zones()) };
    assert_eq!((from, to), (6.0, 9.95));
    assert!((limit - 0.833).abs() < 1e-3, "30 are 0.83 m/s");
    for (speed, expected) in [(0.8, 0), (1.0, 1)] {
        let score = drive(&zone, &Plan { left: &|_| 0.0, halt: None, speed });
        assert_eq!((score.speedings, score.points()), (expected, -5.0 * f64::from(expected)), "{score:?}");
    }
    let open = scene("straight 16000\nspeed 20\nstraight 4000\n", &[]);
    let [(from, to, _)] = open.speed_zones()[..] else { panic!("{:?}", open.speed_zones()) };
    assert!((to - from - open.course.line.length()).abs() < 1e-9, "it goes on for a lap");
    let lone = scene("straight 16000\nspeed-end 20\nstraight 4000\n", &[]);
    assert!(lone.speed_zones().is_empty());
}

#[test]
fn drawn_scenes_follow_the_rules() {
    let options = RoadCourseOptions { crossings: 0.9, zebras: 0.8, ..RoadCourseOptions::default() };
    let (mut seen, mut turns) = ([0; 5], 0);
    for seed in 0..200 {
        let course = generate(seed, &options).unwrap();
        let scene = TrafficScene::drawn(course, seed);
        scene.course.check().unwrap();
        let zones = scene.no_passing_zones();
        for item in &scene.boxes {
            let kind = match item.motion {
                BoxMotion::Static => 0,
                BoxMotion::Along(_) => 1,
                BoxMotion::Across => 2,
                BoxMotion::Crossing(_) => 3,
                BoxMotion::Oncoming(_) => 4,
            };
            seen[kind] += 1;
            let is_in_zone = zones.iter().any(|(from, to)| (*from..*to).contains(&item.along));
            assert!(kind != 0 || !is_in_zone, "{seed}: {item:?}");
        }
        let on_road =
            scene.boxes.iter().filter(|it| matches!(it.motion, BoxMotion::Static | BoxMotion::Along(_)));
        let places: Vec<f64> = on_road.map(|it| it.along).collect();
        assert!(places.windows(2).all(|pair| pair[1] - pair[0] > 1.4), "{seed}: {places:?}");
        turns += RoadTurn::of(&scene.course).len();
        assert_eq!(scene, TrafficScene::drawn(generate(seed, &options).unwrap(), seed), "{seed}");
    }
    assert!(seen.iter().all(|count| *count > 4) && turns > 2, "{seen:?} {turns}");
}

#[test]
fn boxes_that_actors_lack_are_nowhere() {
    let full = scene("straight 20000\n", &[(3.0, 0.0, BoxMotion::Static)]);
    let actors = TrafficActors::new(scene("straight 20000\n", &[]));
    assert_eq!((actors.pose(0), actors.along(usize::MAX), actors.is_clear(0)), (None, None, false));
    let mut referee = ObstacleEvasion::new(full.clone(), &RobotSpec::road_car(), 1);
    referee.see(0.1, &full.course.pose(3.1, 0.0), 1.0, &actors);
    assert_eq!(referee.score().collisions, 0);
}

#[test]
fn a_road_of_no_end_gets_no_boxes_on_it() {
    let mut course = oval("straight 20000\n").scaled(1e9);
    course.marks.clear();
    assert!(course.line.stations().is_empty() && TrafficScene::drawn(course, 1).boxes.is_empty());
}
