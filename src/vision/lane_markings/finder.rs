use super::curve::{Curve, bend_at};
use super::model::Road;
use super::{MarkingFilter, MarkingPoint, RoadCamera};
use crate::ParameterError;
use crate::geometry::{Point, Pose, math};
use crate::parameter::require;
use crate::vision::GrayView;

/// What is known of a road before it is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoadModel {
    /// Metres of the road for each metre of the rules: 1, or 0.5 at a scale of 2:1.
    pub size: f64,
    /// Metres across a marking.
    pub line_width: f64,
    /// Whether cars keep to the left.
    pub left_hand: bool,
}

impl Default for RoadModel {
    /// A road of the rules' size, and traffic on the right.
    fn default() -> Self {
        Self { size: 1.0, line_width: 0.02, left_hand: false }
    }
}

/// Where a car is on its lane, and how the lane goes on.
#[derive(Debug, Clone, PartialEq)]
pub struct LaneEstimate {
    /// Metres to the left of the lane's middle.
    pub offset: f64,
    /// Radians to the left of the lane's direction.
    pub heading: f64,
    /// The curvature of the lane's middle, in 1/m; positive to the left.
    pub curvature: f64,
    /// The standard deviations of these three.
    pub sigmas: [f64; 3],
    /// Metres from the road's middle to the middle of an edge line.
    pub edge: f64,
    /// Radians by which the camera looks higher than it is said to.
    pub pitch: f64,
    /// How many points of lines fit within a metre and a half.
    pub support: f64,
    /// Whether the road has not been seen for longer than a gap may be.
    pub lost: bool,
    /// Curvatures of the road's middle ahead, and metres to the lane's middle.
    bends: [f64; super::curve::KNOTS],
    middle: f64,
    size: f64,
    from_road: (f64, f64),
}

impl LaneEstimate {
    /// The curvature of the lane's middle some metres ahead along the road.
    pub fn curvature_at(&self, ahead: f64) -> f64 {
        let bend = bend_at(&self.bends, ahead / self.size) / self.size;
        bend / (1.0 - bend * self.middle)
    }

    /// A place of the lane's middle some metres ahead along the road, in the robot's frame, with the lane's
    /// direction.
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

/// Finds the lane in images, and tracks it while the car drives.
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
    /// The camera in the rules' size.
    camera: RoadCamera,
    points: Vec<MarkingPoint>,
    road: Option<Road>,
    /// Metres driven since the road was seen.
    blind: f64,
}

/// Metres of ground that are looked at, ahead of the camera.
const REACH: f64 = 2.2;
/// Points that are enough to see a road by.
const ENOUGH: f64 = 7.0;
/// Metres without lines after which the road is lost: a gap of 1 m, and a crossing.
const BLIND: f64 = 1.6;
/// Metres within which points count while the road is tracked, and when it is looked for.
const TRACKED: f64 = 0.05;
const SOUGHT: f64 = 0.08;

impl LaneMarkingFinder {
    /// A finder for a camera. Fails where camera or road make no sense.
    pub fn new(camera: RoadCamera, road_model: RoadModel) -> Result<Self, ParameterError> {
        let size = road_model.size;
        require("size of the road", size, (0.1..=10.0).contains(&size), "0.1 to 10")?;
        let filter = MarkingFilter::new(camera, road_model.line_width, REACH * size)?;
        let own = RoadCamera { height: camera.height / size, ahead: camera.ahead / size, ..camera };
        Ok(Self { road_model, filter, camera: own, points: Vec::new(), road: None, blind: 0.0 })
    }

    /// The points of lines in the last image, in the robot's frame.
    pub fn points(&self) -> impl Iterator<Item = MarkingPoint> {
        let size = self.road_model.size;
        self.points.iter().map(move |&MarkingPoint { place, contrast, pixel }| MarkingPoint {
            place: place * size,
            contrast,
            pixel: pixel * size,
        })
    }

    /// Forgets the road, and looks for it anew in the next image.
    pub fn forget(&mut self) {
        self.road = None;
        self.blind = 0.0;
    }

    /// Looks at an image after the car has driven some metres and turned by some radians since the last one.
    /// Takes the car to be about in its lane when it looks for the road.
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
            (road, TRACKED)
        });
        let (mut road, wide) = tracked.unwrap_or_else(|| (self.acquire(), SOUGHT));
        let support = road.see(&self.points, &self.camera, wide);
        self.blind = if support < ENOUGH { self.blind + metres.abs() } else { 0.0 };
        let lane = self.estimate(&road, support);
        // What has not been seen at first is looked for again.
        self.road = (support >= ENOUGH || wide == TRACKED).then_some(road);
        lane
    }

    /// The likeliest road for a car that is about in its lane.
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

    /// 1 if the own lane is to the left of the road's middle, -1 to the right.
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
