use super::scene::{BoxMotion, CLEAR, PERSON, RoadBox, TrafficScene, WAITS, ZEBRA};
use crate::geometry::Pose;
use crate::world::road::RoadCourse;

/// Speed of moving boxes, by the rules (m/s).
const SPEED: f64 = 0.6;
/// Speed of pedestrians, which the rules leave open (m/s).
const WALK: f64 = 0.3;
/// Time from a car's halt to the first movement of those who wait for it (s).
const HESITATION: f64 = 0.5;
/// Distance of a car's front behind a box at which that begins to drive (m).
const NOTICE: f64 = 1.0;
/// Distance of a car's front before an oncoming box at which that begins to drive (m): the car sees it move
/// before it is so near to an obstacle that it would pass.
pub(super) const MEETS: f64 = 3.4;
/// Speed below which a car stands (m/s).
pub(super) const STANDS: f64 = 0.02;
/// Longest distance between a car that stands and the crosswalk or crossing for which it does (m).
const BEFORE: f64 = 0.5;
/// Distance ahead of a car at which boxes are put back for the next lap (m).
const FAR: f64 = 3.0;

/// What moves in a [`TrafficScene`], by the clock and by where a car is.
///
/// ```
/// use roverlab::drive::traffic::{BoxMotion, CarFront, RoadBox, TrafficActors, TrafficScene};
/// use roverlab::world::formats::course;
/// let oval = course::parse("course 1\nstraight 6000\narc 1500 180\nstraight 6000\narc 1500 180\n", "oval")?;
/// let slow = RoadBox { along: 3.0, left: 0.0, size: [0.2; 3], motion: BoxMotion::Along(2.0) };
/// let mut actors = TrafficActors::new(TrafficScene { course: oval, boxes: vec![slow] });
/// assert!(actors.advance(1.0, CarFront { along: 1.0, speed: 0.5 }).is_empty(), "the car is far away");
/// assert_eq!(actors.advance(2.0, CarFront { along: 2.5, speed: 0.5 }).len(), 1);
/// assert_eq!(actors.along(0), Some(3.6));
/// # Ok::<(), roverlab::world::formats::FormatError>(())
/// ```
#[derive(Debug, Clone)]
pub struct TrafficActors {
    scene: TrafficScene,
    actors: Vec<Actor>,
    time: f64,
}

/// State of a box.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Actor {
    /// As in [`RoadBox`], now (m).
    along: f64,
    left: f64,
    phase: Phase,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// At its first place; since when a car stands before it (s).
    Rests(Option<f64>),
    /// In a direction: 1 to the left or ahead, -1 to the right or back.
    Moves(f64),
    /// Off the road, or on the other side of it.
    Done,
}

/// Position and speed of a car's front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarFront {
    /// Position along the line (m).
    pub along: f64,
    /// Speed (m/s).
    pub speed: f64,
}

impl TrafficActors {
    /// The actors of a scene at their first places.
    pub fn new(scene: TrafficScene) -> Self {
        let actors = scene.boxes.iter().map(Actor::new).collect();
        Self { scene, actors, time: 0.0 }
    }

    /// Advances to a time (s) with a car on the course. Returns the boxes that have moved, with their poses.
    pub fn advance(&mut self, time: f64, car: CarFront) -> Vec<(usize, Pose)> {
        let seconds = time - self.time;
        self.time = time;
        let mut moved = Vec::new();
        for index in 0..self.actors.len() {
            let (item, before) = (&self.scene.boxes[index], self.actors[index]);
            let ahead = between(&self.scene.course, car.along, before.along);
            let step = Step { course: &self.scene.course, item, ahead, speed: car.speed, time, seconds };
            self.actors[index].advance(&step);
            let now = self.actors[index];
            if (before.along, before.left) != (now.along, now.left)
                || before.is_gone(item) != now.is_gone(item)
            {
                moved.extend(self.pose(index).map(|pose| (index, pose)));
            }
        }
        moved
    }

    /// Pose of a box; beyond the floor's corner while it is off the road. `None` if there is no such box.
    pub fn pose(&self, index: usize) -> Option<Pose> {
        let (item, actor) = self.find(index)?;
        if actor.is_gone(item) {
            let corner = self.scene.course.floor().min;
            return Some(Pose::new(corner.x - 5.0, corner.y - 5.0, 0.0));
        }
        Some(item.pose_at(&self.scene.course, actor.along, actor.left))
    }

    /// Position of a box's near side along the line (m); `None` while it is off the road, and if there is no
    /// such box.
    pub fn along(&self, index: usize) -> Option<f64> {
        let (item, actor) = self.find(index)?;
        (!actor.is_gone(item)).then_some(actor.along)
    }

    /// Whether a pedestrian is off the road, or crossing traffic has crossed it; `false` of all other boxes,
    /// and if there is no such box.
    pub fn is_clear(&self, index: usize) -> bool {
        let Some((item, actor)) = self.find(index) else { return false };
        let course = &self.scene.course;
        match item.motion {
            BoxMotion::Across => (actor.left + course.lane_middle()).abs() > course.edge() + 0.5 * PERSON[1],
            BoxMotion::Crossing(_) => actor.left - 0.5 * item.size[0] > course.edge(),
            BoxMotion::Static | BoxMotion::Along(_) | BoxMotion::Oncoming(_) => false,
        }
    }

    /// A box and its state.
    fn find(&self, index: usize) -> Option<(&RoadBox, &Actor)> {
        self.scene.boxes.get(index).zip(self.actors.get(index))
    }

    /// The scene.
    pub fn scene(&self) -> &TrafficScene {
        &self.scene
    }
}

/// What an actor reacts to.
struct Step<'s> {
    course: &'s RoadCourse,
    item: &'s RoadBox,
    /// Distance of the box ahead of the car's front (m), and the car's speed (m/s).
    ahead: f64,
    speed: f64,
    time: f64,
    seconds: f64,
}

impl Actor {
    fn new(item: &RoadBox) -> Self {
        Self { along: item.along, left: item.left, phase: Phase::Rests(None) }
    }

    /// Whether it has driven off the road.
    fn is_gone(&self, item: &RoadBox) -> bool {
        self.phase == Phase::Done && matches!(item.motion, BoxMotion::Along(_) | BoxMotion::Oncoming(_))
    }

    fn advance(&mut self, step: &Step) {
        let edge = step.course.edge();
        match step.item.motion {
            BoxMotion::Static => {}
            BoxMotion::Along(far) => self.drive(step, (NOTICE, 1.0), far),
            BoxMotion::Oncoming(far) => self.drive(step, (MEETS, -1.0), far),
            BoxMotion::Across => {
                let middle = step.course.lane_middle();
                let across = -(self.left + middle).signum();
                self.cross(step, (BEFORE + ZEBRA, across), |way| way * (edge + WAITS) - middle, WALK);
            }
            BoxMotion::Crossing(_) => {
                let end = edge + CLEAR + 0.5 * step.item.size[0];
                self.cross(step, (BEFORE + 1.5 * edge, 1.0), |_| end, SPEED);
            }
        }
    }

    /// Along its lane in a direction, from when a car is within a distance (m), until it leaves the road.
    fn drive(&mut self, step: &Step, (reach, way): (f64, f64), far: f64) {
        match self.phase {
            Phase::Rests(_) if (0.0..reach).contains(&step.ahead) => self.phase = Phase::Moves(way),
            Phase::Done if step.ahead.abs() > 2.0 * FAR => *self = Self::new(step.item),
            _ => {}
        }
        if let Phase::Moves(way) = self.phase {
            self.along += way * SPEED * step.seconds;
            if way * (self.along - step.item.along) > far {
                self.phase = Phase::Done;
            }
        }
    }

    /// Across the road, for a car that stands within a distance before it (m), to an end by the direction.
    fn cross(&mut self, step: &Step, (reach, way): (f64, f64), end: impl Fn(f64) -> f64, pace: f64) {
        match self.phase {
            Phase::Rests(since) => {
                let stands = step.speed.abs() < STANDS && (0.0..reach).contains(&step.ahead);
                let since = stands.then(|| since.unwrap_or(step.time));
                let is_off = since.is_some_and(|since| step.time - since > HESITATION);
                self.phase = if is_off { Phase::Moves(way) } else { Phase::Rests(since) };
            }
            Phase::Moves(way) => {
                let left = way * (end(way) - self.left);
                self.left += way * left.min(pace * step.seconds);
                if left <= pace * step.seconds {
                    self.phase = Phase::Done;
                }
            }
            // A pedestrian waits for the next car where it is; crossing traffic comes from the right again.
            Phase::Done if step.ahead.abs() > FAR => {
                self.phase = Phase::Rests(None);
                if matches!(step.item.motion, BoxMotion::Crossing(_)) {
                    self.left = step.item.left;
                }
            }
            Phase::Done => {}
        }
    }
}

/// Distance between two positions along a closed road, the shorter way (m).
pub(super) fn between(course: &RoadCourse, from: f64, to: f64) -> f64 {
    let around = course.line.length();
    let way = to - from;
    way - around * (way / around).round()
}
