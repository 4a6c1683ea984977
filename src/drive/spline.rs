use crate::geometry::{Point, Pose, Vector, cross, direction};

/// A cubic Hermite spline between two points with given tangents (book, section 3.6), with a parameter from 0
/// to 1.
///
/// ```
/// use roverlab::drive::Hermite;
/// use roverlab::geometry::Pose;
/// let spline = Hermite::between(Pose::default(), Pose::new(1.0, 1.0, 0.0), 1.5);
/// assert_eq!(spline.point(1.0), Pose::new(1.0, 1.0, 0.0).position());
/// assert_eq!(spline.heading(0.0), 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hermite {
    /// Start and end point.
    pub ends: [Point; 2],
    /// Derivatives with respect to the parameter at both ends (m).
    pub tangents: [Vector; 2],
}

impl Hermite {
    /// The spline between two poses, with tangents of `scale` times the distance between them: larger ones
    /// swing out farther.
    pub fn between(start: Pose, goal: Pose, scale: f64) -> Self {
        let length = scale * start.distance_to(goal.position());
        Self {
            ends: [start.position(), goal.position()],
            tangents: [start.forward() * length, goal.forward() * length],
        }
    }

    /// The point at a parameter.
    pub fn point(&self, u: f64) -> Point {
        let (u2, u3) = (u * u, u * u * u);
        let [a, b] = self.ends.map(|end| end.coords);
        let weights = [2.0 * u3 - 3.0 * u2 + 1.0, 3.0 * u2 - 2.0 * u3, u3 - 2.0 * u2 + u, u3 - u2];
        Point::from(
            a * weights[0] + b * weights[1] + self.tangents[0] * weights[2] + self.tangents[1] * weights[3],
        )
    }

    /// First derivative with respect to the parameter.
    pub fn derivative(&self, u: f64) -> Vector {
        let u2 = u * u;
        (self.ends[1] - self.ends[0]) * (6.0 * (u - u2))
            + self.tangents[0] * (3.0 * u2 - 4.0 * u + 1.0)
            + self.tangents[1] * (3.0 * u2 - 2.0 * u)
    }

    /// Second derivative with respect to the parameter.
    pub fn second_derivative(&self, u: f64) -> Vector {
        (self.ends[1] - self.ends[0]) * (6.0 - 12.0 * u)
            + self.tangents[0] * (6.0 * u - 4.0)
            + self.tangents[1] * (6.0 * u - 2.0)
    }

    /// Direction at a parameter (rad); where the derivative vanishes, the direction from start to end.
    pub fn heading(&self, u: f64) -> f64 {
        let along = self.derivative(u);
        let along = if along.norm() > 1e-12 { along } else { self.ends[1] - self.ends[0] };
        crate::geometry::math::atan2(along.y, along.x)
    }

    /// Curvature at a parameter (1/m), positive to the left; 0 where the derivative vanishes.
    pub fn curvature(&self, u: f64) -> f64 {
        let along = self.derivative(u);
        let speed = along.norm();
        if speed > 1e-9 { cross(along, self.second_derivative(u)) / (speed * speed * speed) } else { 0.0 }
    }
}

/// The splines of a centripetal Catmull-Rom chain through points with optional directions (E. Catmull and R.
/// Rom, "A class of local interpolating splines", 1974; parametrised after C. Yuksel, S. Schaefer and J.
/// Keyser, "Parameterization and applications of Catmull-Rom curves", 2011).
pub(super) fn catmull_rom(points: &[(Point, Option<f64>)]) -> Vec<Hermite> {
    // Centripetal parametrisation, by the root of the chord length, avoids loops and cusps.
    let step = |i: usize| (points[i + 1].0 - points[i].0).norm().sqrt();
    let chord = |i: usize| (points[i + 1].0 - points[i].0) / step(i);
    let last = points.len() - 1;
    let tangent = |i: usize| {
        let free = if i == 0 {
            chord(0)
        } else if i == last {
            chord(last - 1)
        } else {
            let whole = (points[i + 1].0 - points[i - 1].0) / (step(i - 1) + step(i));
            chord(i - 1) - whole + chord(i)
        };
        points[i].1.map_or(free, |heading| direction(heading) * free.norm())
    };
    let spline = |i: usize| Hermite {
        ends: [points[i].0, points[i + 1].0],
        tangents: [tangent(i) * step(i), tangent(i + 1) * step(i)],
    };
    (0..last).map(spline).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose() -> impl Strategy<Value = Pose> {
        (-2.0..2.0f64, -2.0..2.0f64, -3.0..3.0f64).prop_map(|(x, y, heading)| Pose::new(x, y, heading))
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn splines_start_and_end_as_told(a in pose(), b in pose(), scale in 0.5..3.0f64) {
            prop_assume!(a.distance_to(b.position()) > 0.01);
            let spline = Hermite::between(a, b, scale);
            for (u, end) in [(0.0, a), (1.0, b)] {
                prop_assert!((spline.point(u) - end.position()).norm() < 1e-12);
                prop_assert!((direction(spline.heading(u)) - end.forward()).norm() < 1e-9);
            }
        }

        #[test]
        fn derivatives_are_those_of_the_points(a in pose(), b in pose(), u in 0.01..0.99f64) {
            let spline = Hermite::between(a, b, 1.0);
            let h = 1e-5;
            let by_points = (spline.point(u + h) - spline.point(u - h)) / (2.0 * h);
            prop_assert!((by_points - spline.derivative(u)).norm() < 1e-6);
            let by_derivatives = (spline.derivative(u + h) - spline.derivative(u - h)) / (2.0 * h);
            prop_assert!((by_derivatives - spline.second_derivative(u)).norm() < 1e-6);
        }

        #[test]
        fn chains_pass_through_their_points_without_a_kink(places in prop::collection::vec(pose(), 3..6)) {
            let points: Vec<_> = places.iter().map(|pose| (pose.position(), None)).collect();
            prop_assume!(points.windows(2).all(|pair| (pair[1].0 - pair[0].0).norm() > 0.05));
            let chain = catmull_rom(&points);
            for (pair, point) in chain.windows(2).zip(&points[1..]) {
                prop_assert!((pair[0].point(1.0) - point.0).norm() < 1e-12);
                let [before, after] = [pair[0].derivative(1.0), pair[1].derivative(0.0)];
                prop_assert!(cross(before, after).abs() < 1e-9 && before.dot(&after) >= 0.0);
            }
        }
    }

    #[test]
    fn a_straight_spline_is_straight() {
        let spline = Hermite::between(Pose::default(), Pose::new(2.0, 0.0, 0.0), 1.0);
        assert!((0..=10).all(|i| spline.curvature(f64::from(i) / 10.0).abs() < 1e-12));
    }
}
