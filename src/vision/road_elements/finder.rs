use std::f64::consts::{FRAC_PI_2, PI};

use super::across::Tones;
use super::distant::OtherLane;
use super::element::{Detection, RoadElement, RoadElementKind};
use super::number::Numbers;
use super::view::RoadView;
use super::{across, barred, beside, centre, crossing, obstacle};
use crate::ParameterError;
use crate::vision::GrayView;
use crate::vision::lane_markings::{LaneEstimate, RoadCamera, RoadModel};

/// Something tracked.
#[derive(Debug, Clone)]
struct Track {
    kind: RoadElementKind,
    ahead: f64,
    /// Metres per second along the road.
    speed: f64,
    evidence: f64,
    /// Whether the last image shows it.
    is_seen: bool,
}

/// Finds what is on the road ahead, and tracks it while the car drives.
///
/// ```
/// use roverlab::vision::GrayView;
/// use roverlab::vision::lane_markings::{LaneMarkingFinder, RoadCamera, RoadModel};
/// use roverlab::vision::road_elements::{RoadElementFinder, RoadElementKind};
///
/// let camera = RoadCamera { field_of_view: 1.6, fisheye: false, tilt: -0.4, height: 0.25, ahead: 0.06 };
/// let mut image = vec![40; 320 * 240];
/// let mut paint = |x: std::ops::Range<u32>, y: std::ops::Range<i32>| {
///     for (x, y) in x.flat_map(|x| y.clone().map(move |y| (x, y))) {
///         let place = roverlab::geometry::Point::new(f64::from(x) / 400.0, f64::from(y) / 400.0);
///         if let Some((column, row)) = camera.project(place, 0.0, (320, 240))
///             && (0.0..320.0).contains(&column)
///             && (0.0..240.0).contains(&row)
///         {
///             image[row as usize * 320 + column as usize] = 220;
///         }
///     }
/// };
/// // The lines of a lane that is 400 mm wide, and a stop line from 700 mm on.
/// for left in [-84, 84, 252] {
///     paint(80..1200, left - 4..left + 4);
/// }
/// paint(280..295, -80..80);
/// let (mut lane, road) = (LaneMarkingFinder::new(camera, RoadModel::default())?, RoadModel::default());
/// let mut finder = RoadElementFinder::new(camera, road)?;
/// let view = GrayView::new(&image, 320, 240)?;
/// for _ in 0..5 {
///     let lane = lane.see(view, (0.0, 0.0));
///     finder.see(view, &lane, 0.0, 0.04);
/// }
/// let [line] = finder.elements().collect::<Vec<_>>()[..] else { panic!("one line") };
/// assert_eq!(line.kind, RoadElementKind::StopLine);
/// assert!((line.ahead - 0.7).abs() < 0.03, "{line:?}");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct RoadElementFinder {
    size: f64,
    tones: Tones,
    numbers: Numbers,
    view: RoadView,
    /// Distance from the road's centre line to the left to the own lane's centre in the last image (m).
    middle: f64,
    /// Distance from the road's centre line to its edge lines in the last image (m).
    edge: f64,
    found: Vec<Detection>,
    tracks: Vec<Track>,
    other_lane: OtherLane,
    /// Angle from the direction of the road to the other road's at a crossing, positive to the left (rad).
    angle: f64,
    /// Evidence that the centre line is dashed on the own side.
    dashed: f64,
}

/// Evidence of a detection.
const HIT: f64 = 1.0;
/// Evidence of no detection where there should be one.
const MISS: f64 = -0.6;
/// Evidence from which something is present.
const PRESENT: f64 = 2.0;
/// Most evidence: what is gone is forgotten after a few images.
const MOST: f64 = 5.0;
/// Most images for and against a dashed centre line.
const DASHED: f64 = 3.0;
/// Distances ahead of the camera between which what is there is detected reliably (m).
const RELIABLE: (f64, f64) = (0.30, 0.85);
/// Distance behind the robot's origin at which things are forgotten (m).
const BEHIND: f64 = -1.0;
/// Area beside a crosswalk where pedestrians wait, from its near edge (m): 450 mm by the rules, and the
/// error.
const WAITING: std::ops::Range<f64> = -0.10..0.52;
/// Length of a start line by the rules' drawing, with the error of its place (m).
const CHEQUERS: f64 = 0.08;
/// Length of a crosswalk, by the rules (m).
const ZEBRA: f64 = 0.40;
/// Share of a detection's place in the running estimate.
const SHARE: f64 = 0.4;
/// Share of a detection's speed in the running estimate of an obstacle's.
const SPEED_SHARE: f64 = 0.2;
/// Speed of boxes that move, by the rules (m/s). Near the limits of the view, they seem to be faster.
const FASTEST: f64 = 0.6;
/// Share of a crossing's angle in one image in the running estimate.
const ANGLE_SHARE: f64 = 0.15;

impl RoadElementFinder {
    /// Creates a finder. Fails for a camera or a road out of range.
    pub fn new(camera: RoadCamera, road: RoadModel) -> Result<Self, ParameterError> {
        camera.validate()?;
        let size = road.size;
        crate::parameter::require("size of the road", size, (0.1..=10.0).contains(&size), "0.1 to 10")?;
        let own = RoadCamera { height: camera.height / size, ahead: camera.ahead / size, ..camera };
        Ok(Self {
            size,
            tones: Tones::new(),
            numbers: Numbers::new(),
            view: RoadView::new(own),
            middle: 0.0,
            edge: 0.0,
            found: Vec::new(),
            tracks: Vec::new(),
            other_lane: OtherLane::default(),
            angle: FRAC_PI_2,
            dashed: 0.0,
        })
    }

    /// Things that are present, nearest first.
    pub fn elements(&self) -> impl Iterator<Item = RoadElement> {
        let size = self.size;
        self.tracks.iter().filter(|track| track.evidence >= track.needed()).map(move |track| {
            let kind = match track.kind {
                RoadElementKind::Obstacle { right, left } => {
                    RoadElementKind::Obstacle { right: right * size, left: left * size }
                }
                RoadElementKind::Barred { right, left, length } => {
                    RoadElementKind::Barred { right: right * size, left: left * size, length: length * size }
                }
                other => other,
            };
            RoadElement { kind, ahead: track.ahead * size, speed: track.speed * size }
        })
    }

    /// Boxes in the other lane up to 4 m ahead, as [`RoadElementKind::Obstacle`]; their speed is negative if
    /// they come towards the car.
    pub fn in_other_lane(&self) -> impl Iterator<Item = RoadElement> {
        self.other_lane.elements(self.size, self.middle)
    }

    /// Whether the last image shows a box between two distances ahead of the robot's origin (m), on the road
    /// and up to a distance beyond its right edge (m). Nothing is a box that is no longer than `paint` (m),
    /// the length of paint there: stripes of a crosswalk hide the feet of boxes.
    pub fn sees_box(&self, (from, to): (f64, f64), beyond: f64, paint: f64) -> bool {
        let edge = self.edge - 0.02;
        let sides = [edge + beyond / self.size, edge];
        obstacle::is_occupied(&self.view, sides, (from / self.size, to / self.size), paint / self.size)
    }

    /// Angle from the direction of the road to that of the other one at the crossing that was seen last,
    /// positive to the left (rad); 90 degrees before any.
    pub fn crossing_angle(&self) -> f64 {
        self.angle
    }

    /// Whether cars may cross the marking between the lanes from the own one, a little ahead.
    pub fn may_pass(&self) -> bool {
        self.dashed >= 0.0
    }

    /// Discards boxes between two distances ahead of the robot's origin (m), for whoever knows that they are
    /// gone.
    pub fn forget_boxes(&mut self, (from, to): (f64, f64)) {
        let gone = from / self.size..to / self.size;
        let is_gone = |track: &Track| {
            matches!(track.kind, RoadElementKind::Obstacle { .. }) && gone.contains(&track.ahead)
        };
        self.tracks.retain(|track| !is_gone(track));
    }

    /// Discards everything.
    pub fn forget(&mut self) {
        self.tracks.clear();
        self.other_lane.forget();
        self.dashed = 0.0;
    }

    /// Processes an image with the lane found in it, after the car has driven a distance (m) in some seconds.
    pub fn see(&mut self, image: GrayView<'_>, lane: &LaneEstimate, metres: f64, seconds: f64) {
        let metres = lane.progress(metres) / self.size;
        for track in &mut self.tracks {
            track.ahead += track.speed * seconds - metres;
            track.is_seen = false;
        }
        self.other_lane.advance(metres, seconds);
        if !lane.lost {
            self.detect(image, lane);
            self.other_lane.see(&self.view, image, &lane.road_ahead(), lane.pitch);
            for detection in std::mem::take(&mut self.found) {
                self.associate(&detection, seconds);
            }
        }
        self.judge(lane.lost);
        self.tracks.sort_by(|a, b| a.ahead.total_cmp(&b.ahead));
    }

    fn detect(&mut self, image: GrayView<'_>, lane: &LaneEstimate) {
        let road = lane.road_ahead();
        self.view.straighten(image, &road, lane.pitch);
        (self.middle, self.edge) = (road.middle, road.edge);
        let (view, found) = (&self.view, &mut self.found);
        found.clear();
        let zebras = self.tracks.iter().filter(|track| track.kind == RoadElementKind::Zebra);
        let zebras: Vec<f64> = zebras.map(|track| track.ahead).collect();
        let waiting = |ahead: f64| zebras.iter().any(|zebra| WAITING.contains(&(ahead - zebra)));
        obstacle::boxes(view, &road, waiting, found);
        across::zebras(view, &self.tones, &road, found);
        across::lines(view, &self.tones, &road, found);
        drop_chequers(found);
        // Boxes hide edge lines, and their outlines look like lines that leave the road.
        if found.iter().all(|detection| !matches!(detection.kind, RoadElementKind::Obstacle { .. })) {
            let left = crossing::on_side(view, &road, 1.0, found);
            let right = crossing::on_side(view, &road, -1.0, found).map(|angle| PI - angle);
            for angle in left.into_iter().chain(right) {
                self.angle += ANGLE_SHARE * (angle - self.angle);
            }
        }
        beside::parking(view, &road, found);
        // A box may have come so near that its foot is out of view.
        let boxes = self.tracks.iter().filter(|track| track.evidence >= PRESENT).map(|track| track.kind);
        let is_box = |kind: RoadElementKind| barred::is_in_other_lane(&road, kind);
        let has_box = boxes.chain(found.iter().map(|it| it.kind)).any(is_box);
        barred::barred(view, &road, has_box, found);
        found.extend(self.numbers.find(view, &road));
        let near = found.iter().filter(|it| matches!(it.kind, RoadElementKind::Obstacle { .. }));
        let hidden = near.map(|it| it.ahead).fold(f64::INFINITY, f64::min);
        // The stripes of a crosswalk look like solid lines.
        let hidden =
            zebras.iter().copied().filter(|zebra| zebra + ZEBRA > view.from()).fold(hidden, f64::min);
        if let Some(is_dashed) = centre::is_dashed(view, &road, hidden) {
            self.dashed = (self.dashed + if is_dashed { 1.0 } else { -1.0 }).clamp(-DASHED, DASHED);
        }
    }

    /// Updates the track of a detection, or begins one.
    fn associate(&mut self, detection: &Detection, seconds: f64) {
        // One number stands in one place: who reads another one there doubts the first.
        for track in self.tracks.iter_mut().filter(|track| track.is_other_number(detection)) {
            track.evidence -= HIT;
        }
        let near = |track: &&mut Track| track.is_near(detection);
        let by_distance = |a: &&mut Track, b: &&mut Track| a.off(detection).total_cmp(&b.off(detection));
        if let Some(track) = self.tracks.iter_mut().filter(near).min_by(by_distance) {
            track.update(detection, seconds);
            return;
        }
        let Detection { kind, ahead, .. } = *detection;
        self.tracks.push(Track { kind, ahead, speed: 0.0, evidence: HIT, is_seen: true });
    }

    /// Lowers the evidence of what should have been seen, and drops what is not there.
    fn judge(&mut self, is_blind: bool) {
        let (view, edge) = (&self.view, self.edge);
        let from = view.from();
        let is_in_view = |track: &Track| {
            let row = view.row(track.ahead);
            match track.kind {
                RoadElementKind::Obstacle { right, left } => {
                    [right, left].iter().all(|side| view.sees(row, super::view::column(side + self.middle)))
                }
                // A narrow lens loses the other lane before the own one.
                RoadElementKind::Zebra => across::begins_in_view(view, edge, row),
                // Arms of a crossing and areas beside the road may be outside the view.
                RoadElementKind::Crossing { .. }
                | RoadElementKind::Parking { .. }
                | RoadElementKind::Barred { .. }
                // A number is read where it is sharp.
                | RoadElementKind::SpeedLimit(_)
                | RoadElementKind::TurnArrow { .. }
                | RoadElementKind::SpeedLimitEnd => false,
                _ => view.sees(row, super::view::column(self.middle)),
            }
        };
        for track in &mut self.tracks {
            let is_near = track.ahead < from + RELIABLE.0;
            if track.is_seen || is_blind || is_near || !is_in_view(track) {
                continue;
            }
            if track.ahead < from + RELIABLE.1 {
                track.evidence += MISS;
            } else {
                // A wrong speed, from a few images, would keep it beyond the reliable distance for ever.
                track.speed *= 1.0 - SPEED_SHARE;
            }
        }
        self.tracks.retain(|track| track.evidence > 0.0 && track.ahead > BEHIND);
    }
}

/// Drops boxes with their feet on the start line: chequers in a patch of light end as sharply as a box does.
fn drop_chequers(found: &mut Vec<Detection>) {
    let lines = found.iter().filter(|it| it.kind == RoadElementKind::StartLine);
    let lines: Vec<f64> = lines.map(|it| it.ahead).collect();
    let is_box = |it: &Detection| matches!(it.kind, RoadElementKind::Obstacle { .. });
    found.retain(|it| !is_box(it) || lines.iter().all(|line| (it.ahead - line).abs() > CHEQUERS));
}

impl Track {
    /// Evidence from which it counts as present. The lines of an arm are short, and patches beside a gap in
    /// the edge line look like them.
    fn needed(&self) -> f64 {
        if matches!(self.kind, RoadElementKind::Crossing { .. }) { PRESENT + 1.0 } else { PRESENT }
    }

    fn off(&self, detection: &Detection) -> f64 {
        (self.ahead - detection.ahead).abs()
    }

    /// Whether a detection is of another number in the same place.
    fn is_other_number(&self, detection: &Detection) -> bool {
        use RoadElementKind::{SpeedLimit, SpeedLimitEnd, TurnArrow};
        let are_numbers = [self.kind, detection.kind]
            .map(|kind| matches!(kind, SpeedLimit(_) | SpeedLimitEnd | TurnArrow { .. }));
        are_numbers == [true; 2] && self.kind != detection.kind && self.off(detection) < 0.2
    }

    /// Whether a detection can be of this thing.
    fn is_near(&self, detection: &Detection) -> bool {
        use RoadElementKind::{Barred, Crossing, Obstacle, Parking};
        let gate = match (self.kind, detection.kind) {
            (Crossing { .. }, Crossing { .. }) => 0.45,
            (Obstacle { right, left }, Obstacle { right: r, left: l })
                if r < left + 0.05 && l > right - 0.05 =>
            {
                0.25
            }
            // The near end of an area leaves the view before the rest does.
            (Barred { length, .. }, Barred { .. }) => 0.3 + length,
            (Parking { left }, Parking { left: same }) if left == same => 1.0,
            (one, other) if one == other => 0.12,
            _ => return false,
        };
        self.off(detection) <= gate
    }

    fn update(&mut self, detection: &Detection, seconds: f64) {
        use RoadElementKind::{Barred, Crossing, Obstacle, Parking};
        let off = detection.ahead - self.ahead;
        match (&mut self.kind, detection.kind) {
            (Crossing { left, right }, Crossing { left: l, right: r }) => {
                *left |= l;
                *right |= r;
                self.ahead += 0.25 * off;
            }
            // Of a box that leaves the view, neither the foot nor the sides are known.
            (Obstacle { .. }, Obstacle { .. }) if !detection.is_whole => {}
            (Obstacle { right, left }, Obstacle { right: r, left: l }) => {
                *right += SHARE * (r - *right);
                *left += SHARE * (l - *left);
                self.ahead += SHARE * off;
                let speed = self.speed + SPEED_SHARE * off / seconds.max(1e-3);
                self.speed = speed.clamp(-FASTEST, FASTEST);
            }
            (Barred { right, left, length }, Barred { right: r, left: l, length: long }) => {
                *right += SHARE * (r - *right);
                *left += SHARE * (l - *left);
                if off < 0.0 {
                    self.ahead += SHARE * off;
                }
                *length = length.max(detection.ahead + long - self.ahead);
            }
            // An area begins where its line was first seen; later, the view cuts it.
            (Parking { .. }, Parking { .. }) => self.ahead += if off < 0.0 { SHARE * off } else { 0.0 },
            _ => self.ahead += SHARE * off,
        }
        self.evidence = (self.evidence + if self.is_seen { 0.0 } else { HIT }).min(MOST);
        self.is_seen = true;
    }
}
