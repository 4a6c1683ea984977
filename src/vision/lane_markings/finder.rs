use super::curve::{Curve, bend_at};
use super::model::Road;
use super::{MarkingFilter, MarkingPoint, RoadCamera};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Vector, math};
use crate::parameter::require;
use crate::vision::GrayView;

/// Known properties of a road.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadModel {
    /// Scale of the road relative to the rules: 1, or 0.5 at a scale of 2:1.
    pub size: f64,
    /// Width of a marking (m).
    pub line_width: f64,
    /// Whether traffic keeps to the left.
    pub left_hand: bool,
}

impl Default for RoadModel {
    /// A road of the rules' size with traffic on the right.
    fn default() -> Self {
        Self { size: 1.0, line_width: 0.02, left_hand: false }
    }
}

/// Position of a car in its lane, and the course of the lane ahead.
#[derive(Debug, Clone, PartialEq)]
pub struct LaneEstimate {
    /// Offset to the left of the lane's centre (m).
    pub offset: f64,
    /// Heading relative to the lane, positive to the left (rad).
    pub heading: f64,
    /// Curvature of the lane's centre line, positive to the left (1/m).
    pub curvature: f64,
    /// Standard deviations of these three.
    pub sigmas: [f64; 3],
    /// Distance from the road's centre line to the centre of an edge line (m).
    pub edge: f64,
    /// Pitch of the camera relative to its nominal tilt, positive upwards (rad).
    pub pitch: f64,
    /// Number of fitting points of lines within 1.5 m.
    pub support: f64,
    /// Whether the road has been out of sight for longer than a gap can be.
    pub lost: bool,
    /// Curvatures of the road's centre line ahead, and distance to the lane's centre (m).
    bends: [f64; super::curve::KNOTS],
    middle: f64,
    size: f64,
    from_road: (f64, f64),
}

impl LaneEstimate {
    /// Curvature of the lane's centre line at a distance ahead along the road (1/m).
    pub fn curvature_at(&self, ahead: f64) -> f64 {
        let bend = bend_at(&self.bends, ahead / self.size) / self.size;
        bend / (1.0 - bend * self.middle)
    }

    /// Distance that a car gains along the road's centre line while it drives a distance (m).
    pub(crate) fn progress(&self, metres: f64) -> f64 {
        let (offset, heading) = self.from_road;
        metres * math::cos(heading) / (1.0 - self.bends[0] * offset).max(0.3)
    }

    /// The road as estimated, to look at what is on it.
    pub(in crate::vision) fn road_ahead(&self) -> RoadAhead {
        let (offset, heading) = self.from_road;
        RoadAhead {
            curve: Curve::new(&self.bends),
            car: Pose::new(0.0, offset, heading),
            edge: self.edge / self.size,
            middle: self.middle / self.size,
        }
    }

    /// Pose on the lane's centre line at a distance ahead along the road (m), in the robot's frame.
    pub fn place(&self, ahead: f64) -> Pose {
        let (point, forward) = Curve::new(&self.bends).at(ahead / self.size);
        let left = self.middle / self.size;
        let x = point.x - forward.y * left;
        let y = point.y + forward.x * left;
        let (offset, heading) = self.from_road;
        let own = Pose::new(0.0, offset, heading).to_local(Point::new(x, y));
        Pose::new(own.x * self.size, own.y * self.size, math::atan2(forward.y, forward.x) - heading)
    }
}

/// The road ahead of a car at the scale of the rules.
#[derive(Debug, Clone)]
pub(in crate::vision) struct RoadAhead {
    curve: Curve,
    /// The car on the road: x along the road, y to the left of its centre line.
    car: Pose,
    /// Distance from the road's centre line to an edge line, and to the left to the own lane's centre (m).
    pub(in crate::vision) edge: f64,
    pub(in crate::vision) middle: f64,
}

impl RoadAhead {
    /// Point of the road's centre line at a distance ahead (m), and the direction to the left there, in the
    /// robot's frame.
    pub(in crate::vision) fn at(&self, ahead: f64) -> (Point, Vector) {
        let (point, forward) = self.curve.at(ahead);
        let (sin, cos) = math::sin_cos(-self.car.heading);
        let aside = Vector::new(-forward.y, forward.x);
        (self.car.to_local(point), Vector::new(cos * aside.x - sin * aside.y, sin * aside.x + cos * aside.y))
    }
}

/// Finds the lane in images and tracks it while the car drives.
///
/// ```
/// use roverlab::vision::lane_markings::{LaneMarkingFinder, RoadCamera, RoadModel};
/// use roverlab::vision::GrayView;
///
/// let camera = RoadCamera { field_of_view: 1.6, fisheye: false, tilt: -0.4, height: 0.25, ahead: 0.06 };
/// let mut finder = LaneMarkingFinder::new(camera, RoadModel::default())?;
/// let image = vec![40; 320 * 240];
/// let lane = finder.see(GrayView::new(&image, 320, 240)?, (0.0, 0.0));
/// assert_eq!(lane.support, 0.0, "nothing is to be seen");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct LaneMarkingFinder {
    road_model: RoadModel,
    filter: MarkingFilter,
    /// The camera at the scale of the rules.
    camera: RoadCamera,
    points: Vec<MarkingPoint>,
    road: Option<Road>,
    /// Whether the road is where odometry expects it, not where the last image showed it.
    is_expected: bool,
    /// Distance driven since the road was last seen (m).
    blind: f64,
}

/// Distance ahead of the camera that is searched (m).
const REACH: f64 = 2.2;
/// Number of points that suffice to see a road.
const ENOUGH: f64 = 7.0;
/// Distance without lines after which the road is lost (m): a gap of 1 m and a crossing.
const BLIND: f64 = 1.6;
/// Number of points by which a road has to explain more than one that is tracked. Of two lines that are taken
/// for the next ones, the outer one has no points, 10 or more in 0.3 m.
const BETTER: f64 = 4.0;
/// Distance from a line within which points count while the road is tracked (m).
const TRACKED: f64 = 0.05;
/// The same while the road is searched (m).
const SOUGHT: f64 = 0.08;

/// Largest distance between neighbours of one drawing on the road, such as the strokes of a number, and width
/// from which it is no pair of lines (m). Lines of lanes and numbers are further apart.
const DRAWING: (f64, f64) = (0.085, 0.055);

/// Removes points of what is painted within a lane: lines of a road are single, or in pairs. Points of a row
/// lie across the car, not across a road that turns: there, stripes are farther apart by a factor.
fn drop_other_paint(points: &mut Vec<MarkingPoint>, factor: impl Fn(&MarkingPoint) -> f64) {
    let (near, wide) = DRAWING;
    let apart = |a: &MarkingPoint, b: &MarkingPoint| (a.place.y - b.place.y).abs();
    let is_joined = |a: &MarkingPoint, b: &MarkingPoint| {
        a.place.x == b.place.x && apart(a, b) < near * factor(a).max(factor(b))
    };
    let is_line = |drawing: &[MarkingPoint]| match drawing {
        [first, .., last] => apart(first, last) < wide,
        _ => true,
    };
    *points = points.chunk_by(is_joined).filter(|drawing| is_line(drawing)).flatten().copied().collect();
}

impl LaneMarkingFinder {
    /// Creates a finder for a camera. Fails for a camera or road out of range.
    pub fn new(camera: RoadCamera, road_model: RoadModel) -> Result<Self, ParameterError> {
        let size = road_model.size;
        require("size of the road", size, (0.1..=10.0).contains(&size), "0.1 to 10")?;
        let filter = MarkingFilter::new(camera, road_model.line_width, REACH * size)?;
        let own = RoadCamera { height: camera.height / size, ahead: camera.ahead / size, ..camera };
        Ok(Self {
            road_model,
            filter,
            camera: own,
            points: Vec::new(),
            road: None,
            is_expected: false,
            blind: 0.0,
        })
    }

    /// Points of lines in the last image, in the robot's frame.
    pub fn points(&self) -> impl Iterator<Item = MarkingPoint> {
        let size = self.road_model.size;
        self.points.iter().map(move |&MarkingPoint { place, contrast, pixel }| MarkingPoint {
            place: place * size,
            contrast,
            pixel: pixel * size,
        })
    }

    /// Discards the road; the next image starts a new search.
    pub fn forget(&mut self) {
        self.road = None;
        self.blind = 0.0;
    }

    /// Expects a straight road in the next image where odometry says that it is: with the car at a distance
    /// to the left of the own lane's centre (m) and in a direction relative to it (rad), and with edge lines
    /// at a distance from the road's centre line (m).
    pub(crate) fn expect(&mut self, offset: f64, heading: f64, edge: f64) {
        let size = self.road_model.size;
        let middle = 0.5 * self.side() * edge;
        self.road = Some(Road::new((middle + offset) / size, heading, 0.0, Some(edge / size)));
        (self.is_expected, self.blind) = (true, 0.0);
    }

    /// Processes an image after the car has driven some distance (m) and turned by an angle (rad) since the
    /// last one. A search assumes that the car is approximately in its lane.
    pub fn see(&mut self, image: GrayView<'_>, (metres, turn): (f64, f64)) -> LaneEstimate {
        let size = self.road_model.size;
        self.filter.find(image, &mut self.points);
        for point in &mut self.points {
            point.place /= size;
            point.pixel /= size;
        }
        let metres = metres / size;
        let lost = self.blind > BLIND;
        let tracked = self.road.take().filter(|_| !lost).map(|mut road| {
            road.drive(metres, turn);
            (road, if self.is_expected { SOUGHT } else { TRACKED })
        });
        match &tracked {
            Some((road, _)) => {
                let curve = Curve::new(&road.bends());
                drop_other_paint(&mut self.points, |point| road.slant(&curve, point.place));
            }
            None => drop_other_paint(&mut self.points, |_| 1.0),
        }
        let is_kept = tracked.is_some();
        self.is_expected = false;
        let (mut road, wide) = tracked.unwrap_or_else(|| (self.acquire(), SOUGHT));
        let support = self.fit(&mut road, wide);
        self.blind = if support < ENOUGH { self.blind + metres.abs() } else { 0.0 };
        let lane = self.estimate(&road, support);
        // A road that was not found in the first image is searched again.
        self.road = (support >= ENOUGH || is_kept).then_some(road);
        lane
    }

    /// Fits a road to the points, or follows it from near the car on where that explains more of them. Returns
    /// the weight of the points within 1.5 m.
    fn fit(&self, road: &mut Road, wide: f64) -> f64 {
        let (points, camera) = (&self.points, &self.camera);
        let before = road.clone();
        let support = road.see(points, camera, wide);
        let enough = road.score(points, camera) + BETTER;
        // No road explains more than all points.
        if points.len() as f64 > enough {
            let (other, support) = before.followed(points, camera);
            if other.score(points, camera) > enough {
                *road = other;
                return support;
            }
        }
        support
    }

    /// Most likely road for a car that is approximately in its lane.
    fn acquire(&self) -> Road {
        let middle = 0.5 * self.side() * Road::new(0.0, 0.0, 0.0, None).edge();
        let mut best = (f64::NEG_INFINITY, Road::new(middle, 0.0, 0.0, None));
        for offset in [0.0, -0.09, 0.09] {
            for heading in [0.0, -0.15, 0.15] {
                for bend in [0.0, -0.35, 0.35, -0.7, 0.7] {
                    let road = Road::new(middle + offset, heading, bend, None);
                    let score = road.score(&self.points, &self.camera);
                    if score > best.0 {
                        best = (score, road);
                    }
                }
            }
        }
        best.1
    }

    /// 1 if the own lane is to the left of the road's centre line, -1 if to the right.
    fn side(&self) -> f64 {
        if self.road_model.left_hand { 1.0 } else { -1.0 }
    }

    fn estimate(&self, road: &Road, support: f64) -> LaneEstimate {
        let size = self.road_model.size;
        let share = 0.5 * self.side();
        let middle = share * road.edge();
        let bends = road.bends();
        let [offset, heading, bend] = road.sigmas(-share);
        let curvature = bends[0] / (1.0 - bends[0] * middle) / size;
        LaneEstimate {
            offset: (road.offset() - middle) * size,
            heading: road.heading(),
            curvature,
            sigmas: [offset * size, heading, bend / size],
            edge: road.edge() * size,
            pitch: road.pitch(),
            support,
            lost: self.blind > BLIND,
            bends,
            middle: middle * size,
            size,
            from_road: (road.offset(), road.heading()),
        }
    }
}
