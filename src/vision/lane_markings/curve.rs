use crate::geometry::{Point, Vector, math};

/// Number of curvature knots: at the car, and at equal distances ahead. In between, curvature is linear.
pub(super) const KNOTS: usize = 6;
/// Distance between knots (m).
pub(super) const SPACING: f64 = 0.4;
/// Step of the table (m).
const STEP: f64 = 0.025;
/// Number of entries in the table.
const PLACES: usize = 112;

/// Curvatures at the knots (1/m).
pub(super) type Bends = [f64; KNOTS];

/// Centre line of a road as a table, from abreast of the car on. It begins at the origin, along x.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    places: Vec<Place>,
}

#[derive(Debug, Clone, Copy)]
struct Place {
    point: Point,
    forward: Vector,
    bend: f64,
    /// Derivatives of the point by the curvatures (m²).
    slopes: [Vector; KNOTS],
}

/// A point in road coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct Foot {
    /// Distance along the road (m).
    pub(super) along: f64,
    /// Distance to the left of the centre line (m).
    pub(super) left: f64,
    /// Direction to the left there.
    pub(super) normal: Vector,
    /// Derivatives of `left` by the curvatures (m²).
    pub(super) slopes: [f64; KNOTS],
}

/// Weights of the knots in the curvature at a position.
fn shares(along: f64) -> [f64; KNOTS] {
    let at = (along / SPACING).clamp(0.0, (KNOTS - 1) as f64);
    std::array::from_fn(|knot| (1.0 - (at - knot as f64).abs()).max(0.0))
}

/// Curvature at a position (1/m).
pub(super) fn bend_at(bends: &Bends, along: f64) -> f64 {
    bends.iter().zip(shares(along)).map(|(bend, share)| bend * share).sum()
}

impl Curve {
    pub(super) fn new(bends: &Bends) -> Self {
        let mut places = Vec::with_capacity(PLACES);
        let (mut heading, mut point) = (0.0, Point::origin());
        let (mut turns, mut slopes) = ([0.0; KNOTS], [Vector::zeros(); KNOTS]);
        for i in 0..PLACES {
            let along = STEP * i as f64;
            let (sin, cos) = math::sin_cos(heading);
            let forward = Vector::new(cos, sin);
            places.push(Place { point, forward, bend: bend_at(bends, along), slopes });
            // Midpoint rule.
            let shares = shares(along + 0.5 * STEP);
            let bend: f64 = bends.iter().zip(shares).map(|(bend, share)| bend * share).sum();
            let (sin, cos) = math::sin_cos(heading + 0.5 * STEP * bend);
            point += Vector::new(cos, sin) * STEP;
            for knot in 0..KNOTS {
                let turn = turns[knot] + 0.5 * STEP * shares[knot];
                slopes[knot] += Vector::new(-sin, cos) * (turn * STEP);
                turns[knot] += STEP * shares[knot];
            }
            heading += STEP * bend;
        }
        Self { places }
    }

    /// Point and direction at a distance along the curve (m).
    pub(super) fn at(&self, along: f64) -> (Point, Vector) {
        let index = ((along / STEP).max(0.0) as usize).min(PLACES - 1);
        let place = self.places[index];
        let rest = along - STEP * index as f64;
        let left = Vector::new(-place.forward.y, place.forward.x);
        (
            place.point + place.forward * rest + left * (0.5 * place.bend * rest * rest),
            place.forward + left * (place.bend * rest),
        )
    }

    /// Road coordinates of a point; `None` beyond the end of the curve.
    pub(super) fn foot(&self, point: Point) -> Option<Foot> {
        let mut along = point.x;
        for _ in 0..4 {
            let index = ((along / STEP + 0.5).max(0.0) as usize).min(PLACES - 1);
            let place = &self.places[index];
            let between = point - place.point;
            let normal = Vector::new(-place.forward.y, place.forward.x);
            let ahead = between.dot(&place.forward) / (1.0 - place.bend * between.dot(&normal)).max(0.3);
            along = STEP * index as f64 + ahead;
            if ahead.abs() <= STEP {
                let turned = normal - place.forward * (place.bend * ahead);
                return Some(Foot {
                    along,
                    left: between.dot(&normal) - 0.5 * place.bend * ahead * ahead,
                    normal: turned / turned.norm(),
                    slopes: place.slopes.map(|slope| -slope.dot(&normal)),
                });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_beside_a_circle_are_as_far_from_it_as_their_radius_says() {
        let curve = Curve::new(&[0.8; KNOTS]);
        for (angle, left) in [(0.2_f64, 0.0), (0.9, 0.3), (1.4, -0.4), (1.0, 0.42)] {
            let radius = 1.25 - left;
            let point = Point::new(radius * math::sin(angle), 1.25 - radius * math::cos(angle));
            let foot = curve.foot(point).unwrap();
            assert!((foot.left - left).abs() < 1e-3, "{foot:?}");
            assert!((foot.along - 1.25 * angle).abs() < 2e-3, "{foot:?}");
            let (place, forward) = curve.at(foot.along);
            assert!((place - point).dot(&forward).abs() < 2e-3);
        }
        assert!(Curve::new(&[0.0; KNOTS]).foot(Point::new(9.0, 0.0)).is_none(), "beyond the table");
    }

    #[test]
    fn slopes_are_those_of_differences() {
        let bends = [0.3, 0.6, 0.1, -0.4, 0.2, 0.0];
        let point = Point::new(1.3, 0.5);
        let foot = Curve::new(&bends).foot(point).unwrap();
        for knot in 0..KNOTS {
            let mut other = bends;
            other[knot] += 1e-3;
            let moved = Curve::new(&other).foot(point).unwrap();
            let slope = (moved.left - foot.left) / 1e-3;
            assert!((slope - foot.slopes[knot]).abs() < 0.02, "{knot}: {slope} {:?}", foot.slopes);
        }
    }
}
