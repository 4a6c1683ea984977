use std::sync::Arc;

use crate::drive::outline::Outline;
use crate::geometry::{Point, Pose};
use crate::io::Psd;
use crate::random::Stream;
use crate::world::road::{
    Alignment, Appearance, CourseError, Element, RoadCourse, RoadMark, RoadMarkKind, RoadSide,
};
use crate::world::{
    Colour, DriveSpec, Footprint, Mount, Object, ObjectKind, PsdSpec, RobotSpec, Scene, Shape,
};

/// Kind of a parking area.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ParkingKind {
    /// One long area along the road, on the right.
    Parallel,
    /// Spots across the road, on the left.
    Perpendicular,
}

/// A straight road with a parking area whose spots are blocked by boxes, except for one.
///
/// ```
/// use roverlab::drive::parking::{ParkingKind, ParkingLot};
/// let lot = ParkingLot::drawn(ParkingKind::Parallel, 3)?;
/// assert!(lot.spot.1 - lot.spot.0 > 0.6, "1.4 lengths of the car");
/// # Ok::<(), roverlab::world::road::CourseError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ParkingLot {
    /// Its kind.
    pub kind: ParkingKind,
    /// The road with its markings.
    pub course: RoadCourse,
    /// Where the free spot begins and ends along the road's line (m).
    pub spot: (f64, f64),
    /// The boxes: pose of the middle, length along it and width (m).
    pub boxes: Vec<(Pose, f64, f64)>,
}

/// Length of the road car (m).
const CAR: f64 = 0.43;
/// Least length of a gap (lengths of the car).
const GAP: f64 = 1.4;
/// Depths of parallel and of perpendicular spots, by the rules (m).
pub(super) const DEPTHS: [f64; 2] = [0.30, 0.50];
/// Width of a perpendicular spot, by the rules (m).
pub(super) const SPOT: f64 = 0.35;
/// Number of perpendicular spots.
const SPOTS: usize = 5;
/// Most room beside a box in a blocked spot (m): by the rules, no vehicle fits there.
const BLOCKED: f64 = 0.16;
/// Height of boxes (m): 100 to 240 mm by the rules.
const HEIGHT: f64 = 0.15;

impl ParkingLot {
    /// An area by the rules, drawn at random. Parallel gaps are 1.4 to 2.1 times as long as the car, behind
    /// one that is too short.
    ///
    /// # Errors
    ///
    /// If the road is no course, which none of these is.
    pub fn drawn(kind: ParkingKind, seed: u64) -> Result<Self, CourseError> {
        let mut random = Stream::new(seed).child("parking", 0);
        let mut course = RoadCourse::new(oval())?;
        course.lane_width = random.between(0.35, 0.45);
        let at = random.between(2.5, 3.0);
        let mut lot = Self { kind, course, spot: (0.0, 0.0), boxes: Vec::new() };
        let long = match kind {
            ParkingKind::Parallel => lot.parallel(at, &mut random),
            ParkingKind::Perpendicular => lot.perpendicular(at, &mut random),
        };
        let side = if kind == ParkingKind::Parallel { RoadSide::Right } else { RoadSide::Left };
        lot.course.marks.push(RoadMark { at, kind: RoadMarkKind::Parking(side, long) });
        lot.course.check().map(|()| lot)
    }

    /// Puts boxes on an area on the right. Returns its length (m).
    fn parallel(&mut self, at: f64, random: &mut Stream) -> f64 {
        let mut along = at + 0.05;
        for gap in [random.between(0.15, 0.35), CAR * random.between(GAP, 1.5 * GAP), 0.05] {
            let (length, aside) = (random.between(0.1, 0.4), random.between(0.02, 0.20));
            let width = random.between(0.1, (DEPTHS[0] - aside).max(0.1));
            let out = self.course.edge() + 0.5 * self.course.line_width + aside + 0.5 * width;
            self.boxes.push((self.beside(along + 0.5 * length, -out), length, width));
            along += length;
            if gap > CAR {
                self.spot = (along, along + gap);
            }
            along += gap;
        }
        along - at
    }

    /// Puts boxes on an area on the left. Returns its length (m).
    fn perpendicular(&mut self, at: f64, random: &mut Stream) -> f64 {
        let free = 1 + random.below(SPOTS - 2);
        for spot in 0..SPOTS {
            let from = at + SPOT * spot as f64;
            if spot == free {
                self.spot = (from, from + SPOT);
                continue;
            }
            let (length, width) = (random.between(0.1, 0.28), random.between(0.1, 0.4));
            let (least, most) =
                (f64::max(0.02, SPOT - BLOCKED - length), f64::min(BLOCKED, SPOT - 0.02 - length));
            let along = from + random.between(least, most);
            let aside = random.between(0.02, 0.10);
            let out = self.course.edge() + 0.5 * self.course.line_width + aside + 0.5 * width;
            self.boxes.push((self.beside(along + 0.5 * length, out), length, width));
        }
        // A little more, so that rounding loses no spot.
        SPOT * SPOTS as f64 + 1e-6
    }

    fn beside(&self, along: f64, left: f64) -> Pose {
        let pose = self.course.line.at(along).pose;
        let place = pose.to_world(Point::new(0.0, left));
        Pose::new(place.x, place.y, pose.heading)
    }

    /// The scene of a simulation: the road with its boxes, and a car with [distance sensors](parking_car) at
    /// its start. Fails if the road cannot be drawn.
    pub fn scene(&self, appearance: &Appearance) -> Result<Scene, CourseError> {
        let mut world = self.course.world(appearance)?;
        for &(pose, length, width) in &self.boxes {
            let shape = Shape::Box { length, width, height: HEIGHT };
            let kind = ObjectKind { fixed: true, ..ObjectKind::new("box", shape, Colour::WHITE) };
            world.objects.push(Object::new(Arc::new(kind), pose));
        }
        Ok(Scene::with_robot(world, parking_car(), self.course.start()))
    }

    /// Whether all wheels of a car at a pose are inside the free spot.
    pub fn is_parked(&self, car: &RobotSpec, pose: &Pose) -> bool {
        let DriveSpec::Ackermann { wheelbase, track, .. } = car.drive else { return false };
        let inner = self.course.edge() + 0.5 * self.course.line_width;
        let depth = DEPTHS[usize::from(self.kind == ParkingKind::Perpendicular)];
        let side = if self.kind == ParkingKind::Parallel { -1.0 } else { 1.0 };
        [(0.0, 0.5), (0.0, -0.5), (wheelbase, 0.5), (wheelbase, -0.5)].into_iter().all(|(x, half)| {
            let wheel = pose.to_world(Point::new(x, half * track));
            let (along, left) = self.course.line.locate(wheel, None);
            (self.spot.0..=self.spot.1).contains(&along) && (inner..=inner + depth).contains(&(side * left))
        })
    }

    /// Whether a car at a pose touches a box.
    pub fn is_touched(&self, car: &RobotSpec, pose: &Pose) -> bool {
        let Footprint::Rectangle(body) = car.footprint else { return false };
        let own = Outline::new(pose, (body.min.x, body.max.x), 0.5 * body.size().y);
        self.boxes.iter().any(|&(pose, length, width)| {
            own.touches(&Outline::new(&pose, (-0.5 * length, 0.5 * length), 0.5 * width))
        })
    }
}

/// [`RobotSpec::road_car`] with a distance sensor on each side, 80 mm above the ground.
///
/// ```
/// use roverlab::drive::parking::parking_car;
/// assert!(parking_car().psds.len() >= 2);
/// ```
pub fn parking_car() -> RobotSpec {
    let sensor = |id: u8, name: &str, side: f64| PsdSpec {
        id,
        name: name.into(),
        mount: Mount {
            x: SENSOR.0,
            y: side * SENSOR.1,
            z: 0.08,
            yaw: side * std::f64::consts::FRAC_PI_2,
            ..Mount::default()
        },
        max_range: 1.5,
    };
    let psds = vec![sensor(Psd::LEFT.0, "left", 1.0), sensor(Psd::RIGHT.0, "right", -1.0)];
    RobotSpec { name: "ParkingCar".into(), psds, ..RobotSpec::road_car() }
}

/// Distances of the sensors ahead of the rear axle and to the sides (m).
pub(super) const SENSOR: (f64, f64) = (0.135, 0.095);

fn oval() -> Alignment {
    let (straight, arc) = (Element::straight(8.0), Element::arc(1.6, std::f64::consts::PI));
    Alignment::new(Pose::default(), vec![straight, arc, straight, arc])
}
