//! What is found on roads by camera beside what is true: a truth table per kind of element.

use std::ops::Range;
use std::sync::Arc;

use image::RgbImage;
use roverlab::drive::lane_keeping::{LaneKeeper, LaneKeeperParameters};
use roverlab::geometry::{Pose, Twist, math};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Camera, Clock, Resolution};
use roverlab::random::Stream;
use roverlab::vision::lane_markings::{RoadCamera, RoadModel};
use roverlab::vision::road_elements::{RoadElement, RoadElementFinder, RoadElementKind};
use roverlab::vision::{GrayView, GrayViewMut, GrayWeights, RgbView, gray_into};
use roverlab::world::formats::course;
use roverlab::world::road::{
    Appearance, Crossing, RightOfWay, RoadCourse, RoadCourseOptions, RoadMark, RoadMarkKind, RoadSide,
    generate,
};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, Shape};

/// Kinds that are counted, each with the distances ahead of the camera where it has to be found, and the
/// distance within which it has to be there (m).
const KINDS: [(&str, (f64, f64), f64); 11] = [
    ("stop line", (0.25, 0.95), 0.08),
    ("give-way line", (0.25, 0.95), 0.08),
    ("start line", (0.25, 0.95), 0.08),
    ("zebra", (0.25, 0.95), 0.10),
    ("crossing", (0.20, 1.00), 0.25),
    ("obstacle", (0.30, 0.95), 0.10),
    ("parking", (0.20, 0.70), 0.15),
    ("barred area", (0.30, 0.80), 0.15),
    ("speed limit", (0.20, 0.70), 0.05),
    ("end of a limit", (0.15, 0.65), 0.05),
    ("turn arrow", (0.20, 0.70), 0.05),
];

/// Row of a kind in the table.
fn row(kind: RoadElementKind) -> usize {
    match kind {
        RoadElementKind::StopLine => 0,
        RoadElementKind::GiveWayLine => 1,
        RoadElementKind::StartLine => 2,
        RoadElementKind::Zebra => 3,
        RoadElementKind::Crossing { .. } => 4,
        RoadElementKind::Obstacle { .. } => 5,
        RoadElementKind::Parking { .. } => 6,
        RoadElementKind::Barred { .. } => 7,
        RoadElementKind::SpeedLimit(_) => 8,
        RoadElementKind::SpeedLimitEnd => 9,
        RoadElementKind::TurnArrow { .. } => 10,
        other => panic!("a kind without a row: {other:?}"),
    }
}

/// Whether one is what the other is: numbers and sides of arrows have to be the same.
fn is_same(one: RoadElementKind, other: RoadElementKind) -> bool {
    use RoadElementKind::{SpeedLimit, TurnArrow};
    row(one) == row(other) && (!matches!(one, SpeedLimit(_) | TurnArrow { .. }) || one == other)
}

/// A box on the road: where its near side is, to the left of the own lane's middle (m), and its size.
#[derive(Debug, Clone, Copy)]
struct Block {
    along: f64,
    left: f64,
    size: [f64; 3],
}

/// A course with boxes and what is on it.
struct Setting {
    course: RoadCourse,
    blocks: Vec<Block>,
    /// What is where along the line (m).
    truths: Vec<(RoadElementKind, f64)>,
    camera: RoadCamera,
}

impl Setting {
    fn drawn(seed: u64) -> Self {
        let options =
            RoadCourseOptions { crossings: 0.9, zebras: 0.8, parking: 0.6, ..RoadCourseOptions::default() };
        let mut course = generate(seed, &options).unwrap();
        let mut truths = truths(&course);
        let blocks = blocks(&course, &truths, &mut Stream::new(seed).child("blocks", 0));
        truths.extend(blocks.iter().map(|block| (OBSTACLE, block.along)));
        add_numbers(&mut course, &mut truths, seed);
        Self { blocks, truths, ..Self::of(course) }
    }

    /// A course as it is.
    fn of(course: RoadCourse) -> Self {
        let camera = RobotSpec::road_car().camera.as_ref().unwrap().into();
        Self { truths: truths(&course), blocks: Vec::new(), course, camera }
    }

    /// The car at the start in a light of 50 to 150 %, with worn paint and patches of light.
    fn simulation(&self, seed: u64, pixel: f64) -> Simulation {
        let mut random = Stream::new(seed);
        let look = Appearance { pixel, wear: random.between(0.0, 0.35), glare: random.below(6), seed };
        let mut world = self.course.world(&look).unwrap();
        for block in &self.blocks {
            let [length, width, height] = block.size;
            let shape = Shape::Box { length, width, height };
            let kind = ObjectKind { fixed: true, ..ObjectKind::new("box", shape, Colour::WHITE) };
            let pose = self.course.pose(block.along + 0.5 * length, block.left);
            world.objects.push(Object::new(Arc::new(kind), pose));
        }
        let scene = Scene::with_robot(world, RobotSpec::road_car(), self.course.start());
        let options = SimOptions { light: random.between(0.5, 1.5), ..SimOptions::with_noise(1.0, seed) };
        Simulation::new(&scene, options).unwrap()
    }

    /// Distance to the left of the lane's middle at which the car is carried past boxes in its lane.
    fn aside(&self, along: f64) -> f64 {
        let smooth = |x: f64| {
            let x = x.clamp(0.0, 1.0);
            x * x * (3.0 - 2.0 * x)
        };
        let past = |block: &Block| {
            let (from, to) = (along - block.along + 1.7, along - block.along - block.size[0] - 0.15);
            smooth(from / 1.2) * (1.0 - smooth(to / 1.2))
        };
        let own = self.blocks.iter().filter(|block| block.left < 0.2);
        0.04 * math::sin(1.3 * along) + self.course.edge() * own.map(past).fold(0.0, f64::max)
    }

    /// Whether the camera of a car sees the front of a box at a place along the road; other things are seen.
    fn is_in_view(&self, car: &Pose, kind: RoadElementKind, along: f64) -> bool {
        let front = |block: &Block| {
            [-0.5, 0.5].into_iter().all(|side| {
                let corner = self.course.pose(along, block.left + side * block.size[1]).position();
                let at = self.camera.project(car.to_local(corner), 0.0, (320, 240));
                at.is_some_and(|(x, y)| (2.0..318.0).contains(&x) && y < 238.0)
            })
        };
        kind != OBSTACLE || self.blocks.iter().filter(|block| block.along == along).all(front)
    }

    /// Distance ahead along the road.
    fn ahead(&self, from: f64, to: f64) -> f64 {
        let around = self.course.line.length();
        let way = to - from;
        way - around * (way / around).round()
    }
}

/// A box whose sides do not matter.
const OBSTACLE: RoadElementKind = RoadElementKind::Obstacle { right: 0.0, left: 0.0 };

/// Markings of the table along a course.
fn truths(course: &RoadCourse) -> Vec<(RoadElementKind, f64)> {
    let mut truths = Vec::new();
    for mark in &course.marks {
        match mark.kind {
            RoadMarkKind::Start => truths.push((RoadElementKind::StartLine, mark.at)),
            RoadMarkKind::Zebra => truths.push((RoadElementKind::Zebra, mark.at)),
            RoadMarkKind::Parking(side, _) => {
                truths.push((RoadElementKind::Parking { left: side == RoadSide::Left }, mark.at));
            }
            RoadMarkKind::Barred(RoadSide::Right, ..) => {
                truths.push((RoadElementKind::Barred { right: 0.0, left: 0.0, length: 0.0 }, mark.at));
            }
            RoadMarkKind::Arrow(side) => {
                truths.push((RoadElementKind::TurnArrow { left: side == RoadSide::Left }, mark.at));
            }
            RoadMarkKind::Crossing(crossing) => truths.extend(of_crossing(course, mark.at, &crossing)),
            _ => {}
        }
    }
    truths
}

fn of_crossing(course: &RoadCourse, at: f64, crossing: &Crossing) -> Vec<(RoadElementKind, f64)> {
    let line = at - course.crossing_reach(crossing) - 0.038;
    let line = match crossing.right_of_way {
        RightOfWay::Priority => None,
        RightOfWay::Stop => Some((RoadElementKind::StopLine, line)),
        RightOfWay::GiveWay | RightOfWay::FromTheRight => Some((RoadElementKind::GiveWayLine, line)),
    };
    [Some((RoadElementKind::Crossing { left: false, right: false }, at)), line]
        .into_iter()
        .flatten()
        .collect()
}

/// Boxes in either lane, away from other things.
fn blocks(course: &RoadCourse, truths: &[(RoadElementKind, f64)], random: &mut Stream) -> Vec<Block> {
    let mut blocks: Vec<Block> = Vec::new();
    let mut along = 1.5;
    while along < course.line.length() - 1.5 {
        let size = [random.between(0.1, 0.4), random.between(0.1, 0.35), random.between(0.1, 0.24)];
        // The car is carried around boxes in its lane on straights, and straight on past those in the other.
        let is_straight =
            (-17..=17).all(|step| course.line.at(along + 0.1 * f64::from(step)).curvature == 0.0);
        let other = usize::from(!is_straight || random.chance(0.5));
        let left = [0.0, course.edge()][other] + random.between(-0.03, 0.03);
        let (before, behind) = (along - 1.4, along + 2.6);
        if truths.iter().all(|&(_, other)| other < before || other > behind) {
            blocks.push(Block { along, left, size });
            along += 3.5;
        }
        along += 0.5;
    }
    blocks
}

/// Draws numbers where nothing else is, every second one struck out.
fn add_numbers(course: &mut RoadCourse, truths: &mut Vec<(RoadElementKind, f64)>, seed: u64) {
    let mut random = Stream::new(seed).child("numbers", 0);
    let (mut along, mut is_end) = (1.0, false);
    while along < course.line.length() - 1.0 {
        if truths.iter().all(|(_, other)| !(along - 1.0..along + 0.9).contains(other)) {
            let value = 10 * (1 + random.below(9) as u8);
            course.marks.push(RoadMark { at: along, kind: RoadMarkKind::Speed(value, is_end) });
            // The line that strikes a number out begins before it.
            let truth = if is_end {
                (RoadElementKind::SpeedLimitEnd, along - 0.05)
            } else {
                (RoadElementKind::SpeedLimit(value), along)
            };
            truths.push(truth);
            is_end = !is_end;
        }
        along += 0.3;
    }
}

/// Right, too much, and missed, for each kind.
#[derive(Debug, Default)]
struct Table {
    frames: usize,
    rows: [[usize; 3]; KINDS.len()],
    time: std::time::Duration,
}

impl Table {
    /// Looks at a course of a seed.
    fn look(&mut self, seed: u64, pixel: f64, most: usize) {
        self.look_at(&Setting::drawn(seed), seed, pixel, 0..most);
    }

    /// Carries a car along a course and compares what it finds.
    fn look_at(&mut self, setting: &Setting, seed: u64, pixel: f64, frames: Range<usize>) {
        let simulation = setting.simulation(seed, pixel);
        let (mut car, truth) = (simulation.robot(0).unwrap(), simulation.truth());
        car.set_resolution(Resolution::Qvga).unwrap();
        let camera = setting.camera;
        let mut keeper =
            LaneKeeper::new(camera, RoadModel::default(), LaneKeeperParameters::default()).unwrap();
        let mut finder = RoadElementFinder::new(camera, RoadModel::default()).unwrap();
        let (mut image, mut gray) = (RgbImage::default(), vec![0; 320 * 240]);
        let mut odometry = Pose::default();
        let mut before: Option<Pose> = None;
        let count = ((setting.course.line.length() / 0.07) as usize).min(frames.end);
        for frame in frames.start..count {
            let along = 0.07 * frame as f64;
            let here = setting.course.pose(along, setting.aside(along));
            let next = setting.course.pose(along + 0.02, setting.aside(along + 0.02));
            let way = next.position() - here.position();
            let heading = math::atan2(way.y, way.x);
            truth.move_robot(0, 0, Pose::new(here.x, here.y, heading)).unwrap();
            car.wait(0.04).unwrap();
            car.image_into(&mut image).unwrap();
            let pose = truth.pose(0).unwrap();
            let moved = before.map_or(Pose::default(), |last| last.inverse().compose(&pose));
            odometry = odometry.compose(&moved);
            before = Some(pose);
            let lane = keeper.see(&image, odometry).unwrap().clone();
            let rgb = RgbView::new(image.as_raw(), 320, 240).unwrap();
            gray_into(rgb, GrayViewMut::new(&mut gray, 320, 240).unwrap(), GrayWeights::default()).unwrap();
            let metres = Twist::new(moved.x, 0.0).linear;
            #[expect(clippy::disallowed_methods, reason = "the time of an image is measured")]
            let clock = std::time::Instant::now();
            finder.see(GrayView::new(&gray, 320, 240).unwrap(), &lane, metres, 0.04);
            self.time += clock.elapsed();
            if frame >= frames.start + 4 {
                self.frames += 1;
                let elements: Vec<RoadElement> = finder.elements().collect();
                self.compare(setting, (along, &pose), &elements, seed);
            }
        }
    }

    fn compare(
        &mut self,
        setting: &Setting,
        (along, car): (f64, &Pose),
        elements: &[RoadElement],
        seed: u64,
    ) {
        let camera = setting.camera.ahead;
        for (kind, &(name, (from, to), near)) in KINDS.iter().enumerate() {
            let own = elements.iter().filter(|element| row(element.kind) == kind);
            let seen: Vec<(RoadElementKind, f64)> =
                own.map(|element| (element.kind, element.ahead - camera)).collect();
            let of_kind = setting.truths.iter().filter(|(other, _)| row(*other) == kind);
            let there: Vec<(RoadElementKind, f64, bool)> = of_kind
                .map(|&(kind, at)| {
                    (kind, setting.ahead(along, at) - camera, setting.is_in_view(car, kind, at))
                })
                .collect();
            for (truth, place, _) in
                there.iter().filter(|(_, place, seen)| *seen && (from..to).contains(place))
            {
                let is_found =
                    seen.iter().any(|(other, at)| (place - at).abs() < near && is_same(*truth, *other));
                self.rows[kind][if is_found { 0 } else { 2 }] += 1;
                if !is_found && std::env::var_os("ROAD_TRACE").is_some() {
                    println!("{seed} {along:.2}: no {name} at {place:.2}, but {seen:.2?}");
                }
            }
            for (found, place) in seen.iter().filter(|(_, place)| (from..to).contains(place)) {
                let is_there = |(truth, at, _): &(RoadElementKind, f64, bool)| {
                    (place - at).abs() < near && is_same(*truth, *found)
                };
                if !there.iter().any(is_there) {
                    self.rows[kind][1] += 1;
                    if std::env::var_os("ROAD_TRACE").is_some() {
                        println!("{seed} {along:.2}: {name} at {place:.2}, but {there:.2?}");
                    }
                }
            }
        }
    }

    /// Harmonic mean of precision and recall.
    fn f1(&self, kind: usize) -> f64 {
        let [right, extra, missed] = self.rows[kind].map(|count| count as f64);
        2.0 * right / (2.0 * right + extra + missed).max(1.0)
    }

    fn print(&self) {
        println!("{} frames, {:.2} ms each", self.frames, 1e3 * self.time.as_secs_f64() / self.frames as f64);
        println!("{:14} {:>6} {:>6} {:>6} {:>6}", "element", "right", "extra", "missed", "F1");
        for (kind, (name, ..)) in KINDS.iter().enumerate() {
            let [right, extra, missed] = self.rows[kind];
            println!("{name:14} {right:6} {extra:6} {missed:6} {:6.3}", self.f1(kind));
        }
    }
}

#[test]
fn elements_are_where_they_are_found() {
    let mut table = Table::default();
    (101..=103).for_each(|seed| table.look(seed, 0.004, 400));
    table.print();
    let met = |kind: &usize| table.rows[*kind].iter().sum::<usize>() > 0;
    assert!((0..KINDS.len()).filter(met).count() >= 4, "few elements: {:?}", table.rows);
    for kind in (0..KINDS.len()).filter(met) {
        assert!(table.f1(kind) > 0.9, "{}: {:?}", KINDS[kind].0, table.rows[kind]);
    }
}

#[test]
fn arms_of_crossings_are_found_at_all_legal_angles() {
    let mut table = Table::default();
    for angle in [70, 80, 90, 100, 110] {
        for arm in ["left", "right"] {
            let half = "straight 2000\narc 1500 180\n";
            let text = format!(
                "course 1\nlane 430\nstraight 2200\ncrossing {angle} {arm}\n{half}straight 2200\n{half}"
            );
            let setting = Setting::of(course::parse(&text, "oval").unwrap());
            table.look_at(&setting, angle, 0.002, 5..30);
        }
    }
    table.print();
    assert!(table.rows[4][0] >= 80, "few frames: {:?}", table.rows[4]);
    assert!(table.f1(4) >= 0.98, "{:?}", table.rows[4]);
}

#[test]
fn turn_arrows_are_told_apart_and_from_numbers() {
    let mut table = Table::default();
    let marks = "arrow left\nstraight 1200\narrow right\nstraight 1200\n";
    let arc = "arc 1500 60\narrow right\narc 1500 60\narrow left\narc 1500 60\n";
    let half = format!("straight 1200\n{marks}{arc}");
    let setting = Setting::of(course::parse(&format!("course 1\nlane 400\n{half}{half}"), "oval").unwrap());
    (1..=2).for_each(|seed| table.look_at(&setting, seed, 0.002, 0..usize::MAX));
    // Numbers are none.
    (101..=102).for_each(|seed| table.look(seed, 0.004, 200));
    table.print();
    assert!(table.rows[10][0] >= 80, "few frames: {:?}", table.rows[10]);
    assert!(table.f1(10) > 0.9, "{:?}", table.rows[10]);
}

/// What takes minutes.
mod campaigns {
    use super::*;

    #[test]
    #[ignore = "a campaign: cargo test --release --all-features --test road_elements campaigns -- --ignored --nocapture"]
    fn elements_in_ten_thousand_frames() {
        let mut table = Table::default();
        (101..=135).for_each(|seed| table.look(seed, 0.002, usize::MAX));
        table.print();
        assert!(table.frames >= 10_000, "{}", table.frames);
        for kind in [0, 1, 3, 4] {
            assert!(table.f1(kind) >= 0.98, "{}: {:?}", KINDS[kind].0, table.rows[kind]);
        }
    }
}
