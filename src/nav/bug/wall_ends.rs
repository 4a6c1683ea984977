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

/// Distance above which the points of two adjacent beams belong to different surfaces (m).
const GAP: f64 = 0.03;
/// Number of steps for which an invisible end is assumed to be still there.
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
mod tests;
