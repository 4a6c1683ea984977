use std::f64::consts::{FRAC_PI_2, TAU};

use super::surroundings::Surroundings;
use crate::geometry::{Point, Pose, WallSide, direction, math, normalize_angle};

/// Distances of boundary following, measured from the robot's centre (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FollowDistances {
    /// Required on either side of a passage.
    pub(super) least: f64,
    /// Kept where there is room.
    pub(super) wished: f64,
    /// Length of a step checked ahead.
    pub(super) step: f64,
}

/// Follows an obstacle's boundary in one direction, into every passage that is wide enough.
///
/// Headings are tried from the obstacle outwards until a step is free. This determines *where* the boundary
/// runs: it is the boundary of the obstacle inflated by the minimum distance. Within that opening the robot
/// takes the first heading that keeps the desired distance, or else the one with the most room, along the
/// middle of a narrow passage.
#[derive(Debug, Clone)]
pub(super) struct BoundaryFollower {
    side: WallSide,
    distances: FollowDistances,
    /// The point that bounded the last step, in the frame of the robot's poses.
    anchor: Point,
    /// Number of steps since it was last seen.
    unseen: u32,
}

/// Number of headings tried in a turn.
const HEADINGS: usize = 180;
/// Distance between them (rad).
const SPACING: f64 = TAU / HEADINGS as f64;
/// Maximum jump of the anchor between two steps (m). Anything farther away is another part of the wall; the
/// anchor, such as the end of a thin wall seen edge-on, is still there.
const ANCHOR_JUMP: f64 = 0.04;
/// Number of steps for which an invisible anchor is assumed to be still there.
const ANCHOR_MEMORY: u32 = 20;

impl BoundaryFollower {
    /// Creates a follower of the obstacle at `anchor`.
    pub(super) fn new(side: WallSide, distances: FollowDistances, anchor: Point) -> Self {
        Self { side, distances, anchor, unseen: 0 }
    }

    /// Follows the same boundary in the other direction.
    pub(super) fn turn_back(&mut self) {
        self.side = self.side.other();
    }

    /// The point that bounded the last step, in the frame of the robot's poses.
    pub(super) fn anchor(&self) -> Point {
        self.anchor
    }

    /// The heading to take, relative to the robot's; `None` when no step is free. Adds an anchor that is
    /// briefly out of sight to the surroundings.
    pub(super) fn heading(&mut self, pose: &Pose, surroundings: &mut Surroundings) -> Option<f64> {
        let sense = self.side.sense();
        let anchor = self.local_anchor(pose, surroundings);
        let start = math::atan2(anchor.y, anchor.x);
        let at = |k: i32| start + sense * SPACING * f64::from(k);
        let FollowDistances { least, step, .. } = self.distances;
        let first = opening(|k| surroundings.is_step_free(direction(at(k)), step, least))?;
        let chosen = self.roomy(first, |k| surroundings.step_clearance(direction(at(k)), step).0);
        let bounding = surroundings.step_clearance(direction(at(first - 1)), self.distances.step).1;
        if let Some(point) = bounding {
            self.anchor = pose.to_world(point);
        }
        Some(normalize_angle(at(chosen)))
    }

    /// The anchor as seen now, in the robot's frame. The end of a thin wall seen edge-on may fall between the
    /// beams for a few steps; it is remembered meanwhile.
    fn local_anchor(&mut self, pose: &Pose, surroundings: &mut Surroundings) -> Point {
        let expected = pose.to_local(self.anchor);
        match surroundings.nearest_to(expected) {
            Some(seen) if (seen - expected).norm() < ANCHOR_JUMP => {
                self.unseen = 0;
                seen
            }
            _ => {
                self.unseen += 1;
                if self.unseen <= ANCHOR_MEMORY {
                    surroundings.remember(expected);
                }
                expected
            }
        }
    }

    /// Within the opening that starts at `first`, the first heading with the wished room, or the one with the
    /// most.
    fn roomy(&self, first: i32, clearance: impl Fn(i32) -> f64) -> i32 {
        let mut best = (first, 0.0);
        let quarter = (FRAC_PI_2 / SPACING) as i32;
        for k in first..first + quarter {
            let room = clearance(k);
            if room >= self.distances.wished {
                return k;
            }
            if room < self.distances.least {
                break;
            }
            if room > best.1 {
                best = (k, room);
            }
        }
        best.0
    }
}

/// The first free heading outwards from the anchor, as an index.
fn opening(is_free: impl Fn(i32) -> bool) -> Option<i32> {
    if !is_free(0) {
        return (1..HEADINGS as i32).find(|&k| is_free(k));
    }
    // The obstacle has receded: turn back towards it until it bounds the way again.
    let back = (1..=HEADINGS as i32 / 2).find(|&k| !is_free(-k));
    Some(back.map_or(0, |k| 1 - k))
}

/// The side on which to follow an obstacle so that the robot turns least.
pub(super) fn nearer_side(
    blocked: f64,
    anchor: Point,
    surroundings: &mut Surroundings,
    distances: FollowDistances,
) -> WallSide {
    let mut turn = |side| {
        let mut trial = BoundaryFollower::new(side, distances, anchor);
        let heading = trial.heading(&Pose::default(), surroundings);
        heading.map_or(f64::INFINITY, |heading| normalize_angle(heading - blocked).abs())
    };
    if turn(WallSide::Left) < turn(WallSide::Right) { WallSide::Left } else { WallSide::Right }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DISTANCES: FollowDistances = FollowDistances { least: 0.07, wished: 0.1, step: 0.1 };

    fn seeing(points: &[Point]) -> Surroundings {
        let mut surroundings = Surroundings::default();
        surroundings.update(points.iter().copied(), 0.24);
        surroundings
    }

    /// Points at intervals of 1 cm from `a` to `b`.
    fn wall(a: (f64, f64), b: (f64, f64)) -> Vec<Point> {
        let (a, b) = (Point::new(a.0, a.1), Point::new(b.0, b.1));
        let count = ((b - a).norm() / 0.01).ceil() as usize;
        (0..=count).map(|i| a + (b - a) * (i as f64 / count as f64)).collect()
    }

    fn heading(side: WallSide, anchor: (f64, f64), points: &[Point]) -> Option<f64> {
        let mut follower = BoundaryFollower::new(side, DISTANCES, Point::new(anchor.0, anchor.1));
        follower.heading(&Pose::default(), &mut seeing(points))
    }

    #[test]
    fn a_wall_at_the_wished_distance_is_followed_along() {
        let right = wall((-0.5, -0.1), (0.5, -0.1));
        assert!(heading(WallSide::Right, (0.0, -0.1), &right).unwrap().abs() < 0.2);
        let left = wall((-0.5, 0.1), (0.5, 0.1));
        assert!(heading(WallSide::Left, (0.0, 0.1), &left).unwrap().abs() < 0.2);
    }

    #[test]
    fn both_sides_mirror_each_other() {
        let corner = [wall((-0.5, -0.09), (0.15, -0.09)), wall((0.15, -0.09), (0.15, 0.3))].concat();
        let mirrored: Vec<Point> = corner.iter().map(|p| Point::new(p.x, -p.y)).collect();
        let right = heading(WallSide::Right, (0.0, -0.09), &corner).unwrap();
        let left = heading(WallSide::Left, (0.0, 0.09), &mirrored).unwrap();
        assert!((right + left).abs() < 1e-9, "{right} {left}");
        assert!(right > 1.0, "an inner corner turns the robot away: {right}");
    }

    #[test]
    fn a_passage_of_one_and_a_half_widths_is_entered_and_a_narrower_one_is_not() {
        // The robot stands in front of the middle of a gap in the wall to its right.
        let before_gap = |width: f64| {
            let half = 0.5 * width;
            let walls = [wall((-0.5, -0.1), (-half, -0.1)), wall((half, -0.1), (0.5, -0.1))].concat();
            heading(WallSide::Right, (-half, -0.1), &walls).unwrap()
        };
        assert!((before_gap(0.18) + FRAC_PI_2).abs() < 0.3, "{}", before_gap(0.18));
        assert!(before_gap(0.12).abs() < 0.5, "{}", before_gap(0.12));
    }

    /// A thin wall seen edge-on ends before a narrow passage; of the wall only a point farther off is seen.
    #[test]
    fn the_end_of_a_thin_wall_is_gone_round_though_it_is_not_seen() {
        let seen = [vec![Point::new(-0.05, -0.17)], wall((-0.5, 0.09), (0.5, 0.09))].concat();
        let heading = heading(WallSide::Right, (0.0, -0.11), &seen).unwrap();
        assert!((-1.0..0.0).contains(&heading), "{heading}");
    }

    #[test]
    fn a_box_without_a_way_out_has_no_heading() {
        let side = 0.06;
        let walls: Vec<Point> = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)]
            .windows(2)
            .flat_map(|w| wall((side * w[0].0, side * w[0].1), (side * w[1].0, side * w[1].1)))
            .collect();
        assert_eq!(heading(WallSide::Right, (side, 0.0), &walls), None);
    }
}
