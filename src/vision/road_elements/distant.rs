//! White boxes in the other lane, as far as they can be seen: farther than the straightened picture reaches.

use super::element::{RoadElement, RoadElementKind};
use super::view::RoadView;
use crate::geometry::Point;
use crate::vision::GrayView;
use crate::vision::lane_markings::{Projection, RoadAhead};

/// Distances ahead of the camera between which boxes are looked for (m): at the farther one, the smallest box
/// of the rules covers three pixels of a QVGA image each way.
const RANGE: (f64, f64) = (0.5, 4.3);
/// Distances from the centre line and from the edge line to what is examined (m): the width of a pixel at the
/// farthest place, and the error of the lane.
const MARGIN: (f64, f64) = (0.06, 0.03);
/// Least brightness of a box between floor and paint; the side that no light meets is at about half.
const WHITE: f64 = 0.30;
/// Least step of brightness at its foot.
const STEP: f64 = 0.25;
/// Largest brightness beside it, relative to its own.
const DIMMER: f64 = 0.65;
/// Distance beside it where it is that dark (pixels).
const BESIDE: i32 = 2;
/// Height to which it is bright (m): by the rules, boxes are at least 100 mm high.
const TALL: f64 = 0.075;
/// Least width (m): by the rules, boxes are at least 100 mm wide.
const WIDE: f64 = 0.065;
/// Error of a foot in the image (pixels).
const PIXEL: f64 = 0.7;
/// Error of the place of a foot from other causes (m).
const BLUR: f64 = 0.02;
/// Standard deviation of a box's speed at first (m/s): boxes drive at 0.6 m/s by the rules.
const SPEED: f64 = 0.5;
/// Change of a box's speed in a second (m/s): it starts within the view.
const STARTS: f64 = 0.3;
/// Number of images that a box has to be in.
const PRESENT: u32 = 4;
/// Error of its speed from which that is known (m/s): boxes that stand and those that come differ by 0.6 m/s.
const KNOWN: f64 = 0.25;
/// Least step along the road from place to place (m), that of a pixel at the nearest one.
const NEXT: f64 = 0.004;
/// Longest time for which a box is kept that something hides (s).
const MEMORY: f64 = 1.5;
/// Distance behind the robot's origin at which a box is forgotten (m).
const BEHIND: f64 = -1.0;

/// A box in one image: distance ahead of the robot's origin (m), its sides to the left of the road's centre
/// line (m), and the error of the distance (m).
#[derive(Debug, Clone, Copy)]
struct Sighting {
    ahead: f64,
    sides: [f64; 2],
    sigma: f64,
}

/// A box that is tracked: a Kalman filter of its distance and its speed along the road.
#[derive(Debug, Clone)]
struct Track {
    ahead: f64,
    speed: f64,
    /// Variances of distance and speed, and their covariance.
    variance: [f64; 2],
    covariance: f64,
    sides: [f64; 2],
    hits: u32,
    /// Time since it was last seen (s).
    unseen: f64,
}

/// The boxes in the other lane, at the scale of the rules.
#[derive(Debug, Clone, Default)]
pub(super) struct OtherLane {
    sightings: Vec<Sighting>,
    tracks: Vec<Track>,
}

impl OtherLane {
    /// Predicts where the boxes are after the car has driven a distance (m) in some seconds.
    pub(super) fn advance(&mut self, metres: f64, seconds: f64) {
        for track in &mut self.tracks {
            track.advance(metres, seconds);
        }
        self.tracks.retain(|track| track.ahead > BEHIND && track.unseen < track.memory());
    }

    /// Processes an image with the road in it.
    pub(super) fn see(&mut self, view: &RoadView, image: GrayView<'_>, road: &RoadAhead, pitch: f64) {
        self.sightings.clear();
        find(view, image, road, &view.projection(image, pitch), &mut self.sightings);
        for sighting in &self.sightings {
            let off = |track: &Track| (track.ahead - sighting.ahead).abs();
            let near = self.tracks.iter_mut().filter(|track| track.is_near(sighting));
            match near.min_by(|a, b| off(a).total_cmp(&off(b))) {
                Some(track) => track.update(sighting),
                None => self.tracks.push(Track::new(sighting)),
            }
        }
    }

    pub(super) fn forget(&mut self) {
        self.tracks.clear();
    }

    /// The boxes that have been seen often enough, on a road of a size with the own lane's middle at a
    /// distance to the left of its centre line (m).
    pub(super) fn elements(&self, size: f64, middle: f64) -> impl Iterator<Item = RoadElement> {
        self.tracks.iter().filter(|track| track.is_known()).map(move |track| {
            let [right, left] = track.sides.map(|side| (side - middle) * size);
            let kind = RoadElementKind::Obstacle { right, left };
            RoadElement { kind, ahead: track.ahead * size, speed: track.speed * size }
        })
    }
}

impl Track {
    fn new(sighting: &Sighting) -> Self {
        Self {
            ahead: sighting.ahead,
            speed: 0.0,
            variance: [sighting.sigma * sighting.sigma, SPEED * SPEED],
            covariance: 0.0,
            sides: sighting.sides,
            hits: 1,
            unseen: 0.0,
        }
    }

    /// Time for which it is kept unseen (s): what was in one image only is soon forgotten.
    fn memory(&self) -> f64 {
        MEMORY * f64::from(self.hits.min(PRESENT)) / f64::from(PRESENT)
    }

    fn is_known(&self) -> bool {
        self.hits >= PRESENT && self.variance[1] < KNOWN * KNOWN
    }

    fn advance(&mut self, metres: f64, seconds: f64) {
        self.ahead += self.speed * seconds - metres;
        self.unseen += seconds;
        self.variance[0] += seconds * (2.0 * self.covariance + seconds * self.variance[1]);
        self.covariance += seconds * self.variance[1];
        self.variance[1] += STARTS * STARTS * seconds;
    }

    fn is_near(&self, sighting: &Sighting) -> bool {
        let sigma = (self.variance[0] + sighting.sigma * sighting.sigma).sqrt();
        (self.ahead - sighting.ahead).abs() < 0.1 + 3.0 * sigma
    }

    fn update(&mut self, sighting: &Sighting) {
        let sum = self.variance[0] + sighting.sigma * sighting.sigma;
        let gain = [self.variance[0] / sum, self.covariance / sum];
        let off = sighting.ahead - self.ahead;
        self.ahead += gain[0] * off;
        self.speed += gain[1] * off;
        self.variance[1] -= gain[1] * self.covariance;
        self.covariance -= gain[0] * self.covariance;
        self.variance[0] -= gain[0] * self.variance[0];
        self.sides = sighting.sides;
        self.hits += 1;
        self.unseen = 0.0;
    }
}

/// Finds the feet of boxes in the other lane.
fn find(
    view: &RoadView,
    image: GrayView<'_>,
    road: &RoadAhead,
    projection: &Projection,
    found: &mut Vec<Sighting>,
) {
    let mut ahead = view.from() + RANGE.0;
    while ahead < view.from() + RANGE.1 {
        let Some(slice) = Slice::new(projection, road, ahead, image.width()) else { return };
        if let Some(sides) = slice.front(view, image) {
            let error = PIXEL * slice.depth;
            let sigma = (BLUR * BLUR + error * error).sqrt();
            found.push(Sighting { ahead, sides, sigma });
            // The rest of the box, and what it hides, is above it in the image.
            ahead += 0.3;
        }
        ahead += slice.depth;
    }
}

/// The other lane at one distance: where it is in the image, from its inner side to its outer one.
struct Slice {
    /// Columns and rows of both sides, and their distances to the left of the road's centre line (m).
    ends: [(f64, f64); 2],
    lefts: [f64; 2],
    /// Pixels per metre across, and metres along the road per pixel.
    scale: f64,
    depth: f64,
}

impl Slice {
    /// `None` where the road is out of sight, or turns back beside the camera: there its lane is wider than
    /// the image.
    fn new(projection: &Projection, road: &RoadAhead, ahead: f64, width: usize) -> Option<Self> {
        let side = -road.middle.signum();
        let lefts = [side * MARGIN.0, side * (road.edge - MARGIN.1)];
        let (centre, aside) = road.at(ahead);
        let project = |place: Point| projection.of(place);
        let ends = [project(centre + aside * lefts[0])?, project(centre + aside * lefts[1])?];
        let (next, _) = road.at(ahead + 0.05);
        let depth = 0.05 / (project(centre)?.1 - project(next)?.1).abs().max(1e-3);
        let across = (ends[1].0 - ends[0].0).abs();
        let scale = across / (lefts[1] - lefts[0]).abs();
        let is_seen = scale > 1.0 && across <= width as f64;
        is_seen.then_some(Self { ends, lefts, scale, depth: depth.clamp(NEXT, 1.0) })
    }

    /// Sides of the widest box whose foot is here, to the left of the road's centre line (m).
    fn front(&self, view: &RoadView, image: GrayView<'_>) -> Option<[f64; 2]> {
        let [from, to] = self.ends;
        let count = (to.0 - from.0).abs().ceil() as i32;
        let pixel = |i: i32| {
            let share = (f64::from(i) + 0.5) / f64::from(count);
            (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1))
        };
        let level = |i: i32, up: i32| {
            let (column, row) = pixel(i);
            at(image, column as i32, row as i32 - up).map(|gray| view.level(gray))
        };
        let high = ((TALL * self.scale).ceil() as i32).max(2);
        let stands = |i: i32| {
            let front = (1..=high).map(|up| level(i, up).unwrap_or(0.0));
            let (least, sum) = front.fold((1.0, 0.0), |(least, sum), it| (f64::min(least, it), sum + it));
            let before = level(i, -1).unwrap_or(1.0);
            least >= WHITE && sum / f64::from(high) - before >= STEP
        };
        let (mut best, mut begun): ((i32, i32), Option<i32>) = ((0, 0), None);
        for i in 0..=count {
            if i < count && stands(i) {
                begun.get_or_insert(i);
            } else if let Some(begin) = begun.take()
                && i - begin > best.1 - best.0
            {
                best = (begin, i);
            }
        }
        let (begin, end) = best;
        let is_wide = f64::from(end - begin) >= WIDE * self.scale;
        // Beside it there is floor, or something that stands before it.
        let ends = |last: i32, out: i32| {
            let inside = level(last, 1).unwrap_or(0.0);
            let beside = |up: i32| level(last + out * BESIDE, up);
            beside(1).is_none_or(|it| it <= DIMMER * inside) || beside(-2).is_none_or(|it| it >= WHITE)
        };
        (is_wide && ends(begin, -1) && ends(end - 1, 1)).then(|| {
            let left =
                |i: i32| self.lefts[0] + f64::from(i) / f64::from(count) * (self.lefts[1] - self.lefts[0]);
            let (a, b) = (left(begin), left(end));
            [a.min(b), a.max(b)]
        })
    }
}

/// Brightness of a pixel; `None` outside the image.
fn at(image: GrayView<'_>, column: i32, row: i32) -> Option<f32> {
    let (x, y) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
    (x < image.width() && y < image.height()).then(|| f32::from(image.row(y)[x]))
}
