use crate::geometry::{Point, Pose, Vector, cross};

/// The free ends of walls recently seen near the robot.
///
/// The end of a thin wall seen edge-on falls between the beams, possibly just when the robot turns round it.
/// A robot steered only by current points would cut the corner. Filtered ranges do not show the end either:
/// they average over what a beam meets while it sweeps off the end.
#[derive(Debug, Clone, Default)]
pub(super) struct WallEnds {
    known: Vec<WallEnd>,
}

#[derive(Debug, Clone, Copy)]
struct WallEnd {
    /// Position in the frame of the robot's poses.
    place: Point,
    /// Number of steps since it was last measured.
    age: u32,
}

/// What is seen in two beams side by side is not of one surface if it lies farther apart than this, in
/// metres.
const GAP: f64 = 0.03;
/// Steps for which an end that is out of sight is taken to be there still.
const MEMORY: u32 = 40;

impl WallEnds {
    /// Updates the ends with the points measured from a pose, in the order of their beams. Ends within
    /// `reach` metres count; points are accurate to `error` metres.
    pub(super) fn update(&mut self, pose: &Pose, measured: &[Point], reach: f64, error: f64) {
        self.known.retain_mut(|end| {
            end.age += 1;
            end.age <= MEMORY && pose.distance_to(end.place) < reach
        });
        for end in ends(measured).filter(|end| end.coords.norm_squared() < reach * reach) {
            self.meet(pose.to_world(end), error);
        }
    }

    /// The ends that are not among the visible points, in the robot's frame.
    pub(super) fn hidden<'a>(
        &'a self,
        pose: &'a Pose,
        seen: &'a [Point],
        error: f64,
    ) -> impl Iterator<Item = Point> + 'a {
        let is_hidden =
            move |end: &Point| seen.iter().all(|point| (point - end).norm_squared() >= error * error);
        self.known.iter().map(|end| pose.to_local(end.place)).filter(is_hidden)
    }

    fn meet(&mut self, place: Point, error: f64) {
        match self.known.iter_mut().find(|end| (end.place - place).norm() < error) {
            Some(end) => end.age = 0,
            None => self.known.push(WallEnd { place, age: 0 }),
        }
    }
}

/// The points with a gap behind them.
fn ends(measured: &[Point]) -> impl Iterator<Item = Point> + '_ {
    gaps(measured).map(|gap| gap.end)
}

/// Possible ends of walls seen at a slant: anywhere before the next beam, which passes them. Extensions
/// shorter than `least` metres, such as noise, are ignored.
pub(super) fn overhangs(measured: &[Point], reach: f64, least: f64) -> impl Iterator<Item = Point> + '_ {
    let near = gaps(measured).filter(move |gap| gap.end.coords.norm_squared() < reach * reach);
    near.filter_map(move |gap| overhang(gap.end, gap.before, least))
}

/// A gap between neighbouring beams: the point on its nearer side, and the point of the beam before.
struct Gap {
    end: Point,
    before: Point,
}

fn gaps(seen: &[Point]) -> impl Iterator<Item = Gap> + '_ {
    let n = seen.len();
    let apart = |a: Point, b: Point| (a - b).norm_squared() > GAP * GAP;
    (0..n).filter(move |&i| apart(seen[i], seen[(i + 1) % n])).map(move |i| {
        let (a, b) = (seen[i], seen[(i + 1) % n]);
        if a.coords.norm_squared() < b.coords.norm_squared() {
            Gap { end: a, before: seen[(i + n - 1) % n] }
        } else {
            Gap { end: b, before: seen[(i + 2) % n] }
        }
    })
}

/// Where the wall through two points of neighbouring beams would meet the next beam, if that is nearer by
/// `least` metres. Along a straight line the reciprocal of the range is linear for small angles.
fn overhang(end: Point, before: Point, least: f64) -> Option<Point> {
    if (end - before).norm_squared() > GAP * GAP {
        return None;
    }
    let (range, range_before) = (end.coords.norm(), before.coords.norm());
    let next = (2.0 / range - 1.0 / range_before).recip();
    let (unit, unit_before) = (end.coords / range, before.coords / range_before);
    // Each beam turns by the same angle from the previous one.
    let (sin, cos) = (cross(unit_before, unit), unit_before.dot(&unit));
    let onward = Vector::new(cos * unit.x - sin * unit.y, sin * unit.x + cos * unit.y);
    (next < range - least).then(|| Point::origin() + onward * next)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;
    use crate::geometry::units::from_deg;

    const REACH: f64 = 0.3;
    const ERROR: f64 = 0.003;

    /// A thin wall ahead, across the robot's way and half a metre long to the left, and another one far
    /// behind.
    fn wall_and_background() -> Vec<Point> {
        let background = (0..60).map(|i| Point::new(-0.3, -0.6 + 0.02 * f64::from(i)));
        (0..40).map(|i| Point::new(0.1, 0.01 * f64::from(i))).chain(background).collect()
    }

    fn background() -> Vec<Point> {
        wall_and_background().split_off(40)
    }

    /// The hidden ends, for a robot that sees exactly the measured points.
    fn hidden(ends: &mut WallEnds, pose: &Pose, measured: &[Point]) -> Vec<Point> {
        ends.update(pose, measured, REACH, ERROR);
        ends.hidden(pose, measured, ERROR).collect()
    }

    #[test]
    fn an_end_that_goes_out_of_sight_is_where_it_was() {
        let mut ends = WallEnds::default();
        assert_eq!(hidden(&mut ends, &Pose::default(), &wall_and_background()), []);
        let moved = Pose::new(0.02, 0.01, 0.3);
        let hidden = hidden(&mut ends, &moved, &background());
        assert_eq!(hidden.len(), 1, "{hidden:?}");
        assert!((moved.to_world(hidden[0]) - Point::new(0.1, 0.0)).norm() < 1e-9, "{hidden:?}");
    }

    #[test]
    fn what_is_seen_again_is_not_hidden() {
        let mut ends = WallEnds::default();
        for measured in [wall_and_background(), background(), wall_and_background()] {
            let count = hidden(&mut ends, &Pose::default(), &measured).len();
            assert_eq!(count, usize::from(measured.len() == background().len()));
        }
    }

    #[test]
    fn an_end_that_a_filter_has_moved_is_where_it_was_measured() {
        let mut ends = WallEnds::default();
        ends.update(&Pose::default(), &wall_and_background(), REACH, ERROR);
        let seen = wall_and_background().split_off(1);
        let hidden: Vec<Point> = ends.hidden(&Pose::default(), &seen, ERROR).collect();
        assert_eq!(hidden, [Point::new(0.1, 0.0)]);
    }

    #[test]
    fn ends_are_forgotten_with_time_and_with_distance() {
        let mut ends = WallEnds::default();
        hidden(&mut ends, &Pose::default(), &wall_and_background());
        for step in 1..=MEMORY + 1 {
            let count = hidden(&mut ends, &Pose::default(), &background()).len();
            assert_eq!(count, usize::from(step <= MEMORY), "{step}");
        }
        hidden(&mut ends, &Pose::default(), &wall_and_background());
        assert_eq!(hidden(&mut ends, &Pose::new(-0.3, 0.0, 0.0), &[]), []);
    }

    /// A wall from (0.1, 0.004) straight away from the robot, at a slant of a few degrees, in beams at
    /// intervals of one degree.
    #[test]
    fn a_wall_seen_at_a_slant_may_end_before_the_next_beam() {
        let (end, along) = (Point::new(0.1, 0.004), Vector::new(1.0, 0.2));
        let hit = |degree: i32| {
            let beam = direction(from_deg(f64::from(degree)));
            // On the line, and on the beam.
            let t = cross(end.coords, beam) / cross(beam, along);
            (t >= 0.0).then(|| end + along * t)
        };
        let seen: Vec<Point> = (0..11).filter_map(hit).chain(background()).collect();
        let nearest = seen[0];
        assert!((nearest - end).norm() > ERROR, "{nearest}");
        let places: Vec<Point> = overhangs(&seen, REACH, ERROR).collect();
        assert_eq!(places.len(), 1, "{places:?}");
        let (before_end, on_line) = (places[0].x < end.x, cross(along, places[0] - end).abs());
        assert!(before_end && on_line < 1e-4, "{places:?}");
    }

    #[test]
    fn a_wall_seen_from_the_front_has_no_overhang() {
        let seen: Vec<Point> =
            (0..40).map(|i| Point::new(0.1, 0.002 * f64::from(i))).chain(background()).collect();
        assert_eq!(overhangs(&seen, REACH, ERROR).count(), 0);
        assert_eq!(overhangs(&[], REACH, ERROR).count(), 0);
    }
}
