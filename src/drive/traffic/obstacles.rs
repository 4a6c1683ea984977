use crate::vision::road_elements::{RoadElement, RoadElementKind};

/// An obstacle on the road or a barred area, with the other lane's direction as left.
#[derive(Debug, Clone, Copy)]
pub(super) struct Obstacle {
    pub(super) ahead: f64,
    pub(super) right: f64,
    pub(super) left: f64,
    pub(super) length: f64,
    pub(super) speed: f64,
    /// Whether it is a barred area.
    pub(super) is_paint: bool,
}

impl Obstacle {
    /// Whether it is within a distance to both sides of the lane's centre (m).
    pub(super) fn is_in_way(&self, reach: f64) -> bool {
        self.left > -reach && self.right < reach
    }
}

/// Longest box, by the rules' drawing, and the error of its foot's place (m).
const LONGEST: f64 = 0.42;
/// Error of the place of an obstacle that moves beside the car, out of view (m).
const UNSEEN: f64 = 0.12;
/// Positions of pedestrians relative to a crosswalk's near edge: half of the waiting areas of 450 mm to both
/// sides of its middle, and the error (m).
const WAITING: std::ops::Range<f64> = -0.10..0.52;
/// Distance beyond a crosswalk's near edge up to which nothing else stands, as elements are a metre apart by
/// the rules (m): what seems to stand there are stripes that blur to a box.
const APART: f64 = 1.0;
/// Length of a crosswalk (m).
pub(super) const ZEBRA: f64 = 0.40;
/// Half the length of a crossing along the road, with the error of a box's place (m).
const HALF_CROSSING: f64 = 0.55;
/// Distance within which a line is the same one (m).
pub(super) const SAME: f64 = 0.35;
/// Speed from which an obstacle moves; boxes drive at 0.6 m/s by the rules (m/s).
pub(super) const MOVES: f64 = 0.3;

/// Speed of what comes towards the car; boxes drive at 0.6 m/s by the rules (m/s).
const COMES: f64 = -0.25;

/// Obstacles on the road that are no pedestrians, and barred areas. The other lane is on the left (side 1) or
/// on the right (-1), and the road has a size relative to that of the rules.
pub(super) fn obstacles(elements: &[RoadElement], side: f64, size: f64) -> Vec<Obstacle> {
    let zebras: Vec<f64> = elements
        .iter()
        .filter(|element| element.kind == RoadElementKind::Zebra)
        .map(|zebra| zebra.ahead)
        .collect();
    let is_beside = |beyond: f64| (WAITING.start..APART).contains(&(beyond / size));
    let obstacles = elements.iter().filter_map(|element| {
        let &RoadElement { ahead, speed, .. } = element;
        let (right, left, length) = match element.kind {
            RoadElementKind::Obstacle { .. } if zebras.iter().any(|zebra| is_beside(ahead - zebra)) => None,
            RoadElementKind::Obstacle { right, left } => {
                Some((right, left, size * (LONGEST + if speed > MOVES { UNSEEN } else { 0.0 })))
            }
            // What looks like slanted stripes there are those of the crosswalk, or a box that crosses.
            RoadElementKind::Barred { .. }
                if is_in_zebra(elements, ahead, size) || is_in_crossing(elements, ahead, size) =>
            {
                None
            }
            RoadElementKind::Barred { right, left, length } => Some((right, left, length)),
            _ => None,
        }?;
        let (right, left) = if side > 0.0 { (right, left) } else { (-left, -right) };
        let is_paint = matches!(element.kind, RoadElementKind::Barred { .. });
        Some(Obstacle { ahead, right, left, length, speed, is_paint })
    });
    obstacles.collect()
}

/// Whether one of some boxes in the other lane comes and is not yet behind the car's front (m).
pub(super) fn comes(mut boxes: impl Iterator<Item = RoadElement>, front: f64, size: f64) -> bool {
    boxes.any(|it| it.speed < COMES && it.ahead + size * LONGEST > front)
}

/// Whether an element is a box on a crosswalk or beside it.
pub(super) fn is_at(element: &RoadElement, zebra: f64, size: f64) -> bool {
    let is_box = matches!(element.kind, RoadElementKind::Obstacle { .. });
    is_box && WAITING.contains(&((element.ahead - zebra) / size))
}

/// Whether a place ahead (m) is on a crosswalk or just before it.
pub(super) fn is_in_zebra(elements: &[RoadElement], ahead: f64, size: f64) -> bool {
    let mut zebras = elements.iter().filter(|element| element.kind == RoadElementKind::Zebra);
    zebras.any(|zebra| (-SAME..ZEBRA + 0.1).contains(&((ahead - zebra.ahead) / size)))
}

/// Whether a place ahead (m) is in a crossing.
pub(super) fn is_in_crossing(elements: &[RoadElement], ahead: f64, size: f64) -> bool {
    let mut crossings = elements.iter().filter(|it| matches!(it.kind, RoadElementKind::Crossing { .. }));
    crossings.any(|crossing| (ahead - crossing.ahead).abs() < size * HALF_CROSSING)
}
