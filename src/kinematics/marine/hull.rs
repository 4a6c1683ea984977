use super::capsule;
use super::displaced::{Displaced, cap};
use crate::ParameterError;
use crate::geometry::{Point3, Vector3};
use crate::parameter::{require_finite, require_positive};

/// A solid part of a hull, in the craft's frame. Parts must not overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum HullPart {
    /// A cuboid along the craft's axes.
    Box {
        /// Size along each axis (m).
        size: Vector3,
        /// Centre.
        centre: Point3,
    },
    /// A cylinder with hemispherical ends.
    Capsule {
        /// Radius (m).
        radius: f64,
        /// Length, including the ends (m).
        length: f64,
        /// Axis of the craft that it is parallel to: 0 forward, 1 left, 2 up.
        axis: usize,
        /// Centre.
        centre: Point3,
    },
    /// An ellipsoid along the craft's axes.
    Ellipsoid {
        /// Semi-axes (m).
        half_axes: Vector3,
        /// Centre.
        centre: Point3,
    },
}

impl HullPart {
    /// Centre.
    pub fn centre(&self) -> Point3 {
        match *self {
            Self::Box { centre, .. } | Self::Capsule { centre, .. } | Self::Ellipsoid { centre, .. } => {
                centre
            }
        }
    }

    /// The same part relative to another origin.
    #[must_use]
    pub(super) fn seen_from(mut self, origin: Vector3) -> Self {
        match &mut self {
            Self::Box { centre, .. } | Self::Capsule { centre, .. } | Self::Ellipsoid { centre, .. } => {
                *centre -= origin;
            }
        }
        self
    }

    /// Half of its extent along each axis (m).
    pub fn half_size(&self) -> Vector3 {
        match *self {
            Self::Box { size, .. } => 0.5 * size,
            Self::Capsule { radius, length, axis, .. } => {
                let mut half = Vector3::repeat(radius);
                if let Some(half) = half.get_mut(axis) {
                    *half = 0.5 * length;
                }
                half
            }
            Self::Ellipsoid { half_axes, .. } => half_axes,
        }
    }

    /// Volume (m³).
    pub fn volume(&self) -> f64 {
        use std::f64::consts::PI;
        match *self {
            Self::Box { size, .. } => size.product(),
            Self::Capsule { radius, length, .. } => {
                PI * radius * radius * (length - 2.0 * radius) + 4.0 / 3.0 * PI * radius * radius * radius
            }
            Self::Ellipsoid { half_axes, .. } => 4.0 / 3.0 * PI * half_axes.product(),
        }
    }

    /// Support function: its extent from the centre along a unit vector (m).
    #[inline]
    pub(super) fn reach(&self, along: &Vector3) -> f64 {
        match *self {
            Self::Box { size, .. } => 0.5 * size.dot(&along.abs()),
            Self::Capsule { radius, length, axis, .. } => {
                radius + (0.5 * length - radius) * along.get(axis).map_or(0.0, |share| share.abs())
            }
            Self::Ellipsoid { half_axes, .. } => half_axes.component_mul(along).norm(),
        }
    }

    /// The water that it displaces, if points `p` with `up · p < level` are under water.
    ///
    /// The volume is exact, not sampled: that of a polyhedron, a cap, or an obliquely cut capsule. NaN if it
    /// depends on a size, a place or a level that is not finite. O(1).
    ///
    /// ```
    /// use roverlab::geometry::{Point3, Vector3};
    /// use roverlab::kinematics::marine::HullPart;
    ///
    /// let tube = HullPart::Capsule { radius: 0.1, length: 1.2, axis: 0, centre: Point3::origin() };
    /// let half = tube.displaced(&Vector3::z(), 0.0);
    /// assert!((half.volume - 0.5 * tube.volume()).abs() < 1e-15 && half.centre().z < 0.0);
    /// ```
    #[inline]
    pub fn displaced(&self, up: &Vector3, level: f64) -> Displaced {
        let centre = self.centre().coords;
        let (depth, reach) = (level - up.dot(&centre), self.reach(up));
        if depth >= reach {
            let volume = self.volume();
            return Displaced { volume, moment: centre * volume };
        }
        if depth <= -reach {
            return Displaced::NOTHING;
        }
        if !(depth - reach).is_finite() {
            return Displaced::UNKNOWN;
        }
        let cut = match *self {
            Self::Box { size, .. } => cut_box(0.5 * size, up, depth),
            Self::Capsule { radius, length, axis, .. } => {
                capsule::cut(radius, 0.5 * length - radius, axis.min(2), up, depth)
            }
            Self::Ellipsoid { half_axes, .. } => cut_ellipsoid(half_axes, up, depth),
        };
        cut.seen_from(-centre)
    }

    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        for coordinate in self.centre().iter() {
            require_finite("hull part's middle", *coordinate)?;
        }
        for half in self.half_size().iter() {
            require_positive("hull part's size", *half)?;
        }
        if let Self::Capsule { radius, length, axis, .. } = *self {
            crate::parameter::require("hull part's axis", axis as f64, axis < 3, "0 to 2")?;
            let long = length >= 2.0 * radius;
            crate::parameter::require("capsule's length", length, long, "at least its diameter")?;
        }
        Ok(())
    }
}

/// The part of a centred cuboid below a plane: the sum of the tetrahedra from a point of the plane to the wet
/// part of each face. The plane itself contributes nothing.
fn cut_box(half: Vector3, up: &Vector3, depth: f64) -> Displaced {
    let apex = up * depth;
    let mut sum = Displaced::NOTHING;
    for axis in 0..3 {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        for side in [1.0, -1.0] {
            // Counter-clockwise as seen from outside.
            let corners = [(1.0, 1.0), (-side, side), (-1.0, -1.0), (side, -side)].map(|(a, b)| {
                let mut corner = Vector3::zeros();
                (corner[axis], corner[next], corner[last]) =
                    (side * half[axis], a * half[next], b * half[last]);
                corner
            });
            sum = sum + wet_part(&corners, up, depth, &apex);
        }
    }
    sum
}

/// The tetrahedra from an apex to the part of a face that is below a plane.
fn wet_part(corners: &[Vector3; 4], up: &Vector3, depth: f64, apex: &Vector3) -> Displaced {
    // A quadrilateral cut by a plane has at most five corners.
    let (mut wet, mut count) = ([Vector3::zeros(); 5], 0);
    for (i, here) in corners.iter().enumerate() {
        let there = &corners[(i + 1) % 4];
        let (a, b) = (depth - up.dot(here), depth - up.dot(there));
        if a >= 0.0 {
            wet[count] = *here;
            count += 1;
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            wet[count] = here + (there - here) * (a / (a - b));
            count += 1;
        }
    }
    let mut sum = Displaced::NOTHING;
    for i in 2..count {
        let (a, b, c) = (wet[0], wet[i - 1], wet[i]);
        let volume = (a - apex).dot(&(b - apex).cross(&(c - apex))) / 6.0;
        sum = sum + Displaced { volume, moment: (apex + a + b + c) * (0.25 * volume) };
    }
    sum
}

/// The part of a centred ellipsoid below a plane: a scaled cap of the unit ball.
fn cut_ellipsoid(half: Vector3, up: &Vector3, depth: f64) -> Displaced {
    let stretched = half.component_mul(up);
    let length = stretched.norm();
    let cap = cap(&(stretched / length), depth / length);
    let stretch = half.product();
    Displaced { volume: cap.volume * stretch, moment: cap.moment.component_mul(&half) * stretch }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::math;
    use proptest::prelude::*;

    fn unit() -> impl Strategy<Value = Vector3> {
        (-1.0..1.0f64, -3.1..3.1f64).prop_map(|(z, angle)| {
            let (sin, cos) = math::sin_cos(angle);
            let flat = (1.0 - z * z).sqrt();
            Vector3::new(flat * cos, flat * sin, z)
        })
    }

    fn part() -> impl Strategy<Value = HullPart> {
        let size = || (0.1..2.0f64, 0.1..2.0f64, 0.1..2.0f64).prop_map(|(x, y, z)| Vector3::new(x, y, z));
        let place = || (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64).prop_map(|(x, y, z)| Point3::new(x, y, z));
        prop_oneof![
            (size(), place()).prop_map(|(size, centre)| HullPart::Box { size, centre }),
            (size(), place()).prop_map(|(half_axes, centre)| HullPart::Ellipsoid { half_axes, centre }),
            (0.05..0.5f64, 0.0..2.0f64, 0..3_usize, place()).prop_map(|(radius, more, axis, centre)| {
                HullPart::Capsule { radius, length: 2.0 * radius + more, axis, centre }
            }),
        ]
    }

    /// Whether a point lies inside a part.
    fn holds(part: &HullPart, point: Vector3) -> bool {
        let local = point - part.centre().coords;
        match *part {
            HullPart::Box { size, .. } => local.abs() <= 0.5 * size,
            HullPart::Ellipsoid { half_axes, .. } => local.component_div(&half_axes).norm() <= 1.0,
            HullPart::Capsule { radius, length, axis, .. } => {
                let mut off = local;
                off[axis] -= local[axis].clamp(radius - 0.5 * length, 0.5 * length - radius);
                off.norm() <= radius
            }
        }
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn the_two_sides_of_a_plane_make_the_whole(part in part(), up in unit(), share in -1.2..1.2f64) {
            let level = up.dot(&part.centre().coords) + share * part.reach(&up);
            let (below, above) = (part.displaced(&up, level), part.displaced(&-up, -level));
            let whole = part.volume();
            prop_assert!(((below + above).volume - whole).abs() < 1e-12 * (1.0 + whole), "{:?} {:?}", below, above);
            let centre = ((below + above).moment / whole - part.centre().coords).norm();
            prop_assert!(centre < 1e-11 / whole.min(1.0), "{}", centre);
        }

        /// The derivative of the volume by the level is the waterplane area, and that of the moment along
        /// `up` is area times level: any wrong constant fails.
        #[test]
        fn volume_and_moment_grow_by_the_water_plane(part in part(), up in unit(), share in -0.95..0.95f64) {
            let level = up.dot(&part.centre().coords) + share * part.reach(&up);
            let step = 1e-5;
            let (more, less) = (part.displaced(&up, level + step), part.displaced(&up, level - step));
            let area = (more.volume - less.volume) / (2.0 * step);
            let growth = (more.moment - less.moment).dot(&up) / (2.0 * step);
            // The second derivative jumps at the edges of a box.
            prop_assert!((growth - level * area).abs() < 1e-3 * (1.0 + area), "{} {}", growth, level * area);
            prop_assert!(area > 0.0);
        }
    }

    #[test]
    fn what_is_not_finite_displaces_no_number() {
        let half_axes = Vector3::new(0.5, f64::NAN, 0.3);
        let parts = [
            HullPart::Box { size: half_axes, centre: Point3::origin() },
            HullPart::Ellipsoid { half_axes, centre: Point3::origin() },
            HullPart::Capsule { radius: f64::INFINITY, length: 1.0, axis: 0, centre: Point3::origin() },
            HullPart::Capsule { radius: 0.1, length: f64::NAN, axis: 0, centre: Point3::origin() },
            HullPart::Capsule { radius: 0.1, length: 1.0, axis: 2, centre: Point3::new(0.0, f64::NAN, 0.0) },
        ];
        for part in parts {
            let displaced = part.displaced(&Vector3::z(), 0.01);
            assert!(displaced.volume.is_nan() && displaced.centre().x.is_nan(), "{part:?}: {displaced:?}");
            let craft = super::super::CraftSpec::of_hull(1.0, Point3::origin(), vec![part]);
            assert!(craft.validate().is_err() && craft.waterline(1e3).is_nan(), "{craft:?}");
        }
    }

    #[test]
    fn counting_points_agrees() {
        let mut stream = crate::random::Stream::new(3);
        let parts = [
            HullPart::Box { size: Vector3::new(0.4, 0.7, 0.3), centre: Point3::new(0.1, 0.2, -0.1) },
            HullPart::Capsule { radius: 0.2, length: 1.0, axis: 1, centre: Point3::new(0.0, 0.1, 0.2) },
            HullPart::Ellipsoid {
                half_axes: Vector3::new(0.5, 0.2, 0.3),
                centre: Point3::new(0.3, 0.0, 0.0),
            },
        ];
        for part in parts {
            let up = Vector3::new(0.4, -0.5, 0.8).normalize();
            let level = up.dot(&part.centre().coords) - 0.3 * part.reach(&up);
            let (mut count, mut sum) = (0, Vector3::zeros());
            let half = part.half_size();
            let points = 400_000;
            for _ in 0..points {
                let draw = Vector3::from_fn(|_, _| stream.between(-1.0, 1.0)).component_mul(&half);
                let point = part.centre().coords + draw;
                if holds(&part, point) && up.dot(&point) < level {
                    (count, sum) = (count + 1, sum + point);
                }
            }
            let exact = part.displaced(&up, level);
            let counted = 8.0 * half.product() * f64::from(count) / f64::from(points);
            assert!((counted / exact.volume - 1.0).abs() < 0.01, "{part:?}: {counted} {exact:?}");
            assert!((sum / f64::from(count) - exact.centre().coords).norm() < 3e-3, "{part:?}");
        }
    }
}
